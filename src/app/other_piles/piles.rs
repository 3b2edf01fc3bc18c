//! Which piles are the others of one that is open, and their initial states.

use std::path::PathBuf;

use crate::app::taken::Opened;
use crate::config::Config;
use crate::error::Result;
use crate::scene::{NewPile, Scene, built_in};
use crate::sim::Settings;
use crate::world::Grain;

/// Number of other piles.
const COUNT: usize = 8;
/// Larger piles rain for minutes each.
const MOST_GRAINS: usize = 1_000;

/// Where initial states are kept: in the user's cache folder.
pub(super) fn user_folder() -> Option<PathBuf> {
    let folder =
        std::env::var_os("XDG_CACHE_HOME").map(PathBuf::from).filter(|path| path.is_absolute());
    let home = || std::env::home_dir().map(|home| home.join(".cache"));
    Some(folder.or_else(home)?.join("slump").join("piles"))
}

/// The other piles of what is open, with seeds from 1 on but for its own and that of the shipped state; none where
/// it is no pile that was made from a seed, or a large one.
pub(super) fn others_of(opened: &Opened) -> Vec<NewPile> {
    let Some(own) = pile_of(opened).filter(|pile| pile.grains <= MOST_GRAINS) else {
        return Vec::new();
    };
    let chosen = NewPile::default().seed;
    let seeds = (1..).filter(|&seed| seed != own.seed && seed != chosen);
    seeds.take(COUNT).map(|seed| NewPile { seed, ..own.clone() }).collect()
}

/// What the grains of a scene were made of.
fn pile_of(opened: &Opened) -> Option<NewPile> {
    let Opened { config, scene } = opened;
    if config.source.initial.is_some() {
        return None;
    }
    // A saved run goes by the name of its scene alone.
    let is_shipped = || {
        let shipped = built_in(Config::DEFAULT_SCENE).ok()?;
        let places = |scene: &Scene| -> Vec<_> {
            scene.grains.iter().map(|grain| (grain.position, grain.radius)).collect()
        };
        (scene.name == shipped.name && places(scene) == places(&shipped)).then(NewPile::default)
    };
    config.new_pile().ok()?.or_else(is_shipped)
}

/// The scene that is open, with other grains and these settings.
///
/// # Errors
/// Where its file is no longer there.
pub(super) fn scene_of(
    opened: &Opened,
    pile: &NewPile,
    grains: Vec<Grain>,
    settings: &Settings,
) -> Result<Scene> {
    let Config { mut source, .. } = opened.config.clone();
    if opened.config.source.makes_new_pile() || opened.config.new_pile()?.is_none() {
        source.grains = Some(pile.grains);
        source.box_width = Some(pile.box_width_in_diameters);
        source.seed = Some(pile.seed);
        source.deposition = Some(pile.deposition);
    }
    let config = Config { source, ..Config::default() };
    config.with_settings(settings).scene_from(grains)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn opened(config: Config) -> Opened {
        Opened { scene: config.without_settling().unwrap(), config }
    }

    fn seeds(config: Config) -> Vec<u64> {
        others_of(&opened(config)).iter().map(|pile| pile.seed).collect()
    }

    #[test]
    fn others_are_of_other_seeds_and_never_the_one_that_was_chosen() {
        assert_eq!(seeds(Config::default()), [1, 2, 3, 4, 5, 6, 7, 9]);
        let mut config = Config::default();
        config.source.seed = Some(3);
        assert_eq!(seeds(config.clone()), [1, 2, 4, 5, 6, 7, 9, 10]);
        config.source.grains = Some(MOST_GRAINS + 1);
        assert_eq!(seeds(config), [0; 0]);
        assert_eq!(seeds(Config::of_scene("cradle")), [0; 0]);
    }

    #[test]
    fn grains_that_came_from_elsewhere_have_no_others() {
        let mut opened = opened(Config::default());
        opened.scene.grains[0].position.x += 1e-9;
        assert!(others_of(&opened).is_empty());
    }

    #[test]
    fn another_pile_is_the_scene_with_other_grains() {
        let opened = opened(Config::default());
        let mut settings = opened.scene.settings();
        settings.parameters.bond = 33.0;
        let pile = others_of(&opened).remove(0);
        let grains = opened.scene.grains[..100].to_vec();
        let scene = scene_of(&opened, &pile, grains, &settings).unwrap();
        assert_eq!((scene.grains.len(), scene.settings()), (100, settings));
        assert_eq!(scene.duration_secs, opened.scene.duration_secs);
    }
}
