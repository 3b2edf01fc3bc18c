//! Errors of this crate. Each message is one sentence that names the field, the value and the allowed values.

use std::path::{Path, PathBuf};

/// The error of every fallible operation of this crate. Its `Display` is one sentence for a person.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A value outside its range.
    #[error("{} is {}, but must be {}", legible(.field), legible(.value), legible(.allowed))]
    Value {
        /// The field, as the user writes it.
        field: String,
        /// The value found.
        value: String,
        /// The allowed values.
        allowed: String,
    },
    /// A file that could not be read or written.
    #[error("{}: {}", place(.path), legible(.reason))]
    File {
        /// The file or folder.
        path: PathBuf,
        /// Message of the system or the parser, with the line if it is known.
        reason: String,
    },
    /// Options that the command line refuses, with the reason.
    #[error("{0}")]
    Options(String),
    /// The requested kind of renderer is not available.
    #[error("{0}")]
    Renderer(String),
    /// A run ended by a signal. Its results up to then have been written.
    #[error("stopped by {signal} at step {step} (t = {time_secs} s)")]
    Interrupted {
        /// Name of the signal.
        signal: &'static str,
        /// The program's exit code.
        exit_code: u8,
        /// Number of the last step.
        step: u64,
        /// The simulated time of that step.
        time_secs: f64,
    },
    /// A solve ended by a signal. The impulses reached by then have been written.
    #[error("stopped by {signal} after {sweeps} sweeps")]
    SolveInterrupted {
        /// Name of the signal.
        signal: &'static str,
        /// The program's exit code.
        exit_code: u8,
        /// Sweeps done before the signal.
        sweeps: u32,
    },
    /// A simulation whose state is no longer finite.
    #[error(
        "{}",
        legible(&format!(
            "the state is no longer finite at step {step} (t = {time_secs} s) with Bond {bond}, \
             time step {time_step_secs} s, restitution {restitution}, friction {friction}; {advice}"
        ))
    )]
    NonFinite {
        /// The step after which the state was found to be not finite.
        step: u64,
        /// The simulated time of that step.
        time_secs: f64,
        /// Bond number in force.
        bond: f64,
        /// Time step in force.
        time_step_secs: f64,
        /// Restitution in force.
        restitution: f64,
        /// Friction in force.
        friction: f64,
        /// The change that is most likely to help.
        advice: String,
    },
}

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An error about the value of a field.
    pub fn value(
        field: impl Into<String>,
        value: impl std::fmt::Display,
        allowed: impl Into<String>,
    ) -> Self {
        Self::Value { field: field.into(), value: value.to_string(), allowed: allowed.into() }
    }

    /// An error about a file or folder.
    pub fn file(path: impl AsRef<Path>, reason: impl std::fmt::Display) -> Self {
        // Messages of parsers contain and end with line breaks; a sentence has none.
        let reason = reason.to_string().trim_end().replace('\n', " ");
        Self::File { path: path.as_ref().to_owned(), reason }
    }

    /// An error about a file that cannot be read or is not a `form`: the message of the system or parser, followed by
    /// the allowed form.
    pub fn unread(path: impl AsRef<Path>, said: impl std::fmt::Display, form: &str) -> Self {
        Self::file(path, with_allowed(&said.to_string(), form))
    }
}

/// Returns an error about the value of a field unless `is_sound`.
///
/// # Errors
/// [`Error::Value`].
pub fn check(
    is_sound: bool,
    field: impl Into<String>,
    value: impl std::fmt::Display,
    allowed: impl Into<String>,
) -> Result<()> {
    if is_sound { Ok(()) } else { Err(Error::value(field, value, allowed)) }
}

/// A parser's message about `form`, extended by the allowed form if it does not name it.
pub fn with_allowed(said: &str, form: &str) -> String {
    let said = said.trim_end();
    if said.contains("must ") {
        return said.to_owned();
    }
    if let Some((found, expected)) =
        said.rsplit_once(", expected ").or(said.rsplit_once("\nexpected "))
    {
        return format!("{found}, but must be {}", in_words(expected));
    }
    if said.starts_with("missing field") {
        return format!("{said}, which must be given in {form}");
    }
    format!("{said}, but must be {form}")
}

/// Replaces names of Rust types in a parser's message by words for users.
pub fn in_words(expected: &str) -> String {
    const WORDS: [(&str, &str); 9] = [
        ("f64", "a number"),
        ("usize", "a whole number ≥ 0"),
        ("u64", "a whole number ≥ 0"),
        ("u32", "a whole number from 0 to 4294967295"),
        ("u8", "a whole number from 0 to 255"),
        ("a boolean", "true or false"),
        ("a sequence", "a list"),
        ("struct ", "a table of "),
        ("nothing", "nothing more"),
    ];
    let known = WORDS.iter().find_map(|(kind, words)| Some((words, expected.strip_prefix(kind)?)));
    known.map_or(expected.to_owned(), |(words, rest)| format!("{words}{rest}"))
}

/// Longest number shown digit by digit. Every f64 fits with an exponent.
const MOST_DIGITS: usize = 24;
/// Longest word of a message; longer words are cut.
const MOST_OF_WORD: usize = 120;
/// Longest part of a message. The list of all settings fits.
const MOST_OF_PART: usize = 3000;

/// Makes part of a message readable, whatever a file or a command line put into it: escapes control characters,
/// writes long numbers with an exponent, and cuts overlong text.
pub fn legible(text: &str) -> String {
    let mut shown = String::with_capacity(text.len().min(MOST_OF_PART));
    for word in text.split_inclusive(' ') {
        if shown.len() > MOST_OF_PART {
            return shown + "…";
        }
        let word = escaped(&short_numbers(word));
        match word.char_indices().nth(MOST_OF_WORD) {
            Some((end, _)) => {
                let space = if word.ends_with(' ') { " " } else { "" };
                shown.extend([&word[..end], "…", space]);
            }
            None => shown.push_str(&word),
        }
    }
    shown
}

/// Gives a word an exponent if it has more than [`MOST_DIGITS`] digits in a row.
fn short_numbers(word: &str) -> String {
    let is_digit = |char: char| char.is_ascii_digit() || char == '.';
    let mut shown = String::new();
    let mut rest = word;
    while let Some(start) = rest.find(is_digit) {
        let length = rest[start..].find(|char| !is_digit(char)).unwrap_or(rest.len() - start);
        let digits = &rest[start..start + length];
        shown.push_str(&rest[..start]);
        match digits.parse::<f64>() {
            Ok(number) if length > MOST_DIGITS && number.is_finite() => {
                shown.push_str(&format!("{number:e}"));
            }
            _ => shown.push_str(digits),
        }
        rest = &rest[start + length..];
    }
    shown + rest
}

/// A path, escaped so that any terminal can show it.
pub fn place(path: &Path) -> String {
    escaped(&path.to_string_lossy())
}

/// Escapes characters that move the cursor or change the writing direction.
pub fn escaped(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for char in text.chars() {
        let turns = matches!(char, '\u{200e}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        if char.is_control() || turns {
            shown.extend(char.escape_default());
        } else {
            shown.push(char);
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_escaped_and_what_is_long_is_cut() {
        let said = |value: &str| Error::value("bond", value, "a number").to_string();
        let sentence = said("\u{1b}[2J\r\nmuch\u{202e}");
        assert_eq!(sentence, "bond is \\u{1b}[2J\\r\\nmuch\\u{202e}, but must be a number");
        assert_eq!(
            said(&f64::MAX.to_string()),
            "bond is 1.7976931348623157e308, but must be a number"
        );
        let number = 1e-300;
        assert!(number.to_string().len() > 300, "the situation");
        assert_eq!(said(&format!("({number}, 2)")), "bond is (1e-300, 2), but must be a number");
        assert_eq!(said("0.1234567890123456"), "bond is 0.1234567890123456, but must be a number");
        let [bond, time_step_secs] = [f64::MAX, 1e-300];
        let (step, time_secs, restitution, friction) = (1, time_step_secs, 0.0, 0.5);
        let advice = String::new();
        let gone = Error::NonFinite {
            step,
            time_secs,
            bond,
            time_step_secs,
            restitution,
            friction,
            advice,
        };
        let gone = gone.to_string();
        assert!(gone.contains("Bond 1.7976931348623157e308, time step 1e-300 s"), "{gone}");
        for long in
            ["1".repeat(100_000), "x".repeat(100_000), "x ".repeat(100_000), "é".repeat(999)]
        {
            assert!(said(&long).len() < 4000, "{}", &long[..4]);
        }
        let path = Error::file("a\u{7}b", "c\nd\u{1b}").to_string();
        assert_eq!(path, "a\\u{7}b: c d\\u{1b}");
    }

    #[test]
    fn what_parsers_say_gets_what_is_allowed() {
        let sentence = |said| with_allowed(said, "a scene file");
        assert_eq!(
            sentence("invalid type: string \"much\", expected f64"),
            "invalid type: string \"much\", but must be a number"
        );
        assert_eq!(sentence("duplicate key\n"), "duplicate key, but must be a scene file");
        assert_eq!(
            sentence("missing field `bond`"),
            "missing field `bond`, which must be given in a scene file"
        );
    }
}
