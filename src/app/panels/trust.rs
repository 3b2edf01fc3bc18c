//! "Can I trust this?": one word on the run that is shown, and the list behind it: how its steps were solved, what went
//! wrong, the slump of other initial states, and an error budget. Idle cores compute the budget once the list has been
//! opened. They continue when the list is closed, until the settings change.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use egui::{Align2, RichText, Ui};

use super::alarms::alarms;
use super::grain::compact;
use crate::Instant;
use crate::app::IN_BROWSER;
use crate::app::budget::{FAST, SOLVED, too_long};
use crate::app::context::PanelContext;
use crate::app::ensemble::on_idle_cores;
use crate::app::theme;
use crate::app::watched_run::WatchedRun;
use crate::app::work::{Work, outcome_of_ended};
use crate::config::Config;
use crate::error::Error;
use crate::live::WorldFrame;
use crate::output::counted;
use crate::sim::{AlarmKind, Settings};
use crate::study::{BudgetOptions, ErrorBudget, Trust, made_budget};

/// Time that a budget may take of the idle cores, s.
const COST_SECS: f64 = 300.0;
/// Of other scenes than heaps, what a budget is of.
const OTHERWISE: &str = "mean(kinetic_energy)";
/// Part of the steps up to which unsolved ones leave the rest worth something.
const FEW: f64 = 0.01;

/// The answer before the first one.
const UNDER_WAY: &str = "Idle cores compute an error budget. The first answer takes a minute for a hundred grains, \
    and hours for thousands.";

/// The word in the status bar, and the list behind it.
#[derive(Default)]
pub(super) struct TrustPanel {
    /// True while the list is open.
    is_open: bool,
    budget: Option<RunBudget>,
}

/// The budget of a run, or what there is of it.
struct RunBudget {
    /// What it is of: the command line that the run is made by.
    of: String,
    /// Its verdict and paragraph.
    told: Arc<Mutex<Option<(Trust, String)>>>,
    work: Option<Work<()>>,
    /// Why there is none.
    failure: Option<String>,
}

impl TrustPanel {
    /// The word on the run that is shown.
    fn word(&self, run: &WatchedRun) -> Trust {
        let Some(world) = run.world() else { return Trust::NotKnownYet };
        const BAD: [AlarmKind; 4] = [
            AlarmKind::NotFinite,
            AlarmKind::GrainLost,
            AlarmKind::GrainLeft,
            AlarmKind::EnergyCreated,
        ];
        let is_bad = world.alarms.iter().any(|alarm| BAD.contains(&alarm.kind));
        let steps = world.snapshot.observables.step.max(1);
        let unsolved = world.unconverged_steps as f64;
        if world.failure.is_some()
            || is_bad
            || warning(world).is_some()
            || unsolved > FEW * steps as f64
        {
            return Trust::No;
        }
        self.of_budget(run).map_or(Trust::NotKnownYet, |(trust, _)| trust)
    }

    /// What the budget says, where there is one of the present settings.
    fn of_budget(&self, run: &WatchedRun) -> Option<(Trust, String)> {
        let budget = self.budget.as_ref()?;
        let told = budget.told.lock().unwrap_or_else(PoisonError::into_inner).clone()?;
        (run.command_line().as_ref() == Some(&budget.of)).then_some(told)
    }

    /// The word in the status bar, which opens the list.
    pub(super) fn button(&mut self, ui: &mut Ui, context: &mut PanelContext<'_>) {
        let trust = self.word(context.run);
        let dark = ui.visuals().dark_mode;
        let colour = match trust {
            Trust::Yes | Trust::Mostly => theme::good(dark),
            Trust::No if !context.touring => theme::warning(dark),
            Trust::No | Trust::NotKnownYet => ui.visuals().text_color(),
        };
        let text = RichText::new(format!("Can I trust this? {}", trust.words())).color(colour);
        let button = ui.selectable_label(self.is_open, text);
        context.note_control("trust", button.rect);
        let hint = "Is a number of this run the grains', the law's or the method's? A click opens the list.";
        self.is_open ^= button.on_hover_text(hint).clicked();
    }

    /// The list, where it is open.
    pub(super) fn show(&mut self, ui: &mut Ui, context: &PanelContext<'_>) {
        self.follow(ui, context);
        if !self.is_open {
            return;
        }
        let mut is_open = true;
        egui::Window::new("Can I trust this?")
            .anchor(Align2::LEFT_BOTTOM, [12.0, -40.0])
            .default_width(420.0)
            .collapsible(false)
            .resizable(false)
            .open(&mut is_open)
            .show(ui.ctx(), |ui| {
                ui.set_max_width(420.0);
                if let Some(world) = context.run.world() {
                    for line in solved(world) {
                        ui.label(line);
                    }
                }
                // A lesson shows what goes wrong with open eyes.
                let colour = match context.touring {
                    true => ui.visuals().text_color(),
                    false => theme::warning(ui.visuals().dark_mode),
                };
                for alarm in
                    context.run.world().and_then(warning).into_iter().chain(alarms(context.run))
                {
                    ui.label(RichText::new(format!("▲ {alarm}")).color(colour));
                }
                if let (Some(said), Some(world)) = (
                    context.ensemble.said(&context.run.frame, context.run.selected),
                    context.run.world(),
                ) {
                    let slump = world.snapshot.observables.slump;
                    ui.label(format!("● This pile slumps by {slump:.3}; {said}."))
                        .on_hover_text(context.ensemble.about(context.run.selected));
                }
                ui.separator();
                self.show_budget(ui, context.run);
            });
        self.is_open &= is_open;
    }

    /// What the error budget says, or how far it is.
    fn show_budget(&self, ui: &mut Ui, run: &WatchedRun) {
        if IN_BROWSER {
            let text = "A page has no idle cores: slump budget, with the command line of this run, computes its \
                error budget.";
            ui.label(RichText::new(text).weak());
            return;
        }
        let told = self.of_budget(run);
        let Some(budget) = &self.budget else {
            let text = "A run that went on from a file, or a scene that is no longer there, has no error budget.";
            ui.label(RichText::new(text).weak());
            return;
        };
        if let Some(failure) = &budget.failure {
            ui.label(RichText::new(failure).weak());
            return;
        }
        ui.label(told.as_ref().map_or(UNDER_WAY, |(_, answer)| answer));
        if let Some(work) = &budget.work {
            work.show(ui, "Error budget", "Stop", "What was found so far stays.");
        }
    }

    /// Has the budget follow the run that is shown.
    fn follow(&mut self, ui: &Ui, context: &PanelContext<'_>) {
        if let Some(budget) = &mut self.budget
            && let Some(outcome) = outcome_of_ended(&mut budget.work)
        {
            budget.failure = outcome.err().map(|error| error.to_string());
        }
        if IN_BROWSER || !(self.is_open || self.budget.is_some()) {
            return;
        }
        let line = context.run.command_line();
        if self.budget.as_ref().map(|budget| &budget.of) == line.as_ref() {
            return;
        }
        let is_from_start =
            context.run.world().is_some_and(|world| world.recorded_from_secs == 0.0);
        let settings = context.run.wanted_settings();
        let config = settings.map(|settings| context.run.config().with_settings(&settings));
        self.budget = match (line, config) {
            (Some(of), Some(config)) if is_from_start && self.is_open => {
                Some(begin(ui, context, of, config))
            }
            _ => None,
        };
    }
}

/// A warning of the time step of a world.
fn warning(world: &WorldFrame) -> Option<String> {
    too_long(&world.controls.settings, &world.snapshot.surroundings, world.substeps)
}

/// How the steps of a world were solved, a line a statement.
fn solved(world: &WorldFrame) -> Vec<String> {
    let last = &world.snapshot.observables;
    if !world.controls.settings.stepper.uses_method() {
        return vec![
            "● A step takes a fixed amount of work, and no test says how well it is done.".into(),
        ];
    }
    if last.step == 0 {
        return vec!["● No step has been taken yet.".into()];
    }
    let off = format!(
        "velocities of the last one are off by some {} mm/s",
        compact(1e3 * last.velocity_error)
    );
    let Settings { parameters, solver, .. } = &world.controls.settings;
    if *solver == FAST.among(&world.snapshot.surroundings, parameters) {
        let mut lines = vec![format!("● A step gets 40 sweeps, solved or not: {off}.")];
        if parameters.bond > 0.0 {
            lines.push(
                "● With cohesion piles fall so that stand if they are solved: Solved, under Law, solver, does that."
                    .into(),
            );
        }
        return lines;
    }
    let unsolved = world.unconverged_steps;
    if unsolved == 0 {
        return vec![format!("● All {} are solved as asked, {off}.", counted(last.step, "step"))];
    }
    let steps = counted(last.step, "step");
    let mut lines = vec![format!("● {unsolved} of {steps} were not solved as asked, {off}.")];
    if *solver != SOLVED.among(&world.snapshot.surroundings, parameters) {
        lines.push("● Solved, under Law, solver, leaves fewer.".into());
    }
    lines
}

/// Begins the budget of a run.
fn begin(ui: &Ui, context: &PanelContext<'_>, of: String, config: Config) -> RunBudget {
    let quantities = if context.run.slumps() { Vec::new() } else { vec![OTHERWISE.to_owned()] };
    let options = BudgetOptions {
        config,
        quantities,
        from_secs: None,
        to_secs: None,
        within: None,
        cost_secs: COST_SECS,
        shard: None,
    };
    let told: Arc<Mutex<Option<(Trust, String)>>> = Arc::default();
    let states = context.ensemble.folder();
    let to = Arc::clone(&told);
    let work = Work::start(ui.ctx(), Vec::new(), move |_: Vec<()>, reporter| {
        let refuse = |error| Error::value("temporary folder", error, "one that can be made");
        let folder = tempfile::tempdir().map_err(refuse)?;
        let states: PathBuf = states.unwrap_or_else(|| folder.path().join("states"));
        let begun = Instant::now();
        let note = |budget: &ErrorBudget| {
            *to.lock().unwrap_or_else(PoisonError::into_inner) = budget.first_answer();
        };
        on_idle_cores(|| {
            let tell = |budget: &ErrorBudget| {
                note(budget);
                reporter.tell(begun.elapsed().as_secs_f64() / COST_SECS)
            };
            made_budget(&options, folder.path(), &states, tell).map(|budget| note(&budget))
        })
    });
    RunBudget { of, told, work: Some(work), failure: None }
}
