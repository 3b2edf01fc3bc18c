//! Lists the simulation runs that Figs. 3, 4 and 7 of Abramian & Staron (2020) show.

use glam::DVec2;

use crate::error::Result;
use crate::scene::{NewPile, Preset, Scene, cradle, paper_pile};
use crate::world::Boundary;

/// A simulation run that a figure of Abramian & Staron (2020) shows, with the times of its pictures.
#[derive(Clone, Debug)]
pub struct PaperRun {
    /// File name of the run's pictures, without the time.
    pub name: String,
    /// Name of the figure of Abramian & Staron (2020) that shows the run: `fig3`, `fig4` or `fig7`.
    pub figure: &'static str,
    /// The simulated scene.
    pub scene: Scene,
    /// Simulated times of the run's pictures, s, in ascending order.
    pub times_secs: Vec<f64>,
}

/// Bond numbers of the runs in Fig. 4 of Abramian & Staron (2020). The figure has one row of pictures per Bond number.
pub const FIG4_BONDS: [f64; 2] = [20.0, 100.0];
/// Time steps of the runs in Fig. 4 of Abramian & Staron (2020), s. The figure has one column of pictures per time
/// step.
pub const FIG4_TIME_STEPS_SECS: [f64; 3] = [1e-4, 1e-3, 2e-3];
/// Time steps of the runs in Fig. 7 of Abramian & Staron (2020), s. The figure has one column of pictures per time
/// step.
pub const FIG7_TIME_STEPS_SECS: [f64; 2] = [5e-4, 1e-3];
/// Simulated times of the pictures in Fig. 7 of Abramian & Staron (2020), s. The figure has one row of pictures per
/// time.
pub const FIG7_TIMES_SECS: [f64; 4] = [1.32, 1.76, 2.25, 2.5];

/// Returns all runs of Figs. 3, 4 and 7 of Abramian & Staron (2020), the most expensive first.
///
/// # Errors
/// Returns the errors of [`paper_pile`].
pub fn paper_runs() -> Result<Vec<PaperRun>> {
    let mut runs = Vec::new();
    let mut pile = paper_pile()?;
    Preset::Paper.apply(&mut pile);
    for time_step_secs in FIG4_TIME_STEPS_SECS {
        for bond in FIG4_BONDS {
            let mut scene = pile.clone();
            scene.parameters.bond = bond;
            scene.parameters.time_step_secs = time_step_secs;
            let times_secs = vec![scene.duration_secs];
            let name = format!("fig4_bond{bond}_dt{time_step_secs:e}");
            runs.push(PaperRun { name, figure: "fig4", scene, times_secs });
        }
    }
    for time_step_secs in FIG7_TIME_STEPS_SECS {
        let mut scene = cradle();
        scene.parameters.time_step_secs = time_step_secs;
        let name = format!("fig7_dt{time_step_secs:e}");
        let times_secs = FIG7_TIMES_SECS.to_vec();
        runs.push(PaperRun { name, figure: "fig7", scene, times_secs });
    }
    // Fig. 3 shows the initial state of the pile, so its scene includes the side walls that support the grains.
    let half_width = 0.5 * NewPile::default().box_width_in_diameters * pile.mean_diameter;
    pile.boundaries = [-half_width, half_width]
        .map(|x| Boundary::Segment {
            from: DVec2::new(x, 0.0),
            to: DVec2::new(x, 12.0 * pile.mean_diameter),
        })
        .to_vec();
    runs.push(PaperRun { name: "fig3".into(), figure: "fig3", scene: pile, times_secs: vec![0.0] });
    Ok(runs)
}
