//! Alarms in words.

use crate::app::budget::FAST;
use crate::app::watched_run::WatchedRun;
use crate::live::{WorldAlarm, WorldFrame};
use crate::sim::{AlarmKind, Settings};

/// The alarms of the selected world, then those of others with their titles; in each, those of the present settings
/// before earlier ones, the newest first.
pub(super) fn alarms(run: &WatchedRun) -> Vec<String> {
    let of_world = |index: usize| {
        let world = &run.frame.worlds[index];
        let is_news = |alarm: &&WorldAlarm| !is_asked_for(alarm, world);
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

/// True where an alarm says what was chosen with open eyes: so many sweeps a step, solved or not, of a pile without cohesion.
/// With cohesion such steps break bonds, and it is told.
fn is_asked_for(alarm: &WorldAlarm, world: &WorldFrame) -> bool {
    let fast = FAST.among(&world.snapshot.surroundings);
    let Settings { parameters, solver, .. } = world.controls.settings;
    alarm.kind == AlarmKind::SweepLimit && solver == fast && parameters.bond == 0.0
}
