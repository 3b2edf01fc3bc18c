use slump::scene::*;
use slump::sim::Tally;
use slump::world::ContactLaw;
fn list(t: &str) -> Vec<f64> {
    t.split(',').map(|x| x.parse().unwrap()).collect()
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let (bonds, dts, seeds) = (list(&a[1]), list(&a[2]), list(&a[3]));
    let law = if a.get(4).map(|s| s == "moreau").unwrap_or(false) {
        ContactLaw::Moreau
    } else {
        ContactLaw::Range
    };
    for &bond in &bonds {
        for &dt in &dts {
            let mut s = vec![];
            let mut cpu = 0.0;
            let mut tal = vec![];
            for seed in seeds[0] as u64..=seeds[1] as u64 {
                let path = format!("/tmp/rs/states/pile_138_width16_seed{seed}_v0.1.0.csv");
                let grains = read_discs(path.as_ref()).unwrap();
                let text = format!(
                    "scene='pile'\nsolver='{}'\nstop='residual'\ntolerance=1e-6\nrestitution-threshold=2.0\nduration=1.0\nseed={seed}\nbond={bond:?}\ndt={dt:?}",
                    std::env::var("SOLVER").unwrap_or("newton".into())
                );
                let config: Config = toml::from_str(&text).unwrap();
                let config = Config { law: Some(law), ..config };
                let scene = config.scene_from(grains).unwrap();
                let mut sim = scene.simulation().unwrap();
                let t0 = std::time::Instant::now();
                let mut tally = Tally::default();
                let mut bw = 0.0;
                let mut tries = 0.0;
                let mut pushes = 0.0;
                for _ in 0..(1.0 / dt).round() as u64 {
                    let o = sim.step().unwrap();
                    tally.add(o);
                    bw += o.bond_work.unwrap_or(0.0);
                    let w = o.normal_work - o.bond_work.unwrap_or(0.0);
                    if w > 0.0 {
                        tries += w;
                    } else {
                        pushes += w;
                    }
                }
                if std::env::var("BW").is_ok() {
                    eprintln!("raised {tries:.3e} lost {pushes:.3e}");
                }
                cpu += t0.elapsed().as_secs_f64();
                if std::env::var("BW").is_ok() {
                    let o = sim.observables();
                    eprintln!(
                        "bond work {bw:.3e} stored {:?} broken {:?} off {:.3}",
                        o.bond_energy,
                        o.broken_bond_energy,
                        (bw + o.bond_energy.unwrap_or(0.0) + o.broken_bond_energy.unwrap_or(0.0))
                            / o.broken_bond_energy.unwrap_or(1.0)
                    );
                }
                s.push(sim.observables().slump);
                tal.push(tally);
            }
            let n = s.len() as f64;
            let m = s.iter().sum::<f64>() / n;
            let sd = (s.iter().map(|x| (x - m).powi(2)).sum::<f64>() / (n - 1.0).max(1.0)).sqrt();
            let steps: u64 = tal.iter().map(|t| t.steps).sum();
            println!(
                "{law:?} B {bond:3} dt {dt:.0e} n {n:2} slump {m:.3} se {:.3} | ovl {:.1e} unconv {:.3} maxres {:.0e} sweeps/step {:.0} wall/s {:.2} | {}",
                sd / n.sqrt(),
                tal.iter().map(|t| t.mean_overlap).fold(0.0, f64::max),
                tal.iter().map(|t| t.unconverged_steps).sum::<u64>() as f64 / steps as f64,
                tal.iter().map(|t| t.largest_residual).fold(0.0, f64::max),
                tal.iter().map(|t| t.sweeps).sum::<u64>() as f64 / steps as f64,
                cpu / n,
                s.iter().map(|x| format!("{x:.3}")).collect::<Vec<_>>().join(" ")
            );
        }
    }
}
