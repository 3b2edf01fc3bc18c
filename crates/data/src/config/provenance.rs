//! The description of a run as words of a command line, and as texts that a file carries.

use serde_json::Value as Json;

use super::Config;
use crate::error::Result;
use crate::output::Texts;
use crate::sim::Settings;

impl Config {
    /// The options that ask for this scene with these settings: where it comes from, and each setting that
    /// differs from what the scene says.
    ///
    /// # Errors
    /// Where the scene is no longer there.
    pub fn words(&self, settings: &Settings) -> Result<Vec<String>> {
        let unchanged = Self { source: self.source.clone(), ..Self::default() };
        let before = unchanged.without_settling()?.settings();
        let mut words = self.source_words();
        words.extend(words_of(settings, Some(&before)));
        Ok(words)
    }

    /// What says where the scene comes from.
    fn source_words(&self) -> Vec<String> {
        // A name that is no text is refused where it is read.
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

/// Settings as options: all of them, or those that differ from others.
pub fn words_of(settings: &Settings, others: Option<&Settings>) -> Vec<String> {
    let differs = |name| others.is_none_or(|others| settings.get(name) != others.get(name));
    let names = Settings::about().map(|about| about.name).filter(|&name| differs(name));
    let words =
        names.filter_map(|name| Some([format!("--{name}"), settings.get(name)?.to_string()]));
    words.flatten().collect()
}

/// Words as a shell takes them.
pub fn joined(words: &[String]) -> String {
    // Refused is what no argument can hold.
    shlex::try_join(words.iter().map(String::as_str)).unwrap_or_else(|_| words.join(" "))
}

/// What a run is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Provenance {
    /// Name of its scene.
    pub scene: String,
    /// Its settings.
    pub settings: Settings,
    /// The options that make it.
    pub words: Vec<String>,
}

impl Provenance {
    /// What a file says of itself that shows this run, at a simulated time (s) if it is of one moment. The command
    /// has these options besides.
    pub fn texts(&self, time_secs: Option<f64>, besides: &[String]) -> Texts {
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
        texts.add("Command line", joined(&[&command[..], words, besides].concat()));
        texts
    }
}

/// The options that ask for a run up to a simulated time (s), with a picture there. One may be later than the
/// scene's own end.
pub fn words_up_to(time_secs: f64) -> Vec<String> {
    let secs = time_secs.to_string();
    let mut words = vec!["--times".to_owned(), secs.clone()];
    if time_secs > 0.0 {
        words.extend(["--duration".to_owned(), secs]);
    }
    words
}

/// A simulated time as one asks for it: without the rounding of a sum of many steps.
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
