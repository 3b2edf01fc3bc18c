//! What frames and animations say of themselves: the command that draws them again.

use clap::ValueEnum;

use super::HeadlessOptions;
use crate::config::{Config, Provenance, asked_time_secs, words_of, words_up_to};
use crate::error::Result;
use crate::output::Texts;
use crate::render::Style;
use crate::scene::Scene;
use crate::sim::Snapshot;

/// What a panel of a figure says of itself, of a scene that is built in.
///
/// # Errors
/// Where it is none.
pub(super) fn texts_of_panel(scene: &Scene, snapshot: &Snapshot) -> Result<Texts> {
    let settings = scene.settings();
    let words = Config::of_scene(&scene.name).words(&settings)?;
    let time_secs = asked_time_secs(snapshot.observables.time_secs);
    let frames = ["--frames".to_owned(), "frames".to_owned()];
    let run = Provenance { scene: scene.name.clone(), settings, words };
    Ok(run.texts(Some(time_secs), &[words_up_to(time_secs), frames.into()].concat()))
}

impl HeadlessOptions {
    /// What a run is made of that `config` and these options ask for.
    ///
    /// # Errors
    /// Where the scene is no longer there.
    pub(super) fn provenance(&self, config: &Config, scene: &Scene) -> Result<Provenance> {
        let settings = scene.settings();
        let words = match &self.saving.restart {
            None => {
                // Frames are the same however long the run goes on after them.
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

    /// What the picture at a simulated time (s) says of itself.
    pub(super) fn texts_of_frame(&self, run: &Provenance, time_secs: f64, style: &Style) -> Texts {
        let frames = ["--frames".to_owned(), "frames".to_owned()];
        run.texts(
            Some(time_secs),
            &[words_up_to(time_secs), self.words_of_style(style), frames.into()].concat(),
        )
    }

    /// What an animation of a run that lasts so long (s) says of itself; its command ends with `last_words`.
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

    /// The options that draw alike, with the scales that the frames have.
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
