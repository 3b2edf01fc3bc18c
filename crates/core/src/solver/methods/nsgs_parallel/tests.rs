//! Tests of Gauss–Seidel by tiles (groups of contacts that different threads can solve) with random contact problems:
//! with any width of the vector registers and any number of threads the result is bitwise the same as if one contact is
//! solved after the other.

use rayon::ThreadPoolBuilder;

use super::*;
use crate::contact::levels;
use crate::solver::methods::pass::sweep;
use crate::solver::methods::random_problem::random_problem;
use crate::solver::problem::residual;
use crate::solver::settings::StopTest;
use crate::solver::{Line, Plane, SmoothPlane, SpinningPlane};
use crate::world::FrictionCone::{self, Compressive, Shifted};

/// Returns a problem with random contacts, sorted by tiles (groups of contacts that share no grain with another tile)
/// and colours (groups of contacts that share no grain). The indices of the two bodies of a contact differ by less than
/// 64.
fn problem<M: Model>(
    seed: u64,
    bodies: usize,
    contacts: u32,
    cone: FrictionCone,
) -> StepProblem<M> {
    let (law, reach) = (ContactLaw::new(0.5, 0.3, cone), bodies.min(64));
    let mut problem = random_problem::<M>(seed, law, bodies, contacts, reach, -0.5..0.5);
    problem.sort_by_colours();
    problem.form_velocities();
    problem
}

/// Returns the bit patterns of all impulses, then of all velocities.
fn bits<M: Model>(problem: &StepProblem<M>) -> Vec<u64> {
    let impulses =
        problem.rows().flat_map(|(_, row)| [row.shifted_impulse, row.tangential_impulse]);
    let velocities = problem.bodies.now.iter().flat_map(M::coordinates::<f64>);
    impulses.chain(velocities).map(f64::to_bits).collect()
}

/// Returns settings for exactly `max_sweeps` sweeps, with a stopping test that is never met.
fn sweeps(max_sweeps: u32) -> SolverSettings {
    let stop = StopTest::ImpulsePerMass;
    SolverSettings { stop, tolerance: 0.0, max_sweeps, ..SolverSettings::SWEEPS }
}

#[test]
fn the_sum_of_squared_impulses_is_that_of_the_rows_with_a_capture_speed_each() {
    for captures in [false, true] {
        let mut problem = problem::<SpinningPlane>(3, 40, 203, Shifted);
        if captures {
            problem.rows.captures = (0..203).map(|row| 1e-3 * f64::from(row)).collect();
        }
        let square = |(number, row): (usize, &Row<SpinningPlane>)| {
            let [normal, tangential] = problem.reduced_impulse(number, row);
            row.effective_mass.powi(2) * (normal.powi(2) + tangential.powi(2))
        };
        let expected: f64 = problem.rows().map(square).sum();
        let mut memory = BlockMemory::default();
        let tiled = Tiled::<SpinningPlane>::new(Level::new(), &mut problem, &mut memory);
        let found = tiled.expect("colours").squared_impulses();
        assert!((found / expected - 1.0).abs() < 1e-14, "{found} for {expected}");
    }
}

fn residual_is_that_of_the_rows<M: Model>(cone: FrictionCone) {
    // A problem with one tile, and a problem with several tiles and contacts between them.
    for (bodies, contacts) in [(40, 203), (4000, 8000)] {
        for level in levels() {
            let mut problem = problem::<M>(4, bodies, contacts, cone);
            nsgs::solve(&mut problem, &sweeps(3));
            let expected = residual(&problem);
            let mut memory = BlockMemory::default();
            let mut tiled = Tiled::<M>::new(level, &mut problem, &mut memory).expect("colours");
            let found = tiled.residual();
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} for {expected}");
            assert!(expected > 1e-6, "something errs");
        }
    }
}

#[test]
fn the_residual_in_blocks_is_that_of_the_rows() {
    residual_is_that_of_the_rows::<Line>(Shifted);
    residual_is_that_of_the_rows::<Plane>(Compressive);
    residual_is_that_of_the_rows::<SpinningPlane>(Shifted);
}

#[test]
fn where_nothing_would_move_the_residual_is_none_or_infinite() {
    for (error, expected) in [(0.0, 0.0), (0.1, f64::INFINITY)] {
        let mut problem = problem::<SpinningPlane>(5, 40, 60, Shifted);
        problem.law = ContactLaw::new(0.5, 0.0, Shifted);
        problem.bodies.free.iter_mut().for_each(|body| *body = Default::default());
        for row in problem.rows.iter_mut() {
            (row.restitution_velocity, row.shifted_impulse) = (0.0, error);
            row.tangential_impulse = 0.0;
        }
        problem.rows.fixed.iter_mut().for_each(|row| row.surface_speed = 0.0);
        problem.form_velocities();
        assert_eq!(residual::<SpinningPlane>(&problem), expected);
        let mut memory = BlockMemory::default();
        let tiled = Tiled::<SpinningPlane>::new(Level::new(), &mut problem, &mut memory);
        assert_eq!(tiled.expect("colours").residual(), expected);
    }
}

fn same_bits_at_all_levels<M: Model>(cone: FrictionCone) {
    let mut seen = [0; LANES];
    for seed in 0..60 {
        // The number of contacts is small, so that some colours end with a block of only one, two or three contacts.
        let start = problem::<M>(seed, 40, 1 + 3 * seed as u32, cone);
        let settings = sweeps(1 + seed as u32 % 30);
        let mut expected = start.clone();
        nsgs::solve(&mut expected, &settings);
        for level in levels() {
            let (mut solved, mut memory) = (start.clone(), BlockMemory::default());
            let report = solve_at::<M>(level, &mut solved, &mut memory, &settings);
            assert_eq!(report.sweeps, settings.max_sweeps);
            assert!(bits(&solved) == bits(&expected), "{level:?}, seed {seed}");
        }
        assert!(bits(&start) != bits(&expected), "something moves");
        for groups in &start.order.groups {
            groups.colours_of(0).for_each(|rows| seen[rows.len() % LANES] += 1);
        }
    }
    assert!(seen.iter().all(|&colours| colours > 10), "{seen:?}");
}

#[test]
fn contacts_side_by_side_give_the_bits_of_one_after_the_other() {
    same_bits_at_all_levels::<Line>(Shifted);
    same_bits_at_all_levels::<SmoothPlane>(Shifted);
    same_bits_at_all_levels::<Plane>(Shifted);
    same_bits_at_all_levels::<Plane>(Compressive);
    same_bits_at_all_levels::<SpinningPlane>(Shifted);
    same_bits_at_all_levels::<SpinningPlane>(Compressive);
}

#[test]
fn what_a_sweep_changed_is_one_sum_on_any_registers_and_threads() {
    let start = problem::<SpinningPlane>(1, 40_960, 80_000, Shifted);
    let mut one_by_one = start.clone();
    let expected = [(); 8].map(|()| sweep::<SpinningPlane, true>(&mut one_by_one));
    let (mut sums, mut residuals) = (Vec::new(), Vec::new());
    for several in [1, 2, 4] {
        let pool = ThreadPoolBuilder::new().num_threads(several).build().expect("threads");
        for level in levels() {
            let mut problem = start.clone();
            let mut memory = BlockMemory::default();
            let (changes, residual) = pool.install(|| {
                threads::share(|| {
                    let tiled = Tiled::<SpinningPlane>::new(level, &mut problem, &mut memory);
                    let mut tiled = tiled.expect("colours");
                    assert_eq!(tiled.threads, several > 1, "there are several tiles");
                    let changes = [(); 8].map(|()| tiled.sweep::<true>());
                    let residual = tiled.residual();
                    tiled.store();
                    let between = memory.layout.blocks.len() - blocks_of(&memory.layout.tiles);
                    assert!(between > 100, "contacts between tiles");
                    assert!(
                        memory.layout.tiles.iter().all(|tile| tile.blocks > 100 && tile.fixed > 10)
                    );
                    (changes, residual)
                })
            });
            residuals.push(residual.to_bits());
            assert!(bits(&problem) == bits(&one_by_one), "{level:?}, {several} threads");
            for (change, expected) in changes.iter().zip(&expected) {
                assert!((change.squared / expected.squared - 1.0).abs() < 1e-12);
                assert!((change.absolute / expected.absolute - 1.0).abs() < 1e-12);
            }
            sums.push(changes.map(|sum| [sum.squared, sum.absolute].map(f64::to_bits)));
        }
    }
    assert!(sums.iter().all(|sum| *sum == sums[0]), "{sums:?}");
    assert!(residuals.iter().all(|bits| *bits == residuals[0]), "{residuals:?}");
}

#[test]
fn rows_whose_colours_share_a_grain_are_swept_as_they_come() {
    let mut start = problem::<SpinningPlane>(2, 40, 200, Shifted);
    let second = start.order.groups[1].colour_ends[0];
    start.rows.pairs[second] = start.rows.pairs[second - 1];
    start.rows.pairs.swap(0, second);
    let (mut expected, mut solved) = (start.clone(), start);
    nsgs::solve::<SpinningPlane>(&mut expected, &sweeps(5));
    solve::<SpinningPlane>(&mut solved, &mut BlockMemory::default(), &sweeps(5));
    assert!(bits(&solved) == bits(&expected));
}

#[test]
fn tiles_that_share_a_grain_are_swept_as_they_come() {
    let mut start = problem::<SpinningPlane>(6, 4000, 8000, Shifted);
    let ends = &start.order.groups[1];
    let of_second = ends.colours_of(1).next().expect("a colour").start;
    // The first contact of the second tile gets a grain of the first tile.
    start.rows.pairs[of_second].i = start.rows.pairs[0].i;
    let (mut expected, mut solved) = (start.clone(), start);
    nsgs::solve::<SpinningPlane>(&mut expected, &sweeps(5));
    let mut memory = BlockMemory::default();
    assert!(Tiled::<SpinningPlane>::new(Level::new(), &mut solved.clone(), &mut memory).is_none());
    solve::<SpinningPlane>(&mut solved, &mut memory, &sweeps(5));
    assert!(bits(&solved) == bits(&expected));
}
