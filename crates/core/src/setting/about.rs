//! What there is to know of a setting.

use super::{Kind, Settable};

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
    /// Whether equal distances on the slider are equal factors.
    pub logarithmic: bool,
}

impl Control {
    /// A control without a slider, or one from 0 to 1.
    pub(crate) const PLAIN: Self =
        Self { label: "", symbol: "", unit: "", hint: "", range: [0.0, 1.0], logarithmic: false };
}

/// The declaration of a setting of one type.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Declared<T> {
    /// See [`About::name`].
    pub name: &'static str,
    /// See [`About::value_name`].
    pub value_name: &'static str,
    /// See [`About::help`].
    pub help: &'static str,
    /// What it may be, for messages.
    pub allowed: &'static str,
    /// Whether a value is allowed. NaN must not be.
    pub holds: fn(T) -> bool,
    /// See [`About::needs`].
    pub needs: Needs,
    /// See [`About::control`].
    pub control: Option<Control>,
}

impl<T: Settable> Declared<T> {
    /// A setting that may be any value and that the window does not show.
    pub(crate) const ANY: Self = Self {
        name: "",
        value_name: "",
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
