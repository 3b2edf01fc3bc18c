//! Definitions of technical terms for hover texts. They come from the glossary of the documentation and from the help
//! texts of settings.

use std::sync::OnceLock;

use egui::Response;

use crate::sim::{Settings, Stepper};
use crate::solver::METHODS;

/// Text of the documentation's page on theory. The last table on this page is the glossary.
const PAGE: &str = include_str!("../../docs/theory.md");
/// Terms of the glossary that are also common words or letters. The window shows no definitions of these terms.
const COMMON: [&str; 2] = ["d", "stop"];

/// Shows the definitions of all glossary terms in `text` when the user points at the widget of `response`.
pub(super) fn explained(response: Response, text: &str) -> Response {
    if !response.hovered() {
        return response;
    }
    let found = definitions_in(text);
    if found.is_empty() { response } else { response.on_hover_text(found) }
}

/// Returns the definitions of all technical terms that occur in a text, one per line. Each term is defined once.
fn definitions_in(text: &str) -> String {
    let mut found: Vec<&str> = Vec::new();
    for (term, definition) in terms() {
        if has_word(text, term) && !found.contains(&definition.as_str()) {
            found.push(definition);
        }
    }
    found.join("\n")
}

/// Returns all technical terms that have a definition, each with the line that defines the term.
fn terms() -> &'static [(String, String)] {
    static TERMS: OnceLock<Vec<(String, String)>> = OnceLock::new();
    TERMS.get_or_init(|| {
        let glossary = PAGE.rsplit_once("|---|---|").map_or("", |(_, rows)| rows);
        let rows = glossary.lines().filter_map(|line| {
            let (term, definition) =
                line.strip_prefix("| ")?.strip_suffix(" |")?.split_once(" | ")?;
            let plain = |text: &str| text.replace(['`', '*'], "").replace("δ_c", "δc");
            Some((plain(term), plain(definition)))
        });
        let glossary = rows.flat_map(|(names, definition)| {
            let line = format!("{names}: {definition}");
            let names: Vec<_> = names.split(", ").map(str::to_owned).collect();
            names.into_iter().map(move |name| (name, line.clone()))
        });
        let steppers = Stepper::ALL.iter().map(|stepper| (stepper.name(), stepper.hint()));
        let methods = METHODS.iter().map(|info| (info.name, info.summary));
        let settings =
            Settings::about().filter_map(|about| Some((about.control?.symbol, about.help)));
        let declared = steppers.chain(methods).chain(settings);
        let declared = declared.map(|(name, help)| (name.to_owned(), format!("{name}: {help}")));
        let is_term =
            |(name, _): &(String, String)| !name.is_empty() && !COMMON.contains(&name.as_str());
        let mut terms: Vec<(String, String)> = Vec::new();
        for (name, line) in glossary.chain(declared).filter(is_term) {
            // If a term occurs twice, the definition in the glossary is used, because it comes first.
            if terms.iter().all(|(other, _)| *other != name) {
                terms.push((name, line));
            }
        }
        terms
    })
}

/// True if a text contains a word, also in the plural or at the beginning of a sentence.
fn has_word(text: &str, word: &str) -> bool {
    let (text, word) = (text.to_lowercase(), word.to_lowercase());
    text.match_indices(&word).any(|(at, _)| {
        let before = text[..at].chars().next_back();
        let after = text[at + word.len()..].trim_start_matches('s').chars().next();
        let ends =
            |next: Option<char>| next.is_none_or(|next| !next.is_alphanumeric() && next != '-');
        ends(before) && ends(after)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::lessons::LESSONS;

    #[test]
    fn every_term_of_the_window_has_a_definition() {
        for term in [
            "slump", "Δy", "Bond", "moreau", "range", "δc", "nsgs", "ρ", "μ", "Δt", "sweeps",
            "residual",
        ] {
            let found = definitions_in(term);
            assert_eq!(found.lines().count(), 1, "{term}: {found:?}");
        }
        let lesson = definitions_in(LESSONS[3].watch);
        assert!(lesson.contains("moreau: ") && lesson.contains("range: "), "{lesson}");
        assert_eq!(definitions_in("a day in the sun"), "");
        let slump = "slump, Δy: drop of the mean height divided by the first mean height";
        assert!(
            definitions_in("Slumps differ").starts_with(slump),
            "{}",
            definitions_in("Slumps differ")
        );
    }
}
