//! The errors of this crate. Each message is one sentence that names a field, its value and the allowed values.

use std::path::{Path, PathBuf};

/// The error of every operation of this crate that can fail. Its `Display` is one sentence for the user.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A value that is outside its range.
    #[error("{} is {}, but must be {}", legible(.field), legible(.value), legible(.allowed))]
    Value {
        /// Name of the field, as the user writes it.
        field: String,
        /// The value that the user or a file gives, as text.
        value: String,
        /// Description of the allowed values.
        allowed: String,
    },
    /// A file that could not be read or written.
    #[error("{}: {}", place(.path), legible(.reason))]
    File {
        /// Path of the file or folder.
        path: PathBuf,
        /// Message of the operating system or of the parser, with the line number if it is known.
        reason: String,
    },
    /// A combination of command-line options that Slump does not accept. The text is the whole message.
    #[error("{0}")]
    Options(String),
    /// A renderer (a graphics driver or the window) that is not available or fails. The text is the whole message.
    #[error("{0}")]
    Renderer(String),
    /// A run that was ended by a signal of the operating system. The results up to the last computed step have been
    /// written.
    #[error("stopped by {signal} at step {step} (t = {time_secs} s)")]
    Interrupted {
        /// Name of the signal, such as `SIGINT`.
        signal: &'static str,
        /// Exit code with which the program ends.
        exit_code: u8,
        /// Number of steps that the run has computed.
        step: u64,
        /// Simulated time after the last computed step, s.
        time_secs: f64,
    },
    /// A solve of a contact problem that was ended by a signal of the operating system. The impulses after the last
    /// computed sweep have been written.
    #[error("stopped by {signal} after {sweeps} sweeps")]
    SolveInterrupted {
        /// Name of the signal, such as `SIGINT`.
        signal: &'static str,
        /// Exit code with which the program ends.
        exit_code: u8,
        /// Number of sweeps of the solver before the signal.
        sweeps: u32,
    },
    /// A simulation whose positions or velocities are no longer finite.
    #[error(
        "{}",
        legible(&format!(
            "the state is no longer finite at step {step} (t = {time_secs} s) with Bond {bond}, \
             time step {time_step_secs} s, restitution {restitution}, friction {friction}; {advice}"
        ))
    )]
    NonFinite {
        /// Number of the step after which a position or velocity was not finite.
        step: u64,
        /// Simulated time after this step, s.
        time_secs: f64,
        /// Bond number in the last step.
        bond: f64,
        /// Time step in the last step, s.
        time_step_secs: f64,
        /// Restitution in the last step.
        restitution: f64,
        /// Friction coefficient in the last step.
        friction: f64,
        /// Advice at the end of the error message: the change of settings that is most likely to help.
        advice: String,
    },
}

/// Shorter name of [`std::result::Result`] with the error type [`Error`] of this crate.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// Returns an error about a field, named `field`, whose value `value` is not allowed. `allowed` describes the
    /// allowed values.
    pub fn value(
        field: impl Into<String>,
        value: impl std::fmt::Display,
        allowed: impl Into<String>,
    ) -> Self {
        Self::Value { field: field.into(), value: value.to_string(), allowed: allowed.into() }
    }

    /// Returns an error about the file or folder `path`, which cannot be read or written for the given `reason`.
    pub fn file(path: impl AsRef<Path>, reason: impl std::fmt::Display) -> Self {
        // Messages of parsers contain line breaks and end with them. The sentence of an error has no line break.
        let reason = reason.to_string().trim_end().replace('\n', " ");
        Self::File { path: path.as_ref().to_owned(), reason }
    }

    /// Returns an error about a file that cannot be read, or whose content is not valid. The message is that of the
    /// operating system or parser (`said`), followed by a description of a valid file (`form`).
    pub fn unread(path: impl AsRef<Path>, said: impl std::fmt::Display, form: &str) -> Self {
        Self::file(path, with_allowed(&said.to_string(), form))
    }
}

/// Returns an error about the value of a field if `is_sound` is false.
///
/// # Errors
/// [`Error::Value`] if `is_sound` is false.
pub fn check(
    is_sound: bool,
    field: impl Into<String>,
    value: impl std::fmt::Display,
    allowed: impl Into<String>,
) -> Result<()> {
    if is_sound { Ok(()) } else { Err(Error::value(field, value, allowed)) }
}

/// Returns the message of a parser (`said`) about a file or text. If the message does not name the allowed values, a
/// description of a valid file or text (`form`) is appended.
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

/// Replaces the names of Rust types, such as `f64`, in a parser's message by words that users know.
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

/// Largest number of digits with which a number is written in a message. A longer number is written with an exponent,
/// and then every f64 fits into this many digits.
const MOST_DIGITS: usize = 24;
/// Largest number of characters of a word in a message. Longer words are cut, so that one word cannot fill the
/// terminal.
const MOST_OF_WORD: usize = 120;
/// Largest number of bytes, in a message, of the name of a field, of its value, or of the description of the allowed
/// values. The longest of these descriptions, the list of all settings, is shorter.
const MOST_OF_PART: usize = 3000;

/// Returns a text from a file or a command line in a form that is readable in an error message, whatever the text
/// contains: control characters are escaped, long numbers have an exponent, and text that is too long is cut.
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

/// Returns a word in which each number of more than [`MOST_DIGITS`] digits is written with an exponent.
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

/// Returns a path as text, escaped so that any terminal can show it.
pub fn place(path: &Path) -> String {
    escaped(&path.to_string_lossy())
}

/// Escapes control characters and the characters that change the writing direction, so that a text cannot disturb the
/// terminal on which it is shown.
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
