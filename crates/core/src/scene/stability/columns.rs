//! Discs on discs: columns, unequal masses and sizes, initial overlaps.

use glam::DVec2;

use super::{DIAMETER, GRAVITY, TOUCH, disc, half_space, on_floor};
use crate::scene::Scene;
use crate::world::{Grain, Gravity, Physics};

/// A column of n discs. The floor carries n·m·g, and the k-th contact carries n − k times m·g.
///
/// On the chain of contacts, Jacobi's iteration is P_k ← (P_{k−1} + P_{k+1})/2, with P_{−1} = P_1 at the floor and
/// P_n = 0 at the top. Its modes cos kθ require cos nθ = 0, so the slowest decays by cos(π/2n) per iteration. A chain
/// has no loops, so every order of the contacts is consistent (D. M. Young, 1971), and Gauss–Seidel decays by
/// cos²(π/2n) per sweep.
pub fn column(count: usize) -> Scene {
    let place = |k: usize| (0.5 + k as f64) * (1.0 - TOUCH) - 0.5 * TOUCH;
    on_floor("column", (0..count).map(|k| disc(0.0, place(k))).collect())
}

/// The same column lying along the x axis, with gravity along it: the smallest model.
pub fn column_on_line(count: usize) -> Scene {
    let mut scene = column(count);
    for grain in &mut scene.grains {
        grain.position = DVec2::new(grain.position.y, 0.0);
    }
    scene.mean_diameter = DIAMETER;
    scene.physics = Physics { axes: 1, friction: false, rotation: false, cohesion: true };
    scene.gravity = Gravity::Uniform { acceleration: DVec2::new(-GRAVITY, 0.0) };
    scene.boundaries = vec![half_space(DVec2::ZERO, DVec2::X)];
    scene
}

/// A heavy disc on a light one. With R the ratio of their masses, Gauss–Seidel on the two contacts reduces its error
/// by W₀₁²/(W₀₀W₁₁) = R/(R + 1) per sweep, so the number of sweeps is proportional to R.
pub fn mass_ratio(ratio: f64) -> Scene {
    let radius = 0.5 * ratio.sqrt();
    let heavy =
        Grain::at_rest(DIAMETER * DVec2::new(0.0, 1.0 + radius - 2.0 * TOUCH), DIAMETER * radius);
    on_floor("mass-ratio", vec![disc(0.0, 0.5 - TOUCH), heavy])
}

/// Discs below the heavy one.
const BELOW: usize = 5;

/// A column of five discs with a heavy disc on top, `ratio` times as heavy and last in the list, that is removed in
/// mid-run. The impulses that carried it are the starting point of the next step's iteration, and must not throw the
/// other discs up.
pub fn lift_off(ratio: f64) -> Scene {
    let mut scene = column(BELOW);
    scene.name = "lift-off".into();
    let heavy = &mass_ratio(ratio).grains[1];
    let top = BELOW as f64 * (1.0 - TOUCH) - 2.0 * TOUCH;
    let position = DVec2::new(0.0, DIAMETER * top + heavy.radius);
    scene.grains.push(Grain { position, ..heavy.clone() });
    scene
}

/// A large disc on two small ones, as logs are piled.
///
/// With the centres of the small discs (radius r) 2r apart and the large disc of radius R, the contacts lean by θ
/// from the vertical, sin θ = r/(R + r). The two forces on a small disc, from the floor and from the large disc, pass
/// through its two contact points and exert no torque. So the force from above is inclined by θ/2 to its contact's
/// normal, and the contact holds if μ ≥ tan(θ/2). For R = r, θ = 30°, this is μ ≥ tan 15° = 2 − √3. The floor needs
/// less.
pub fn logs(ratio: f64) -> Scene {
    let half = 0.5 * (1.0 - TOUCH);
    let reach = 0.5 * (1.0 + ratio) - TOUCH;
    let height = 0.5 - TOUCH + (reach * reach - half * half).sqrt();
    let large = Grain::at_rest(DIAMETER * DVec2::new(0.0, height), 0.5 * DIAMETER * ratio);
    let small = |x: f64| disc(x, 0.5 - TOUCH);
    on_floor("logs", vec![small(-half), small(half), large])
}

/// Two discs, each overlapping the body below by `overlap` diameters. A correct solver separates them without
/// throwing them.
pub fn overlapped(overlap: f64) -> Scene {
    on_floor("overlap", vec![disc(0.0, 0.5 - overlap), disc(0.0, 1.5 - 2.0 * overlap)])
}
