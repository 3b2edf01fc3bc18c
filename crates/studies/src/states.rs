//! Initial states that are new piles: settled once, kept in memory and on disk, and shared by all runs.

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
    /// Reads or makes the initial states of `configs`, which are stored in `folder`.
    pub(super) fn of<'a>(
        folder: PathBuf,
        configs: impl Iterator<Item = &'a Config>,
    ) -> Result<Self> {
        let mut piles: HashMap<String, NewPile> = HashMap::new();
        let mut looked_at = HashSet::new();
        for config in configs {
            // A scene file is read once, whatever the number of its runs.
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

    /// The scene of a config, with its settled grains if it asks for a new pile.
    pub(super) fn scene(&self, config: &Config) -> Result<Scene> {
        match config.new_pile()?.and_then(|pile| self.settled.get(&name(&pile))) {
            Some(grains) => config.scene_from(grains.clone()),
            None => config.scene(|_| true),
        }
    }
}

/// The settled grains of a pile: read from `folder`, or made and then written there. A state reads back bit for bit, so
/// both give the same result.
///
/// # Errors
/// As [`settle`], and if the folder cannot be read or written.
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

/// The grains in a file; `None` if the file is missing, or damaged, which is reported.
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
    // Tables of sieves are too long for a name.
    let sized = match sizes == &NewPile::default().sizes {
        true => String::new(),
        false => format!("_sizes-{}", checksum(sizes.to_string().as_bytes())),
    };
    format!(
        "pile_{grains}_width{box_width_in_diameters}_seed{seed}{deposited}{sized}_v{}",
        env!("CARGO_PKG_VERSION")
    )
}
