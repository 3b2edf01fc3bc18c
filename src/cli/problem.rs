//! `slump problem`: one step's contact problem as a file, and such a file solved.

use std::path::PathBuf;

use crate::config::{Config, parser_of};
use crate::error::Result;
use crate::headless::settled;
use crate::interchange::{ProblemFile, Solution, problem_file_at, solve_file};
use crate::output::{Progress, check_file, print_line, warn_of_steps, write_file};
use crate::solver::{Method, SolverSettings, StopTest};

/// What to do with a problem.
#[derive(clap::Subcommand)]
pub(super) enum ProblemCommand {
    /// Run a scene up to a time and write the problem of the step that begins there
    Dump {
        #[command(flatten)]
        config: Box<Config>,
        /// Simulated time, seconds
        #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
        at: f64,
        /// The file to write (JSON)
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
    },
    /// Solve a problem file, or a text file of Siconos', and say how well and how fast
    Solve {
        /// The problem file
        file: PathBuf,
        /// The method
        #[arg(long, value_name = "NAME", default_value = "nsgs", value_parser = parser_of::<Method>())]
        method: Method,
        /// Residual to reach
        #[arg(long, value_name = "X", default_value_t = 1e-8, allow_negative_numbers = true)]
        tolerance: f64,
        /// Give up after this many sweeps
        #[arg(long, value_name = "N", default_value_t = 1_000_000)]
        max_sweeps: u32,
        /// Solve it this many times and give the least time
        #[arg(long, value_name = "N", default_value_t = 1)]
        repeat: u32,
        /// Work on W alone, whether or not the file has bodies
        #[arg(long)]
        without_bodies: bool,
        /// Write velocities and impulses to this file (JSON)
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
}

impl ProblemCommand {
    /// Does what is asked.
    pub(super) fn run(self) -> Result<()> {
        match self {
            Self::Dump { config, at, out } => {
                check_file("out", &out)?;
                let scene = settled(&config)?;
                scene.parameters.check_steps("at", at)?;
                warn_of_steps(scene.parameters.steps_in(at));
                let progress = Progress::new("running", 100);
                let file = problem_file_at(&scene, at, |time| {
                    progress.set((100.0 * time / at) as u64);
                });
                progress.finish();
                let file = file?;
                write_file(&out, file.text().as_bytes())?;
                print_line(format_args!("{} contacts in {}", file.nc, out.display()));
                Ok(())
            }
            Self::Solve { file, method, tolerance, max_sweeps, repeat, without_bodies, out } => {
                out.as_deref().map(|out| check_file("out", out)).transpose()?;
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
                    ..SolverSettings::default()
                };
                let solution = solve_file(&problem, &settings, repeat)?;
                tell(&solution);
                match out {
                    Some(out) => write_file(&out, solution.text().as_bytes()),
                    None => Ok(()),
                }
            }
        }
    }
}

fn tell(solution: &Solution) {
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
    let converged = match (solution.converged, solution.stalled) {
        (true, _) => "yes",
        (false, true) => "no: stalled, more sweeps are of no use",
        (false, false) => "no: stopped too early",
    };
    print_line(format_args!("converged       {converged}"));
}
