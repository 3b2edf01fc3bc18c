//! Which piles are run, by which methods, and how well each is to solve its steps.

use super::super::entrants::{self, Entrant, Way};
use crate::scene::{Config, NewPile, Origin};
use crate::sim::Stepper;
use crate::solver::Method;
use crate::world::ParameterChanges;

/// Δt of the reference that has next to no error of the time step, s.
pub(super) const FINEST_SECS: f64 = 1e-4;
/// Residual of the references, and of those that show the floor.
pub(super) const REFERENCE: [f64; 2] = [1e-8, 1e-9];
/// A step gets no more sweeps: one without a solution must not take for ever.
const MOST_SWEEPS: u32 = 5_000;
/// Contacts slower than this many g·Δt do not bounce.
const THRESHOLD: f64 = 2.0;

/// One entrant, and how well it is to solve its steps.
pub(super) struct Effort {
    /// Number in `Plan::entrants`.
    pub entrant: usize,
    /// Whose references it is held against.
    pub law: Stepper,
    /// In words.
    pub name: String,
    pub way: Way,
}

/// What is run.
pub(super) struct Plan {
    pub time_steps_secs: Vec<f64>,
    /// (Bond, seed) of each pile.
    pub piles: Vec<(f64, u64)>,
    /// Who takes part.
    pub entrants: Vec<Entrant>,
    pub efforts: Vec<Effort>,
    /// Laws that have references.
    pub laws: Vec<Stepper>,
    /// How often a run is timed.
    pub repeats: u32,
    /// Wall time that a simulated second may take, s.
    pub limit_secs: f64,
}

impl Plan {
    pub(super) fn new(quick: bool) -> Self {
        let residuals: &[f64] =
            if quick { &[1e-2, 1e-4, 1e-6] } else { &[1e-1, 1e-2, 1e-4, 1e-6, 1e-8] };
        let sweeps: &[u32] = if quick { &[20] } else { &[10, 40] };
        let substeps: &[u32] = if quick { &[0] } else { &[0, 16, 64] };
        // What the law range costs is told by one good method, and by long runs.
        let laws =
            if quick { vec![Stepper::Moreau] } else { vec![Stepper::Moreau, Stepper::Range] };
        let mut entrants: Vec<Entrant> = Vec::new();
        let mut efforts = Vec::new();
        let of_law = |law| entrants::all().into_iter().map(move |entrant| (law, entrant));
        let models = entrants::models().into_iter().map(|model| (Stepper::Moreau, model));
        for (law, mut entrant) in laws.iter().copied().flat_map(of_law).chain(models) {
            if law == Stepper::Range {
                if entrant.method() != Some(Method::Newton) {
                    continue;
                }
                entrant.stepper = law;
                entrant.name.push_str(" (range)");
                entrant.look += entrants::looks();
            }
            let number = entrants.len();
            let mut add = |name: String, way| {
                efforts.push(Effort { entrant: number, law, name, way });
            };
            if entrant.stepper.uses_method() {
                for &tolerance in residuals {
                    let way = entrant.to_residual(tolerance, MOST_SWEEPS);
                    add(format!("residual {tolerance:e}"), way);
                }
                for &count in sweeps.iter().filter(|_| law == Stepper::Moreau) {
                    add(format!("{count} sweeps"), entrant.sweeps(count));
                }
            } else {
                for &count in substeps {
                    let name = match count {
                        0 => "its own substeps".to_owned(),
                        count => format!("{count} substeps"),
                    };
                    add(name, entrant.substeps(count));
                }
            }
            entrants.push(entrant);
        }
        Self {
            time_steps_secs: if quick { vec![1e-3, 5e-3] } else { vec![1e-3, 2e-3, 5e-3] },
            piles: piles(quick),
            entrants,
            laws,
            efforts,
            repeats: if quick { 1 } else { 2 },
            limit_secs: if quick { 0.8 } else { 10.0 },
        }
    }
}

/// (Bond, seed) of each pile.
fn piles(quick: bool) -> Vec<(f64, u64)> {
    let shared = NewPile::default().seed;
    // Bond numbers are dealt out to the seeds: each is met by several, and each meets several.
    if quick {
        vec![(0.0, shared), (20.0, 1), (50.0, 2), (100.0, 3)]
    } else {
        let bonds = [[0.0, 50.0], [20.0, 100.0]];
        let seeds = [shared, 1, 2, 3, 4, 5];
        let of = |(index, seed): (usize, u64)| bonds[index % 2].map(|bond| (bond, seed));
        seeds.into_iter().enumerate().flat_map(of).collect()
    }
}

/// A pile of (Bond, seed) at a time step under a law.
pub(super) fn config((bond, seed): (f64, u64), time_step_secs: f64, law: Stepper) -> Config {
    let parameters = ParameterChanges {
        bond: Some(bond),
        time_step_secs: Some(time_step_secs),
        restitution_threshold: Some(THRESHOLD),
        ..ParameterChanges::default()
    };
    let origin = Origin { seed: Some(seed), ..Origin::default() };
    Config { origin, stepper: Some(law), parameters, ..Config::default() }
}
