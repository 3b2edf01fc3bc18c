//! Validates columns of dry grains that collapse and spread: the run-out and the final height as functions of the
//! aspect ratio (initial height divided by half the width).

use super::experiment::*;
use super::fit::power_law;
use super::surface::{profile, roughness};
use super::variants::StepVariant;
use super::watched::{WatchedRun, at_rest, centre_of_mass, loose, mean_energy, open_box, settled};
use crate::error::Result;
use crate::scene::Scene;
use crate::scene::experiments::{collapse_of, half_width};
use crate::scene::stability::{DIAMETER, GRAVITY, dry};
use crate::sim::{GrainState, Moment, OtherBody};
use crate::statistics::mean;
use crate::world::Grain;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "collapse",
    title: "Columns that collapse",
    about: "A column of half width R₀ and height H₀ = a R₀ between two gates on a rough floor, μ = 0.5; the gates are \
            pulled away (L. Staron, E. J. Hinch, J. Fluid Mech. 545, 1, 2005, in the plane by Contact Dynamics, as \
            are G. Lube et al. 2005 and E. Lajeunesse et al. 2005 in channels). R∞ is how far the grains reach that \
            are joined to the rest by contacts, mean of both sides; H∞ how high the highest lies. The factors of \
            the two sources differ by 2, and those of run-out in channels with the material (N. J. Balmforth, R. R. \
            Kerswell, J. Fluid Mech. 538, 399, 2005, whose abstract was read): so each source has a band of its own.",
    cases: ExperimentCases::Chosen(cases),
    published: PUBLISHED,
    judge,
};

const FRICTION: f64 = 0.5;
/// Aspect ratio (height divided by half the width) of a column up to which the run-out is proportional to the aspect
/// ratio.
const LINEAR_TO: f64 = 2.0;
/// Duration of a run after the gates beside the column are removed, in units of √(H₀/g), with the height H₀ of the
/// column and gravity g.
const TIMES: f64 = 6.0;
/// Simulated time at which the gates beside the column are removed, s.
const RELEASE_SECS: f64 = 0.02;
/// Level of the rough floor from which heights are measured, in diameters: the height of the lowest points of grains
/// that lie in the hollows between the discs of the floor.
pub(super) const FLOOR: f64 = 0.37;
/// Widths of the two windows in which the roughness of a heap's surface is measured, as the deviation from a straight
/// line, in diameters.
const WINDOWS: [f64; 2] = [4.0, 12.0];

fn cases(effort: Effort, variant: StepVariant) -> Vec<ExperimentCase> {
    let (grains, seeds) = effort.pick((260, 4), (2_000, 8));
    let aspects: &[f64] =
        effort.pick(&[0.5, 1.0, 2.0, 4.0, 8.0], &[0.5, 0.7, 1.0, 1.4, 2.0, 3.0, 4.0, 6.0, 8.0]);
    seeded(aspects, seeds, |aspect, seed| {
        let at = [("aspect", aspect), ("grains", f64::from(grains)), ("seed", seed as f64)];
        let column = CollapsingColumn { grains: grains as usize, aspect, seed, bond: 0.0 };
        let cost = f64::from(grains) * 4.0 * aspect.sqrt() / variant.time_step_secs;
        ExperimentCase::new(&at, cost, move || column.run(variant))
    })
}

#[derive(Clone, Copy, Debug)]
pub(super) struct CollapsingColumn {
    pub grains: usize,
    /// Nominal aspect ratio H₀/R₀: the height of the column divided by half its width.
    pub aspect: f64,
    pub seed: u64,
    pub bond: f64,
}

impl CollapsingColumn {
    pub(super) fn run(&self, variant: StepVariant) -> Result<RunReadings> {
        self.released(&self.settled(variant)?, variant)
    }

    /// Lets the grains of the column fall and come to rest between two walls.
    pub(super) fn settled(&self, variant: StepVariant) -> Result<WatchedRun> {
        settled(&self.between_walls(half_width(self.grains, self.aspect), variant))
    }

    /// Pulls the walls (then called gates) away from the grains at rest, and measures the final heap.
    pub(super) fn released(
        &self,
        settled: &WatchedRun,
        variant: StepVariant,
    ) -> Result<RunReadings> {
        let half = half_width(self.grains, self.aspect);
        let mut scene = column_scene(at_rest(settled));
        scene.parameters.bond = self.bond;
        let mut scene = collapse_of(scene, half, RELEASE_SECS);
        variant.apply(&mut scene);
        // The height of the column is twice the height of its centre of mass, because the surface is uneven.
        let floor = FLOOR * DIAMETER;
        let height = 2.0 * (centre_of_mass(&settled.simulation).y - floor);
        scene.duration_secs = RELEASE_SECS + TIMES * (height / GRAVITY).sqrt();
        let mut run = WatchedRun::start(&scene)?;
        run.run_until(scene.duration_secs, |_| ())?;
        let width = half * DIAMETER;
        let heap = joined(&run.simulation.moment());
        let [reach, top] = reach_and_top(&heap);
        let surface = profile(&heap);
        let [rough, rougher] = WINDOWS.map(|window| roughness(&surface, window));
        Ok(run.with([
            ("aspect", height / width),
            ("run_out", reach / width - 1.0),
            ("height", (top - floor) / width),
            ("slump", run.simulation.observables().slump),
            ("roughness", rougher),
            ("roughness_exponent", (rougher / rough).ln() / (WINDOWS[1] / WINDOWS[0]).ln()),
            ("energy", mean_energy(&run.simulation)),
        ]))
    }

    /// Returns a scene with the grains of the column loosely packed between two walls, from where they fall on the
    /// floor. `half` is half the distance of the walls, in diameters.
    fn between_walls(&self, half: f64, variant: StepVariant) -> Scene {
        let mut grains = loose(self.grains, 2.0 * half, self.seed);
        for grain in &mut grains {
            grain.position.y += 0.6 * DIAMETER;
        }
        let mut scene = collapse_of(column_scene(grains), half, RELEASE_SECS);
        scene.motions.clear();
        scene.boundaries = open_box(2.0 * half);
        variant.apply(&mut scene);
        scene.duration_secs = 60.0;
        scene
    }
}

fn column_scene(grains: Vec<Grain>) -> Scene {
    let mut scene = dry("collapse", grains);
    scene.parameters.friction = FRICTION;
    scene
}

/// Returns the grains of the largest cluster of touching grains.
fn joined(moment: &Moment) -> Vec<GrainState> {
    let grains = &moment.grains;
    let mut set: Vec<usize> = (0..grains.len()).collect();
    fn root(set: &mut [usize], mut grain: usize) -> usize {
        while set[grain] != grain {
            set[grain] = set[set[grain]];
            grain = set[grain];
        }
        grain
    }
    for contact in &moment.contacts {
        if let OtherBody::Grain(other) = contact.other {
            let ends = [contact.grain, other].map(|grain| root(&mut set, grain as usize));
            set[ends[0]] = ends[1];
        }
    }
    let roots: Vec<usize> = (0..grains.len()).map(|grain| root(&mut set, grain)).collect();
    let mut sizes = vec![0usize; grains.len()];
    roots.iter().for_each(|&root| sizes[root] += 1);
    let largest = (0..grains.len()).max_by_key(|&root| sizes[root]).unwrap_or(0);
    grains.iter().zip(roots).filter(|(_, root)| *root == largest).map(|(grain, _)| *grain).collect()
}

/// Returns the horizontal extent of the grains from the middle of the column, averaged over both sides, and the height
/// of their highest point, m.
fn reach_and_top(grains: &[GrainState]) -> [f64; 2] {
    let (mut left, mut right, mut top) = (0.0f64, 0.0f64, 0.0f64);
    for grain in grains {
        left = left.max(grain.radius - grain.position.x);
        right = right.max(grain.radius + grain.position.x);
        top = top.max(grain.radius + grain.position.y);
    }
    [0.5 * (left + right), top]
}

/// Table of published values as text, with one row for each quantity that the function [`judge`] computes from the
/// runs. A row has the form: name of the quantity | lower end of the band of values that agree, published value, upper
/// end of the band | kind of the source (`read`, `recalled`, `derived` or `exact`): source.
const PUBLISHED: &str = "
    run-out over a, a ≤ 2, simulated | 1.9 2.5 3.1 | recalled: Staron, Hinch 2005: 2.5
    run-out over a, a ≤ 2, in a channel | 0.9 1.2 1.5 | recalled: Lube et al. 2005: 1.2
    exponent of run-out in a, a ≥ 2 | 0.55 0.7 0.9 | recalled: Staron, Hinch 2005: 0.7; Lajeunesse et al. 2005: 2/3
    factor of run-out, a ≥ 2, simulated | 2.4 3.25 4.1 | recalled: Staron, Hinch 2005: 3.25
    factor of run-out, a ≥ 2, in a channel | 1.4 1.9 2.4 | recalled: Lube et al. 2005: 1.9
    exponent of final height in a, a ≥ 1 | 0.25 0.35 0.5 \
        | recalled: Staron, Hinch 2005: 0.35; Lajeunesse et al. 2005: 1/3
    factor of final height, a ≥ 1 | 0.5 0.65 0.8 | recalled: Staron, Hinch 2005: 0.65
";

fn judge(all: &Measurements) -> Vec<Measured> {
    let (grains, aspects) = (all.first("grains"), all.list("aspect"));
    let system = format!("{grains} grains, a = {aspects}, {}", all.seeds());
    // Mean run-out divided by the aspect ratio, over the columns of each seed with a small aspect ratio.
    let low_factors = all.by_seed(|of_seed| {
        let low = of_seed.such_that(|case| case.at("aspect") <= LINEAR_TO).0;
        let ratios = low.iter().map(|case| case.reading("run_out") / case.reading("aspect"));
        mean(&ratios.collect::<Vec<_>>()).mean
    });
    // Exponent of a power law in the aspect ratio a, and value of this law at a = 1, for the columns of each seed whose
    // aspect ratio is at least `least`.
    let power_laws = |reading: &str, least: f64| -> (Vec<f64>, Vec<f64>) {
        let law = |of_seed: Measurements| {
            let slender = of_seed.such_that(|case| case.at("aspect") >= least);
            power_law(&slender.points(|case| (case.reading("aspect"), case.reading(reading))))
        };
        all.by_seed(law).into_iter().unzip()
    };
    let (exponents, factors) = power_laws("run_out", LINEAR_TO);
    let (height_exponents, height_factors) = power_laws("height", 1.0);
    let (low, high) = (low_factors.clone(), factors.clone());
    let values = [low, low_factors, exponents, high, factors, height_exponents, height_factors];
    values.map(|values| (system.clone(), values)).into()
}
