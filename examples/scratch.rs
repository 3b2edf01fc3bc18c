use slump::scene::*;
use std::time::Instant;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    match args[1].as_str() {
        "gen" => {
            let t = Instant::now();
            let rain = Rain {
                seed: args[2].parse().unwrap(),
                grains: args[3].parse().unwrap(),
                box_width_in_diameters: args[4].parse().unwrap(),
            };
            let mut k = 0;
            let g = settle(&rain, |s| {
                k += 1;
                if k % 100 == 0 {
                    eprintln!("{s:?}");
                }
                true
            })
            .unwrap();
            std::fs::write(&args[5], write_discs(&g, "test")).unwrap();
            let sc = pile_of(g, rain.box_width_in_diameters);
            let sim = sc.simulation().unwrap();
            eprintln!("{:?} in {:?}", sim.observables(), t.elapsed());
        }
        "pile" => {
            let g = read_discs(args[2].as_ref()).unwrap();
            let tol: f64 = args[3].parse().unwrap();
            for bond in [0., 20., 50., 100.] {
                for dt in [5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4] {
                    let mut sc = pile_of(g.clone(), 16.);
                    sc.parameters.bond = bond;
                    sc.parameters.time_step_secs = dt;
                    sc.solver.tolerance = tol;
                    let mut sim = sc.simulation().unwrap();
                    let t = Instant::now();
                    let mut sweeps = 0u64;
                    let mut bad = 0;
                    let mut upd = 0u64;
                    let mut ov = 0.0;
                    let n = (1.0 / dt as f64).round() as u64;
                    for _ in 0..n {
                        let o = sim.step().unwrap();
                        sweeps += o.sweeps as u64;
                        upd += o.sweeps as u64 * o.contacts as u64;
                        if !o.converged {
                            bad += 1;
                        }
                        ov += o.mean_overlap / n as f64;
                    }
                    let e = t.elapsed().as_secs_f64();
                    println!(
                        "B {bond} dt {dt:e} slump {:.3} overlap {:.2e} sweeps/step {:.0} bad {bad}/{n} {:.2}s {:.2} ns/upd res {:.1e}",
                        sim.observables().slump,
                        ov,
                        sweeps as f64 / n as f64,
                        e,
                        e * 1e9 / upd as f64,
                        sim.observables().residual
                    );
                }
            }
        }
        "cradle" => {
            for dt in [
                1e-4, 2e-4, 3e-4, 4e-4, 5e-4, 6e-4, 7e-4, 8e-4, 9e-4, 1e-3, 2e-3, 3e-3, 4e-3, 5e-3,
                6e-3, 7e-3, 8e-3, 9e-3, 1e-2,
            ] {
                let mut sc = cradle();
                sc.parameters.time_step_secs = dt;
                let mut sim = sc.simulation().unwrap();
                for _ in 0..(2.5 / dt as f64).round() as u64 {
                    sim.step().unwrap();
                }
                let p = &sim.world().grains.positions;
                println!("{dt:e} {:.3e}", (p[1].x - p[0].x - 0.3) / 0.3);
            }
        }
        "row" => {
            let tol: f64 = args[3].parse().unwrap();
            let ms: u32 = args[4].parse().unwrap();
            for f in args[2].split(',') {
                let g = read_discs(f.as_ref()).unwrap();
                for bond in [20., 100., 50.] {
                    print!("{f} B {bond}: ");
                    let t = Instant::now();
                    for dt in [1e-4, 1e-3, 2e-3, 5e-3] {
                        let mut sc = pile_of(g.clone(), 16.);
                        sc.parameters.bond = bond;
                        sc.parameters.time_step_secs = dt;
                        sc.solver.tolerance = tol;
                        sc.solver.max_sweeps = ms;
                        let mut sim = sc.simulation().unwrap();
                        let mut bad = 0;
                        let n = (1.0 / dt as f64).round() as u64;
                        for _ in 0..n {
                            sim.step().unwrap();
                        }
                        print!("{:.3} ", sim.observables().slump);
                    }
                    println!("  {:.1}s", t.elapsed().as_secs_f64());
                }
            }
        }
        _ => {}
    }
}
