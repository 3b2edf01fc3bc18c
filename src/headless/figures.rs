//! Simulates the piles and the cradle of Abramian & Staron (2020) and draws Figs. 3, 4 and 7 of their paper.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;
use std::time::Instant;

use glam::DVec2;
use image::RgbaImage;
use rayon::prelude::*;

use super::folder::{EarlierFiles, RunFolder};
use super::manifest::{Manifest, PictureEntry, RunEntry, RunStatus, ShownMoment};
use super::options::texts_of_panel;
use super::table::ObservablesTable;
use super::writer::{go_on, interrupted, tell_of_alarms, tell_of_unconverged_steps};
use crate::error::Result;
use crate::output::{Progress, Texts, caught_signal, counted, note_line, print_line};
use crate::render::{PanelGrid, Renderer, RendererChoice, Style, draw_scene};
use crate::scene::View;
use crate::sim::{Observables, Snapshot};
use crate::study::png::write_png;
use crate::study::{
    FIG4_BONDS, FIG4_TIME_STEPS_SECS, FIG7_TIME_STEPS_SECS, FIG7_TIMES_SECS, PaperRun, Recorded,
    Recorder, paper_runs, record,
};
use crate::threads::make_threads;

/// Width of a panel of Fig. 4 of Abramian & Staron (2020), pixels.
const PILE_PANEL_WIDTH: u32 = 640;
/// Width of Fig. 3 of Abramian & Staron (2020), pixels.
const FIG3_WIDTH: u32 = 1280;
/// Width of a panel of Fig. 7 of Abramian & Staron (2020), pixels.
const CRADLE_PANEL_WIDTH: u32 = 720;

struct FigureRun {
    paper: PaperRun,
    snapshots: Vec<Snapshot>,
    recorded: Recorded,
}

/// Simulates the runs of Figs. 3, 4 and 7 of Abramian & Staron (2020) on all cores and draws the figures into `folder`.
pub(super) fn draw(folder: &Path, earlier: EarlierFiles, renderer: RendererChoice) -> Result<()> {
    let mut renderer = Renderer::new(renderer)?;
    make_threads()?;
    let claimed = RunFolder::claim(folder, earlier)?;
    let runs = paper_runs()?;
    let mut manifest = Manifest::new(renderer.name());
    for run in &runs {
        manifest.runs.push(RunEntry::start(&run.name, &run.scene)?);
    }
    claimed.clear()?;
    note_line(format_args!("drawing with {}", renderer.name()));
    let mut writer = FigureWriter { folder, renderer: &mut renderer, manifest };
    writer.write_manifest()?;
    let mut runs = simulate(folder, runs)?;

    let mut failure = None;
    for (entry, run) in writer.manifest.runs.iter_mut().zip(&mut runs) {
        let FigureRun { paper: PaperRun { scene, .. }, recorded, .. } = run;
        entry.end(RunStatus::of(recorded), recorded);
        tell_of_unconverged_steps(scene, &recorded.tally);
        tell_of_alarms(scene, recorded.simulation.alarms());
        let signal = caught_signal().filter(|_| recorded.interrupted);
        let by_signal = signal.map(|signal| interrupted(signal, recorded.simulation.observables()));
        failure = failure.or(recorded.failure.take()).or(by_signal);
    }
    let drawn = match failure {
        Some(failure) => Err(failure),
        None => {
            writer.fig3(&runs).and_then(|()| writer.fig4(&runs)).and_then(|()| writer.fig7(&runs))
        }
    };
    let written = writer.write_manifest();
    drawn.and(written)?;
    let count = counted(writer.manifest.pictures.len() as u64, "picture");
    print_line(format_args!("{count} in {}", folder.display()));
    Ok(())
}

/// Simulates the runs of all figures. The most expensive run starts first, so that at the end no core is idle for long.
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
            // A run that takes no steps has no table.
            let path = folder.join(format!("{}.csv", run.name));
            let table = (until_secs > 0.0).then(|| ObservablesTable::start_as(path)).transpose()?;
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

/// Recorder of a run: keeps the snapshots that the figures need, and writes the table of observables (quantities that
/// are measured in each step).
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

struct FigurePanel<'a> {
    run: &'a FigureRun,
    /// Index of the snapshot that the panel shows, in the run's list of snapshots.
    number: usize,
    /// Name of the panel's file without its ending.
    name: String,
}

impl FigurePanel<'_> {
    fn moment(&self) -> ShownMoment {
        let observables = self.run.snapshots[self.number].observables;
        ShownMoment { run: self.run.paper.name.clone(), observables }
    }
}

struct FigureWriter<'a> {
    folder: &'a Path,
    renderer: &'a mut Renderer,
    manifest: Manifest,
}

impl FigureWriter<'_> {
    fn write_manifest(&self) -> Result<()> {
        self.manifest.write(&self.folder.join("manifest.json"))
    }

    fn fig3(&mut self, runs: &[FigureRun]) -> Result<()> {
        let Some(run) = of_figure(runs, "fig3").next() else { return Ok(()) };
        let panels = vec![FigurePanel { run, number: 0, name: "fig3_panel".into() }];
        let mut figure = self.panels([1, 1], &panels, run.paper.scene.view(), FIG3_WIDTH)?;
        figure.title = "Initial state shared by all piles".into();
        figure.caption = format!(
            "{} discs rained between walls over a rough base and left to come to rest. \
             Greys mark layers two diameters high. At t = 0 the walls go.",
            run.paper.scene.grains.len()
        );
        self.figure("fig3.png", &figure, &panels)
    }

    fn fig4(&mut self, runs: &[FigureRun]) -> Result<()> {
        let mut view = common_view(runs, "fig4");
        // The rough base belongs to the picture. Its fixed discs reach half a diameter below y = 0.
        view.min.y = -0.5 * runs[0].paper.scene.mean_diameter;
        let mut panels = Vec::new();
        for bond in FIG4_BONDS {
            for time_step_secs in FIG4_TIME_STEPS_SECS {
                let is_this = |run: &&FigureRun| {
                    let parameters = run.paper.scene.parameters;
                    parameters.bond == bond && parameters.time_step_secs == time_step_secs
                };
                let run = of_figure(runs, "fig4").find(is_this);
                let panel = |run| FigurePanel { run, number: 0, name: run.paper.name.clone() };
                panels.extend(run.map(panel));
            }
        }
        let Some(FigurePanel { run, .. }) = panels.first() else { return Ok(()) };
        let grid = [FIG4_BONDS.len(), FIG4_TIME_STEPS_SECS.len()];
        let mut figure = self.panels(grid, &panels, view, PILE_PANEL_WIDTH)?;
        figure.row_labels = FIG4_BONDS.map(|bond| format!("Bond = {bond}")).to_vec();
        figure.column_labels = FIG4_TIME_STEPS_SECS.map(time_step).to_vec();
        let title = |panel: &FigurePanel| {
            format!("Δy_{{G}} = {:.3}", panel.run.snapshots[0].observables.slump)
        };
        figure.panel_titles = panels.iter().map(title).collect();
        figure.caption = format!(
            "The pile at t = {} s, from one initial state; Δy_{{G}} is the slump.",
            run.paper.scene.duration_secs
        );
        self.figure("fig4.png", &figure, &panels)
    }

    fn fig7(&mut self, runs: &[FigureRun]) -> Result<()> {
        let view = common_view(runs, "fig7");
        let mut panels = Vec::new();
        for (number, time_secs) in FIG7_TIMES_SECS.iter().enumerate() {
            panels.extend(of_figure(runs, "fig7").map(|run| {
                let name = format!("{}_t{time_secs}", run.paper.name);
                FigurePanel { run, number, name }
            }));
        }
        let grid = [FIG7_TIMES_SECS.len(), FIG7_TIME_STEPS_SECS.len()];
        let mut figure = self.panels(grid, &panels, view, CRADLE_PANEL_WIDTH)?;
        figure.row_labels = FIG7_TIMES_SECS.map(|time| format!("t = {time} s")).to_vec();
        figure.column_labels = FIG7_TIME_STEPS_SECS.map(time_step).to_vec();
        figure.caption =
            "Three discs drawn towards the dot: k (dark grey) falls on the bonded pair \
                          of i (white) and j (light grey; does not feel the attraction)."
                .into();
        self.figure("fig7.png", &figure, &panels)
    }

    /// Draws panels, each `width` pixels wide and as high as `view` (the visible part of the scene) needs, and writes
    /// each panel to a file.
    fn panels(
        &mut self,
        [rows, columns]: [usize; 2],
        panels: &[FigurePanel],
        view: View,
        width: u32,
    ) -> Result<PanelGrid> {
        let height = panel_height(view, width);
        // All panels have the same camera, with or without the scale bar, so that they have the same scale.
        let camera = Style::default().camera(view.min, view.max, width, height);
        let mut images = Vec::new();
        for panel in panels {
            // All panels have the same scale, so only the first has a scale bar.
            let style = Style { scale_bar: images.is_empty(), ..Style::default() };
            let snapshot = &panel.run.snapshots[panel.number];
            let image = draw_scene(self.renderer, snapshot, &style, &camera, width, height)?;
            let texts = texts_of_panel(&panel.run.paper.scene, snapshot)?;
            let file = format!("{}.png", panel.name);
            self.write(&file, &image, vec![panel.moment()], &texts)?;
            images.push(image);
        }
        Ok(PanelGrid::new(rows, columns, images))
    }

    /// Writes a figure that consists of several panels to a file. The file contains the command that reproduces the
    /// figure.
    fn figure(&mut self, file: &str, figure: &PanelGrid, panels: &[FigurePanel]) -> Result<()> {
        let mut texts = Texts::default();
        texts.add("Command line", "slump --headless --frames figures");
        let shows = panels.iter().map(FigurePanel::moment).collect();
        self.write(file, &figure.draw(), shows, &texts)
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

fn of_figure<'a>(runs: &'a [FigureRun], figure: &'a str) -> impl Iterator<Item = &'a FigureRun> {
    runs.iter().filter(move |run| run.paper.figure == figure)
}

/// Returns the visible part of the scene for all panels of a figure. It contains all grains of all runs; because it is
/// the same in all panels, the panels can be compared.
fn common_view(runs: &[FigureRun], figure: &str) -> View {
    let snapshots = of_figure(runs, figure).flat_map(|run| &run.snapshots);
    let mut view = View { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };
    for grain in snapshots.flat_map(|snapshot| &snapshot.grains) {
        view.min = view.min.min(grain.position - grain.radius);
        view.max = view.max.max(grain.position + grain.radius);
    }
    view
}

/// Returns the height of a panel, pixels, at which the whole view is visible, including the margins of
/// [`Style::camera`].
fn panel_height(View { min, max }: View, width: u32) -> u32 {
    /// Total height of the space above and below the grains, for margins and scale bar, pixels.
    const ROOM: f64 = 70.0;
    let shape = (max.y - min.y) / (max.x - min.x);
    (f64::from(width) * shape + ROOM).ceil() as u32
}

/// Returns the text of a time step in scientific notation, such as Δt = 10^{−4} s or Δt = 2·10^{−3} s.
fn time_step(secs: f64) -> String {
    let text = format!("{secs:e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let factor = if mantissa == "1" { String::new() } else { format!("{mantissa}·") };
    format!("Δt = {factor}10^{{{}}} s", exponent.replace('-', "−"))
}
