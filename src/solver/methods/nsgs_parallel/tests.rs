//! Random contact problems: whatever the vector registers and the threads, the bits are those of
//! the same contacts one after the other.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::ThreadPoolBuilder;

use super::*;
use crate::contact::levels;
use crate::solver::problem::{Kinematics, Line, Plane, Row, SpinningPlane, StepModel};

/// Contacts between random bodies, every eighth against a fixed one, in the order of their colours.
fn problem<M: Model>(seed: u64, bodies: usize, contacts: u32) -> StepProblem<M::Kinematics> {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut problem = StepProblem::<M::Kinematics>::default();
    (problem.friction, problem.capture_speed, problem.mean_mass) = (0.5, 0.3, 1.0);
    problem.masses.resize(bodies, 1.0);
    problem.contact_of_row.extend(0..contacts);
    for _ in 0..bodies {
        let speeds = [(); 3].map(|()| random.random_range(-1.0..1.0));
        problem.free.push(M::Kinematics::from_coordinates(speeds));
    }
    problem.before.clone_from(&problem.free);
    for contact in 0..contacts {
        let i = random.random_range(0..bodies);
        let j = (i + random.random_range(1..bodies)) % bodies;
        let angle: f64 = random.random_range(0.0..std::f64::consts::TAU);
        let normal = [if angle < 3.0 { 1.0 } else { -1.0 }, 0.0];
        let row = Row {
            i: i as u32,
            j: j as u32,
            normal: M::Kinematics::normal(match M::Kinematics::AXES {
                1 => normal,
                _ => [angle.cos(), angle.sin()],
            }),
            share: random.random_range(0.1..0.9),
            restitution_velocity: random.random_range(-0.5..0.5),
            shifted_impulse: random.random_range(0.0..1.0),
            tangential_impulse: if M::FRICTION { random.random_range(-0.1..0.1) } else { 0.0 },
            effective_mass: random.random_range(0.5..2.0),
        };
        let rows = match contact % 8 {
            0 => &mut problem.fixed_rows,
            _ => &mut problem.pair_rows,
        };
        rows.push(Row { share: if contact % 8 == 0 { 1.0 } else { row.share }, ..row });
    }
    problem.sort_by_colours();
    problem.form_velocities();
    problem
}

/// Every bit that a solve leaves: impulses, then velocities.
fn bits<K: Kinematics>(problem: &StepProblem<K>) -> Vec<u64> {
    let impulses =
        problem.rows().flat_map(|(_, row)| [row.shifted_impulse, row.tangential_impulse]);
    let velocities = problem.bodies.iter().flat_map(K::coordinates::<f64>);
    impulses.chain(velocities).map(f64::to_bits).collect()
}

/// Sweeps that none of the tests ends.
fn sweeps(max_sweeps: u32) -> SolverSettings {
    let stop = StopTest::ImpulsePerMass;
    SolverSettings { stop, tolerance: 0.0, max_sweeps, ..SolverSettings::default() }
}

#[test]
fn the_sum_of_squared_impulses_is_that_of_the_rows_with_a_capture_speed_each() {
    type Full = StepModel<SpinningPlane, true, false>;
    for captures in [false, true] {
        let mut problem = problem::<Full>(3, 40, 203);
        if captures {
            problem.captures = (0..203).map(|row| 1e-3 * f64::from(row)).collect();
        }
        let square = |(number, row): (usize, &Row<SpinningPlane>)| {
            let [normal, tangential] = problem.reduced_impulse(number, row);
            row.effective_mass.powi(2) * (normal.powi(2) + tangential.powi(2))
        };
        let expected: f64 = problem.rows().map(square).sum();
        let mut memory = BlockMemory::default();
        let coloured = Coloured::<Full>::new(Level::new(), &mut problem, &mut memory);
        let found = coloured.expect("colours").squared_impulses();
        assert!((found / expected - 1.0).abs() < 1e-14, "{found} for {expected}");
    }
}

fn same_bits_at_all_levels<M: Model>() {
    let mut seen = [0; LANES];
    for seed in 0..60 {
        // So few that each number of rows that fill no block comes up.
        let start = problem::<M>(seed, 40, 1 + 3 * seed as u32);
        let settings = sweeps(1 + seed as u32 % 30);
        let mut expected = start.clone();
        nsgs::solve::<M>(&mut expected, &mut (), &settings);
        for level in levels() {
            let (mut solved, mut memory) = (start.clone(), BlockMemory::default());
            let report = solve_at::<M>(level, &mut solved, &mut memory, &settings);
            assert_eq!(report.sweeps, settings.max_sweeps);
            assert!(bits(&solved) == bits(&expected), "{level:?}, seed {seed}");
        }
        assert!(bits(&start) != bits(&expected), "something moves");
        for ends in &start.colour_ends {
            let starts = [0].iter().chain(ends);
            starts.zip(ends).for_each(|(start, end)| seen[(end - start) % LANES] += 1);
        }
    }
    assert!(seen.iter().all(|&colours| colours > 10), "{seen:?}");
}

#[test]
fn contacts_side_by_side_give_the_bits_of_one_after_the_other() {
    same_bits_at_all_levels::<StepModel<Line, false, false>>();
    same_bits_at_all_levels::<StepModel<Plane, false, false>>();
    same_bits_at_all_levels::<StepModel<Plane, true, false>>();
    same_bits_at_all_levels::<StepModel<Plane, true, true>>();
    same_bits_at_all_levels::<StepModel<SpinningPlane, true, false>>();
    same_bits_at_all_levels::<StepModel<SpinningPlane, true, true>>();
}

#[test]
fn what_a_sweep_changed_is_one_sum_on_any_registers_and_threads() {
    type Full = StepModel<SpinningPlane, true, false>;
    let start = problem::<Full>(1, 40_000, 80_000);
    let mut one_by_one = start.clone();
    let expected = [(); 8].map(|()| nsgs::sweep::<Full, true>(&mut one_by_one));
    let mut sums = Vec::new();
    for threads in [1, 2, 4] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        for level in levels() {
            let mut problem = start.clone();
            let mut memory = BlockMemory::default();
            let changes = pool.install(|| {
                let coloured = Coloured::<Full>::new(level, &mut problem, &mut memory);
                let mut coloured = coloured.expect("colours");
                assert_eq!(coloured.threads, threads > 1, "a colour is worth threads");
                let changes = [(); 8].map(|()| coloured.sweep::<true>());
                coloured.store();
                changes
            });
            assert!(bits(&problem) == bits(&one_by_one), "{level:?}, {threads} threads");
            for (change, expected) in changes.iter().zip(&expected) {
                assert!((change.squared / expected.squared - 1.0).abs() < 1e-12);
                assert!((change.absolute / expected.absolute - 1.0).abs() < 1e-12);
            }
            sums.push(changes.map(|sum| [sum.squared, sum.absolute].map(f64::to_bits)));
        }
    }
    assert!(sums.iter().all(|sum| *sum == sums[0]), "{sums:?}");
}

#[test]
fn rows_whose_colours_share_a_grain_are_swept_as_they_come() {
    type Full = StepModel<SpinningPlane, true, false>;
    let mut start = problem::<Full>(2, 40, 200);
    let [_, pair_ends] = &start.colour_ends;
    let second = pair_ends[0];
    start.pair_rows[second] = start.pair_rows[second - 1];
    start.pair_rows.swap(0, second);
    let (mut expected, mut solved) = (start.clone(), start);
    nsgs::solve::<Full>(&mut expected, &mut (), &sweeps(5));
    solve::<Full>(&mut solved, &mut BlockMemory::default(), &sweeps(5));
    assert!(bits(&solved) == bits(&expected));
}
