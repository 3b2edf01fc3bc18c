//! Which piles are run, by which methods, and how well each is to solve its steps.

use super::super::entrants::{self, Entrant, Way};
use crate::config::{Config, SceneSource};
use crate::scene::{Deposition, NewPile};
use crate::sim::Stepper;
use crate::solver::{Method, SolverSettings, StopTest};
use crate::world::ParameterChanges;

/// A step gets no more sweeps: one without a solution must not take for ever.
const MOST_SWEEPS: u32 = 5_000;
/// Contacts slower than this many g·Δt do not bounce.
const THRESHOLD: f64 = 2.0;
/// The pile of 2,000 grains that other engines ran.
const LARGE: NewPile =
    NewPile { grains: 2_000, box_width_in_diameters: 60.0, seed: 1, deposition: Deposition::Rain };

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

/// How each entrant is tried.
struct Tries {
    residuals: Vec<f64>,
    sweeps: Vec<u32>,
    substeps: Vec<u32>,
    laws: Vec<Stepper>,
}

/// What is run.
pub(super) struct Plan {
    /// In the names of files.
    pub label: &'static str,
    pub time_steps_secs: Vec<f64>,
    /// What the piles are made as; each has a seed of its own.
    pub made_as: NewPile,
    /// Simulated time of a run, s.
    pub duration_secs: f64,
    /// (Bond, seed) of each pile; the first one is without cohesion.
    pub piles: Vec<(f64, u64)>,
    /// Whether the first one is that which other engines ran.
    pub has_peers: bool,
    /// Who takes part.
    pub entrants: Vec<Entrant>,
    pub efforts: Vec<Effort>,
    /// Laws that have references.
    pub laws: Vec<Stepper>,
    /// Δt of the reference with the least error of the time step, s.
    pub finest_secs: f64,
    /// How the references are solved.
    pub reference: Entrant,
    /// Residual of the references, and of those that show the floor.
    pub tolerances: [f64; 2],
    /// How often a run is timed.
    pub repeats: u32,
    /// Wall time that a simulated second may take, s.
    pub limit_secs: f64,
}

impl Plan {
    /// The paper's 138 grains.
    pub(super) fn of_paper(quick: bool) -> Self {
        let (entrants, efforts) = tried(&Tries {
            residuals: if quick {
                vec![1e-2, 1e-4, 1e-6]
            } else {
                vec![1e-1, 1e-2, 1e-4, 1e-6, 1e-8]
            },
            sweeps: if quick { vec![20] } else { vec![10, 40] },
            substeps: if quick { vec![0] } else { vec![0, 16, 64] },
            laws: laws(quick),
        });
        Self {
            label: "",
            time_steps_secs: if quick { vec![1e-3, 5e-3] } else { vec![1e-3, 2e-3, 5e-3] },
            made_as: NewPile::default(),
            duration_secs: 1.0,
            piles: piles(quick),
            has_peers: true,
            entrants,
            efforts,
            laws: laws(quick),
            finest_secs: 1e-4,
            reference: entrants::of_method(Method::Newton),
            tolerances: [1e-8, 1e-9],
            repeats: if quick { 1 } else { 2 },
            limit_secs: if quick { 0.8 } else { 10.0 },
        }
    }

    /// 2,000 grains. Coulomb's law is not solved there, so that the references are certified under the bounds of
    /// friction that piles do not tell from it. A quick pass has no time for rain.
    pub(super) fn of_large(quick: bool) -> Self {
        let laws = vec![Stepper::Moreau];
        let (entrants, efforts) = tried(&Tries {
            residuals: if quick { vec![1e-2] } else { vec![1e-2, 1e-4] },
            sweeps: vec![40],
            substeps: vec![0],
            laws: laws.clone(),
        });
        let bonds: &[f64] = if quick { &[0.0, 20.0] } else { &[0.0, 20.0, 50.0] };
        let deposition = if quick { Deposition::DropAndRoll } else { LARGE.deposition };
        Self {
            label: "-large",
            time_steps_secs: if quick { vec![2e-3, 5e-3] } else { vec![1e-3, 5e-3] },
            made_as: NewPile { deposition, ..LARGE },
            duration_secs: if quick { 0.2 } else { 1.0 },
            piles: bonds.iter().map(|&bond| (bond, LARGE.seed)).collect(),
            has_peers: !quick,
            entrants,
            efforts,
            laws,
            finest_secs: if quick { 2e-3 } else { 1e-3 },
            reference: entrants::certified(),
            tolerances: [1e-8, 1e-7],
            repeats: 1,
            limit_secs: if quick { 15.0 } else { 60.0 },
        }
    }

    /// A pile of (Bond, seed) at a time step under a law.
    pub(super) fn config(
        &self,
        (bond, seed): (f64, u64),
        time_step_secs: f64,
        law: Stepper,
    ) -> Config {
        let parameters = ParameterChanges {
            bond: Some(bond),
            time_step_secs: Some(time_step_secs),
            restitution_threshold: Some(THRESHOLD),
            ..ParameterChanges::default()
        };
        let source = SceneSource {
            grains: Some(self.made_as.grains),
            box_width: Some(self.made_as.box_width_in_diameters),
            deposition: Some(self.made_as.deposition),
            seed: Some(seed),
            duration: Some(self.duration_secs),
            ..SceneSource::default()
        };
        Config { source, stepper: Some(law), parameters, ..Config::default() }
    }

    /// How the references are solved to a tolerance.
    pub(super) fn reference_to(&self, tolerance: f64) -> SolverSettings {
        SolverSettings { stop: StopTest::Residual, tolerance, ..self.reference.solver }
    }
}

/// What the law range costs is told by one good method, and by long runs.
fn laws(quick: bool) -> Vec<Stepper> {
    if quick { vec![Stepper::Moreau] } else { vec![Stepper::Moreau, Stepper::Range] }
}

/// All entrants with all their efforts.
fn tried(tries: &Tries) -> (Vec<Entrant>, Vec<Effort>) {
    let mut entrants: Vec<Entrant> = Vec::new();
    let mut efforts = Vec::new();
    let of_law = |law| entrants::all().into_iter().map(move |entrant| (law, entrant));
    let models = entrants::models().into_iter().map(|model| (Stepper::Moreau, model));
    for (law, mut entrant) in tries.laws.iter().copied().flat_map(of_law).chain(models) {
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
            for &tolerance in &tries.residuals {
                let way = entrant.to_residual(tolerance, MOST_SWEEPS);
                add(format!("residual {tolerance:e}"), way);
            }
            for &count in tries.sweeps.iter().filter(|_| law == Stepper::Moreau) {
                add(format!("{count} sweeps"), entrant.sweeps(count));
            }
        } else {
            for &count in &tries.substeps {
                let name = match count {
                    0 => "its own substeps".to_owned(),
                    count => format!("{count} substeps"),
                };
                add(name, entrant.substeps(count));
            }
        }
        entrants.push(entrant);
    }
    (entrants, efforts)
}

/// (Bond, seed) of each pile of 138 grains.
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
