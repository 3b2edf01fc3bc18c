//! Videos and GIF animations of a recorded run. A separate thread computes the run again, to bitwise identical states,
//! and draws it at equal intervals of simulated time.

use std::ops::ControlFlow;
use std::path::PathBuf;

use super::file_names::free_path;
use super::number_text::slump_text;
use super::scene_picture::ScenePicture;
use super::watched_run::TakenRun;
use super::work::Reporter;
use crate::error::{Result, check};
use crate::film::{Animation, Video};
use crate::headless::WaitingStates;
use crate::number::millis_text;
use crate::output::{check_writable, counted};
use crate::render::{Renderer, RendererChoice, speed_reference};
use crate::sim::{RunEnding, Settings, Simulation};

/// File format of an exported film.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum FilmFormat {
    /// An MP4 video.
    Video,
    /// A GIF animation, which repeats and has at most 256 colours per picture.
    Gif,
}

impl FilmFormat {
    /// Name of the format in messages.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Video => "video",
            Self::Gif => "GIF",
        }
    }
}

/// Part of a film's progress bar, 0 to 1, that shows the computation of its states. The rest of the bar shows the
/// drawing and encoding of its pictures.
const PART_OF_MOMENTS: f64 = 0.3;
/// Largest number of pictures in a film. A larger number is probably a mistake of the user.
const MOST_PICTURES: f64 = 1e5;

/// For each simulation and each picture of a film: the index of the stored state that the picture shows, and the
/// settings of the simulation at that time.
type Moments = Vec<Vec<(usize, Settings)>>;

/// A request to export a video or an animation.
pub(crate) struct FilmOrder {
    pub format: FilmFormat,
    /// The picture from which all pictures of the film are made. For each picture of the film, the states of its
    /// simulations are replaced; their arrangement and the drawing style stay.
    pub picture: ScenePicture,
    pub slumps: bool,
    /// Pictures per second of the film. The file format must be able to express this rate.
    pub rate_hz: f64,
    /// Simulated seconds per second of the film.
    pub speed: f64,
    /// First and last simulated time of the film, s; `None` for the whole run as computed so far.
    pub stretch: Option<[f64; 2]>,
    pub folder: PathBuf,
    pub stem: String,
}

impl FilmOrder {
    /// Makes the film from copies of the runs, one per simulation, and returns a message for the user. If the user
    /// cancelled before the solver's thread had sent all copies, no film is made.
    pub(crate) fn make(self, runs: &[TakenRun], reporter: &Reporter) -> Result<String> {
        let (format, count) = (self.format, self.picture.worlds.len());
        let made = if runs.len() == count { self.write(runs, reporter)? } else { None };
        let Some((path, pictures)) = made else {
            return Ok(format!("Stopped: no {} is saved", format.name()));
        };
        let whole = std::path::absolute(&path).unwrap_or(path);
        Ok(format!("Saved {} of {}", whole.display(), counted(pictures as u64, "picture")))
    }

    /// Writes the film. Returns the path of the file and its number of pictures, or `None` if the user cancels.
    fn write(self, runs: &[TakenRun], reporter: &Reporter) -> Result<Option<(PathBuf, usize)>> {
        check_writable("folder", &self.folder)?;
        let times = self.times(runs)?;
        // The states wait in a file, because all pictures have the same colour scale, which is known only after all
        // states are computed.
        let mut states = WaitingStates::start(&self.folder)?;
        let Some((shown, fastest)) = self.moments(runs, &times, &mut states, reporter)? else {
            return Ok(None);
        };
        let (format, mut picture, count) = (self.format, self.picture, times.len());
        states.set_scale(&mut picture.style);
        let fastest = Some(fastest).filter(|&fastest| fastest > 0.0);
        picture.style.speed_reference = picture.style.speed_reference.or(fastest);
        let ending = if format == FilmFormat::Video { "mp4" } else { "gif" };
        let path = free_path(&self.folder, &self.stem, ending);
        let start_video = || Video::start(&path, self.rate_hz);
        let start_gif = || Animation::start(&path, self.rate_hz);
        let mut video = (format == FilmFormat::Video).then(start_video).transpose()?;
        let mut gif = (format == FilmFormat::Gif).then(start_gif).transpose()?;
        let mut renderer = Renderer::new(RendererChoice::Auto)?;
        for number in 0..count {
            let done = number as f64 / count as f64;
            if reporter.tell(PART_OF_MOMENTS + (1.0 - PART_OF_MOMENTS) * done).is_break() {
                return Ok(None);
            }
            for (world, shown) in picture.worlds.iter_mut().zip(&shown) {
                // A world that has already ended shows its last state.
                let moment = shown.get(number).or(shown.last()).copied();
                let (index, settings) = moment.unwrap_or((0, world.settings));
                world.settings = settings;
                let snapshot = states.get(index)?.1;
                let slump = snapshot.observables.slump;
                world.note = if self.slumps { slump_text(slump) } else { String::new() };
                world.snapshot = snapshot.into();
            }
            let image = picture.draw(&mut renderer)?;
            video.as_mut().map_or(Ok(()), |video| video.add(&image, &picture.texts))?;
            gif.as_mut().map_or(Ok(()), |gif| gif.add(image, &picture.texts))?;
        }
        video.map_or(Ok(true), Video::finish)?;
        gif.map_or(Ok(true), Animation::finish)?;
        Ok(Some((path, count)))
    }

    /// Returns the simulated times of the pictures, s, which are equally spaced.
    fn times(&self, runs: &[TakenRun]) -> Result<Vec<f64>> {
        let records = || runs.iter().map(|run| &run.world.record);
        let first =
            records().map(|record| record.start().time_secs()).fold(f64::INFINITY, f64::min);
        let last = records().map(|record| record.end_secs()).fold(first, f64::max);
        let [from, until] = self.stretch.unwrap_or([first, last]);
        let each = self.speed / self.rate_hz;
        let count = ((until.min(last) - from.max(first)) / each * (1.0 + 1e-12)).floor();
        let rate_per_ms = 1e-3 * self.rate_hz / self.speed;
        let found = format!("{} at {rate_per_ms} pictures per ms", millis_text(until - from));
        let allowed = format!("at least one picture and at most {MOST_PICTURES}");
        check((0.0..MOST_PICTURES).contains(&count), self.format.name(), found, allowed)?;
        Ok((0..=count as u64).map(|number| from.max(first) + number as f64 * each).collect())
    }

    /// Computes the runs again and adds the states that the film shows to the store `states`. Returns which of these
    /// states each picture shows, and the largest reference speed of these states, m/s (the speed whose velocity arrow
    /// has the full length). Returns `None` if the user cancels.
    fn moments(
        &self,
        runs: &[TakenRun],
        times: &[f64],
        states: &mut WaitingStates,
        reporter: &Reporter,
    ) -> Result<Option<(Moments, f64)>> {
        let style = &self.picture.style;
        let [from, until] = [times[0], times[times.len() - 1]];
        let span = (until - from).max(f64::MIN_POSITIVE);
        let (mut shown, mut fastest) = (vec![Vec::new(); runs.len()], 0.0f64);
        for (world, run) in runs.iter().enumerate() {
            let mut due = times.iter().peekable();
            let ended = run.world.record.replay([from, until], |simulation, is_within| {
                let part = ((simulation.time_secs() - from) / span).clamp(0.0, 1.0);
                let done = (world as f64 + part) / runs.len() as f64;
                if reporter.tell(PART_OF_MOMENTS * done).is_break() {
                    return Ok(ControlFlow::Break(()));
                }
                if is_within && due.peek().is_some_and(|time| is_nearest(simulation, **time)) {
                    let snapshot = simulation.snapshot();
                    fastest = fastest.max(speed_reference(style, &snapshot));
                    let index = states.len();
                    states.add(style, index, snapshot)?;
                    // The interval between pictures can be shorter than a step, so several pictures can show the same
                    // state.
                    while due.next_if(|&&time| is_nearest(simulation, time)).is_some() {
                        shown[world].push((index, *simulation.settings()));
                    }
                }
                Ok(ControlFlow::Continue(()))
            })?;
            if matches!(ended, RunEnding::Stopped) {
                return Ok(None);
            }
        }
        Ok(Some((shown, fastest)))
    }
}

/// True if the present state is at most half a step before the simulated time `time_secs`, so that no later state is
/// nearer to that time.
fn is_nearest(simulation: &Simulation, time_secs: f64) -> bool {
    let half_a_step = 0.5 * simulation.settings().parameters.time_step_secs;
    simulation.time_secs() + half_a_step > time_secs
}
