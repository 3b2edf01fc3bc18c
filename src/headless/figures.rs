//! The paper's Fig. 3, 4 and 7, from simulation to finished figure.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;
use std::time::Instant;

use glam::DVec2;
use image::RgbaImage;
use rayon::prelude::*;

use super::folder::{EarlierFiles, RunFolder};
use super::manifest::{Ended, Manifest, PictureEntry, RunEntry, ShownMoment};
use super::options::texts_of_panel;
use super::table::ObservablesTable;
use super::writer::{go_on, interrupted, tell_of_alarms, tell_of_unconverged_steps};
use crate::error::Result;
use crate::output::{Progress, Texts, caught_signal, counted, print_line};
use crate::render::{Camera, PanelGrid, Style, draw_scene};
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
struct FigureRun {
    paper: PaperRun,
    snapshots: Vec<Snapshot>,
    recorded: Recorded,
}

/// Simulates the runs on all cores and draws the figures into `folder`.
pub(super) fn draw(folder: &Path, earlier: EarlierFiles) -> Result<()> {
    let claimed = RunFolder::claim(folder, earlier)?;
    let runs = paper_runs()?;
    let mut manifest = Manifest::new();
    for run in &runs {
        manifest.runs.push(RunEntry::start(&run.name, &run.scene)?);
    }
    claimed.clear()?;
    let mut writer = FigureWriter { folder, manifest };
    writer.write_manifest()?;
    let mut runs = simulate(folder, runs)?;

    let mut failure = None;
    for (entry, run) in writer.manifest.runs.iter_mut().zip(&mut runs) {
        let FigureRun { paper: PaperRun { scene, .. }, recorded, .. } = run;
        entry.end(Ended::of(recorded), recorded);
        tell_of_unconverged_steps(scene, &recorded.tally);
        tell_of_alarms(scene, recorded.simulation.alarms());
        let signal = caught_signal().filter(|_| recorded.interrupted);
        let by_signal = signal.map(|signal| interrupted(signal, recorded.simulation.observables()));
        failure = failure.or(recorded.failure.take()).or(by_signal);
    }
    let drawn = match failure {
        Some(failure) => Err(failure),
        None => writer.figures(&runs),
    };
    let written = writer.write_manifest();
    drawn.and(written)?;
    let count = counted(writer.manifest.pictures.len() as u64, "picture");
    print_line(format_args!("{count} in {}", folder.display()));
    Ok(())
}

/// Runs everything, dearest first, so that no core waits long for the last one.
fn simulate(folder: &Path, runs: Vec<PaperRun>) -> Result<Vec<FigureRun>> {
    let steps = |run: &PaperRun| run.scene.duration_secs / run.scene.parameters.time_step_secs;
    let progress = Progress::new("simulating", runs.iter().map(|run| steps(run) as u64).sum());
    let said = Mutex::new(());
    let runs = runs
        .into_par_iter()
        .with_max_len(1)
        .map(|run| {
            let started = Instant::now();
            let until_secs = run.times_secs.iter().copied().fold(0.0, f64::max);
            // A run that takes no step has no table.
            let path = folder.join(format!("{}.csv", run.name));
            let table = (until_secs > 0.0).then(|| ObservablesTable::start(path)).transpose()?;
            let mut recorder = FigureRecorder { table, snapshots: Vec::new(), progress: &progress };
            let mut recorded = record(&run.scene, &run.times_secs, until_secs, &mut recorder)?;
            let table = recorder.table.map_or(Ok(()), ObservablesTable::finish);
            recorded.failure = recorded.failure.or(table.err());
            let _one_at_a_time = said.lock();
            progress.say(&format!("{}: {:.1} s", run.name, started.elapsed().as_secs_f64()));
            Ok(FigureRun { paper: run, snapshots: recorder.snapshots, recorded })
        })
        .collect();
    progress.finish();
    runs
}

/// Keeps what the figures need of a run.
struct FigureRecorder<'a> {
    table: Option<ObservablesTable>,
    snapshots: Vec<Snapshot>,
    progress: &'a Progress,
}

impl Recorder for FigureRecorder<'_> {
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

/// Draws figures and writes the manifest.
struct FigureWriter<'a> {
    folder: &'a Path,
    manifest: Manifest,
}

impl FigureWriter<'_> {
    fn figures(&mut self, runs: &[FigureRun]) -> Result<()> {
        self.fig3(runs)?;
        self.fig4(runs)?;
        self.fig7(runs)
    }

    fn write_manifest(&self) -> Result<()> {
        self.manifest.write(&self.folder.join("manifest.json"))
    }

    fn fig3(&mut self, runs: &[FigureRun]) -> Result<()> {
        let Some(run) = of_figure(runs, "fig3").next() else { return Ok(()) };
        let view = run.paper.scene.view();
        let style = Style::default();
        let panel = self.panel(run, 0, "fig3_panel", view, FIG3_WIDTH, &style)?;
        let mut figure = PanelGrid::new(1, 1, vec![panel]);
        figure.title = "Initial state shared by all piles".into();
        figure.caption = format!(
            "{} discs rained between walls over a rough base and left to come to rest. \
             Greys mark layers two diameters high. At t = 0 the walls go.",
            run.paper.scene.grains.len()
        );
        self.write_figure("fig3.png", &figure.draw()?, vec![moment(run, 0)])
    }

    fn fig4(&mut self, runs: &[FigureRun]) -> Result<()> {
        let mut view = common_view(runs, "fig4");
        // The base belongs to the picture: its discs reach half a diameter below y = 0.
        view.min.y = -0.5 * runs[0].paper.scene.mean_diameter;
        let mut panels = Vec::new();
        let mut titles = Vec::new();
        let mut moments = Vec::new();
        for bond in FIG4_BONDS {
            for time_step_secs in FIG4_TIME_STEPS_SECS {
                let is_this = |run: &&FigureRun| {
                    let parameters = run.paper.scene.parameters;
                    parameters.bond == bond && parameters.time_step_secs == time_step_secs
                };
                let Some(run) = of_figure(runs, "fig4").find(is_this) else { continue };
                // The scale is the same in all panels: one bar says it.
                let style = Style { scale_bar: panels.is_empty(), ..Style::default() };
                let name = run.paper.name.clone();
                let slump = run.snapshots[0].observables.slump;
                titles.push(format!("Δy_{{G}} = {slump:.3}"));
                moments.push(moment(run, 0));
                panels.push(self.panel(run, 0, &name, view, PILE_PANEL_WIDTH, &style)?);
            }
        }
        let mut figure = PanelGrid::new(FIG4_BONDS.len(), FIG4_TIME_STEPS_SECS.len(), panels);
        figure.row_labels = FIG4_BONDS.map(|bond| format!("Bond = {bond}")).to_vec();
        figure.column_labels =
            FIG4_TIME_STEPS_SECS.map(|step| format!("Δt = {} s", power_of_ten(step))).to_vec();
        figure.panel_titles = titles;
        figure.titles_inside = true;
        let Some(run) = of_figure(runs, "fig4").next() else { return Ok(()) };
        figure.caption = format!(
            "The pile at t = {} s, from one initial state; Δy_{{G}} is the slump.",
            run.paper.scene.duration_secs
        );
        self.write_figure("fig4.png", &figure.draw()?, moments)
    }

    fn fig7(&mut self, runs: &[FigureRun]) -> Result<()> {
        let view = common_view(runs, "fig7");
        let mut panels = Vec::new();
        let mut moments = Vec::new();
        for (row, time_secs) in FIG7_TIMES_SECS.iter().enumerate() {
            for run in of_figure(runs, "fig7") {
                let style = Style { scale_bar: panels.is_empty(), ..Style::default() };
                let name = format!("{}_t{time_secs}", run.paper.name);
                moments.push(moment(run, row));
                panels.push(self.panel(run, row, &name, view, CRADLE_PANEL_WIDTH, &style)?);
            }
        }
        let mut figure = PanelGrid::new(FIG7_TIMES_SECS.len(), FIG7_TIME_STEPS_SECS.len(), panels);
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
        run: &FigureRun,
        number: usize,
        name: &str,
        View { min, max }: View,
        width: u32,
        style: &Style,
    ) -> Result<RgbaImage> {
        let height = panel_height(min, max, width);
        // The same camera with and without the bar: panels of one figure lie alike.
        let camera: Camera = Style::default().camera(min, max, width, height);
        let snapshot = &run.snapshots[number];
        let image = draw_scene(snapshot, style, &camera, width, height)?;
        let texts = texts_of_panel(&run.paper.scene, snapshot)?;
        self.write(&format!("{name}.png"), &image, vec![moment(run, number)], &texts)?;
        Ok(image)
    }

    /// Writes a figure, all of which one command draws.
    fn write_figure(
        &mut self,
        file: &str,
        image: &RgbaImage,
        shows: Vec<ShownMoment>,
    ) -> Result<()> {
        let mut texts = Texts::default();
        texts.add("Command line", "slump --headless --frames figures");
        self.write(file, image, shows, &texts)
    }

    fn write(
        &mut self,
        file: &str,
        image: &RgbaImage,
        shows: Vec<ShownMoment>,
        texts: &Texts,
    ) -> Result<()> {
        write_png(&self.folder.join(file), image, texts)?;
        let entry = PictureEntry { file: file.to_owned(), shows };
        self.manifest.add(entry, &self.folder.join("manifest.json"))
    }
}

fn moment(run: &FigureRun, number: usize) -> ShownMoment {
    let observables = run.snapshots[number].observables;
    ShownMoment { run: run.paper.name.clone(), observables }
}

fn of_figure<'a>(runs: &'a [FigureRun], figure: &'a str) -> impl Iterator<Item = &'a FigureRun> {
    runs.iter().filter(move |run| run.paper.figure == figure)
}

/// One view for all panels of a figure, so that they can be compared: it shows all grains of all.
fn common_view(runs: &[FigureRun], figure: &str) -> View {
    let snapshots = of_figure(runs, figure).flat_map(|run| &run.snapshots);
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
