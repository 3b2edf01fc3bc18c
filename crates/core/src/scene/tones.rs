//! Grey levels with which pictures show the grains of a pile.

use crate::world::Grain;

/// Height of one layer of a pile in pictures, in diameters. Neighbouring layers have different grey levels.
const LAYER_IN_DIAMETERS: f64 = 2.0;
/// Grey levels of the layers of a pile, in turn from the bottom: 0 is black, 255 is white.
const LAYER_TONES: [u8; 2] = [222, 168];

/// Sets the grey levels of grains by their initial layer, so that a picture shows how far each layer has moved.
/// `diameter` is the mean diameter, m.
pub(crate) fn tone_in_layers(grains: &mut [Grain], diameter: f64) {
    for grain in grains {
        let layer = (grain.position.y / (LAYER_IN_DIAMETERS * diameter)).floor() as i64;
        grain.tone = LAYER_TONES[layer.rem_euclid(LAYER_TONES.len() as i64) as usize];
    }
}
