//! What files say of a column where their format has no place of its own for it.

use super::table::{Column, Values};

impl Column {
    /// Unit and meaning under the name that a file has for it, as `gap [m]: distance of the surfaces`.
    pub(super) fn described(&self, name: &str) -> String {
        let Self { unit, about, .. } = self;
        let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
        format!("{name}{unit}: {about}")
    }

    /// The same where words are numbers, the first of them `first_code`.
    pub(super) fn described_with_codes(&self, name: &str, first_code: u32) -> String {
        let codes = match &self.values {
            Values::Words { words, .. } => {
                let codes = words.iter().zip(first_code..);
                let codes: Vec<_> = codes.map(|(word, code)| format!("{code} {word}")).collect();
                format!(" ({})", codes.join(", "))
            }
            Values::Flags(_) => " (1 yes, 0 no, -1 neither)".to_owned(),
            Values::Numbers(_) | Values::SomeNumbers(_) | Values::Counts(_) => String::new(),
        };
        self.described(name) + &codes
    }
}
