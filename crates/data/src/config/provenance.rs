//! Describes the origin of a result: the command line that repeats its run, and the texts that are stored in its files.

use serde_json::Value as Json;

use super::Config;
use crate::error::Result;
use crate::output::Texts;
use crate::sim::Settings;

impl Config {
    /// Returns the command-line options for a run of this configuration's scene with the given settings: the options
    /// for the source of the scene, and one option for each setting that differs from the scene's own value.
    ///
    /// # Errors
    /// If the scene can no longer be made, for example because its file was removed.
    pub fn words(&self, settings: &Settings) -> Result<Vec<String>> {
        let unchanged = Self { source: self.source.clone(), ..Self::default() };
        let before = unchanged.without_settling()?.settings();
        let mut words = self.source_words();
        words.extend(words_of(settings, Some(&before)));
        Ok(words)
    }

    /// Returns the command-line options that define the scene, such as `--scene pile --seed 3`.
    fn source_words(&self) -> Vec<String> {
        // Writing fails only for a path that is not Unicode. Such a path is refused when it is read.
        let Ok(Json::Object(fields)) = serde_json::to_value(&self.source) else {
            return Vec::new();
        };
        let said = |value: Json| match value {
            Json::String(text) => text,
            other => other.to_string(),
        };
        fields.into_iter().flat_map(|(name, value)| [format!("--{name}"), said(value)]).collect()
    }
}

/// Returns settings as command-line options: all settings, or only those that differ from `others`, if that is given.
pub fn words_of(settings: &Settings, others: Option<&Settings>) -> Vec<String> {
    let differs = |name| others.is_none_or(|others| settings.get(name) != others.get(name));
    let names = Settings::about().map(|about| about.name).filter(|&name| differs(name));
    let words =
        names.filter_map(|name| Some([format!("--{name}"), settings.get(name)?.to_string()]));
    words.flatten().collect()
}

/// Joins words into a command line for a shell, with quotes around words that need them.
pub fn joined(words: &[String]) -> String {
    // Joining fails only for a character that no argument can contain.
    shlex::try_join(words.iter().map(String::as_str)).unwrap_or_else(|_| words.join(" "))
}

/// Origin of a result: scene, settings and command-line options of the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Provenance {
    /// Name of the run's scene.
    pub scene: String,
    /// Settings of the run.
    pub settings: Settings,
    /// Command-line options that reproduce the run.
    pub words: Vec<String>,
}

impl Provenance {
    /// Returns the texts to be stored in a file that shows this run: title, scene, settings and command line.
    /// `time_secs` is the simulated time (s) that the file shows; `None` if it shows more than one time. `further` are
    /// more options for the stored command line.
    pub fn texts(&self, time_secs: Option<f64>, further: &[String]) -> Texts {
        let Self { scene, settings, words } = self;
        let mut texts = Texts::default();
        let at = time_secs.map_or_else(String::new, |secs| format!(", t = {secs} s"));
        texts.add("Title", format!("{scene}{at}"));
        texts.add("Scene", scene);
        if let Some(secs) = time_secs {
            texts.add("Time", format!("{secs} s"));
        }
        texts.add("Settings", joined(&words_of(settings, None)));
        let command = ["slump".to_owned(), "--headless".to_owned()];
        texts.add("Command line", joined(&[&command[..], words, further].concat()));
        texts
    }
}

/// Returns the command-line options for a run that ends at a simulated time (s) and makes a picture at that time. The
/// time may exceed the scene's duration.
pub fn words_up_to(time_secs: f64) -> Vec<String> {
    let secs = time_secs.to_string();
    let mut words = vec!["--times".to_owned(), secs.clone()];
    if time_secs > 0.0 {
        words.extend(["--duration".to_owned(), secs]);
    }
    words
}

/// Rounds a simulated time (s) to twelve decimals, so that it is the number that a user would write. This removes the
/// rounding error of a sum over many steps.
pub fn asked_time_secs(time_secs: f64) -> f64 {
    format!("{time_secs:.12}").parse().unwrap_or(time_secs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_has_what_differs_and_a_file_all_settings() {
        let config = Config::of_scene("pile");
        let mut settings = config.without_settling().unwrap().settings();
        settings.parameters.bond = 33.5;
        let words = config.words(&settings).unwrap();
        assert_eq!(words, ["--scene", "pile", "--bond", "33.5"]);
        let told = Provenance { scene: "pile".into(), settings, words };
        let texts = told.texts(Some(0.25), &["--theme".into(), "dark".into()]);
        let text = |name: &str| texts.get(name).unwrap().to_owned();
        assert_eq!(text("Title"), "pile, t = 0.25 s");
        let command = "slump --headless --scene pile --bond 33.5 --theme dark";
        assert_eq!(text("Command line"), command);
        assert!(
            text("Settings").contains("--bond 33.5 --bond-acceleration 0 --dt 0.001"),
            "{}",
            text("Settings")
        );
        assert!(text("Software").starts_with("slump "));
    }

    #[test]
    fn times_are_asked_for_without_the_rounding_of_sums() {
        let sum: f64 = (0..1000).map(|_| 1e-3).sum();
        assert_ne!(sum, 1.0);
        assert_eq!(asked_time_secs(sum), 1.0);
    }
}
