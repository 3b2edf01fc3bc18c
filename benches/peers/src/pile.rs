//! The pile without cohesion: the same grains, base and numbers as in Slump.

use std::error::Error;
use std::path::Path;

use serde::Deserialize;

/// d, m.
pub const DIAMETER: f64 = 5e-3;
/// g, m/s².
pub const GRAVITY: f64 = 9.8;
/// μ.
pub const FRICTION: f32 = 0.5;
/// ρ.
pub const RESTITUTION: f32 = 0.1;
/// σ, kg/m².
pub const AREAL_DENSITY: f64 = 1.0;

/// A disc, m.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Disc {
    pub x: f64,
    pub y: f64,
    pub radius: f64,
}

/// Grains, and what stands still.
#[derive(Clone, Debug)]
pub struct Pile {
    pub grains: Vec<Disc>,
    /// The rough base.
    pub base: Vec<Disc>,
    /// Where walls stand, at ± this x, m.
    pub walls_at: Option<f64>,
}

impl Pile {
    /// Reads the grains that `slump generate` wrote for a box of that width. The base is Slump's.
    pub fn read(path: &Path, box_width: f64, walls: bool) -> Result<Self, Box<dyn Error>> {
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path)?;
        let grains: Vec<Disc> = reader.deserialize().collect::<Result<_, _>>()?;
        let height = grains.iter().map(|disc| disc.y).fold(0.0, f64::max) / DIAMETER;
        let half = (0.5 * (box_width + 10.0 * height)).ceil() as i64;
        let base = (-half..=half)
            .map(|k| Disc { x: k as f64 * DIAMETER, y: 0.0, radius: 0.5 * DIAMETER })
            .collect();
        Ok(Self { grains, base, walls_at: walls.then_some(0.5 * box_width * DIAMETER) })
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
        (sum / f64::from(count.max(1)) / DIAMETER, largest / DIAMETER)
    }
}
