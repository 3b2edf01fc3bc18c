//! Two discs on the floor that overlap at the start. Right is to part them without throwing them.

use super::{disc, dry, floor};
use crate::scene::Scene;

/// Two discs, one on the other, each overlapping what is below by `overlap` diameters.
pub fn overlapped(overlap: f64) -> Scene {
    let mut scene = dry("overlap", vec![disc(0.0, 0.5 - overlap), disc(0.0, 1.5 - 2.0 * overlap)]);
    scene.boundaries = vec![floor()];
    scene
}
