//! What is wrong with a command line, in one sentence that says what is allowed: the argument parser
//! itself says what it could not read, adds usage and hints, and leaves out what it would take.

use std::error::Error as _;
use std::num::{ParseFloatError, ParseIntError};

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, Command, Error};

use crate::error::legible;

/// The sentence for what the parser of `command` refuses.
pub fn sentence(error: &Error, mut command: Command) -> String {
    // Before that no argument knows how it is shown.
    command.build();
    let said = |kind: ContextKind| match error.get(kind) {
        Some(ContextValue::String(text)) => text.clone(),
        Some(ContextValue::Strings(list)) => list.join(", "),
        Some(ContextValue::StyledStr(text)) => text.to_string(),
        _ => String::new(),
    };
    let argument = said(ContextKind::InvalidArg);
    let field = without_value_name(&argument);
    let value = match said(ContextKind::InvalidValue) {
        empty if empty.is_empty() => "missing".to_owned(),
        value => value,
    };
    let sentence = match error.kind() {
        ErrorKind::InvalidValue | ErrorKind::ValueValidation => {
            let allowed = match said(ContextKind::ValidValue) {
                none if none.is_empty() => kind_of_value(error, &command, &argument),
                list => format!("one of {list}"),
            };
            format!("{field} is {value}, but must be {allowed}")
        }
        ErrorKind::UnknownArgument => {
            let near = match said(ContextKind::SuggestedArg) {
                none if none.is_empty() => String::new(),
                near => format!(", such as {near}"),
            };
            format!("{field} is given, but must be an option or a command that --help lists{near}")
        }
        ErrorKind::InvalidSubcommand => {
            let found = said(ContextKind::InvalidSubcommand);
            format!("the command is {found}, but must be one of {}", commands(&command))
        }
        ErrorKind::MissingRequiredArgument => format!("{argument} is missing, but must be given"),
        ErrorKind::ArgumentConflict => {
            let found = match said(ContextKind::InvalidSubcommand) {
                none if none.is_empty() => field.to_owned(),
                command => command,
            };
            match said(ContextKind::PriorArg) {
                prior if prior == argument => {
                    format!("{found} is given twice, but must be given once")
                }
                prior => format!(
                    "{found} is given, but must be left out where {} is",
                    without_value_name(&prior)
                ),
            }
        }
        ErrorKind::TooManyValues => format!("{field} is {value}, but must be given without that"),
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand | ErrorKind::MissingSubcommand => {
            "the command is incomplete, but must be whole: see its --help".to_owned()
        }
        ErrorKind::InvalidUtf8 => "an argument is no text, but must be UTF-8".to_owned(),
        _ => format!("{}, but must be as --help says", first_sentence(&error.to_string())),
    };
    legible(&sentence)
}

/// `--bond <BOND>` as a user writes it.
fn without_value_name(argument: &str) -> &str {
    argument.split_once(" <").map_or(argument, |(name, _)| name)
}

/// What a value must be that is no word of a list: what the parser says, and the option's help,
/// which has the range.
fn kind_of_value(error: &Error, command: &Command, argument: &str) -> String {
    let source = error.source();
    let kind = if source.is_some_and(|source| source.is::<ParseFloatError>()) {
        "a number".to_owned()
    } else if source.is_some_and(|source| source.is::<ParseIntError>()) {
        "a whole number ≥ 0".to_owned()
    } else if let Some((_, range)) =
        source.map(ToString::to_string).unwrap_or_default().split_once(" is not in ")
    {
        format!("a whole number in {range}")
    } else {
        "given".to_owned()
    };
    match find(command, argument).and_then(Arg::get_help) {
        Some(help) => format!("{kind} ({help})"),
        None => kind,
    }
}

fn find<'a>(command: &'a Command, argument: &str) -> Option<&'a Arg> {
    let own = command.get_arguments().find(|known| known.to_string() == argument);
    own.or_else(|| command.get_subcommands().find_map(|below| find(below, argument)))
}

/// The names of all commands, and of those within each.
fn commands(command: &Command) -> String {
    let name = |command: &Command| match commands(command) {
        none if none.is_empty() => command.get_name().to_owned(),
        within => format!("{} ({within})", command.get_name()),
    };
    let own = command.get_subcommands().filter(|command| command.get_name() != "help");
    own.map(name).collect::<Vec<_>>().join(", ")
}

/// The first sentence of what the argument parser says: it also gives usage and hints.
fn first_sentence(message: &str) -> String {
    let message = message.trim_start_matches("error: ");
    let lines = message.lines().take_while(|line| !line.is_empty() && !line.starts_with("Usage"));
    lines.map(str::trim).collect::<Vec<_>>().join(" ")
}
