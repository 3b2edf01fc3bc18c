//! Known remedies for known failures, all off in the paper's scheme. A remedy has a row in [`ROWS`], a setting in
//! [`Remedies`], and a line where a step asks for it: in [`solve`] or [`after_step`], or, where it looks ahead or cuts the
//! step, in the way to step itself.

#![deny(
    dead_code,
    reason = "a remedy without a row, or one that no step asks, would not be missed"
)]

pub(super) mod sequential_impacts;

use glam::DVec2;

use crate::contact::{InTouch, LookAhead, Numbering};
use crate::number::Parts;
use crate::setting::{Group, Value, settings};
use crate::sim::settings::Settings;
use crate::sim::state::State;
use crate::sim::steppers::Stepper;
use crate::sim::steppers::moreau::set_up;
use crate::sim::stepping::Stage;
use crate::solver::{Model, SolveReport};

/// What there is to know of a remedy.
#[derive(Clone, Copy, Debug)]
pub struct Remedy {
    /// The name of its setting.
    pub name: &'static str,
    /// The steppers that take it; others have their own ways, or none.
    pub taken_by: &'static [Stepper],
    /// Its setting in the preset `robust`, if it is part of that.
    pub robust: Option<Value>,
}

impl Remedy {
    /// True where it is asked for.
    pub(crate) fn is_on(&self, remedies: &Remedies) -> bool {
        remedies.get(self.name) != Remedies::default().get(self.name)
    }

    /// Asks for it no more.
    pub(crate) fn leave_out(&self, remedies: &mut Remedies) {
        if let Some(value) = Remedies::default().get(self.name) {
            remedies.set(self.name, value);
        }
    }
}

settings! {
    /// Remedies for known failures.
    #[serde(default)]
    pub struct Remedies, changes RemedyChanges, heading "Solver" {
        push_out: bool = false, "push-out",
            "Push overlap out by moving grains apart after each step, without giving them speed", {
            control: shown(
                "Push overlap out",
                "Grains that overlap are moved apart after each step, without speed.",
            ),
        }
        max_travel: f64 = 0.0, "max-travel" ("D"),
            "Cut steps into pieces in which no grain moves further than this, in diameters, but \
             into 100 at the most; 0 never does", {
            allowed: "a finite number of diameters ≥ 0; 0 never cuts a step",
            holds: |value| value >= 0.0 && value.is_finite(),
        }
        calm_unsolved: bool = false, "calm-unsolved",
            "Solve a step that did not converge once more without bounces, which may contradict \
             each other", {
            control: shown(
                "Calm unsolved steps",
                "A step that did not converge is solved once more without bounces, which may \
                 contradict each other.",
            ),
        }
        sequential_impacts: bool = false, "sequential-impacts",
            "Have shocks run through touching grains one after the other, as in Newton's cradle; \
             not with cohesion", {
            control: shown(
                "Shocks in sequence",
                "Shocks run through touching grains one after the other, as in Newton's cradle; \
                 not where Bond is above 0.",
            ),
        }
        speculative: bool = false, "speculative",
            "Let pairs that would close their gap within a step close it and no more, so that \
             nothing tunnels; it costs bounces", {
            control: shown(
                "Look ahead",
                "Pairs that would meet within a step close their gap and no more: nothing \
                 tunnels, but they hardly bounce.",
            ),
        }
    }
}

impl Remedies {
    /// True where there are none.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

/// All remedies, in the order of their settings.
pub const ROWS: [Remedy; 5] = {
    const fn row(
        name: &'static str,
        taken_by: &'static [Stepper],
        robust: Option<Value>,
    ) -> Remedy {
        Remedy { name, taken_by, robust }
    }
    const ON: Option<Value> = Some(Value::Switch(true));
    const MOREAU: &[Stepper] = &[Stepper::Moreau];
    [
        row("push-out", MOREAU, ON),
        row("max-travel", &[Stepper::Moreau, Stepper::Range], Some(Value::Number(ROBUST_TRAVEL))),
        row("calm-unsolved", MOREAU, ON),
        row("sequential-impacts", MOREAU, ON),
        // Fast grains are cut into pieces of a step: looking ahead would cost them their bounce.
        row("speculative", MOREAU, None),
    ]
};

const _: () = assert!(ROWS.len() == Remedies::ABOUT.len(), "each remedy has a row and a setting");

/// Solves the problem that is set up.
pub(super) fn solve<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) -> SolveReport {
    let mut report = if settings.remedies.sequential_impacts {
        sequential_impacts::solve(stage, settings)
    } else {
        stage.solve(settings)
    };
    if settings.remedies.calm_unsolved && !report.converged {
        // ρ v_n^{n−1} can ask wedged contacts for what contradicts itself, and then a step has no solution with it. So it is
        // solved anew with ρ = 0, from the impulses of the step before; what it measures is that problem's.
        let mut calm = *settings;
        calm.parameters.restitution = 0.0;
        // Detection at the same places finds the same contacts, and their impulses with them.
        set_up(stage, &calm);
        report = stage.solve(&calm).after(report);
    }
    report
}

/// What is done once the grains have moved.
pub(super) fn after_step<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) {
    if settings.remedies.push_out {
        push_out(stage.state, settings.parameters.time_step_secs);
    }
}

/// Furthest way of a grain in a piece where the preset `robust` asks, in d: half of what could jump a wall.
const ROBUST_TRAVEL: f64 = 0.25;

/// Most pieces of a step: more would be a step of another order than the one asked for.
const MOST_PIECES: f64 = 100.0;

/// Pieces of the next step: 1 unless grains are too fast for it.
pub(in crate::sim) fn pieces(state: &State, settings: &Settings) -> u32 {
    let world = &state.world;
    let longest = settings.remedies.max_travel * world.mean_diameter;
    if longest == 0.0 {
        return 1;
    }
    let time_step_secs = settings.parameters.time_step_secs;
    let mut travel = state.fastest_in(time_step_secs) * time_step_secs
        + state.largest_acceleration() * time_step_secs * time_step_secs;
    if let Some(pull) = state.pull {
        let position = world.grains.positions[pull.grain as usize];
        travel += world.shortest(pull.target - position).length();
    }
    (travel / longest).ceil().clamp(1.0, MOST_PIECES) as u32
}

/// Overlap that is left, in d: cohesive contacts live on overlap. Smaller: contacts are lost to
/// rounding; larger: it shows in what is measured.
const LEFT: f64 = 2e-4;
/// Part of the rest that one step takes away. Larger: piles visibly jump; smaller: it takes longer.
const SHARE: f64 = 0.2;
/// Sweeps. What they leave, the next step takes up.
const SWEEPS: u32 = 8;

/// A contact to be pushed.
struct PushedContact {
    i: usize,
    j: Option<usize>,
    normal: DVec2,
    /// By how much its gap has to grow, m; negative is what it may shrink.
    want: f64,
    /// λ, kg·m.
    push: f64,
    /// 1/w, kg.
    mass: f64,
}

/// Moves the grains after a step of that length, whose contacts are still those of its beginning.
///
/// After a step the grains are moved by δ so that each contact's gap grows by a part of what it
/// overlaps too much, and no contact is pushed into overlap by its neighbours. With w = 1/m_i + 1/m_j
/// and λ the push of a contact, δ_i = Σ n λ/m_i,
///
/// > 0 ≤ λ ⟂ n·(δ_i − δ_j) − want ≥ 0,
///
/// which is Signorini's law again, solved by a few sweeps of projected Gauss–Seidel. Velocities stay
/// as they are, so no kinetic energy is gained; a grain that is lifted gains the height.
pub(in crate::sim) fn push_out(state: &mut State, time_step_secs: f64) {
    let State { world, contacts, walls, .. } = state;
    let left = LEFT * world.mean_diameter;
    let (grains, numbering) = (&world.grains, Numbering::of(world));
    let mut rows = Vec::with_capacity(contacts.contacts().len());
    let mut deepest = 0f64;
    for contact in contacts.contacts() {
        let i = contact.grain as usize;
        let j = numbering.other(contact.other).grain();
        let velocity_of = |j| grains.velocities[j] + world.speed_of_image(i, j) * DVec2::X;
        let velocity_of_other = j.map_or(DVec2::ZERO, velocity_of);
        let approach = (grains.velocities[i] - velocity_of_other).dot(contact.normal);
        let centre = grains.positions[i] - time_step_secs * grains.velocities[i];
        let surface = walls.surface_at(world, contact, centre);
        let approach = approach - surface.map_or(0.0, |it| it.along(contact.normal)[0]);
        let depth = -(contact.gap + time_step_secs * approach) - left;
        deepest = deepest.max(depth);
        let inverse = 1.0 / grains.masses[i] + j.map_or(0.0, |j| 1.0 / grains.masses[j]);
        let want = if depth > 0.0 { SHARE * depth } else { depth };
        rows.push(PushedContact {
            i,
            j,
            normal: contact.normal,
            want,
            push: 0.0,
            mass: 1.0 / inverse,
        });
    }
    if deepest <= 0.0 {
        return;
    }
    let mut moves = vec![DVec2::ZERO; grains.len()];
    for _ in 0..SWEEPS {
        for row in &mut rows {
            let move_of_other = row.j.map_or(DVec2::ZERO, |j| moves[j]);
            let lacks = row.want - (moves[row.i] - move_of_other).dot(row.normal);
            let push = (row.push + row.mass * lacks).positive_part();
            let change = (push - row.push) * row.normal;
            row.push = push;
            moves[row.i] += change / grains.masses[row.i];
            if let Some(j) = row.j {
                moves[j] -= change / grains.masses[j];
            }
        }
    }
    for (position, by) in world.grains.positions.iter_mut().zip(moves) {
        *position += by;
    }
}

/// Farther pairs are left alone, in d: where all grains are fast, the search would be of nearly all pairs.
const FARTHEST_IN_DIAMETERS: f64 = 8.0;

/// How far a step that has begun has to look: as far as two bodies of the fastest speed come.
///
/// A contact that is looked for at the beginning of a step is missed where the pair meets later in it,
/// and a fast disc is then inside a wall, or through it. So pairs with a gap that would close within
/// the step enter its problem too, and may close by that gap and no more (E. Catto, *Continuous
/// collision*, 2013):
///
/// > 0 ≤ P ⟂ v_n + gap/Δt ≥ 0.
///
/// They do not pull. At the end of the step they touch: the gap is taken larger by the rounding that
/// contacts have (`contact::range`). In the compressive cone they rub by what exceeds the cohesion that
/// they will have.
///
/// **What it costs.** The pair is slowed down to gap/Δt before it meets, and bounces in the step after
/// with ρ times that: with any share between 0 and 1 of the speed that it should have, half of it in
/// the mean. The normal is that of the beginning, so what would pass by at a slant may be held up by
/// nothing. And a fast grain looks for all that lies within its way. Cutting the step into pieces
/// ([`pieces`]) has none of these faults.
pub(in crate::sim) fn look_ahead(state: &State, time_step_secs: f64) -> LookAhead {
    let world = &state.world;
    let by_forces = 2.0 * state.largest_acceleration() * time_step_secs * time_step_secs;
    let way = 2.0 * state.fastest() * time_step_secs + by_forces;
    LookAhead {
        time_step_secs,
        distance: by_forces,
        reach: way.min(FARTHEST_IN_DIAMETERS * world.mean_diameter),
        in_touch: InTouch::Touching,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_row_is_about_the_setting_at_its_place() {
        for (row, about) in ROWS.iter().zip(Remedies::ABOUT) {
            assert_eq!(row.name, about.name);
        }
    }
}
