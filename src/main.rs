//! The command line.

mod problem_command;
mod stability_command;
mod sweep_command;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::builder::PossibleValuesParser;
use clap::{Parser, Subcommand};
use slump::app::WindowOptions;
use slump::error::Result;
use slump::headless::HeadlessOptions;
use slump::output::{Progress, check_writable, write_file};
use slump::scene::{
    Config, Rain, SCENES, SceneGroup, Settling, scene_to_toml, settle, write_discs,
};
use slump::solver::{METHODS, MethodKind};
use slump::study::{
    ChartOptions, ChartPart, chart_speed, default_peers_folder, figure_names, reproduce,
};

/// A laboratory for Contact Dynamics of cohesive grains: what the time step does to cohesion.
#[derive(Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(flatten)]
    config: Config,
    #[command(flatten)]
    headless: HeadlessOptions,
    #[command(flatten)]
    window: WindowOptions,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Rain discs into a box over a rough base, let them come to rest, and write them as CSV
    Generate {
        /// Number of grains
        #[arg(long, default_value_t = Rain::default().grains)]
        grains: usize,
        /// Width of the box, in mean diameters
        #[arg(long, default_value_t = Rain::default().box_width_in_diameters, allow_negative_numbers = true)]
        box_width: f64,
        /// Seed of diameters and places
        #[arg(long, default_value_t = Rain::default().seed)]
        seed: u64,
        /// The file to write
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
    },
    /// List the built-in scenes and the methods
    List,
    /// Write the contact problem of one step to a file, or solve such a file alone
    Problem {
        #[command(subcommand)]
        command: problem_command::ProblemCommand,
    },
    /// Run a study: all combinations of lists and ranges of parameters, on all cores
    Sweep(sweep_command::SweepCommand),
    /// Make the paper's figures, and those its conclusion asks for, from simulation alone
    Reproduce {
        /// Figures, or all
        #[arg(required = true, value_name = "FIGURE", value_parser = PossibleValuesParser::new(figure_names()))]
        figures: Vec<String>,
        /// Folder for figures, tables and report; the same command goes on where it stopped
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
        /// Coarser, in a few minutes
        #[arg(long)]
        quick: bool,
    },
    /// Chart speed against accuracy of every method: of steps, of simulations, and of lean models
    Chart {
        /// Folder for pictures, tables and measurements; the same command goes on where it stopped
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
        /// Coarser, in a few minutes
        #[arg(long)]
        quick: bool,
        /// Also race on steps of 2,000 grains
        #[arg(long)]
        large: bool,
        /// Chart these alone
        #[arg(long, value_name = "PART", value_delimiter = ',')]
        only: Vec<ChartPart>,
        /// Folder with the tables of other engines' runs
        #[arg(long, value_name = "DIR", default_value_os_t = default_peers_folder().to_owned())]
        peers: PathBuf,
    },
    /// Run every method on scenes made to break methods, and tell where each holds, degrades and fails
    Stability(stability_command::StabilityCommand),
    /// Print a scene, with the changes asked for, as a scene file
    Scene {
        #[command(flatten)]
        config: Config,
    },
}

fn main() -> ExitCode {
    // SAFETY: no other thread has been started yet.
    unsafe { slump::render::quieten_drivers() };
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) if !error.use_stderr() => error.exit(),
        Err(error) => {
            eprintln!("slump: {}", one_sentence(&error.to_string()));
            return ExitCode::from(2);
        }
    };
    match run(cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("slump: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(cli: Cli) -> Result<()> {
    match cli.command {
        Some(Command::Generate { grains, box_width, seed, out }) => {
            generate(&Rain { grains, box_width_in_diameters: box_width, seed }, &out)
        }
        Some(Command::List) => {
            list();
            Ok(())
        }
        Some(Command::Problem { command }) => command.run(),
        Some(Command::Sweep(command)) => command.run(),
        Some(Command::Reproduce { figures, out, quick }) => {
            reproduce(&figures, &out, quick, slump::headless::draw_snapshots)
        }
        Some(Command::Chart { out, quick, large, only, peers }) => {
            chart_speed(&ChartOptions { out, quick, large, only, peers })
        }
        Some(Command::Stability(command)) => command.run(),
        Some(Command::Scene { config }) => {
            print!("{}", scene_to_toml(&slump::headless::settled(&config)?)?);
            Ok(())
        }
        None if cli.headless.headless => slump::headless::run(&cli.config, &cli.headless),
        None => slump::app::run(&cli.config, &cli.headless, &cli.window),
    }
}

fn generate(rain: &Rain, out: &std::path::Path) -> Result<()> {
    if let Some(folder) = out.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        check_writable(folder)?;
    }
    let progress = Progress::new("settling", 100);
    let grains = settle(rain, |Settling { time_secs, limit_secs, .. }| {
        progress.set((100.0 * time_secs / limit_secs) as u64);
        true
    });
    progress.finish();
    let Rain { grains: count, box_width_in_diameters: width, seed } = rain;
    let comment = format!(
        "Discs rained into a box over a rough base and left to come to rest; metres.\n\
         slump generate --grains {count} --box-width {width} --seed {seed}"
    );
    write_file(out, write_discs(&grains?, &comment).as_bytes())?;
    println!("{}", out.display());
    Ok(())
}

fn list() {
    for group in SceneGroup::ALL {
        println!("{}:", group.title());
        for scene in SCENES.iter().filter(|scene| scene.group == group) {
            println!("  {:14} {}", scene.name, scene.summary);
        }
    }
    let methods = |heading: &str, of_problem: bool| {
        println!("{heading}:");
        for info in METHODS {
            if (info.method.kind() == MethodKind::Problem) == of_problem {
                println!("  {:14} {}", info.name, info.summary);
                println!("  {:14} solves {} ({})", "", info.solves, info.source);
            }
        }
    };
    methods("Methods", true);
    methods("Stepping schemes, in place of the whole step", false);
}

/// The first sentence of what the argument parser says: it also gives usage and hints.
fn one_sentence(message: &str) -> String {
    let message = message.trim_start_matches("error: ");
    let lines = message.lines().take_while(|line| !line.is_empty() && !line.starts_with("Usage"));
    lines.map(str::trim).collect::<Vec<_>>().join(" ")
}
