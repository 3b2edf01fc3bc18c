//! Which impulses each model of friction allows a contact.

/// Slacks of a contact: of σ ≥ 0, and of the two sides of friction.
pub(super) const PAIRS: usize = 3;

/// Which impulses a model of friction allows.
pub(super) trait Shape {
    /// The first and the end of the slacks that it has.
    const FIRST: usize;
    /// See [`Shape::FIRST`].
    const END: usize;
    /// Whether the two slacks of friction stand for the impulses.
    const CONE: bool;
    /// Whether the sides of friction push only along the tangent though the bound grows with σ: Coulomb's
    /// law, which is no convex problem.
    const LEANS: bool = false;
    /// ε, over the compliance of a contact of free bodies: below, rounding in the factorisation eats what is
    /// gained; above, impulses that carry nothing but each other move too little in a step.
    const COMPLIANCE: f64 = 1e-11;
}

/// 0 ≤ σ.
pub(super) enum HalfLine {}

impl Shape for HalfLine {
    const FIRST: usize = 0;
    const END: usize = 1;
    const CONE: bool = false;
}

/// 0 ≤ σ, |λ| ≤ g with g held: `tresca`.
pub(super) enum Strip {}

impl Shape for Strip {
    const FIRST: usize = 0;
    const END: usize = 3;
    const CONE: bool = false;
}

/// |λ| ≤ μσ, what is added to v_n held: `associated` and `desaxce`.
pub(super) enum Cone {}

impl Shape for Cone {
    const FIRST: usize = 1;
    const END: usize = 3;
    const CONE: bool = true;
}

/// 0 ≤ σ, |λ| ≤ μσ, the sides pushing along the tangent alone: Coulomb's law.
pub(super) enum Leaning {}

impl Shape for Leaning {
    const FIRST: usize = 0;
    const END: usize = 3;
    const CONE: bool = false;
    const LEANS: bool = true;
    // The unsymmetric factors invert their diagonal blocks, which costs digits.
    const COMPLIANCE: f64 = 1e-8;
}
