//! Errors and times of sweeps on single steps of flowing piles, as JSON: plain and over-relaxed sweeps, sweeps with
//! Nesterov's extrapolation, conjugate gradients, and the part of the error that coarse cells of grains could correct.
//!
//! cargo run --release --example large_piles 500:0:50,150 2000:0:60,150 > large-piles.json
//!
//! Each argument has a number of grains, a Bond number, and steps (Δt = 1e-3 s) of the collapse. The reported `time` is
//! that of the sweeps alone, relative to 40 plain sweeps.

use std::collections::HashMap;
use std::time::Instant;

use slump::contact::ContactList;
use slump::error::Result;
use slump::scene::{Deposition, NewPile, pile_of, settle};
use slump::sim::ProblemVisitor;
use slump::solver::{
    BodySystem, ContactSystem, Memory, Method, Model, PairRow, Row, SolutionSearch, SolverSettings,
    StepProblem, StopTest, distance_to_velocities, solve, velocities, velocity_error,
};

/// Numbers of sweeps after which errors are measured.
const SWEEPS: [u32; 5] = [40, 80, 160, 320, 640];
/// Side of a coarse cell, in mean diameters.
const CELL: f64 = 5.0;
/// Times are minima of this many repeats of 40 sweeps.
const REPEATS: usize = 15;
/// The solutions from which errors are measured.
const SEARCH: SolutionSearch =
    SolutionSearch { starts: 4, seed: 1, max_sweeps: 20_000, tolerance: 1e-12 };

/// Ways to make sweeps.
#[derive(Clone, Copy)]
enum Way {
    /// Over-relaxed with factors for normal and tangential updates; 1 is plain. Without the last quarter, which is
    /// plain, if `then_plain` is set.
    Relaxed { factors: [f64; 2], then_plain: bool },
    /// s_k = G(y_k), y_{k+1} = s_k + β (s_k − s_{k−1}) with Nesterov's β, which restarts if the sweep G(y_k) − y_k goes
    /// against s_{k−1} − s_{k−2}. The extrapolation is not optimised.
    Nesterov,
    /// Alternately from the first contact to the last and back.
    Symmetric,
}

const WAYS: [(&str, Way); 6] = [
    ("plain", Way::Relaxed { factors: [1.0; 2], then_plain: false }),
    ("over-relaxed 1.6", Way::Relaxed { factors: [1.6; 2], then_plain: false }),
    ("over-relaxed 1.6, then plain", Way::Relaxed { factors: [1.6; 2], then_plain: true }),
    ("over-relaxed 1.8, then plain", Way::Relaxed { factors: [1.8; 2], then_plain: true }),
    ("Nesterov", Way::Nesterov),
    ("symmetric", Way::Symmetric),
];

/// Updates one contact with relaxed steps. Returns the change of (σ, λ_t).
fn update<M: Model>(row: &mut Row<M>, friction: f64, velocity: [f64; 2], w: [f64; 2]) -> [f64; 2] {
    let before = row.impulse();
    let normal = before[0] - w[0] * (velocity[0] + row.restitution_velocity);
    let tangential = before[1] - w[1] * velocity[1] / M::TANGENTIAL_COMPLIANCE;
    row.shifted_impulse = normal.max(0.0);
    let bound = friction * row.shifted_impulse;
    row.tangential_impulse = tangential.clamp(-bound, bound);
    [row.shifted_impulse - before[0], row.tangential_impulse - before[1]]
}

/// One sweep in the shifted cone.
fn sweep<M: Model>(problem: &mut StepProblem<M>, w: [f64; 2], backward: bool) {
    let friction = problem.law.friction;
    let StepProblem { bodies, rows, .. } = problem;
    let now = &mut bodies.now[..];
    let pair = |row: &mut PairRow<M>, now: &mut [M::Body<f64>]| {
        let (mut i, mut j) = (now[row.i as usize], now[row.j as usize]);
        let velocity = M::relative_velocity(row.normal, &i, &j);
        let change = update(&mut row.row, friction, velocity, w);
        M::push_pair(&mut i, &mut j, row.normal, change, row.share);
        (now[row.i as usize], now[row.j as usize]) = (i, j);
    };
    if backward {
        rows.pairs.iter_mut().rev().for_each(|row| pair(row, now));
    }
    for row in &mut rows.fixed {
        let velocity = row.velocity(now);
        let change = update(&mut row.row, friction, velocity, w);
        M::push_single(&mut now[row.i as usize], row.normal, change);
    }
    if !backward {
        rows.pairs.iter_mut().for_each(|row| pair(row, now));
    }
}

/// Makes this many sweeps.
fn sweep_by<M: Model>(problem: &mut StepProblem<M>, way: Way, sweeps: u32) {
    // Impulses before a sweep and after it, and those after the last sweep and the one before that.
    let [mut start, mut swept, mut last, mut earlier] = [(); 4].map(|()| Vec::new());
    let mut theta: f64 = 1.0;
    for number in 0..sweeps {
        match way {
            Way::Relaxed { then_plain: true, .. } if number >= sweeps - sweeps / 4 => {
                sweep(problem, [1.0; 2], false);
            }
            Way::Relaxed { factors, .. } => sweep(problem, factors, false),
            Way::Symmetric => sweep(problem, [1.0; 2], number % 2 == 1),
            Way::Nesterov => {
                let mut system = BodySystem::new(problem);
                system.read(&mut start);
                system.sweep();
                system.read(&mut swept);
                if number > 1 && number + 1 < sweeps {
                    let change = swept.iter().flatten().zip(start.iter().flatten());
                    let momentum = last.iter().flatten().zip(earlier.iter().flatten());
                    let product: f64 =
                        change.zip(momentum).map(|((g, y), (l, e))| (g - y) * (l - e)).sum();
                    let next = 0.5 * (1.0 + (1.0 + 4.0 * theta * theta).sqrt());
                    let factor = if product < 0.0 { 0.0 } else { (theta - 1.0) / next };
                    theta = if product < 0.0 { 1.0 } else { next };
                    let ahead = |(g, l): (&[f64; 2], &[f64; 2])| {
                        [0, 1].map(|k| g[k] + factor * (g[k] - l[k]))
                    };
                    let ahead: Vec<_> = swept.iter().zip(&last).map(ahead).collect();
                    system.write(&ahead);
                }
                std::mem::swap(&mut earlier, &mut last);
                std::mem::swap(&mut last, &mut swept);
            }
        }
    }
    problem.form_velocities();
}

/// Measures one step.
struct Measured {
    label: String,
    positions: Vec<[f64; 2]>,
    diameter: f64,
}

impl ProblemVisitor for Measured {
    type Output = String;

    fn visit<M: Model>(self, problem: &mut StepProblem<M>, _: &ContactList) -> String {
        let solutions = SEARCH.find(problem);
        let unit = velocity_error(problem).scale;
        let known: Vec<_> = solutions.iter().map(|one| velocities(&one.problem)).collect();
        let spread = solutions.iter().map(|one| {
            known.iter().map(|v| distance_to_velocities(&one.problem, v)).fold(0.0, f64::max)
        });
        let told = solutions.iter().map(|one| one.velocity_error).fold(0.0, f64::max) / unit;
        let least_secs = |work: &dyn Fn(&mut StepProblem<M>)| {
            let mut least = f64::INFINITY;
            for _ in 0..REPEATS {
                let mut copy = problem.clone();
                let started = Instant::now();
                work(&mut copy);
                least = least.min(started.elapsed().as_secs_f64());
            }
            least
        };
        let by = |method: Method, max_sweeps: u32| SolverSettings {
            method,
            max_sweeps,
            stop: StopTest::RelativeChange,
            tolerance: 1e-15,
            ..SolverSettings::default()
        };
        let by_method = |method: Method, copy: &mut StepProblem<M>, sweeps: u32| {
            solve(copy, &mut Memory::default(), &by(method, sweeps));
        };
        let unit_secs = least_secs(&|copy| by_method(Method::Nsgs, copy, 40));
        let mut lines = Vec::new();
        let mut add = |name: &str, work: &dyn Fn(&mut StepProblem<M>, u32)| {
            let ratio = least_secs(&|copy| work(copy, 40)) / unit_secs / 40.0;
            for sweeps in SWEEPS {
                let mut copy = problem.clone();
                work(&mut copy, sweeps);
                let to = |v: &&Vec<[f64; 3]>| distance_to_velocities(&copy, v);
                let nearest = known.iter().min_by(|a, b| to(a).total_cmp(&to(b)));
                let [error, coarse] = nearest.map_or([f64::NAN; 2], |nearest| {
                    [to(&nearest) / unit, self.rigid_part(&copy, nearest)]
                });
                let time = ratio * f64::from(sweeps);
                let numbers =
                    format!(r#""time": {time:.2}, "error": {error:.2e}, "coarse": {coarse:.2}"#);
                lines.push(format!(r#"    {{"way": "{name}", "sweeps": {sweeps}, {numbers}}}"#));
            }
        };
        for (name, way) in WAYS {
            add(name, &|copy, sweeps| sweep_by(copy, way, sweeps));
        }
        add("nncg", &|copy, sweeps| by_method(Method::Nncg, copy, sweeps));
        let spread = spread.fold(0.0, f64::max) / unit;
        let (label, contacts, found) = (&self.label, problem.rows.len(), known.len());
        let of_step = format!(r#""step": "{label}", "contacts": {contacts}, "solutions": {found}"#);
        let of_solutions = format!(r#""spread": {spread:.1e}, "known_to": {told:.1e}"#);
        let unit_ms = 1e3 * unit_secs;
        let lines = lines.join(",\n");
        format!(
            "  {{{of_step},\n   {of_solutions}, \"ms_of_40_sweeps\": {unit_ms:.3}, \"solves\": [\n{lines}\n  ]}}"
        )
    }
}

impl Measured {
    /// The part of the squared error (spins included) that rigid motions of square cells make up.
    fn rigid_part<M: Model>(&self, problem: &StepProblem<M>, solution: &[[f64; 3]]) -> f64 {
        let masses = &problem.bodies.masses;
        let errors: Vec<[f64; 3]> = velocities(problem)
            .iter()
            .zip(solution)
            .map(|(one, other)| [0, 1, 2].map(|axis| one[axis] - other[axis]))
            .collect();
        let side = CELL * self.diameter;
        let mut cells: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
        for (grain, place) in self.positions.iter().enumerate() {
            cells.entry(place.map(|x| (x / side).floor() as i64)).or_default().push(grain);
        }
        let rigid = cells.values().map(|grains| {
            let sum = |of: &dyn Fn(usize) -> f64| -> f64 {
                grains.iter().map(|&grain| masses[grain] * of(grain)).sum()
            };
            let mass = sum(&|_| 1.0);
            let centre = [0, 1].map(|axis| sum(&|grain| self.positions[grain][axis]) / mass);
            let from = |grain: usize| [0, 1].map(|axis| self.positions[grain][axis] - centre[axis]);
            let momentum = [0, 1].map(|axis| sum(&|grain| errors[grain][axis]));
            let turning = sum(&|grain| {
                let [x, y] = from(grain);
                x * errors[grain][1] - y * errors[grain][0]
            });
            let inertia = sum(&|grain| from(grain).iter().map(|x| x * x).sum());
            let turned = if inertia > 0.0 { turning * turning / inertia } else { 0.0 };
            (momentum[0] * momentum[0] + momentum[1] * momentum[1]) / mass + turned
        });
        let squares = errors.iter().zip(masses).map(|(error, mass)| {
            mass * (0..M::DEGREES)
                .map(|k| M::INERTIA_OVER_MASS[k] * error[k] * error[k])
                .sum::<f64>()
        });
        rigid.sum::<f64>() / squares.sum::<f64>()
    }
}

/// Measures the steps of one argument.
fn measured(argument: &str) -> Result<Vec<String>> {
    let mut fields = argument.split(':');
    let mut field = || fields.next().unwrap_or_default();
    let grains: usize = field().parse().unwrap_or(500);
    let bond: f64 = field().parse().unwrap_or(0.0);
    let steps: Vec<u64> = field().split(',').filter_map(|step| step.parse().ok()).collect();
    let width = (1.35 * (grains as f64).sqrt()).round();
    let deposition = Deposition::DropAndRoll;
    let pile = NewPile {
        grains,
        box_width_in_diameters: width,
        seed: 1,
        deposition,
        ..NewPile::default()
    };
    let mut scene = pile_of(settle(&pile, |_| true)?, width)?;
    scene.parameters.bond = bond;
    scene.parameters.time_step_secs = 1e-3;
    let diameter = scene.mean_diameter;
    let mut simulation = scene.simulation()?;
    let mut all = Vec::new();
    for step in steps {
        while simulation.observables().step < step {
            simulation.step()?;
        }
        // Sweeps in the default order.
        let mut at = simulation.clone();
        at.set_solver(SolverSettings { method: Method::Nsgs, ..*simulation.solver() })?;
        let positions = at.world().grains.positions.iter().map(|place| place.to_array()).collect();
        let label = format!("{grains} grains, Bond {bond}, step {step}");
        all.push(at.next_problem(Measured { label, positions, diameter }));
    }
    Ok(all)
}

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let all: Result<Vec<Vec<String>>> = arguments.iter().map(|one| measured(one)).collect();
    let command = "cargo run --release --example large_piles";
    let arguments = arguments.join(" ");
    println!(
        "{{\"command\": \"{command} {arguments}\", \"steps\": [\n{}\n]}}",
        all?.concat().join(",\n")
    );
    Ok(())
}
