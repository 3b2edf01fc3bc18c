//! The command line that computes what a world shows.

use super::state::AppState;
use crate::scene::Config;
use crate::setting::Value;
use crate::sim::Settings;

impl AppState {
    /// The command line that computes the selected world from its start with the present settings, without a
    /// window and to the last digit; none where its scene is no longer there. Changes on the way and hands that
    /// pulled are not in it.
    pub fn command_line(&self) -> Option<String> {
        let settings = self.wanted.get(self.selected)?.settings;
        let origin = self.config.origin.clone();
        let unchanged = Config { origin, ..Config::default() };
        let mut words = vec!["slump".to_owned(), "--headless".to_owned()];
        words.extend(origin_words(&unchanged));
        let before = unchanged.without_settling().ok()?.settings();
        for about in Settings::about() {
            let value = settings.get(about.name);
            if let Some(value) = value.filter(|_| value != before.get(about.name)) {
                words.extend([format!("--{}", about.name), said(value)]);
            }
        }
        shlex::try_join(words.iter().map(String::as_str)).ok()
    }
}

/// What says where a scene comes from.
fn origin_words(config: &Config) -> Vec<String> {
    // A name that is no text is refused where it is read.
    let Ok(serde_json::Value::Object(fields)) = serde_json::to_value(&config.origin) else {
        return Vec::new();
    };
    let said = |value: serde_json::Value| match value {
        serde_json::Value::String(text) => text,
        other => other.to_string(),
    };
    fields.into_iter().flat_map(|(name, value)| [format!("--{name}"), said(value)]).collect()
}

fn said(value: Value) -> String {
    match value {
        Value::Number(number) => number.to_string(),
        Value::Count(count) => count.to_string(),
        Value::Switch(on) => on.to_string(),
        Value::Word(word) => word.to_owned(),
    }
}
