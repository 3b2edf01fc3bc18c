//! Columns of dry grains that collapse and spread: how far they run and how high they end, against how slender they
//! were.

use super::experiment::{Case, Cases, Experiment, Found, Measured, values, with};
use super::quantity::{Provenance, Quantity};
use super::start::{loose, settle, wall};
use super::trial::Trial;
use super::way::Way;
use crate::error::Result;
use crate::scene::Scene;
use crate::scene::experiments::{collapse_of, half_width};
use crate::scene::stability::{DIAMETER, GRAVITY, dry};
use crate::sim::{Moment, OtherBody, Simulation};
use crate::statistics::{mean, slope};
use crate::world::Grain;
use glam::DVec2;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "collapse",
    title: "Columns that collapse",
    about: "A column of half width R₀ and height H₀ = a R₀ between two gates on a rough floor, μ = 0.5; the gates are \
            pulled away (L. Staron, E. J. Hinch, J. Fluid Mech. 545, 1, 2005, in the plane by Contact Dynamics, as \
            are G. Lube et al. 2005 and E. Lajeunesse et al. 2005 in channels). R∞ is how far the grains reach that \
            are joined to the rest by contacts, mean of both sides; H∞ how high the highest lies.",
    cases: Cases::Chosen(cases),
    judge,
};

/// μ.
const FRICTION: f64 = 0.5;
/// Up to here run-out is linear in a, and the final height is that of the column where it is lower.
const LINEAR_TO: f64 = 2.0;
/// How long a column is watched, in √(H₀/g).
const TIMES: f64 = 6.0;
/// When the gates go, s.
const RELEASE_SECS: f64 = 0.02;
/// The floor, in diameters: grains that lie in the hollows of the discs it is made of have their lowest points there.
const FLOOR: f64 = 0.37;

fn cases(quick: bool, way: Way) -> Vec<Case> {
    let (grains, seeds) = if quick { (260, 4u32) } else { (2_000, 8) };
    let aspects: &[f64] = if quick {
        &[0.5, 1.0, 2.0, 4.0, 8.0]
    } else {
        &[0.5, 0.7, 1.0, 1.4, 2.0, 3.0, 4.0, 6.0, 8.0]
    };
    let mut cases = Vec::new();
    for &aspect in aspects {
        for seed in 1..=seeds {
            let at =
                vec![("aspect", aspect), ("grains", f64::from(grains)), ("seed", f64::from(seed))];
            let column =
                Column { grains: grains as usize, aspect, seed: u64::from(seed), bond: 0.0 };
            let cost = f64::from(grains) * 4.0 * aspect.sqrt() / way.time_step_secs;
            cases.push(Case { at, cost, run: Box::new(move || column.run(way)) });
        }
    }
    cases
}

/// A column to let go.
#[derive(Clone, Copy, Debug)]
pub(super) struct Column {
    pub grains: usize,
    /// H₀/R₀ that is aimed at.
    pub aspect: f64,
    pub seed: u64,
    pub bond: f64,
}

impl Column {
    /// Lets it settle between walls, pulls the gates, and measures what is left.
    pub(super) fn run(&self, way: Way) -> Result<Measured> {
        let half = half_width(self.grains, self.aspect);
        let mut settling = Trial::start(&self.between_walls(half, way))?;
        settle(&mut settling)?;
        let grains = at_rest(&settling.simulation);
        let mut scene = self.of(grains);
        scene.parameters.bond = self.bond;
        let mut scene = collapse_of(scene, half, RELEASE_SECS);
        way.take(&mut scene);
        // Twice the height of the centre of mass: the surface is not even.
        let floor = FLOOR * DIAMETER;
        let height = 2.0 * (mean_height(&settling.simulation) - floor);
        scene.duration_secs = RELEASE_SECS + TIMES * (height / GRAVITY).sqrt();
        let mut trial = Trial::start(&scene)?;
        trial.run_until(scene.duration_secs, |_| ())?;
        let width = half * DIAMETER;
        let [reach, top] = reach_and_top(&trial.simulation.moment());
        Ok(trial.measured([
            ("aspect", height / width),
            ("run_out", reach / width - 1.0),
            ("height", (top - floor) / width),
            ("slump", trial.simulation.observables().slump),
            ("energy", super::start::energy(&trial.simulation)),
        ]))
    }

    fn of(&self, grains: Vec<Grain>) -> Scene {
        let mut scene = dry("collapse", grains);
        scene.parameters.friction = FRICTION;
        scene.parameters.restitution_threshold = 2.0;
        scene
    }

    /// Its grains above the floor, loosely, between two walls.
    fn between_walls(&self, half: f64, way: Way) -> Scene {
        let mut grains = loose(self.grains, 2.0 * half, self.seed);
        for grain in &mut grains {
            grain.position.y += 0.6 * DIAMETER;
        }
        let mut scene = collapse_of(self.of(grains), half, RELEASE_SECS);
        scene.motions.clear();
        scene.boundaries =
            vec![wall(0.0, 0.0, DVec2::Y), wall(-half, 0.0, DVec2::X), wall(half, 0.0, -DVec2::X)];
        way.take(&mut scene);
        scene.duration_secs = 60.0;
        scene
    }
}

/// The grains of a run where they are, at rest.
pub(super) fn at_rest(simulation: &Simulation) -> Vec<Grain> {
    let grains = &simulation.world().grains;
    let rest = |index| {
        let grain = grains.grain(index);
        Grain::at_rest(grain.position, grain.radius)
    };
    (0..grains.len()).map(rest).collect()
}

/// Height of the centre of mass, m.
fn mean_height(simulation: &Simulation) -> f64 {
    let grains = &simulation.world().grains;
    let mass: f64 = grains.masses.iter().sum();
    let moments = grains.masses.iter().zip(&grains.positions).map(|(mass, place)| mass * place.y);
    moments.sum::<f64>() / mass
}

/// How far from the middle, and how high, the largest set of grains reaches that contacts join, m: the mean of both
/// sides, and its highest point.
fn reach_and_top(moment: &Moment) -> [f64; 2] {
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
    let (mut left, mut right, mut top) = (0.0f64, 0.0f64, 0.0f64);
    for (grain, _) in grains.iter().zip(&roots).filter(|(_, root)| **root == largest) {
        left = left.max(grain.radius - grain.position.x);
        right = right.max(grain.radius + grain.position.x);
        top = top.max(grain.radius + grain.position.y);
    }
    [0.5 * (left + right), top]
}

/// A power law through a reading of the columns of each seed, over those whose slenderness is in a range: its exponent,
/// and what it has at a = 1.
fn power_law(found: &[Found], reading: &str, range: [f64; 2]) -> [Vec<f64>; 2] {
    let (mut exponents, mut factors) = (Vec::new(), Vec::new());
    for seed in values(found, "seed") {
        let points: Vec<(f64, f64)> = with(found, "seed", seed)
            .filter(|one| (range[0]..=range[1]).contains(&one.at("aspect")))
            .map(|one| (one.reading("aspect").ln(), one.reading(reading).ln()))
            .collect();
        let exponent = slope(&points);
        let [x, y] = [0, 1].map(|axis| {
            mean(&points.iter().map(|point| [point.0, point.1][axis]).collect::<Vec<_>>()).mean
        });
        exponents.push(exponent);
        factors.push((y - exponent * x).exp());
    }
    [exponents, factors]
}

fn judge(found: &[Found]) -> Vec<Quantity> {
    let grains = found.first().map_or(0.0, |one| one.at("grains"));
    let seeds = values(found, "seed").len();
    let aspects = values(found, "aspect");
    let list: Vec<String> = aspects.iter().map(f64::to_string).collect();
    let system = format!("{grains} grains, a = {}, {seeds} seeds", list.join(", "));
    let quantity = |name: &str, values: &[f64], band, source| {
        Quantity::new(name, &system, mean(values), band, (Provenance::Memory, source))
    };
    let low_factors = linear(found);
    let [high_exponents, high_factors] = power_law(found, "run_out", [LINEAR_TO, f64::INFINITY]);
    let [height_exponents, height_factors] = power_law(found, "height", [1.0, f64::INFINITY]);
    vec![
        quantity(
            "run-out over a, a ≤ 2",
            &low_factors,
            [1.2, 2.5, 3.2],
            "Staron, Hinch 2005: 2.5; Lube et al. 2005: 1.2",
        ),
        quantity(
            "exponent of run-out in a, a ≥ 2",
            &high_exponents,
            [0.55, 0.7, 0.9],
            "Staron, Hinch 2005: 0.7; Lajeunesse et al. 2005: 2/3",
        ),
        quantity(
            "factor of run-out, a ≥ 2",
            &high_factors,
            [1.7, 3.25, 4.0],
            "Staron, Hinch 2005: 3.25; Lube et al. 2005: 1.9",
        ),
        quantity(
            "exponent of final height in a, a ≥ 1",
            &height_exponents,
            [0.25, 0.35, 0.5],
            "Staron, Hinch 2005: 0.35; Lajeunesse et al. 2005: 1/3",
        ),
        quantity(
            "factor of final height, a ≥ 1",
            &height_factors,
            [0.5, 0.65, 0.8],
            "Staron, Hinch 2005: 0.65",
        ),
    ]
}

/// Run-out over a of the columns of each seed that are not slender.
fn linear(found: &[Found]) -> Vec<f64> {
    let of_seed = |seed: f64| {
        let low = with(found, "seed", seed).filter(|one| one.at("aspect") <= LINEAR_TO);
        let ratios: Vec<f64> =
            low.map(|one| one.reading("run_out") / one.reading("aspect")).collect();
        mean(&ratios).mean
    };
    values(found, "seed").into_iter().map(of_seed).collect()
}
