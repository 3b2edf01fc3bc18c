//! Creates parsers for command-line options whose value is one word from a list.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser, ValueParser};

use crate::setting::{Kind, Settable, Value, Word};

/// Returns the command-line parser that accepts the words of the type `T` and converts each word to the value that it
/// stands for. It serves options that do not change a single setting, such as `--preset`, which changes a group of
/// settings, and `--deposition`, which belongs to a new pile.
pub fn parser_of<T: Settable + Send + Sync + 'static>() -> ValueParser {
    let words = if let Kind::Word(words) = T::KIND { words } else { &[] };
    let said = |said: String| {
        let word = words.iter().find(|word| word.name == said);
        word.and_then(|word| T::of(Value::Word(word.name))).ok_or("one of the words")
    };
    possible(words).try_map(said).into()
}

/// Returns a command-line parser that accepts only the words of a list. The help of the command line explains each word
/// by the text `hint` of its [`Word`].
pub(super) fn possible(words: &'static [Word]) -> PossibleValuesParser {
    let word = |word: &Word| PossibleValue::new(word.name).help(word.hint);
    PossibleValuesParser::new(words.iter().map(word))
}
