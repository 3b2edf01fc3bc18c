//! Videos and animations of what the window has computed: all of it is computed once more, bit for bit, by a thread
//! of its own, and drawn at equal times.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::mpsc::Receiver;

use image::RgbaImage;

use super::export::{ScenePicture, free_path};
use super::opening::TakenRun;
use super::work::{Reporter, Work};
use crate::error::Result;
use crate::film::{Animation, Video};
use crate::headless::WaitingStates;
use crate::output::{Texts, check_writable, counted};
use crate::render::{Renderer, RendererChoice, Style, speed_reference};
use crate::sim::{Simulation, Snapshot};

/// What the record is made into.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum FilmFormat {
    /// MP4.
    Video,
    /// An animation that repeats, with at most 256 colours a picture.
    Gif,
}

impl FilmFormat {
    /// What it is called.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Video => "video",
            Self::Gif => "GIF",
        }
    }

    /// How names of its files end.
    pub(super) fn ending(self) -> &'static str {
        match self {
            Self::Video => "mp4",
            Self::Gif => "gif",
        }
    }

    /// Pictures a second that it can have, nearest to so many.
    pub(crate) fn nearest_rate_hz(self, rate_hz: f64) -> f64 {
        match self {
            Self::Video => rate_hz,
            Self::Gif => Animation::nearest_rate_hz(rate_hz),
        }
    }

    /// A size (px) that it can have, nearest above.
    pub(crate) fn size(self, size: [u32; 2]) -> [u32; 2] {
        match self {
            Self::Video => size.map(|side| side.next_multiple_of(2)),
            Self::Gif => size,
        }
    }

    /// Starts a file of so many pictures a second.
    pub(super) fn start(self, path: &Path, rate_hz: f64) -> Result<FilmFile> {
        Ok(match self {
            Self::Video => FilmFile::Video(Box::new(Video::start(path, rate_hz)?)),
            Self::Gif => FilmFile::Gif(Animation::start(path, rate_hz)?),
        })
    }
}

/// A file that is being made, and is there once it is finished.
pub(super) enum FilmFile {
    Video(Box<Video>),
    Gif(Animation),
}

impl FilmFile {
    /// Adds a picture; `texts` is what the file says of itself.
    pub(super) fn add(&mut self, image: RgbaImage, texts: &Texts) -> Result<()> {
        match self {
            Self::Video(video) => video.add(&image, texts),
            Self::Gif(gif) => gif.add(image, texts),
        }
    }

    /// Ends it and gives it its name. Whether there is one: none has no picture.
    pub(super) fn finish(self) -> Result<bool> {
        match self {
            Self::Video(video) => video.finish(),
            Self::Gif(gif) => gif.finish(),
        }
    }
}

/// Computing the moments is this part of the work, and drawing and encoding them is the rest.
const PART_OF_MOMENTS: f64 = 0.3;
/// More pictures than this are a mistake rather than a wish.
const MOST_PICTURES: f64 = 1e5;

/// What a video or an animation is to show.
pub(crate) struct FilmOrder {
    /// What it is to be.
    pub format: FilmFormat,
    /// How all pictures look; its moments are those of the present.
    pub picture: ScenePicture,
    /// Whether slump tells anything of the scene.
    pub slumps: bool,
    /// Pictures a second, as many as the format can have.
    pub rate_hz: f64,
    /// Simulated seconds in a second.
    pub speed: f64,
    /// First and last simulated time, s; all that is recorded where none are given.
    pub stretch: Option<[f64; 2]>,
    /// Where it goes.
    pub folder: PathBuf,
    /// How its name begins.
    pub stem: String,
}

impl FilmOrder {
    /// Starts one of runs that are on their way, one a world.
    pub(crate) fn start(self, context: &egui::Context, runs: Vec<Receiver<TakenRun>>) -> Work {
        Work::start(context, move |reporter| {
            let stopped = format!("Stopped: there is no {}", self.format.name());
            let mut taken = Vec::new();
            for run in &runs {
                let Some(run) = reporter.wait_for(run)? else { return Ok(stopped) };
                taken.push(run);
            }
            let made = self.write(&taken, reporter)?;
            Ok(made.map_or(stopped, |(path, pictures)| told(&path, pictures)))
        })
    }

    /// The file and how many pictures it has; nothing where it was given up.
    fn write(self, runs: &[TakenRun], reporter: &Reporter) -> Result<Option<(PathBuf, usize)>> {
        check_writable("folder", &self.folder)?;
        let times = self.times(runs)?;
        let Some(mut moments) = self.moments(runs, &times, reporter)? else { return Ok(None) };
        let mut style = self.picture.style.clone();
        moments.set_scales(&mut style);
        let path = free_path(&self.folder, &self.stem, self.format.ending());
        let mut film = self.format.start(&path, self.rate_hz)?;
        let mut renderer = Renderer::new(RendererChoice::Auto)?;
        let (count, slumps) = (times.len(), self.slumps);
        let mut picture = ScenePicture { style, ..self.picture };
        for number in 0..count {
            let done = number as f64 / count as f64;
            if reporter.tell(PART_OF_MOMENTS + (1.0 - PART_OF_MOMENTS) * done).is_break() {
                return Ok(None);
            }
            for (index, world) in picture.worlds.iter_mut().enumerate() {
                world.snapshot = moments.get(index, number)?.into();
                world.note = slump(&world.snapshot, slumps);
            }
            film.add(picture.draw(&mut renderer)?, &picture.texts)?;
        }
        film.finish()?;
        Ok(Some((path, count)))
    }

    /// The simulated times of the pictures, s.
    fn times(&self, runs: &[TakenRun]) -> Result<Vec<f64>> {
        let records = || runs.iter().map(|run| &run.world.record);
        let first =
            records().map(|record| record.start().time_secs()).fold(f64::INFINITY, f64::min);
        let last = records().map(|record| record.end_secs()).fold(first, f64::max);
        let [from, until] = self.stretch.unwrap_or([first, last]);
        let each = self.speed / self.rate_hz;
        let count = ((until.min(last) - from.max(first)) / each * (1.0 + 1e-12)).floor();
        if !(0.0..MOST_PICTURES).contains(&count) {
            let found =
                format!("{} s at {} pictures a second", until - from, self.rate_hz / self.speed);
            let allowed = format!("one picture at least and no more than {MOST_PICTURES}");
            return Err(crate::error::Error::value(self.format.name(), found, allowed));
        }
        Ok((0..=count as u64).map(|number| from.max(first) + number as f64 * each).collect())
    }

    /// Computes what is to be shown; nothing where it is given up.
    fn moments(
        &self,
        runs: &[TakenRun],
        times: &[f64],
        reporter: &Reporter,
    ) -> Result<Option<Moments>> {
        let mut moments = Moments::start(&self.folder, &self.picture.style)?;
        let [from, until] = [times[0], times[times.len() - 1]];
        let span = (until - from).max(f64::MIN_POSITIVE);
        for (world, run) in runs.iter().enumerate() {
            moments.begin_world();
            let mut due = times.iter().peekable();
            let ended = run.world.record.replay([from, until], |simulation, is_within| {
                let part = ((simulation.time_secs() - from) / span).clamp(0.0, 1.0);
                let done = (world as f64 + part) / runs.len() as f64;
                if reporter.tell(PART_OF_MOMENTS * done).is_break() {
                    return Ok(ControlFlow::Break(()));
                }
                if is_within && due.next_if(|&&time| is_nearest(simulation, time)).is_some() {
                    moments.add(simulation.snapshot())?;
                    // Pictures may follow each other faster than steps.
                    while due.next_if(|&&time| is_nearest(simulation, time)).is_some() {
                        moments.add_again();
                    }
                }
                Ok(ControlFlow::Continue(()))
            })?;
            if matches!(ended, crate::sim::RunEnding::Stopped) {
                return Ok(None);
            }
        }
        Ok(Some(moments))
    }
}

/// Whether a run has come to a time, or no later step comes nearer to it.
fn is_nearest(simulation: &Simulation, time_secs: f64) -> bool {
    let half_a_step = 0.5 * simulation.settings().parameters.time_step_secs;
    simulation.time_secs() + half_a_step > time_secs
}

fn told(path: &Path, pictures: usize) -> String {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    format!("Saved {} of {}", whole.display(), counted(pictures as u64, "picture"))
}

/// What stands below a world that is compared.
fn slump(snapshot: &Snapshot, slumps: bool) -> String {
    if slumps { format!("Δy {:.3}", snapshot.observables.slump) } else { String::new() }
}

/// The moments that a film shows, on disk: all of them have one scale of colours, and that is known at the end.
struct Moments {
    kept: WaitingStates,
    style: Style,
    /// For each world, which of the states each picture shows.
    shown: Vec<Vec<usize>>,
    speed_reference: f64,
}

impl Moments {
    fn start(folder: &Path, style: &Style) -> Result<Self> {
        let kept = WaitingStates::start(folder)?;
        Ok(Self { kept, style: style.clone(), shown: Vec::new(), speed_reference: 0.0 })
    }

    fn begin_world(&mut self) {
        self.shown.push(Vec::new());
    }

    fn add(&mut self, snapshot: Snapshot) -> Result<()> {
        self.speed_reference = self.speed_reference.max(speed_reference(&self.style, &snapshot));
        let number = self.kept.len();
        self.kept.add(&self.style, number, snapshot)?;
        self.add_again();
        Ok(())
    }

    /// The state that was added last shows in the next picture, too.
    fn add_again(&mut self) {
        let last = self.kept.len().saturating_sub(1);
        if let Some(shown) = self.shown.last_mut() {
            shown.push(last);
        }
    }

    fn set_scales(&self, style: &mut Style) {
        self.kept.set_scale(style);
        let fastest = Some(self.speed_reference).filter(|&fastest| fastest > 0.0);
        style.speed_reference = style.speed_reference.or(fastest);
    }

    /// What a picture shows of a world; of one that ended before, its last moment.
    fn get(&mut self, world: usize, picture: usize) -> Result<Snapshot> {
        let shown = &self.shown[world];
        let index = shown.get(picture).or(shown.last()).copied().unwrap_or(0);
        Ok(self.kept.get(index)?.1)
    }
}
