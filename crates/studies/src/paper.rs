//! The runs in the paper's Fig. 3, 4 and 7.

use glam::DVec2;

use crate::error::Result;
use crate::scene::{NewPile, Preset, Scene, cradle, paper_pile};
use crate::world::Boundary;

/// One run of a figure, with the times at which it is shown.
#[derive(Clone, Debug)]
pub struct PaperRun {
    /// File name without the time.
    pub name: String,
    /// The figure to which it belongs.
    pub figure: &'static str,
    /// The simulated scene.
    pub scene: Scene,
    /// Times, s, in ascending order.
    pub times_secs: Vec<f64>,
}

/// Bond numbers of Fig. 4, one row each.
pub const FIG4_BONDS: [f64; 2] = [20.0, 100.0];
/// Time steps of Fig. 4, one column each, s.
pub const FIG4_TIME_STEPS_SECS: [f64; 3] = [1e-4, 1e-3, 2e-3];
/// Time steps of Fig. 7, one column each, s.
pub const FIG7_TIME_STEPS_SECS: [f64; 2] = [5e-4, 1e-3];
/// Times of Fig. 7, one row each, s.
pub const FIG7_TIMES_SECS: [f64; 4] = [1.32, 1.76, 2.25, 2.5];

/// All runs, the most expensive first.
///
/// # Errors
/// As [`paper_pile`].
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
    // The initial state is shown with the walls that support it.
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
