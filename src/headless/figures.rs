//! The paper's Fig. 3, 4 and 7, from simulation to finished figure.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;
use std::time::Instant;

use glam::DVec2;
use image::RgbaImage;
use rayon::prelude::*;

use super::folder::{Earlier, RunFolder};
use super::manifest::{Ended, Manifest, Moment, PictureEntry, RunEntry};
use super::provenance::texts_of_panel;
use super::table::ObservablesTable;
use super::telling::{go_on, interrupted, tell_of_alarms, tell_of_unconverged_steps};
use crate::error::Result;
use crate::output::{Progress, Texts, caught_signal, counted, note_line, print_line};
use crate::render::{Camera, Figure, Renderer, RendererChoice, Style, draw_scene};
use crate::scene::View;
use crate::sim::{Observables, Snapshot};
use crate::study::png::write_png;
use crate::study::{
    FIG4_BONDS, FIG4_TIME_STEPS_SECS, FIG7_TIME_STEPS_SECS, FIG7_TIMES_SECS, PaperRun, Recorded,
    Recorder, paper_runs, record,
};

/// Width of a panel of Fig. 4, pixels.
const PILE_PANEL_WIDTH: u32 = 640;
/// Width of Fig. 3, pixels.
const FIG3_WIDTH: u32 = 1280;
/// Width of a panel of Fig. 7, pixels.
const CRADLE_PANEL_WIDTH: u32 = 720;

/// One run that has ended.
struct Outcome {
    run: PaperRun,
    snapshots: Vec<Snapshot>,
    recorded: Recorded,
}

/// Simulates the runs on all cores and draws the figures into `folder`.
pub(super) fn draw(folder: &Path, earlier: Earlier, renderer: RendererChoice) -> Result<()> {
    let mut renderer = Renderer::new(renderer)?;
    let claimed = RunFolder::claim(folder, earlier)?;
    let runs = paper_runs()?;
    let mut manifest = Manifest::new(renderer.name());
    for run in &runs {
        manifest.runs.push(RunEntry::start(&run.name, &run.scene)?);
    }
    claimed.clear()?;
    note_line(format_args!("drawing with {}", renderer.name()));
    let mut press = Press { folder, renderer: &mut renderer, manifest };
    press.write_manifest()?;
    let mut outcomes = simulate(folder, runs)?;

    let mut failure = None;
    for (entry, outcome) in press.manifest.runs.iter_mut().zip(&mut outcomes) {
        let Outcome { run: PaperRun { scene, .. }, recorded, .. } = outcome;
        entry.end(Ended::of(recorded), recorded);
        tell_of_unconverged_steps(scene, &recorded.tally);
        tell_of_alarms(scene, recorded.simulation.alarms());
        let signal = caught_signal().filter(|_| recorded.interrupted);
        let by_signal = signal.map(|signal| interrupted(signal, recorded.simulation.observables()));
        failure = failure.or(recorded.failure.take()).or(by_signal);
    }
    let drawn = match failure {
        Some(failure) => Err(failure),
        None => press.figures(&outcomes),
    };
    let written = press.write_manifest();
    drawn.and(written)?;
    let count = counted(press.manifest.pictures.len() as u64, "picture");
    print_line(format_args!("{count} in {}", folder.display()));
    Ok(())
}

/// Runs everything, dearest first, so that no core waits long for the last one.
fn simulate(folder: &Path, runs: Vec<PaperRun>) -> Result<Vec<Outcome>> {
    let steps = |run: &PaperRun| run.scene.duration_secs / run.scene.parameters.time_step_secs;
    let progress = Progress::new("simulating", runs.iter().map(|run| steps(run) as u64).sum());
    let said = Mutex::new(());
    let outcomes = runs
        .into_par_iter()
        .with_max_len(1)
        .map(|run| {
            let started = Instant::now();
            let until_secs = run.times_secs.iter().copied().fold(0.0, f64::max);
            // A run that takes no step has no table.
            let path = folder.join(format!("{}.csv", run.name));
            let table = (until_secs > 0.0).then(|| ObservablesTable::start_as(path)).transpose()?;
            let mut notes = Notes { table, snapshots: Vec::new(), progress: &progress };
            let mut recorded = record(&run.scene, &run.times_secs, until_secs, &mut notes)?;
            let table = notes.table.map_or(Ok(()), ObservablesTable::finish);
            recorded.failure = recorded.failure.or(table.err());
            let _one_at_a_time = said.lock();
            progress.say(&format!("{}: {:.1} s", run.name, started.elapsed().as_secs_f64()));
            Ok(Outcome { run, snapshots: notes.snapshots, recorded })
        })
        .collect();
    progress.finish();
    outcomes
}

/// What is taken down of a run.
struct Notes<'a> {
    table: Option<ObservablesTable>,
    snapshots: Vec<Snapshot>,
    progress: &'a Progress,
}

impl Recorder for Notes<'_> {
    fn step(&mut self, observables: &Observables) -> Result<ControlFlow<()>> {
        self.progress.advance(1);
        self.table.as_mut().map_or(Ok(()), |table| table.add(observables))?;
        Ok(go_on())
    }

    fn picture(&mut self, _: usize, snapshot: Snapshot) -> Result<()> {
        self.snapshots.push(snapshot);
        Ok(())
    }
}

/// Draws figures and keeps the books.
struct Press<'a> {
    folder: &'a Path,
    renderer: &'a mut Renderer,
    manifest: Manifest,
}

impl Press<'_> {
    fn figures(&mut self, outcomes: &[Outcome]) -> Result<()> {
        self.fig3(outcomes)?;
        self.fig4(outcomes)?;
        self.fig7(outcomes)
    }

    fn write_manifest(&self) -> Result<()> {
        self.manifest.write(&self.folder.join("manifest.json"))
    }

    fn fig3(&mut self, outcomes: &[Outcome]) -> Result<()> {
        let Some(outcome) = of_figure(outcomes, "fig3").next() else { return Ok(()) };
        let view = outcome.run.scene.view();
        let style = Style::default();
        let panel = self.panel(outcome, 0, "fig3_panel", view, FIG3_WIDTH, &style)?;
        let mut figure = Figure::new(1, 1, vec![panel]);
        figure.title = "Initial state shared by all piles".into();
        figure.caption = format!(
            "{} discs rained between walls over a rough base and left to come to rest. \
             Greys mark layers two diameters high. At t = 0 the walls go.",
            outcome.run.scene.grains.len()
        );
        self.write_figure("fig3.png", &figure.draw()?, vec![moment(outcome, 0)])
    }

    fn fig4(&mut self, outcomes: &[Outcome]) -> Result<()> {
        let mut view = common_view(outcomes, "fig4");
        // The base belongs to the picture: its discs reach half a diameter below y = 0.
        view.min.y = -0.5 * outcomes[0].run.scene.mean_diameter;
        let mut panels = Vec::new();
        let mut titles = Vec::new();
        let mut moments = Vec::new();
        for bond in FIG4_BONDS {
            for time_step_secs in FIG4_TIME_STEPS_SECS {
                let is_this = |outcome: &&Outcome| {
                    let parameters = outcome.run.scene.parameters;
                    parameters.bond == bond && parameters.time_step_secs == time_step_secs
                };
                let Some(outcome) = of_figure(outcomes, "fig4").find(is_this) else { continue };
                // The scale is the same in all panels: one bar says it.
                let style = Style { scale_bar: panels.is_empty(), ..Style::default() };
                let name = outcome.run.name.clone();
                let slump = outcome.snapshots[0].observables.slump;
                titles.push(format!("Δy_{{G}} = {slump:.3}"));
                moments.push(moment(outcome, 0));
                panels.push(self.panel(outcome, 0, &name, view, PILE_PANEL_WIDTH, &style)?);
            }
        }
        let mut figure = Figure::new(FIG4_BONDS.len(), FIG4_TIME_STEPS_SECS.len(), panels);
        figure.row_labels = FIG4_BONDS.map(|bond| format!("Bond = {bond}")).to_vec();
        figure.column_labels =
            FIG4_TIME_STEPS_SECS.map(|step| format!("Δt = {} s", power_of_ten(step))).to_vec();
        figure.panel_titles = titles;
        figure.titles_inside = true;
        let Some(outcome) = of_figure(outcomes, "fig4").next() else { return Ok(()) };
        figure.caption = format!(
            "The pile at t = {} s, from one initial state; Δy_{{G}} is the slump.",
            outcome.run.scene.duration_secs
        );
        self.write_figure("fig4.png", &figure.draw()?, moments)
    }

    fn fig7(&mut self, outcomes: &[Outcome]) -> Result<()> {
        let view = common_view(outcomes, "fig7");
        let mut panels = Vec::new();
        let mut moments = Vec::new();
        for (row, time_secs) in FIG7_TIMES_SECS.iter().enumerate() {
            for outcome in of_figure(outcomes, "fig7") {
                let style = Style { scale_bar: panels.is_empty(), ..Style::default() };
                let name = format!("{}_t{time_secs}", outcome.run.name);
                moments.push(moment(outcome, row));
                panels.push(self.panel(outcome, row, &name, view, CRADLE_PANEL_WIDTH, &style)?);
            }
        }
        let mut figure = Figure::new(FIG7_TIMES_SECS.len(), FIG7_TIME_STEPS_SECS.len(), panels);
        figure.row_labels = FIG7_TIMES_SECS.map(|time| format!("t = {time} s")).to_vec();
        figure.column_labels =
            FIG7_TIME_STEPS_SECS.map(|step| format!("Δt = {} s", power_of_ten(step))).to_vec();
        figure.caption =
            "Three discs drawn towards the dot: k (dark grey) falls on the bonded pair \
                          of i (white) and j (light grey; does not feel the attraction)."
                .into();
        self.write_figure("fig7.png", &figure.draw()?, moments)
    }

    /// Draws one panel `width` pixels wide and as high as its view asks, and writes it by itself.
    fn panel(
        &mut self,
        outcome: &Outcome,
        number: usize,
        name: &str,
        View { min, max }: View,
        width: u32,
        style: &Style,
    ) -> Result<RgbaImage> {
        let height = panel_height(min, max, width);
        // The same camera with and without the bar: panels of one figure lie alike.
        let camera: Camera = Style::default().camera(min, max, width, height);
        let snapshot = &outcome.snapshots[number];
        let image = draw_scene(self.renderer, snapshot, style, &camera, width, height)?;
        let texts = texts_of_panel(&outcome.run.scene, snapshot)?;
        self.write(&format!("{name}.png"), &image, vec![moment(outcome, number)], &texts)?;
        Ok(image)
    }

    /// Writes a figure, all of which one command draws.
    fn write_figure(&mut self, file: &str, image: &RgbaImage, shows: Vec<Moment>) -> Result<()> {
        let mut texts = Texts::default();
        texts.add("Command line", "slump --headless --frames figures");
        self.write(file, image, shows, &texts)
    }

    fn write(
        &mut self,
        file: &str,
        image: &RgbaImage,
        shows: Vec<Moment>,
        texts: &Texts,
    ) -> Result<()> {
        write_png(&self.folder.join(file), image, texts)?;
        let entry = PictureEntry { file: file.to_owned(), shows };
        self.manifest.add(entry, &self.folder.join("manifest.json"))
    }
}

fn moment(outcome: &Outcome, number: usize) -> Moment {
    let observables = outcome.snapshots[number].observables;
    Moment { run: outcome.run.name.clone(), observables }
}

fn of_figure<'a>(outcomes: &'a [Outcome], figure: &'a str) -> impl Iterator<Item = &'a Outcome> {
    outcomes.iter().filter(move |outcome| outcome.run.figure == figure)
}

/// One view for all panels of a figure, so that they can be compared: it shows all grains of all.
fn common_view(outcomes: &[Outcome], figure: &str) -> View {
    let snapshots = of_figure(outcomes, figure).flat_map(|outcome| &outcome.snapshots);
    let mut view = View { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };
    for grain in snapshots.flat_map(|snapshot| &snapshot.grains) {
        view.min = view.min.min(grain.position - grain.radius);
        view.max = view.max.max(grain.position + grain.radius);
    }
    view
}

/// Height in pixels that shows a view whole, with the margins that [`Style::camera`] leaves.
fn panel_height(min: DVec2, max: DVec2, width: u32) -> u32 {
    /// Room above and below for margins and scale bar, pixels.
    const ROOM: f64 = 70.0;
    let shape = (max.y - min.y) / (max.x - min.x);
    (f64::from(width) * shape + ROOM).ceil() as u32
}

/// A number as a journal writes it: 10^{−4}, 2·10^{−3}.
fn power_of_ten(number: f64) -> String {
    let text = format!("{number:e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent = exponent.replace('-', "−");
    if mantissa == "1" {
        format!("10^{{{exponent}}}")
    } else {
        format!("{mantissa}·10^{{{exponent}}}")
    }
}
