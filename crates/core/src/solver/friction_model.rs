//! How friction enters the problem of a step.

use crate::setting::words;

words! {
    /// What is asked of friction in a step. All but Coulomb's law are made convex by what is held while a
    /// step is solved (`problem::held`), so that the velocities of a solve are unique.
    #[derive(Default)]
    pub enum FrictionModel {
        /// |λ_t| ≤ μσ with the σ of the same step.
        #[default]
        Coulomb = "coulomb",
            "Coulomb's law itself (M. Jean, 1999); not convex, so a large step may not be solved in any time";
        /// |λ_t| ≤ g, held.
        Tresca = "tresca",
            "bounds μN of each contact's last solve (P. D. Panagiotopoulos, 1975); friction lags a step behind";
        /// (σ, λ_t) in the cone, (w, v_t) in its dual.
        Associated = "associated",
            "cone complementarity (M. Anitescu, 2006); what slides opens by Δt·μ·v_t a step, and bonds break";
        /// The same with w + s, s = μ|v_t| held.
        Desaxce = "desaxce",
            "associated less the last μ|v_t| (G. de Saxcé, Z.-Q. Feng, 1998); what slides faster still opens";
    }
}

words! {
    /// What becomes of a step whose problem is not solved under Coulomb's law.
    #[derive(Default)]
    pub enum Fallback {
        /// `tresca` where the method is `auto`, and where the window opens a scene, else `none`.
        #[default]
        OfMethod = "of-method", "tresca where the solver is auto or the scene opens in the window, else none";
        /// What the method came to.
        None = "none", "the impulses that the method came to, unsolved as they are";
        /// The solution under bounds of friction at those impulses, with a certificate.
        Tresca = "tresca",
            "friction bounded by what the method came to, and that problem solved with a certificate";
    }
}

impl FrictionModel {
    /// Whether it holds anything that a further solve of the same step takes anew.
    pub fn is_taken_anew(self) -> bool {
        matches!(self, Self::Tresca | Self::Desaxce)
    }

    /// Whether its cone is the shifted one alone. The compressive cone with cohesion is no convex set: its
    /// convex hull is the shifted cone.
    pub(crate) fn needs_shifted_cone(self) -> bool {
        matches!(self, Self::Associated | Self::Desaxce)
    }
}
