//! Three discs as a semicircular arch between two fixed ones: the centres of all five lie on half a
//! circle, an eighth of a turn apart.
//!
//! A contact whose normal, from the lower disc to the higher, rises at the angle φ carries N along it
//! and T across it, so the force up the arch is H = N cos φ − T sin φ, V = N sin φ + T cos φ. With w the
//! weight of a disc, half the keystone hangs on each crown contact (V = w/2, φ = β), and the spring
//! contact below carries a disc more (V = 3w/2, φ = α) at the same thrust H, so that
//!
//! > T_β = (w/2) cos β − H sin β,  T_α = (3w/2) cos α − H sin α.
//!
//! No torque on the disc between them asks for T_α = −T_β, which gives
//!
//! > H = (w/2) (cos β + 3 cos α)/(sin α + sin β),
//! > T_β = (w/2) (sin α cos β − 3 cos α sin β)/(sin α + sin β).
//!
//! T vanishes where tan α = 3 tan β, on the funicular. On the semicircle β = 22.5° and α = 67.5°; with
//! c = cos β = sin α and s = sin β = cos α, 4cs = √2 and c² − 3s² = √2 − 1, the crown contacts have
//!
//! > T/N = (c² − 3s²)/(1 + 4cs) = (√2 − 1)/(√2 + 1) = 3 − 2√2.
//!
//! The spring contacts need (√2 − 1)/(3 + √2), about half of it. Below μ = 3 − 2√2 the keystone slips
//! through.
//!
//! The balance is one of discs that can roll, and so unstable at any friction: left alone, rounding and
//! what the solver leaves grow until the arch rolls aside, after about 0.7 s. What is measured is over
//! long before.

use std::f64::consts::{FRAC_PI_4, FRAC_PI_8, SQRT_2};

use glam::DVec2;

use super::{DIAMETER, TOUCH, disc, dry};
use crate::scene::{Scene, View};
use crate::world::{Boundary, Disc};

/// The least friction that holds the arch.
pub const FRICTION_OF_ARCH: f64 = 3.0 - 2.0 * SQRT_2;

/// Depth of the ground that a fallen arch lies on, below the fixed discs' centres, in diameters.
const GROUND: f64 = 0.5;

/// The arch; the keystone is the second of its discs.
pub fn arch() -> Scene {
    let radius = 0.5 * (1.0 - TOUCH) / FRAC_PI_8.sin();
    let place = |eighth: u8| radius * DVec2::from_angle(f64::from(eighth) * FRAC_PI_4);
    let stones = [1, 2, 3].map(place).map(|centre| disc(centre.x, centre.y));
    let mut scene = dry("arch", stones.into());
    let abutment = |eighth: u8| Disc { position: DIAMETER * place(eighth), radius: 0.5 * DIAMETER };
    scene.fixed_discs = vec![abutment(0), abutment(4)];
    scene.boundaries =
        vec![Boundary::HalfSpace { point: DIAMETER * DVec2::new(0.0, -GROUND), normal: DVec2::Y }];
    scene.view =
        Some(View { min: DIAMETER * DVec2::new(-3.0, -1.0), max: DIAMETER * DVec2::new(3.0, 2.5) });
    scene
}
