//! A contact in the interior point method, and its contribution to a Newton step.
//!
//! A friction model allows the impulses p = (σ, λ) with G p + h ≥ 0: σ is the shifted normal impulse (normal impulse
//! plus the largest impulse of cohesion, so that it is never negative) and λ the tangential impulse, both divided by
//! the effective mass, m/s. The matrix G has the row (1, 0) for σ ≥ 0, and the rows (κ, ±1) for the two bounds of
//! friction. If the friction bound grows with σ, the slope κ is the friction coefficient μ and h = 0; if the bound g
//! stays fixed during the solve, κ = 0 and h is g in the rows of friction. With slacks x = G p + h and multipliers y,
//! one of each per row k of G, the solution satisfies
//!
//! > (w, v) = Aᵀy,  x ≥ 0, y ≥ 0, x_k y_k = 0,
//!
//! where w is the normal velocity plus the restitution term (restitution times the normal velocity before the step)
//! and, under `desaxce`, plus an opening speed that stays fixed during a solve. v is the tangential velocity, m/s. A =
//! G, except in Coulomb's law, where the multipliers of friction have no component along the normal. A Newton step aims
//! at products x_k y_k equal to the targets e_k. Let δp, δx and δy be the changes of p, x and y in the step, δu the
//! change of the contact's velocity (v_n, v_t), and D the diagonal matrix of the ratios y_k/x_k. The step satisfies for
//! each contact
//!
//! > S δp = b − δu,  S = AᵀD G + ε,  b = Aᵀ(e/x) − (w, v),
//! > δx = G δp,  δy = e/x − y − D δx,
//!
//! with a small compliance ε that keeps S regular. ε changes the path of the iterates but not the solution. If the
//! allowed impulses form a cone, |λ| ≤ μσ, the slacks of its two sides can replace p as variables, and S is diagonal in
//! them.
//!
//! Slacks are separate variables with their own initial values and steps. If they were recomputed from the impulses, or
//! updated by a difference of two changes, a small slack would be only rounding error. For the same reason the velocity
//! (w, v) and its change δu are subtracted from e/x one after the other.

use crate::contact::law;

/// Number of slacks of a contact: one for the condition that the normal impulse plus cohesion impulse is not negative,
/// and two for the two bounds of the tangential impulse. A slack is the distance from such a bound.
pub(super) const PAIRS: usize = 3;

/// The set of impulses that a friction model allows at a contact, as constraints with slacks (distances from the bounds
/// of the constraints). The impulses are the shifted normal impulse σ (normal impulse plus the largest impulse of
/// cohesion, so that it is never negative) and the tangential impulse λ, both divided by the effective mass, m/s.
pub(super) trait Shape {
    /// Index of the first slack that a contact with this set of impulses uses. There are three slacks: slack 0 is the
    /// distance of the normal impulse plus cohesion impulse from 0, and slacks 1 and 2 are the distances of the
    /// tangential impulse from its two bounds.
    const FIRST: usize;
    /// Index after the last slack that a contact with this set of impulses uses. There are three slacks, which are the
    /// distances of the impulses from their bounds.
    const END: usize;
    /// True if the Newton steps use two slacks as variables instead of the normal and tangential impulse: the distances
    /// of the tangential impulse from its two bounds.
    const CONE: bool;
    /// True for Coulomb's law: the friction bound grows with the normal impulse, but the multipliers of the friction
    /// bounds are velocities along the tangent only, so that a sliding contact does not open. The problem is then not
    /// convex.
    const LEANS: bool = false;
    /// Regularisation ε: a compliance added to each contact, relative to the compliance of a contact whose bodies touch
    /// nothing else. With a smaller ε, rounding errors in the factorisation would cost as much accuracy as the smaller
    /// ε gains. With a larger ε, impulses that only balance each other would change too little in a step.
    const COMPLIANCE: f64 = 1e-11;
}

/// Allowed impulses of a contact without friction: the shifted normal impulse σ (normal impulse plus the largest
/// impulse of cohesion) is at least 0.
pub(super) enum HalfLine {}

impl Shape for HalfLine {
    const FIRST: usize = 0;
    const END: usize = 1;
    const CONE: bool = false;
}

/// Allowed impulses of the friction model `tresca`: σ ≥ 0 for the shifted normal impulse σ (normal impulse plus the
/// largest impulse of cohesion), and |λ| ≤ g for the tangential impulse λ, with a friction bound g that stays fixed
/// during a solve.
pub(super) enum Strip {}

impl Shape for Strip {
    const FIRST: usize = 0;
    const END: usize = 3;
    const CONE: bool = false;
}

/// Allowed impulses of the friction models `associated` and `desaxce`: |λ| ≤ μσ, with the tangential impulse λ, the
/// friction coefficient μ and the shifted normal impulse σ (normal impulse plus the largest impulse of cohesion, so
/// that it is never negative). `desaxce` also adds an opening speed, which is estimated before a solve and stays fixed
/// during it, to the normal velocity of the contact.
pub(super) enum Cone {}

impl Shape for Cone {
    const FIRST: usize = 1;
    const END: usize = 3;
    const CONE: bool = true;
}

/// Allowed impulses of Coulomb's law: σ ≥ 0 for the shifted normal impulse σ (normal impulse plus the largest impulse
/// of cohesion), and |λ| ≤ μσ for the tangential impulse λ, with the friction coefficient μ. The multipliers of the two
/// bounds of λ are velocities along the tangent only, so that a sliding contact does not open.
pub(super) enum Leaning {}

impl Shape for Leaning {
    const FIRST: usize = 0;
    const END: usize = 3;
    const CONE: bool = false;
    const LEANS: bool = true;
    // ε is larger than for the other sets: the matrix is unsymmetric, so its factorisation inverts the diagonal
    // blocks, which loses digits.
    const COMPLIANCE: f64 = 1e-8;
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PathContact {
    /// Shifted normal impulse σ (normal impulse plus the largest impulse of cohesion, so that it is never negative) and
    /// tangential impulse λ, both divided by the effective mass, m/s.
    pub impulse: [f64; 2],
    /// Slacks of the constraints, m/s, in the unit of impulses divided by the effective mass: the distance of the
    /// normal impulse plus cohesion impulse from 0, and the distances of the tangential impulse from its two bounds.
    pub slack: [f64; PAIRS],
    /// Multipliers of the constraints, m/s, in the order of `slack`: first of the condition that the normal impulse
    /// plus cohesion impulse is not negative, then of the two bounds of the tangential impulse. The product of a
    /// multiplier and its slack is 0 at the solution.
    pub multiplier: [f64; PAIRS],
    /// Largest tangential impulse under `tresca`, divided by the effective mass, m/s. It stays fixed during a solve. 0
    /// for the models whose friction bound grows with the normal impulse.
    pub bound: f64,
    /// Opening speed, m/s, that the friction model `desaxce` adds to the normal velocity of the contact. It is
    /// estimated before a solve and stays fixed during it. 0 for all other models.
    pub lag: f64,
    /// Velocities (w, v) at the present impulses, m/s: w is the normal velocity plus the opening speed `lag` and the
    /// restitution term (restitution times the normal velocity before the step), v is the tangential velocity.
    pub velocity: [f64; 2],
    /// Regularisation ε of this contact, relative to the compliance of a contact whose bodies touch nothing else.
    pub compliance: f64,
    /// Mobility of each variable of the Newton step, dimensionless: its decrease per increase of the contact's velocity
    /// in the direction of the variable, if the other variables do not change. The variables are the normal and
    /// tangential impulse, whose directions are the normal and the tangent, or on the friction cone the slacks of the
    /// two friction bounds (distances from the bounds), whose directions combine normal and tangent. The mobility is
    /// the inverse of a diagonal entry of the matrix that maps changes of the variables to the negative changes of the
    /// velocities.
    pub mobility: [f64; PAIRS],
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PathStep {
    pub impulse: [f64; 2],
    pub slack: [f64; PAIRS],
    pub multiplier: [f64; PAIRS],
}

/// Slope of the friction bound and ratio of the effective masses, which are the same for all contacts of a solve.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactNumbers {
    /// Slope of the friction bound: the friction coefficient μ if the bound grows with the normal impulse, and 0 if the
    /// bound stays fixed during a solve.
    pub slope: f64,
    /// Ratio m_n/m_t of the effective masses along normal and tangent.
    pub tangential_compliance: f64,
}

impl ContactNumbers {
    /// Returns the compliance of a contact along one slack of its friction cone |λ| ≤ κσ, (1/κ² + m_n/m_t)/4,
    /// dimensionless, with the normal impulse σ, the tangential impulse λ, the slope κ, and the effective masses m_n
    /// and m_t along normal and tangent. The bodies of the contact touch nothing else. The slacks are κσ + λ and κσ −
    /// λ. If one slack grows by 1 and the other does not change, (σ, λ) changes by (1/κ, ±1)/2.
    fn along_slack(&self) -> f64 {
        0.25 * (1.0 / (self.slope * self.slope) + self.tangential_compliance)
    }

    /// Returns the velocity that belongs to the variable with index `pair` of the Newton step, m/s: the scalar product
    /// of the normal and tangential velocity (v_n, v_t) and the change of the normal and tangential impulse per change
    /// of the variable. If the allowed impulses form a cone, variables 1 and 2 are the slacks of the two friction
    /// bounds; otherwise variable 0 is the normal and variable 1 the tangential impulse.
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
    /// Returns the index after the last slack that this contact uses. With a fixed friction bound of 0, only slack 0 is
    /// used, which belongs to the normal impulse, because the tangential impulse is 0.
    #[inline(always)]
    pub(super) fn end<S: Shape>(&self) -> usize {
        if !S::CONE && !S::LEANS && self.bound == 0.0 { 1 } else { S::END }
    }

    /// Computes `mobility`, the response of the contact's impulses (or slacks, if the allowed impulses form a cone) to
    /// changes of its velocity in a Newton step, from the slacks, multipliers and regularisation of the contact.
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

    /// Returns the matrix S⁻¹ of the contact in a Newton step, 2×2, dimensionless: if the contact's normal and
    /// tangential velocity change by δu, its normal and tangential impulse, divided by the effective mass, change by
    /// −S⁻¹ δu.
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

    /// Returns μ (y₁/x₁ − y₂/x₂), dimensionless, with the friction coefficient μ, and the slacks x (m/s) and
    /// multipliers y (m/s) of the two bounds of friction. Under Coulomb's law this is an off-diagonal entry of the
    /// contact's matrix S in the Newton step, which maps changes of impulses to the negative changes of velocities: it
    /// couples the tangential velocity to the normal impulse.
    #[inline(always)]
    fn lean(&self, numbers: ContactNumbers) -> f64 {
        let ratio = |pair: usize| self.multiplier[pair] / self.slack[pair];
        numbers.slope * (ratio(1) - ratio(2))
    }

    /// Returns the changes of the impulses and of the slacks, m/s, in a Newton step that aims at the products `targets`
    /// of slacks and multipliers, (m/s)², if the normal and tangential velocity change by `change`, m/s.
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
            // If the contact slides, the change of the slack μσ ± λ would be the small difference of two large changes.
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

    /// Returns the change of the impulses in a Newton step if the velocities of the bodies did not change, m/s.
    /// `targets` are the products of slacks and multipliers at which the step aims, (m/s)².
    #[inline(always)]
    pub(super) fn load<S: Shape>(
        &self,
        numbers: ContactNumbers,
        targets: &[f64; PAIRS],
    ) -> [f64; 2] {
        self.answer::<S>(numbers, targets, [0.0; 2]).0
    }

    /// Returns the Newton step of impulses, slacks and multipliers, m/s, that follows from the change `change` of the
    /// normal and tangential velocity, m/s. `targets` are the products of slacks and multipliers at which the step
    /// aims, (m/s)².
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

    /// Returns the longest step length, up to 1, that keeps all slacks and multipliers non-negative.
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

    /// Adds a step, multiplied by the step length `share`, to impulses, slacks and multipliers.
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

    /// Moves the contact's impulses, slacks and multipliers to the central path of the interior point method: every
    /// product of a slack and its multiplier becomes `centre`, (m/s)². The chosen point of the path is near the
    /// impulses to which the friction model would project `trial`, the normal and tangential trial impulses, m/s. A
    /// trial impulse is the present impulse divided by the effective mass, minus the velocity; along the tangent this
    /// velocity is multiplied by m_t/m_n, with the effective masses m_n and m_t along normal and tangent.
    ///
    /// Let τ = `centre`. The new normal impulse plus cohesion impulse σ and its multiplier u must have the product τ,
    /// and the difference σ − u must be the normal trial impulse. These two conditions give a quadratic equation. Let g
    /// be the friction bound, which is fixed or, under Coulomb's law, follows from σ. The multipliers of the smaller
    /// slack x of the tangential impulse and of its larger slack 2g − x must differ by the tangential velocity at the
    /// new point: τ/x − τ/(2g − x) = (m_n/m_t) (t − (g − x)), with the magnitude t of the tangential trial impulse and
    /// the magnitude g − x of the new one. The second term is neglected, which again leaves a quadratic equation. If
    /// the allowed impulses form a cone, the slacks at the point of the cone that is nearest to the trial impulses, and
    /// their multipliers, are moved away from 0 by the same quadratic equation.
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
        // Normal and tangential velocity, m/s, at the nearest point of the cone, and the multipliers that belong to it.
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

/// Returns the positive solution x of x − c/x = d, with c = `product` and d = `difference`.
#[inline(always)]
fn positive_root(difference: f64, product: f64) -> f64 {
    let root = (difference * difference + 4.0 * product).sqrt();
    if difference > 0.0 { 0.5 * (difference + root) } else { 2.0 * product / (root - difference) }
}
