//! Fig. 2: the contact graph, Signorini's and shifted by the cohesion, with the lines
//! N = K v̄ + A of the three cases. The dots where they meet are simulated.

use super::two_body::{RESTITUTION, one_step};
use super::{Claim, Figure, Workshop};
use crate::chart::{Axis, Chart, Corner, INK, Layer, Look, PALETTE, Sheet, points};
use crate::error::Result;
use crate::scene::collision;

/// A of the three cases, in units of C₀.
const CASES: [(f64, &str); 3] = [(1.2, "A > 0"), (-0.5, "−C₀ < A < 0"), (-2.2, "A < −C₀")];
const TIME_STEP_SECS: f64 = 1e-3;
/// Reach of the axes, in units of ΔtC₀/m_ij and of C₀.
const REACH: (f64, f64) = (2.0, 3.0);

pub(super) fn make(_workshop: &Workshop) -> Result<Figure> {
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

/// The graph whose corner lies at N = −`shift`·C₀, and how far off it a simulated step lies at most.
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
    chart.legend = Corner::LowerRight;
    let graph = [(0.0, y_reach), (0.0, -shift), (x_reach, -shift)];
    let graph = points(graph);
    chart.layers.push(Layer::curve("contact law", graph, INK, Look::Line(5)));
    for (number, (force, name)) in CASES.into_iter().enumerate() {
        let colour = PALETTE[[1, 3, 6][number]];
        let line = [-x_reach, x_reach].map(|v| (v, (1.0 + RESTITUTION) * v + force));
        // Cut where the axes end.
        let line = line.map(|(v, n)| {
            let kept = n.clamp(-y_reach, y_reach);
            (v + (kept - n) / (1.0 + RESTITUTION), kept)
        });
        chart.layers.push(Layer::curve(name, points(line), colour, Look::Line(2)));
        // A = −m(1 + ρ) v^{n−1} / Δt where no other force acts.
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
