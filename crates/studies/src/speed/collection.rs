//! Collects steps of simulated piles, on which solver methods are compared. A collected step is a simulation in its
//! state just before the step, together with the impulses of the previous step for a warm start.

use std::path::Path;

use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::config::{Config, SceneSource};
use crate::error::Result;
use crate::harness::{Bench, Case, Effort, Runner, Threads};
use crate::output::Progress;
use crate::scene::{Deposition, NewPile, walls};
use crate::sim::Simulation;
use crate::solver::{FrictionModel, Method, Ordering, SolverSettings, StopTest};
use crate::states::States;
use crate::world::{ParameterChanges, RESTITUTION_THRESHOLD};

/// Solver settings with which piles are simulated up to the collected steps. The tolerance is so small that the
/// collected states contain no visible error of the solver, which could favour one of the compared methods.
const ADVANCE: SolverSettings = SolverSettings {
    method: Method::Newton,
    ordering: Ordering::Interleaved,
    stop: StopTest::Residual,
    tolerance: 1e-8,
    max_sweeps: 1000,
    warm_start: true,
    friction_model: FrictionModel::Coulomb,
    model_solves: 1,
};

/// Width of the box in which a pile is made, in diameters, divided by the square root of the number of grains. For 138
/// grains, the number in Abramian & Staron (2020), the box is 16 diameters wide.
const WIDTH_BY_ROOT: f64 = 1.35;

/// Description of a collection of steps on which solver methods are compared. One pile is simulated for every Bond
/// number and time step Δt, and one of its steps is collected at each of several simulated times.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CollectionPlan {
    pub bonds: Vec<f64>,
    /// Time steps Δt of the piles, s.
    pub time_steps_secs: Vec<f64>,
    /// Simulated times at which the collected steps begin, s, in ascending order.
    pub times_secs: Vec<f64>,
    /// Seeds of the initial states of the piles. There are more piles than seeds, so several piles have the same seed.
    pub seeds: Vec<u64>,
    pub grains: usize,
    /// Width of the box in which the initial states are made, in diameters.
    pub box_width_in_diameters: f64,
    pub deposition: Deposition,
    /// True if the piles remain in the box in which they were made, so that they are at rest.
    pub in_a_box: bool,
    pub advance: SolverSettings,
    /// Approach speed below which contacts do not bounce, in units of g·Δt, the speed that gravity adds in one step; 0
    /// in the scheme of Abramian & Staron (2020).
    pub restitution_threshold: f64,
    /// Coefficient of friction; `None` for the coefficient of the scene.
    pub friction: Option<f64>,
}

impl CollectionPlan {
    /// Returns the description of a collection of 48 steps (24 in a quick pass, a pass with fewer runs) of piles of 138
    /// grains, the number in Abramian & Staron (2020). In the full pass, the steps are from the first motion, from the
    /// collapse (which takes about 0.3 s), from its end, and from the state of rest.
    pub(super) fn piles(restitution_threshold: f64, effort: Effort) -> Self {
        let rain = NewPile::default();
        Self {
            bonds: vec![0.0, 20.0, 50.0, 100.0],
            time_steps_secs: vec![1e-4, 1e-3, 5e-3],
            times_secs: effort.pick(vec![0.03, 0.1], vec![0.03, 0.1, 0.25, 0.6]),
            seeds: vec![rain.seed, 1, 2, 3],
            grains: rain.grains,
            box_width_in_diameters: rain.box_width_in_diameters,
            deposition: rain.deposition,
            in_a_box: false,
            advance: ADVANCE,
            restitution_threshold,
            friction: None,
        }
    }

    /// Returns the description of a collection of steps with Δt = 1e-3 s, from piles of `grains` grains with and
    /// without cohesion. The initial states are made by the quick method drop-and-roll and are as steep as the pile of
    /// Abramian & Staron (2020), which has 138 grains. The piles begin to slump or, with `in_a_box`, are at rest in
    /// their box. The steps before a collected step are solved with bounded friction (Tresca), so that the impulses of
    /// the warm start contain no error of a compared method.
    pub(super) fn of_size(grains: usize, in_a_box: bool, effort: Effort) -> Self {
        let times_secs = match in_a_box {
            true => effort.pick(vec![5e-3], vec![1e-2, 2e-2]),
            false => effort.pick(vec![2e-2], vec![3e-2, 0.1]),
        };
        Self {
            // The second Bond number has an effect, but still lets a pile of any size slump.
            bonds: vec![0.0, 10.0],
            time_steps_secs: vec![1e-3],
            times_secs,
            seeds: vec![1],
            grains,
            box_width_in_diameters: (WIDTH_BY_ROOT * (grains as f64).sqrt()).round(),
            deposition: Deposition::DropAndRoll,
            in_a_box,
            advance: SolverSettings {
                method: Method::InteriorPoint,
                friction_model: FrictionModel::Tresca,
                ..ADVANCE
            },
            restitution_threshold: RESTITUTION_THRESHOLD,
            friction: None,
        }
    }

    /// Returns the Bond number, the time step Δt (s) and the simulated time (s) of each step of the collection.
    pub(super) fn steps(&self) -> Vec<[f64; 3]> {
        let of_pile = |bond, step| self.times_secs.iter().map(move |&time| [bond, step, time]);
        let steps =
            |&bond: &f64| self.time_steps_secs.iter().flat_map(move |&step| of_pile(bond, step));
        self.bonds.iter().flat_map(steps).collect()
    }

    pub(super) fn names(&self) -> Vec<String> {
        let Self { grains, in_a_box, restitution_threshold, friction, .. } = self;
        let place = if *in_a_box { " in a box" } else { "" };
        let friction = friction.map_or(String::new(), |it| format!(", μ {it}"));
        let name = |[bond, step, time]: [f64; 3]| {
            format!(
                "{grains} grains{place}, Bond {bond}{friction}, dt {step:e}, t {time}, threshold \
                    {restitution_threshold}"
            )
        };
        self.steps().into_iter().map(name).collect()
    }

    /// Returns the settings of one pile for every Bond number and time step. The seed changes with both, so that every
    /// time step and every Bond number occurs with several initial states.
    fn configs(&self) -> Vec<Config> {
        let mut configs = Vec::new();
        for (row, &bond) in self.bonds.iter().enumerate() {
            for (column, &time_step_secs) in self.time_steps_secs.iter().enumerate() {
                let source = SceneSource {
                    grains: Some(self.grains),
                    box_width: Some(self.box_width_in_diameters),
                    seed: Some(self.seeds[(row + column) % self.seeds.len()]),
                    deposition: Some(self.deposition),
                    ..SceneSource::default()
                };
                let parameters = ParameterChanges {
                    bond: Some(bond),
                    time_step_secs: Some(time_step_secs),
                    restitution_threshold: Some(self.restitution_threshold),
                    friction: self.friction,
                    ..ParameterChanges::default()
                };
                configs.push(Config { source, parameters, ..Config::default() });
            }
        }
        configs
    }
}

/// Simulates the piles of a collection on all cores. Returns one simulation for each collected step, in its state just
/// before this step. The simulations are sorted by Bond number, then by time step, then by simulated time.
/// `Simulation::next_problem` gives the contact problem of the collected step. Initial states are stored in
/// `states_folder`. Two calls with the same plan return simulations that are equal to the last bit.
pub(super) fn collect(plan: &CollectionPlan, states_folder: &Path) -> Result<Vec<Simulation>> {
    let configs = plan.configs();
    let states = States::of(states_folder.to_owned(), configs.iter())?;
    let last_secs = plan.times_secs.last().copied().unwrap_or(0.0);
    let steps_of = |time_secs: f64, config: &Config| {
        (time_secs / config.parameters.time_step_secs.unwrap_or(f64::INFINITY)).round() as u64
    };
    let total = configs.iter().map(|config| steps_of(last_secs, config)).sum();
    let progress = Progress::new("steps to collect", total);
    let piles: Result<Vec<Vec<Simulation>>> = configs
        .par_iter()
        .with_max_len(1)
        .map(|config| {
            let mut scene = states.scene(config)?;
            scene.solver = plan.advance;
            if plan.in_a_box {
                scene.boundaries = walls(plan.box_width_in_diameters);
            }
            let mut simulation = scene.simulation()?;
            let mut collected = Vec::with_capacity(plan.times_secs.len());
            for &time_secs in &plan.times_secs {
                while simulation.observables().step < steps_of(time_secs, config) {
                    simulation.step()?;
                    progress.advance(1);
                }
                collected.push(simulation.clone());
            }
            Ok(collected)
        })
        .collect();
    progress.finish();
    Ok(piles?.into_iter().flatten().collect())
}

/// Returns the results of `compute` for each step of a collection. Each result is stored in the journal (file of
/// results) named `journal`. A result that is already in this file is read and not computed again.
pub(super) fn over_steps<T: Clone + Send + Sync + Serialize + DeserializeOwned>(
    bench: &Bench,
    journal: &str,
    plan: &CollectionPlan,
    threads: Threads,
    compute: impl Fn(&Simulation) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let runner: Runner<T> = bench.runner(journal)?;
    let case = |(setup, key)| Case { key, cost: 1.0, setup };
    let cases: Vec<Case<usize>> = plan.names().into_iter().enumerate().map(case).collect();
    let is_finished = cases.iter().all(|case| runner.has(&case.key));
    let steps = if is_finished { Vec::new() } else { collect(plan, &bench.states_folder())? };
    let results = runner.run(&cases, threads, |&step| compute(&steps[step]))?;
    Ok(results.into_iter().map(|case| case.result).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Parameters;

    fn small() -> CollectionPlan {
        CollectionPlan {
            bonds: vec![0.0, 20.0],
            time_steps_secs: vec![1e-3, 5e-3],
            times_secs: vec![0.01, 0.02],
            seeds: vec![1, 2],
            grains: 30,
            box_width_in_diameters: 8.0,
            ..CollectionPlan::piles(2.0, Effort::Full)
        }
    }

    fn steps(plan: &CollectionPlan) -> usize {
        plan.bonds.len() * plan.time_steps_secs.len() * plan.times_secs.len()
    }

    fn bits(step: &Simulation) -> Vec<u64> {
        let grains = &step.world().grains;
        let places = grains.positions.iter().chain(&grains.velocities);
        let impulses = step.contacts().impulses();
        let mut bits: Vec<u64> = places.flat_map(|v| [v.x.to_bits(), v.y.to_bits()]).collect();
        bits.extend(impulses.iter().flat_map(|i| [i.normal.to_bits(), i.tangential.to_bits()]));
        bits
    }

    #[test]
    fn a_collection_is_the_same_on_any_number_of_threads_and_steps_stand_at_their_time() {
        let folder = tempfile::tempdir().expect("a folder");
        let plan = small();
        let first = collect(&plan, folder.path()).expect("a collection");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
        let again = pool.install(|| collect(&plan, folder.path())).expect("a collection");
        assert_eq!(first.len(), steps(&plan));
        assert!(first.iter().map(bits).eq(again.iter().map(bits)));
        let mut names = plan.names();
        assert_eq!(names.len(), first.len());
        for (simulation, name) in first.iter().zip(&names) {
            assert!(!simulation.contacts().impulses().is_empty());
            let Parameters { bond, time_step_secs, .. } = simulation.parameters();
            let told = format!(
                "30 grains, Bond {bond}, dt {time_step_secs:e}, t {:.2}, threshold 2",
                simulation.time_secs()
            );
            assert_eq!(*name, told);
            assert!(simulation.world().boundaries.is_empty());
            assert_eq!(simulation.parameters().restitution_threshold, 2.0);
        }
        names.dedup();
        assert_eq!(names.len(), first.len(), "every step has a name of its own");
    }

    #[test]
    fn boxes_are_as_steep_as_the_papers() {
        let paper = NewPile::default();
        let width =
            CollectionPlan::of_size(paper.grains, false, Effort::Full).box_width_in_diameters;
        assert_eq!(width, paper.box_width_in_diameters);
    }

    #[test]
    fn no_bond_number_and_no_time_step_meets_one_state_alone() {
        let plan = CollectionPlan::piles(0.0, Effort::Full);
        assert!(steps(&plan) >= 40);
        let configs = plan.configs();
        for bond in &plan.bonds {
            let seeds: std::collections::HashSet<_> = configs
                .iter()
                .filter(|c| c.parameters.bond == Some(*bond))
                .map(|c| c.source.seed)
                .collect();
            assert!(seeds.len() > 1);
        }
    }
}
