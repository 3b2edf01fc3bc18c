//! Settings, each declared once: its name, its default, what it may be, and how it is explained.
//!
//! `settings!` makes of a list of declarations the plain structure that the physics reads, the structure
//! of changes that command line, scene and study files fill in ([`Group::Changes`]), the check of the ranges,
//! and a table ([`About`]) from which options, controls and messages are made. `words!` does so for a
//! setting that is one of a few words.

use std::fmt;

use serde::de::MapAccess;
use serde::ser::SerializeMap;

use crate::error;

/// A setting as its declaration explains it.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// As command line, studies and messages write it.
    pub name: &'static str,
    /// Stands for the value in the help of the command line.
    pub value_name: &'static str,
    /// One line.
    pub help: &'static str,
    /// Under which heading the command line lists it.
    pub heading: &'static str,
    /// What its values are.
    pub kind: Kind,
    /// What a scene must have for it to mean anything.
    pub needs: Needs,
    /// How the window shows it, if it does.
    pub control: Option<Control>,
}

/// What a scene must have for a setting to mean anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Nothing.
    Nothing,
    /// Friction.
    Friction,
    /// Cohesion.
    Cohesion,
    /// Uniform gravity in the plane, which has a direction.
    Direction,
}

/// How the window shows a setting.
#[derive(Clone, Copy, Debug)]
pub struct Control {
    /// What it is called.
    pub label: &'static str,
    /// Its short name, by which scripts that drive the window find it.
    pub symbol: &'static str,
    /// Its unit, or nothing.
    pub unit: &'static str,
    /// One sentence.
    pub hint: &'static str,
    /// Ends of a number's slider. Typed values may lie outside.
    pub range: [f64; 2],
    /// The largest number that can be typed: beyond it lies no physics, but a slip of the finger.
    pub most: f64,
    /// True where equal distances on the slider are equal factors.
    pub logarithmic: bool,
}

impl Control {
    /// A control without a slider, or one from 0 to 1.
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

/// A control of which no more is said.
pub(crate) const fn shown(label: &'static str, hint: &'static str) -> Option<Control> {
    Some(Control { label, hint, ..Control::PLAIN })
}

/// The declaration of a setting of one type: what [`About`] has, and which values it may have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Declaration<T> {
    pub name: &'static str,
    pub value_name: &'static str,
    pub help: &'static str,
    /// What it may be, for messages.
    pub allowed: &'static str,
    /// True where a value is allowed. NaN must not be.
    pub holds: fn(T) -> bool,
    pub needs: Needs,
    pub control: Option<Control>,
}

impl<T: Settable> Declaration<T> {
    /// A setting that may be any value and that the window does not show.
    pub(crate) const ANY: Self = Self {
        name: "",
        value_name: T::VALUE_NAME,
        help: "",
        allowed: "",
        holds: |_| true,
        needs: Needs::Nothing,
        control: None,
    };

    /// The row of a table.
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

/// As command line and files write it.
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
    /// As command line and files write it.
    pub name: &'static str,
    /// One line.
    pub hint: &'static str,
}

/// A type that settings can have.
pub trait Settable: Copy + PartialEq {
    /// The kind of its values.
    const KIND: Kind;
    /// Stands for the value in the help of the command line, where no declaration says otherwise.
    const VALUE_NAME: &'static str = "";
    /// It as a value.
    fn value(self) -> Value;
    /// It from a value of its kind; nothing from any other.
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
    /// The same settings, each given or not.
    type Changes: Changes<Group = Self>;
    /// The settings, in the order of the declaration.
    const ABOUT: &'static [About];
    /// The value of a setting.
    fn get(&self, name: &str) -> Option<Value>;
    /// Gives a setting a value of its kind. Whether there is one of that name and kind.
    fn set(&mut self, name: &str, value: Value) -> bool;
    /// Checks each setting against its range.
    ///
    /// # Errors
    /// Names the first outside its range, its value and the range.
    fn validate_each(&self) -> error::Result<()>;
}

/// Settings that are given or not. By name, as files and the command line know them.
pub trait Changes: Default {
    /// What is changed.
    type Group: Group<Changes = Self>;
    /// All settings of a group, as they are.
    fn all_of(group: &Self::Group) -> Self;
    /// Makes the changes.
    fn apply(&self, group: &mut Self::Group);
    /// Gives a setting a value of its kind. Whether there is one of that name and kind.
    fn set(&mut self, name: &str, value: Value) -> bool;
    /// Reads the value of the setting of that name from a file. Whether there is one.
    ///
    /// # Errors
    /// Where the value is of another kind.
    fn read<'de, A: MapAccess<'de>>(&mut self, name: &str, map: &mut A) -> Result<bool, A::Error>;
    /// Writes what is given.
    ///
    /// # Errors
    /// Where the writer fails.
    fn write<S: SerializeMap>(&self, map: &mut S) -> Result<(), S::Error>;
}

/// Declares a structure of settings and the one of their changes. Each field is followed by its default, by name, stand-in
/// and help of its option (which is its documentation, too), and by what else [`crate::setting::Declaration`] says of it.
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

/// Declares a setting that is one of a few words, each with its name and a line that explains it, which is its
/// documentation, too.
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
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$Variant),*];

            const WORDS: &'static [$crate::setting::Word] =
                &[$($crate::setting::Word { name: $word, hint: $hint }),*];

            /// As command line and files write it.
            pub const fn name(self) -> &'static str {
                Self::WORDS[self as usize].name
            }

            /// One line.
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
