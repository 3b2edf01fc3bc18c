//! What each method tells of itself.

use super::method::Method;
use crate::solver::ordering::Ordering;

/// What there is to know of a method.
#[derive(Clone, Copy, Debug)]
pub struct MethodInfo {
    /// The method.
    pub method: Method,
    /// Its name on the command line.
    pub name: &'static str,
    /// How it works, one line.
    pub summary: &'static str,
    /// What its result solves exactly, one line.
    pub solves: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// In which order it takes the contacts.
    pub order: MethodOrder,
    /// Whether it solves the models of friction beside Coulomb's law.
    pub takes_models: bool,
    /// Whether it solves for walls that a force drives.
    pub takes_drives: bool,
    /// Whether it solves for grains whose images slide.
    pub takes_shear: bool,
}

/// In which order a method takes the contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodOrder {
    /// In that of the settings.
    OfSettings,
    /// In this one, whatever the settings ask for.
    Always(Ordering),
    /// In none: it takes them all at once.
    AllAtOnce,
}

impl MethodOrder {
    /// The order of the rows where the settings ask for `asked`.
    pub(crate) fn of_rows(self, asked: Ordering) -> Ordering {
        match self {
            Self::Always(needed) => needed,
            Self::OfSettings | Self::AllAtOnce => asked,
        }
    }
}

/// What is solved by every method that rests at a zero of the common natural map.
pub(super) const COULOMB: &str = "Signorini's law with cohesion and Coulomb's law";

/// What is solved where the bound of friction is a fixed point of its own.
pub(super) const BOUND_BY_BOUND: &str =
    "the same, the bound of friction taken anew every iteration";
