//! Draws figures of two bodies in contact. Fig. 2 of Abramian & Staron (2020) shows two contact laws as graphs of the
//! normal force N against the formal velocity v̄: Signorini's law, and the same law shifted by the cohesion force. The
//! lines N = K v̄ + A are the equation of motion for three values of the constant A, with K = m_ij (1 + ρ)/Δt, the
//! effective mass m_ij, the restitution ρ and the time step Δt. The solution of a step is at the intersection of line
//! and graph, and dots show simulated steps. A second figure shows the opening speed after one step against Δt (§2.2 of
//! the article), with theory as lines and simulation as points.

use glam::DVec2;

use super::{Claim, Figure, StudyRunner};
use crate::chart::{Axis, Chart, INK, Layer, Look, PALETTE, Sheet, points};
use crate::error::Result;
use crate::scene::{Scene, collision};
use crate::world::{Grain, Parameters};

/// Three values of the constant A of the equation of motion N = K v̄ + A, in units of the cohesion force C₀, and the
/// name of each case. N is the normal force and v̄ the formal velocity. K is m_ij (1 + ρ)/Δt, with the effective mass
/// m_ij, the restitution ρ and the time step Δt.
const CASES: [(f64, &str); 3] = [(1.2, "A > 0"), (-0.5, "−C₀ < A < 0"), (-2.2, "A < −C₀")];
const TIME_STEP_SECS: f64 = 1e-3;
/// Upper ends of the two axes; the lower ends are the negative of these values. The first axis is the formal velocity
/// in units of Δt·C₀/m_ij, the second the normal force in units of C₀, with the time step Δt, the cohesion force C₀ and
/// the effective mass m_ij.
const REACH: (f64, f64) = (2.0, 3.0);

pub(super) fn fig2(_: &StudyRunner) -> Result<Figure> {
    let (signorini, off) = chart("Signorini", 0.0)?;
    let (shifted, off_shifted) = chart("shifted by the cohesion", 1.0)?;
    let worst = off.max(off_shifted);
    let sheet = Sheet {
        size: (1500, 780),
        charts: vec![signorini, shifted],
        caption: vec![format!(
            "Thick: the graph of the law. Thin: N = K v + A with K = m(1 + ρ)/Δt. Dots: one simulated \
             step each (ρ = {RESTITUTION})."
        )],
    };
    let claim = Claim::new(
        "Fig. 2: the solution is where the line meets the graph",
        format!("six simulated steps lie there to {worst:.1e}"),
        (worst < 1e-12).into(),
    )
    .by_chance("nothing is drawn at random: the steps are exact")
    .hanging_on("no choice: any ρ, Bond and Δt give the same graph in these units");
    Ok(Figure { name: "fig2", sheet, claims: vec![claim], table: None })
}

/// Draws the graph of a contact law: the normal force against the formal velocity, with the corner of the graph at the
/// normal force −`shift`·C₀, where C₀ is the cohesion force. Also returns the largest distance between a simulated step
/// and the intersection of this graph with the line of the equation of motion.
fn chart(title: &str, shift: f64) -> Result<(Chart, f64)> {
    let scene = collision();
    let bond = scene.parameters.bond;
    let capture_speed = bond * scene.gravity.magnitude() * TIME_STEP_SECS;
    let (x_reach, y_reach) = REACH;
    let mut worst: f64 = 0.0;
    let mut chart = Chart::new(
        title,
        Axis::linear("formal velocity v / (ΔtC₀/m)", -x_reach, x_reach),
        Axis::linear("N / C₀", -y_reach, y_reach),
    );
    let graph = [(0.0, y_reach), (0.0, -shift), (x_reach, -shift)];
    let graph = points(graph);
    chart.layers.push(Layer::curve("contact law", graph, INK, Look::Line(5)));
    for (number, (force, name)) in CASES.into_iter().enumerate() {
        let colour = PALETTE[[1, 3, 6][number]];
        let line = [-x_reach, x_reach].map(|v| (v, (1.0 + RESTITUTION) * v + force));
        // The line is clipped to the axes.
        let line = line.map(|(v, n)| {
            let cut = n.clamp(-y_reach, y_reach);
            (v + (cut - n) / (1.0 + RESTITUTION), cut)
        });
        chart.layers.push(Layer::curve(name, points(line), colour, Look::Line(2)));
        // Without other forces, A = −m(1 + ρ) v^{n−1}/Δt, with the effective mass m, the restitution ρ and the opening
        // speed v^{n−1} before the step.
        let before = -force * capture_speed / (1.0 + RESTITUTION);
        let (mass, n, after) = one_step(before, TIME_STEP_SECS, bond * shift)?;
        let formal = (after + RESTITUTION * before) / (1.0 + RESTITUTION) / capture_speed;
        let n = n / (mass * capture_speed / TIME_STEP_SECS);
        let expected = if force > -shift {
            (0.0, force)
        } else {
            ((-shift - force) / (1.0 + RESTITUTION), -shift)
        };
        worst = worst.max((formal - expected.0).abs()).max((n - expected.1).abs());
        let dot = points([(formal, n)]);
        chart.layers.push(Layer::quiet(format!("simulated, {name}"), dot, colour, Look::Dots(9)));
    }
    Ok((chart, worst))
}

/// Restitution ρ of the simulated contacts, large enough for the bounce to be visible in the figures.
const RESTITUTION: f64 = 0.2;

/// Opening speeds of the contact at the beginning of the simulated steps, m/s; negative if the contact closes.
const SPEEDS: [f64; 5] = [-0.02, 0.01, 0.02, 0.04, 0.06];
const TIME_STEPS_SECS: (f64, f64) = (0.0, 0.012);
const POINTS: u32 = 25;

/// Simulates one step of two free, touching discs of different sizes that separate with `speed` (m/s). Returns their
/// effective mass (kg), the normal force N (newton), and the opening speed v^n after the step (m/s).
fn one_step(speed: f64, time_step_secs: f64, bond: f64) -> Result<(f64, f64, f64)> {
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

/// Returns the theoretical opening speed v^n of a contact after a step, according to the three cases of §2.2 of
/// Abramian & Staron (2020), without other forces. Let v^{n−1} be the opening speed before the step, ρ the restitution,
/// C₀ the cohesion force and m_ij the effective mass. The result is −ρ v^{n−1} if the contact closes or bounces, and
/// v^{n−1} − ΔtC₀/m_ij if the contact opens. ΔtC₀/m_ij is `capture_speed`.
fn theory(speed: f64, capture_speed: f64) -> f64 {
    if speed * (1.0 + RESTITUTION) > capture_speed {
        speed - capture_speed
    } else {
        -RESTITUTION * speed
    }
}

pub(super) fn two_bodies(_: &StudyRunner) -> Result<Figure> {
    let (bond, gravity) = (collision().parameters.bond, collision().gravity.magnitude());
    let (from, to) = TIME_STEPS_SECS;
    let mut chart = Chart::new(
        "Two bodies: opening speed after one step",
        Axis::linear("Δt (s)", from, to),
        Axis::linear("vₙ after the step (m/s)", -0.02, 0.075),
    );
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
