//! Comparison that changes one setting of an engine at a time, to find the reasons for its overlap. Writes the results
//! as JSON. See `README.md`.

use std::error::Error;
use std::time::Instant;

use rapier2d::prelude::IntegrationParameters;
use serde::Serialize;
use slump_studies::mean;

use crate::box2d::Box2d;
use crate::engine::{Engine, SLOP_IN_DIAMETERS, Setting};
use crate::pile::Pile;
use crate::rapier::{Rapier, set_prediction};
use crate::slump::{Slump, Way};
use crate::{DURATION_SECS, PILES, STEPS_PER_LOOK, processor};

pub const COMMAND: &str = "benches/peers/run.sh reasons";
const REPEATS: usize = 3;
/// Settings of rapier of which one at a time is changed.
const SUBSTEPS: u32 = 4;
const CONTACT_HERTZ: f32 = 3840.0;
/// Distance, in mean diameters, at which Box2D starts to create contacts: four times its slop.
const PREDICTION_OF_BOX2D: f64 = 4.0 * SLOP_IN_DIAMETERS;
/// Bond number of the cohesive piles.
const BOND: f64 = 20.0;
/// Fraction of the run, at its end, of which `late_overlap` is the mean.
const LATE: f64 = 0.1;

#[derive(Serialize)]
pub struct Report {
    command: &'static str,
    processor: String,
    date: String,
    rows: Vec<Row>,
    cohesive: Vec<Cohesive>,
}

/// Results of an engine with one setting: means over the piles.
#[derive(Serialize)]
struct Row {
    engine: &'static str,
    setting: String,
    grains: usize,
    time_step_secs: f64,
    /// Computing time divided by the time of the first row with the same grains and time step.
    cost: f64,
    secs_per_simulated_sec: f64,
    /// Slump Δy_G at the end of the run, dimensionless.
    slump: f64,
    /// Half of the 95 % confidence interval of `slump`; `None` for a single pile.
    slump_within: Option<f64>,
    /// Mean overlap of touching grains, averaged over the measurements, in mean diameters.
    mean_overlap: f64,
    /// Like `mean_overlap`, for the last tenth of the run, in which the grains are nearly at rest.
    late_overlap: f64,
    /// Largest overlap in any measurement of any pile, in mean diameters.
    max_overlap: f64,
}

/// Slump of the cohesive piles under a stepper of Slump.
#[derive(Serialize)]
struct Cohesive {
    setting: String,
    time_step_secs: f64,
    slump: f64,
    slump_within: f64,
}

/// Rapier with a pile whose grains are in reversed order. Returns the positions in the order of the pile.
struct Reversed(Rapier);

impl Engine for Reversed {
    fn step(&mut self) {
        self.0.step();
    }

    fn positions(&mut self) -> Vec<[f64; 2]> {
        let mut positions = self.0.positions();
        positions.reverse();
        positions
    }
}

struct Variant {
    engine: &'static str,
    setting: String,
    make: Box<dyn Fn(&Pile) -> Result<Box<dyn Engine>, Box<dyn Error>>>,
}

/// Runs all comparisons. Prints each row.
pub fn report() -> Result<Report, Box<dyn Error>> {
    let mut rows = Vec::new();
    for (grains, width, count) in PILES {
        let piles = piles(grains, width, count)?;
        for time_step_secs in [1e-3, 5e-3] {
            let in_full = grains == PILES[0].0 && time_step_secs == 1e-3;
            let variants = variants(time_step_secs, in_full);
            rows.extend(measured(&variants, &piles, time_step_secs)?);
        }
    }
    let cohesive = cohesive()?;
    let date = jiff::Timestamp::now().strftime("%Y-%m-%d").to_string();
    Ok(Report { command: COMMAND, processor: processor(), date, rows, cohesive })
}

fn piles(grains: usize, width: f64, count: u64) -> Result<Vec<Pile>, Box<dyn Error>> {
    (1..=count).map(|seed| Ok(Pile::rained(grains, width, seed)?)).collect()
}

/// Returns the engines with their settings. The first one is rapier, of which the others differ in one setting if
/// `in_full`.
fn variants(time_step_secs: f64, in_full: bool) -> Vec<Variant> {
    let mut all = Vec::new();
    let mut rapier = |setting: &str,
                      substeps,
                      contact_hertz,
                      change: fn(&mut IntegrationParameters)| {
        let made_with = Setting { time_step_secs, substeps, contact_hertz };
        let make = move |pile: &Pile| -> Result<Box<dyn Engine>, Box<dyn Error>> {
            Ok(Box::new(Rapier::new(pile, made_with, change)))
        };
        all.push(Variant { engine: "rapier2d", setting: setting.to_owned(), make: Box::new(make) });
    };
    rapier("4 substeps, 3840 Hz", SUBSTEPS, CONTACT_HERTZ, |_| ());
    rapier("prediction 0.03 d", SUBSTEPS, CONTACT_HERTZ, |it| set_prediction(it, 0.03));
    rapier("prediction 0.01 d", SUBSTEPS, CONTACT_HERTZ, |it| set_prediction(it, 0.01));
    rapier("prediction of Box2D, 0.002 d", SUBSTEPS, CONTACT_HERTZ, |it| {
        set_prediction(it, PREDICTION_OF_BOX2D);
    });
    rapier("prediction 0", SUBSTEPS, CONTACT_HERTZ, |it| set_prediction(it, 0.0));
    rapier("1920 Hz", SUBSTEPS, 1920.0, |_| ());
    rapier("960 Hz", SUBSTEPS, 960.0, |_| ());
    rapier("frequencies of Box2D, 500 and 1000 Hz", SUBSTEPS, 500.0, |it| {
        it.static_contact_softness.natural_frequency = 1000.0;
    });
    rapier("250 Hz", SUBSTEPS, 250.0, |_| ());
    rapier("frequencies and prediction of Box2D", SUBSTEPS, 500.0, |it| {
        it.static_contact_softness.natural_frequency = 1000.0;
        set_prediction(it, PREDICTION_OF_BOX2D);
    });
    rapier("8 substeps", 8, CONTACT_HERTZ, |_| ());
    if in_full {
        for (damping, setting) in [("damping ratio 1", 1.0), ("damping ratio 30", 30.0)] {
            let change: fn(&mut IntegrationParameters) = match setting {
                1.0 => |it| set_damping(it, 1.0),
                _ => |it| set_damping(it, 30.0),
            };
            rapier(damping, SUBSTEPS, CONTACT_HERTZ, change);
        }
        rapier("no relaxation sweep", SUBSTEPS, CONTACT_HERTZ, |it| {
            it.num_internal_stabilization_iterations = 0;
        });
        rapier("2 relaxation sweeps", SUBSTEPS, CONTACT_HERTZ, |it| {
            it.num_internal_stabilization_iterations = 2;
        });
        rapier("2 sweeps per substep", SUBSTEPS, CONTACT_HERTZ, |it| {
            it.num_internal_pgs_iterations = 2;
        });
        rapier("no warm start", SUBSTEPS, CONTACT_HERTZ, |it| it.warmstart_coefficient = 0.0);
        rapier("friction in both sweeps", SUBSTEPS, CONTACT_HERTZ, |it| {
            it.friction_in_bias_pass = true
        });
        rapier("no recycled contacts", SUBSTEPS, CONTACT_HERTZ, |it| it.contact_recycling = false);
        rapier("slop 5e-3 d", SUBSTEPS, CONTACT_HERTZ, |it| {
            it.normalized_allowed_linear_error *= 10.0
        });
        rapier("speed limit 1 m/s", SUBSTEPS, CONTACT_HERTZ, |it| {
            it.normalized_max_corrective_velocity = 1.0 / it.length_unit;
        });
        rapier("speed limit 0.025 m/s", SUBSTEPS, CONTACT_HERTZ, |it| {
            it.normalized_max_corrective_velocity = 0.025 / it.length_unit;
        });
    }
    if in_full {
        let make = move |pile: &Pile| -> Result<Box<dyn Engine>, Box<dyn Error>> {
            let made_with =
                Setting { time_step_secs, substeps: SUBSTEPS, contact_hertz: CONTACT_HERTZ };
            Ok(Box::new(Reversed(Rapier::new(&pile.reversed(), made_with, |_| ()))))
        };
        let setting = "grains in reversed order".to_owned();
        all.push(Variant { engine: "rapier2d", setting, make: Box::new(make) });
    }
    for substeps in [4, 8] {
        let made_with = Setting { time_step_secs, substeps, contact_hertz: CONTACT_HERTZ };
        let make = move |pile: &Pile| -> Result<Box<dyn Engine>, Box<dyn Error>> {
            Ok(Box::new(Box2d::new(pile, made_with)?))
        };
        let setting = format!("{substeps} substeps, 3840 Hz");
        all.push(Variant { engine: "Box2D", setting, make: Box::new(make) });
    }
    let mut own = |setting: String, way| {
        let make = move |pile: &Pile| -> Result<Box<dyn Engine>, Box<dyn Error>> {
            Ok(Box::new(Slump::new(pile, time_step_secs, way)?))
        };
        all.push(Variant { engine: "Slump", setting, make: Box::new(make) });
    };
    for speculative in [false, true] {
        let ahead = if speculative { ", speculative" } else { "" };
        for substeps in [4, 5, 6, 8] {
            if speculative || substeps % 4 == 0 {
                let way = Way::TgsSoft { substeps, speculative };
                own(format!("tgs-soft, {substeps} substeps{ahead}"), way);
            }
        }
        for count in [10, 20] {
            let way = Way::Sweeps { count, push_out: true, speculative };
            own(format!("{count} sweeps, push-out{ahead}"), way);
        }
    }
    all
}

fn set_damping(parameters: &mut IntegrationParameters, ratio: f32) {
    parameters.contact_softness.damping_ratio = ratio;
    parameters.static_contact_softness.damping_ratio = ratio;
}

/// Measures all variants, in turns. All repeats give the same positions, so a part of a run takes the shortest time of
/// the repeats: other programs on the same processor then hardly change the times.
fn measured(
    variants: &[Variant],
    piles: &[Pile],
    time_step_secs: f64,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let looks = (DURATION_SECS / time_step_secs).round() as usize / STEPS_PER_LOOK as usize;
    let late_from = looks - (LATE * looks as f64) as usize;
    let repeats = if piles.len() > 1 { REPEATS } else { REPEATS - 1 };
    let mut least_secs = vec![vec![f64::INFINITY; looks * piles.len()]; variants.len()];
    let mut found = Vec::new();
    found.resize_with(variants.len(), Measured::default);
    for repeat in 0..repeats {
        for (number, pile) in piles.iter().enumerate() {
            for (at, variant) in variants.iter().enumerate() {
                let mut engine = (variant.make)(pile)?;
                for look in 0..looks {
                    let started = Instant::now();
                    (0..STEPS_PER_LOOK).for_each(|_| engine.step());
                    let least = &mut least_secs[at][number * looks + look];
                    *least = least.min(started.elapsed().as_secs_f64());
                    if repeat == 0 {
                        let (mean, largest) = pile.overlaps(&engine.positions());
                        let found = &mut found[at];
                        found.overlaps.push(mean);
                        if look >= late_from {
                            found.late_overlaps.push(mean);
                        }
                        found.max_overlap = found.max_overlap.max(largest);
                    }
                }
                if repeat == 0 {
                    found[at].slumps.push(pile.slump(&engine.positions()));
                }
            }
        }
    }
    let secs = |at: usize| least_secs[at].iter().sum::<f64>() / piles.len() as f64 / DURATION_SECS;
    let row = |(at, (variant, found)): (usize, (&Variant, Measured))| {
        let slump = mean(&found.slumps);
        let row = Row {
            engine: variant.engine,
            setting: variant.setting.clone(),
            grains: piles[0].grains.len(),
            time_step_secs,
            cost: secs(at) / secs(0),
            secs_per_simulated_sec: secs(at),
            slump: slump.mean,
            slump_within: (piles.len() > 1).then_some(slump.high - slump.mean),
            mean_overlap: mean(&found.overlaps).mean,
            late_overlap: mean(&found.late_overlaps).mean,
            max_overlap: found.max_overlap,
        };
        let Row {
            engine,
            setting,
            grains,
            cost,
            slump,
            mean_overlap,
            late_overlap,
            max_overlap,
            ..
        } = &row;
        println!(
            "{engine}, {setting}, {grains} grains, dt {time_step_secs:e}: cost {cost:.2}, slump {slump:.3}, overlap \
             {mean_overlap:.2e}, late {late_overlap:.2e}, largest {max_overlap:.1e}"
        );
        row
    };
    Ok(variants.iter().zip(found).enumerate().map(row).collect())
}

/// Measurements of one variant, one entry per measurement or pile.
#[derive(Default)]
struct Measured {
    slumps: Vec<f64>,
    overlaps: Vec<f64>,
    late_overlaps: Vec<f64>,
    max_overlap: f64,
}

/// Measures the slump of cohesive piles under `tgs-soft`, with and without the remedy `speculative`.
fn cohesive() -> Result<Vec<Cohesive>, Box<dyn Error>> {
    let (grains, width, count) = PILES[0];
    let mut piles = piles(grains, width, count)?;
    piles.iter_mut().for_each(|pile| pile.scene.parameters.bond = BOND);
    let mut all = Vec::new();
    for time_step_secs in [5e-3, 1e-3, 1e-4] {
        for speculative in [false, true] {
            let way = Way::TgsSoft { substeps: SUBSTEPS, speculative };
            let slumps = piles.iter().map(|pile| {
                let mut engine = Slump::new(pile, time_step_secs, way)?;
                (0..(DURATION_SECS / time_step_secs).round() as u64).for_each(|_| engine.step());
                Ok(pile.slump(&engine.positions()))
            });
            let slump = mean(&slumps.collect::<Result<Vec<f64>, Box<dyn Error>>>()?);
            let ahead = if speculative { ", speculative" } else { "" };
            let setting = format!("tgs-soft, {SUBSTEPS} substeps{ahead}");
            let slump_within = slump.high - slump.mean;
            println!(
                "Bond {BOND}, {setting}, dt {time_step_secs:e}: {:.3} ± {slump_within:.3}",
                slump.mean
            );
            all.push(Cohesive { setting, time_step_secs, slump: slump.mean, slump_within });
        }
    }
    Ok(all)
}
