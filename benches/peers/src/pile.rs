//! The cohesionless pile: the same grains, base and parameters as in Slump.

use slump_core::error::Result;
use slump_core::scene::{NewPile, Scene, pile_of, settle};

/// g, m/s².
pub const GRAVITY: f64 = 9.8;
/// σ, kg/m².
pub const AREAL_DENSITY: f64 = 1.0;

/// A disc, m.
#[derive(Clone, Copy, Debug)]
pub struct Disc {
    pub x: f64,
    pub y: f64,
    pub radius: f64,
}

/// The grains and the rough base.
#[derive(Clone, Debug)]
pub struct Pile {
    /// The pile as a Slump scene.
    pub scene: Scene,
    pub grains: Vec<Disc>,
    /// The rough base.
    pub base: Vec<Disc>,
}

impl Pile {
    /// Rains grains into a box and removes its walls.
    pub fn rained(grains: usize, box_width_in_diameters: f64, seed: u64) -> Result<Self> {
        let made_as = NewPile { grains, box_width_in_diameters, seed, ..NewPile::default() };
        let mut scene = pile_of(settle(&made_as, |_| true)?, box_width_in_diameters)?;
        scene.parameters.bond = 0.0;
        let disc = |position: glam::DVec2, radius| Disc { x: position.x, y: position.y, radius };
        let grains = scene.grains.iter().map(|grain| disc(grain.position, grain.radius)).collect();
        let base = scene.fixed_discs.iter().map(|one| disc(one.position, one.radius)).collect();
        Ok(Self { scene, grains, base })
    }

    /// Mean diameter d, m.
    pub fn diameter(&self) -> f64 {
        self.scene.mean_diameter
    }

    /// μ and ρ.
    pub fn friction_and_restitution(&self) -> [f32; 2] {
        [self.scene.parameters.friction as f32, self.scene.parameters.restitution as f32]
    }

    /// Δy_G: the relative drop of the mean height.
    pub fn slump(&self, now: &[[f64; 2]]) -> f64 {
        let before: f64 = self.grains.iter().map(|disc| disc.y).sum();
        (before - now.iter().map(|[_, y]| y).sum::<f64>()) / before
    }

    /// Mean and largest overlap of touching grains, in diameters.
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
