//! What a setting can be.

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
    /// It as a value.
    fn value(self) -> Value;
    /// It from a value of its kind; nothing from any other.
    fn of(value: Value) -> Option<Self>;
}

impl Settable for f64 {
    const KIND: Kind = Kind::Number;

    fn value(self) -> Value {
        Value::Number(self)
    }

    fn of(value: Value) -> Option<Self> {
        if let Value::Number(number) = value { Some(number) } else { None }
    }
}

impl Settable for u32 {
    const KIND: Kind = Kind::Count;

    fn value(self) -> Value {
        Value::Count(self)
    }

    fn of(value: Value) -> Option<Self> {
        if let Value::Count(count) = value { Some(count) } else { None }
    }
}

impl Settable for bool {
    const KIND: Kind = Kind::Switch;

    fn value(self) -> Value {
        Value::Switch(self)
    }

    fn of(value: Value) -> Option<Self> {
        if let Value::Switch(on) = value { Some(on) } else { None }
    }
}
