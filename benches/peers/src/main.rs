//! Benchmark: runs the cohesionless pile with other engines and with Slump, and writes the results as JSON and as a
//! chart. See `README.md`.

mod box2d;
mod draw;
mod engine;
mod pile;
mod rapier;
mod reasons;
mod slump;

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use serde::Serialize;
use slump_studies::mean;

use engine::{Engine, Setting};
use pile::Pile;
use slump::{Slump, Way};

/// Sizes of the piles: number of grains, width of the box in which they were made (in mean diameters), and number of
/// piles.
const PILES: [(usize, f64, u64); 2] = [(138, 16.0, 8), (2000, 60.0, 1)];
const COMMAND: &str = "benches/peers/run.sh";
const DURATION_SECS: f64 = 1.0;
const TIME_STEPS_SECS: [f64; 2] = [1e-3, 5e-3];
const SUBSTEPS: [u32; 3] = [4, 8, 16];
const CONTACT_HERTZ: [f32; 2] = [960.0, 3840.0];
const SWEEPS: [u32; 3] = [10, 40, 160];
/// Largest number of runs whose shortest time counts. A run that takes longer than `LONG_ENOUGH_SECS` is not repeated.
const REPEATS: u32 = 3;
const LONG_ENOUGH_SECS: f64 = 5.0;
/// Number of steps between two measurements of positions. The time of measurements is not counted.
const STEPS_PER_LOOK: u64 = 10;

/// Curve in the chart: an engine, or a solver or stepper of Slump.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
enum Series {
    #[serde(rename = "rapier2d 0.36 f32")]
    Rapier,
    #[serde(rename = "Box2D 3.2 f32")]
    Box2d,
    #[serde(rename = "sweeps")]
    Sweeps,
    #[serde(rename = "sweeps, push-out")]
    PushOut,
    #[serde(rename = "tgs-soft")]
    TgsSoft,
    #[serde(rename = "certified")]
    Certified,
}

/// All results of the benchmark.
#[derive(Serialize)]
struct Report {
    command: &'static str,
    processor: String,
    date: String,
    rows: Vec<Row>,
}

/// Results of an engine with one setting and one time step: means over the piles.
#[derive(Serialize)]
struct Row {
    series: Series,
    setting: String,
    grains: usize,
    piles: usize,
    time_step_secs: f64,
    /// Slump Δy_G at the end of the run, dimensionless.
    slump: f64,
    /// Half of the 95 % confidence interval of `slump`; `None` for a single pile.
    slump_within: Option<f64>,
    /// Mean overlap of touching grains, averaged over the measurements, in mean diameters.
    mean_overlap: f64,
    /// Largest overlap in any measurement of any pile, in mean diameters.
    max_overlap: f64,
    secs_per_simulated_sec: f64,
    ms_per_step: f64,
}

/// An engine with its setting.
struct Compared {
    series: Series,
    setting: String,
    make: Box<Make>,
}

/// Function that puts a pile into an engine, for steps of the given length (s).
type Make = dyn Fn(&Pile, f64) -> Result<Box<dyn Engine>, Box<dyn Error>>;

fn main() -> Result<(), Box<dyn Error>> {
    if std::env::args().nth(1).as_deref() == Some("reasons") {
        let bytes = serde_json::to_vec_pretty(&reasons::report()?)?;
        return Ok(std::fs::write("results/reasons.json", bytes)?);
    }
    let mut rows = Vec::new();
    for (grains, width, count) in PILES {
        let rained = |seed| Pile::rained(grains, width, seed);
        let piles: Vec<Pile> = (1..=count).map(rained).collect::<Result<_, _>>()?;
        for time_step_secs in TIME_STEPS_SECS {
            for compared in compared() {
                let row = measured(&compared, &piles, time_step_secs)?;
                println!(
                    "{}, {}, {grains} grains, dt {time_step_secs:e}: slump {:.3}, overlap {:.2e}, {:.3} s a simulated second",
                    name_of(row.series),
                    row.setting,
                    row.slump,
                    row.mean_overlap,
                    row.secs_per_simulated_sec
                );
                rows.push(row);
            }
        }
    }
    let date = jiff::Timestamp::now().strftime("%Y-%m-%d").to_string();
    let report = Report { command: COMMAND, processor: processor(), date, rows };
    let picture = draw::png(&report)?;
    for (name, bytes) in
        [("dry-pile.json", serde_json::to_vec_pretty(&report)?), ("chart-engines.png", picture)]
    {
        let path = Path::new("results").join(name);
        std::fs::write(&path, bytes)?;
        println!("{}", path.display());
    }
    Ok(())
}

/// Returns every engine with each of its settings.
fn compared() -> Vec<Compared> {
    let mut all = Vec::new();
    for substeps in SUBSTEPS {
        for contact_hertz in CONTACT_HERTZ {
            let of = move |time_step_secs| Setting { time_step_secs, substeps, contact_hertz };
            let setting = format!("{substeps} substeps, {contact_hertz} Hz");
            all.push(Compared {
                series: Series::Rapier,
                setting: setting.clone(),
                make: Box::new(move |pile, step| {
                    Ok(Box::new(rapier::Rapier::new(pile, of(step), |_| ())))
                }),
            });
            all.push(Compared {
                series: Series::Box2d,
                setting,
                make: Box::new(move |pile, step| Ok(Box::new(box2d::Box2d::new(pile, of(step))?))),
            });
        }
    }
    let mut own = |series, setting: String, way| {
        let make = move |pile: &Pile, step| -> Result<Box<dyn Engine>, Box<dyn Error>> {
            Ok(Box::new(Slump::new(pile, step, way)?))
        };
        all.push(Compared { series, setting, make: Box::new(make) });
    };
    for count in SWEEPS {
        for (series, push_out) in [(Series::Sweeps, false), (Series::PushOut, true)] {
            own(
                series,
                format!("{count} sweeps"),
                Way::Sweeps { count, push_out, speculative: false },
            );
        }
    }
    for substeps in SUBSTEPS {
        own(
            Series::TgsSoft,
            format!("{substeps} substeps"),
            Way::TgsSoft { substeps, speculative: false },
        );
    }
    own(Series::Certified, "the default".into(), Way::Certified { push_out: false });
    own(Series::Certified, "push-out".into(), Way::Certified { push_out: true });
    all
}

/// Returns the name of a series in tables.
fn name_of(series: Series) -> String {
    serde_json::to_value(series)
        .ok()
        .and_then(|name| name.as_str().map(str::to_owned))
        .unwrap_or_default()
}

fn measured(
    compared: &Compared,
    piles: &[Pile],
    time_step_secs: f64,
) -> Result<Row, Box<dyn Error>> {
    let steps = (DURATION_SECS / time_step_secs).round() as u64;
    let (mut slumps, mut overlaps, mut max_overlap, mut secs) = (Vec::new(), Vec::new(), 0f64, 0.0);
    for pile in piles {
        let mut least_secs = f64::INFINITY;
        for repeat in 0..REPEATS {
            let mut engine = (compared.make)(pile, time_step_secs)?;
            let mut run_secs = 0.0;
            for step in 1..=steps {
                let started = Instant::now();
                engine.step();
                run_secs += started.elapsed().as_secs_f64();
                // All repeats give the same positions, so only the first repeat is measured.
                if repeat == 0 && (step % STEPS_PER_LOOK == 0 || step == steps) {
                    let (mean, largest) = pile.overlaps(&engine.positions());
                    overlaps.push(mean);
                    max_overlap = max_overlap.max(largest);
                }
            }
            if repeat == 0 {
                slumps.push(pile.slump(&engine.positions()));
            }
            least_secs = f64::min(least_secs, run_secs);
            if run_secs > LONG_ENOUGH_SECS {
                break;
            }
        }
        secs += least_secs / piles.len() as f64;
    }
    let slump = mean(&slumps);
    Ok(Row {
        series: compared.series,
        setting: compared.setting.clone(),
        grains: piles[0].grains.len(),
        piles: piles.len(),
        time_step_secs,
        slump: slump.mean,
        slump_within: (piles.len() > 1).then_some(slump.high - slump.mean),
        mean_overlap: mean(&overlaps).mean,
        max_overlap,
        secs_per_simulated_sec: secs / DURATION_SECS,
        ms_per_step: 1e3 * secs / steps as f64,
    })
}

/// Returns the name of the processor according to Linux.
fn processor() -> String {
    let text = std::fs::read_to_string(Path::new("/proc/cpuinfo")).unwrap_or_default();
    let line = text.lines().find(|line| line.starts_with("model name"));
    line.and_then(|line| line.split_once(':')).map_or("unknown", |(_, name)| name.trim()).to_owned()
}
