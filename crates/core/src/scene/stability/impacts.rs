//! Discs that collide, bounce and slide.

use glam::DVec2;

use crate::scene::Scene;
use crate::scene::stability::{DIAMETER, GRAVITY, TOUCH, disc, dry, mass_ratio, on_floor, view};
use crate::world::{Boundary, Gravity, Physics};

/// Height of the fall, in diameters.
const DROP: f64 = 5.0;

/// A disc dropped on the floor. It rises to ρ² of its height. For ρ < 1 it is at rest after infinitely many bounces,
/// at √(2h/g)·(1 + ρ)/(1 − ρ).
pub fn bounce(restitution: f64) -> Scene {
    let mut scene = on_floor("bounce", vec![disc(0.0, DROP + 0.5)]);
    scene.parameters.restitution = restitution;
    scene.view = view(DVec2::new(-4.5, -0.5), DVec2::new(4.5, DROP + 1.5));
    scene.duration_secs = 10.0 * (2.0 * DROP * DIAMETER / GRAVITY).sqrt();
    scene
}

/// Speed of the first ball, in √(g d).
const BALL_SPEED: f64 = 3.0;

/// Newton's cradle, without gravity: one ball hits a row of `count` − 1 touching balls at rest. At ρ = 1 the last
/// ball flies off with the full speed, which no law that solves all impacts of a step together predicts.
pub fn balls(count: usize) -> Scene {
    let mut grains: Vec<_> = (0..count).map(|k| disc(k as f64 * (1.0 - TOUCH), 0.0)).collect();
    grains[0].position.x -= DIAMETER;
    grains[0].velocity.x = BALL_SPEED * (GRAVITY * DIAMETER).sqrt();
    let mut scene = dry("newtons-cradle", grains);
    scene.physics = Physics { axes: 1, friction: false, rotation: false, cohesion: false };
    scene.gravity = Gravity::Uniform { acceleration: DVec2::ZERO };
    scene.parameters.restitution = 1.0;
    let width = count as f64 + 6.0;
    // A little later the last ball leaves the view.
    scene.duration_secs = (count as f64 + 1.0) / BALL_SPEED * (DIAMETER / GRAVITY).sqrt();
    scene.view = view(DVec2::new(-2.5, -2.0), DVec2::new(width, 2.0));
    scene
}

/// Mass of the falling disc, relative to the sliding one.
const RATIO: f64 = 9.0;
/// Speeds of both along the floor, and of the fall, in √(g d).
const SLIDING: f64 = 6.0;
const FALLING: f64 = 2.0;
/// Height of the fall, in d. The steps before the blow are solved with the lower disc alone, at every Δt.
const HEIGHT: f64 = 0.05;

/// A disc slides along the floor, and a heavy disc beside it in the air hits it from above. Neither turns, and there
/// is no gravity: the floor pushes only during the blow.
///
/// The floor's friction acts on the whole normal impulse of the blow. With M the total mass and p_y < 0 the momentum
/// of the fall, both discs move horizontally after the blow, and momentum balance gives
///
/// > M v_x = M v₀ − μ|p_y|,
///
/// whatever happens between the two discs. Because the lower disc has the mass M/10, a fraction of 0.9 μ of the blow,
/// which is less than μ, makes both move together. `tresca` bounds the friction of this step by the floor's impulse
/// before it, which is zero, and that of the next step by the blow: the speed is right one step late, and both discs
/// move Δt μ|p_y|/M too far. A second solve of the step knows the blow, because the floor's normal impulse does not
/// depend on friction here.
pub fn blow() -> Scene {
    let mut scene = mass_ratio(RATIO);
    scene.name = "blow".into();
    scene.physics.rotation = false;
    scene.gravity = Gravity::Uniform { acceleration: DVec2::ZERO };
    let scale = (GRAVITY * DIAMETER).sqrt();
    for grain in &mut scene.grains {
        grain.velocity.x = SLIDING * scale;
    }
    let falling = &mut scene.grains[1];
    falling.position.y += HEIGHT * DIAMETER;
    falling.velocity.y = -FALLING * scale;
    scene.view = view(DVec2::new(-2.5, -0.5), DVec2::new(20.5, 13.5));
    scene
}

/// Speed at the start, in √(g d).
const SLIDING_SPEED: f64 = 3.0;

/// A disc that slides on the floor and does not turn. It must keep its height, and stop.
///
/// A step reduces the speed v₀ by a = μ g Δt, so that the disc slides for n = ⌊v₀/a⌋ steps. Moved with the velocity
/// at the end of each step, it gets as far as
///
/// > Δt (n v₀ − a n(n + 1)/2) = v₀²/(2μg) − v₀Δt/2 + Δt r(a − r)/(2a),  r = v₀ − n a,
///
/// so the distance differs from v₀²/(2μg) by at most v₀Δt/2 at any step length.
///
/// `associated` requires v_n ≥ μ|v_t|, and takes the admissible velocity nearest to the free velocity, (v₀, −g Δt):
///
/// > v_t = (v₀ − a)/(1 + μ²),  v_n = μ v_t.
///
/// The disc is lifted by Δt μ v_t, loses a fraction μ²/(1 + μ²) of its speed as if it had hit a slope, and flies,
/// v_n²/2g high, at any Δt.
///
/// `desaxce` allows v_n = μ(|v_t| − |v_t| of the previous solve), which is negative for a disc that slows down. The
/// sum over the whole path is −μ v₀: the disc ends μ v₀ Δt lower than it began.
pub fn dilatancy() -> Scene {
    let mut grain = disc(0.0, 0.5 - TOUCH);
    grain.velocity.x = SLIDING_SPEED * (GRAVITY * DIAMETER).sqrt();
    let mut scene = on_floor("dilatancy", vec![grain]);
    scene.physics.rotation = false;
    scene.view = view(DVec2::new(-1.5, -0.5), DVec2::new(11.5, 6.5));
    scene
}

/// Position of the wall, in diameters from the disc's start.
pub const WALL_DISTANCE: f64 = 20.0;

/// A fast disc and a wall without thickness. The disc flies `travel` diameters per step and starts the fraction
/// `phase` of a step further on. A step longer than the disc's radius can carry its centre past the wall before the
/// two ever overlap, or as they first do. A fraction 1 − r/(v Δt) of all phases then passes through.
pub fn thin_wall(travel: f64, phase: f64) -> Scene {
    let mut grain = disc(travel * phase, 0.0);
    let mut scene = dry("thin-wall", Vec::new());
    grain.velocity.x = travel * DIAMETER / scene.parameters.time_step_secs;
    scene.grains = vec![grain];
    scene.gravity = Gravity::Uniform { acceleration: DVec2::ZERO };
    let wall = DIAMETER * WALL_DISTANCE;
    scene.boundaries =
        vec![Boundary::Segment { from: DVec2::new(wall, -wall), to: DVec2::new(wall, wall) }];
    // A little later a disc that has passed the wall leaves the view.
    scene.duration_secs = 2.5 * WALL_DISTANCE / travel * scene.parameters.time_step_secs;
    scene.view = view(DVec2::new(-5.0, -10.0), DVec2::new(WALL_DISTANCE + 35.0, 10.0));
    scene
}
