//! Draws stability maps over two parameters, for scenes that must stay at rest. A map shows three regions: a solver
//! method keeps the scene at rest; the scene sinks, or grains overlap, by more than 1 % of the diameter d; grains are
//! torn off, thrown away or still shaking, or positions become NaN or infinite.
//!
//! Theory gives the boundaries of the regions. Sweeps of Gauss–Seidel remove the velocity of a falling column only in
//! part. The slowest mode (the velocity pattern that decreases most slowly) has, before a step, the velocity g Δt from
//! gravity plus the velocity that remains from the previous step. A step of s sweeps without a warm start leaves the
//! fraction ρ^s of this velocity, where ρ is the factor by which one sweep reduces the mode. A column therefore sinks
//! with the velocity
//!
//! > v = A g Δt ρ^s / (1 − ρ^s),
//!
//! where A = 4/π is the slowest mode's amplitude at the top of a tall column (1 for two discs), and `scene::stability`
//! derives ρ for each scene. In the time T the column sinks by v T = 0.01 d if s = ln(q/(1 + q)) / ln ρ, with q = 0.01
//! d/(A g Δt T). For steppers with springs, the boundary is the critical time step of explicit integration.
//!
//! On the map over Δt and Bond number, the boundary follows from statics: below a certain Bond number the cohesion
//! force C₀ no longer supports the cantilever. This Bond number does not depend on Δt. The force of a bond is a
//! reaction, so cohesion does not pull grains into each other, however long the step is.

use std::f64::consts::{FRAC_PI_2, PI};

use rayon::prelude::*;

use super::rest::{CANTILEVER, sagging, sunk};
use super::table::colour;
use super::{VARIANTS, jitter, step_by};
use crate::chart::{Axis, Chart, INK, Layer, Look, MapCell, Sheet, points};
use crate::error::{Error, Result};
use crate::harness::{Change, Effort};
use crate::scene::Scene;
use crate::scene::stability::{
    breaking_bond_of_cantilever, cantilever, column_on_line, mass_ratio,
};
use crate::sim::Stepper;
use crate::solver::METHODS;

/// Simulated time of every run of a stability map, s. A stability map is a chart of two parameters that shows where a
/// solver keeps a scene at rest.
const DURATION_SECS: f64 = 0.1;
/// Limit of the sinking distance and of the overlap, in diameters d. A run above this limit is marked as sinking on the
/// stability map, a chart that shows where a solver keeps a scene at rest.
const COUNTS: f64 = 0.01;
/// Amplitude A, at the top of a tall column, of the mode (velocity pattern) that Gauss–Seidel sweeps reduce most
/// slowly, dimensionless. If all discs fall with the same velocity, 4/π of this velocity is in this mode. The velocity
/// with which a column sinks is proportional to A.
const TOP_OF_COLUMN: f64 = 4.0 / PI;
/// Displacement of a grain during a run, in diameters d, above which the grain counts as torn off or thrown away on a
/// stability map (a chart that shows where a solver keeps a scene at rest).
const LOST: f64 = 1.0;
/// Root mean square speed of the grains at the end of a run above which the scene counts as shaking, in √(g d), with
/// gravity g and diameter d. The first value is for rigid grains. It is larger, because a scene whose steps are not
/// solved accurately sinks steadily and must not count as shaking. The second value is for grains on springs, which are
/// at rest at the end of a run if the springs are stable.
const SHAKES: [f64; 2] = [0.05, 4e-3];
/// Number of discs of a column in those stability maps (charts that show where a solver keeps a scene at rest) that do
/// not vary this number.
const DISCS: usize = 20;
/// Width and height of the chart of a stability map, pixels.
const CHART: (u32, u32) = (500, 500);
/// Number of charts side by side on a sheet of stability maps.
const ABREAST: usize = 5;

/// A parameter that is varied along one of the two axes of a stability map, a chart that shows where a solver keeps a
/// scene at rest.
struct Parameter {
    label: &'static str,
    from: f64,
    to: f64,
    /// True if the values of the parameter are integers.
    whole: bool,
}

const TIME_STEP: Parameter = Parameter { label: "Δt (s)", from: 1e-4, to: 1e-2, whole: false };

const fn sweeps(to: f64) -> Parameter {
    Parameter { label: "sweeps (substeps) a step", from: 1.0, to, whole: true }
}

impl Parameter {
    /// Returns the tested values of the parameter: twelve (six in a quick pass, a pass with fewer runs), with a
    /// constant ratio of neighbouring values. Each value comes with the lower and the upper edge of its cell on the
    /// map.
    fn values(&self, effort: Effort) -> Vec<(f64, [f64; 2])> {
        let count = effort.pick(6, 12);
        let ratio = (self.to / self.from).powf(1.0 / f64::from(count));
        let edge = |k: i32| self.from * ratio.powi(k);
        let value = |k: i32| {
            let middle = (edge(k) * edge(k + 1)).sqrt();
            (if self.whole { middle.round().max(1.0) } else { middle }, [edge(k), edge(k + 1)])
        };
        (0..count).map(value).collect()
    }

    fn axis(&self) -> Axis {
        Axis::log(self.label, self.from, self.to)
    }
}

/// A theoretical boundary on a stability map, a chart that shows where a solver keeps a scene at rest. The first text
/// is the name of the boundary. The second text is the name of the stepper or solver method on whose charts the
/// boundary is drawn; empty for all. The function returns the y value of the boundary from the x value.
type Border = (&'static str, &'static str, fn(f64) -> Result<f64>);

/// Description of a stability map (a chart that shows where a solver keeps a scene at rest): the scene, the two varied
/// parameters, and the theoretical boundaries.
struct Map {
    name: &'static str,
    title: &'static str,
    x: Parameter,
    y: Parameter,
    scene: fn(f64, f64) -> Scene,
    borders: &'static [Border],
}

/// All stability maps, charts that show where a solver keeps a scene at rest: the map of a cantilever over time step
/// and Bond number, and three maps of columns and of a heavy disc on a light disc.
const MAPS: [Map; 4] = [
    Map {
        name: "map-dt-bond",
        title: "cantilever",
        x: TIME_STEP,
        y: Parameter { label: "Bond", from: 5.0, to: 500.0, whole: false },
        scene: |time_step_secs, bond| {
            let mut scene = cantilever(CANTILEVER);
            scene.parameters.time_step_secs = time_step_secs;
            scene.parameters.bond = bond;
            scene
        },
        borders: &[(STATICS, "", |_| Ok(breaking_bond_of_cantilever(CANTILEVER)))],
    },
    Map {
        name: "map-dt-sweeps",
        title: "column of 20",
        x: TIME_STEP,
        y: sweeps(1e3),
        scene: |time_step_secs, sweeps| sagging_on_line(DISCS, time_step_secs, sweeps),
        borders: &[
            ("theory", "nsgs", |time_step_secs| {
                let contraction = contraction_of_column(DISCS as f64);
                Ok(sweeps_at_border(TOP_OF_COLUMN, time_step_secs, contraction))
            }),
            (SPRINGS, "dem", |time_step_secs| substeps_at_border(DISCS, time_step_secs)),
        ],
    },
    Map {
        name: "map-mass-sweeps",
        title: "heavy on light",
        x: Parameter { label: "ratio of masses", from: 1.0, to: 1e4, whole: false },
        y: sweeps(1e5),
        scene: |ratio, sweeps| {
            let mut scene = mass_ratio(ratio);
            scene.solver = sagging(1, sweeps as u32).solver;
            scene
        },
        borders: &[("theory", "nsgs", |ratio| {
            Ok(sweeps_at_border(1.0, 1e-3, ratio / (ratio + 1.0)))
        })],
    },
    Map {
        name: "map-discs-sweeps",
        title: "columns",
        x: Parameter { label: "discs", from: 2.0, to: 100.0, whole: true },
        y: sweeps(1e4),
        scene: |count, sweeps| sagging_on_line(count as usize, 1e-3, sweeps),
        borders: &[
            ("theory", "nsgs", |count| {
                Ok(sweeps_at_border(TOP_OF_COLUMN, 1e-3, contraction_of_column(count)))
            }),
            (SPRINGS, "dem", |count| substeps_at_border(count as usize, 1e-3)),
        ],
    },
];

const STATICS: &str = "statics";
const SPRINGS: &str = "critical time step";

fn sagging_on_line(count: usize, time_step_secs: f64, sweeps: f64) -> Scene {
    let mut scene = column_on_line(count);
    scene.solver = sagging(count, sweeps as u32).solver;
    scene.parameters.time_step_secs = time_step_secs;
    scene
}

/// Runs a scene and returns the class of the run: 0 if the variant of the solver keeps the scene at rest, 1 if the
/// scene sinks or grains overlap, 2 if grains are torn off, thrown away or still shaking, or if positions become NaN or
/// infinite.
///
/// A scene whose steps are not solved accurately sinks steadily and does not count as shaking. Grains on stable, stiff
/// springs are at rest at the end of a run; with `may_swing`, grains on springs are allowed to swing.
fn class(variant: &Change, scene: &Scene, may_swing: bool) -> Result<f64> {
    let mut scene = scene.clone();
    step_by(variant, &mut scene);
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
    let springs = simulation.critical_time_step_secs().is_some();
    let shakes = !(springs && may_swing) && jitter(&simulation) > SHAKES[usize::from(springs)];
    Ok(if way > LOST || shakes {
        2.0
    } else if way.max(overlap) > COUNTS {
        1.0
    } else {
        0.0
    })
}

/// Returns the variants of the solver for which maps are drawn: every solver method and every stepper, without further
/// changes of settings.
fn of_registry() -> impl Iterator<Item = &'static Change> {
    let steppers = Stepper::ALL.iter().map(|stepper| stepper.name());
    let names: Vec<&str> = METHODS.iter().map(|info| info.name).chain(steppers).collect();
    VARIANTS.iter().filter(move |variant| names.contains(&&*variant.name))
}

/// Draws all stability maps (charts that show where a solver keeps a scene at rest), with the charts of several solver
/// methods and steppers side by side on a sheet. Returns each sheet with the name of its file. `progress` is called
/// after each chart.
///
/// # Errors
/// If a scene is invalid.
pub fn maps(quick: bool, progress: impl Fn() + Sync) -> Result<Vec<(String, Sheet)>> {
    let mut sheets = Vec::new();
    for map in &MAPS {
        let mut charts = Vec::new();
        for variant in of_registry() {
            charts.push(map.chart(variant, Effort::new(quick))?);
            progress();
        }
        for (number, charts) in charts.chunks(ABREAST).enumerate() {
            let mut caption = vec![
                "Green holds; yellow sinks or overlaps by more than 1 % of d in 0.1 s; red is torn, thrown, still \
                    shaking or not finite.".to_owned(),
            ];
            caption.push(if map.can_swing() {
                "Dashed: the Bond number below which it tears by statics, without friction; the friction of 0.5 \
                    here lowers it by 5 %. Springs may swing."
            } else {
                "Dashed: the border of Gauss–Seidel in theory. Line: the critical time step of springs."
            }.to_owned());
            let size = (CHART.0 * charts.len() as u32, CHART.1);
            let sheet = Sheet { size, charts: charts.to_vec(), caption };
            sheets.push((format!("{}-{}", map.name, number + 1), sheet));
        }
    }
    Ok(sheets)
}

/// Returns the number of charts that [`maps`] draws: one chart per stability map and solver method or stepper.
pub fn count_of_maps() -> usize {
    MAPS.len() * of_registry().count()
}

impl Map {
    /// Returns true if springs between grains may swing at the end of a run on this map without the scene counting as
    /// shaking. This is so for the map of the cantilever, which swings under the stepper `dem` for longer than a run.
    fn can_swing(&self) -> bool {
        self.borders.iter().any(|(name, ..)| *name == STATICS)
    }

    fn chart(&self, variant: &Change, effort: Effort) -> Result<Chart> {
        let rows = self.y.values(effort);
        let columns = self.x.values(effort).into_par_iter();
        let cells = columns
            .flat_map_iter(|x| rows.iter().map(move |y| (x, *y)))
            .map(|(x, y)| {
                let value = class(variant, &(self.scene)(x.0, y.0), self.can_swing())?;
                Ok(MapCell { x, y, value })
            })
            .collect::<Result<Vec<_>>>()?;
        let title = format!("{}: {}", self.title, variant.name);
        let mut chart = Chart::new(title, self.x.axis(), self.y.axis());
        chart.layers.push(Layer::Cells { name: variant.name.clone(), cells, colour });
        let (from, to) = (self.x.from, self.x.to);
        for (name, of, border) in self.borders {
            if !of.is_empty() && *of != variant.name {
                continue;
            }
            let mut curve = Vec::new();
            for k in 0..=60 {
                let x = from * (to / from).powf(f64::from(k) / 60.0);
                curve.push((x, border(x)?));
            }
            curve.retain(|(_, y)| (self.y.from..=self.y.to).contains(y));
            let look = if *name == SPRINGS { Look::Line(3) } else { Look::Dashes(3) };
            chart.layers.push(Layer::quiet(*name, points(curve), INK, look));
        }
        Ok(chart)
    }
}

/// Returns the factor by which one sweep of Gauss–Seidel reduces that velocity pattern of a column of `count` discs
/// which decreases most slowly.
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
        step_by(dem, &mut scene);
    }
    let critical_secs = scene.simulation()?.critical_time_step_secs().unwrap_or(f64::INFINITY);
    Ok(time_step_secs / critical_secs)
}
