//! The command line: a file a command, and one way to say what went wrong.

mod chart;
mod generate;
mod list;
mod problem;
mod reproduce;
mod run;
mod scene;
mod stability;
mod sweep;
mod validate;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use crate::config::refusal_of;
use crate::error::{Error, Result};
use crate::output::{lost_stdout, note_line, note_printed};

/// A laboratory for Contact Dynamics of cohesive grains: what the time step does to cohesion.
#[derive(Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(flatten)]
    run: run::RunCommand,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Put discs into a box over a rough base, let them come to rest, and write them as CSV
    Generate(generate::GenerateCommand),
    /// List the built-in scenes and the methods
    List,
    /// Write the contact problem of one step to a file, or solve such a file alone
    Problem {
        #[command(subcommand)]
        command: problem::ProblemCommand,
    },
    /// Run a study: all combinations of lists and ranges of parameters, on all cores
    Sweep(sweep::SweepCommand),
    /// Make the paper's figures, and those its conclusion asks for, from simulation alone
    Reproduce(reproduce::ReproduceCommand),
    /// Chart speed against accuracy of every method: of steps, of simulations, and of lean models
    Chart(chart::ChartCommand),
    /// Run every method on scenes made to break methods, and tell where each holds, degrades and fails
    Stability(stability::StabilityCommand),
    /// Hold Slump against published experiments: quantity, interval, verdict and cost, for a choice of methods
    Validate(validate::ValidateCommand),
    /// Print a scene, with the changes asked for, as a scene file
    // By far the largest of them.
    Scene(Box<scene::SceneCommand>),
}

/// Exit code of all that went wrong, but for a signal.
const REFUSED: u8 = 2;

/// Does what the command line of this process asks for. What goes wrong is one sentence on stderr,
/// and exit code 2; a run that a signal ended has the code that shells know for it.
pub fn main() -> ExitCode {
    let parsed = Cli::try_parse().map(Some).or_else(|error| match error.use_stderr() {
        true => Err((REFUSED, refusal_of(&error, Cli::command()))),
        // Help and version.
        false => {
            note_printed(error.print());
            Ok(None)
        }
    });
    let said = |error: Error| match error {
        Error::Interrupted { exit_code, .. } => (exit_code, error.to_string()),
        _ => (REFUSED, error.to_string()),
    };
    let done = parsed.and_then(|cli| cli.map_or(Ok(()), run).map_err(said));
    let done = done.and_then(|()| lost_stdout().map_or(Ok(()), |loss| Err((REFUSED, loss))));
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err((code, message)) => {
            note_line(format_args!("slump: {message}"));
            ExitCode::from(code)
        }
    }
}

fn run(cli: Cli) -> Result<()> {
    match cli.command {
        Some(Command::Generate(command)) => command.run(),
        Some(Command::List) => {
            list::run();
            Ok(())
        }
        Some(Command::Problem { command }) => command.run(),
        Some(Command::Sweep(command)) => command.run(),
        Some(Command::Reproduce(command)) => command.run(),
        Some(Command::Chart(command)) => command.run(),
        Some(Command::Stability(command)) => command.run(),
        Some(Command::Validate(command)) => command.run(),
        Some(Command::Scene(command)) => command.run(),
        None => cli.run.run(),
    }
}
