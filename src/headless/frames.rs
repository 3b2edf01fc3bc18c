//! Frames of one scene, with observables and manifest beside them.

use std::path::Path;

use super::HeadlessOptions;
use super::begin::{Asked, Schedule};
use super::checkpoint::{Beginning, Checkpoints, Found, look};
use super::data::RecordingPlan;
use super::folder::{Earlier, RunFolder};
use super::studio::Studio;
use super::telling::interrupted;
use crate::config::{Config, SavedState};
use crate::error::Result;
use crate::output::{caught_signal, check_file, note_line, warn_of_steps};
use crate::render::{Renderer, RendererChoice};
use crate::sim::Observables;
use crate::study::{OnItsWay, go_on as go_on_with};

/// Simulates the scene, or lets a saved run go on, and draws the frames.
pub(super) fn draw(config: &Config, options: &HeadlessOptions, earlier: Earlier) -> Result<()> {
    let size = options.size()?;
    options.style()?;
    options.video_rate_hz()?;
    let asked = Asked::of(config, options)?;
    let Schedule { times_secs, until_secs } = asked.schedule(config, options)?;
    let data = options.data.settings(asked.scene())?;
    let choice = if options.draws() { options.renderer } else { RendererChoice::Cpu };
    let renderer = Renderer::new(choice)?;
    renderer.check_size(size.width, size.height)?;
    let lock = |path: &Path| RunFolder::lock(path, earlier);
    let folder = options.frames.as_deref().map(lock).transpose()?;
    let every_secs = options.saving.checkpoint_every;
    let fingerprint = every_secs.map(|_| asked.fingerprint(config, options)).transpose()?;
    let found = left_in(folder.as_ref(), fingerprint.as_deref())?;
    let files = [("gif", &options.gif), ("video", &options.video), ("save", &options.saving.save)];
    for (option, path) in files {
        path.as_deref().map(|path| check_file(option, path)).transpose()?;
    }
    let picture_times_secs = options.picture_times(asked.scene().duration_secs)?;
    let claim = |data| RecordingPlan::claim(data, options.overwrite, found.is_some());
    let recording = data.map(claim).transpose()?;
    let begun = match found {
        Some(found) => found,
        None => asked.begin(config, &times_secs).map_err(|error| match caught_signal() {
            Some(signal) => interrupted(signal, &Observables::default()),
            None => error,
        })?,
    };
    let goes_on = !begun.marks.went_on_at.is_empty();
    if let Some(folder) = &folder {
        if goes_on { folder.keep_pictures(&begun.marks.pictures)? } else { folder.clear()? }
    }
    if options.draws() {
        note_line(format_args!("drawing with {}", renderer.name()));
    }

    let Beginning { state: SavedState { scene, simulation, tally, .. }, marks } = begun;
    let steps = simulation.step_at(until_secs);
    warn_of_steps(steps.saturating_sub(simulation.observables().step));
    let next_picture = marks.next_picture;
    let asked_of = folder.as_ref().zip(every_secs.zip(fingerprint));
    let mut checkpoints = asked_of.map(|(folder, (every_secs, fingerprint))| {
        Checkpoints::start(folder.path(), every_secs, fingerprint, &simulation)
    });
    if let (Some(checkpoints), false) = (&mut checkpoints, goes_on) {
        // Before anything else is there that another run would be refused for.
        checkpoints.write(&scene, (&simulation, &tally), marks.clone())?;
    }
    let start = |plan: RecordingPlan| plan.start(&scene, &simulation, &picture_times_secs);
    let recording = recording.map(start).transpose()?;
    let of_run = (&scene, steps, options.provenance(config, &scene)?);
    let mut studio = Studio::open(options, renderer, of_run, marks, checkpoints)?;
    studio.record_in(recording);
    let run = OnItsWay { simulation, tally, next_picture };
    let recorded = go_on_with(run, &times_secs, until_secs, &mut studio);
    studio.end(recorded)
}

/// The run that the same command left in its folder, if there is one to go on with. Any other files of an
/// earlier run are refused, unless they are to be removed.
fn left_in(folder: Option<&RunFolder>, fingerprint: Option<&str>) -> Result<Option<Beginning>> {
    let Some(folder) = folder else { return Ok(None) };
    let Some(fingerprint) = fingerprint.filter(|_| folder.may_go_on()) else {
        return folder.check("").map(|()| None);
    };
    match look(folder.path(), fingerprint) {
        Found::Nothing => folder.check("").map(|()| None),
        Found::Strange(why) => {
            folder.check(&format!(", and no run goes on with it: {why}")).map(|()| None)
        }
        Found::Own(begun) => {
            let Observables { step, time_secs, .. } = begun.state.simulation.observables();
            let place = folder.path().display();
            note_line(format_args!("{place}: the run goes on at step {step}, t = {time_secs} s"));
            Ok(Some(*begun))
        }
    }
}
