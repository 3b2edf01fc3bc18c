//! A [`Config`] as options of the command line.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser, ValueParser};
use clap::error::ErrorKind;
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};

use super::{Config, Origin, refusal_of};
use crate::error::{Error, Result};
use crate::setting::{About, Kind, Settable, Value, Word};
use crate::sim::Settings;

impl Config {
    /// The names of all fields, as command line and study files write them.
    pub fn names() -> Vec<String> {
        Self::options().into_iter().map(|(name, _)| name).collect()
    }

    /// The names of all fields, each with its line in the help of the command line.
    pub fn options() -> Vec<(String, String)> {
        let command = Self::augment_args(Command::new("config"));
        let help = |option: &Arg| option.get_help().map(ToString::to_string).unwrap_or_default();
        let named = |option: &Arg| Some((option.get_long()?.to_owned(), help(option)));
        command.get_arguments().filter_map(named).collect()
    }

    /// What the command line makes of these options, each a name and what is said of it.
    ///
    /// ```
    /// use slump::config::Config;
    ///
    /// let config = Config::of_options([("scene", "cradle"), ("max-sweeps", "20")])?;
    /// assert_eq!(config.scene(|_| true)?.solver.max_sweeps, 20);
    /// let refused = Config::of_options([("max-sweeps", "many")]);
    /// assert!(refused.is_err_and(|error| error.to_string().starts_with("--max-sweeps is many")));
    /// # Ok::<(), slump::error::Error>(())
    /// ```
    ///
    /// # Errors
    /// In the command line's own sentence, where it does not take one of them, or not together.
    pub fn of_options<'a>(options: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Self> {
        let command = Self::augment_args(Command::new("slump").no_binary_name(true));
        let given = options.into_iter().map(|(name, value)| format!("--{name}={value}"));
        let matches = command.clone().try_get_matches_from(given);
        matches
            .and_then(|matches| Self::from_arg_matches(&matches))
            .map_err(|error| Error::Options(refusal_of(&error, command)))
    }
}

impl Args for Config {
    fn augment_args(command: Command) -> Command {
        Settings::about()
            .fold(Origin::augment_args(command), |command, about| command.arg(option(about)))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

/// The parser of a word, for options that are not settings.
pub fn parser_of<T: Settable + Send + Sync + 'static>() -> ValueParser {
    let words = if let Kind::Word(words) = T::KIND { words } else { &[] };
    let said = |said: String| {
        let word = words.iter().find(|word| word.name == said);
        word.and_then(|word| T::of(Value::Word(word.name))).ok_or("one of the words")
    };
    possible(words).try_map(said).into()
}

fn possible(words: &'static [Word]) -> PossibleValuesParser {
    let word = |word: &Word| PossibleValue::new(word.name).help(word.hint);
    PossibleValuesParser::new(words.iter().map(word))
}

/// The option of a setting.
fn option(about: &About) -> Arg {
    let parser: ValueParser = match about.kind {
        Kind::Number => clap::value_parser!(f64).into(),
        Kind::Count => clap::value_parser!(u32).into(),
        Kind::Switch => clap::value_parser!(bool),
        Kind::Word(words) => possible(words).into(),
    };
    Arg::new(about.name)
        .long(about.name)
        .value_name(about.value_name)
        .help(about.help)
        .help_heading(about.heading)
        .allow_negative_numbers(about.kind == Kind::Number)
        .value_parser(parser)
}

/// What is given of a setting.
fn given(about: &About, matches: &ArgMatches) -> Option<Value> {
    let name = about.name;
    match about.kind {
        Kind::Number => matches.get_one(name).copied().map(Value::Number),
        Kind::Count => matches.get_one(name).copied().map(Value::Count),
        Kind::Switch => matches.get_one(name).copied().map(Value::Switch),
        Kind::Word(words) => {
            let said: &String = matches.get_one(name)?;
            words.iter().find(|word| word.name == said).map(|word| Value::Word(word.name))
        }
    }
}

impl FromArgMatches for Config {
    fn from_arg_matches(matches: &ArgMatches) -> std::result::Result<Self, clap::Error> {
        let mut config = Self::default();
        config.update_from_arg_matches(matches)?;
        Ok(config)
    }

    fn update_from_arg_matches(
        &mut self,
        matches: &ArgMatches,
    ) -> std::result::Result<(), clap::Error> {
        self.origin = Origin::from_arg_matches(matches)?;
        for about in Settings::about() {
            let accepted = given(about, matches).is_none_or(|value| self.set(about.name, value));
            if !accepted {
                let message = format!("{} is not of its kind", about.name);
                return Err(clap::Error::raw(ErrorKind::InvalidValue, message));
            }
        }
        Ok(())
    }
}
