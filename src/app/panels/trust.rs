//! The verdict "Can I trust this?" on the displayed run: one word in the status bar, and a panel that gives the
//! reasons. The panel contains a sentence, the bars of an error budget (estimated effects of initial state, contact
//! law, time step and solver on a result), how well the steps were solved, warnings, and the mean slump of runs from
//! other initial states. Idle cores compute the error budget after the panel was opened. The cores continue when the
//! panel is closed, until the settings change.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use egui::{
    Align, Button, Color32, CornerRadius, Label, Layout, Rect, RichText, ScrollArea, Sense, Stroke,
    Ui, pos2, vec2,
};

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
use crate::study::{
    BudgetAnswer, BudgetEffect, BudgetOptions, ErrorBudget, FEW_UNSOLVED, Trust, made_budget,
};

/// Time limit for the computation of an error budget on the idle cores, s.
const COST_SECS: f64 = 300.0;
/// Quantity whose error is estimated in scenes that are not heaps, because slump is meaningful only for heaps.
const OTHERWISE: &str = "mean(kinetic_energy)";

/// Text that the panel shows until the error budget has its first result.
const UNDER_WAY: &str = "Idle cores compute an error budget. The first answer takes a minute for a hundred grains, \
    and hours for thousands.";

/// Width of the names to the left of the bars, points.
const NAMES: f32 = 150.0;
/// Height of a bar of the error budget including the space to the next bar, points.
const ROW: f32 = 18.0;
/// Height of a bar of the error budget without the space to the next bar, points.
const BAR: f32 = 9.0;

/// The verdict "Can I trust this?" in the status bar, and the panel with its reasons.
#[derive(Default)]
pub(crate) struct TrustPanel {
    /// True while the panel is open.
    pub is_open: bool,
    budget: Option<RunBudget>,
}

/// The error budget of a run, finished or in progress.
struct RunBudget {
    /// Command line that reproduces the run. If the displayed run has another command line, the error budget is not
    /// valid for it.
    of: String,
    /// Latest result of the error budget; `None` before the first result.
    told: Arc<Mutex<Option<BudgetAnswer>>>,
    work: Option<Work<()>>,
    /// Error message if the error budget could not be computed.
    failure: Option<String>,
}

impl TrustPanel {
    /// Returns the verdict on whether the displayed run can be trusted, and the reason in a sentence.
    fn verdict(&self, run: &WatchedRun) -> (Trust, String) {
        const BAD: [AlarmKind; 4] = [
            AlarmKind::NotFinite,
            AlarmKind::GrainLost,
            AlarmKind::GrainLeft,
            AlarmKind::EnergyCreated,
        ];
        let Some(world) = run.world() else { return (Trust::NotKnownYet, String::new()) };
        if let Some(failure) = &world.failure {
            return (Trust::No, format!("The run failed: {failure}."));
        }
        if let Some(alarm) = world.alarms.iter().find(|alarm| BAD.contains(&alarm.kind)) {
            return (Trust::No, alarm.text.to_string());
        }
        if let Some(warning) = warning(world) {
            return (Trust::No, warning);
        }
        let (steps, unsolved) = (world.snapshot.observables.step, world.unconverged_steps);
        if unsolved as f64 > FEW_UNSOLVED * steps.max(1) as f64 {
            return (Trust::No, format!("In this run {}.", unsolved_text(unsolved, steps)));
        }
        let Some(BudgetAnswer { trust, quantity, within_text, .. }) = self.of_budget(run) else {
            let text = match self.budget.as_ref().is_some_and(|budget| budget.work.is_some()) {
                true => UNDER_WAY,
                false => "Nobody has computed how much the method changes the result.",
            };
            return (Trust::NotKnownYet, text.into());
        };
        let reason = match trust {
            Trust::Yes => format!(
                "Neither the method nor the choice of a law changes {quantity} by more than {within_text}."
            ),
            Trust::Mostly => format!(
                "The method changes {quantity} by at most {within_text}; the choice of a law may change it by more."
            ),
            Trust::No => format!("The method changes {quantity} by more than {within_text}."),
            Trust::NotKnownYet => format!(
                "More runs must show if the method changes {quantity} by more than {within_text}."
            ),
        };
        (trust, reason)
    }

    /// Returns the latest result of the error budget; `None` if no result exists for the displayed run with the present
    /// settings.
    fn of_budget(&self, run: &WatchedRun) -> Option<BudgetAnswer> {
        let budget = self.budget.as_ref()?;
        let told = budget.told.lock().unwrap_or_else(PoisonError::into_inner).clone()?;
        (run.command_line().as_ref() == Some(&budget.of)).then_some(told)
    }

    /// Shows the button with the verdict in the status bar, which opens or closes the panel. Returns the
    /// reason not to trust the run; `None` if the run can be trusted or the verdict is not known yet.
    pub(super) fn button(&mut self, ui: &mut Ui, context: &mut PanelContext<'_>) -> Option<String> {
        let (trust, reason) = self.verdict(context.run);
        let dark = ui.visuals().dark_mode;
        let colour = match trust {
            Trust::Yes | Trust::Mostly => theme::good(dark),
            Trust::No if !context.touring => theme::warning(dark),
            Trust::No | Trust::NotKnownYet => ui.visuals().text_color(),
        };
        let text = RichText::new(heading(context.run, trust)).color(colour);
        let button = ui.add(Button::selectable(self.is_open, text).frame_when_inactive(true));
        context.note_control("trust", button.rect);
        let hint = format!("{reason} A click opens the whole answer.");
        self.is_open ^= button.on_hover_text(hint).clicked();
        (trust == Trust::No).then_some(reason)
    }

    /// Shows the panel: the reason of the verdict, the progress of the error budget, the bars of the error budget, and
    /// below them the solved steps and warnings. Until the error budget has a result, the panel also shows the mean
    /// slump of runs from other initial states.
    pub(super) fn show(&mut self, ui: &mut Ui, context: &PanelContext<'_>) {
        let (trust, reason) = self.verdict(context.run);
        ui.horizontal(|ui| {
            ui.heading(heading(context.run, trust));
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let close = ui.button("✖").on_hover_text("Close (Esc). The computation continues.");
                self.is_open &= !close.clicked();
            });
        });
        ui.label(RichText::new(&reason).strong());
        // Above the bars, so that the button is visible in a low window, too.
        if let Some(work) = self.budget.as_ref().and_then(|budget| budget.work.as_ref()) {
            work.show(ui, "Error budget", "Stop", "The results so far stay.");
        }
        ScrollArea::vertical().id_salt("trust").auto_shrink([false, false]).show(ui, |ui| {
            let answer = self.of_budget(context.run);
            if let Some(answer) = answer.as_ref().filter(|answer| !answer.effects.is_empty()) {
                bars(ui, answer);
            }
            if let Some(world) = context.run.world() {
                for line in solved(world) {
                    ui.label(line);
                }
            }
            // Lessons demonstrate errors on purpose, so their warnings have the usual colour of text.
            let colour = match context.touring {
                true => ui.visuals().text_color(),
                false => theme::warning(ui.visuals().dark_mode),
            };
            let warnings = context.run.world().and_then(warning);
            let others = warnings.into_iter().chain(alarms(context.run));
            for alarm in others.filter(|alarm| *alarm != reason) {
                ui.label(RichText::new(format!("▲ {alarm}")).color(colour));
            }
            // The text of the error budget has a mean of its own, over other piles.
            if let (None, Some(said), Some(world)) = (
                &answer,
                context.ensemble.said(&context.run.frame, context.run.selected),
                context.run.world(),
            ) {
                let slump = world.snapshot.observables.slump;
                ui.label(format!("● This pile slumps by {slump:.3}; {said}."))
                    .on_hover_text(context.ensemble.about(context.run.selected));
            }
            ui.separator();
            self.show_budget(ui, answer.as_ref());
        });
    }

    /// Shows the result of the error budget in words.
    fn show_budget(&self, ui: &mut Ui, answer: Option<&BudgetAnswer>) {
        if IN_BROWSER {
            let text = "In a browser one thread computes, so there is no error budget. The program computes it: slump \
                budget with the command line of this run.";
            ui.label(RichText::new(text).weak());
            return;
        }
        let Some(budget) = &self.budget else {
            let text = "A run that went on from a file, or a scene that is no longer there, has no error budget.";
            ui.label(RichText::new(text).weak());
            return;
        };
        if let Some(failure) = &budget.failure {
            ui.label(RichText::new(failure).weak());
            return;
        }
        if let Some(answer) = answer {
            ui.label(&answer.text);
        }
    }

    /// If the panel is open, starts to compute the error budget of the displayed run. Discards an error budget that was
    /// computed for other settings.
    pub(super) fn follow(&mut self, ui: &Ui, context: &PanelContext<'_>) {
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

/// Returns the question "Can I trust this?" with its answer in a few words. If simulations are compared, the question
/// is about the selected simulation.
fn heading(run: &WatchedRun, trust: Trust) -> String {
    let asked = match run.compares() {
        true => format!("Can I trust run {}?", run.selected + 1),
        false => "Can I trust this?".to_owned(),
    };
    format!("{asked} {}", trust.words())
}

/// Shows the effects of an error budget as bars with their confidence intervals, the largest effect first, as in the
/// picture of the command `slump budget`.
fn bars(ui: &mut Ui, answer: &BudgetAnswer) {
    let BudgetAnswer { quantity, within, within_text, effects, .. } = answer;
    let ends = effects.iter().flat_map(|effect| effect.adds).filter(|end| end.is_finite());
    let reach = 1.05 * ends.map(f64::abs).fold(*within, f64::max);
    ui.label(RichText::new(format!("Effect of each change on {quantity}")).small());
    for effect in effects {
        bar(ui, effect, *within, reach);
    }
    ui.horizontal_wrapped(|ui| {
        let mut named: Vec<&str> = Vec::new();
        for BudgetEffect { share, colour: (red, green, blue), .. } in effects {
            if !named.contains(share) {
                named.push(share);
                ui.label(RichText::new("■").small().color(Color32::from_rgb(*red, *green, *blue)));
                ui.label(RichText::new(*share).small());
            }
        }
        ui.label(RichText::new(format!("grey lines: ± {within_text}")).small().weak());
    });
}

/// Draws one bar of an error budget: the name of a change (such as another solver), its effect on the result, and the
/// confidence interval of the effect. Grey lines at ±`within` show the largest acceptable effect of the numerical
/// method. The ends of the axis are ±`reach`. Both have the unit of the result.
fn bar(ui: &mut Ui, effect: &BudgetEffect, within: f64, reach: f64) {
    let BudgetEffect { share, colour: (red, green, blue), changed, adds: [mean, low, high] } =
        effect;
    let response = ui.horizontal(|ui| {
        let name = Label::new(RichText::new(changed).small()).truncate();
        ui.allocate_ui_with_layout(vec2(NAMES, ROW), Layout::left_to_right(Align::Center), |ui| {
            ui.set_min_size(vec2(NAMES, ROW));
            ui.add(name);
        });
        let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
        let at = |value: f64| {
            let part = (value.clamp(-reach, reach) / reach) as f32;
            area.center().x + 0.5 * area.width() * part
        };
        let (painter, y) = (ui.painter(), area.center().y);
        let grey = Stroke::new(1.0, Color32::GRAY);
        for end in [-within, within] {
            painter.vline(at(end), area.y_range(), grey);
        }
        let [from, to] = [at(0.0).min(at(*mean)), at(0.0).max(at(*mean))];
        let shape =
            Rect::from_min_max(pos2(from, y - 0.5 * BAR), pos2(to.max(from + 1.0), y + 0.5 * BAR));
        painter.rect_filled(shape, CornerRadius::ZERO, Color32::from_rgb(*red, *green, *blue));
        let ink = Stroke::new(1.2, ui.visuals().text_color());
        painter.hline(at(*low)..=at(*high), y, ink);
        painter.vline(at(0.0), area.y_range(), Stroke::new(1.0, ink.color));
    });
    let text = format!("{changed} ({share}): {mean:+.3}, between {low:+.3} and {high:+.3}");
    response.response.on_hover_text(text);
}

/// Returns a warning if a grain at rest would fall by more than 0.2 mean diameters in one step of a simulation (in one
/// substep if the stepper divides its steps), because contacts would then be found too late.
fn warning(world: &WorldFrame) -> Option<String> {
    too_long(&world.controls.settings, &world.snapshot.surroundings, world.substeps)
}

/// Returns a clause with the number of unsolved steps, such as "1 of 200 steps was not solved".
fn unsolved_text(unsolved: u64, steps: u64) -> String {
    let were = if unsolved == 1 { "was" } else { "were" };
    format!("{unsolved} of {} {were} not solved", counted(steps, "step"))
}

/// Returns sentences on how well the steps of a simulation were solved.
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
        // Rounded up, because 0.000 would mean that there is no error.
        compact((1e6 * last.velocity_error).ceil() / 1e3)
    );
    let Settings { parameters, solver, .. } = &world.controls.settings;
    if *solver == FAST.among(&world.snapshot.surroundings, parameters) {
        let mut lines = vec![format!("● A step gets 40 sweeps, solved or not: {off}.")];
        if parameters.bond > 0.0 {
            lines.push(
                "● With cohesion, piles can slump although they would not if each step were solved. Choose Solved \
                 under Law, solver."
                    .into(),
            );
        }
        return lines;
    }
    let unsolved = world.unconverged_steps;
    if unsolved == 0 {
        return vec![format!("● All {} are solved as asked, {off}.", counted(last.step, "step"))];
    }
    let mut lines =
        vec![format!("● In this run {} as asked, {off}.", unsolved_text(unsolved, last.step))];
    if *solver != SOLVED.among(&world.snapshot.surroundings, parameters) {
        lines.push("● With Solved, under Law, solver, fewer steps are unsolved.".into());
    }
    lines
}

/// Starts to compute the error budget of the run with the configuration `config` and the command line `of`.
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
    let told: Arc<Mutex<Option<BudgetAnswer>>> = Arc::default();
    let states = context.ensemble.folder.clone();
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_step_was_and_two_steps_were_not_solved() {
        assert_eq!(unsolved_text(1, 200), "1 of 200 steps was not solved");
        assert_eq!(unsolved_text(2, 200), "2 of 200 steps were not solved");
    }
}
