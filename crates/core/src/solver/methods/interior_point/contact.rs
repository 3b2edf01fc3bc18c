//! A contact in the interior point method, and its part in a Newton step.
//!
//! A model of friction allows impulses p = (σ, λ) with G p + h ≥ 0. The rows of G are (1, 0) for σ ≥ 0 and (κ, ±1) for
//! the two sides of friction; κ = μ if the bound grows with σ, and κ = 0 if the bound is lagged. With slacks
//! x = G p + h and multipliers y, the solution satisfies
//!
//! > (w, v) = Aᵀy,  x ≥ 0, y ≥ 0, x_k y_k = 0,
//!
//! where w includes the term added to v_n. A = G, except in Coulomb's law, where the sides of friction do not push
//! along the normal. With h now the change of (v_n, v_t) and D = diag(y/x), a Newton step for x_k y_k = e_k gives for
//! each contact
//!
//! > S δp = b − h,  S = AᵀD G + ε,  b = Aᵀ(e/x) − (w, v),
//! > δx = G δp,  δy = e/x − y − D δx,
//!
//! with a small compliance ε that keeps S regular. ε changes the path but not its end. On the cone, the two slacks can
//! replace p as variables, and S is diagonal in them.
//!
//! Slacks are separate variables with their own start values and steps. If they were recomputed from the impulses, or
//! updated by a difference of two changes, a small slack would be only rounding error. For the same reason velocity and
//! change are subtracted from the push one after the other.

use crate::contact::law;

/// Number of slacks of a contact: one for σ ≥ 0, and two for the sides of friction.
pub(super) const PAIRS: usize = 3;

/// The set of impulses that a model of friction allows.
pub(super) trait Shape {
    /// Index range of its slacks.
    const FIRST: usize;
    const END: usize;
    /// True if the two slacks of friction replace the impulses as variables.
    const CONE: bool;
    /// True if the sides of friction push only along the tangent although the bound grows with σ, as in Coulomb's law,
    /// whose problem is not convex.
    const LEANS: bool = false;
    /// ε, relative to the compliance of a contact of free bodies. If it were smaller, rounding in the factorisation
    /// would cancel the gain; if it were larger, impulses that only balance each other would move too little in a step.
    const COMPLIANCE: f64 = 1e-11;
}

/// 0 ≤ σ.
pub(super) enum HalfLine {}

impl Shape for HalfLine {
    const FIRST: usize = 0;
    const END: usize = 1;
    const CONE: bool = false;
}

/// 0 ≤ σ, |λ| ≤ g with a lagged g: `tresca`.
pub(super) enum Strip {}

impl Shape for Strip {
    const FIRST: usize = 0;
    const END: usize = 3;
    const CONE: bool = false;
}

/// |λ| ≤ μσ, with a lagged term added to v_n: `associated` and `desaxce`.
pub(super) enum Cone {}

impl Shape for Cone {
    const FIRST: usize = 1;
    const END: usize = 3;
    const CONE: bool = true;
}

/// 0 ≤ σ, |λ| ≤ μσ, the sides of friction pushing only along the tangent: Coulomb's law.
pub(super) enum Leaning {}

impl Shape for Leaning {
    const FIRST: usize = 0;
    const END: usize = 3;
    const CONE: bool = false;
    const LEANS: bool = true;
    // The unsymmetric factorisation inverts its diagonal blocks, which loses digits.
    const COMPLIANCE: f64 = 1e-8;
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PathContact {
    /// (σ, λ), m/s.
    pub impulse: [f64; 2],
    /// x, m/s.
    pub slack: [f64; PAIRS],
    /// y, m/s.
    pub multiplier: [f64; PAIRS],
    /// The lagged bound g, m/s.
    pub bound: f64,
    /// The lagged term added to w, m/s.
    pub lag: f64,
    /// (w, v) at the present impulses, m/s.
    pub velocity: [f64; 2],
    /// ε.
    pub compliance: f64,
    /// Change of an impulse, or of a slack on the cone, per velocity along it: the inverse of S in that direction.
    pub mobility: [f64; PAIRS],
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PathStep {
    pub impulse: [f64; 2],
    pub slack: [f64; PAIRS],
    pub multiplier: [f64; PAIRS],
}

/// Numbers common to all contacts.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactNumbers {
    /// κ.
    pub slope: f64,
    /// m_n/m_t.
    pub tangential_compliance: f64,
}

impl ContactNumbers {
    /// Compliance of a contact of free bodies along a slack of the cone, in which p moves by (1/κ, ±1)/2.
    fn along_slack(&self) -> f64 {
        0.25 * (1.0 / (self.slope * self.slope) + self.tangential_compliance)
    }

    /// The component of (v_n, v_t) along a variable of the shape: a slack of the cone, or else a component of p.
    #[inline(always)]
    fn along<S: Shape>(&self, pair: usize, [normal, tangential]: [f64; 2]) -> f64 {
        match (S::CONE, pair) {
            (false, 0) => normal,
            (false, _) => tangential,
            (true, 1) => 0.5 * (normal / self.slope + tangential),
            (true, _) => 0.5 * (normal / self.slope - tangential),
        }
    }
}

impl PathContact {
    /// End of this contact's index range: if the friction bound is 0, the sides of friction have no slacks.
    #[inline(always)]
    pub(super) fn end<S: Shape>(&self) -> usize {
        if !S::CONE && !S::LEANS && self.bound == 0.0 { 1 } else { S::END }
    }

    /// Computes the mobilities from slacks, multipliers and ε.
    #[inline(always)]
    pub(super) fn stiffen<S: Shape>(&mut self, numbers: ContactNumbers) {
        let ratio = |pair: usize| self.multiplier[pair] / self.slack[pair];
        let (compliance, tangential_compliance) = (self.compliance, numbers.tangential_compliance);
        self.mobility = if S::CONE {
            let along_slack = compliance * numbers.along_slack();
            [0.0, 1.0 / (ratio(1) + along_slack), 1.0 / (ratio(2) + along_slack)]
        } else if self.end::<S>() == 1 {
            [1.0 / (ratio(0) + compliance), 0.0, 0.0]
        } else {
            let tangential = ratio(1) + ratio(2) + tangential_compliance * compliance;
            [1.0 / (ratio(0) + compliance), 1.0 / tangential, 0.0]
        };
    }

    /// S⁻¹.
    #[inline(always)]
    pub(super) fn stiffness<S: Shape>(&self, numbers: ContactNumbers) -> [[f64; 2]; 2] {
        let [normal, one, other] = self.mobility;
        if S::CONE {
            let across = 0.25 / numbers.slope;
            let (sum, difference) = (one + other, across * (one - other));
            [[across / numbers.slope * sum, difference], [difference, 0.25 * sum]]
        } else if S::LEANS {
            [[normal, 0.0], [-self.lean(numbers) * one * normal, one]]
        } else {
            [[normal, 0.0], [0.0, one]]
        }
    }

    /// μ(y/x − y/x) of the two sides: the coupling from a change of σ to the tangent.
    #[inline(always)]
    fn lean(&self, numbers: ContactNumbers) -> f64 {
        let ratio = |pair: usize| self.multiplier[pair] / self.slack[pair];
        numbers.slope * (ratio(1) - ratio(2))
    }

    /// δp and δx of a step to `targets`, if (v_n, v_t) change by `change`.
    #[inline(always)]
    fn answer<S: Shape>(
        &self,
        numbers: ContactNumbers,
        targets: &[f64; PAIRS],
        change: [f64; 2],
    ) -> ([f64; 2], [f64; PAIRS]) {
        let push = |pair: usize| targets[pair] / self.slack[pair];
        let along = |pair| numbers.along::<S>(pair, self.velocity);
        let changed = |pair| numbers.along::<S>(pair, change);
        if S::CONE {
            let slack =
                |pair: usize| self.mobility[pair] * ((push(pair) - along(pair)) - changed(pair));
            let (one, other) = (slack(1), slack(2));
            let impulse = [0.5 * (one + other) / numbers.slope, 0.5 * (one - other)];
            return (impulse, [0.0, one, other]);
        }
        let normal = self.mobility[0] * ((push(0) - along(0)) - changed(0));
        if self.end::<S>() == 1 {
            return ([normal, 0.0], [normal, 0.0, 0.0]);
        }
        let force = (push(1) - push(2) - along(1)) - changed(1);
        if S::LEANS {
            // If the contact slides, x = μσ ± λ would be the small difference of two large changes.
            let ratio = |pair: usize| self.multiplier[pair] / self.slack[pair];
            let grown = numbers.slope * normal;
            let soft = numbers.tangential_compliance * self.compliance;
            let one = self.mobility[1] * (force + grown * (2.0 * ratio(2) + soft));
            let other = self.mobility[1] * (grown * (2.0 * ratio(1) + soft) - force);
            let tangential = self.mobility[1] * (force - self.lean(numbers) * normal);
            return ([normal, tangential], [normal, one, other]);
        }
        let tangential = self.mobility[1] * force;
        ([normal, tangential], [normal, tangential, -tangential])
    }

    /// S⁻¹b.
    #[inline(always)]
    pub(super) fn load<S: Shape>(
        &self,
        numbers: ContactNumbers,
        targets: &[f64; PAIRS],
    ) -> [f64; 2] {
        self.answer::<S>(numbers, targets, [0.0; 2]).0
    }

    /// The step that belongs to a change of (v_n, v_t).
    #[inline(always)]
    pub(super) fn direction<S: Shape>(
        &self,
        numbers: ContactNumbers,
        targets: &[f64; PAIRS],
        change: [f64; 2],
    ) -> PathStep {
        let (impulse, slack) = self.answer::<S>(numbers, targets, change);
        let mut direction = PathStep { impulse, slack, ..PathStep::default() };
        for pair in S::FIRST..self.end::<S>() {
            let (x, y) = (self.slack[pair], self.multiplier[pair]);
            direction.multiplier[pair] = (targets[pair] - y * slack[pair]) / x - y;
        }
        direction
    }

    /// The longest step length, up to 1, that keeps all slacks and multipliers non-negative.
    #[inline(always)]
    pub(super) fn longest<S: Shape>(&self, direction: &PathStep) -> f64 {
        let mut longest: f64 = 1.0;
        for pair in S::FIRST..self.end::<S>() {
            for (value, change) in [
                (self.slack[pair], direction.slack[pair]),
                (self.multiplier[pair], direction.multiplier[pair]),
            ] {
                if value + longest * change < 0.0 {
                    longest = -value / change;
                }
            }
        }
        longest
    }

    /// Takes a step of length `share`.
    #[inline(always)]
    pub(super) fn advance<S: Shape>(&mut self, direction: &PathStep, share: f64) {
        for (value, change) in self.impulse.iter_mut().zip(direction.impulse) {
            *value += share * change;
        }
        for pair in S::FIRST..self.end::<S>() {
            self.slack[pair] += share * direction.slack[pair];
            self.multiplier[pair] += share * direction.multiplier[pair];
        }
    }

    /// Places a contact on the path at x·y = `centre` (m²/s²), near the point that the natural map leads to; `trial` is
    /// (σ − w, λ − v m_t/m_n).
    ///
    /// With τ = `centre`: σ and its multiplier u must have the difference σ − u of the trial and the product τ, which
    /// gives a quadratic equation. With a lagged bound g, the smaller slack x and the larger slack 2g − x must make the
    /// velocity τ/x − τ/(2g − x). The second term is neglected, which again leaves a quadratic equation. On the cone
    /// the slacks of the nearest point and their multipliers are moved off 0 in the same way.
    pub(super) fn centre<S: Shape>(
        &mut self,
        numbers: ContactNumbers,
        trial: [f64; 2],
        centre: f64,
    ) {
        if S::CONE {
            return self.centre_on_cone(numbers, trial, centre);
        }
        let normal = positive_root(trial[0], centre);
        self.slack[0] = normal;
        self.multiplier[0] = centre / normal;
        self.impulse = [normal, 0.0];
        if self.end::<S>() == 1 {
            return;
        }
        let bound = if S::LEANS { numbers.slope * normal } else { self.bound };
        let across = trial[1].abs();
        let narrow =
            positive_root(bound - across, centre / numbers.tangential_compliance).min(bound);
        let wide = 2.0 * bound - narrow;
        let tangential = (bound - narrow).copysign(trial[1]);
        let slacks = if tangential > 0.0 { [wide, narrow] } else { [narrow, wide] };
        self.impulse[1] = tangential;
        self.slack[1..].copy_from_slice(&slacks);
        self.multiplier[1..].copy_from_slice(&slacks.map(|slack| centre / slack));
    }

    fn centre_on_cone(&mut self, numbers: ContactNumbers, trial: [f64; 2], centre: f64) {
        let ContactNumbers { slope, tangential_compliance, .. } = numbers;
        let nearest = law::nearest_on_cone(slope, tangential_compliance, trial);
        // (w, v) at the nearest point, and the multipliers that make them.
        let normal_velocity = nearest[0] - trial[0];
        let velocity = tangential_compliance * (nearest[1] - trial[1]);
        let together = (normal_velocity / slope).max(velocity.abs());
        let multipliers = [0.5 * (together + velocity), 0.5 * (together - velocity)];
        let slacks = [slope * nearest[0] + nearest[1], slope * nearest[0] - nearest[1]];
        for side in 0..2 {
            let slack = positive_root(slacks[side] - multipliers[side], centre);
            self.slack[side + 1] = slack;
            self.multiplier[side + 1] = centre / slack;
        }
        let [_, one, other] = self.slack;
        self.impulse = [0.5 * (one + other) / slope, 0.5 * (one - other)];
    }
}

/// The positive x with x − c/x = d.
#[inline(always)]
fn positive_root(difference: f64, product: f64) -> f64 {
    let root = (difference * difference + 4.0 * product).sqrt();
    if difference > 0.0 { 0.5 * (difference + root) } else { 2.0 * product / (root - difference) }
}
