//! Settings. Each setting is declared once, with its name, default, allowed values and explanation.
//!
//! From a list of declarations the macro `settings!` generates four items. The first is a structure with the values of
//! all settings, which the simulation reads. The second is a structure of changes ([`Group::Changes`]), which contains
//! new values for some settings and which the command line, scene files and files of studies (lists of runs) fill in.
//! The third is the check that each value is allowed. The fourth is a list of descriptions ([`About`]), from which
//! command-line options, controls of the window and error messages are made. The macro `words!` declares the type of a
//! setting whose value is one of a few words.

use std::fmt;

use serde::de::MapAccess;
use serde::ser::SerializeMap;

use crate::error;

/// Declaration of a setting (name, help text, kind of value, control), in a form that does not depend on the Rust type
/// of its value.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// Name of the setting on the command line, in studies (lists of runs) and in error messages.
    pub name: &'static str,
    /// Placeholder for the value in the help of the command line, such as `SECONDS` in `--dt SECONDS`.
    pub value_name: &'static str,
    /// Help text of the setting on the command line: one line.
    pub help: &'static str,
    /// Heading under which the help of the command line lists the setting.
    pub heading: &'static str,
    /// Type of the value: number, count, switch or word.
    pub kind: Kind,
    /// The feature that a scene must have, because the setting has no effect without it.
    pub needs: Needs,
    /// Control in the window. `None` if the window does not show the setting.
    pub control: Option<Control>,
}

/// The feature that a scene must have for a setting to have an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// The setting has an effect in every scene.
    Nothing,
    /// The setting has an effect only if contacts have friction.
    Friction,
    /// The setting has an effect only if grains rotate.
    Rotation,
    /// The setting has an effect only if contacts have cohesion.
    Cohesion,
    /// The setting has an effect only with uniform gravity in the plane, because only this gravity has a direction that
    /// can be turned.
    Direction,
}

/// Slider, check box or list in the window with which the user changes a setting.
#[derive(Clone, Copy, Debug)]
pub struct Control {
    /// Label that the window shows next to the control.
    pub label: &'static str,
    /// Short name of the setting, such as `Δt`, by which titles, explanations and window tests refer to it.
    pub symbol: &'static str,
    /// Unit of the value, or an empty string.
    pub unit: &'static str,
    /// Explanation of one sentence, shown as a hint.
    pub hint: &'static str,
    /// Smallest and largest value of the slider, if the setting is a number. Values outside this range can be typed.
    pub range: [f64; 2],
    /// Largest number that can be typed. Slump refuses a larger number as a typing error.
    pub most: f64,
    /// True if the scale of the slider is logarithmic.
    pub logarithmic: bool,
}

impl Control {
    /// A control without a label or a hint, with slider values from 0 to 1. Declarations of settings start from it and
    /// override some of its fields.
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

/// Returns a control with this label and hint. Its other fields are those of [`Control::PLAIN`].
pub(crate) const fn shown(label: &'static str, hint: &'static str) -> Option<Control> {
    Some(Control { label, hint, ..Control::PLAIN })
}

/// Declaration of a setting with a value of type `T`: the fields of [`About`] and the check that a value is allowed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Declaration<T> {
    pub name: &'static str,
    pub value_name: &'static str,
    pub help: &'static str,
    /// Description of the allowed values, for error messages.
    pub allowed: &'static str,
    /// Returns true if the setting may have this value. It must return false for NaN.
    pub holds: fn(T) -> bool,
    pub needs: Needs,
    pub control: Option<Control>,
}

impl<T: Settable> Declaration<T> {
    /// A declaration that allows any value and has no control in the window. Declarations of settings start from it
    /// and override some of its fields.
    pub(crate) const ANY: Self = Self {
        name: "",
        value_name: T::VALUE_NAME,
        help: "",
        allowed: "",
        holds: |_| true,
        needs: Needs::Nothing,
        control: None,
    };

    /// Returns this declaration as an [`About`], which does not depend on the type of the value. `heading` is the
    /// heading of the setting in the help of the command line.
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

/// Value of a setting: a real number, a count, a switch or a word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A real number.
    Number(f64),
    /// A whole number, not negative.
    Count(u32),
    /// A switch: true is on, false is off.
    Switch(bool),
    /// One of the few words that the setting allows.
    Word(&'static str),
}

/// Formats the value of a setting as the command line and files write it.
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

/// Type of the value of a setting, with the allowed words if it is a word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A real number.
    Number,
    /// A whole number, not negative.
    Count,
    /// A switch that is on or off.
    Switch,
    /// The value is one of the listed words.
    Word(&'static [Word]),
}

/// One of the words that a setting can have as its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// The word itself, as it is written on the command line and in files.
    pub name: &'static str,
    /// Explanation of the word in one line.
    pub hint: &'static str,
}

/// A Rust type that the value of a setting can have: `f64`, `u32`, `bool` or an enum of words.
pub trait Settable: Copy + PartialEq {
    /// Type of the setting's value, as a [`Kind`].
    const KIND: Kind;
    /// Default placeholder for the value in the help of the command line.
    const VALUE_NAME: &'static str = "";
    /// Converts a value of this type to a [`Value`].
    fn value(self) -> Value;
    /// Converts a [`Value`] to this Rust type. `None` if the value has another type, such as a word instead of a
    /// number.
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

/// A structure whose fields are settings, which can be read and set by name.
pub trait Group: Sized + 'static {
    /// The structure of changes to these settings: each setting is an `Option`, and `None` leaves it unchanged.
    type Changes: Changes<Group = Self>;
    /// The declarations of the settings, in the order of the fields.
    const ABOUT: &'static [About];
    /// Returns the value of the setting with this name. `None` if no setting has the name.
    fn get(&self, name: &str) -> Option<Value>;
    /// Sets the setting with this name. Returns false if no setting has this name, or if the value has the wrong type,
    /// such as a word instead of a number.
    fn set(&mut self, name: &str, value: Value) -> bool;
    /// Checks that each setting is in its range.
    ///
    /// # Errors
    /// If a setting is outside its range. The error names the first such setting, its value and the range.
    fn validate_each(&self) -> error::Result<()>;
}

/// Changes of settings: new values for some of the settings in a structure of settings ([`Group`]). Files and the
/// command line access the settings by name.
pub trait Changes: Default {
    /// The structure whose settings are changed.
    type Group: Group<Changes = Self>;
    /// Returns changes that set all settings to the values of `group`.
    fn all_of(group: &Self::Group) -> Self;
    /// Sets those settings of `group` for which these changes have a value.
    fn apply(&self, group: &mut Self::Group);
    /// Adds the change of one setting. Returns false if no setting has this name, or if the value has the wrong type,
    /// such as a word instead of a number.
    fn set(&mut self, name: &str, value: Value) -> bool;
    /// Reads the value of the setting `name` from a file and adds it to the changes. Returns false if no setting has
    /// this name.
    ///
    /// # Errors
    /// If the value in the file has the wrong type, such as a word instead of a number.
    fn read<'de, A: MapAccess<'de>>(&mut self, name: &str, map: &mut A) -> Result<bool, A::Error>;
    /// Writes the settings for which these changes have a value. Each setting becomes an entry of `map`, the part of
    /// the file that is being written, with the name of the setting as its key.
    ///
    /// # Errors
    /// If the file cannot be written.
    fn write<S: SerializeMap>(&self, map: &mut S) -> Result<(), S::Error>;
}

/// Declares a structure of settings and the structure of their changes. Each field is declared by its type and
/// default, the name, placeholder and help text of its command-line option, and further fields of
/// [`crate::setting::Declaration`]. The help text is also the documentation of the field.
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

        #[doc = concat!("Changes of [`", stringify!($Name), "`]; `None` leaves a setting unchanged.")]
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        $vis struct $Changes {
            $(
                #[doc = concat!("See [`", stringify!($Name), "::", stringify!($field), "`].")]
                pub $field: Option<$type>,
            )*
        }

        impl $Name {
            /// The default values of all settings.
            pub const DEFAULT: Self = Self { $($field: $default,)* };
        }

        impl Default for $Name {
            fn default() -> Self {
                Self::DEFAULT
            }
        }

        const _: () = {
            use $crate::setting::{About, Changes, Declaration, Group, Settable, Value};

            // The constants of this module have the names of the fields of the structure.
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

/// Declares the type of a setting whose value is one of a few words. Each word has a name and an explanation of one
/// line, which is also its documentation.
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
            /// All values of this type.
            pub const ALL: &'static [Self] = &[$(Self::$Variant),*];

            const WORDS: &'static [$crate::setting::Word] =
                &[$($crate::setting::Word { name: $word, hint: $hint }),*];

            /// Returns the word as it is written on the command line and in files.
            pub const fn name(self) -> &'static str {
                Self::WORDS[self as usize].name
            }

            /// Returns the explanation of the word in one line.
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
