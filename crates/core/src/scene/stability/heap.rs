//! A heap with slopes of 60° over a rough base: each disc lies in the notch of two below it, and
//! what presses on an edge disc from above passes straight on to the one below, so the heap stands
//! even without friction.

use glam::DVec2;

use super::{DIAMETER, TOUCH, disc, dry};
use crate::scene::{Scene, View, rough_base};

/// Where the falling disc starts, from the place of the highest, in diameters.
const FALLING: [f64; 2] = [0.3, 1.5];

/// A heap of `rows` rows, the lowest of `rows` discs.
pub fn heap(rows: usize) -> Scene {
    let height = 0.75f64.sqrt() * (1.0 - 3.0 * TOUCH);
    let mut grains = Vec::new();
    for row in 0..rows {
        let count = rows - row;
        let left = -0.5 * (count as f64 - 1.0);
        // The discs of the lowest row lie between those of the base.
        let shift = if rows.is_multiple_of(2) { 0.0 } else { 0.5 };
        for column in 0..count {
            let x = (left + column as f64 + shift) * (1.0 - TOUCH);
            grains.push(disc(x, (row as f64 + 1.0) * height));
        }
    }
    let mut scene = dry("repose", grains);
    let width = rows as f64 + 6.0;
    scene.fixed_discs = rough_base(width, DIAMETER);
    for disc in &mut scene.fixed_discs {
        disc.position.x *= 1.0 - TOUCH;
    }
    scene.view = Some(View {
        min: DIAMETER * DVec2::new(-0.5 * width, -1.0),
        max: DIAMETER * DVec2::new(0.5 * width, rows as f64 + 1.0),
    });
    scene
}

/// The largest heap of at most `count` discs, for `count` ≥ 1.
pub fn heap_of(count: usize) -> Scene {
    let rows = (1..).take_while(|rows| rows * (rows + 1) / 2 <= count).count();
    Scene { name: "size".into(), ..heap(rows) }
}

/// The same heap with one disc more that falls on its slope, `distance` diameters from the origin along both axes.
pub fn heap_far_away(rows: usize, distance: f64) -> Scene {
    let mut scene = heap(rows);
    scene.name = "far".into();
    scene.grains.push(disc(FALLING[0], rows as f64 * 0.75f64.sqrt() + FALLING[1]));
    let shift = DVec2::splat(distance * DIAMETER);
    scene.grains.iter_mut().for_each(|grain| grain.position += shift);
    scene.fixed_discs.iter_mut().for_each(|disc| disc.position += shift);
    if let Some(view) = &mut scene.view {
        view.min += shift;
        view.max += shift;
    }
    scene
}
