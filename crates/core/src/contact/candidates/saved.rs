//! Candidates that go on as they would have.

use super::Candidates;
use crate::error::{Error, Result};
use crate::world::World;

impl Candidates {
    /// Those that were read from a file, in the world that they are of.
    ///
    /// # Errors
    /// Where they tell of bodies that do not exist.
    pub(crate) fn complete(self, world: &World) -> Result<Self> {
        let Self { reach, way_of_features, way_of_discs, way_of_images, .. } = self;
        let Self { skins, skin_of_features, centres, starts, others, .. } = self;
        let whole = Self {
            way_of_features,
            way_of_discs,
            way_of_images,
            skin_of_features,
            ..Self::new(world, reach)?
        };
        let count = world.grains.len();
        let bodies = whole.radii.len() + whole.features.len();
        let is_list = starts.len() == count + 1
            && starts[0] == 0
            && starts.is_sorted()
            && starts[count] as usize == others.len()
            && centres.len() == whole.radii.len()
            && skins.len() == centres.len();
        if !(is_list || starts.is_empty()) || others.iter().any(|&other| other as usize >= bodies) {
            return Err(Error::value("candidates", "no list", "pairs of bodies of the state"));
        }
        Ok(Self { skins, centres, starts, others, ..whole })
    }
}
