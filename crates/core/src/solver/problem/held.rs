//! Models of friction that hold something while a step is solved, which makes the problem convex.
//!
//! With w = v_n + ρ v_n^{n−1} and v = v_t of a contact, in reduced impulses (`contact::law`):
//!
//! * `tresca`: 0 ≤ σ ⟂ w ≥ 0 and λ_t = clamp(λ_t − v m_t/m_n, ±g). Held is g, Coulomb's bound at the σ of
//!   the contact's last solve. A contact that has not been solved yet has no such σ, and gets Coulomb's bound
//!   within its first solve (P. D. Panagiotopoulos, 1975, solved Coulomb's law by such problems).
//! * `associated`: K ∋ (σ, λ_t) ⟂ (w, v) ∈ K* with K = {|λ_t| ≤ μσ} (M. Anitescu, 2006; A. Tasora and
//!   M. Anitescu, 2011). Where it slides, w = μ|v|: a contact opens that ought to stay closed.
//! * `desaxce`: the same with w + s in the place of w. With s = μ|v| of the solution that would be Coulomb's
//!   law (G. de Saxcé and Z.-Q. Feng, 1998; V. Acary and others, 2011); held is s of the solve before, at
//!   first that of the velocities that the step begins with.
//!
//! In each the impulses of a contact are the point nearest to (σ − w − s, λ_t − v m_t/m_n) of a convex set, in
//! the metric diag(1, m_n/m_t). That is Gauss–Seidel's update of a solid disc's contact, whose Delassus
//! block is diagonal, and the natural map.

use super::kinematics::Kinematics;
use super::model::Model;
use super::step_problem::StepProblem;
use crate::contact::{ContactList, law};
use crate::solver::friction_model::FrictionModel;

/// What stands for g of a contact that has not been solved yet.
const COULOMBS_BOUND: f64 = f64::INFINITY;

/// The numbers of the contact law that all rows share.
#[derive(Clone, Copy)]
pub(crate) struct LawNumbers {
    /// μ.
    friction: f64,
    /// C₀Δt/m_ij, m/s.
    capture_speed: f64,
}

impl LawNumbers {
    /// Those of a problem.
    pub(crate) fn of<K: Kinematics>(problem: &StepProblem<K>) -> Self {
        Self { friction: problem.friction, capture_speed: problem.capture_speed }
    }
}

/// A way to hold friction.
pub(crate) trait Held {
    /// The (σ, λ_t) that are allowed nearest to `trial`, in the metric diag(1, m_n/m_t).
    fn project<M: Model>(law: LawNumbers, held: f64, trial: [f64; 2]) -> [f64; 2];

    /// What is held of a contact after a solve that came to this σ and v_t.
    fn after<M: Model>(law: LawNumbers, shifted_impulse: f64, tangential_velocity: f64) -> f64;
}

/// `tresca`: held is the bound.
pub(crate) enum Bound {}

impl Held for Bound {
    #[inline(always)]
    fn project<M: Model>(law: LawNumbers, held: f64, [normal, tangential]: [f64; 2]) -> [f64; 2] {
        let shifted = law::signorini(normal);
        let bound = if held == COULOMBS_BOUND {
            M::friction_bound(law.friction, shifted, law.capture_speed)
        } else {
            held
        };
        [shifted, law::coulomb(tangential, bound)]
    }

    #[inline(always)]
    fn after<M: Model>(law: LawNumbers, shifted_impulse: f64, _: f64) -> f64 {
        M::friction_bound(law.friction, shifted_impulse, law.capture_speed)
    }
}

/// `associated` and `desaxce`: held is what is added to w.
pub(crate) enum Opening {}

impl Held for Opening {
    #[inline(always)]
    fn project<M: Model>(numbers: LawNumbers, held: f64, trial: [f64; 2]) -> [f64; 2] {
        let compliance = M::Kinematics::TANGENTIAL_COMPLIANCE;
        law::nearest_on_cone(numbers.friction, compliance, [trial[0] - held, trial[1]])
    }

    #[inline(always)]
    fn after<M: Model>(law: LawNumbers, _: f64, tangential_velocity: f64) -> f64 {
        law.friction * tangential_velocity.abs()
    }
}

impl<K: Kinematics> StepProblem<K> {
    /// Says by which model a problem is to be solved whose rows are there, and what its contacts hold.
    pub(super) fn hold<M: Model<Kinematics = K>>(
        &mut self,
        contacts: &ContactList,
        model: FrictionModel,
    ) {
        self.friction_model = model;
        let mut held = std::mem::take(&mut self.held_at_start);
        held.clear();
        match model {
            _ if !M::FRICTION => {}
            FrictionModel::Coulomb => {}
            FrictionModel::Tresca => {
                held.extend(self.rows().map(|(number, row)| {
                    let index = self.contact_of_row[number] as usize;
                    if contacts.is_unsolved(index) {
                        return COULOMBS_BOUND;
                    }
                    let normal_impulse = contacts.impulses()[index].normal / row.effective_mass;
                    let shifted = law::signorini(normal_impulse + self.capture(number));
                    self.friction_bound::<M>(shifted)
                }));
            }
            FrictionModel::Associated => held.resize(self.contact_of_row.len(), 0.0),
            FrictionModel::Desaxce => {
                let law = LawNumbers::of(self);
                self.for_each_velocity(&self.before, |row, [_, tangential]| {
                    held.push(Opening::after::<M>(law, row.shifted_impulse, tangential));
                });
            }
        }
        self.held_at_start = held;
        self.hold_as_at_start();
    }

    /// Has contacts hold what they hold as the step begins.
    pub(crate) fn hold_as_at_start(&mut self) {
        self.held.clone_from(&self.held_at_start);
    }

    /// Has friction bounded by what Coulomb's law allows at the present impulses.
    pub(crate) fn bound_by_present<M: Model<Kinematics = K>>(&mut self) {
        self.friction_model = FrictionModel::Tresca;
        self.hold_after::<M, Bound>();
    }

    /// Goes back to Coulomb's law.
    pub(crate) fn forget_bounds(&mut self) {
        self.friction_model = FrictionModel::Coulomb;
        self.held.clear();
    }

    /// Whether contacts are to be bounded that have not been solved yet.
    pub(crate) fn has_new_bounds(&self) -> bool {
        self.friction_model == FrictionModel::Tresca && self.held.contains(&COULOMBS_BOUND)
    }

    /// Gives such contacts Coulomb's bounds at the present impulses, for all solves of the step.
    pub(crate) fn fix_new_bounds<M: Model<Kinematics = K>>(&mut self) {
        let mut held = std::mem::take(&mut self.held);
        for ((_, row), held) in self.rows().zip(&mut held) {
            if *held == COULOMBS_BOUND {
                *held = self.friction_bound::<M>(row.shifted_impulse);
            }
        }
        self.held = held;
    }

    /// Takes anew what contacts hold, from the present impulses and velocities.
    pub(crate) fn hold_anew<M: Model<Kinematics = K>>(&mut self) {
        match self.friction_model {
            FrictionModel::Tresca => self.hold_after::<M, Bound>(),
            FrictionModel::Desaxce => self.hold_after::<M, Opening>(),
            FrictionModel::Coulomb | FrictionModel::Associated => {}
        }
    }

    fn hold_after<M: Model<Kinematics = K>, H: Held>(&mut self) {
        let mut held = std::mem::take(&mut self.held);
        held.clear();
        let law = LawNumbers::of(self);
        self.for_each_velocity(&self.bodies, |row, [_, tangential]| {
            held.push(H::after::<M>(law, row.shifted_impulse, tangential));
        });
        self.held = held;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::problem::{Plane, SpinningPlane, StepModel};

    type Turning = StepModel<SpinningPlane, true, false>;

    /// ½(σ − a)² + ½c(λ − b)².
    fn distance<M: Model>(point: [f64; 2], trial: [f64; 2]) -> f64 {
        let across = M::Kinematics::TANGENTIAL_COMPLIANCE * (point[1] - trial[1]).powi(2);
        0.5 * ((point[0] - trial[0]).powi(2) + across)
    }

    fn no_point_of_the_cone_is_nearer<M: Model>() {
        let law = LawNumbers { friction: 0.7, capture_speed: 0.0 };
        for step in 0..48 {
            let angle = std::f64::consts::TAU * (f64::from(step) + 0.5) / 48.0;
            let trial = [angle.cos(), angle.sin()];
            let found = Opening::project::<M>(law, 0.0, trial);
            assert!(found[1].abs() <= law.friction * found[0] + 1e-15, "{trial:?}: {found:?}");
            let least = distance::<M>(found, trial);
            for up in 0..200 {
                let shifted = 0.02 * f64::from(up);
                for share in -20..=20 {
                    let point = [shifted, law.friction * shifted * f64::from(share) / 20.0];
                    let other = distance::<M>(point, trial);
                    assert!(other >= least - 1e-15, "{trial:?}: {point:?} beats {found:?}");
                }
            }
        }
    }

    #[test]
    fn the_projection_on_the_cone_is_the_nearest_point_in_its_metric() {
        no_point_of_the_cone_is_nearer::<Turning>();
        no_point_of_the_cone_is_nearer::<StepModel<Plane, true, false>>();
    }

    #[test]
    fn a_bound_is_held_but_for_contacts_that_have_none_yet() {
        let law = LawNumbers { friction: 0.5, capture_speed: 0.0 };
        assert_eq!(Bound::project::<Turning>(law, 0.3, [4.0, -9.0]), [4.0, -0.3]);
        assert_eq!(Bound::project::<Turning>(law, 0.3, [-4.0, 9.0]), [0.0, 0.3]);
        assert_eq!(Bound::project::<Turning>(law, COULOMBS_BOUND, [4.0, -9.0]), [4.0, -2.0]);
    }
}
