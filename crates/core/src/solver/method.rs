//! The list of methods that find the contact impulses of a time step, and the properties of each method.

use crate::setting::words;

words! {
    /// A method that finds the contact impulses of a time step, with its name on the command line, in scene files and
    /// in the panels of the user interface.
    pub enum Method {
        Nsgs = "nsgs", "non-linear Gauss-Seidel: one contact after the other, exact for each";
        NsgsParallel = "nsgs-parallel",
            "Gauss-Seidel by tiles and colours: four contacts at a time, large piles on several threads";
        Newton = "newton", "semi-smooth Newton with sparse factorisation: all contacts at once, for tight tolerances";
        Nncg = "nncg", "conjugate gradients over Gauss-Seidel sweeps: fewer sweeps to tight tolerances";
        Apgd = "apgd", "accelerated projected gradients with restart: all contacts at once, no order";
        Admm = "admm", "alternating directions of multipliers: one cached factorisation, many solves";
        Jacobi = "jacobi", "Jacobi with mass splitting: all contacts at once, each with its part of the mass";
        InteriorPoint = "interior-point",
            "interior point with sparse factorisation: convex friction models to any tolerance";
        Auto = "auto",
            "newton under Coulomb's law, but over-relaxed sweeps while a large pile flows; interior-point under convex \
                friction models";
    }
}

words! {
    /// The order in which a sweep visits the contacts.
    #[derive(Default)]
    pub enum Ordering {
        #[default]
        Interleaved = "interleaved", "distant contacts in turn: the fastest sweep";
        Detected = "detected", "as detected: sorted by grain";
        BottomUp = "bottom-up", "from the lowest contact to the highest";
        Symmetric = "symmetric", "interleaved, every second sweep backward";
        Coloured = "coloured", "contacts that share no grain follow each other";
    }
}

/// Properties of a method that finds the contact impulses of a time step.
#[derive(Clone, Copy, Debug)]
pub struct MethodInfo {
    /// The method.
    pub method: Method,
    /// Name of the method on the command line.
    pub name: &'static str,
    /// Description of how the method works, one line.
    pub summary: &'static str,
    /// The contact and friction laws that a converged result of the method satisfies, one line.
    pub solves: &'static str,
    /// The publication or other source of the method.
    pub source: &'static str,
    /// The order in which a sweep of the method visits the contacts.
    pub order: MethodOrder,
    /// True if the method also supports friction models other than Coulomb's law.
    pub takes_models: bool,
    /// True if the method supports walls that a force drives.
    pub takes_drives: bool,
    /// True if the method supports periodic borders that shear, so that the copies (images) of grains beyond a border
    /// move relative to the grains.
    pub takes_shear: bool,
    /// True if the method supports contact laws that differ between pairs of materials.
    pub takes_pairs: bool,
    /// True if the method supports rolling friction.
    pub takes_rolling: bool,
}

/// The order in which a method visits the contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodOrder {
    /// The order that the settings name (`--ordering`).
    OfSettings,
    /// A fixed order, regardless of the settings.
    Always(Ordering),
    /// No order: the method updates all contacts at once.
    AllAtOnce,
}

impl MethodOrder {
    /// Returns the order in which the contacts of a problem are sorted for the method. `asked` is the order that the
    /// settings name.
    pub(crate) fn of_rows(self, asked: Ordering) -> Ordering {
        match self {
            Self::Always(needed) => needed,
            Self::OfSettings | Self::AllAtOnce => asked,
        }
    }
}

use MethodOrder::{AllAtOnce, Always, OfSettings};

/// Text for users that names the contact laws of the solutions that a method finds: Signorini's law with cohesion, and
/// Coulomb friction.
const COULOMB: &str = "Signorini's law with cohesion and Coulomb's law";
/// Text for users that names the contact laws of the solutions that a method finds. It is the counterpart of
/// [`COULOMB`] for a method that recomputes the friction bounds from its own impulses in every iteration; such a method
/// solves the laws that `COULOMB` names.
const BOUND_BY_BOUND: &str = "the same, the bound of friction taken anew every iteration";

/// Makes [`METHODS`]. Each row has a method, its order, the laws that it solves and its source, and then the names of
/// the parts of scenes that the method supports.
macro_rules! methods {
    ($($method:ident, $order:expr, $solves:expr, $source:literal: $($takes:ident)*;)*) => {
        /// The properties of all methods, in the order of [`Method`], which is also the order in which the program
        /// lists them.
        pub const METHODS: [MethodInfo; Method::ALL.len()] = [$(MethodInfo {
            $($takes: true,)*
            ..MethodInfo {
                method: Method::$method,
                name: Method::$method.name(),
                summary: Method::$method.hint(),
                solves: $solves,
                source: $source,
                order: $order,
                takes_models: false,
                takes_drives: false,
                takes_shear: false,
                takes_pairs: false,
                takes_rolling: false,
            }
        }),*];
    };
}

methods! {
    Nsgs, OfSettings, COULOMB, "M. Jean, The non-smooth contact dynamics method (1999)":
        takes_models takes_drives takes_shear takes_pairs takes_rolling;
    NsgsParallel, Always(Ordering::Coloured), COULOMB,
        "M. Jean (1999); colours as in M. Renouf, F. Dubois, P. Alart (2004)":;
    Newton, OfSettings, COULOMB, "P. Alart, A. Curnier, generalised Newton methods for contact with friction (1991)":
        takes_shear takes_pairs takes_rolling;
    Nncg, OfSettings, COULOMB, "M. Silcowitz, S. Niebe, K. Erleben, non-smooth non-linear conjugate gradients (2010)":
        takes_drives takes_shear takes_pairs takes_rolling;
    Apgd, AllAtOnce, BOUND_BY_BOUND, "H. Mazhar, T. Heyn, D. Negrut, A. Tasora, Nesterov's method for contact (2015)":
        takes_drives takes_shear takes_pairs;
    Admm, AllAtOnce, BOUND_BY_BOUND, "S. Boyd and others (2011); for contact V. Acary, M. Bremond, O. Huber (2018)":
        takes_shear takes_pairs;
    Jacobi, AllAtOnce, COULOMB, "R. Tonge, F. Benevolenski, A. Voroshilov, mass splitting (2012)":
        takes_drives takes_shear takes_pairs;
    InteriorPoint, OfSettings, "a convex model of friction; Coulomb's law where its path leads there",
        "S. Mehrotra, On the implementation of a primal-dual interior point method (1992)":
        takes_models takes_drives takes_shear takes_pairs;
    Auto, OfSettings, "a convex model of friction, or Coulomb's law", "the charts of speed against accuracy":
        takes_models takes_drives takes_shear takes_pairs takes_rolling;
}

impl Method {
    /// Returns the properties of this method.
    pub const fn info(self) -> &'static MethodInfo {
        &METHODS[self as usize]
    }

    /// Returns true if the method visits the contacts in the order that the settings name (`--ordering`).
    pub fn sweeps_in_order(self) -> bool {
        self.info().order == MethodOrder::OfSettings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_method_stands_at_its_own_place_in_the_registry() {
        for (info, &method) in METHODS.iter().zip(Method::ALL) {
            assert_eq!(info.method, method);
            assert_eq!(method.info().name, method.name());
        }
    }
}
