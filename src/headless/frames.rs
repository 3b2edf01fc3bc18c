//! Frames of one scene, with observables and manifest beside them.

use std::path::Path;

use image::RgbaImage;

use super::HeadlessOptions;
use super::gif::Animation;
use super::manifest::{Manifest, Moment, PictureEntry, RunEntry};
use crate::error::{Error, Result};
use crate::output::{Progress, check_writable, finish_file, start_file, write_png};
use crate::render::{
    Camera, ColourBy, Renderer, Style, automatic_range, draw_scene, force_reference,
};
use crate::scene::{Config, Scene, Settling, View};
use crate::sim::{Alarm, AlarmKind, Observables, Snapshot};
use crate::solver::{Method, picked};
use crate::study::record;

/// Name of the run in the manifest.
const RUN: &str = "run";

/// Simulates the scene and draws its frames.
pub(super) fn draw(config: &Config, options: &HeadlessOptions) -> Result<()> {
    let size = options.size()?;
    options.picture_times(config.without_settling()?.duration_secs)?;
    let renderer = Renderer::new(options.renderer)?;
    renderer.check_size(size.width, size.height)?;
    for folder in options.frames.as_deref().into_iter().chain(gif_folder(options)) {
        check_writable(folder)?;
    }
    let scene = settled(config)?;
    let times = options.picture_times(scene.duration_secs)?;
    eprintln!("drawing with {}", renderer.name());

    let mut studio = Studio::open(options, renderer, &scene)?;
    let steps = scene.parameters.steps_in(scene.duration_secs);
    let progress = Progress::new(&scene.name, steps);
    let mut table = options.frames.as_deref().map(ObservablesTable::start).transpose()?;

    // Colours and widths that follow the state need one scale for all frames, so those frames wait
    // for the end of the run. All others are drawn as the run comes by.
    let wait = studio.needs_common_scale();
    let mut waiting = Vec::new();
    let recorded = record(
        &scene,
        &times,
        |number, snapshot| {
            if wait {
                waiting.push(snapshot);
                return Ok(());
            }
            studio.shoot(number, &snapshot)
        },
        |observables| {
            progress.set(observables.step);
            table.as_mut().map_or(Ok(()), |table| table.add(observables))
        },
    );
    progress.finish();
    let recorded = recorded?;
    let alarms = recorded.simulation.alarms();
    if let Some(table) = table {
        table.finish()?;
    }
    if wait {
        studio.set_common_scale(&waiting);
        for (number, snapshot) in waiting.iter().enumerate() {
            studio.shoot(number, snapshot)?;
        }
    }
    studio.manifest.runs.push(RunEntry::new(RUN, &scene, recorded.tally, alarms)?);
    studio.finish()?;
    tell_of_unconverged_steps(&scene, &recorded.tally);
    if scene.solver.method == Method::Auto {
        let contacts = recorded.simulation.contacts().contacts().len();
        eprintln!("auto took {} for {contacts} contacts", picked(&scene.solver, contacts).name());
    }
    tell_of_alarms(&scene, alarms);
    recorded.failure.map_or(Ok(()), Err)
}

/// Says on stderr what went wrong, and what is most likely to help. A state that is no longer finite
/// ends the run with an error of its own.
pub(super) fn tell_of_alarms(scene: &Scene, alarms: &[Alarm]) {
    for alarm in alarms.iter().filter(|alarm| alarm.kind != AlarmKind::NotFinite) {
        eprintln!("{}: {}", scene.name, alarm.message(&scene.settings()));
    }
}

/// Says on stderr how many steps were not solved as asked.
pub(super) fn tell_of_unconverged_steps(scene: &Scene, tally: &crate::sim::Tally) {
    if tally.unconverged_steps > 0 {
        eprintln!(
            "{} (Bond {}, time step {} s): {} of {} steps did not reach tolerance {:e} within {} \
             sweeps, {} of them stalled (more sweeps would be of no use); largest residual {:.1e}",
            scene.name,
            scene.parameters.bond,
            scene.parameters.time_step_secs,
            tally.unconverged_steps,
            tally.steps,
            scene.solver.tolerance,
            scene.solver.max_sweeps,
            tally.stalled_steps,
            tally.largest_residual
        );
    }
}

/// The scene, with progress shown where a new pile has to settle first.
pub(crate) fn settled(config: &Config) -> Result<Scene> {
    let progress = Progress::new("settling", 100);
    let scene = config.scene(|Settling { time_secs, limit_secs, .. }| {
        progress.set((100.0 * time_secs / limit_secs) as u64);
        true
    });
    progress.finish();
    scene
}

fn gif_folder(options: &HeadlessOptions) -> Option<&Path> {
    let folder = options.gif.as_deref()?.parent()?;
    (!folder.as_os_str().is_empty()).then_some(folder)
}

/// Draws snapshots and keeps the books.
struct Studio<'a> {
    options: &'a HeadlessOptions,
    renderer: Renderer,
    style: Style,
    camera: Camera,
    animation: Option<Animation>,
    manifest: Manifest,
}

impl<'a> Studio<'a> {
    fn open(options: &'a HeadlessOptions, renderer: Renderer, scene: &Scene) -> Result<Self> {
        let size = options.size()?;
        let View { min, max } = scene.view();
        let style = options.style();
        Ok(Self {
            options,
            camera: style.camera(min, max, size.width, size.height),
            style,
            manifest: Manifest::new(renderer.name()),
            renderer,
            animation: options.gif.as_deref().map(Animation::start).transpose()?,
        })
    }

    fn needs_common_scale(&self) -> bool {
        let by_state =
            !matches!(self.style.colour_by, ColourBy::PaperGreys | ColourBy::Coordination);
        self.style.show_forces || by_state
    }

    fn set_common_scale(&mut self, snapshots: &[Snapshot]) {
        let colour_by = self.style.colour_by;
        let ranges = snapshots.iter().map(|snapshot| automatic_range(colour_by, snapshot));
        self.style.range = ranges.reduce(|all, one| (all.0.min(one.0), all.1.max(one.1)));
        let references = snapshots.iter().map(|snapshot| force_reference(&self.style, snapshot));
        self.style.force_reference = references.reduce(f64::max).filter(|&largest| largest > 0.0);
    }

    fn shoot(&mut self, number: usize, snapshot: &Snapshot) -> Result<()> {
        let size = self.options.size()?;
        let image: RgbaImage = draw_scene(
            &mut self.renderer,
            snapshot,
            &self.style,
            &self.camera,
            size.width,
            size.height,
        )?;
        if let Some(folder) = &self.options.frames {
            let file = format!("frame_{number:05}.png");
            write_png(&folder.join(&file), &image)?;
            let moment = Moment { run: RUN.to_owned(), observables: snapshot.observables };
            self.manifest.pictures.push(PictureEntry { file, shows: vec![moment] });
        }
        match &mut self.animation {
            Some(animation) => animation.add(image),
            None => Ok(()),
        }
    }

    fn finish(self) -> Result<()> {
        if let Some(folder) = &self.options.frames {
            self.manifest.write(&folder.join("manifest.json"))?;
            println!("{} pictures in {}", self.manifest.pictures.len(), folder.display());
        }
        if let (Some(animation), Some(path)) = (self.animation, &self.options.gif) {
            animation.finish()?;
            println!("{}", path.display());
        }
        Ok(())
    }
}

/// `observables.csv`, a row a step; it is there once the run has ended.
pub(super) struct ObservablesTable {
    path: std::path::PathBuf,
    writer: csv::Writer<tempfile::NamedTempFile>,
}

impl ObservablesTable {
    /// Starts `observables.csv` in a folder.
    pub(super) fn start(folder: &Path) -> Result<Self> {
        Self::start_as(folder.join("observables.csv"))
    }

    /// Starts a table at a path.
    pub(super) fn start_as(path: std::path::PathBuf) -> Result<Self> {
        let writer = csv::Writer::from_writer(start_file(&path)?);
        Ok(Self { path, writer })
    }

    /// Adds a row.
    pub(super) fn add(&mut self, observables: &Observables) -> Result<()> {
        self.writer.serialize(observables).map_err(|error| Error::file(&self.path, error))
    }

    /// Gives the table its name.
    pub(super) fn finish(self) -> Result<()> {
        let Self { path, writer } = self;
        let file = writer.into_inner().map_err(|error| Error::file(&path, error.error()))?;
        finish_file(file, &path)
    }
}
