//! Passes the results of the shocks (instantaneous collisions at the beginning of a step) on to the contact problem of
//! the step.

use glam::DVec2;

use super::{NextImpact, ShockInputs, ShockPair, Shocks, Touch, along_normal, grains};
use crate::contact::{Candidates, ContactList, Impulse};
use crate::number::Parts;
use crate::sim::steppers::range::step_numbers::StepNumbers;
use crate::solver::{Model, StepProblem};
use crate::world::World;

/// Bond that a shock (a collision that is solved in zero time) within the step has formed, or whose gap a shock has
/// made close.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct ClosedBond {
    /// Fraction of the time step that is left after the shock (collision) that has formed the bond or has made its gap
    /// close.
    pub part: f64,
    /// Normal velocity that gravity and other external forces had added, between the beginning of the step and the
    /// shock (collision), to a grain that falls on a fixed body, m/s; 0 for other pairs.
    pub gained: f64,
}

impl Shocks {
    /// Changes the contact problem of a step so that it continues from the shocks (instantaneous collisions). Bodies
    /// begin with their velocities v⁺ after the shocks. Each contact may close a gap that is computed backwards: the
    /// gap that the pair would have had at the beginning of the step, if its bodies had moved with their present
    /// velocities since then.
    ///
    /// **Grains that pass by.** The constraint on a gap uses the contact normal at the beginning of the step, so it
    /// stops a grain that would have passed another grain. If the constraint would act although the two grains do not
    /// meet, the code replaces it by a constraint with the normal and the gap that the pair will have at the end of the
    /// step. Then the velocities v⁺ satisfy the constraints of all contacts.
    ///
    /// **No contact has to open.** A pair that was struck at the time t has the normal velocity v_n⁺ from then on, as
    /// if it had opened from a gap of −t v_n⁺ since the beginning of the step. To end the step without any overlap, its
    /// normal velocity v_n at the end of the step would have to be above 0, but other contacts that confine the pair
    /// may not allow that. Then velocities of 0 would no longer satisfy the constraints of all contacts, and a cluster
    /// with many struck contacts would often have no solution. So only v_n ≥ 0 is required, and the remaining overlap
    /// of at most t v_n⁺ is removed by moving the grains apart (`range::separate`).
    ///
    /// **Gaps below `TOUCH_IN_DIAMETERS` mean diameters count as zero**, after a shock as before it. Otherwise gaps of
    /// the size of rounding between touching grains would require contacts to open or close by less than the tolerance
    /// of the solver.
    pub(super) fn hand_over<M: Model>(
        &mut self,
        problem: &mut StepProblem<M>,
        world: &World,
        candidates: &Candidates,
    ) {
        let mut moved = false;
        for (index, body) in self.bodies.iter().enumerate().filter(|(_, body)| body.struck_in_step)
        {
            moved = true;
            let before = M::coordinates(&problem.bodies.before[index]);
            let free = std::array::from_fn(|axis| before[axis] + body.gain[axis]);
            M::set(&mut problem.bodies.free[index], free);
        }
        for number in 0..self.pairs.len() {
            let at = ShockInputs { problem, world, candidates };
            let Some((allowed, normal)) = self.closing_left(&at, number) else { continue };
            moved = true;
            let capture = self.capture_left(problem, number);
            let wall_speed = match normal {
                Some(normal) => problem.turn_row(number, normal),
                None => problem.wall_speed(number),
            };
            problem.let_close(number, allowed.positive_part(), wall_speed);
            let row = problem.rows.get_mut(number);
            if let Some([before, after]) = capture {
                row.shifted_impulse = (row.shifted_impulse - before + after).positive_part();
                problem.rows.captures[number] = after;
            }
        }
        if moved {
            problem.form_velocities();
        }
    }

    /// Returns the closing speed that a contact may have at the end of the step after the shocks (collisions), m/s,
    /// relative to the wall if the other body is a moving wall, and the new contact normal if the normal has changed.
    /// Returns `None` if neither the speed nor the normal has changed.
    fn closing_left<M: Model>(
        &self,
        at: &ShockInputs<'_, M>,
        number: usize,
    ) -> Option<(f64, Option<DVec2>)> {
        let problem = at.problem;
        let StepNumbers { time_step_secs: secs, touch, .. } = self.numbers;
        let pair = self.pairs[number];
        let (i, j) = grains(problem, number);
        let rest_of_way =
            self.bodies[i].rest_of_way - j.map_or(DVec2::ZERO, |j| self.bodies[j].rest_of_way);
        let rest = pair.normal.dot(rest_of_way) / secs;
        let left = 1.0 - pair.struck_at / secs;
        let mut allowed = (pair.gap + pair.shift - touch) / secs + rest;
        if self.acts_late(number, i, j) {
            allowed = left * rest.positive_part();
        }
        let mut normal = None;
        if pair.next == NextImpact::Never && pair.speed + allowed < 0.0 {
            let is_in_touch = self.is_in_touch(at, number);
            if let Some((at_end, gap)) = self.approach(at, number, secs)
                && (!is_in_touch || gap > touch)
            {
                normal = Some(at_end);
                let velocity = self.course(problem, number).velocity_at(secs);
                allowed = gap.positive_part() / secs - at_end.dot(velocity);
            } else if pair.speed > 0.0 {
                allowed = -pair.speed;
            }
        }
        let is_struck = |grain: usize| self.bodies[grain].struck_in_step;
        let changes = is_struck(i) || j.is_some_and(is_struck) || rest_of_way != DVec2::ZERO;
        (changes || normal.is_some()).then_some((allowed, normal))
    }

    /// Returns two capture speeds (opening speeds that the bond of a contact can stop), m/s: the value in the contact
    /// problem before the shocks (collisions) of the step, and the value for the rest of the step after a shock that
    /// has formed the bond or has made its gap close. Returns `None` if there was no such shock.
    fn capture_left<M: Model>(&self, problem: &StepProblem<M>, number: usize) -> Option<[f64; 2]> {
        let before = *problem.rows.captures.get(number)?;
        let ClosedBond { part, .. } = self.closed(number)?;
        Some([before, part * problem.law.capture_speed()])
    }

    /// Returns the bond of contact `number` if a shock (collision) of this step has formed the bond, or has made its
    /// gap close; otherwise `None`. A pair that touched and was bonded before the shock keeps its bond unchanged, so
    /// for this pair the result is `None`.
    pub(in super::super) fn closed(&self, number: usize) -> Option<ClosedBond> {
        let pair = self.pairs.get(number)?;
        let closes = pair.impulse > 0.0 && (pair.touch == Touch::Met || !pair.is_bonded);
        closes.then(|| ClosedBond {
            part: 1.0 - pair.struck_at / self.numbers.time_step_secs,
            gained: pair.gained,
        })
    }

    /// True if the gap of the pair of contact `number` closed within the step, at the time t, and none of its grains
    /// was struck afterwards. Then the impulse that the solution of the step gives the pair acts only after t: at t the
    /// gap is 0, and at the end of the step it is (Δt − t) v^n, with the time step Δt and the normal velocity v^n at
    /// the end of the step. If the grain falls freely with the acceleration a, ½a(Δt − t)² is subtracted from this gap.
    fn acts_late(&self, number: usize, i: usize, j: Option<usize>) -> bool {
        let pair = &self.pairs[number];
        pair.touch == Touch::Met && pair.impulse > 0.0 && self.since(i, j) <= pair.struck_at
    }

    /// Records the results of a solved step. If the gap of a pair closed at the time t and its grains were not struck
    /// afterwards, the impulse λ (divided by the effective mass, m/s) that the solution of the step gives the pair
    /// moves its bodies apart only for the rest of the step Δt: by (Δt − t)·λ, and not by Δt·λ. Also adds the impulses
    /// of shocks (collisions) and step to the contacts' impulse sums of the step.
    pub(in super::super) fn finish<M: Model>(
        &mut self,
        problem: &StepProblem<M>,
        contacts: &mut ContactList,
    ) {
        let Self { of_step, of_shocks, .. } = self;
        of_step.clear();
        of_step.resize(contacts.contacts().len(), (DVec2::ZERO, Impulse::default()));
        for (number, row) in problem.rows() {
            let impulse = problem.reduced_impulse(number, row);
            of_step[problem.rows.contacts[number] as usize] = along_normal(row, impulse);
        }
        for (index, &(normal, impulse)) in of_step.iter().enumerate() {
            contacts.add_to_sums(index, normal, impulse);
        }
        for &(number, (normal, impulse)) in &*of_shocks {
            contacts.add_to_sums(problem.rows.contacts[number] as usize, normal, impulse);
        }
        for (number, row) in problem.rows() {
            let (i, j) = grains(problem, number);
            if !self.acts_late(number, i, j) {
                continue;
            }
            let [impulse, _] = problem.reduced_impulse(number, row);
            let ShockPair { normal, struck_at, .. } = self.pairs[number];
            let way = -struck_at * impulse * normal;
            let share = problem.rows.share(number);
            self.bodies[i].rest_of_way += share * way;
            if let Some(j) = j {
                self.bodies[j].rest_of_way -= (1.0 - share) * way;
            }
        }
    }

    /// Corrects the positions of the grains, which have moved by Δt times their velocities at the end of the step. The
    /// true displacements are different, because of shocks (collisions) within the step and of free fall; adds the
    /// differences.
    pub(in super::super) fn shift(&self, world: &mut World) {
        let grains = &mut world.grains;
        for (index, body) in self.bodies.iter().enumerate() {
            let [x, y, turn] = body.offset;
            grains.positions[index] += DVec2::new(x, y) + body.rest_of_way;
            grains.angles[index] += turn / grains.radii[index];
        }
    }
}
