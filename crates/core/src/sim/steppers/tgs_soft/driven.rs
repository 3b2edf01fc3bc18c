//! Walls that a force drives, among soft contacts: bodies of one speed V each (`solver::problem::driven`).
//!
//! In a substep such a wall goes with V_free = r (M V⁻ + hF), r = 1/(M + ch), and an impulse λ of one of its contacts
//! changes it by −r m_i (b_n λ_n + b_t λ_t) at once: the next contact of the sweep finds it as it goes then. With
//! κ = r m_i an impulse changes v_n by d_n λ_n, d_n = 1 + κb_n², and v_t by 3 d_t λ_t, d_t = 1 + κb_t²/3, so that a
//! contact's update is divided by them; its spring is that of its own mass, m_i/d_n.

use crate::sim::state::State;
use crate::sim::steppers::course::Works;
use crate::sim::steppers::touching::Touching;
use crate::sim::stepping::Stage;
use crate::solver::{DrivenRow, DrivenWall, Kinematics, Model, StepProblem};

impl Touching {
    /// Sees how its wall goes now, if that is driven.
    #[inline(always)]
    pub(super) fn see(&mut self, walls: &[DrivenWall]) {
        if let Some(DrivenRow { by, still, speed, .. }) = self.driven {
            let now = walls[by.wall as usize].now;
            self.wall_speed = speed + by.along[0] * now;
            self.surface_speed = still[1] + by.along[1] * now;
        }
    }

    /// Pushes its wall back by the impulses λ (m/s) on a grain of that mass, if that is driven.
    #[inline(always)]
    pub(super) fn push_back(&self, walls: &mut [DrivenWall], mass: f64, impulse: [f64; 2]) {
        if let Some(DrivenRow { by, .. }) = self.driven {
            let wall = &mut walls[by.wall as usize];
            wall.now -= wall.response * mass * by.part_along(impulse);
        }
    }
}

/// Begins a substep of such walls, of which contacts know from then on what they answer with. One that takes no time is
/// a blow.
pub(super) fn begin<M: Model>(
    stage: &Stage<'_, M>,
    contacts: &mut [Touching],
    substep_secs: f64,
) -> Vec<DrivenWall> {
    let State { world, walls, .. } = &*stage.state;
    let mut driven: Vec<DrivenWall> = walls.driven(world, substep_secs).collect();
    driven.iter_mut().for_each(|wall| wall.now = wall.free);
    answer::<M::Kinematics>(stage.problem, contacts, &driven);
    driven
}

/// Tells contacts d_n and d_t.
fn answer<K: Kinematics>(
    problem: &StepProblem<K>,
    contacts: &mut [Touching],
    walls: &[DrivenWall],
) {
    for (row, contact) in problem.fixed_rows.iter().zip(contacts) {
        if let Some(DrivenRow { by, .. }) = contact.driven {
            let share = walls[by.wall as usize].response * row.effective_mass;
            let [normal, tangential] = by.along.map(|along| share * along * along);
            contact.answers = [1.0 + normal, 1.0 + tangential / K::TANGENTIAL_COMPLIANCE];
        }
    }
}

/// Has the walls go on as a sweep has left them, and gives the work of what drives them since the substep began, J.
pub(super) fn take<M: Model>(
    stage: &mut Stage<'_, M>,
    contacts: &mut [Touching],
    driven: &[DrivenWall],
) -> f64 {
    contacts.iter_mut().for_each(|contact| contact.see(driven));
    let State { world, walls, .. } = &mut *stage.state;
    walls.take_driven(world, driven)
}

/// Takes off what contacts told of the work of walls with their last speed in a substep, since they had the mean one.
pub(super) fn correct_works<K: Kinematics>(
    problem: &StepProblem<K>,
    contacts: &[Touching],
    walls: &[DrivenWall],
    works: &mut Works,
) {
    for (row, contact) in problem.fixed_rows.iter().zip(contacts) {
        if let Some(DrivenRow { by, .. }) = contact.driven {
            let wall = &walls[by.wall as usize];
            let along = by.part_along(contact.impulse);
            let gained = wall.now - wall.before;
            works.add_of_driven_wall(-0.5 * row.effective_mass * along * gained);
        }
    }
}
