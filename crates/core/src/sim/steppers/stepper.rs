//! Which ways to step there are.

use crate::setting::words;

words! {
    /// A way to take a step of Δt, with its contact law.
    #[derive(Default)]
    pub enum Stepper {
        /// The paper's.
        #[default]
        Moreau = "moreau", "the paper's law: a contact and its bond live while the gap is negative";
        /// Bonds that live until they are stretched by the debonding distance.
        Range = "range", "a bond lives until it has been opened by δc, whatever Δt";
        /// Substeps with soft contacts.
        TgsSoft = "tgs-soft",
            "substeps with soft contacts and a relaxing sweep, as game engines step";
        /// Penalties that stiffen, minimised body by body.
        Avbd = "avbd", "augmented vertex block descent: stiffening penalties, body by body, as game engines try";
        /// Discrete elements with springs and dashpots.
        Dem = "dem", "smooth discrete elements: springs, dashpots and a constant attraction";
    }
}
