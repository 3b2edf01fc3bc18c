//! Options of pictures, recordings (files of grains and contacts) and saved runs, and the command lines that reproduce
//! output files. These command lines are written into the files.

use std::path::{Path, PathBuf};

use clap::ValueEnum;

use crate::config::{Config, Provenance, asked_time_secs, parser_of, words_of, words_up_to};
use crate::data::{DataSettings, FormatName};
use crate::error::{Error, Result, check};
use crate::film::{VIDEO_RATES_HZ, VIDEO_SIDES, check_ending, check_ffmpeg};
use crate::output::Texts;
use crate::render::{ColourBy, RendererChoice, Style, Theme};
use crate::scene::Scene;
use crate::sim::Snapshot;

/// Width and height of a picture, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PictureSize {
    pub width: u32,
    pub height: u32,
}

impl std::str::FromStr for PictureSize {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let refuse = || Error::value("size", text, "WIDTHxHEIGHT in pixels, both at least 1");
        let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(refuse)?;
        let side = |text: &str| text.trim().parse().ok().filter(|&side| side > 0);
        match (side(width), side(height)) {
            (Some(width), Some(height)) => Ok(Self { width, height }),
            _ => Err(refuse()),
        }
    }
}

/// Overlays: additional marks that pictures show on the grains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Overlay {
    /// Contact forces as lines between the grains
    Forces,
    /// A mark on each grain, which turns with the grain
    Angles,
}

/// Options of pictures, recordings and saved runs.
#[derive(Clone, Debug, Default, PartialEq, clap::Args)]
#[command(next_help_heading = "Pictures")]
pub(crate) struct HeadlessOptions {
    /// Draw pictures without a window; with --frames alone, Figs. 3, 4 and 7 of the paper (Abramian & Staron, 2020)
    #[arg(long)]
    pub headless: bool,
    /// Folder for pictures, observables.csv and manifest.json
    #[arg(long, value_name = "DIR")]
    pub frames: Option<PathBuf>,
    /// Replace files and remove the files of earlier runs; without this option folders with earlier runs are refused
    #[arg(long)]
    pub overwrite: bool,
    /// Size of a picture, pixels [default: 960x540]
    #[arg(long, value_name = "WxH")]
    pub size: Option<String>,
    /// Pictures per simulated second: frame_00000.png and so on [default: 25]
    #[arg(long, value_name = "N", conflicts_with = "times")]
    pub fps: Option<f64>,
    /// Pictures at these simulated times, seconds; the last ends the run unless --duration is given
    #[arg(long, value_name = "T1,T2", value_delimiter = ',', allow_hyphen_values = true)]
    pub times: Vec<f64>,
    /// Also write the pictures as an animation (GIF), 25 per second
    #[arg(long, value_name = "FILE")]
    pub gif: Option<PathBuf>,
    /// Also write the pictures as a video (MP4, by ffmpeg), which shows one simulated second per second unless
    /// --video-speed is given
    #[arg(long, value_name = "FILE", conflicts_with = "times")]
    pub video: Option<PathBuf>,
    /// Simulated seconds per second of video; 0.1 is slow motion by a factor of ten, with 250 pictures per simulated
    /// second unless --fps is given [default: 1]
    #[arg(long, value_name = "N")]
    pub video_speed: Option<f64>,
    /// Overlay on the grains
    #[arg(long, value_name = "WHAT", value_delimiter = ',')]
    pub show: Vec<Overlay>,
    /// Quantity shown by the colours of the grains
    #[arg(long, value_name = "BY", alias = "color")]
    pub colour: Option<ColourBy>,
    /// Values at the two ends of the colour scale: m/s, diameters or N. Pictures are then drawn during the run; without
    /// this option they are drawn at its end, with a scale that fits all of them
    #[arg(
        long,
        value_name = "LOW,HIGH",
        value_delimiter = ',',
        allow_hyphen_values = true,
        alias = "color-scale"
    )]
    pub colour_scale: Vec<f64>,
    /// Contact force of the widest line of --show forces, N; without this option the scale fits all pictures
    #[arg(long, value_name = "N")]
    pub force_scale: Option<f64>,
    /// Colours of the background, and of lines and text
    #[arg(long, value_name = "THEME")]
    pub theme: Option<Theme>,
    /// Renderer: auto tries Vulkan, then OpenGL, then the processor
    #[arg(long, value_name = "KIND", default_value = "auto")]
    pub renderer: RendererChoice,
    /// Continue a saved run; simulated time, slump and picture numbers continue, and other settings on the command line apply from there on (to start a new run from its grains, use --initial)
    #[arg(long, value_name = "FILE", help_heading = "Saved runs")]
    pub restart: Option<PathBuf>,
    /// Save the run to this file at its end, also if a signal ends it, unless its state is no longer finite
    #[arg(long, value_name = "FILE", help_heading = "Saved runs")]
    pub save: Option<PathBuf>,
    /// Save the run every this many simulated seconds as checkpoint.slump in the folder of the frames; the same command continues a stopped run from there (--overwrite starts again)
    #[arg(long, value_name = "SECONDS", help_heading = "Saved runs", requires = "frames")]
    pub checkpoint_every: Option<f64>,
    /// Folder for a recording: all grains and contacts at the times of the pictures, for other programs
    #[arg(long, value_name = "DIR", help_heading = "Data")]
    pub data: Option<PathBuf>,
    /// Simulated time between the frames of the recording, seconds [default: the times of the pictures]
    #[arg(long, value_name = "SECONDS", help_heading = "Data")]
    pub data_every: Option<f64>,
    /// Format of the recording [default: parquet]
    #[arg(
        long,
        value_name = "FORMAT",
        help_heading = "Data",
        value_delimiter = ',',
        value_parser = parser_of::<FormatName>()
    )]
    pub data_format: Vec<FormatName>,
}

const DEFAULT_SIZE: PictureSize = PictureSize { width: 960, height: 540 };
/// Default number of pictures per simulated second.
const DEFAULT_FPS: f64 = 25.0;
/// Largest number of pictures of a run. A larger number is probably a mistake of the user.
const MOST_PICTURES: f64 = 1e5;

impl HeadlessOptions {
    /// True if the command draws pictures of the scene. It does so if it has any option except `--headless`,
    /// `--frames`, `--overwrite` and `--renderer`. With these four alone it draws the figures of Abramian & Staron
    /// (2020).
    pub(super) fn asks_for_frames(&self) -> bool {
        let Self { headless, overwrite, renderer, .. } = *self;
        let frames = self.frames.clone();
        *self != Self { headless, frames, overwrite, renderer, ..Self::default() }
    }

    pub(super) fn draws(&self) -> bool {
        self.frames.is_some() || self.animation().is_some()
    }

    /// Returns the output files that the options name, each with the name of its option.
    pub(super) fn files(&self) -> Vec<(&'static str, &Path)> {
        let files = [("gif", &self.gif), ("video", &self.video), ("save", &self.save)];
        files.into_iter().filter_map(|(option, path)| Some((option, path.as_deref()?))).collect()
    }

    /// Checks that the options ask for at least one output, and that options of pictures are given only with pictures.
    /// `data` are the settings of the recording (files of grains and contacts), if there is one.
    pub(super) fn check_places(&self, data: Option<&DataSettings>) -> Result<()> {
        if self.draws() {
            return Ok(());
        }
        let allowed =
            "a folder (--frames out/), or give --gif FILE, --video FILE, --data DIR or --save FILE";
        check(self.save.is_some() || data.is_some(), "frames", "missing", allowed)?;
        let has_times = data.is_some_and(|data| data.every_secs.is_none());
        let given = [
            ("size", self.size.is_some()),
            ("fps", self.fps.is_some() && !has_times),
            ("show", !self.show.is_empty()),
            ("colour", self.colour.is_some()),
            ("theme", self.theme.is_some()),
        ];
        let allowed = "left out, since no pictures are asked for (--frames, --gif or --video)";
        given.into_iter().try_for_each(|(option, is)| check(!is, option, "given", allowed))
    }

    /// Path of the GIF or video; `None` if the options name no such file.
    pub(super) fn animation(&self) -> Option<&Path> {
        self.gif.as_deref().or(self.video.as_deref())
    }

    pub(crate) fn size(&self) -> Result<PictureSize> {
        self.size.as_ref().map_or(Ok(DEFAULT_SIZE), |text| text.parse())
    }

    pub(crate) fn style(&self) -> Result<Style> {
        let style = Style {
            colour_by: self.colour.unwrap_or_default(),
            theme: self.theme.unwrap_or_default(),
            show_forces: self.show.contains(&Overlay::Forces),
            angles: self.show.contains(&Overlay::Angles),
            force_reference: self.force_scale,
            ..Style::default()
        };
        if let Some(force) = self.force_scale {
            let allowed = "left out where --show forces is not given";
            check(style.show_forces, "force-scale", force, allowed)?;
            let is_sound = force > 0.0 && force.is_finite();
            check(is_sound, "force-scale", force, "a finite force > 0 N")?;
        }
        let range = match self.colour_scale[..] {
            [] => None,
            [low, high] if low < high && (high - low).is_finite() => Some((low, high)),
            _ => {
                let found: Vec<_> = self.colour_scale.iter().map(f64::to_string).collect();
                let allowed = "LOW,HIGH: two finite numbers, the first below the second";
                return Err(Error::value("colour-scale", found.join(","), allowed));
            }
        };
        let allowed = "left out where --colour is not speed, overlap or force";
        check(range.is_none() || style.colour_by.has_scale(), "colour-scale", "given", allowed)?;
        Ok(Style { range, ..style })
    }

    /// Number of pictures per simulated second, used if the options do not list the times of the pictures.
    pub(super) fn pictures_per_sec(&self) -> Result<f64> {
        Ok(self.fps.unwrap_or(DEFAULT_FPS / self.video_speed()?))
    }

    /// Simulated seconds per second of video; 1 if the option is missing.
    fn video_speed(&self) -> Result<f64> {
        let Some(speed) = self.video_speed else { return Ok(1.0) };
        let allowed = "left out where --video is not given";
        check(self.video.is_some(), "video-speed", speed, allowed)?;
        let is_sound = speed > 0.0 && speed.is_finite();
        check(is_sound, "video-speed", speed, "a finite number > 0").map(|()| speed)
    }

    pub(super) fn video_rate_hz(&self) -> Result<f64> {
        if let Some(path) = &self.video {
            check_ending("video", path, "mp4", "--gif makes a GIF")?;
            let PictureSize { width, height } = self.size()?;
            let [least, most] = VIDEO_SIDES;
            let is_side = |side: u32| side.is_multiple_of(2) && (least..=most).contains(&side);
            let allowed =
                format!("even and from {least} to {most} pixels on both sides for a video");
            let is_sound = is_side(width) && is_side(height);
            check(is_sound, "size", format!("{width}x{height}"), allowed)?;
        }
        let speed = self.video_speed()?;
        let rate_hz = self.pictures_per_sec()? * speed;
        let [least, most] = VIDEO_RATES_HZ;
        let Some(path) = &self.video else { return Ok(rate_hz) };
        let found = format!("{} at --video-speed {speed}", self.pictures_per_sec()?);
        let allowed = format!("such that a second of the video has {least} to {most} pictures");
        check((least..=most).contains(&rate_hz), "fps", found, allowed)?;
        check_ffmpeg(path.display()).map(|()| rate_hz)
    }

    /// Returns the times of the pictures of a run that lasts `duration_secs`, s, in ascending order.
    pub(crate) fn picture_times(&self, duration_secs: f64) -> Result<Vec<f64>> {
        if !self.times.is_empty() {
            let allowed = format!("between 0 and the duration of {duration_secs} s");
            for time in &self.times {
                check((0.0..=duration_secs).contains(time), "times", time, &allowed)?;
            }
            let mut times = self.times.clone();
            times.sort_by(f64::total_cmp);
            return Ok(times);
        }
        let fps = self.pictures_per_sec()?;
        let last = (duration_secs * fps * (1.0 + 1e-12)).floor();
        if !(fps > 0.0 && last < MOST_PICTURES) {
            let allowed = format!("> 0, and no more than {MOST_PICTURES} pictures in all");
            // The error names the option that the user gave.
            return Err(match self.fps {
                Some(fps) => Error::value("fps", fps, allowed),
                None => Error::value(
                    "duration",
                    duration_secs,
                    format!("such that its pictures, {fps} a second, are {allowed}"),
                ),
            });
        }
        Ok((0..=last as u64).map(|number| number as f64 / fps).collect())
    }

    /// Returns an error if the interval between checkpoints is not positive and finite.
    pub(super) fn check_checkpoints(&self) -> Result<()> {
        self.checkpoint_every.map_or(Ok(()), |secs| {
            let is_sound = secs > 0.0 && secs.is_finite();
            check(is_sound, "checkpoint-every", secs, "a finite number of seconds > 0")
        })
    }

    /// Returns the folder and settings of the recording of grains and contacts; `None` if neither the options nor the
    /// scene name a folder. Options override the scene.
    pub(super) fn data_settings(&self, scene: &Scene) -> Result<Option<(PathBuf, DataSettings)>> {
        let of_scene = scene.data.clone().unwrap_or_default();
        let given = !self.data_format.is_empty();
        let formats = if given { self.data_format.clone() } else { of_scene.formats };
        let every_secs = self.data_every.or(of_scene.every_secs);
        let settings = DataSettings { folder: None, every_secs, formats };
        settings.validate("data-every")?;
        let folder = self.data.clone().or(of_scene.folder);
        let alone = self.data_every.map(|_| "data-every").or(given.then_some("data-format"));
        match (folder, alone) {
            (None, Some(field)) => Err(Error::value(field, "given", "given with --data DIR")),
            (folder, _) => Ok(folder.map(|folder| (folder, settings))),
        }
    }

    /// Returns the provenance (scene, settings and command-line arguments) of the run that `config` and these options
    /// describe.
    pub(super) fn provenance(&self, config: &Config, scene: &Scene) -> Result<Provenance> {
        let settings = scene.settings();
        let words = match &self.restart {
            None => {
                // A frame does not depend on how long the run continues after it.
                let mut config = config.clone();
                config.source.duration = None;
                config.words(&settings)?
            }
            Some(path) => {
                let file = ["--restart".to_owned(), path.display().to_string()];
                [&file[..], &words_of(&settings, None)].concat()
            }
        };
        Ok(Provenance { scene: scene.name.clone(), settings, words })
    }

    /// Returns the texts (scene, settings, command line) that are written into the file of the picture that shows the
    /// simulated time `time_secs`, s.
    pub(super) fn texts_of_frame(&self, run: &Provenance, time_secs: f64, style: &Style) -> Texts {
        let frames = ["--frames".to_owned(), "frames".to_owned()];
        run.texts(
            Some(time_secs),
            &[words_up_to(time_secs), self.words_of_style(style), frames.into()].concat(),
        )
    }

    /// Returns the texts (scene, settings, command line) that are written into the GIF or video of a run that lasts
    /// `duration_secs`, s. `last_words` are the last arguments of this command line, such as the option that names the
    /// file.
    pub(super) fn texts_of_animation(
        &self,
        run: &Provenance,
        duration_secs: f64,
        style: &Style,
        last_words: &[&str],
    ) -> Texts {
        let mut words = vec!["--duration".to_owned(), duration_secs.to_string()];
        if let Some(fps) = self.fps {
            words.extend(["--fps".to_owned(), fps.to_string()]);
        }
        if !self.times.is_empty() {
            let times: Vec<_> = self.times.iter().map(f64::to_string).collect();
            words = vec!["--times".to_owned(), times.join(",")];
        }
        words.extend(self.words_of_style(style));
        if let Some(speed) = self.video_speed {
            words.extend(["--video-speed".to_owned(), speed.to_string()]);
        }
        words.extend(last_words.iter().map(|&word| word.to_owned()));
        run.texts(None, &words)
    }

    /// Returns the command-line options that reproduce the style of the pictures, including the range of the colours
    /// and the force of the widest line.
    fn words_of_style(&self, style: &Style) -> Vec<String> {
        let named = |value: Option<clap::builder::PossibleValue>| {
            value.map_or_else(String::new, |value| value.get_name().to_owned())
        };
        let mut words = Vec::new();
        let mut say = |name: &str, value: String| words.extend([format!("--{name}"), value]);
        if let Some(size) = &self.size {
            say("size", size.clone());
        }
        let shown: Vec<_> = self.show.iter().map(|what| named(what.to_possible_value())).collect();
        if !shown.is_empty() {
            say("show", shown.join(","));
        }
        if let Some(colour) = self.colour {
            say("colour", named(colour.to_possible_value()));
        }
        if let Some((low, high)) = style.range.filter(|_| style.colour_by.has_scale()) {
            say("colour-scale", format!("{low},{high}"));
        }
        if let Some(force) = style.force_reference.filter(|_| style.show_forces) {
            say("force-scale", force.to_string());
        }
        if let Some(theme) = self.theme {
            say("theme", named(theme.to_possible_value()));
        }
        words
    }
}

/// Returns the texts (scene, settings, command line) that are written into the picture file of one panel of a figure.
/// The panel shows a built-in scene.
pub(super) fn texts_of_panel(scene: &Scene, snapshot: &Snapshot) -> Result<Texts> {
    let settings = scene.settings();
    let words = Config::of_scene(&scene.name).words(&settings)?;
    let time_secs = asked_time_secs(snapshot.observables.time_secs);
    let frames = ["--frames".to_owned(), "frames".to_owned()];
    let run = Provenance { scene: scene.name.clone(), settings, words };
    Ok(run.texts(Some(time_secs), &[words_up_to(time_secs), frames.into()].concat()))
}
