//! Settings, each declared once: name, default, allowed values and explanation.
//!
//! From a list of declarations `settings!` generates the plain structure that the physics reads, the structure of
//! changes that the command line, scene files and study files fill in ([`Group::Changes`]), the range checks, and a
//! table ([`About`]) from which options, controls and messages are made. `words!` does the same for a setting with a
//! few allowed words.

use std::fmt;

use serde::de::MapAccess;
use serde::ser::SerializeMap;

use crate::error;

/// The declaration of a setting, independent of its type.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// Name on the command line, in studies and in messages.
    pub name: &'static str,
    /// Placeholder of the value in the command line's help.
    pub value_name: &'static str,
    /// Help text of one line.
    pub help: &'static str,
    /// Heading under which the command line lists the setting.
    pub heading: &'static str,
    /// Kind of its values.
    pub kind: Kind,
    /// The scene feature without which the setting has no effect.
    pub needs: Needs,
    /// Control in the window, if the window shows the setting.
    pub control: Option<Control>,
}

/// The scene feature without which a setting has no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Nothing.
    Nothing,
    /// Friction.
    Friction,
    /// Rotation of grains.
    Rotation,
    /// Cohesion.
    Cohesion,
    /// Uniform gravity in the plane, which has a direction.
    Direction,
}

/// How the window shows a setting.
#[derive(Clone, Copy, Debug)]
pub struct Control {
    /// Label in the window.
    pub label: &'static str,
    /// Short name used by scripts that drive the window.
    pub symbol: &'static str,
    /// Unit, or an empty string.
    pub unit: &'static str,
    /// Hint of one sentence.
    pub hint: &'static str,
    /// Ends of a number's slider. Typed values may lie outside.
    pub range: [f64; 2],
    /// The largest number that can be typed; larger ones are typing errors.
    pub most: f64,
    /// True if the slider is logarithmic.
    pub logarithmic: bool,
}

impl Control {
    /// A control without a label, with range 0 to 1.
    pub(crate) const PLAIN: Self = Self {
        label: "",
        symbol: "",
        unit: "",
        hint: "",
        range: [0.0, 1.0],
        most: f64::INFINITY,
        logarithmic: false,
    };
}

/// A control with a label and a hint and defaults for the rest.
pub(crate) const fn shown(label: &'static str, hint: &'static str) -> Option<Control> {
    Some(Control { label, hint, ..Control::PLAIN })
}

/// The declaration of a setting of type `T`: the fields of [`About`] and the range check.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Declaration<T> {
    pub name: &'static str,
    pub value_name: &'static str,
    pub help: &'static str,
    /// Allowed values, for messages.
    pub allowed: &'static str,
    /// True if a value is allowed. Must be false for NaN.
    pub holds: fn(T) -> bool,
    pub needs: Needs,
    pub control: Option<Control>,
}

impl<T: Settable> Declaration<T> {
    /// Any value is allowed, and the window does not show the setting.
    pub(crate) const ANY: Self = Self {
        name: "",
        value_name: T::VALUE_NAME,
        help: "",
        allowed: "",
        holds: |_| true,
        needs: Needs::Nothing,
        control: None,
    };

    /// The row of the table of settings.
    pub(crate) const fn about(&self, heading: &'static str) -> About {
        About {
            name: self.name,
            value_name: self.value_name,
            help: self.help,
            heading,
            kind: T::KIND,
            needs: self.needs,
            control: self.control,
        }
    }
}

/// The value of a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A real number.
    Number(f64),
    /// A whole number.
    Count(u32),
    /// On or off.
    Switch(bool),
    /// One of a few words.
    Word(&'static str),
}

/// Formats the value as the command line and files do.
impl fmt::Display for Value {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(formatter),
            Self::Count(count) => count.fmt(formatter),
            Self::Switch(on) => on.fmt(formatter),
            Self::Word(word) => word.fmt(formatter),
        }
    }
}

/// The kind of a setting's values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A real number.
    Number,
    /// A whole number.
    Count,
    /// On or off.
    Switch,
    /// One of these words.
    Word(&'static [Word]),
}

/// A word that a setting can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// Name on the command line and in files.
    pub name: &'static str,
    /// Explanation of one line.
    pub hint: &'static str,
}

/// A type that settings can have.
pub trait Settable: Copy + PartialEq {
    /// The kind of its values.
    const KIND: Kind;
    /// Default placeholder of the value in the command line's help.
    const VALUE_NAME: &'static str = "";
    /// Converts the setting to a value.
    fn value(self) -> Value;
    /// Converts a value of the right kind to the setting; `None` for another kind.
    fn of(value: Value) -> Option<Self>;
}

macro_rules! settable {
    ($type:ty, $Variant:ident, $value_name:literal) => {
        impl Settable for $type {
            const KIND: Kind = Kind::$Variant;
            const VALUE_NAME: &'static str = $value_name;

            fn value(self) -> Value {
                Value::$Variant(self)
            }

            fn of(value: Value) -> Option<Self> {
                if let Value::$Variant(value) = value { Some(value) } else { None }
            }
        }
    };
}

settable!(f64, Number, "");
settable!(u32, Count, "N");
settable!(bool, Switch, "BOOL");

/// A structure of settings.
pub trait Group: Sized + 'static {
    /// The same settings, each optional.
    type Changes: Changes<Group = Self>;
    /// The settings, in the order of the declaration.
    const ABOUT: &'static [About];
    /// The value of a setting.
    fn get(&self, name: &str) -> Option<Value>;
    /// Sets a setting to a value of its kind. Returns false if no setting has that name and kind.
    fn set(&mut self, name: &str, value: Value) -> bool;
    /// Checks each setting against its range.
    ///
    /// # Errors
    /// Names the first setting outside its range, its value and the range.
    fn validate_each(&self) -> error::Result<()>;
}

/// Optional settings, accessed by the names that files and the command line use.
pub trait Changes: Default {
    /// The settings to change.
    type Group: Group<Changes = Self>;
    /// Changes that set all settings to the values of `group`.
    fn all_of(group: &Self::Group) -> Self;
    /// Applies the changes.
    fn apply(&self, group: &mut Self::Group);
    /// Sets a setting to a value of its kind. Returns false if no setting has that name and kind.
    fn set(&mut self, name: &str, value: Value) -> bool;
    /// Reads the value of the setting `name` from a file. Returns false if no setting has that name.
    ///
    /// # Errors
    /// If the value is of another kind.
    fn read<'de, A: MapAccess<'de>>(&mut self, name: &str, map: &mut A) -> Result<bool, A::Error>;
    /// Writes the settings that are given.
    ///
    /// # Errors
    /// If the writer fails.
    fn write<S: SerializeMap>(&self, map: &mut S) -> Result<(), S::Error>;
}

/// Declares a structure of settings and the structure of their changes. Each field has a default, then the name,
/// placeholder and help of its option (the help is also its documentation), then further fields of
/// [`crate::setting::Declaration`].
macro_rules! settings {
    (
        $(#[$meta:meta])* $vis:vis struct $Name:ident, changes $Changes:ident, heading $heading:literal {
            $(
                $(#[$field_meta:meta])* $field:ident: $type:ty = $default:expr,
                $flag:literal $(($value_name:literal))?, $help:literal, { $($said:tt)* }
            )*
        }
    ) => {
        #[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        $(#[$meta])*
        $vis struct $Name {
            $(#[doc = $help] $(#[$field_meta])* pub $field: $type,)*
        }

        #[doc = concat!("What is given of [`", stringify!($Name), "`].")]
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        $vis struct $Changes {
            $(
                #[doc = concat!("See [`", stringify!($Name), "::", stringify!($field), "`].")]
                pub $field: Option<$type>,
            )*
        }

        impl $Name {
            /// The declared defaults.
            pub const DEFAULT: Self = Self { $($field: $default,)* };
        }

        impl Default for $Name {
            fn default() -> Self {
                Self::DEFAULT
            }
        }

        const _: () = {
            use $crate::setting::{About, Changes, Declaration, Group, Settable, Value};

            // Declarations by the names of their fields.
            #[allow(non_upper_case_globals, reason = "named after the fields")]
            #[allow(clippy::needless_update, reason = "a declaration may say everything")]
            mod declared {
                #[allow(unused_imports, reason = "not every declaration needs them all")]
                use super::*;
                #[allow(unused_imports, reason = "not every declaration needs them all")]
                use $crate::setting::{Control, Declaration, Needs, shown};
                $(
                    pub(super) const $field: Declaration<$type> = Declaration {
                        name: $flag,
                        $(value_name: $value_name,)?
                        help: $help,
                        $($said)*
                        ..Declaration::ANY
                    };
                )*
            }

            impl Group for $Name {
                type Changes = $Changes;
                const ABOUT: &'static [About] = &[$(declared::$field.about($heading)),*];

                fn get(&self, name: &str) -> Option<Value> {
                    $(if name == declared::$field.name {
                        return Some(self.$field.value());
                    })*
                    None
                }

                fn set(&mut self, name: &str, value: Value) -> bool {
                    $(if name == declared::$field.name {
                        let value = <$type>::of(value);
                        self.$field = value.unwrap_or(self.$field);
                        return value.is_some();
                    })*
                    false
                }

                fn validate_each(&self) -> $crate::error::Result<()> {
                    $(if !(declared::$field.holds)(self.$field) {
                        let Declaration { name, allowed, .. } = declared::$field;
                        return Err($crate::error::Error::value(name, self.$field, allowed));
                    })*
                    Ok(())
                }
            }

            impl Changes for $Changes {
                type Group = $Name;

                fn all_of(group: &$Name) -> Self {
                    Self { $($field: Some(group.$field),)* }
                }

                fn apply(&self, group: &mut $Name) {
                    $(group.$field = self.$field.unwrap_or(group.$field);)*
                }

                fn set(&mut self, name: &str, value: Value) -> bool {
                    $(if name == declared::$field.name {
                        self.$field = <$type>::of(value);
                        return self.$field.is_some();
                    })*
                    false
                }

                fn read<'de, A: serde::de::MapAccess<'de>>(
                    &mut self,
                    name: &str,
                    map: &mut A,
                ) -> std::result::Result<bool, A::Error> {
                    $(if name == declared::$field.name {
                        self.$field = Some(map.next_value()?);
                        return Ok(true);
                    })*
                    Ok(false)
                }

                fn write<S: serde::ser::SerializeMap>(
                    &self,
                    map: &mut S,
                ) -> std::result::Result<(), S::Error> {
                    $(if let Some(value) = &self.$field {
                        map.serialize_entry(declared::$field.name, value)?;
                    })*
                    Ok(())
                }
            }
        };
    };
}

pub(crate) use settings;

/// Declares a setting with a few allowed words. Each word has a name and a line of explanation, which is also its
/// documentation.
macro_rules! words {
    (
        $(#[$meta:meta])* $vis:vis enum $Name:ident {
            $($(#[$variant_meta:meta])* $Variant:ident = $word:literal, $hint:literal;)*
        }
    ) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
        $(#[$meta])*
        $vis enum $Name {
            $(#[doc = $hint] $(#[$variant_meta])* #[serde(rename = $word)] $Variant,)*
        }

        impl $Name {
            /// All values.
            pub const ALL: &'static [Self] = &[$(Self::$Variant),*];

            const WORDS: &'static [$crate::setting::Word] =
                &[$($crate::setting::Word { name: $word, hint: $hint }),*];

            /// Name on the command line and in files.
            pub const fn name(self) -> &'static str {
                Self::WORDS[self as usize].name
            }

            /// Explanation of one line.
            pub const fn hint(self) -> &'static str {
                Self::WORDS[self as usize].hint
            }
        }

        impl std::fmt::Display for $Name {
            fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                formatter.write_str(self.name())
            }
        }

        impl $crate::setting::Settable for $Name {
            const KIND: $crate::setting::Kind = $crate::setting::Kind::Word(Self::WORDS);

            fn value(self) -> $crate::setting::Value {
                $crate::setting::Value::Word(self.name())
            }

            fn of(value: $crate::setting::Value) -> Option<Self> {
                let $crate::setting::Value::Word(word) = value else { return None };
                Self::ALL.iter().copied().find(|one| one.name() == word)
            }
        }
    };
}
pub(crate) use words;
