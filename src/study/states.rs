//! Initial states that are rained: settled once, kept in memory and on disk, shared by all runs.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::record;
use crate::error::{Error, Result};
use crate::output::{Progress, check_writable, note_line, write_file};
use crate::scene::{Config, Rain, Scene, parse_discs, settle, write_discs};
use crate::world::Grain;

/// Settled grains by the rain they come from.
pub(super) struct States {
    settled: HashMap<String, Vec<Grain>>,
}

impl States {
    /// Reads or makes the states that `configs` start from. They are kept in `folder`.
    ///
    /// # Errors
    /// Where a state does not settle, or the folder cannot be written.
    pub(super) fn of<'a>(
        folder: PathBuf,
        configs: impl Iterator<Item = &'a Config>,
    ) -> Result<Self> {
        let mut rains: HashMap<String, Rain> = HashMap::new();
        let mut looked_at = HashSet::new();
        for config in configs {
            // A scene file is read once, whatever the number of its runs.
            if config.origin.makes_new_pile() || looked_at.insert(config.name_of_ground()) {
                rains.extend(config.rain()?.map(|rain| (name(&rain), rain)));
            }
        }
        if rains.is_empty() {
            return Ok(Self { settled: HashMap::new() });
        }
        check_writable("out", &folder)?;
        let mut rains: Vec<_> = rains.into_iter().collect();
        rains.sort_by(|(one, a), (other, b)| b.grains.cmp(&a.grains).then(one.cmp(other)));
        let cost = |rain: &Rain| (rain.grains as u64).pow(2);
        let progress =
            Progress::new("initial states", rains.iter().map(|(_, rain)| cost(rain)).sum());
        let settled = rains
            .into_iter()
            .par_bridge()
            .map(|(name, rain)| {
                let path = folder.join(format!("{name}.csv"));
                // A state reads back bit for bit, so that it does not matter which way it came.
                let grains = match kept(&path)? {
                    Some(grains) => grains,
                    None => {
                        let grains = settle(&rain, |_| true)?;
                        let text = write_discs(&grains, "An initial state; metres.");
                        write_file(&path, record::sealed_text(&text).as_bytes())?;
                        grains
                    }
                };
                progress.advance(cost(&rain));
                Ok((name, grains))
            })
            .collect::<Result<_>>();
        progress.finish();
        Ok(Self { settled: settled? })
    }

    /// The scene of a config, with its settled grains where it makes a new pile.
    pub(super) fn scene(&self, config: &Config) -> Result<Scene> {
        match config.rain()?.and_then(|rain| self.settled.get(&name(&rain))) {
            Some(grains) => config.scene_from(grains.clone()),
            None => config.scene(|_| true),
        }
    }
}

/// The grains that a file holds; nothing where it is not there, or damaged, which is told of.
fn kept(path: &Path) -> Result<Option<Vec<Grain>>> {
    let bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(Error::file(path, error)),
    };
    let grains = record::of_text(&bytes).and_then(|text| parse_discs(text, path).ok());
    if grains.is_none() {
        note_line(format_args!("{}: is damaged; the state is settled anew", path.display()));
    }
    Ok(grains)
}

fn name(rain: &Rain) -> String {
    let Rain { grains, box_width_in_diameters, seed } = rain;
    format!("pile_{grains}_width{box_width_in_diameters}_seed{seed}_v{}", env!("CARGO_PKG_VERSION"))
}
