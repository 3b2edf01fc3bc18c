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

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::error::Result;

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
    /// Rain discs into a box over a rough base, let them come to rest, and write them as CSV
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
    /// Print a scene, with the changes asked for, as a scene file
    Scene(scene::SceneCommand),
}

/// Does what the command line of this process asks for. What goes wrong is one sentence on stderr,
/// and exit code 2.
pub fn main() -> ExitCode {
    let outcome = match Cli::try_parse() {
        Ok(cli) => run(cli).map_err(|error| error.to_string()),
        Err(error) if !error.use_stderr() => error.exit(),
        Err(error) => Err(one_sentence(&error.to_string())),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("slump: {message}");
            ExitCode::from(2)
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
        Some(Command::Scene(command)) => command.run(),
        None => cli.run.run(),
    }
}

/// The first sentence of what the argument parser says: it also gives usage and hints.
fn one_sentence(message: &str) -> String {
    let message = message.trim_start_matches("error: ");
    let lines = message.lines().take_while(|line| !line.is_empty() && !line.starts_with("Usage"));
    lines.map(str::trim).collect::<Vec<_>>().join(" ")
}
