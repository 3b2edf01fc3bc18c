#[path = "../benches/common/mod.rs"]
mod common;
use slump::solver::*;
use std::time::Instant;
fn main() {
    for n in [138, 2000, 10000] {
        let t = Instant::now();
        let s = common::settled(n);
        let s = common::with(&s, |p| p.bond = 20.0);
        let mut sim = s.clone();
        sim.step().unwrap();
        println!(
            "{n} built {:?} contacts {} {:?}",
            t.elapsed(),
            sim.contacts().contacts().len(),
            sim.observables().mean_overlap
        );
        let mut p = StepProblem::<SpinningPlane>::default();
        p.prepare::<StepModel<SpinningPlane, true, false>>(
            sim.world(),
            sim.contacts(),
            sim.parameters(),
            true,
            true,
        );
        let c = p.contact_of_row.len();
        let reps = (4_000_000 / c).max(3);
        let mut best = f64::MAX;
        let mut bestm = f64::MAX;
        for _ in 0..9 {
            let t = Instant::now();
            for _ in 0..reps {
                sweep::<StepModel<SpinningPlane, true, false>, false>(&mut p);
            }
            best = best.min(t.elapsed().as_secs_f64() * 1e9 / (reps * c) as f64);
            let t = Instant::now();
            for _ in 0..reps {
                sweep::<StepModel<SpinningPlane, true, false>, true>(&mut p);
            }
            bestm = bestm.min(t.elapsed().as_secs_f64() * 1e9 / (reps * c) as f64);
        }
        println!("{best:.2} ns per update, measured sweep {bestm:.2}");
    }
}
