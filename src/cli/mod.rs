//! The command line of the program, and the report of errors.

mod help;
mod studies;

pub use help::command;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand, ValueEnum};

#[cfg(feature = "window")]
use crate::app::WindowOptions;
use crate::config::{Config, parser_of, refusal_of, scene_to_toml, write_discs};
use crate::error::{Error, Result, check};
use crate::headless::{HeadlessOptions, settled};
use crate::interchange::{
    FoundSolution, MOST_STARTS, ProblemFile, Solution, problem_file_at, solutions_of_file,
    solve_file,
};
use crate::output::{
    Progress, Signal, caught_signal, check_new_file, heed_signals, ignore_file_size_signal,
    lost_stdout, note_line, note_printed, print_line, print_text, resolved, warn_of_steps,
    write_file,
};
use crate::scene::{Deposition, NewPile, SCENES, SceneGroup, Settled, Settling, Sizes, deposit};
use crate::sim::Stepper;
use crate::solver::{
    FrictionModel, METHODS, Method, SolutionSearch, SolveProgress, SolverSettings, StopTest,
    look_on,
};
use crate::threads::check_threads;
use studies::StudyCommand;

/// A laboratory for Contact Dynamics of cohesive grains: what the time step does to cohesion.
#[derive(Parser)]
#[command(name = "slump", version = crate::VERSION, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(flatten)]
    config: Config,
    #[command(flatten)]
    headless: HeadlessOptions,
    #[cfg(feature = "window")]
    #[command(flatten)]
    window: WindowOptions,
    #[command(subcommand)]
    command: Option<CliCommand>,
}

#[derive(Subcommand)]
enum CliCommand {
    /// Run a scene without a window: `slump run pile …` is `slump --headless --scene pile …`
    Run {
        #[command(flatten)]
        config: Box<Config>,
        #[command(flatten)]
        headless: Box<HeadlessOptions>,
    },
    /// Make a pile: put discs into a box over a rough base, let them settle, and write them as CSV
    Generate {
        /// Number of grains
        #[arg(long, default_value_t = NewPile::default().grains)]
        grains: usize,
        /// Width of the box, in mean diameters
        #[arg(long, default_value_t = NewPile::default().box_width_in_diameters)]
        box_width: f64,
        /// Seed of the random diameters and positions
        #[arg(long, default_value_t = NewPile::default().seed)]
        seed: u64,
        /// Deposition: the way to place the grains
        #[arg(long, value_name = "WAY", default_value_t, value_parser = parser_of::<Deposition>())]
        deposition: Deposition,
        /// Distribution of the diameters, whose mean is d: uniform:S (from d·(1−S) to d·(1+S)), normal:S (standard
        /// deviation S·d), lognormal:S (standard deviation S of the logarithm), bidisperse:RATIO,FRACTION (large by
        /// small diameter, number fraction of the large grains), or sieves:DIAMETER=FRACTION,… (openings in any unit,
        /// mass fraction that passes); normal and lognormal are cut off at 2.5 standard deviations
        #[arg(long, default_value_t)]
        sizes: Sizes,
        /// CSV file for the discs: x, y and radius, metres
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
        /// Replace the file if it exists; without this option an existing file is refused
        #[arg(long)]
        overwrite: bool,
    },
    /// List the built-in scenes, steppers, solvers and friction models
    List {
        /// The only list to print [default: all lists]
        #[arg(value_name = "WHAT")]
        what: Option<Listed>,
    },
    /// Write the contact problem of one step to a file, or solve such a file
    Problem {
        #[command(subcommand)]
        command: ProblemCommand,
    },
    #[command(flatten)]
    Study(StudyCommand),
    /// Print a scene, with the requested changes, as a scene file
    Scene {
        // Boxed because this variant is by far the largest.
        #[command(flatten)]
        config: Box<Config>,
    },
    /// Print the completions of commands and options for a shell
    #[cfg(feature = "manual")]
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page of the program, or of a command, for `man`
    #[cfg(feature = "manual")]
    Man {
        /// The command, such as `budget` or `problem solve`
        #[arg(value_name = "COMMAND")]
        command: Vec<String>,
    },
}

/// Exit code of a run that ends with an error, unless a signal ended the run.
const REFUSED: u8 = 2;

/// Runs the command line of this process. An error is reported as one sentence on stderr, with exit code 2. A run that
/// a signal ended has the exit code that shells use for that signal.
pub fn main() -> ExitCode {
    ignore_file_size_signal();
    let parsed = check_stack().map_err(|error| (REFUSED, error.to_string())).and_then(|()| parse());
    let said = |error: Error| match error {
        Error::Interrupted { exit_code, .. } | Error::SolveInterrupted { exit_code, .. } => {
            (exit_code, error.to_string())
        }
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

/// Parses the command line of this process. Returns `None` if the user asked for help or the version, which are then
/// printed. `inline(never)` keeps its stack frame, one of the largest in the program, out of other functions.
#[inline(never)]
fn parse() -> std::result::Result<Option<Cli>, (u8, String)> {
    command()
        .try_get_matches()
        .and_then(|matches| <Cli as clap::FromArgMatches>::from_arg_matches(&matches))
        .map(Some)
        .or_else(|error| match error.use_stderr() {
            true => Err((REFUSED, refusal_of(&error, command()))),
            false => {
                note_printed(error.print());
                Ok(None)
            }
        })
}

/// Smallest stack of the main thread, bytes; with less, the program does not start. Runs were measured to need 512 to
/// 768 KiB. A window that opens a saved session needs more than 2 MiB, but this limit must not stop a run without a
/// window. The default stack is usually 8 MiB on systems with windows.
#[cfg(target_os = "linux")]
const LEAST_STACK_BYTES: u64 = 1 << 20;

/// Returns an error if the stack of the main thread is too small, because a stack overflow would end the process
/// without a message.
fn check_stack() -> Result<()> {
    #[cfg(target_os = "linux")]
    if let Some(bytes) = rustix::process::getrlimit(rustix::process::Resource::Stack).current {
        let [found, least] = [bytes, LEAST_STACK_BYTES].map(|bytes| bytes >> 10);
        let allowed = format!("at least {least}, as `ulimit -s {least}` makes it");
        check(found >= least, "the limit on the stack in KiB", found, allowed)?;
    }
    Ok(())
}

fn run(cli: Cli) -> Result<()> {
    check_threads()?;
    match cli.command {
        Some(CliCommand::Run { config, headless }) => {
            crate::headless::run(&config, &HeadlessOptions { headless: true, ..*headless })
        }
        Some(CliCommand::Generate {
            grains,
            box_width,
            seed,
            deposition,
            sizes,
            out,
            overwrite,
        }) => {
            let box_width_in_diameters = box_width;
            check_new_file("out", &out, overwrite)?;
            generate(&NewPile { grains, box_width_in_diameters, seed, deposition, sizes }, &out)
        }
        Some(CliCommand::List { what }) => {
            Listed::value_variants()
                .iter()
                .filter(|listed| what.is_none_or(|what| what == **listed))
                .for_each(|listed| listed.print());
            Ok(())
        }
        Some(CliCommand::Problem { command }) => command.run(),
        Some(CliCommand::Study(command)) => command.run(),
        Some(CliCommand::Scene { config }) => {
            print_text(scene_to_toml(&settled(&config)?)?);
            Ok(())
        }
        #[cfg(feature = "manual")]
        Some(CliCommand::Completions { shell }) => {
            print_text(help::completions(shell));
            Ok(())
        }
        #[cfg(feature = "manual")]
        Some(CliCommand::Man { command }) => {
            print_text(help::page(&command)?);
            Ok(())
        }
        None if cli.headless.headless => crate::headless::run(&cli.config, &cli.headless),
        #[cfg(feature = "window")]
        None => crate::app::run(&cli.config, &cli.headless, &cli.window),
        #[cfg(not(feature = "window"))]
        None => Err(Error::Renderer(
            "this build has no window: build it with the feature window, or give --headless".into(),
        )),
    }
}

/// The lists that `slump list` prints.
#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Listed {
    Scenes,
    Steppers,
    Methods,
    FrictionModels,
}

impl Listed {
    fn print(self) {
        let row = |name: &str, about: &str| print_line(format_args!("  {name:14} {about}"));
        match self {
            Self::Scenes => {
                for &group in SceneGroup::ALL {
                    print_line(format_args!("{}:", group.hint()));
                    let of_group = SCENES.iter().filter(|scene| scene.group == group);
                    of_group.for_each(|scene| row(scene.name, scene.summary));
                }
            }
            Self::Steppers => {
                print_line("Steppers:");
                for stepper in Stepper::ALL {
                    let info = stepper.info();
                    row(stepper.name(), stepper.hint());
                    row("", &format!("solves {} ({})", info.solves, info.source));
                    row("", &format!("reads {}", info.settings.replace(' ', ", ")));
                }
            }
            Self::Methods => {
                print_line("Methods, for steppers that solve each step's problem by one:");
                for info in METHODS {
                    row(info.name, info.summary);
                    row("", &format!("solves {} ({})", info.solves, info.source));
                }
            }
            Self::FrictionModels => {
                let takers = METHODS.iter().filter(|info| info.takes_models).map(|info| info.name);
                let takers = takers.collect::<Vec<_>>().join(", ");
                print_line(format_args!("Models of friction, those beside coulomb for {takers}:"));
                FrictionModel::ALL.iter().for_each(|model| row(model.name(), model.hint()));
            }
        }
    }
}

/// Places discs in a box, lets them settle, and writes them to a file when they are at rest.
fn generate(pile: &NewPile, out: &Path) -> Result<()> {
    let progress = Progress::new("settling", 100);
    let settled = deposit(pile, |Settling { time_secs, limit_secs, .. }| {
        progress.set((100.0 * time_secs / limit_secs) as u64);
        true
    });
    progress.finish();
    let Settled { grains, kinetic_energy, mean_overlap, max_overlap } = settled?;
    let rest = format!(
        "At rest: kinetic energy {kinetic_energy:.1e} m g d a grain, overlap {mean_overlap:.1e} d in the \
             mean and {max_overlap:.1e} d at most."
    );
    let NewPile { grains: count, box_width_in_diameters: width, seed, deposition, sizes } = pile;
    let sized = match *sizes == Sizes::default() {
        true => String::new(),
        false => format!(" --sizes {sizes}"),
    };
    let command =
        format!("slump generate --grains {count} --box-width {width} --seed {seed}{sized}");
    let comment = match deposition {
        // The file of the built-in pile has only these lines.
        Deposition::Rain => format!(
            "Discs rained into a box over a rough base and left to come to rest; metres.\n{command}"
        ),
        Deposition::DropAndRoll => format!(
            "Discs dropped into a box over a rough base, each rolled to where two others hold it, and \
                 left to come to rest; metres.\n{rest}\n{command} --deposition drop-and-roll"
        ),
    };
    write_file(out, write_discs(&grains, &comment).as_bytes())?;
    note_line(&rest);
    print_line(out.display());
    Ok(())
}

/// The subcommands of `slump problem`.
#[derive(clap::Subcommand)]
enum ProblemCommand {
    /// Run a scene up to a time and write the problem of the step that begins there
    Dump {
        #[command(flatten)]
        config: Box<Config>,
        /// Simulated time, seconds
        #[arg(long, value_name = "SECONDS")]
        at: f64,
        /// The file to write (JSON)
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
        /// Replace the file if it exists; without this option an existing file is refused
        #[arg(long)]
        overwrite: bool,
    },
    /// Solve the contact problem in a file of Slump or of the program Siconos, and report residual and time
    Solve {
        /// File with a contact problem: JSON of `slump problem dump`, or text of the program Siconos
        file: PathBuf,
        /// The method
        #[arg(long, value_name = "NAME", default_value = "auto", value_parser = parser_of::<Method>())]
        method: Method,
        /// Residual to reach, dimensionless
        #[arg(long, value_name = "X", default_value_t = 1e-8)]
        tolerance: f64,
        /// Stop after this many sweeps
        #[arg(long, value_name = "N", default_value_t = 1_000_000)]
        max_sweeps: u32,
        /// Repeat the solve this many times and report the least time
        #[arg(long, value_name = "N", default_value_t = 1)]
        repeat: u32,
        /// Search for solutions under Coulomb friction from this many starts (the impulses of the file, zero, then
        /// random impulses), and report how much their velocities differ, m/s
        #[arg(long, value_name = "N", default_value_t = 0, conflicts_with = "without_bodies", value_parser = clap::value_parser!(u32).range(..=i64::from(MOST_STARTS)))]
        starts: u32,
        /// Solve with the matrix W (effect of impulses on contact velocities), even if the file has the bodies
        #[arg(long)]
        without_bodies: bool,
        /// Write velocities and impulses to this file (JSON)
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
        /// Replace the file of --out if it exists; without this option an existing file is refused
        #[arg(long, requires = "out")]
        overwrite: bool,
    },
}

impl ProblemCommand {
    fn run(self) -> Result<()> {
        match self {
            Self::Dump { config, at, out, overwrite } => {
                if let Some(secs) = config.source.duration {
                    let allowed = "left out, since --at says how long the scene is run";
                    return Err(Error::value("duration", secs, allowed));
                }
                check_new_file("out", &out, overwrite)?;
                let scene = settled(&config)?;
                scene.parameters.check_steps("at", at)?;
                warn_of_steps(scene.parameters.steps_in(at));
                let progress = Progress::new("running", 100);
                let file = problem_file_at(&scene, at, |time| {
                    progress.set((100.0 * time / at) as u64);
                });
                progress.finish();
                let file = file?;
                file.write(&out)?;
                print_line(format_args!("{} contacts in {}", file.nc, out.display()));
                Ok(())
            }
            Self::Solve {
                file,
                method,
                tolerance,
                max_sweeps,
                repeat,
                starts,
                without_bodies,
                out,
                overwrite,
            } => {
                if let Some(out) = &out {
                    let place = resolved(out)?;
                    let is_another = place.is_none() || place != resolved(&file)?;
                    let allowed = "another file than that of the problem";
                    check(is_another, "out", out.display(), allowed)?;
                    check_new_file("out", out, overwrite)?;
                }
                let mut problem = ProblemFile::read(&file)?;
                if without_bodies {
                    problem.bodies = None;
                }
                let stop = StopTest::Residual;
                let settings = SolverSettings {
                    method,
                    stop,
                    tolerance,
                    max_sweeps,
                    ..SolverSettings::SWEEPS
                };
                heed_signals();
                look_on(move |progress| show_progress(progress, tolerance));
                let solution = solve_file(&problem, &settings, repeat)?;
                let signal = caught_signal().filter(|_| !solution.converged);
                print_solution(&solution, max_sweeps, signal);
                let mut ended_by = signal;
                if starts > 0 && signal.is_none() {
                    let search = SolutionSearch { starts, seed: 1, max_sweeps, tolerance };
                    print_found(&solutions_of_file(&problem, &search)?, starts);
                    ended_by = caught_signal();
                }
                if let Some(out) = out {
                    write_file(&out, solution.text().as_bytes())?;
                }
                ended_by.map_or(Ok(()), |signal| {
                    let (exit_code, sweeps) = (signal.exit_code(), solution.sweeps);
                    Err(Error::SolveInterrupted { signal: signal.name(), exit_code, sweeps })
                })
            }
        }
    }
}

/// Number of sweeps from which on the program prints the residual of an unfinished solve, each time that the number has
/// doubled. With a smaller limit, the residuals of short solves are also printed.
const LONG_SOLVE_SWEEPS: u32 = 4_096;

/// Prints the solutions of a contact problem that were found from several sets of initial impulses.
fn print_found(found: &[FoundSolution], starts: u32) {
    let solved = found.iter().filter(|solution| solution.is_solved).count();
    print_line(format_args!("starts          {starts}, under Coulomb's law"));
    print_line(format_args!("solutions       {solved}"));
    for (number, solution) in (1..).zip(found) {
        let FoundSolution { residual, is_solved, starts, distances, farthest, .. } = solution;
        let starts: Vec<_> = starts.iter().map(|start| (start + 1).to_string()).collect();
        let name = if *is_solved { "solution" } else { "not solved" };
        print_line(format_args!(
            "  {number}: {name}, residual {residual:.1e}, from start {}",
            starts.join(", ")
        ));
        for (other, distance) in (1..).zip(distances) {
            print_line(format_args!("     root mean square from {other}: {distance:.2e} m/s"));
        }
        if let ((grain, off), false) = (farthest, distances.is_empty()) {
            print_line(format_args!("     most from 1: grain {grain}, by {off:.2e} m/s"));
        }
    }
}

/// Reports the progress of a long solve, and ends the solve if a signal has arrived.
fn show_progress(progress: SolveProgress, tolerance: f64) -> ControlFlow<()> {
    let SolveProgress { sweeps, residual } = progress;
    if let Some(residual) = residual.filter(|_| sweeps >= LONG_SOLVE_SWEEPS) {
        note_line(format_args!(
            "slump: after {sweeps} sweeps the residual is {residual:.3e}; the goal is {tolerance:e}"
        ));
    }
    caught_signal().map_or(ControlFlow::Continue(()), |_| ControlFlow::Break(()))
}

/// Prints a solution. If the solve ended early, also prints its cause: the limit of sweeps or a signal.
fn print_solution(solution: &Solution, max_sweeps: u32, signal: Option<Signal>) {
    let Solution { contacts, method, sweeps, factorisations, seconds, residual, .. } = solution;
    print_line(format_args!("contacts        {contacts}"));
    print_line(format_args!(
        "method          {method} on {}",
        if solution.on_bodies { "bodies" } else { "W" }
    ));
    print_line(format_args!("sweeps          {sweeps}"));
    print_line(format_args!("factorisations  {factorisations}"));
    print_line(format_args!("seconds         {seconds:.3e}"));
    print_line(format_args!("residual        {residual:.3e}"));
    let converged = match (solution.converged, signal) {
        (true, _) => "yes".to_owned(),
        (false, Some(signal)) => format!("no: stopped by {}", signal.name()),
        (false, None) if solution.stalled => "no: stalled, more sweeps are of no use".into(),
        (false, None) if *sweeps >= max_sweeps => {
            format!("no: all {max_sweeps} sweeps were used; --max-sweeps allows more")
        }
        (false, None) => format!("no: {method} gave up"),
    };
    print_line(format_args!("converged       {converged}"));
}
