//! Provides the initial states of runs that begin with a newly made pile. The grains of each pile fall and come to rest
//! only once. They are kept in memory and on disk, and all runs share them.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::config::{Config, parse_discs, write_discs};
use crate::error::{Error, Result};
use crate::harness::journal::{checksum, sealed_text, text_of};
use crate::output::{Progress, check_writable, note_line, write_file};
use crate::scene::{Deposition, NewPile, Scene, Settling, settle};
use crate::world::Grain;

pub(super) struct States {
    settled: HashMap<String, Vec<Grain>>,
}

impl States {
    /// Reads the grains at rest of all new piles that `configs` describe from `folder`. Piles that are not in the
    /// folder are made now (their grains fall and come to rest) and are stored in the folder.
    pub(super) fn of<'a>(
        folder: PathBuf,
        configs: impl Iterator<Item = &'a Config>,
    ) -> Result<Self> {
        let mut piles: HashMap<String, NewPile> = HashMap::new();
        let mut looked_at = HashSet::new();
        for config in configs {
            // Each scene file is read only once, even if many configs use it.
            if config.source.makes_new_pile() || looked_at.insert(config.base_scene_key()) {
                piles.extend(config.new_pile()?.map(|pile| (name(&pile), pile)));
            }
        }
        if piles.is_empty() {
            return Ok(Self { settled: HashMap::new() });
        }
        check_writable("out", &folder)?;
        let mut piles: Vec<_> = piles.into_iter().collect();
        piles.sort_by(|(one, a), (other, b)| b.grains.cmp(&a.grains).then(one.cmp(other)));
        let cost = |pile: &NewPile| (pile.grains as u64).pow(2);
        let progress =
            Progress::new("initial states", piles.iter().map(|(_, pile)| cost(pile)).sum());
        let settled = piles
            .into_iter()
            .par_bridge()
            .map(|(name, pile)| {
                let grains = settled_pile(&folder, &pile, |_| true)?;
                progress.advance(cost(&pile));
                Ok((name, grains))
            })
            .collect::<Result<_>>();
        progress.finish();
        Ok(Self { settled: settled? })
    }

    /// Returns the scene that a config describes. If the config asks for a new pile, the scene contains the grains of
    /// that pile at rest.
    pub(super) fn scene(&self, config: &Config) -> Result<Scene> {
        match config.new_pile()?.and_then(|pile| self.settled.get(&name(&pile))) {
            Some(grains) => config.scene_from(grains.clone()),
            None => config.scene(|_| true),
        }
    }
}

/// Returns the grains of a pile at rest. If `folder` contains a file of this pile, the grains are read from the file.
/// Otherwise the grains fall until they are at rest, and the file is written. Numbers in the file are exact to the last
/// bit, so the grains are the same whether they are simulated or read.
///
/// # Errors
/// Returns the errors of [`settle`]. Also fails if the folder cannot be read or written.
pub fn settled_pile(
    folder: &Path,
    pile: &NewPile,
    progress: impl FnMut(Settling) -> bool,
) -> Result<Vec<Grain>> {
    let path = folder.join(format!("{}.csv", name(pile)));
    if let Some(grains) = read(&path)? {
        return Ok(grains);
    }
    let grains = settle(pile, progress)?;
    let text = write_discs(&grains, "An initial state; metres.");
    write_file(&path, sealed_text(&text).as_bytes())?;
    Ok(grains)
}

/// Reads the grains of a pile at rest from a file. Returns `None` if the file is missing or damaged; a damaged file is
/// reported on the terminal.
fn read(path: &Path) -> Result<Option<Vec<Grain>>> {
    let bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(Error::file(path, error)),
    };
    let grains = text_of(&bytes).and_then(|text| parse_discs(text, path).ok());
    if grains.is_none() {
        note_line(format_args!("{}: is damaged; the state is settled anew", path.display()));
    }
    Ok(grains)
}

fn name(pile: &NewPile) -> String {
    let NewPile { grains, box_width_in_diameters, seed, deposition, sizes } = pile;
    let deposited = match deposition {
        Deposition::Rain => "",
        Deposition::DropAndRoll => "_drop-and-roll",
    };
    // A distribution of diameters can be a table of sieves, which is too long for a file name. The name contains a
    // checksum of the distribution instead.
    let sized = match sizes == &NewPile::default().sizes {
        true => String::new(),
        false => format!("_sizes-{}", checksum(sizes.to_string().as_bytes())),
    };
    format!(
        "pile_{grains}_width{box_width_in_diameters}_seed{seed}{deposited}{sized}_v{}",
        env!("CARGO_PKG_VERSION")
    )
}
