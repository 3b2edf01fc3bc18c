//! Stability maps: where, over two parameters, each method holds, where it sinks or overlaps by more
//! than 1 % of d, and where it is lost: torn, thrown, or no longer finite.
//!
//! Theory gives their borders. A step of Gauss–Seidel from nothing leaves the share
//! ρ^s of what gravity adds to the slowest mode, g Δt, and of what the step before left. So a column
//! sinks with
//!
//! > v = A g Δt ρ^s / (1 − ρ^s),
//!
//! where A = 4/π is the slowest mode's part at the top of a column of many (1 for two discs) and ρ is
//! what `scene::stability` derives for each scene. In T it sinks by v T = 0.01 d where
//! s = ln(q/(1 + q)) / ln ρ, q = 0.01 d/(A g Δt T). The border of springs is their critical time step.
//!
//! Over Δt and Bond the border is that of statics, where C₀ no longer carries the cantilever; Δt does not enter. A bond
//! pulls no more than is asked of it, so that no impulse of cohesion pulls grains into each other however long the step.

use std::f64::consts::{FRAC_PI_2, PI};

use rayon::prelude::*;

use super::rest::{sagging, sunk};
use super::table::colour;
use super::{TriedVariant, VARIANTS, jitter};
use crate::chart::{Axis, Chart, INK, Layer, Look, MapCell, Sheet, points};
use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::scene::stability::{
    breaking_bond_of_cantilever, cantilever, column_on_line, mass_ratio,
};

/// Simulated time of every run, s.
const DURATION_SECS: f64 = 0.1;
/// Sinking or overlap that counts, in d.
const COUNTS: f64 = 0.01;
/// Part of the slowest mode in the motion of a column's top.
const TOP_OF_COLUMN: f64 = 4.0 / PI;

/// A grain that has gone this far is lost, in d.
const LOST: f64 = 1.0;
/// Speed that a scene at rest does not have at its end, in √(g d).
const SHAKES: f64 = 0.05;
const SPRINGS_SHAKE: f64 = 4e-3;
/// Discs of the column whose size is not varied.
const DISCS: usize = 20;
/// Discs in a row of the cantilever.
const CANTILEVER: i32 = 4;
/// Width of a chart, pixels.
const CHART_WIDTH: u32 = 500;
/// Charts side by side.
const ABREAST: usize = 5;

/// A parameter of a map.
struct Parameter {
    label: &'static str,
    from: f64,
    to: f64,
    /// Values of a full pass; a quick one takes half as many.
    count: usize,
    whole: bool,
}

impl Parameter {
    /// Its values, in ratio, each with the edges of its cell.
    fn values(&self, quick: bool) -> Vec<(f64, [f64; 2])> {
        let count = if quick { self.count / 2 } else { self.count };
        let ratio = (self.to / self.from).powf(1.0 / count as f64);
        let edge = |k: usize| self.from * ratio.powi(k as i32);
        (0..count)
            .map(|k| {
                let middle = (edge(k) * edge(k + 1)).sqrt();
                (if self.whole { middle.round().max(1.0) } else { middle }, [edge(k), edge(k + 1)])
            })
            .collect()
    }
}

/// A map of two parameters.
struct Map {
    name: &'static str,
    title: &'static str,
    x: Parameter,
    y: Parameter,
    scene: fn(f64, f64) -> Scene,
    /// True if springs swing in it for longer than a run.
    may_swing: bool,
    /// What theory says.
    borders: &'static [Border],
    /// What is said of the borders.
    caption: &'static str,
}

/// A border against x.
struct Border {
    /// The variant that has it, or all.
    of: Option<&'static str>,
    look: Look,
    at: fn(f64) -> Result<f64>,
}

const fn border(of: &'static str, look: Look, at: fn(f64) -> Result<f64>) -> Border {
    Border { of: Some(of), look, at }
}

const fn sweeps(to: f64) -> Parameter {
    Parameter { label: "sweeps (substeps) a step", from: 1.0, to, count: 14, whole: true }
}

const fn time_step() -> Parameter {
    Parameter { label: "Δt (s)", from: 1e-4, to: 1e-2, count: 12, whole: false }
}

const OF_SWEEPS: &str =
    "Dashed: the border of Gauss–Seidel in theory. Line: the critical time step of springs.";
const THEORY: Look = Look::Dashes(3);
const CRITICAL: Look = Look::Line(3);

/// All maps.
const MAPS: [Map; 4] = [
    Map {
        name: "map-dt-bond",
        title: "cantilever",
        x: time_step(),
        y: Parameter { label: "Bond", from: 5.0, to: 500.0, count: 12, whole: false },
        scene: |time_step_secs, bond| {
            let mut scene = cantilever(CANTILEVER);
            scene.parameters.time_step_secs = time_step_secs;
            scene.parameters.bond = bond;
            scene
        },
        may_swing: true,
        borders: &[Border {
            of: None,
            look: THEORY,
            at: |_| Ok(breaking_bond_of_cantilever(CANTILEVER)),
        }],
        caption: "Dashed: the Bond number below which it tears by statics, without friction; the friction of 0.5 here lowers it by 5 %. Springs may swing.",
    },
    Map {
        name: "map-dt-sweeps",
        title: "column of 20",
        x: time_step(),
        y: sweeps(1e3),
        scene: |time_step_secs, sweeps| sagging_on_line(DISCS, time_step_secs, sweeps),
        may_swing: false,
        borders: &[
            border("nsgs", THEORY, |step| {
                Ok(sweeps_at_border(TOP_OF_COLUMN, step, contraction_of_column(DISCS as f64)))
            }),
            border("dem", CRITICAL, |step| substeps_at_border(DISCS, step)),
        ],
        caption: OF_SWEEPS,
    },
    Map {
        name: "map-mass-sweeps",
        title: "heavy on light",
        x: Parameter { label: "ratio of masses", from: 1.0, to: 1e4, count: 12, whole: false },
        y: sweeps(1e5),
        scene: |ratio, sweeps| {
            let mut scene = mass_ratio(ratio);
            scene.solver = sagging(1, sweeps as u32).solver;
            scene
        },
        may_swing: false,
        borders: &[border("nsgs", THEORY, |ratio| {
            Ok(sweeps_at_border(1.0, 1e-3, ratio / (ratio + 1.0)))
        })],
        caption: OF_SWEEPS,
    },
    Map {
        name: "map-discs-sweeps",
        title: "columns",
        x: Parameter { label: "discs", from: 2.0, to: 100.0, count: 12, whole: true },
        y: sweeps(1e4),
        scene: |count, sweeps| sagging_on_line(count as usize, 1e-3, sweeps),
        may_swing: false,
        borders: &[
            border("nsgs", THEORY, |count| {
                Ok(sweeps_at_border(TOP_OF_COLUMN, 1e-3, contraction_of_column(count)))
            }),
            border("dem", CRITICAL, |count| substeps_at_border(count as usize, 1e-3)),
        ],
        caption: OF_SWEEPS,
    },
];

fn sagging_on_line(count: usize, time_step_secs: f64, sweeps: f64) -> Scene {
    let mut scene = column_on_line(count);
    scene.solver = sagging(count, sweeps as u32).solver;
    scene.parameters.time_step_secs = time_step_secs;
    scene
}

/// 0 where the variant holds, 1 where it sinks or overlaps, 2 where it is lost. `may_swing`: what
/// stands on springs has not come to rest by the end, and is not lost for that.
fn class(variant: &TriedVariant, scene: &Scene, may_swing: bool) -> Result<f64> {
    let mut scene = scene.clone();
    variant.apply(&mut scene);
    let mut simulation = scene.simulation()?;
    let mut overlap = 0f64;
    while simulation.time_secs() < DURATION_SECS {
        match simulation.step() {
            Ok(observables) => overlap = overlap.max(observables.max_overlap),
            Err(Error::NonFinite { .. }) => return Ok(2.0),
            Err(error) => return Err(error),
        }
    }
    let way = sunk(&simulation, &scene);
    // A step left unsolved sinks steadily; stiff springs that are stable have come to rest.
    let springs = simulation.critical_time_step_secs().is_some();
    let calm = match (springs, may_swing) {
        (false, _) => SHAKES,
        (true, false) => SPRINGS_SHAKE,
        (true, true) => f64::INFINITY,
    };
    let shakes = jitter(&simulation) > calm;
    Ok(if way > LOST || shakes {
        2.0
    } else if way.max(overlap) > COUNTS {
        1.0
    } else {
        0.0
    })
}

/// Who has a map.
fn of_registry() -> impl Iterator<Item = &'static TriedVariant> {
    VARIANTS.iter().filter(|one| one.is_of_registry())
}

/// All maps, each with its file's name: the methods of the registry side by side.
///
/// # Errors
/// Where a scene is not sound.
pub fn maps(quick: bool, progress: impl Fn() + Sync) -> Result<Vec<(String, Sheet)>> {
    let mut sheets = Vec::new();
    for map in &MAPS {
        let mut charts = Vec::new();
        for variant in of_registry() {
            charts.push(map.chart(variant, quick, &progress)?);
        }
        for (number, charts) in charts.chunks(ABREAST).enumerate() {
            let caption = vec![
                "Green holds; yellow sinks or overlaps by more than 1 % of d in 0.1 s; red is torn, thrown, still shaking or not finite.".to_owned(),
                map.caption.to_owned(),
            ];
            let size = (CHART_WIDTH * charts.len() as u32, 620);
            let sheet = Sheet { size, charts: charts.to_vec(), caption };
            sheets.push((format!("{}-{}", map.name, number + 1), sheet));
        }
    }
    Ok(sheets)
}

/// Number of charts of all maps.
pub fn count_of_maps() -> usize {
    MAPS.len() * of_registry().count()
}

impl Map {
    fn chart(&self, variant: &TriedVariant, quick: bool, progress: &impl Fn()) -> Result<Chart> {
        let rows = self.y.values(quick);
        let cells = self
            .x
            .values(quick)
            .into_par_iter()
            .flat_map_iter(|x| rows.iter().map(move |y| (x, *y)))
            .map(|(x, y)| {
                let value = class(variant, &(self.scene)(x.0, y.0), self.may_swing)?;
                Ok(MapCell { x, y, value })
            })
            .collect::<Result<Vec<_>>>()?;
        let mut chart = Chart::new(
            format!("{}: {}", self.title, variant.name),
            Axis::log(self.x.label, self.x.from, self.x.to),
            Axis::log(self.y.label, self.y.from, self.y.to),
        );
        chart.layers.push(Layer::Cells { name: variant.name.into(), cells, colour });
        let ratio = (self.x.to / self.x.from).powf(1.0 / 60.0);
        let places: Vec<f64> = (0..=60).map(|k| self.x.from * ratio.powi(k)).collect();
        for Border { of, look, at } in self.borders {
            if of.is_some_and(|of| of != variant.name) {
                continue;
            }
            let mut curve = Vec::new();
            for &x in &places {
                curve.push((x, at(x)?));
            }
            curve.retain(|(_, y)| (self.y.from..=self.y.to).contains(y));
            chart.layers.push(Layer::quiet("border", points(curve), INK, *look));
        }
        progress();
        Ok(chart)
    }
}

/// What a sweep of Gauss–Seidel leaves of the slowest mode of a column.
pub fn contraction_of_column(count: f64) -> f64 {
    (FRAC_PI_2 / count).cos().powi(2)
}

fn sweeps_at_border(part: f64, time_step_secs: f64, contraction: f64) -> f64 {
    let scene = column_on_line(1);
    let fall = part * scene.gravity.magnitude() * time_step_secs * DURATION_SECS;
    let q = COUNTS * scene.mean_diameter / fall;
    (q / (1.0 + q)).ln() / contraction.ln()
}

fn substeps_at_border(count: usize, time_step_secs: f64) -> Result<f64> {
    let mut scene = column_on_line(count);
    if let Some(dem) = VARIANTS.iter().find(|variant| variant.name == "dem") {
        dem.apply(&mut scene);
    }
    let critical_secs = scene.simulation()?.critical_time_step_secs().unwrap_or(f64::INFINITY);
    Ok(time_step_secs / critical_secs)
}
