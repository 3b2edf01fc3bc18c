//! Parsers of options whose value is a word of a list.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser, ValueParser};

use crate::setting::{Kind, Settable, Value, Word};

/// Parser of a word, for options that are not settings.
pub fn parser_of<T: Settable + Send + Sync + 'static>() -> ValueParser {
    let words = if let Kind::Word(words) = T::KIND { words } else { &[] };
    let said = |said: String| {
        let word = words.iter().find(|word| word.name == said);
        word.and_then(|word| T::of(Value::Word(word.name))).ok_or("one of the words")
    };
    possible(words).try_map(said).into()
}

/// The words of a list, each with its help.
pub(super) fn possible(words: &'static [Word]) -> PossibleValuesParser {
    let word = |word: &Word| PossibleValue::new(word.name).help(word.hint);
    PossibleValuesParser::new(words.iter().map(word))
}
