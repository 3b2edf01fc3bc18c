//! Predictions in the lessons: the question that the user answers before the run starts, and the result of the run in
//! numbers.

use serde::{Deserialize, Serialize};

use crate::live::LiveFrame;
use crate::number::millis_text;
use crate::sim::Observables;

/// The question of a lesson, with its answers and its evaluation.
#[derive(Debug)]
pub struct Question {
    /// Text of the question.
    pub text: &'static str,
    /// The two answers from which the user chooses.
    pub answers: [&'static str; 2],
    /// Returns the observables (measured quantities of a step) that decide the question; `None` while the run has not
    /// reached the simulated time at which it is decided.
    pub rows: fn(&LiveFrame) -> Option<Vec<Observables>>,
    /// Returns the index of the right answer and a sentence on the result, given the rows that [`Self::rows`] returned.
    pub result: fn(&[Observables]) -> Option<(usize, String)>,
}

/// The answer of the user to the question of a lesson.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Prediction {
    /// Index of the answer.
    pub answer: usize,
    /// True if the run confirmed the prediction; `None` before the run has decided the question.
    pub was_right: Option<bool>,
}

/// Largest difference of two slumps at which the piles count as slumping alike. It is an eighth of the slump axis, a
/// distance that is hardly visible. With a smaller value nearly every pair of piles would count as different.
const ALIKE: f64 = 0.05;
/// Overlap above which a disc counts as not carrying its load, in mean diameters. The command `slump stability` uses
/// the same limit.
const SQUEEZED: f64 = 0.01;
/// Slump that the question of lesson 7 asks about. Piles of the lesson's settings slump by 0.3 to 0.45, so that a
/// smaller Bond number or another Δt can change the answer.
const ASKED_SLUMP: f64 = 0.3;
/// Simulated time after a change of Δt for which the pile is watched, s.
const WATCHED_SECS: f64 = 0.3;

/// Returns the observables (measured quantities) of the last step of each simulation; `None` until all simulations have
/// reached the end of the scene.
pub(super) fn last_rows(frame: &LiveFrame) -> Option<Vec<Observables>> {
    let duration_secs = frame.start.as_ref()?.scene.duration_secs;
    let last = frame.worlds.iter().map(|world| world.curve.last().copied());
    let ended = |row: &Observables| row.time_secs + 0.5 * row.time_step_secs >= duration_secs;
    last.map(|row| row.filter(ended)).collect()
}

/// Returns the observables (measured quantities) of two steps: the last step with the first Δt of the run, and the last
/// step of the run. `None` until the pile has been watched for [`WATCHED_SECS`] after the change to a shorter Δt. The
/// steps between the two may have other values of Δt, because the user drags a slider to the new value.
pub(super) fn rows_around_change(frame: &LiveFrame) -> Option<Vec<Observables>> {
    let curve = &frame.worlds.first()?.curve;
    let last = *curve.last()?;
    let taken = || curve.rows().filter(|row| row.step > 0);
    let first_secs = taken().next()?.time_step_secs;
    let before = *taken().filter(|row| row.time_step_secs == first_secs).last()?;
    let was_watched = last.time_secs >= before.time_secs + WATCHED_SECS;
    (was_watched && last.time_step_secs < first_secs).then(|| vec![before, last])
}

/// Evaluates the question of lesson 1: does the pile slump alike with two time steps?
pub(super) fn two_time_steps(rows: &[Observables]) -> Option<(usize, String)> {
    let [short, long] = rows else { return None };
    let text = format!(
        "With {} the pile slumped by {:.3}, with {} by {:.3}.",
        millis_text(short.time_step_secs),
        short.slump,
        millis_text(long.time_step_secs),
        long.slump
    );
    Some((usize::from((short.slump - long.slump).abs() > ALIKE), text))
}

/// Evaluates the question of lesson 2: does a shorter Δt make a pile at rest move?
pub(super) fn shorter_at_rest(rows: &[Observables]) -> Option<(usize, String)> {
    let [before, after] = rows else { return None };
    let text = format!(
        "With {} the pile had slumped by {:.3}, after {} with {} by {:.3}. Now tick the box below and drag Δt a little: the \
         pile starts again.",
        millis_text(before.time_step_secs),
        before.slump,
        millis_text(after.time_secs - before.time_secs),
        millis_text(after.time_step_secs),
        after.slump
    );
    Some((usize::from((before.slump - after.slump).abs() <= ALIKE), text))
}

/// Evaluates the question of lesson 3: do unsolved steps make the pile more stable?
pub(super) fn unsolved_steps(rows: &[Observables]) -> Option<(usize, String)> {
    let [few, some, solved] = rows else { return None };
    let text = format!(
        "The slump was {:.3} with 5 sweeps per step, {:.3} with 40 sweeps, and {:.3} with Solved.",
        few.slump, some.slump, solved.slump
    );
    Some((usize::from(few.slump > solved.slump), text))
}

/// Evaluates the question of lesson 4: does Δt change the slump under the law `range` (bonds with a length) as much as
/// under the law `moreau`?
pub(super) fn two_laws(rows: &[Observables]) -> Option<(usize, String)> {
    let [short, long, range_short, range_long] = rows else { return None };
    let [rigid, range] = [short.slump - long.slump, range_short.slump - range_long.slump];
    let text = format!(
        "From 0.1 ms to 5 ms the slump changed by {:.3} under moreau and by {:.3} under range.",
        rigid.abs(),
        range.abs()
    );
    Some((usize::from(range.abs() < 0.5 * rigid.abs()), text))
}

/// Evaluates the question of lesson 5: does a pile with a large Bond number slump more under the shifted friction cone
/// (friction bounded by the normal force plus the cohesion force) or under the compressive one (friction bounded by the
/// pushing part of the normal force only)?
pub(super) fn two_cones(rows: &[Observables]) -> Option<(usize, String)> {
    let [shifted, compressive] = rows else { return None };
    let [left, right] = [shifted.slump, compressive.slump];
    let text = format!("The left pile slumped by {left:.3}, the right pile by {right:.3}.");
    Some((usize::from(right > left), text))
}

/// Evaluates the question of lesson 6: do ten sweeps per step suffice for a light disc to support a heavy disc?
pub(super) fn ten_sweeps(rows: &[Observables]) -> Option<(usize, String)> {
    let [few, solved] = rows else { return None };
    let text = format!(
        "At the end the largest overlap was {:.1} % of a diameter with ten sweeps per step, and {:.1} % with solved \
         steps.",
        100.0 * few.max_overlap,
        100.0 * solved.max_overlap
    );
    Some((usize::from(few.max_overlap > SQUEEZED), text))
}

/// Evaluates the question of lesson 7: does the user's own pile slump by more than [`ASKED_SLUMP`]?
pub(super) fn own_pile(rows: &[Observables]) -> Option<(usize, String)> {
    let slump = rows.first()?.slump;
    let text = format!(
        "Your pile slumped by {slump:.3}. Other piles with the same settings slump differently."
    );
    Some((usize::from(slump <= ASKED_SLUMP), text))
}
