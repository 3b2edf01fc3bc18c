//! Rings that flash at the positions of breaking bonds.

use std::collections::BTreeSet;

use egui::{Color32, Stroke, Ui};
use glam::DVec2;

use super::grabbing::WorldCell;
use crate::sim::Snapshot;

/// Wall-clock time for which the ring of a broken bond is visible, s.
const LASTS_SECS: f64 = 0.4;
/// Radius of the ring around a broken bond, in mean diameters.
const RADIUS: f64 = 0.35;
/// Largest number of grains of a scene in which rings around broken bonds are drawn. With more grains a ring is only a
/// few pixels large.
const MOST_GRAINS: usize = 3_000;

/// Bonds of one simulation that broke recently.
#[derive(Default)]
pub(super) struct BreakingBonds {
    /// Number of initial states loaded so far and simulated time (s), both for the snapshot that was shown last.
    seen: (u64, f64),
    /// Pairs of grains that pulled each other in the snapshot that was shown last.
    pulling: BTreeSet<[u32; 2]>,
    /// Positions of broken bonds, m, each with the wall-clock time at which its ring appeared, s.
    flashes: Vec<(DVec2, f64)>,
}

impl BreakingBonds {
    /// Compares the present snapshot with the snapshot that was shown before. If a pair of grains pulled each other
    /// before and has no contact now, its bond broke. If the present snapshot is earlier or belongs to another run, no
    /// bond counts as broken.
    fn follow(&mut self, run: u64, snapshot: &Snapshot, now_secs: f64) {
        let seen = (run, snapshot.observables.time_secs);
        if seen == self.seen {
            return;
        }
        let touching = |pulls: bool| {
            let contacts = snapshot.contacts.iter();
            let chosen = contacts.filter(move |contact| !pulls || contact.normal_force < 0.0);
            chosen.filter_map(|contact| Some([contact.grain, contact.other_grain?]))
        };
        if self.seen.0 == run && self.seen.1 < seen.1 {
            let present: BTreeSet<_> = touching(false).collect();
            let place =
                |grain: u32| snapshot.grains.get(grain as usize).map(|grain| grain.position);
            for &[one, other] in self.pulling.difference(&present) {
                let Some((one, other)) = place(one).zip(place(other)) else { continue };
                self.flashes.push((0.5 * (one + other), now_secs));
            }
        } else {
            self.flashes.clear();
        }
        self.seen = seen;
        self.pulling = touching(true).collect();
    }

    /// Draws fading rings around the bonds of one simulation that broke recently.
    pub(super) fn show(&mut self, ui: &Ui, run: u64, cell: &WorldCell<'_>, colour: Color32) {
        let snapshot = &cell.frame.snapshot;
        if snapshot.grains.len() > MOST_GRAINS {
            return;
        }
        let now_secs = ui.input(|input| input.time);
        self.follow(run, snapshot, now_secs);
        self.flashes.retain(|(_, since)| now_secs - since < LASTS_SECS);
        if self.flashes.is_empty() {
            return;
        }
        let radius = RADIUS * snapshot.surroundings.mean_diameter;
        for &(place, since) in &self.flashes {
            let left = 1.0 - (now_secs - since) / LASTS_SECS;
            let stroke = Stroke::new(2.0, colour.gamma_multiply(left as f32));
            cell.ring(ui, place, radius, stroke);
        }
        ui.ctx().request_repaint();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;
    use crate::sim::ContactView;

    #[test]
    fn a_bond_flashes_once_when_it_breaks_and_another_run_forgets_it() {
        let scene = Config::default().scene(|_| true).expect("a pile");
        let mut snapshot = scene.simulation().expect("a pile").snapshot();
        let bond = |force| ContactView {
            grain: 3,
            other_grain: Some(5),
            from: DVec2::ZERO,
            to: DVec2::X,
            normal_force: force,
            tangential_force: 0.0,
            gap: 0.0,
        };
        let mut bonds = BreakingBonds::default();
        let mut follow = |run, time_secs, contact: Option<ContactView>| {
            snapshot.contacts = contact.into_iter().collect();
            snapshot.observables.time_secs = time_secs;
            bonds.follow(run, &snapshot, 0.0);
            bonds.flashes.len()
        };
        assert_eq!(follow(1, 0.001, Some(bond(-1.0))), 0);
        assert_eq!(follow(1, 0.002, Some(bond(1.0))), 0, "a bond that pushes is not broken");
        assert_eq!(follow(1, 0.003, None), 0, "and leaves no flash when it ends");
        assert_eq!(follow(1, 0.004, Some(bond(-1.0))), 0);
        assert_eq!(follow(1, 0.005, None), 1);
        assert_eq!(follow(1, 0.005, None), 1, "once");
        assert_eq!(follow(1, 0.004, Some(bond(-1.0))), 0, "an earlier moment");
        assert_eq!(follow(2, 0.005, None), 0, "another run");
    }
}
