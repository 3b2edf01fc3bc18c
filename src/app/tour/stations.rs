//! The stations. What their sentences say is checked by `tests/window/tour.rs`, which computes them.

use super::station::Station;
use crate::sim::{Settings, Stepper};
use crate::solver::{Fallback, Method, SolverSettings};
use crate::world::FrictionCone;

/// A pile of the paper, slow enough to be followed.
const PILE: Station = Station {
    title: "",
    watch: "",
    scene: "pile",
    worlds: |base| vec![base],
    speed: 0.2,
    plots: &["slump"],
    panel: None,
};

fn two_time_steps(base: Settings, bond: f64) -> Vec<Settings> {
    [1e-4, 5e-3].map(|secs| base.with_bond(bond).over(secs)).into()
}

/// That many sweeps of Gauss-Seidel a step, solved or not.
fn sweeps(base: Settings, count: u32) -> Settings {
    let (method, fallback) = (Method::Nsgs, Fallback::None);
    let solver = SolverSettings { method, fallback, max_sweeps: count, ..base.solver };
    Settings { solver, ..base }
}

/// All of them, in their order.
pub const STATIONS: [Station; 9] = [
    Station {
        title: "The time step glues",
        watch: "One pile twice, with the same cohesion, Bond 20. Only the time step differs. Release the walls: \
                at Δt = 1e-4 s it spreads out, at 5e-3 s it stands.",
        worlds: |base| two_time_steps(base, 20.0),
        ..PILE
    },
    Station {
        title: "Strong piles: the reverse",
        watch: "The same at Bond 100. Now the small time step is the one that holds best; the pile at 5e-3 s sinks \
                a little. Look at the scale of the plot.",
        worlds: |base| two_time_steps(base, 100.0),
        ..PILE
    },
    Station {
        title: "Why: three grains on a line",
        watch: "A grain falls on a bonded pair. A bond cancels an opening speed of up to Bond·g·Δt in each step: at \
                Δt = 5e-4 s the pair is torn apart, at 1e-3 s the bond holds. Watch the energy.",
        scene: "cradle",
        worlds: |base| [5e-4, 1e-3].map(|secs| base.over(secs)).into(),
        speed: 0.5,
        plots: &["energy"],
        ..PILE
    },
    Station {
        title: "The solver's part",
        watch: "Bond 20, Δt = 5e-3 s: 5 sweeps a step, 40 sweeps, and solved to 1e-6. Only a solved step shows what \
                the law says; the sweeps not taken look like weaker glue. See the residual.",
        worlds: |base| {
            let base = base.with_bond(20.0).over(5e-3);
            vec![sweeps(base, 5), sweeps(base, 40), base]
        },
        plots: &["slump", "residual"],
        panel: Some("solver"),
        ..PILE
    },
    Station {
        title: "A law in which Δt means little",
        watch: "Above the paper's law moreau, below range, whose bonds live until they are opened by δc: at Δt = \
                1e-4 and 5e-3 s. Above, the time step decides; below, the pile holds at both.",
        worlds: |base| {
            let of_law = |stepper| two_time_steps(Settings { stepper, ..base }, 20.0);
            [Stepper::Moreau, Stepper::Range].into_iter().flat_map(of_law).collect()
        },
        ..PILE
    },
    Station {
        title: "What friction hangs on",
        watch: "Bond 100, Δt = 1e-4 s. On the left friction is bounded by μ(N + C₀), cohesion included; on the right by \
                μ max(N, 0): there the strong pile slumps. The paper can be read both ways.",
        worlds: |base| {
            let base = base.with_bond(100.0).over(1e-4);
            let in_cone = |cone| {
                let mut settings = base;
                settings.parameters.cone = cone;
                settings
            };
            [FrictionCone::Shifted, FrictionCone::Compressive].map(in_cone).into()
        },
        panel: Some("physics"),
        ..PILE
    },
    Station {
        title: "Where a method breaks",
        watch: "A disc a thousand times as heavy on a light one. Ten sweeps a step cannot carry it, and the light \
                disc is squeezed; the right world is solved by newton. Watch the overlap.",
        scene: "mass-ratio",
        worlds: |base| {
            let solver = SolverSettings::to_residual(Method::Newton, 1e-6, 100);
            let base = Settings { solver, ..base };
            vec![sweeps(base, 10), base]
        },
        plots: &["overlap", "residual"],
        ..PILE
    },
    Station {
        title: "Speed against accuracy",
        watch: "Start the pile, stop it while it slumps, and press Measure this step under Speed and accuracy: each \
                method solves the step that is shown, and its residual is drawn over its time.",
        worlds: |base| vec![base.with_bond(20.0).over(1e-3)],
        plots: &["slump", "residual"],
        panel: Some("speed"),
        ..PILE
    },
    Station {
        title: "Your own pile",
        watch: "Under Run, choose a number of grains and a seed, and make a new pile; under Physics, its Bond and Δt. \
                Drag grains with the mouse. The tour can be taken up again at any time.",
        plots: &["slump", "overlap", "residual", "energy"],
        panel: Some("run"),
        ..PILE
    },
];
