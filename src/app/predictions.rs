//! Predictions: the question of a lesson before its pile is released, and the result of the run in numbers.

use serde::{Deserialize, Serialize};

use crate::live::LiveFrame;
use crate::number::millis_text;
use crate::sim::Observables;

/// The question of a lesson.
#[derive(Debug)]
pub struct Question {
    /// The question.
    pub text: &'static str,
    /// Its two answers.
    pub answers: [&'static str; 2],
    /// The rows of the run that decide; nothing while the run has not come so far.
    pub rows: fn(&LiveFrame) -> Option<Vec<Observables>>,
    /// The index of the right answer and the result of the run in a sentence, from those rows.
    pub result: fn(&[Observables]) -> Option<(usize, String)>,
}

/// The answer of the user to the question of a lesson.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Prediction {
    /// Index of the answer.
    pub answer: usize,
    /// True if the run agreed; nothing before it ended.
    pub was_right: Option<bool>,
}

/// Difference of slumps up to which two piles slump alike: an eighth of the axis of the plot, hardly visible. A smaller
/// value calls nearly every pair of piles different.
const ALIKE: f64 = 0.05;
/// Overlap above which a disc does not carry its load, in mean diameters: the limit of `slump stability`.
const SQUEEZED: f64 = 0.01;
/// Simulated time for which a pile is watched after a change of Δt, s.
const WATCHED_SECS: f64 = 0.3;

/// The last rows of all worlds, once all of them have reached the end of the scene.
pub(super) fn last_rows(frame: &LiveFrame) -> Option<Vec<Observables>> {
    let duration_secs = frame.start.as_ref()?.scene.duration_secs;
    let last = frame.worlds.iter().map(|world| world.curve.last().copied());
    let ended = |row: &Observables| row.time_secs + 0.5 * row.time_step_secs >= duration_secs;
    last.map(|row| row.filter(ended)).collect()
}

/// The last row with the longest Δt and the last row of all, once the pile was watched with a shorter Δt. While a slider is
/// dragged, a few steps have a Δt between the two.
pub(super) fn rows_around_change(frame: &LiveFrame) -> Option<Vec<Observables>> {
    let curve = &frame.worlds.first()?.curve;
    let last = *curve.last()?;
    let taken = || curve.rows().filter(|row| row.step > 0);
    let longest_secs = taken().map(|row| row.time_step_secs).fold(last.time_step_secs, f64::max);
    let is_before = |row: &&Observables| {
        row.time_step_secs == longest_secs && longest_secs > last.time_step_secs
    };
    let before = *taken().filter(is_before).last()?;
    (last.time_secs >= before.time_secs + WATCHED_SECS).then(|| vec![before, last])
}

/// Lesson 1: do two time steps make the pile slump alike?
pub(super) fn two_time_steps(rows: &[Observables]) -> Option<(usize, String)> {
    let [short, long] = rows else { return None };
    let text = format!(
        "With {} the pile slumped by {:.2}, with {} by {:.2}.",
        millis_text(short.time_step_secs),
        short.slump,
        millis_text(long.time_step_secs),
        long.slump
    );
    Some((usize::from((short.slump - long.slump).abs() > ALIKE), text))
}

/// Lesson 2: does a shorter Δt move a pile at rest?
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

/// Lesson 3: do unsolved steps hold the pile better?
pub(super) fn unsolved_steps(rows: &[Observables]) -> Option<(usize, String)> {
    let [few, some, solved] = rows else { return None };
    let text = format!(
        "The slump was {:.2} with 5 sweeps per step, {:.2} with 40 sweeps, and {:.2} with solved steps.",
        few.slump, some.slump, solved.slump
    );
    Some((usize::from(few.slump > solved.slump), text))
}

/// Lesson 4: does Δt change the slump as much if bonds have a length?
pub(super) fn two_laws(rows: &[Observables]) -> Option<(usize, String)> {
    let [short, long, range_short, range_long] = rows else { return None };
    let [rigid, range] = [short.slump - long.slump, range_short.slump - range_long.slump];
    let text = format!(
        "From 0.1 ms to 5 ms the slump changed by {:.2} under moreau and by {:.2} under range.",
        rigid.abs(),
        range.abs()
    );
    Some((usize::from(range.abs() < 0.5 * rigid.abs()), text))
}

/// Lesson 5: which law of friction lets a strong pile slump?
pub(super) fn two_cones(rows: &[Observables]) -> Option<(usize, String)> {
    let [shifted, compressive] = rows else { return None };
    let [left, right] = [shifted.slump, compressive.slump];
    let text = format!("The left pile slumped by {left:.2}, the right pile by {right:.2}.");
    Some((usize::from(right > left), text))
}

/// Lesson 6: do ten sweeps carry a heavy disc?
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
