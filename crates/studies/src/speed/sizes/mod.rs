//! What a step costs by the number of grains: to a residual of Coulomb's law, and to a certificate.
//!
//! Collections of steps of piles that begin to slump, and of piles at rest in their box, without cohesion and
//! with. They stand in runs whose every step was certified under bounds of friction, so that what a warm start
//! takes over is the error of no method. A step's time is that of the whole step, contacts and motion
//! included, over that of one of forty sweeps of `nsgs`, which is measured beside each.

mod report;

use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::collection::{ADVANCE, CollectionPlan};
use super::performance::{Timing, median_with_failures, share_solved};
use super::solves::{LEAST_REPEATS, SolveTimer, TimedSolves, solved_by, time_collection, timed};
use super::variants::{self, ChartedVariant};
use super::{Bench, ChartSection, csv_cell, listed};
use crate::chart::{Axis, Chart, Layer, Look, Rgb, Sheet, points};
use crate::contact::ContactList;
use crate::error::Result;
use crate::scene::Deposition;
use crate::sim::{ProblemVisitor, Simulation};
use crate::solver::{FrictionModel, Memory, Method, Model, SolverSettings, StepProblem};

/// Grains of the piles.
const SIZES: [usize; 3] = [500, 2_000, 10_000];
/// Residuals of Coulomb's law, falling.
const RESIDUALS: [f64; 3] = [1e-3, 1e-6, 1e-8];
/// The natural map of a model of friction that is certified.
const CERTIFIED: f64 = 1e-8;
/// Bond numbers: the second one is felt, and yet lets a pile of any size slump.
const BONDS: [f64; 2] = [0.0, 10.0];
/// Sweeps of the step in whose time others are told.
const UNIT_SWEEPS: u32 = 40;
/// Width of a box over the root of the number of its grains, in diameters: 16 for 138.
const WIDTH_BY_ROOT: f64 = 1.35;

/// Coulomb's law is not solved in large piles, and a run that is certified leaves the warm start of no method
/// better off.
const ADVANCE_CERTIFIED: SolverSettings = SolverSettings {
    method: Method::InteriorPoint,
    friction_model: FrictionModel::Tresca,
    ..ADVANCE
};

/// Beside the sizes on either side of the axis, as a factor.
const MARGIN: f64 = 1.8;
/// Of the limit: where what did not reach its goal stands, and where the axis ends.
const GIVEN_UP: [f64; 2] = [2.0, 4.0];
/// Where the axis begins, in steps of the unit.
const LEAST: f64 = 0.2;
/// From ring to ring, in widths of the panel.
const RING: f64 = 0.03;
const GREY: Rgb = (130, 130, 130);

/// Times all variants over all sizes, and draws a figure of what moves and one of what rests.
pub(super) fn make(bench: &Bench) -> Result<Vec<ChartSection>> {
    let quick = bench.options.quick;
    let limit = step_limit(quick);
    let runner = bench.runner("sizes")?;
    let mut sections = Vec::new();
    for (state, in_a_box) in [("moving", false), ("rest", true)] {
        let mut by_size =
            StepsBySize { state, limit, variants: timed_variants(), sizes: Vec::new() };
        for grains in SIZES {
            let plan = steps(grains, in_a_box, quick);
            let variants = &by_size.variants;
            let times = time_collection(bench, &runner, &plan, variants, |simulation, variant| {
                time(simulation, variant, limit)
            })?;
            by_size.sizes.push(SizedSteps { grains, problems: plan.names(), times });
        }
        sections.push(ChartSection {
            name: format!("chart-size-{state}"),
            sheet: by_size.sheet(bench),
            report: by_size.report(),
            tables: vec![(format!("chart-size-{state}-times"), by_size.table())],
        });
    }
    Ok(sections)
}

/// Under Coulomb's law, then under a convex model.
fn timed_variants() -> Vec<ChartedVariant> {
    let mut variants = variants::of_problems(false);
    let models = variants::models().into_iter();
    variants.extend(models.filter(|one| one.solver.friction_model == FrictionModel::Tresca));
    variants
}

/// A step gets no more time than so many of [`UNIT_SWEEPS`] sweeps.
fn step_limit(quick: bool) -> f64 {
    if quick { 100.0 } else { 1_000.0 }
}

/// What a variant is to reach, falling.
fn goals(variant: &ChartedVariant) -> &'static [f64] {
    if variant.is_of_model() { &[CERTIFIED] } else { &RESIDUALS }
}

/// Steps at Δt = 1e-3 s of piles without cohesion and with, made quickly, as steep as that of 138 grains: beginning
/// to slump or, in their box, at rest.
fn steps(grains: usize, in_a_box: bool, quick: bool) -> CollectionPlan {
    let times_secs = match (in_a_box, quick) {
        (true, true) => vec![5e-3],
        (true, false) => vec![1e-2, 2e-2],
        (false, true) => vec![2e-2],
        (false, false) => vec![3e-2, 0.1],
    };
    CollectionPlan {
        bonds: BONDS.to_vec(),
        time_steps_secs: vec![1e-3],
        times_secs,
        seeds: vec![1],
        grains,
        box_width_in_diameters: (WIDTH_BY_ROOT * (grains as f64).sqrt()).round(),
        deposition: Deposition::DropAndRoll,
        in_a_box,
        advance: ADVANCE_CERTIFIED,
        ..CollectionPlan::piles(2.0)
    }
}

/// The times of one variant on a step.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct StepTimes {
    /// Time of a whole step of [`UNIT_SWEEPS`] sweeps of `nsgs`, just before, s.
    unit_secs: f64,
    /// Time of a step of this variant but for its solve, s.
    besides_secs: f64,
    solves: TimedSolves,
}

impl StepTimes {
    /// Time of a whole step to that goal, s; longer than any where it was not reached. A solve that went further has
    /// reached it too.
    fn step_secs(&self, goal: f64) -> f64 {
        let as_far = self.solves.reached.iter().filter(|reached| reached.goal <= goal);
        let solves = as_far.map(|reached| reached.solve_secs);
        self.besides_secs + solves.fold(f64::INFINITY, f64::min)
    }
}

/// Times a variant from goal to goal, until one is not reached within so many units.
fn time(simulation: &Simulation, variant: &ChartedVariant, limit: f64) -> Result<StepTimes> {
    let unit = variants::of_method(Method::Nsgs);
    let settings = unit.sweeps(UNIT_SWEEPS);
    let unit_secs = besides_secs(simulation, &unit)?
        + solved_by(simulation, settings)?.next_problem(LeastSolve { settings: &settings });
    let besides_secs = besides_secs(simulation, variant)?;
    let limit_secs = limit * unit_secs - besides_secs;
    let timer = SolveTimer { variant, goals: goals(variant), limit_secs, keeps_memory: true };
    Ok(StepTimes { unit_secs, besides_secs, solves: timer.time(simulation)? })
}

/// What a step takes but for its solve: contacts, their order, motion, and what is observed.
fn besides_secs(simulation: &Simulation, variant: &ChartedVariant) -> Result<f64> {
    // Met by whatever the first test looks at.
    let at_once = variant.to_residual(f64::MAX, 1);
    let start = solved_by(simulation, at_once)?;
    let mut least = f64::INFINITY;
    for _ in 0..LEAST_REPEATS {
        let mut simulation = start.clone();
        let started = Instant::now();
        simulation.step()?;
        least = least.min(started.elapsed().as_secs_f64());
    }
    Ok((least - start.next_problem(LeastSolve { settings: &at_once })).max(0.0))
}

/// The least time of some solves, s.
struct LeastSolve<'a> {
    settings: &'a SolverSettings,
}

impl ProblemVisitor for LeastSolve<'_> {
    type Output = f64;

    fn visit<M: Model>(self, problem: &mut StepProblem<M>, _: &ContactList) -> f64 {
        let once = |_| timed::<M>(problem, &mut Memory::default(), self.settings).0;
        (0..LEAST_REPEATS).map(once).fold(f64::INFINITY, f64::min)
    }
}

/// Steps of one size.
struct SizedSteps {
    grains: usize,
    /// Names of the steps.
    problems: Vec<String>,
    /// By variant, then by step.
    times: Vec<Vec<StepTimes>>,
}

/// All steps in one state of the piles.
struct StepsBySize {
    /// In the names of files.
    state: &'static str,
    /// See [`step_limit`].
    limit: f64,
    variants: Vec<ChartedVariant>,
    sizes: Vec<SizedSteps>,
}

/// What a variant comes to at one size and goal.
struct SizeSummary {
    /// Steps.
    steps: usize,
    /// Share of them that reach the goal.
    share: f64,
    /// Median time of a whole step over that of the unit; none where half of the steps do not reach it.
    median: Option<f64>,
    /// The same time, s.
    median_secs: Option<f64>,
    /// The largest duality gap of what reached the goal; not a number where nothing did.
    largest_gap: f64,
}

impl SizedSteps {
    fn summary(&self, variant: usize, goal: f64) -> SizeSummary {
        let times = &self.times[variant];
        let timings = |unit: fn(&StepTimes) -> f64| -> Vec<Timing> {
            let timing = |times: &StepTimes| {
                let secs = times.step_secs(goal) / unit(times);
                Timing { secs, solved: secs.is_finite() }
            };
            times.iter().map(timing).collect()
        };
        let by_unit = timings(|times| times.unit_secs);
        let gaps = times.iter().filter_map(|times| times.solves.reached(goal)?.duality_gap);
        SizeSummary {
            steps: times.len(),
            share: share_solved(&by_unit),
            median: median_with_failures(&by_unit),
            median_secs: median_with_failures(&timings(|_| 1.0)),
            largest_gap: gaps.fold(f64::NAN, f64::max),
        }
    }

    /// Time of a step of the unit, median of all, ms.
    fn unit_ms(&self) -> f64 {
        let of_all = self.times.iter().flatten();
        let units: Vec<_> =
            of_all.map(|times| Timing { secs: times.unit_secs, solved: true }).collect();
        1e3 * median_with_failures(&units).unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::super::collection::collect;
    use super::super::solves::{ROUNDING, ReachedGoal};
    use super::*;
    use crate::scene::NewPile;

    fn collected(grains: usize, in_a_box: bool) -> Vec<Simulation> {
        let folder = tempfile::tempdir().expect("a folder");
        collect(&steps(grains, in_a_box, true), folder.path()).expect("a collection")
    }

    #[test]
    fn a_pile_in_a_box_is_at_rest_and_one_without_slumps_each_step_certified() {
        let speeds = [true, false].map(|in_a_box| {
            let collected = collected(SIZES[0], in_a_box);
            assert_eq!(collected.len(), BONDS.len());
            collected.into_iter().map(|step| {
                let told = step.observables();
                assert!(
                    told.converged && told.model_residual.is_some_and(|left| left <= CERTIFIED)
                );
                let velocities = step.world().grains.velocities.iter();
                velocities.map(|velocity| velocity.length()).fold(0.0, f64::max)
            })
        });
        let [at_rest, moving] = speeds.map(Vec::from_iter);
        assert!(at_rest.iter().all(|speed| *speed < 0.01), "{at_rest:?} m/s");
        assert!(moving.iter().all(|speed| *speed > 0.1), "{moving:?} m/s");
    }

    #[test]
    fn boxes_are_as_steep_as_the_papers() {
        let paper = NewPile::default();
        let width = steps(paper.grains, false, false).box_width_in_diameters;
        assert_eq!(width, paper.box_width_in_diameters);
    }

    #[test]
    fn models_come_after_all_methods_and_have_a_goal_of_their_own() {
        let variants = timed_variants();
        let certified: Vec<_> =
            variants.iter().skip_while(|variant| goals(variant) == RESIDUALS).collect();
        let names: Vec<_> = certified.iter().map(|variant| variant.name.as_str()).collect();
        assert_eq!(names, ["nsgs tresca", "interior-point tresca"]);
    }

    #[test]
    fn a_certificate_has_a_gap_and_solves_end_at_their_limit() {
        let variants = timed_variants();
        let certified = variants.last().expect("a variant");
        for step in collected(SIZES[0], false) {
            let times = time(&step, certified, step_limit(false)).expect("times");
            let reached = times.solves.reached(CERTIFIED).expect("it is certified");
            assert!(reached.left <= CERTIFIED * (1.0 + ROUNDING));
            assert!(reached.duality_gap.is_some_and(|gap| gap.abs() < 1e-4));
            assert!(times.step_secs(CERTIFIED) > times.besides_secs);
            let unit = variants::of_method(Method::Nsgs);
            let times = time(&step, &unit, 1e-3).expect("times");
            assert!(times.solves.start > RESIDUALS[0], "there is something to be solved");
            assert!(times.solves.reached.is_empty() && times.solves.gave_up_secs.is_some());
            assert_eq!(times.step_secs(RESIDUALS[0]), f64::INFINITY);
        }
    }

    #[test]
    fn what_is_solved_too_late_is_not_reached() {
        // So few grains hold at this Bond number.
        let step = collected(60, false).pop().expect("a step");
        let unit = variants::of_method(Method::Nsgs);
        let ample = time(&step, &unit, step_limit(false)).expect("times").solves;
        assert!(ample.start <= RESIDUALS[0] && ample.reached(RESIDUALS[0]).is_some());
        let short = time(&step, &unit, 1e-9).expect("times").solves;
        assert!(short.smallest <= RESIDUALS[0], "a sweep does it");
        assert!(short.reached.is_empty());
    }

    /// Times in which each goal takes a third of a unit more than the one before.
    fn times(goals: &[f64]) -> StepTimes {
        let reached = goals.iter().zip(1..).map(|(&goal, number)| ReachedGoal {
            goal,
            solve_secs: f64::from(number),
            left: goal,
            duality_gap: None,
        });
        let solves = TimedSolves {
            contacts: 9,
            start: 1.0,
            smallest: 1e-4,
            reached: reached.collect(),
            gave_up_secs: Some(30.0),
        };
        StepTimes { unit_secs: 3.0, besides_secs: 0.5, solves }
    }

    /// Two sizes of four steps each. The first variant reaches all goals at the smaller, and at the larger the
    /// first goal in half of the steps; the others reach nothing.
    fn made_up() -> StepsBySize {
        let variants = timed_variants();
        let sizes = [(500, [3; 4]), (2_000, [1, 1, 0, 0])].map(|(grains, goals)| {
            let of_variant = |number: usize| {
                let reached =
                    |count: usize| times(&RESIDUALS[..if number == 0 { count } else { 0 }]);
                goals.map(reached).to_vec()
            };
            let problems = [0, 1, 2, 3].map(|number| format!("{grains}, {number}")).to_vec();
            SizedSteps { grains, problems, times: (0..variants.len()).map(of_variant).collect() }
        });
        StepsBySize { state: "moving", limit: step_limit(true), variants, sizes: sizes.into() }
    }

    #[test]
    fn a_summary_is_of_whole_steps_and_has_no_median_where_half_of_them_fail() {
        let [small, large] = &made_up().sizes[..] else { panic!("two sizes") };
        let [first, second, _] = RESIDUALS;
        let all = small.summary(0, second);
        assert_eq!((all.steps, all.share), (4, 1.0));
        assert_eq!((all.median_secs, all.median), (Some(2.5), Some(2.5 / 3.0)));
        let half = large.summary(0, first);
        assert_eq!((half.share, half.median), (0.5, None));
        assert_eq!(large.summary(0, second).share, 0.0);
        assert_eq!(large.unit_ms(), 3e3);
    }

    #[test]
    fn what_is_not_reached_stands_above_the_limit() {
        let made_up = made_up();
        let above = GIVEN_UP[0] * made_up.limit;
        assert!(above > made_up.limit);
        // Places of the curves of a variant, and of the rings of what it did not reach.
        let places = |number: usize| {
            let mut places = [Vec::new(), Vec::new()];
            for layer in made_up.layers(number, RESIDUALS[0], 0.0) {
                if let Layer::Curve { name, points, .. } = layer {
                    let missed = usize::from(name.contains("not reached"));
                    places[missed].extend(points.iter().map(|point| (point.x, point.y)));
                }
            }
            places
        };
        assert_eq!(places(0), [vec![(500.0, 0.5)], vec![(2_000.0, above)]]);
        let [reached, missed] = places(1);
        assert_eq!((reached.len(), missed.len()), (0, 2), "nothing is hidden");
    }
}
