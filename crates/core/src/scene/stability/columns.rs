//! Scenes of discs on top of each other: columns, unequal masses and sizes, initial overlaps.

use glam::DVec2;

use super::{DIAMETER, GRAVITY, TOUCH, disc, half_space, on_floor, view};
use crate::scene::Scene;
use crate::world::{Disc, Grain, Gravity, Physics};

/// Returns the scene of a column of n discs with mass m under gravity g. The contact with the floor carries n·m·g, and
/// the k-th contact above it carries (n − k)·m·g.
///
/// Let P_k be the error of the impulse of contact k (k = 0 at the floor), N·s, while a solver iterates. An iteration of
/// Jacobi's method changes these errors to P_k ← (P_{k−1} + P_{k+1})/2, with P_{−1} = P_1 at the floor and P_n = 0 at
/// the top. The modes of the error are cos kθ with the angles θ for which cos nθ = 0. Each mode decays by the factor
/// cos θ per iteration, so the slowest mode decays by cos(π/2n). A chain has no loops, so every order of the contacts
/// is *consistent* (D. M. Young, 1971). For a consistent order a sweep of Gauss–Seidel is as good as two iterations of
/// Jacobi's method: the slowest mode decays by cos²(π/2n).
pub fn column(count: usize) -> Scene {
    let place = |k: usize| (0.5 + k as f64) * (1.0 - TOUCH) - 0.5 * TOUCH;
    on_floor("column", (0..count).map(|k| disc(0.0, place(k))).collect())
}

/// Returns the scene of [`column`](fn@column) turned onto the x axis, with gravity along this axis. It uses the smallest
/// mechanical model: one axis, without friction and rotation.
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

/// Returns the scene of a heavy disc on a light disc, which needs many sweeps. Let R = `ratio` be the mass of the heavy
/// disc divided by that of the light disc. Let W be the Delassus operator, the matrix that maps impulses to changes of
/// velocities, with the contacts 0 (light disc and floor) and 1 (both discs). Gauss–Seidel reduces the error of the
/// impulses by the factor W₀₁²/(W₀₀W₁₁) = R/(R + 1) per sweep, so the number of sweeps is proportional to R.
pub fn mass_ratio(ratio: f64) -> Scene {
    let radius = 0.5 * ratio.sqrt();
    let heavy =
        Grain::at_rest(DIAMETER * DVec2::new(0.0, 1.0 + radius - 2.0 * TOUCH), DIAMETER * radius);
    on_floor("mass-ratio", vec![disc(0.0, 0.5 - TOUCH), heavy])
}

/// Smallest coefficient of rolling friction, dimensionless, at which the column of [`leaning_column`] stays at rest.
pub const ROLLING_FRICTION_OF_COLUMN: f64 = 1.0;

/// Returns the scene of n discs on a fixed disc. All centres are on a line that leans from the vertical by the angle φ
/// with tan φ = 1/(2n). Without rolling friction the column rolls aside, at any friction coefficient.
///
/// Each disc has the weight w and the radius r. The contact below the k-th disc from the top carries k discs, so its
/// normal force is N = k w cos φ and its tangential force k w sin φ. The weight of these discs acts at their centre of
/// mass, which is at the distance k r from the contact along the inclined line, so the contact must transmit the moment
/// M = k² r w sin φ. Rolling friction with the coefficient μ_r transmits moments up to μ_r R N, with the reduced radius
/// R = r/2 of two equal discs. So the lowest contact, k = n, decides, and the column holds if
///
/// > μ_r ≥ 2n tan φ = 1.
pub fn leaning_column(count: usize) -> Scene {
    let along = DVec2::new(0.5 / count as f64, 1.0).normalize() * (1.0 - TOUCH);
    let place = |k: usize| DVec2::new(0.0, 0.5) + k as f64 * along;
    let grains = (1..=count).map(|k| disc(place(k).x, place(k).y)).collect();
    let mut scene = on_floor("leaning-column", grains);
    scene.fixed_discs = vec![Disc { position: DIAMETER * place(0), radius: 0.5 * DIAMETER }];
    let half = 0.5 * count as f64 + 1.0;
    scene.view = view(DVec2::new(-half, -0.5), DVec2::new(half, count as f64 + 1.5));
    scene
}

/// Number of discs in the column below the heavy disc of the scene [`lift_off`].
const BELOW: usize = 5;

/// Returns the scene of a column of five discs under a heavy disc, which is removed during the run. The heavy disc is
/// `ratio` times as heavy as the other discs and is the last grain. The solve of the first step after the removal
/// starts from the contact impulses that carried the heavy disc. In a correct step these impulses do not throw the
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

/// Returns the scene of a large disc on two small discs, as in a pile of logs. `ratio` is the ratio of the radii, R/r.
///
/// The two small discs of radius r touch each other, and the large disc has the radius R. The upper contacts are
/// inclined by θ to the vertical, with sin θ = r/(R + r). The two small discs need not push each other. Then three
/// forces act on a small disc: its weight, the force of the floor and the force of the large disc. The weight and the
/// force of the floor act along lines through the lowest point of the disc. So in equilibrium the force of the large
/// disc acts along the line from the upper contact to this point, which is inclined by θ/2 to the normal of the upper
/// contact. The upper contact does not slide if the friction coefficient is μ ≥ tan(θ/2). For R = r, θ is 30°, and the
/// condition is μ ≥ tan 15° = 2 − √3. The contacts with the floor need less friction.
pub fn logs(ratio: f64) -> Scene {
    let half = 0.5 * (1.0 - TOUCH);
    let reach = 0.5 * (1.0 + ratio) - TOUCH;
    let height = 0.5 - TOUCH + (reach * reach - half * half).sqrt();
    let large = Grain::at_rest(DIAMETER * DVec2::new(0.0, height), 0.5 * DIAMETER * ratio);
    let small = |x: f64| disc(x, 0.5 - TOUCH);
    on_floor("logs", vec![small(-half), small(half), large])
}

/// Returns the scene of two discs, one on top of the other, each of which overlaps the disc or floor below it by
/// `overlap` diameters. A correct solver separates the bodies without throwing the discs up.
pub fn overlapped(overlap: f64) -> Scene {
    on_floor("overlap", vec![disc(0.0, 0.5 - overlap), disc(0.0, 1.5 - 2.0 * overlap)])
}
