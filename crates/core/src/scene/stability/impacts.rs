//! Scenes of discs that collide, bounce and slide.

use glam::DVec2;

use crate::scene::Scene;
use crate::scene::stability::{DIAMETER, GRAVITY, TOUCH, disc, dry, mass_ratio, on_floor, view};
use crate::world::{Boundary, Gravity, Physics};

/// Height of fall of the disc in the scene [`bounce`], from its lowest point to the floor, in diameters.
const DROP: f64 = 5.0;

/// Returns the scene of a disc that falls under gravity g from the height h onto the floor. After the first bounce with
/// the restitution ρ it rises to ρ² h. For ρ < 1 it comes to rest after infinitely many bounces. The time until then is
/// √(2h/g)·(1 + ρ)/(1 − ρ).
pub fn bounce(restitution: f64) -> Scene {
    let mut scene = on_floor("bounce", vec![disc(0.0, DROP + 0.5)]);
    scene.parameters.restitution = restitution;
    scene.view = view(DVec2::new(-4.5, -0.5), DVec2::new(4.5, DROP + 1.5));
    scene.duration_secs = 10.0 * (2.0 * DROP * DIAMETER / GRAVITY).sqrt();
    scene
}

/// Speed of the ball that hits the row of balls in the scene [`balls`], in units of √(g d) (g: gravity, d: diameter).
const BALL_SPEED: f64 = 3.0;

/// Returns the scene of Newton's cradle, without gravity: one ball hits a row of `count` − 1 balls, which touch each
/// other and are at rest. With the restitution ρ = 1 the last ball should fly off with the speed of the first ball,
/// and all others should stop. No contact law that solves all impacts of a step together predicts this.
pub fn balls(count: usize) -> Scene {
    let mut grains: Vec<_> = (0..count).map(|k| disc(k as f64 * (1.0 - TOUCH), 0.0)).collect();
    grains[0].position.x -= DIAMETER;
    grains[0].velocity.x = BALL_SPEED * (GRAVITY * DIAMETER).sqrt();
    let mut scene = dry("newtons-cradle", grains);
    scene.physics = Physics { axes: 1, friction: false, rotation: false, cohesion: false };
    scene.gravity = Gravity::Uniform { acceleration: DVec2::ZERO };
    scene.parameters.restitution = 1.0;
    let width = count as f64 + 6.0;
    // The run ends before the last ball leaves the view.
    scene.duration_secs = (count as f64 + 1.0) / BALL_SPEED * (DIAMETER / GRAVITY).sqrt();
    scene.view = view(DVec2::new(-2.5, -2.0), DVec2::new(width, 2.0));
    scene
}

/// Mass of the heavy falling disc divided by the mass of the sliding disc in the scene `blow`.
const RATIO: f64 = 9.0;
/// Initial speed of both discs along the floor, in √(g d) (g: gravity, d: diameter), in the scene `blow`.
const SLIDING: f64 = 6.0;
/// Initial speed at which the heavy disc falls, in √(g d) (g: gravity, d: diameter), in the scene `blow`.
const FALLING: f64 = 2.0;
/// Initial gap between the falling disc and the lower disc in the scene `blow`, in diameters. The gap is so large that
/// the first step, at any time step, has a single contact: that of the lower disc with the floor. So this contact
/// exists before the blow.
const HEIGHT: f64 = 0.05;

/// Returns the scene of a blow: a disc slides along the floor, and a heavy disc, which moves along above it, hits it
/// from above. The discs do not rotate, and there is no gravity, so the floor pushes only during the blow.
///
/// In the step of the blow, the friction impulse of the floor must be μ times the whole normal impulse of the blow.
/// Let M be the total mass, p_y < 0 the vertical momentum of the falling disc, μ the friction coefficient, v₀ the
/// initial and v_x the final horizontal speed. After the blow both discs move horizontally, and the balance of
/// momentum gives
///
/// > M v_x = M v₀ − μ|p_y|,
///
/// whatever happens between the two discs. The two discs stay together, because the friction impulse between them need
/// only be 0.9 μ times the normal impulse of the blow, which is less than μ times this impulse (the lower disc has the
/// mass M/10).
///
/// The friction model `tresca` bounds friction by μ times a normal impulse that is known before the solve. With the
/// normal impulse of the previous step, this bound would be zero in the step of the blow. The discs would have the
/// right speed one step late, and both discs would move too far by Δt μ|p_y|/M (time step Δt). Therefore `tresca`
/// estimates the normal impulse by sweeps under Coulomb's law in the same step, which include the blow. A second solve
/// of the same step (setting `model-solves`) makes the bound exact, because here the normal impulse of the floor does
/// not depend on friction.
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

/// Initial speed of the sliding disc along the floor in the scene [`dilatancy`], in units of √(g d) (g: gravity, d:
/// diameter).
const SLIDING_SPEED: f64 = 3.0;

/// Returns the scene of a disc that slides on the floor and does not rotate. In a correct solution the disc keeps its
/// height, and friction stops it.
///
/// **Coulomb friction.** A time step Δt reduces the speed v₀ by a = μ g Δt (μ: friction coefficient), so the disc
/// slides for n = ⌊v₀/a⌋ steps. If it moves with the velocity at the end of each step, it slides over the distance
///
/// > Δt (n v₀ − a n(n + 1)/2) = v₀²/(2μg) − v₀Δt/2 + Δt r(a − r)/(2a),  r = v₀ − n a.
///
/// So for any time step the distance differs from the exact value v₀²/(2μg) by at most v₀Δt/2.
///
/// **The friction model `associated`** requires v_n ≥ μ|v_t| (normal and tangential velocity at the contact). It
/// chooses the allowed velocity that is nearest to the velocity without contact, (v₀, −g Δt):
///
/// > v_t = (v₀ − a)/(1 + μ²),  v_n = μ v_t.
///
/// The disc is lifted by Δt μ v_t and loses a fraction μ²/(1 + μ²) of its speed, as if it had hit a slope. Then it
/// flies up to a height of v_n²/2g, at any time step.
///
/// **The friction model `desaxce`** allows v_n = μ(|v_t| − |v_t'|), with the tangential velocity v_t' before the step.
/// This v_n is negative for a disc that slows down. The sum of v_n over all steps is −μ v₀, so at the end the disc is
/// lower by μ v₀ Δt than at the start.
pub fn dilatancy() -> Scene {
    let mut grain = disc(0.0, 0.5 - TOUCH);
    grain.velocity.x = SLIDING_SPEED * (GRAVITY * DIAMETER).sqrt();
    let mut scene = on_floor("dilatancy", vec![grain]);
    scene.physics.rotation = false;
    scene.view = view(DVec2::new(-1.5, -0.5), DVec2::new(11.5, 6.5));
    scene
}

/// Distance from the origin to the wall in the scene [`thin_wall`], in diameters. The disc starts near the origin.
pub const WALL_DISTANCE: f64 = 20.0;

/// Returns the scene of a fast disc and a wall without thickness. The disc moves `travel` diameters per step. Its
/// initial position is shifted by the fraction `phase` of the distance per step. A solver that detects contacts only at
/// the beginning of a step misses the wall if the gap is then still open and the step carries the centre of the disc
/// past the wall. This can happen if the distance per step, v Δt (speed v, time step Δt), is longer than the radius r
/// of the disc. It happens for a fraction 1 − r/(v Δt) of all phases.
pub fn thin_wall(travel: f64, phase: f64) -> Scene {
    let mut grain = disc(travel * phase, 0.0);
    let mut scene = dry("thin-wall", Vec::new());
    grain.velocity.x = travel * DIAMETER / scene.parameters.time_step_secs;
    scene.grains = vec![grain];
    scene.gravity = Gravity::Uniform { acceleration: DVec2::ZERO };
    let wall = DIAMETER * WALL_DISTANCE;
    scene.boundaries =
        vec![Boundary::Segment { from: DVec2::new(wall, -wall), to: DVec2::new(wall, wall) }];
    // The run ends before a disc that has passed the wall leaves the view.
    scene.duration_secs = 2.5 * WALL_DISTANCE / travel * scene.parameters.time_step_secs;
    scene.view = view(DVec2::new(-5.0, -10.0), DVec2::new(WALL_DISTANCE + 35.0, 10.0));
    scene
}
