//! Initial states of new piles: settled once, kept in memory and on disk, shared by all runs.

use std::collections::HashMap;
use std::path::PathBuf;

use rayon::prelude::*;

use crate::error::Result;
use crate::output::{Progress, check_writable, write_file};
use crate::scene::{Config, Rain, Scene, read_discs, settle, write_discs};
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
        for config in configs.filter(|config| config.origin.makes_new_pile()) {
            let rain = config.origin.rain();
            rains.insert(name(&rain), rain);
        }
        if rains.is_empty() {
            return Ok(Self { settled: HashMap::new() });
        }
        check_writable(&folder)?;
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
                let grains = if path.exists() {
                    read_discs(&path)?
                } else {
                    let grains = settle(&rain, |_| true)?;
                    write_file(
                        &path,
                        write_discs(&grains, "An initial state; metres.").as_bytes(),
                    )?;
                    grains
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
        match self.settled.get(&name(&config.origin.rain())) {
            Some(grains) if config.origin.makes_new_pile() => config.scene_from(grains.clone()),
            _ => config.scene(|_| true),
        }
    }
}

fn name(rain: &Rain) -> String {
    let Rain { grains, box_width_in_diameters, seed } = rain;
    format!("pile_{grains}_width{box_width_in_diameters}_seed{seed}_v{}", env!("CARGO_PKG_VERSION"))
}
