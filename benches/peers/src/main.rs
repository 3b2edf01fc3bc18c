//! Runs the pile without cohesion with other engines and writes what came of it as CSV. See
//! `README.md`.

mod box2d;
mod engine;
mod pile;
mod rapier;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Parser;
use serde::Serialize;

use engine::{Engine, Setting};
use pile::Pile;

/// Steps between two looks at positions, which are outside of the clock.
const STEPS_PER_LOOK: u64 = 10;

/// The pile without cohesion, run by rapier2d and Box2D.
#[derive(Parser)]
struct Options {
    /// Grains at rest, as `slump generate` writes them
    #[arg(long, value_name = "FILE", default_value = "../../assets/pile_138.csv")]
    initial: PathBuf,
    /// Width of the box that they were rained into, in diameters
    #[arg(long, default_value_t = 16.0)]
    box_width: f64,
    /// Leave the walls standing: the pile stays at rest
    #[arg(long)]
    rest: bool,
    /// Simulated time, s
    #[arg(long, default_value_t = 1.0)]
    duration: f64,
    /// Time steps, s
    #[arg(long, value_delimiter = ',', default_value = "1e-3,5e-3")]
    dt: Vec<f64>,
    /// Substeps of a step
    #[arg(long, value_delimiter = ',', default_value = "4,16")]
    substeps: Vec<u32>,
    /// Stiffness of contacts, Hz
    #[arg(long, value_delimiter = ',', default_value = "960,3840")]
    contact_hertz: Vec<f32>,
    /// Overlaps that are not pushed out, in diameters
    #[arg(long, value_delimiter = ',', default_value = "5e-3,5e-4")]
    slop: Vec<f64>,
    /// Runs that the least time is taken of
    #[arg(long, default_value_t = 3)]
    repeats: u32,
    /// The table to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// A row of the table.
#[derive(Serialize)]
struct Row {
    engine: &'static str,
    scene: &'static str,
    grains: usize,
    time_step_secs: f64,
    substeps: u32,
    contact_hertz: f32,
    slop: f64,
    /// Δy_G at the end.
    slump: f64,
    /// Mean over the looks of the mean overlap of touching grains, in diameters.
    mean_overlap: f64,
    /// Largest overlap at any look, in diameters.
    max_overlap: f64,
    secs_per_simulated_sec: f64,
    ms_per_step: f64,
    processor: String,
    date: String,
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse();
    let pile = Pile::read(&options.initial, options.box_width, options.rest)?;
    let mut writer = csv::Writer::from_path(&options.out)?;
    for setting in settings(&options) {
        let rapier = || Ok(rapier::Rapier::new(&pile, setting));
        tell(&mut writer, measured(rapier::NAME, &pile, setting, &options, rapier)?)?;
        let box2d = || Ok(box2d::Box2d::new(&pile, setting)?);
        tell(&mut writer, measured(box2d::NAME, &pile, setting, &options, box2d)?)?;
    }
    println!("{}", options.out.display());
    Ok(())
}

/// Every combination of what the options list.
fn settings(options: &Options) -> Vec<Setting> {
    let mut settings = Vec::new();
    for &time_step_secs in &options.dt {
        for &substeps in &options.substeps {
            for &contact_hertz in &options.contact_hertz {
                for &slop in &options.slop {
                    settings.push(Setting { time_step_secs, substeps, contact_hertz, slop });
                }
            }
        }
    }
    settings
}

fn tell(writer: &mut csv::Writer<std::fs::File>, row: Row) -> Result<(), Box<dyn Error>> {
    println!(
        "{}, {}, {} grains, dt {:e}, {} substeps, {} Hz, slop {:e}: slump {:.3}, overlap {:.2e}, {:.4} ms a step",
        row.engine,
        row.scene,
        row.grains,
        row.time_step_secs,
        row.substeps,
        row.contact_hertz,
        row.slop,
        row.slump,
        row.mean_overlap,
        row.ms_per_step
    );
    writer.serialize(row)?;
    writer.flush()?;
    Ok(())
}

fn measured<E: Engine>(
    engine: &'static str,
    pile: &Pile,
    setting: Setting,
    options: &Options,
    make: impl Fn() -> Result<E, Box<dyn Error>>,
) -> Result<Row, Box<dyn Error>> {
    let steps = (options.duration / setting.time_step_secs).round() as u64;
    let mut least_secs = f64::INFINITY;
    let (mut slump, mut mean_overlap, mut max_overlap) = (0.0, 0.0, 0f64);
    for _ in 0..options.repeats {
        let mut world = make()?;
        let (mut secs, mut overlaps, mut looks) = (0.0, 0.0, 0);
        for step in 1..=steps {
            let started = Instant::now();
            world.step();
            secs += started.elapsed().as_secs_f64();
            if step % STEPS_PER_LOOK == 0 || step == steps {
                let (mean, largest) = pile.overlaps(&world.positions());
                overlaps += mean;
                looks += 1;
                max_overlap = max_overlap.max(largest);
            }
        }
        slump = pile.slump(&world.positions());
        mean_overlap = overlaps / f64::from(looks);
        least_secs = f64::min(least_secs, secs);
    }
    Ok(Row {
        engine,
        scene: if options.rest { "rest" } else { "collapse" },
        grains: pile.grains.len(),
        time_step_secs: setting.time_step_secs,
        substeps: setting.substeps,
        contact_hertz: setting.contact_hertz,
        slop: setting.slop,
        slump,
        mean_overlap,
        max_overlap,
        secs_per_simulated_sec: least_secs / options.duration,
        ms_per_step: 1e3 * least_secs / steps as f64,
        processor: processor(),
        date: jiff::Timestamp::now().strftime("%Y-%m-%d").to_string(),
    })
}

/// The name that Linux gives the processor.
fn processor() -> String {
    let text = std::fs::read_to_string(Path::new("/proc/cpuinfo")).unwrap_or_default();
    let line = text.lines().find(|line| line.starts_with("model name"));
    line.and_then(|line| line.split_once(':')).map_or("unknown", |(_, name)| name.trim()).to_owned()
}
