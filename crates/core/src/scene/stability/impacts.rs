//! Discs that hit, bounce and slide.

use glam::DVec2;

use crate::scene::Scene;
use crate::scene::stability::{DIAMETER, GRAVITY, TOUCH, disc, dry, mass_ratio, on_floor, view};
use crate::world::{Boundary, Gravity, Physics};

/// Height that it falls, in diameters.
const DROP: f64 = 5.0;

/// A disc dropped on the floor. It rises to ρ² of its height, and for ρ < 1 it is at rest after
/// infinitely many bounces, at √(2h/g)·(1 + ρ)/(1 − ρ).
pub fn bounce(restitution: f64) -> Scene {
    let mut scene = on_floor("bounce", vec![disc(0.0, DROP + 0.5)]);
    scene.parameters.restitution = restitution;
    scene.view = view(DVec2::new(-4.5, -0.5), DVec2::new(4.5, DROP + 1.5));
    scene.duration_secs = 10.0 * (2.0 * DROP * DIAMETER / GRAVITY).sqrt();
    scene
}

/// Speed of the first ball, in √(g d).
const BALL_SPEED: f64 = 3.0;

/// One ball that hits `count` − 1 others on a line, without gravity.
/// Newton's cradle: a row of balls at rest that touch, and one that hits them. At ρ = 1 the last one
/// flies off with all the speed: no law that settles all impacts of a step together says so.
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

/// How much heavier the disc is that falls.
const RATIO: f64 = 9.0;
/// Speeds of both along the floor, and of the fall, in √(g d).
const SLIDING: f64 = 6.0;
const FALLING: f64 = 2.0;
/// The height that it falls from, in d: the disc below has been solved before the blow at every Δt.
const HEIGHT: f64 = 0.05;

/// A disc that slides along the floor, and a heavy one beside it in the air that hits it from above. Neither
/// turns, and there is no gravity: what the floor pushes is the blow and nothing else.
///
/// All that the floor pushes, it pushes while it rubs. With M the mass of both and p_y < 0 the momentum of the
/// fall, both are level after the blow, and momentum alone says
///
/// > M v_x = M v₀ − μ|p_y|,
///
/// whatever happens between the two; as the lower one is M/10, a part of 0.9 μ of the blow, less than μ, has
/// them go on together. `tresca` bounds the friction of that step by what the floor bore before, nothing, and
/// that of the next one by the blow: the speed is right a step too late, and both get Δt μ|p_y|/M too far. A
/// second solve of the step knows the blow, since what the floor pushes here does not depend on friction.
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

/// A disc that slides on the floor and does not turn. It must keep its level, and stop.
///
/// A step takes a = μ g Δt of its speed v₀, so that it slides for n = ⌊v₀/a⌋ steps and, moved with the
/// velocity that a step ends with, comes as far as
///
/// > Δt (n v₀ − a n(n + 1)/2) = v₀²/(2μg) − v₀Δt/2 + Δt r(a − r)/(2a),  r = v₀ − n a,
///
/// so that no step leaves it further from v₀²/(2μg) than v₀Δt/2.
///
/// `associated` asks for v_n ≥ μ|v_t|, and of all velocities that do so takes the one nearest to the free
/// one, (v₀, −g Δt):
///
/// > v_t = (v₀ − a)/(1 + μ²),  v_n = μ v_t.
///
/// The disc is lifted by Δt μ v_t, has lost a share μ²/(1 + μ²) of its speed as if it had run into a
/// slope, and flies, v_n²/2g high, at any Δt.
///
/// `desaxce` lets v_n = μ(|v_t| − |v_t| of the solve before), less than nothing for what slows down. These sum
/// up to −μ v₀ over the whole way: the disc ends μ v₀ Δt lower than it began.
pub fn dilatancy() -> Scene {
    let mut grain = disc(0.0, 0.5 - TOUCH);
    grain.velocity.x = SLIDING_SPEED * (GRAVITY * DIAMETER).sqrt();
    let mut scene = on_floor("dilatancy", vec![grain]);
    scene.physics.rotation = false;
    scene.view = view(DVec2::new(-1.5, -0.5), DVec2::new(11.5, 6.5));
    scene
}

/// Where the wall stands, in diameters from the disc's start.
pub const WALL_DISTANCE: f64 = 20.0;

/// A disc that flies `travel` diameters a step, and starts a share `phase` of a step further on.
/// A fast disc and a wall without thickness. A step longer than the disc's radius can carry its
/// centre past the wall before they ever overlap, or just as they first do; a share of 1 − r/(v Δt)
/// of all phases then goes through.
pub fn thin_wall(travel: f64, phase: f64) -> Scene {
    let mut grain = disc(travel * phase, 0.0);
    let mut scene = dry("thin-wall", Vec::new());
    grain.velocity.x = travel * DIAMETER / scene.parameters.time_step_secs;
    scene.grains = vec![grain];
    scene.gravity = Gravity::Uniform { acceleration: DVec2::ZERO };
    let wall = DIAMETER * WALL_DISTANCE;
    scene.boundaries =
        vec![Boundary::Segment { from: DVec2::new(wall, -wall), to: DVec2::new(wall, wall) }];
    // A little later a disc that is through leaves the view.
    scene.duration_secs = 2.5 * WALL_DISTANCE / travel * scene.parameters.time_step_secs;
    scene.view = view(DVec2::new(-5.0, -10.0), DVec2::new(WALL_DISTANCE + 35.0, 10.0));
    scene
}
