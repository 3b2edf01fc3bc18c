//! The texts of warnings about the run.

use crate::app::budget::FAST;
use crate::app::watched_run::WatchedRun;
use crate::live::{WorldAlarm, WorldFrame};
use crate::sim::{AlarmKind, Settings};

/// Returns the texts of warnings about the selected simulation, then those about the other simulations with their
/// titles. Within a simulation, warnings under the present settings come first, then warnings under earlier settings;
/// the newest are first.
pub(super) fn alarms(run: &WatchedRun) -> Vec<String> {
    let of_world = |index: usize| {
        let world = &run.frame.worlds[index];
        let is_news = |alarm: &&WorldAlarm| !is_expected(alarm, world);
        let mut alarms: Vec<&WorldAlarm> = world.alarms.iter().rev().filter(is_news).collect();
        alarms.sort_by_key(|alarm| alarm.is_earlier);
        let said = move |alarm: &WorldAlarm| match run.compares() {
            true => format!("{}: {}", run.title(index), alarm.text),
            false => alarm.text.to_string(),
        };
        alarms.into_iter().map(said).collect::<Vec<_>>()
    };
    let others = (0..run.frame.worlds.len()).filter(|&index| index != run.selected);
    let selected = (!run.frame.worlds.is_empty()).then_some(run.selected);
    selected.into_iter().chain(others).flat_map(of_world).collect()
}

/// True for a warning that the user has chosen to accept: unsolved steps with the solver preset Fast at Bond number 0.
/// With cohesion the warning is shown, because unsolved steps break bonds.
fn is_expected(alarm: &WorldAlarm, world: &WorldFrame) -> bool {
    let Settings { parameters, solver, .. } = world.controls.settings;
    alarm.kind == AlarmKind::SweepLimit
        && solver == FAST.among(&world.snapshot.surroundings, &parameters)
        && parameters.bond == 0.0
}
