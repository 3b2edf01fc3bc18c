//! Rain: the method of generating a pile by which the initial state that is shipped with Slump was made.
//!
//! The discs start at rest on a loose lattice above the base, with random displacements, and fall through a medium. The
//! medium limits their speed to the terminal speed √(g·d)/2. So they land with overlaps of at most the terminal speed
//! times the time step, whatever the height of the box is. When the pile has formed, the medium is removed. Then the
//! pile settles without cohesion under the contact laws of the runs of Abramian & Staron (2020).

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::error::Result;
use crate::scene::deposition::{
    REST_SECS, Settled, Settling, fastest, in_a_box, interrupted, not_at_rest, random_radius,
};
use crate::scene::new_pile::NewPile;
use crate::scene::paper::{DIAMETER, GRAVITY};
use crate::solver::SolverSettings;
use crate::world::Grain;

/// Time step while the pile settles, s. The overlaps of the grains in the initial state are proportional to it.
const TIME_STEP_SECS: f64 = 1e-4;
/// Largest speed of a grain in a pile at rest, in √(g·d) (g: gravity, d: mean diameter). A pile is at rest if all its
/// grains have been slower than this speed for [`REST_SECS`].
const REST_SPEED: f64 = 2e-4;
const STEPS_PER_LOOK: u32 = 100;

pub(super) fn settled(
    rain: &NewPile,
    mut progress: impl FnMut(Settling) -> bool,
) -> Result<Settled> {
    let columns = rain.columns();
    let solver = SolverSettings { tolerance: 1e-4, max_sweeps: 1000, ..SolverSettings::SWEEPS };
    let scene = in_a_box(lattice(rain), rain.box_width_in_diameters, TIME_STEP_SECS, solver)?;
    let mut simulation = scene.simulation()?;

    let rows = (rain.grains as f64 / columns as f64).ceil();
    let speed_unit = (GRAVITY * DIAMETER).sqrt();
    let terminal_speed = 0.5 * speed_unit;
    // Grains of the upper rows fall farthest. The pile on which they land is lower than the lattice.
    let raining_secs = rows * rain.spacing() * DIAMETER / terminal_speed + 0.1;
    let limit_secs = 4.0 * raining_secs + 2.0;
    // The factor is linear in Δt, because an exponential would differ between machines in its last digits.
    let drag_per_step = 1.0 - TIME_STEP_SECS * GRAVITY / terminal_speed;
    let mut slow_since_secs = f64::INFINITY;
    loop {
        for _ in 0..STEPS_PER_LOOK {
            simulation.step()?;
            if simulation.time_secs() < raining_secs {
                simulation.scale_velocities(drag_per_step);
            }
        }
        let time_secs = simulation.time_secs();
        let speed_over_rest = fastest(&simulation) / (REST_SPEED * speed_unit);
        let rains = time_secs < raining_secs;
        let simulation = &simulation;
        if !progress(Settling { simulation, rains, time_secs, limit_secs, speed_over_rest }) {
            return Err(interrupted());
        }
        if speed_over_rest > 1.0 || rains {
            slow_since_secs = f64::INFINITY;
        } else {
            slow_since_secs = slow_since_secs.min(time_secs);
            if time_secs - slow_since_secs >= REST_SECS {
                break;
            }
        }
        if time_secs > limit_secs {
            return Err(not_at_rest(speed_over_rest, limit_secs));
        }
    }
    Ok(Settled::of(simulation))
}

/// Returns the discs of a new pile before they fall: at rest on a loose lattice with random displacements, row by row
/// from the bottom.
pub(super) fn lattice(rain: &NewPile) -> Vec<Grain> {
    let columns = rain.columns();
    let mut random = Pcg64::seed_from_u64(rain.seed);
    let spacing = rain.spacing() * DIAMETER;
    (0..rain.grains)
        .map(|index| {
            let radius = random_radius(rain, &mut random);
            let room = 0.5 * spacing - radius;
            let jitter =
                DVec2::new(random.random_range(-1.0..=1.0), random.random_range(-1.0..=1.0));
            let column = (index % columns) as f64 - 0.5 * (columns - 1) as f64;
            let row = (index / columns) as f64 + 1.5;
            Grain::at_rest(spacing * DVec2::new(column, row) + room * jitter, radius)
        })
        .collect()
}
