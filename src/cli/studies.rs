//! Commands of studies: `sweep`, `budget`, `calibrate`, `reproduce`, `chart`, `stability` and `validate`.

use std::path::{Path, PathBuf};

use clap::builder::PossibleValuesParser;

use crate::VERSION;
use crate::config::{Config, joined};
use crate::error::{Error, Result};
use crate::headless::draw_snapshots;
use crate::output::{
    Progress, check_new_file, check_writable, note_line, print_line, print_text, remove_drafts,
    write_file,
};
use crate::study::chart::{png, svg};
use crate::study::stability::{
    CHALLENGES, Challenge, StabilityTable, count_of_maps, maps, picture,
};
use crate::study::{
    BudgetOptions, CalibrateOptions, ChartOptions, RunsTable, Shard, Study, SweepOptions,
    ValidateOptions, budget, calibrate, chart_speed, figure_names, merge, reproduce, sweep,
    validate, write_means,
};
use crate::threads::make_threads;

/// The commands that compute one result from many simulations, such as `slump sweep` and `slump budget`.
#[derive(clap::Subcommand)]
pub(super) enum StudyCommand {
    /// Run a study: one run for each combination of the parameter values in its lists and ranges, on all cores
    #[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
    Sweep {
        /// The study file (NAME.toml)
        #[arg(value_name = "STUDY", required = true)]
        study: Option<PathBuf>,
        /// Folder for the results; the same command continues where it stopped
        #[arg(long, value_name = "DIR", required = true)]
        out: Option<PathBuf>,
        /// Run only part K of N parts of the study; `slump sweep merge` joins the parts
        #[arg(long, value_name = "K/N")]
        shard: Option<String>,
        /// Run the quick pass of the study: fewer runs, with the values in the table `quick` of the study file
        #[arg(long)]
        quick: bool,
        /// Remove results of another study, or unreadable results, from the folder
        #[arg(long)]
        redo: bool,
        /// Print one command per run, for GNU parallel or the queue of a cluster, and run nothing; `slump sweep merge` joins the runs
        #[arg(long, conflicts_with_all = ["shard", "redo"])]
        list: bool,
        #[command(subcommand)]
        command: Option<SweepAction>,
    },
    /// Estimate how much of a result is due to the initial state, the contact law, the time step and the solver
    Budget {
        // Boxed because this variant is by far the largest.
        #[command(flatten)]
        config: Box<Config>,
        /// Result to explain: the value of a column (slump, max_overlap, coordination, …) at the end of the run, or
        /// mean(x), min(x), max(x) or total(x) of a column x between the times --from and --to; can be given several
        /// times [default: slump]
        #[arg(long = "quantity", value_name = "X", help_heading = "Budget")]
        quantities: Vec<String>,
        /// Simulated time at which mean(x), min(x), max(x) and total(x) of a result x begin, seconds [default: 0]
        #[arg(long = "from", value_name = "SECONDS", help_heading = "Budget")]
        from_secs: Option<f64>,
        /// Simulated time at which the runs end, and with them mean(x), min(x), max(x) and total(x) of a result x,
        /// seconds [default: the duration of the scene]
        #[arg(long = "to", value_name = "SECONDS", help_heading = "Budget")]
        to_secs: Option<f64>,
        /// Half-width at which the confidence intervals are narrow enough, so that no more runs follow, in the unit of
        /// the result [default: a tenth of its value]
        #[arg(long, value_name = "X", help_heading = "Budget")]
        within: Option<f64>,
        /// Limit of the computing time, as wall-clock time with all cores in use: 90s, 30min, 2h
        #[arg(long = "cost", value_name = "TIME", help_heading = "Budget", default_value = "5min", value_parser = secs_of)]
        cost_secs: f64,
        /// Compute only part K of N of the initial states, for example on another machine; the same command without this option joins the parts in the folder
        #[arg(long, value_name = "K/N", help_heading = "Budget")]
        shard: Option<String>,
        /// Folder for report, picture and tables; the same command continues where it stopped
        #[arg(long, value_name = "DIR", help_heading = "Budget")]
        out: PathBuf,
    },
    /// Find the parameters with which a scene reproduces measured values
    Calibrate {
        #[command(flatten)]
        config: Box<Config>,
        /// Measured value with its standard error, as in slump=0.35±0.02 (or 0.35+-0.02), at the end of the run: a
        /// quantity of `slump budget`, such as repose_angle (degrees) or run_out (m), the slope and the half base of a
        /// triangular heap in which the grains have the same mean height and the same mean distance from the middle;
        /// can be given several times
        #[arg(
            long = "target",
            value_name = "X=VALUE±ERROR",
            help_heading = "Calibration",
            required = true
        )]
        targets: Vec<String>,
        /// Parameter with its range, as in bond=0..50; can be given up to four times
        #[arg(
            long,
            value_name = "SETTING=FROM..TO",
            help_heading = "Calibration",
            required = true
        )]
        vary: Vec<String>,
        /// Number of runs, each from another initial state; the first seed is that of --seed, or 1, and the following
        /// seeds are the next integers [default: 40, 100, 200 or 350 for 1 to 4 parameters]
        #[arg(long, value_name = "N", help_heading = "Calibration")]
        runs: Option<usize>,
        /// Folder for report, picture and numbers; the same command continues where it stopped
        #[arg(long, value_name = "DIR", help_heading = "Calibration")]
        out: PathBuf,
    },
    /// Compute the figures of the paper (Abramian & Staron, 2020), and the maps over two parameters that the conclusion
    /// of the paper asks for
    Reproduce {
        /// Names of the figures; `all` computes all figures
        #[arg(required = true, value_name = "FIGURE", value_parser = PossibleValuesParser::new(figure_names()))]
        figures: Vec<String>,
        /// Folder for figures, tables and report; the same command continues where it stopped
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
        /// Compute a coarser version of the figures, in a few minutes
        #[arg(long)]
        quick: bool,
    },
    /// Chart the error of every solver against its time, for single steps and whole simulations
    Chart(ChartOptions),
    /// Run every solver on scenes that are made to break solvers, and report whether it holds, degrades or fails at
    /// each level of difficulty
    Stability {
        /// Names of the scenes to run [default: all]
        #[arg(value_name = "SCENE")]
        scenes: Vec<String>,
        /// Folder for the table of verdicts and its picture; if no scene is named, also for the stability maps, which
        /// show for which values of two parameters a solver keeps a scene at rest
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// CSV file for the table of verdicts
        #[arg(long, value_name = "FILE")]
        table: Option<PathBuf>,
        /// Replace the file of --table if it exists; without this option an existing file is refused
        #[arg(long, requires = "table")]
        overwrite: bool,
        /// Leave out the longest runs, so that the command takes under a minute; the tests of Slump check this shorter
        /// table
        #[arg(long)]
        quick: bool,
    },
    /// Compare Slump with published experiments, and report each measured quantity with its 95 % interval, its verdict
    /// and its cost
    Validate(ValidateOptions),
}

#[derive(clap::Subcommand)]
pub(super) enum SweepAction {
    /// Join the parts of a study into runs.csv
    Merge {
        /// The study file (NAME.toml)
        study: PathBuf,
        /// Folders with parts of the study
        #[arg(required = true, value_name = "DIR")]
        parts: Vec<PathBuf>,
        /// Folder for runs.csv [default: the folder of the first part]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// The parts belong to the quick pass of the study (the table `quick` of the study file)
        #[arg(long)]
        quick: bool,
    },
    /// Print how many runs a study has
    Count {
        /// The study file (NAME.toml)
        study: PathBuf,
        /// Count the runs of the quick pass of the study (the table `quick` of the study file)
        #[arg(long)]
        quick: bool,
    },
}

impl StudyCommand {
    pub(super) fn run(self) -> Result<()> {
        make_threads()?;
        match self {
            Self::Sweep {
                command: Some(SweepAction::Merge { study, parts, out, quick }), ..
            } => {
                let study = Study::read(&study, quick)?;
                let out = out.unwrap_or_else(|| parts[0].clone());
                report_runs(&study, &merge(&study, &parts, &out)?, &out)
            }
            Self::Sweep { command: Some(SweepAction::Count { study, quick }), .. } => {
                print_line(Study::read(&study, quick)?.runs.len());
                Ok(())
            }
            Self::Sweep { study, out, shard, quick, redo, list, command: None } => {
                let missing = |field| Error::value(field, "missing", "given");
                let path = study.ok_or_else(|| missing("study"))?;
                let study = Study::read(&path, quick)?;
                let out = out.ok_or_else(|| missing("out"))?;
                if list {
                    return list_runs(&path, study.runs.len(), &out, quick);
                }
                let options = SweepOptions { shard: part_of(shard)?, redo, states: None };
                if let Some(table) = sweep(&study, &out, &options)? {
                    return report_runs(&study, &table, &out);
                }
                print_line(format_args!("a part of {} in {}", study.name, out.display()));
                Ok(())
            }
            Self::Budget {
                config,
                quantities,
                from_secs,
                to_secs,
                within,
                cost_secs,
                shard,
                out,
            } => {
                let (config, shard) = (*config, part_of(shard)?);
                let options = BudgetOptions {
                    config,
                    quantities,
                    from_secs,
                    to_secs,
                    within,
                    cost_secs,
                    shard,
                };
                budget(&options, &out).map(drop)
            }
            Self::Calibrate { config, targets, vary, runs, out } => {
                calibrate(&CalibrateOptions { config: *config, targets, vary, runs }, &out)
                    .map(drop)
            }
            Self::Reproduce { figures, out, quick } => {
                reproduce(&figures, &out, quick, VERSION, draw_snapshots)
            }
            Self::Chart(options) => chart_speed(&options, VERSION),
            Self::Stability { scenes, out, table, overwrite, quick } => {
                if let Some(path) = &table {
                    check_new_file("table", path, overwrite)?;
                }
                stability(&scenes, out.as_deref(), table.as_deref(), quick)
            }
            Self::Validate(options) => validate(&options, VERSION),
        }
    }
}

fn part_of(shard: Option<String>) -> Result<Option<Shard>> {
    shard.map(|text| text.parse()).transpose()
}

/// Converts a time with its unit, such as 30min, to seconds.
fn secs_of(text: &str) -> std::result::Result<f64, String> {
    let allowed = || "a time > 0 with its unit, as in 90s, 30min or 2h".to_owned();
    let digits = text.find(|sign: char| sign.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = text.split_at(digits);
    let unit = match unit {
        "s" => 1.0,
        "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(allowed()),
    };
    let secs = number.trim().parse().map(|number: f64| unit * number).map_err(|_| allowed())?;
    if secs > 0.0 && secs.is_finite() { Ok(secs) } else { Err(allowed()) }
}

/// Prints one command for each run of a study. A command that was interrupted can be executed again.
fn list_runs(study: &Path, runs: usize, out: &Path, quick: bool) -> Result<()> {
    let text = |path: &Path| {
        let allowed = "a name that is text";
        let text = path.to_str().map(str::to_owned);
        text.ok_or_else(|| Error::value("path", path.display(), allowed))
    };
    let (study, out) = (text(study)?, text(out)?);
    for run in 1..=runs {
        let mut words = ["slump", "sweep", &study, "--out", &out].map(str::to_owned).to_vec();
        words.extend(["--shard".to_owned(), format!("{run}/{runs}")]);
        words.extend(quick.then(|| "--quick".to_owned()));
        print_line(joined(&words));
    }
    Ok(())
}

fn report_runs(study: &Study, table: &RunsTable, folder: &Path) -> Result<()> {
    write_means(study, table, folder, VERSION)?;
    let (runs, file) = (table.rows.len(), folder.join("runs.csv"));
    let secs: f64 = table.wall_secs.iter().sum();
    print_line(format_args!("{runs} runs in {} ({secs:.0} core seconds)", file.display()));
    let ended = table.not_finite();
    if ended > 0 {
        note_line(format_args!("{ended} runs ended early: their state was no longer finite"));
    }
    if let Some(told) = table.alarms() {
        note_line(format_args!("{told}"));
    }
    Ok(())
}

fn stability(
    scenes: &[String],
    out: Option<&Path>,
    table_path: Option<&Path>,
    quick: bool,
) -> Result<()> {
    let named: Result<Vec<_>> = scenes.iter().map(|name| Challenge::named(name)).collect();
    let challenges = match named? {
        named if named.is_empty() => CHALLENGES.iter().collect(),
        named => named,
    };
    if let Some(folder) = out {
        check_writable("out", folder)?;
    }
    let progress = Progress::new("stability", StabilityTable::count(&challenges, quick) as u64);
    let table = StabilityTable::run(&challenges, quick, || {
        progress.advance(1);
    });
    progress.finish();
    let table = table?;
    print_text(&table);
    // The table is written before the maps are computed, which takes the longest.
    if let Some(path) = table_path {
        write_file(path, &table.to_csv()?)?;
        print_line(path.display());
    }
    if let Some(folder) = out {
        write_file(&folder.join("table.csv"), &table.to_csv()?)?;
        draw_stability(&table, scenes, folder, quick)?;
        remove_drafts(folder)?;
        print_line(folder.display());
    }
    Ok(())
}

fn draw_stability(
    table: &StabilityTable,
    scenes: &[String],
    folder: &Path,
    quick: bool,
) -> Result<()> {
    let mut sheets = vec![("table".to_owned(), picture(table))];
    if scenes.is_empty() {
        let progress = Progress::new("maps", count_of_maps() as u64);
        let found = maps(quick, || progress.advance(1));
        progress.finish();
        sheets.extend(found?);
    }
    let quick = if quick { " --quick" } else { "" };
    let scenes: String = scenes.iter().map(|name| format!(" {name}")).collect();
    let command = format!("slump stability{quick}{scenes} --out stability");
    for (name, sheet) in &sheets {
        write_file(&folder.join(format!("{name}.png")), &png(sheet, &command)?)?;
        write_file(&folder.join(format!("{name}.svg")), svg(sheet)?.as_bytes())?;
        if name != "table" {
            write_file(&folder.join(format!("{name}.csv")), &sheet.to_csv()?)?;
        }
    }
    Ok(())
}
