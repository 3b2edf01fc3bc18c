//! The macros that declare settings, and what their structures have in common.

use serde::de::MapAccess;
use serde::ser::SerializeMap;

use super::{About, Value};
use crate::error;

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

/// Declares a structure of settings and the one of their changes. Each field is followed by its default and
/// by what [`crate::setting::Declared`] says of it.
macro_rules! settings {
    (
        $(#[$meta:meta])* $vis:vis struct $Name:ident, changes $Changes:ident, heading $heading:literal {
            $($(#[$field_meta:meta])* $field:ident: $type:ty = $default:expr, { $($said:tt)* })*
        }
    ) => {
        #[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        $(#[$meta])*
        $vis struct $Name {
            $($(#[$field_meta])* pub $field: $type,)*
        }

        #[doc = concat!("What is given of [`", stringify!($Name), "`].")]
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        $vis struct $Changes {
            $(
                #[doc = concat!("See [`", stringify!($Name), "::", stringify!($field), "`].")]
                pub $field: Option<$type>,
            )*
        }

        impl Default for $Name {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        const _: () = {
            use $crate::setting::{About, Changes, Declared, Group, Settable, Value};

            // Declarations by the names of their fields.
            #[allow(non_upper_case_globals, reason = "named after the fields")]
            #[allow(clippy::needless_update, reason = "a declaration may say everything")]
            mod declared {
                #[allow(unused_imports, reason = "not every declaration needs them all")]
                use super::*;
                #[allow(unused_imports, reason = "not every declaration needs them all")]
                use $crate::setting::{Control, Declared, Needs};
                $(
                    pub(super) const $field: Declared<$type> =
                        Declared { $($said)* ..Declared::ANY };
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
                        let Declared { name, allowed, .. } = declared::$field;
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

/// Declares a setting that is one of a few words, each with its name and a line that explains it.
macro_rules! words {
    (
        $(#[$meta:meta])* $vis:vis enum $Name:ident {
            $($(#[$variant_meta:meta])* $Variant:ident = $word:literal, $hint:literal;)*
        }
    ) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
        $(#[$meta])*
        $vis enum $Name {
            $($(#[$variant_meta])* #[serde(rename = $word)] $Variant,)*
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
