//! Recordings of runs without a window.

use std::path::{Path, PathBuf};

use crate::config::{parser_of, scene_facts};
use crate::data::{DataSettings, FormatName, Recording, RecordingFolder, Times, formats_of};
use crate::error::{Error, Result};
use crate::output::counted;
use crate::scene::Scene;
use crate::sim::Simulation;

/// Options of recordings.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct DataOptions {
    /// Folder for a recording: all grains and contacts at the times of the pictures, for other programs
    #[arg(long, value_name = "DIR", help_heading = "Data", requires = "headless")]
    pub data: Option<PathBuf>,
    /// Simulated time between its moments, seconds [default: the times of the pictures]
    #[arg(
        long,
        value_name = "SECONDS",
        help_heading = "Data",
        requires = "headless",
        allow_negative_numbers = true
    )]
    pub data_every: Option<f64>,
    /// What it is written as [default: parquet]
    #[arg(
        long,
        value_name = "FORMAT",
        help_heading = "Data",
        requires = "headless",
        value_delimiter = ',',
        value_parser = parser_of::<FormatName>()
    )]
    pub data_format: Vec<FormatName>,
}

impl DataOptions {
    /// What is asked for by these and by the scene; these go first. Nothing where neither names a folder.
    ///
    /// # Errors
    /// Names what is outside its range.
    pub(super) fn settings(&self, scene: &Scene) -> Result<Option<(PathBuf, DataSettings)>> {
        let of_scene = scene.data.clone().unwrap_or_default();
        let formats =
            if self.data_format.is_empty() { of_scene.formats } else { self.data_format.clone() };
        let every_secs = self.data_every.or(of_scene.every_secs);
        let settings = DataSettings { folder: None, every_secs, formats };
        settings.validate("data-every")?;
        let folder = self.data.clone().or(of_scene.folder);
        if folder.is_none()
            && let Some(field) = self.without_folder()
        {
            return Err(Error::value(field, "given", "given with --data DIR"));
        }
        Ok(folder.map(|folder| (folder, settings)))
    }

    fn without_folder(&self) -> Option<&'static str> {
        let every = self.data_every.map(|_| "data-every");
        every.or((!self.data_format.is_empty()).then_some("data-format"))
    }
}

/// A recording that is to be.
pub(super) struct RecordingPlan {
    /// A folder of its own; none where a run goes on with the recording that it has.
    claim: Option<RecordingFolder>,
    folder: PathBuf,
    settings: DataSettings,
}

impl RecordingPlan {
    /// Takes the folder of a recording that is asked for, unless a run `goes_on` with what is there.
    ///
    /// # Errors
    /// Names what is wrong with the folder.
    pub(super) fn claim(
        (folder, settings): (PathBuf, DataSettings),
        overwrite: bool,
        goes_on: bool,
    ) -> Result<Self> {
        let claim = (!goes_on).then(|| RecordingFolder::of(&folder, overwrite)).transpose()?;
        Ok(Self { claim, folder, settings })
    }

    /// Starts it, or goes on with it, at the present state of a run.
    ///
    /// # Errors
    /// Where the folder cannot be written to.
    pub(super) fn start(
        self,
        scene: &Scene,
        simulation: &Simulation,
        picture_times: &[f64],
    ) -> Result<Recording> {
        let mut about = scene_facts(scene)?;
        let words = std::env::args_os().map(|word| word.to_string_lossy().into_owned());
        let command = words.collect::<Vec<_>>().join(" ").replace(char::is_control, " ");
        about.facts.insert(1, ("command".to_owned(), command));
        let times = match self.settings.every_secs {
            Some(secs) => Times::Every(secs),
            None => Times::At(picture_times.to_vec()),
        };
        let formats = formats_of(&self.settings)?;
        let step = simulation.observables().step;
        let recording = match self.claim {
            Some(claim) => Recording::start_in(claim, &formats, &about)?,
            None => Recording::go_on(&self.folder, &formats, &about, step)?,
        };
        Ok(recording.at(times, simulation))
    }
}

/// Where a finished recording is, and how many frames it has, in words.
pub(crate) fn told(folder: &Path, frames: u64) -> String {
    format!("{} of data in {}", counted(frames, "frame"), folder.display())
}
