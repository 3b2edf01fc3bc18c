//! Which piles are run, by which methods, and how well each is to solve its steps.

use super::super::entrants::{self, Entrant};
use crate::scene::{Config, Rain};
use crate::solver::{METHODS, Method, MethodKind, SolverSettings};
use crate::world::ContactLaw;

/// A step gets no more sweeps: one without a solution must not take for ever.
const MOST_SWEEPS: u32 = 5_000;
/// Contacts slower than this many g·Δt do not bounce.
const THRESHOLD: f64 = 2.0;

/// One entrant, and how well it is to solve its steps.
pub(super) struct Effort {
    /// Number in `Plan::entrants`.
    pub entrant: usize,
    pub law: ContactLaw,
    /// In words.
    pub name: String,
    pub settings: SolverSettings,
}

/// What is run.
pub(super) struct Plan {
    pub time_steps_secs: Vec<f64>,
    /// (Bond, seed) of each pile.
    pub piles: Vec<(f64, u64)>,
    /// Who takes part.
    pub entrants: Vec<Entrant>,
    pub efforts: Vec<Effort>,
    /// Laws that they take.
    pub laws: Vec<ContactLaw>,
    /// How often a run is timed.
    pub repeats: u32,
    /// Wall time that a simulated second may take, s.
    pub limit_secs: f64,
}

impl Plan {
    pub fn new(quick: bool) -> Self {
        let shared = Rain::default().seed;
        let residuals: &[f64] =
            if quick { &[1e-2, 1e-4, 1e-6] } else { &[1e-1, 1e-2, 1e-4, 1e-6, 1e-8] };
        let sweeps: &[u32] = if quick { &[20] } else { &[10, 40] };
        let substeps: &[u32] = if quick { &[0] } else { &[0, 16, 64] };
        // What the law range costs is told by one good method, and by long runs.
        let laws = if quick {
            vec![ContactLaw::Moreau]
        } else {
            vec![ContactLaw::Moreau, ContactLaw::Range]
        };
        let mut entrants: Vec<Entrant> = Vec::new();
        let mut efforts = Vec::new();
        let of_law = |law| entrants::all().into_iter().map(move |entrant| (law, entrant));
        for (law, mut entrant) in laws.iter().copied().flat_map(of_law) {
            if law == ContactLaw::Range {
                if entrant.method != Method::Newton {
                    continue;
                }
                entrant.name.push_str(" (law range)");
                entrant.look += METHODS.len();
            }
            let number = entrants.len();
            let mut add = |name: String, settings| {
                efforts.push(Effort { entrant: number, law, name, settings });
            };
            match entrant.method.kind() {
                MethodKind::Problem => {
                    for &tolerance in residuals {
                        let settings = entrant.to_residual(tolerance, MOST_SWEEPS);
                        add(format!("residual {tolerance:e}"), settings);
                    }
                    for &count in sweeps.iter().filter(|_| law == ContactLaw::Moreau) {
                        add(format!("{count} sweeps"), entrant.sweeps(count));
                    }
                }
                MethodKind::Scheme(_) => {
                    for &count in substeps {
                        let name = match count {
                            0 => "its own substeps".to_owned(),
                            count => format!("{count} substeps"),
                        };
                        add(name, entrant.substeps(count));
                    }
                }
            }
            entrants.push(entrant);
        }
        // Bond numbers are dealt out to the seeds: each is met by several, and each meets several.
        let piles = if quick {
            vec![(0.0, shared), (20.0, 1), (50.0, 2), (100.0, 3)]
        } else {
            let bonds = [[0.0, 50.0], [20.0, 100.0]];
            let seeds = [shared, 1, 2, 3, 4, 5];
            let of = |(index, seed): (usize, u64)| bonds[index % 2].map(|bond| (bond, seed));
            seeds.into_iter().enumerate().flat_map(of).collect()
        };
        Self {
            time_steps_secs: if quick { vec![1e-3, 5e-3] } else { vec![1e-3, 2e-3, 5e-3] },
            piles,
            entrants,
            laws,
            efforts,
            repeats: if quick { 1 } else { 2 },
            limit_secs: if quick { 0.8 } else { 10.0 },
        }
    }
}

/// A pile of (Bond, seed) at a time step under a law.
pub(super) fn config((bond, seed): (f64, u64), time_step_secs: f64, law: ContactLaw) -> Config {
    Config {
        law: Some(law),
        seed: Some(seed),
        bond: Some(bond),
        dt: Some(time_step_secs),
        restitution_threshold: Some(THRESHOLD),
        ..Config::default()
    }
}
