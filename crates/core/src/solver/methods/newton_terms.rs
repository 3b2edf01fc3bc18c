//! The linear equations of a step of Newton's method (`newton`): predicted states of contacts (open, stick or slip),
//! and the contributions of contacts to the equations of bodies.

use crate::contact::ContactLaw;
use crate::solver::kinematics::Model;
use crate::solver::problem::{Rolling, Row};

/// Predicted state of a contact at the end of a Newton step. For a rolling moment, `Stick` means below its bound and
/// `Slip` at its bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Guess {
    Open,
    Stick,
    /// The contact slips: the tangential impulse is at its bound. The number is the sign of the impulse, 1 or −1, or 0
    /// if the bound itself is 0.
    Slip(f64),
}

impl Guess {
    /// Predicts the state of a contact from trial impulses, which are not yet projected on the contact law: `shifted`
    /// is the normal impulse plus the largest impulse of cohesion, which is never negative under the contact law,
    /// although the trial impulse can be; `trial` is the tangential or the rolling impulse, and `bound` is the largest
    /// |`trial`| that `shifted` allows. All are divided by the effective mass, m/s.
    fn new(shifted: f64, trial: f64, bound: f64) -> Self {
        if shifted <= 0.0 {
            return Self::Open;
        }
        if bound == 0.0 {
            return Self::Slip(0.0);
        }
        if trial.abs() <= bound { Self::Stick } else { Self::Slip(trial.signum()) }
    }
}

/// Predicts the state of a contact at the end of a Newton step, from its present impulses and its normal and tangential
/// velocity, m/s.
pub(super) fn guess<M: Model>(
    law: &ContactLaw,
    row: &Row<M>,
    [normal_velocity, tangential_velocity]: [f64; 2],
) -> Guess {
    let shifted = row.shifted_impulse - normal_velocity - row.restitution_velocity;
    let bound = if M::FRICTION { law.friction_bound(shifted) } else { 0.0 };
    let compliance = 1.0 / M::TANGENTIAL_COMPLIANCE;
    Guess::new(shifted, row.tangential_impulse - compliance * tangential_velocity, bound)
}

/// Predicts the state of a contact's rolling moment from the contact's normal velocity and rolling velocity (`speed`),
/// m/s.
pub(super) fn guess_rolling<M: Model>(
    law: &ContactLaw,
    row: &Row<M>,
    normal_velocity: f64,
    rolling: &Rolling,
    speed: f64,
) -> Guess {
    let shifted = row.shifted_impulse - normal_velocity - row.restitution_velocity;
    let trial = rolling.impulse - speed / rolling.compliance;
    Guess::new(shifted, trial, rolling.bound(law, shifted))
}

/// Data of a contact's rolling moment in a Newton step: its law and impulse (`rolling`), the rolling velocity (`speed`,
/// m/s), the predicted state (`guess`), and the regularisation of the step (`compliance`, relative to the compliance
/// 1/m_ij of a contact with the effective mass m_ij).
pub(super) struct RollingTerms<'a> {
    pub rolling: &'a Rolling,
    pub speed: f64,
    pub guess: Guess,
    pub compliance: f64,
}

/// Contribution of a contact to the linear equations of one of its bodies in a Newton step.
pub(super) struct Terms<const D: usize> {
    /// Gradient of the contact's normal velocity v_n with respect to the body's velocity.
    normal: [f64; D],
    /// Gradient of the contact's tangential velocity v_t with respect to the body's velocity.
    tangent: [f64; D],
    /// Gradient of the contact's rolling velocity v_r with respect to the body's velocity; 0 without rolling friction.
    rolling: [f64; D],
    /// Direction of the impulse with which the contact responds to a change of its normal velocity: the normal n, or n
    /// ± μt if the contact slips (tangent t, friction coefficient μ). If the rolling moment is at its bound, ±μ_r times
    /// the gradient of the rolling velocity is added (coefficient of rolling friction μ_r).
    answer: [f64; D],
    /// Normal stiffness of the contact, kg: its impulse (N·s) in the direction `answer` per change of its normal
    /// velocity (m/s), with a minus sign; 0 if the contact is open.
    normal_stiffness: f64,
    /// Tangential stiffness of the contact, kg: its tangential impulse (N·s) per change of its tangential velocity
    /// (m/s), with a minus sign; 0 unless the contact sticks.
    tangential_stiffness: f64,
    /// Rolling stiffness of the contact, kg: its rolling impulse (N·s) per change of its rolling velocity (m/s), with a
    /// minus sign; 0 unless the rolling moment is below its bound.
    rolling_stiffness: f64,
    /// Right-hand side of the body's equations, kg·m/s: the change of the contact's impulse on the body that the
    /// regularised contact law requires at the present velocities.
    load: [f64; D],
}

impl<const D: usize> Terms<D> {
    #[inline(always)]
    pub(super) fn new<M: Model>(
        law: &ContactLaw,
        row: &Row<M>,
        [normal_velocity, tangential_velocity]: [f64; 2],
        guess: Guess,
        compliance: f64,
        gradients: &[[f64; 3]; 2],
    ) -> Self {
        let part = |vector: &[f64; 3]| std::array::from_fn::<f64, D, _>(|axis| vector[axis]);
        let (normal, tangent) = (part(&gradients[0]), part(&gradients[1]));
        let mass = row.effective_mass;
        let stiffness = mass / compliance;
        let (shifted, tangential) = (row.shifted_impulse, row.tangential_impulse);
        let normal_change = -(normal_velocity + row.restitution_velocity) / compliance;
        let (slope, normal_stiffness, tangential_stiffness, changes) = match guess {
            Guess::Open => (0.0, 0.0, 0.0, [-shifted, -tangential]),
            Guess::Stick => {
                let softness = M::TANGENTIAL_COMPLIANCE;
                let tangential_change = -tangential_velocity / (softness * compliance);
                (0.0, stiffness, stiffness / softness, [normal_change, tangential_change])
            }
            Guess::Slip(sign) => {
                let slope = sign * law.friction;
                let rubbing = law.rubbing(shifted + normal_change);
                (slope, stiffness, 0.0, [normal_change, slope * rubbing - tangential])
            }
        };
        let [normal_load, tangential_load] = changes.map(|change| mass * change);
        Self {
            normal,
            tangent,
            rolling: [0.0; D],
            rolling_stiffness: 0.0,
            answer: std::array::from_fn(|axis| normal[axis] + slope * tangent[axis]),
            normal_stiffness,
            tangential_stiffness,
            load: std::array::from_fn(|axis| {
                normal_load * normal[axis] + tangential_load * tangent[axis]
            }),
        }
    }

    /// Adds the rolling moment of a contact to the contribution of the same contact to the equations of one of its
    /// bodies: body j if `on_j` is set, otherwise body i. The contact has the normal velocity `normal_velocity`, m/s.
    #[inline(always)]
    pub(super) fn add_rolling<M: Model>(
        &mut self,
        law: &ContactLaw,
        row: &Row<M>,
        normal_velocity: f64,
        RollingTerms { rolling, speed, guess, compliance }: &RollingTerms<'_>,
        on_j: bool,
    ) {
        let gradient = rolling.gradient(on_j);
        self.rolling = std::array::from_fn(|axis| gradient[axis]);
        let softness = rolling.compliance * compliance;
        let (slope, change) = match guess {
            Guess::Open => (0.0, -rolling.impulse),
            Guess::Stick => {
                self.rolling_stiffness = row.effective_mass / softness;
                (0.0, -speed / softness)
            }
            Guess::Slip(sign) => {
                let slope = sign * rolling.friction;
                let normal_change = -(normal_velocity + row.restitution_velocity) / compliance;
                let rubbing = law.rubbing(row.shifted_impulse + normal_change);
                (slope, slope * rubbing - rolling.impulse)
            }
        };
        for axis in 0..D {
            self.answer[axis] += slope * self.rolling[axis];
            self.load[axis] += row.effective_mass * change * self.rolling[axis];
        }
    }

    /// Adds to `block` the stiffness by which a contact couples the equations of the body of `self` to the velocity of
    /// the body of `other`. Both are contributions of the same contact; for the diagonal block of a body they are the
    /// same contribution.
    #[inline(always)]
    pub(super) fn add<M: Model>(&self, block: &mut [[f64; D]; D], other: &Self) {
        for (row, entries) in block.iter_mut().enumerate() {
            let normal = self.normal_stiffness * self.answer[row];
            let tangential = self.tangential_stiffness * self.tangent[row];
            for (column, entry) in entries.iter_mut().enumerate() {
                *entry += normal * other.normal[column] + tangential * other.tangent[column];
                if M::ROLLING {
                    *entry += self.rolling_stiffness * self.rolling[row] * other.rolling[column];
                }
            }
        }
    }

    #[inline(always)]
    pub(super) fn add_load(&self, vector: &mut [f64; D]) {
        for (entry, load) in vector.iter_mut().zip(self.load) {
            *entry += load;
        }
    }
}
