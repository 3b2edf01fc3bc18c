//! Selects the pairs of bodies that collide next within a step, and the touching contacts that these collisions
//! (shocks) strike together with them.

use glam::DVec2;

use super::{
    LEAST_AGAIN, NEVER, NextImpact, Role, SAME_MOMENT, ShockInputs, Shocks, Touch, along_axes,
    grains,
};
use crate::contact::RelativeMotion;
use crate::sim::steppers::range::step_numbers::StepNumbers;
use crate::solver::{Model, StepProblem};

impl Shocks {
    /// Finds the next impact of each pair, and returns the time of the earliest impact of all pairs, s.
    pub(super) fn find_next<M: Model>(&mut self, at: &ShockInputs<'_, M>) -> f64 {
        let mut first = NEVER;
        for number in 0..self.pairs.len() {
            if at.problem.gives_way(number) {
                continue;
            }
            if self.pairs[number].next == NextImpact::Unknown {
                self.pairs[number].acceleration = self.acceleration(at.problem, number);
                self.pairs[number].next = self.next_of(at, number);
            }
            first = first.min(self.pairs[number].next.secs());
        }
        first
    }

    /// Returns the acceleration a_n along the normal, m/s², of a grain that falls on a fixed disc or a boundary and has
    /// not met it yet; 0 for other pairs.
    fn acceleration<M: Model>(&self, problem: &StepProblem<M>, number: usize) -> f64 {
        let (i, j) = grains(problem, number);
        let pair = &self.pairs[number];
        if j.is_some() || self.bodies[i].is_supported || pair.touch == Touch::Met {
            return 0.0;
        }
        pair.normal.dot(self.fall::<M>(i)) / self.numbers.time_step_secs
    }

    /// Returns the change of the velocity of grain `grain` along x and y by gravity and other external forces in the
    /// whole step, m/s.
    fn fall<M: Model>(&self, grain: usize) -> DVec2 {
        along_axes::<M>(&M::from_coordinates(self.bodies[grain].gain))
    }

    /// Returns the motion of the first body of contact `number`, a grain, relative to the second body, after the shocks
    /// (collisions) that have been computed so far, extrapolated back to the beginning of the step: its velocity, its
    /// acceleration, and the offset (m) of the extrapolated position from the actual position at the beginning of the
    /// step.
    pub(super) fn course<M: Model>(
        &self,
        problem: &StepProblem<M>,
        number: usize,
    ) -> RelativeMotion {
        let (i, j) = grains(problem, number);
        let pair = &self.pairs[number];
        let offset =
            |grain: usize| along_axes::<M>(&M::from_coordinates(self.bodies[grain].offset));
        let velocity = |grain: usize| along_axes::<M>(&problem.bodies.before[grain]);
        let acceleration = match pair.acceleration {
            0.0 => DVec2::ZERO,
            _ => self.fall::<M>(i) / self.numbers.time_step_secs,
        };
        let of_other = match j {
            None => (DVec2::ZERO, problem.shape_velocity(number, pair.normal)),
            Some(j) => {
                let slide = M::slide(problem.rows.get(number).normal);
                (offset(j), velocity(j) + slide * DVec2::X)
            }
        };
        let (offset, velocity) = (offset(i) - of_other.0, velocity(i) - of_other.1);
        RelativeMotion { offset, velocity, acceleration }
    }

    /// Returns the time, s from the beginning of the step, since which both bodies of a pair have had their present
    /// velocities. `i` is a grain; `j` is the second body if it is a grain, too.
    pub(super) fn since(&self, i: usize, j: Option<usize>) -> f64 {
        j.map_or(0.0, |j| self.bodies[j].since).max(self.bodies[i].since)
    }

    /// True if the pair of contact `number` touches at the time of the last shock (collision) that changed the velocity
    /// of one of its grains, or at the beginning of the step if there was no such shock. To touch, its gap at this time
    /// must be closed along its normal at the last time when its gap closed within the step, or along its normal at the
    /// beginning of the step if no gap has closed. If another body struck one of its grains after the pair's own last
    /// shock, the pair has moved on in the meantime, so the actual gap at this time must be closed, too.
    pub(super) fn is_in_touch<M: Model>(&self, at: &ShockInputs<'_, M>, number: usize) -> bool {
        let pair = &self.pairs[number];
        let (i, j) = grains(at.problem, number);
        let (from, touch) = (self.since(i, j), self.numbers.touch);
        if pair.touch == Touch::Apart || pair.gap_at(from) > touch {
            return false;
        }
        let end = (from > pair.struck_at).then(|| self.approach(at, number, from));
        end.flatten().is_none_or(|(_, gap)| gap <= touch)
    }

    /// Returns the normal and the gap (m) of the pair of contact `number` at the time `secs` (s). `None` if the second
    /// body is a part of a boundary, the point of it that is nearest to the grain is a corner which it shares with
    /// another part, and a contact at this corner counts for the other part.
    pub(super) fn approach<M: Model>(
        &self,
        at: &ShockInputs<'_, M>,
        number: usize,
        secs: f64,
    ) -> Option<(DVec2, f64)> {
        let contact = &self.pairs[number].contact;
        self.course(at.problem, number).approach(at.world, at.candidates, contact, secs, M::AXES)
    }

    /// Returns the next impact of the pair of contact `number` in the step. A pair that touches has an impact if it
    /// closes fast enough, a pair with a gap if the gap closes within the step.
    fn next_of<M: Model>(&self, at: &ShockInputs<'_, M>, number: usize) -> NextImpact {
        let pair = &self.pairs[number];
        let (i, j) = grains(at.problem, number);
        let from = self.since(i, j);
        if self.is_in_touch(at, number) {
            let was_struck = |grain: usize| self.bodies[grain].struck_in_step;
            let again = was_struck(i) || j.is_some_and(was_struck);
            let least = if again { LEAST_AGAIN * self.fastest } else { 0.0 };
            let momentum = -pair.speed * at.problem.rows.get(number).effective_mass;
            let closes =
                -pair.speed > least.max(self.least_closing) && momentum > self.least_momentum;
            return if closes { NextImpact::Closes(from) } else { NextImpact::Never };
        }
        // The true gap is at least as large as its linear approximations, so it cannot close if they do not.
        let [begin, end] = [from, self.numbers.time_step_secs].map(|secs| pair.gap_at(secs));
        if begin > 0.0 && end > 0.0 && pair.acceleration <= 0.0 {
            return NextImpact::Never;
        }
        self.meeting(at, number, from).unwrap_or(NextImpact::Never)
    }

    /// Returns the next time after `from` (s) at which the gap of the pair of contact `number` closes, with the normal
    /// at that time; `None` if it does not close within the step.
    fn meeting<M: Model>(
        &self,
        at: &ShockInputs<'_, M>,
        number: usize,
        from: f64,
    ) -> Option<NextImpact> {
        let ShockInputs { problem, world, candidates } = at;
        let (contact, times) = (&self.pairs[number].contact, [from, self.numbers.time_step_secs]);
        let course = self.course(problem, number);
        let (secs, normal) = course.time_of_impact(world, candidates, contact, times, M::AXES)?;
        Some(NextImpact::Meets { secs, normal })
    }

    /// Computes, for struck pairs that count as touching although they have a small gap, the exact times at which these
    /// gaps close. Until now the impact time of such a pair is the time from which its two bodies approach each other,
    /// as if its gap were closed. Leaves out pairs that are struck together with other contacts, because such contacts
    /// share the time of their cluster.
    pub(super) fn refine<M: Model>(&mut self, at: &ShockInputs<'_, M>) {
        for (number, row) in at.problem.rows() {
            let root = self.root(row.i as usize);
            let pair = &self.pairs[number];
            let NextImpact::Closes(from) = pair.next else { continue };
            if pair.role != Role::Struck || self.bodies[root].cluster.1 > 1 {
                continue;
            }
            if let Some(next) = self.meeting(at, number, from) {
                self.pairs[number].next = next;
                self.bodies[root].cluster.0 = next.secs();
            }
        }
    }

    /// Chooses the pairs that are struck in this pass: the group of shocks (collisions) that is computed next. A pair
    /// is struck if its next impact is the next impact of each of its grains. All contacts that touch at that time and
    /// are connected to a struck pair are struck, too. `first` is the time of the earliest impact of all pairs, s.
    pub(super) fn choose<M: Model>(&mut self, problem: &StepProblem<M>, first: f64) {
        let StepNumbers { time_step_secs, touch, .. } = self.numbers;
        for (index, body) in self.bodies.iter_mut().enumerate() {
            body.next = NEVER;
            body.root = index as u32;
            body.cluster = (NEVER, 0);
        }
        for number in 0..self.pairs.len() {
            let (i, j) = grains(problem, number);
            let next = self.pairs[number].next.secs();
            for grain in std::iter::once(i).chain(j) {
                self.bodies[grain].next = self.bodies[grain].next.min(next);
            }
        }
        for number in 0..self.pairs.len() {
            let (i, j) = grains(problem, number);
            let moment = self.bodies[i].next.min(j.map_or(NEVER, |j| self.bodies[j].next));
            let since = self.since(i, j);
            let pair = &mut self.pairs[number];
            let next = pair.next.secs();
            let at = if moment < NEVER { moment } else { first };
            let in_touch = pair.touch != Touch::Apart && since <= at && pair.gap_at(at) <= touch;
            pair.role = if next < NEVER && next <= moment + SAME_MOMENT * time_step_secs {
                Role::Struck
            } else if in_touch {
                Role::Joined
            } else {
                Role::Apart
            };
            if let (Role::Struck | Role::Joined, Some(j)) = (pair.role, j) {
                let (one, other) = (self.root(i), self.root(j));
                self.bodies[one.max(other)].root = one.min(other) as u32;
            }
        }
        for (number, row) in problem.rows() {
            let root = self.root(row.i as usize);
            let pair = &self.pairs[number];
            if pair.role != Role::Apart {
                let (earliest, rows) = &mut self.bodies[root].cluster;
                if pair.role == Role::Struck {
                    *earliest = earliest.min(pair.next.secs());
                }
                *rows += 1;
            }
        }
    }

    /// Returns the index of the representative of the cluster of `grain`: one grain of the cluster, which identifies
    /// the cluster. A cluster is a set of grains that are struck together.
    pub(super) fn root(&mut self, grain: usize) -> usize {
        let mut at = grain;
        while self.bodies[at].root as usize != at {
            let above = self.bodies[at].root as usize;
            self.bodies[at].root = self.bodies[above].root;
            at = above;
        }
        at
    }
}
