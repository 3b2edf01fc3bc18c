//! The methods by name, and what there is to know of each.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::setting::{Kind, Settable, Value, Word, words};

/// A method, by the name that command line, scene files and panels use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Non-linear Gauss–Seidel.
    Nsgs,
    /// Non-linear Gauss–Seidel by colours, in vector registers and on several threads.
    NsgsParallel,
    /// Semi-smooth Newton with a sparse factorisation.
    Newton,
    /// Non-smooth non-linear conjugate gradients over Gauss–Seidel sweeps.
    Nncg,
    /// Accelerated projected gradients with adaptive restart.
    Apgd,
    /// Alternating directions of multipliers with a cached factorisation.
    Admm,
    /// Jacobi with mass splitting.
    Jacobi,
    /// Interior point with a sparse factorisation, for the convex models of friction.
    InteriorPoint,
    /// One of the above, by the size of the problem.
    Auto,
}

words! {
    /// The order of a sweep.
    #[derive(Default)]
    pub enum Ordering {
        /// Alternating between distant stretches of the order of detection: the fastest sweep.
        #[default]
        Interleaved = "interleaved", "distant contacts in turn: the fastest sweep";
        /// As detected: sorted by grain i, then by j.
        Detected = "detected", "as detected: sorted by grain";
        /// From the lowest contact against gravity to the highest.
        BottomUp = "bottom-up", "from the lowest contact to the highest";
        /// Interleaved, every second sweep backward.
        Symmetric = "symmetric", "interleaved, every second sweep backward";
        /// By colours: no two contacts of a colour share a grain.
        Coloured = "coloured", "contacts that share no grain follow each other";
    }
}

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
    /// True where it solves the models of friction beside Coulomb's law.
    pub takes_models: bool,
    /// True where it solves for walls that a force drives.
    pub takes_drives: bool,
    /// True where it solves for grains whose images slide.
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

/// All methods, in the order in which they are shown: that of [`Method`].
pub const METHODS: [MethodInfo; 9] = [
    MethodInfo {
        method: Method::Nsgs,
        name: "nsgs",
        summary: "non-linear Gauss-Seidel: one contact after the other, exact for each",
        solves: COULOMB,
        source: "M. Jean, The non-smooth contact dynamics method (1999)",
        order: MethodOrder::OfSettings,
        takes_models: true,
        takes_drives: true,
        takes_shear: true,
    },
    MethodInfo {
        method: Method::NsgsParallel,
        name: "nsgs-parallel",
        summary: "Gauss-Seidel by tiles and colours: four contacts at a time, large piles on several threads",
        solves: COULOMB,
        source: "M. Jean (1999); colours as in M. Renouf, F. Dubois, P. Alart (2004)",
        order: MethodOrder::Always(Ordering::Coloured),
        takes_models: false,
        takes_drives: false,
        takes_shear: false,
    },
    MethodInfo {
        method: Method::Newton,
        name: "newton",
        summary: "semi-smooth Newton, sparse direct: all contacts together, for tight tolerances",
        solves: COULOMB,
        source: "P. Alart, A. Curnier, generalised Newton methods for contact with friction (1991)",
        order: MethodOrder::OfSettings,
        takes_models: false,
        takes_drives: false,
        takes_shear: true,
    },
    MethodInfo {
        method: Method::Nncg,
        name: "nncg",
        summary: "conjugate gradients over Gauss-Seidel sweeps: fewer sweeps to tight tolerances",
        solves: COULOMB,
        source: "M. Silcowitz, S. Niebe, K. Erleben, non-smooth non-linear conjugate gradients (2010)",
        order: MethodOrder::OfSettings,
        takes_models: false,
        takes_drives: true,
        takes_shear: true,
    },
    MethodInfo {
        method: Method::Apgd,
        name: "apgd",
        summary: "accelerated projected gradients with restart: all contacts at once, no order",
        solves: BOUND_BY_BOUND,
        source: "H. Mazhar, T. Heyn, D. Negrut, A. Tasora, Nesterov's method for contact (2015)",
        order: MethodOrder::AllAtOnce,
        takes_models: false,
        takes_drives: true,
        takes_shear: true,
    },
    MethodInfo {
        method: Method::Admm,
        name: "admm",
        summary: "alternating directions of multipliers: one cached factorisation, many solves",
        solves: BOUND_BY_BOUND,
        source: "S. Boyd and others (2011); for contact V. Acary, M. Bremond, O. Huber (2018)",
        order: MethodOrder::AllAtOnce,
        takes_models: false,
        takes_drives: false,
        takes_shear: true,
    },
    MethodInfo {
        method: Method::Jacobi,
        name: "jacobi",
        summary: "Jacobi with mass splitting: all contacts at once, each with its part of the mass",
        solves: COULOMB,
        source: "R. Tonge, F. Benevolenski, A. Voroshilov, mass splitting (2012)",
        order: MethodOrder::AllAtOnce,
        takes_models: false,
        takes_drives: true,
        takes_shear: true,
    },
    MethodInfo {
        method: Method::InteriorPoint,
        name: "interior-point",
        summary: "interior point, sparse direct: the convex models of friction to any tolerance",
        solves: "a convex model of friction, with a certificate; Coulomb's law where its path leads there",
        source: "S. Mehrotra, On the implementation of a primal-dual interior point method (1992)",
        order: MethodOrder::OfSettings,
        takes_models: true,
        takes_drives: false,
        takes_shear: true,
    },
    MethodInfo {
        method: Method::Auto,
        name: "auto",
        summary: "newton up to 1,000 contacts, nncg above, nsgs where sweeps are what is studied",
        solves: COULOMB,
        source: "the charts of speed against accuracy",
        order: MethodOrder::OfSettings,
        takes_models: false,
        takes_drives: true,
        takes_shear: true,
    },
];

const WORDS: [Word; METHODS.len()] = {
    let mut words = [Word { name: "", hint: "" }; METHODS.len()];
    let mut at = 0;
    while at < METHODS.len() {
        words[at] = Word { name: METHODS[at].name, hint: METHODS[at].summary };
        at += 1;
    }
    words
};

impl Method {
    /// What there is to know of it.
    pub const fn info(self) -> &'static MethodInfo {
        &METHODS[self as usize]
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        self.info().name
    }

    /// True where it can be had island by island: tiles that threads share are laid over all of a problem.
    pub(super) fn takes_islands(self) -> bool {
        self.info().order != MethodOrder::Always(Ordering::Coloured)
    }

    /// True where the order of the settings tells the method in which order to sweep.
    pub fn sweeps_in_order(self) -> bool {
        self.info().order == MethodOrder::OfSettings
    }
}

impl Settable for Method {
    const KIND: Kind = Kind::Word(&WORDS);

    fn value(self) -> Value {
        Value::Word(self.name())
    }

    fn of(value: Value) -> Option<Self> {
        let Value::Word(word) = value else { return None };
        METHODS.iter().find(|info| info.name == word).map(|info| info.method)
    }
}

impl fmt::Display for Method {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_method_is_called_the_same_in_the_registry_and_in_scene_files() {
        for info in METHODS {
            assert_eq!(info.method.name(), info.name);
            assert_eq!(info.method.info().method, info.method);
            let written = serde_json::to_string(&info.method).expect("a name");
            assert_eq!(written, format!("\"{}\"", info.name));
        }
    }
}
