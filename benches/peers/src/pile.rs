//! The cohesionless pile for all engines: the grains, base and parameters of Slump's pile.

use slump_core::error::Result;
use slump_core::scene::{NewPile, Scene, pile_of, settle};

/// Gravitational acceleration g, m/s².
pub const GRAVITY: f64 = 9.8;
/// Areal density σ of the discs, kg/m².
pub const AREAL_DENSITY: f64 = 1.0;

/// A disc with the centre (x, y) and its radius, m.
#[derive(Clone, Copy, Debug)]
pub struct Disc {
    pub x: f64,
    pub y: f64,
    pub radius: f64,
}

/// A pile: its grains and its rough base.
#[derive(Clone, Debug)]
pub struct Pile {
    /// The pile as a Slump scene.
    pub scene: Scene,
    pub grains: Vec<Disc>,
    /// Fixed discs of the rough base.
    pub base: Vec<Disc>,
}

impl Pile {
    /// Makes a pile: rains grains into a box, lets them come to rest, and removes the walls of the box.
    pub fn rained(grains: usize, box_width_in_diameters: f64, seed: u64) -> Result<Self> {
        let made_as = NewPile { grains, box_width_in_diameters, seed, ..NewPile::default() };
        let mut scene = pile_of(settle(&made_as, |_| true)?, box_width_in_diameters)?;
        scene.parameters.bond = 0.0;
        // The other engines bounce at every speed, too.
        scene.parameters.restitution_threshold = 0.0;
        let disc = |position: glam::DVec2, radius| Disc { x: position.x, y: position.y, radius };
        let grains = scene.grains.iter().map(|grain| disc(grain.position, grain.radius)).collect();
        let base = scene.fixed_discs.iter().map(|one| disc(one.position, one.radius)).collect();
        Ok(Self { scene, grains, base })
    }

    /// Returns the pile with its grains in reversed order.
    pub fn reversed(&self) -> Self {
        let mut pile = self.clone();
        pile.grains.reverse();
        pile
    }

    /// Returns the mean diameter d, m.
    pub fn diameter(&self) -> f64 {
        self.scene.mean_diameter
    }

    /// Returns the friction coefficient μ and the restitution ρ.
    pub fn friction_and_restitution(&self) -> [f32; 2] {
        [self.scene.parameters.friction as f32, self.scene.parameters.restitution as f32]
    }

    /// Returns the slump Δy_G: the drop of the mean height, divided by the initial mean height.
    pub fn slump(&self, now: &[[f64; 2]]) -> f64 {
        let before: f64 = self.grains.iter().map(|disc| disc.y).sum();
        (before - now.iter().map(|[_, y]| y).sum::<f64>()) / before
    }

    /// Returns the mean and the largest overlap of touching grains, in mean diameters.
    pub fn overlaps(&self, now: &[[f64; 2]]) -> (f64, f64) {
        let reach = 2.0 * self.grains.iter().map(|disc| disc.radius).fold(0.0, f64::max);
        let mut order: Vec<usize> = (0..now.len()).collect();
        order.sort_by(|&i, &j| now[i][0].total_cmp(&now[j][0]));
        let (mut sum, mut largest, mut count) = (0.0, 0f64, 0);
        for (place, &i) in order.iter().enumerate() {
            for &j in &order[place + 1..] {
                let (dx, dy) = (now[j][0] - now[i][0], now[j][1] - now[i][1]);
                if dx > reach {
                    break;
                }
                let overlap = self.grains[i].radius + self.grains[j].radius - dx.hypot(dy);
                if overlap > 0.0 {
                    sum += overlap;
                    largest = largest.max(overlap);
                    count += 1;
                }
            }
        }
        (sum / f64::from(count.max(1)) / self.diameter(), largest / self.diameter())
    }
}
