//! Results of shocks, passed on to the step.

use glam::DVec2;

use super::{NextImpact, ShockInputs, ShockPair, Shocks, Touch, along_normal, grains};
use crate::contact::{Candidates, ContactList, Impulse};
use crate::number::Parts;
use crate::sim::steppers::range::step_numbers::StepNumbers;
use crate::solver::{Model, StepProblem};
use crate::world::World;

/// A bond that a shock closed.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct ClosedBond {
    /// The remaining fraction of the step.
    pub part: f64,
    /// Velocity that gravity had given the pair by then, m/s.
    pub gained: f64,
}

impl Shocks {
    /// Makes a problem continue from its shocks. Bodies begin with v⁺. Each contact may close the gap that it would
    /// have if its bodies had moved with their present velocities from the beginning.
    ///
    /// **Grains that pass by.** The constraint on a gap uses the speed along the normal of the beginning, which stops
    /// a grain that would have passed another one. If that would happen and the two do not meet, the constraint uses
    /// the tangent of the gap at the end of the step. Then v⁺ itself satisfies every contact.
    ///
    /// **No contact has to open.** A pair that was struck at t opens from then on, as if from a gap of −t v_n⁺. If it
    /// had to end the step without any overlap, its v_n would have to be above 0, while other contacts that hold it
    /// may not allow that: v = 0 would no longer satisfy every contact, and a cluster with many struck contacts would
    /// often not be solved. So only v_n ≥ 0 is required, and the remaining overlap, at most t v_n⁺, is pushed out
    /// (`range::separate`).
    ///
    /// **Gaps below the touch tolerance count as zero**, after a shock as before it. Slacks of the size of rounding
    /// between touching grains would open or close a contact by less than the tolerance of a step.
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

    /// Closing speed that a contact may have after the shocks, m/s, relative to a moving wall, and its new normal if
    /// it has changed. `None` if nothing has changed.
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

    /// The capture speed, m/s, with which a row was prepared, and that of a pair for the rest of the step after a
    /// shock has closed its bond. `None` if no shock has.
    fn capture_left<M: Model>(&self, problem: &StepProblem<M>, number: usize) -> Option<[f64; 2]> {
        let before = *problem.rows.captures.get(number)?;
        let ClosedBond { part, .. } = self.closed(number)?;
        Some([before, part * problem.law.capture_speed()])
    }

    /// The remaining step for the bond of a row, if a shock closed the bond. A pair that already touched and was
    /// bonded keeps its bond unchanged.
    pub(in super::super) fn closed(&self, number: usize) -> Option<ClosedBond> {
        let pair = self.pairs.get(number)?;
        let closes = pair.impulse > 0.0 && (pair.touch == Touch::Met || !pair.is_bonded);
        closes.then(|| ClosedBond {
            part: 1.0 - pair.struck_at / self.numbers.time_step_secs,
            gained: pair.gained,
        })
    }

    /// True if the step's impulse on a row acts only in the time after a meeting. A pair that met at t and was not
    /// struck since has no gap at t, so its gap at the end is (Δt − t) v^n, and −½a(Δt − t)² more if it falls.
    fn acts_late(&self, number: usize, i: usize, j: Option<usize>) -> bool {
        let pair = &self.pairs[number];
        pair.touch == Touch::Met && pair.impulse > 0.0 && self.since(i, j) <= pair.struck_at
    }

    /// Records a solved step. Its impulse λ on a pair that met at t moves grains only for the remaining time, and not
    /// by Δt·λ. Also adds the impulses of shocks and step to the sums of the contacts.
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

    /// Moves grains by the part of their displacement in the step that their last velocity does not give, because of
    /// shocks and falling.
    pub(in super::super) fn shift(&self, world: &mut World) {
        let grains = &mut world.grains;
        for (index, body) in self.bodies.iter().enumerate() {
            let [x, y, turn] = body.offset;
            grains.positions[index] += DVec2::new(x, y) + body.rest_of_way;
            grains.angles[index] += turn / grains.radii[index];
        }
    }
}
