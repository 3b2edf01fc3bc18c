//! Two bodies (paper §2.2): the speed after one step against Δt. Theory as lines, simulation as
//! points.

use glam::DVec2;

use super::{Claim, Figure, Workshop};
use crate::chart::{Axis, Chart, Corner, Layer, Look, PALETTE, Sheet, points};
use crate::error::Result;
use crate::scene::{Scene, collision};
use crate::world::{Grain, Parameters};

/// Restitution of the runs: large enough to be seen.
pub(super) const RESTITUTION: f64 = 0.2;

/// Opening speeds at the beginning of the step, m/s.
const SPEEDS: [f64; 5] = [-0.02, 0.01, 0.02, 0.04, 0.06];
const TIME_STEPS_SECS: (f64, f64) = (0.0, 0.012);
/// Points a line.
const POINTS: u32 = 25;

/// The state after one step of two free discs of different sizes that touch and part with `speed`.
/// Returns their effective mass (kg), N (newton) and v^n (m/s).
pub(super) fn one_step(speed: f64, time_step_secs: f64, bond: f64) -> Result<(f64, f64, f64)> {
    let scene = collision();
    let (small, large) = (0.1, 0.2);
    let disc = |x: f64, radius: f64, velocity: f64| Grain {
        feels_gravity: false,
        velocity: DVec2::new(velocity, 0.0),
        ..Grain::at_rest(DVec2::new(x, 0.0), radius)
    };
    let scene = Scene {
        gap_tolerance: 1e-9,
        parameters: Parameters {
            time_step_secs,
            bond,
            restitution: RESTITUTION,
            ..scene.parameters
        },
        fixed_discs: Vec::new(),
        grains: vec![disc(small + large, small, speed), disc(0.0, large, 0.0)],
        ..scene
    };
    let mut simulation = scene.simulation()?;
    simulation.step()?;
    let grains = &simulation.world().grains;
    let mass = 1.0 / (1.0 / grains.masses[0] + 1.0 / grains.masses[1]);
    let force = simulation.snapshot().contacts.first().map_or(0.0, |contact| contact.normal_force);
    Ok((mass, force, grains.velocities[0].x - grains.velocities[1].x))
}

/// v^n by the three cases of §2.2, without other forces: −ρ v^{n−1} where the contact closes or
/// bounces, v^{n−1} − ΔtC₀/m_ij where it opens.
fn theory(speed: f64, capture_speed: f64) -> f64 {
    if speed * (1.0 + RESTITUTION) > capture_speed {
        speed - capture_speed
    } else {
        -RESTITUTION * speed
    }
}

pub(super) fn make(workshop: &Workshop) -> Result<Figure> {
    let (bond, gravity) = (collision().parameters.bond, collision().gravity.magnitude());
    let (from, to) = TIME_STEPS_SECS;
    let mut chart = Chart::new(
        "Two bodies: opening speed after one step",
        Axis::linear("Δt (s)", from, to),
        Axis::linear("vₙ after the step (m/s)", -0.02, 0.075),
    );
    chart.legend = Corner::UpperRight;
    let mut worst: f64 = 0.0;
    for (number, speed) in SPEEDS.into_iter().enumerate() {
        let colour = PALETTE[number % PALETTE.len()];
        let at = |index: u32| from + (to - from) * (f64::from(index) + 0.5) / f64::from(POINTS);
        let mut simulated = Vec::new();
        for time_step_secs in (0..POINTS).map(at) {
            let (_, _, after) = one_step(speed, time_step_secs, bond)?;
            let expected = theory(speed, bond * gravity * time_step_secs);
            worst = worst.max((after - expected).abs() / speed.abs());
            simulated.push((time_step_secs, after));
        }
        let line = (0..=1200).map(|k| from + (to - from) * f64::from(k) / 1200.0);
        let line = line.map(|step| (step, theory(speed, bond * gravity * step)));
        let name = format!("theory {speed}");
        chart.layers.push(Layer::quiet(name, points(line), colour, Look::Line(2)));
        let before = format!("vₙ before: {speed} m/s").replace('-', "−");
        chart.layers.push(Layer::curve(before, points(simulated), colour, Look::Dots(5)));
    }
    let mut sheet = Sheet::of(chart);
    sheet.caption = vec![format!(
        "Lines: theory of §2.2 (Bond {bond}, g {gravity} m/s², ρ {RESTITUTION}); points: one simulated \
         step each. Largest relative difference {worst:.1e}."
    )];
    let _ = workshop;
    let claim = Claim::new(
        "§2.2: a contact bounces, closes again, or opens with v − ΔtC₀/m_ij",
        format!(
            "largest relative difference {worst:.1e} over {} steps",
            SPEEDS.len() as u32 * POINTS
        ),
        (worst < 1e-12).into(),
    )
    .by_chance("nothing is drawn at random: the steps are exact")
    .hanging_on("no choice: the three cases follow from the law");
    Ok(Figure { name: "two-body", sheet, claims: vec![claim], table: None })
}
