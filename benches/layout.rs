//! Array of structures, as the sweep has it, against structure of arrays: the same arithmetic in the
//! same order, checked to give the same bits before it is timed.

mod common;

use std::hint::black_box;

use common::timing::{criterion, least_secs};
use slump::solver::{PlaneBody, SolverSettings, SpinningPlane, StepModel, StepProblem, sweep};

type Full = StepModel<SpinningPlane, true>;

/// The rows of one kind, one list a field.
#[derive(Clone, Default)]
struct Rows {
    i: Vec<u32>,
    j: Vec<u32>,
    nx: Vec<f64>,
    ny: Vec<f64>,
    share: Vec<f64>,
    restitution: Vec<f64>,
    shifted: Vec<f64>,
    tangential: Vec<f64>,
}

/// A step problem as structure of arrays, bodies included.
#[derive(Clone, Default)]
struct Lists {
    x: Vec<f64>,
    y: Vec<f64>,
    spin: Vec<f64>,
    fixed: Rows,
    pairs: Rows,
    friction: f64,
}

impl Lists {
    fn of(problem: &StepProblem<SpinningPlane>) -> Self {
        let mut lists = Self { friction: problem.law.friction, ..Self::default() };
        for body in &problem.bodies.now {
            lists.x.push(body.velocity[0]);
            lists.y.push(body.velocity[1]);
            lists.spin.push(body.spin);
        }
        let fixed = problem.rows.fixed.iter().map(|row| (&row.row, 1.0));
        let pairs = problem.rows.pairs.iter().map(|row| (&row.row, row.share));
        let sources: [Vec<_>; 2] = [fixed.collect(), pairs.collect()];
        for (rows, source) in [&mut lists.fixed, &mut lists.pairs].into_iter().zip(sources) {
            for (row, share) in source {
                rows.i.push(row.i);
                rows.j.push(row.j);
                rows.nx.push(row.normal[0]);
                rows.ny.push(row.normal[1]);
                rows.share.push(share);
                rows.restitution.push(row.restitution_velocity);
                rows.shifted.push(row.shifted_impulse);
                rows.tangential.push(row.tangential_impulse);
            }
        }
        lists
    }

    fn sweep(&mut self) {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx") {
            // SAFETY: the processor has just been asked.
            return unsafe { self.sweep_with_avx() };
        }
        self.pass();
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx")]
    fn sweep_with_avx(&mut self) {
        self.pass();
    }

    #[inline(always)]
    fn pass(&mut self) {
        let (x, y, s) = (&mut self.x[..], &mut self.y[..], &mut self.spin[..]);
        let Rows { i, nx, ny, restitution, shifted, tangential, .. } = &mut self.fixed;
        let impulses = shifted.iter_mut().zip(tangential);
        let rows = i.iter().zip(nx).zip(ny).zip(restitution).zip(impulses);
        for ((((&i, &mut nx), &mut ny), &mut restitution), (shifted, tangential)) in rows {
            let i = i as usize;
            let v_n = nx * x[i] + ny * y[i];
            let v_t = nx * y[i] - ny * x[i] - s[i];
            let [dn, dt] = update(self.friction, v_n + restitution, v_t, shifted, tangential);
            x[i] += nx * dn - ny * dt;
            y[i] += ny * dn + nx * dt;
            s[i] -= dt + dt;
        }
        let Rows { i, j, nx, ny, share, restitution, shifted, tangential } = &mut self.pairs;
        let impulses = shifted.iter_mut().zip(tangential);
        let ends = i.iter().zip(j).zip(share);
        let rows = ends.zip(nx).zip(ny).zip(restitution).zip(impulses);
        for ((((ends, &mut nx), &mut ny), &mut restitution), impulses) in rows {
            let ((&i, &mut j), &mut share) = ends;
            let (shifted, tangential) = impulses;
            let (i, j) = (i as usize, j as usize);
            let (dx, dy) = (x[i] - x[j], y[i] - y[j]);
            let v_n = nx * dx + ny * dy;
            let v_t = nx * dy - ny * dx - (s[i] + s[j]);
            let [dn, dt] = update(self.friction, v_n + restitution, v_t, shifted, tangential);
            let (px, py, turn) = (nx * dn - ny * dt, ny * dn + nx * dt, dt + dt);
            let other = 1.0 - share;
            x[i] += share * px;
            y[i] += share * py;
            s[i] -= share * turn;
            x[j] -= other * px;
            y[j] -= other * py;
            s[j] -= other * turn;
        }
    }
}

#[inline(always)]
fn update(
    friction: f64,
    closing: f64,
    v_t: f64,
    shifted: &mut f64,
    tangential: &mut f64,
) -> [f64; 2] {
    let before = [*shifted, *tangential];
    let pressed = before[0] - closing;
    *shifted = if pressed > 0.0 { pressed } else { 0.0 };
    let bound = friction * *shifted;
    let stuck = before[1] - 1.0 / 3.0 * v_t;
    let above = if stuck > -bound { stuck } else { -bound };
    *tangential = if above < bound { above } else { bound };
    [*shifted - before[0], *tangential - before[1]]
}

fn main() {
    let mut criterion = criterion();
    let mut summary = Vec::new();
    for count in [138, 2_000, 10_000] {
        let mut simulation = common::with(&common::settled(count), |numbers| numbers.bond = 20.0);
        simulation.step().expect("a finite state");
        let cold = SolverSettings { warm_start: false, ..SolverSettings::default() };
        let mut structures = common::problem(&simulation, &cold);
        let mut lists = Lists::of(&structures);
        for _ in 0..20 {
            sweep::<Full, false>(&mut structures);
            lists.sweep();
        }
        for (k, PlaneBody { velocity, spin }) in structures.bodies.now.iter().enumerate() {
            assert_eq!([*velocity, [*spin, 0.0]], [[lists.x[k], lists.y[k]], [lists.spin[k], 0.0]]);
        }
        let updates = structures.rows.len() as f64;
        let of_structures = least_secs(&mut criterion, &format!("structures/{count}"), || {
            black_box(sweep::<Full, false>(&mut structures));
        });
        let of_lists = least_secs(&mut criterion, &format!("lists/{count}"), || {
            black_box(&mut lists).sweep();
        });
        summary.push(format!(
            "{count} discs: array of structures {:.2} ns an update, structure of arrays {:.2}: \
             {:.2} times as long",
            1e9 * of_structures / updates,
            1e9 * of_lists / updates,
            of_lists / of_structures
        ));
    }
    println!("\nleast over all repeats:\n{}", summary.join("\n"));
    criterion.final_summary();
}
