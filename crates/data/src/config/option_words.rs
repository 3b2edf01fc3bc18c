//! Creates parsers for command-line options whose value is a word of a list.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser, ValueParser};

use crate::setting::{Kind, Settable, Value, Word};

/// Returns the parser of a word that stands for a value of the type `T`, for options that are not settings.
pub fn parser_of<T: Settable + Send + Sync + 'static>() -> ValueParser {
    let words = if let Kind::Word(words) = T::KIND { words } else { &[] };
    let said = |said: String| {
        let word = words.iter().find(|word| word.name == said);
        word.and_then(|word| T::of(Value::Word(word.name))).ok_or("one of the words")
    };
    possible(words).try_map(said).into()
}

/// Returns the parser that accepts the words of a list. Each word has its own help text.
pub(super) fn possible(words: &'static [Word]) -> PossibleValuesParser {
    let word = |word: &Word| PossibleValue::new(word.name).help(word.hint);
    PossibleValuesParser::new(words.iter().map(word))
}
