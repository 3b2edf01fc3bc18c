//! The plot of an experiment's main quantity (such as the angle of the surface in a drum) against simulated time. The
//! curve has one point for each frame that the window has shown.

use std::collections::BTreeMap;

use egui::{Color32, Label, RichText, Ui};
use egui_plot::VLine;
use glam::DVec2;

use super::axes::{plot_with_axes, with_room};
use super::curve_pieces::{interval_secs, solid, thinned};
use super::theme;
use crate::live::LiveFrame;
use crate::scene::Scene;
use crate::sim::Snapshot;

/// The main quantity of an experiment, such as the angle of the surface in a drum.
struct ExperimentQuantity {
    /// Title of the plot, with the unit.
    title: &'static str,
    /// Function that returns the value of the quantity, given the scene in its initial state and a snapshot of the run.
    of: fn(&Scene, &Snapshot) -> f64,
    /// True if the plot shows the change of the quantity per second instead of the quantity itself.
    is_rate: bool,
}

/// Returns the main quantity of an experiment; `None` for other scenes.
fn quantity_of(scene: &Scene) -> Option<ExperimentQuantity> {
    let (title, of): (_, fn(&Scene, &Snapshot) -> f64) = match &*scene.name {
        "drum" => ("angle of the surface (degrees)", |_, now| surface_degrees(now)),
        "shear" | "shear-periodic" => ("shear stress / normal stress", |_, now| {
            let [_, xy, yy] = stress(now);
            xy.abs() / yy
        }),
        "biaxial" => ("stress ratio σyy/σxx", |_, now| {
            let [xx, _, yy] = stress(now);
            yy / xx
        }),
        "vibrated" => ("height of the large grain (mean diameters)", |scene, now| {
            let largest =
                now.grains.iter().max_by(|one, other| one.radius.total_cmp(&other.radius));
            largest.map_or(f64::NAN, |grain| grain.position.y / scene.mean_diameter)
        }),
        "collapse" => ("run-out (L − L₀)/L₀", |scene, now| {
            let before = half_width(scene.grains.iter().map(|grain| grain.position.x));
            half_width(now.grains.iter().map(|grain| grain.position.x)) / before - 1.0
        }),
        "silo" => ("grains per second through the orifice", |_, now| {
            now.grains.iter().filter(|grain| grain.position.y < 0.0).count() as f64
        }),
        "incline" => ("mean speed of the grains (mm/s)", |_, now| {
            let speeds = now.grains.iter().map(|grain| grain.velocity.length());
            1e3 * speeds.sum::<f64>() / now.grains.len().max(1) as f64
        }),
        _ => return None,
    };
    Some(ExperimentQuantity { title, of, is_rate: scene.name == "silo" })
}

/// Returns the angle of the surface in a rotating drum whose axis is at the origin, degrees. The centre of mass of a
/// filling with a plane surface lies on the line through the axis that is perpendicular to the surface.
fn surface_degrees(now: &Snapshot) -> f64 {
    let weighted = now.grains.iter().map(|grain| grain.radius.powi(2) * grain.position);
    let centre: DVec2 = weighted.sum();
    centre.x.atan2(-centre.y).to_degrees().abs()
}

fn half_width(places: impl Iterator<Item = f64>) -> f64 {
    let ends =
        places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    0.5 * (ends[1] - ends[0])
}

/// Returns the mean stresses σxx, ½(σxy + σyx) and σyy of the sample due to its contacts, each multiplied by the area
/// of the sample; the unit is therefore J. Each contact adds the product of its force, N, and the vector between the
/// two centres, m (formula of Love and Weber; at a wall, the touched point replaces the centre). Compression is
/// positive.
fn stress(now: &Snapshot) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for contact in &now.contacts {
        let branch = contact.from - contact.to;
        let normal = branch.normalize_or_zero();
        let force = contact.normal_force * normal + contact.tangential_force * normal.perp();
        sum[0] += force.x * branch.x;
        sum[1] += 0.5 * (force.x * branch.y + force.y * branch.x);
        sum[2] += force.y * branch.y;
    }
    sum
}

/// True if the scene in `frame` (the data to draw) is an experiment with a main quantity (such as the angle of the
/// surface in a drum) that can be plotted.
pub(super) fn has_quantity(frame: &LiveFrame) -> bool {
    frame.start.as_ref().is_some_and(|start| quantity_of(&start.scene).is_some())
}

/// Least simulated time between the two values from which the plot computes a change per second, s. A shorter time
/// would show the fluctuations between single frames.
const RATE_SECS: f64 = 0.1;

/// Values of an experiment's main quantity (such as the angle of the surface in a drum) in the frames that the window
/// has shown, by simulation and number of step.
#[derive(Debug, Default)]
pub(crate) struct ExperimentSeries {
    /// Number of initial states loaded so far, number of the newest earlier run, and number of simulations. If one of
    /// these numbers changes, the window shows another run, and all values are discarded.
    run: (u64, Option<u64>, usize),
    worlds: Vec<BTreeMap<u64, [f64; 2]>>,
}

impl ExperimentSeries {
    /// Adds the main quantity of an experiment (such as the angle of the surface in a drum) for each simulation in
    /// `frame`, the newest data from the solver's thread. If the recorded run now ends at an earlier step, removes the
    /// later values.
    pub(super) fn follow(&mut self, frame: &LiveFrame) {
        let scene = frame.start.as_ref().map(|start| &start.scene);
        let quantity = scene.and_then(|scene| Some((scene, quantity_of(scene)?)));
        let Some((scene, quantity)) = quantity else { return *self = Self::default() };
        let run = (frame.loads, frame.past.last().map(|past| past.number), frame.worlds.len());
        if self.run != run {
            *self = Self { run, worlds: vec![BTreeMap::new(); frame.worlds.len()] };
        }
        for (values, world) in self.worlds.iter_mut().zip(&frame.worlds) {
            let row = &world.snapshot.observables;
            if let Some(last) = world.curve.last() {
                values.split_off(&(last.step + 1));
            }
            values
                .entry(row.step)
                .or_insert_with(|| [row.time_secs, (quantity.of)(scene, &world.snapshot)]);
        }
    }

    /// Returns the points of a simulation's curve: simulated time, s, and the quantity or, if `is_rate` is true, its
    /// change per second.
    fn points(values: &BTreeMap<u64, [f64; 2]>, is_rate: bool) -> Vec<[f64; 2]> {
        let values: Vec<[f64; 2]> = values.values().copied().collect();
        let point = |&[time_secs, value]: &[f64; 2]| {
            let before = values.partition_point(|[at, _]| *at <= time_secs - RATE_SECS);
            match (is_rate, before.checked_sub(1)) {
                (false, _) => [time_secs, value],
                (true, None) => [time_secs, f64::NAN],
                (true, Some(before)) => {
                    let [then_secs, then] = values[before];
                    [time_secs, (value - then) / (time_secs - then_secs)]
                }
            }
        };
        values.iter().map(point).filter(|[_, value]| value.is_finite()).collect()
    }

    /// Draws the plot of the experiment's main quantity (such as the angle of the surface in a drum) into the remaining
    /// space. Draws nothing if the scene has no such quantity.
    pub(crate) fn draw(&self, ui: &mut Ui, frame: &LiveFrame) {
        let Some(scene) = frame.start.as_ref().map(|start| &start.scene) else { return };
        let Some(ExperimentQuantity { title, is_rate, .. }) = quantity_of(scene) else { return };
        ui.add(Label::new(RichText::new(title).small()).truncate());
        let worlds: Vec<_> =
            self.worlds.iter().map(|values| Self::points(values, is_rate)).collect();
        let values = worlds.iter().flatten().map(|point| point[1]);
        let ends = [[0.0, scene.duration_secs], with_room(values, false)];
        let dark = ui.visuals().dark_mode;
        plot_with_axes(ui, "experiment", [false; 2], " ms", ends).show(ui, |plot| {
            plot.vline(VLine::new("now", frame.time_secs()).color(Color32::GRAY).width(1.0));
            for (world, points) in worlds.into_iter().enumerate() {
                let colour = theme::world_colour(world, dark);
                let points = thinned(&points, interval_secs(plot));
                plot.line(solid(title, points).color(colour).width(1.6));
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{SCENES, SceneGroup};

    #[test]
    fn every_experiment_has_a_quantity_with_a_finite_value() {
        for info in SCENES.iter().filter(|info| info.group == SceneGroup::Experiments) {
            let scene = (info.make)().unwrap();
            let quantity = quantity_of(&scene).unwrap_or_else(|| panic!("{}", info.name));
            let mut run = scene.clone().simulation().unwrap();
            run.take_steps(400).unwrap();
            let value = (quantity.of)(&scene, &run.snapshot());
            // Before the grains of a shear cell touch, there is no stress.
            assert!(value.is_finite() || run.observables().contacts == 0, "{}: {value}", info.name);
        }
    }
}
