//! Panel: published experiments, what was published and measured of each, and the scenes that they are like.

use egui::{CollapsingHeader, Color32, RichText, TextEdit, Ui};

use crate::app::state::AppState;
use crate::app::theme;
use crate::app::validation::{COMMAND, Found, Measured, Published, Validation, scene_of};
use crate::config::Config;
use crate::study::Verdict;

/// Shows the panel.
pub(crate) fn show(ui: &mut Ui, state: &mut AppState) {
    source(ui, state);
    let mut opened = None;
    for of_one in state.validation.experiments() {
        let name = &of_one[0].experiment;
        let title = format!("{name}: {}", counted(of_one));
        CollapsingHeader::new(title).id_salt(("experiment", name)).show(ui, |ui| {
            if let Some(scene) = scene_of(name) {
                let open = ui.button(format!("Open {scene}"));
                let hint = format!("The built-in scene that is most like that of {name}.");
                if open.on_hover_text(hint).clicked() {
                    opened = Some(scene);
                }
            }
            for of_way in of_one.chunk_by(|one, other| one.way == other.way) {
                ui.label(RichText::new(&of_way[0].way).small().strong());
                table(ui, of_way);
            }
        });
    }
    if let Some(scene) = opened {
        state.load(Config::of_scene(scene));
    }
}

/// Which report shows, and the field that asks for another.
fn source(ui: &mut Ui, state: &mut AppState) {
    ui.horizontal(|ui| {
        let hint = "The quantities.json that slump validate wrote, or its folder.";
        let label = ui.label("Report").on_hover_text(hint);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let is_named = !state.report.trim().is_empty();
            let read = ui.add_enabled(is_named, egui::Button::new("Read"));
            let edit = TextEdit::singleline(&mut state.report)
                .desired_width(f32::INFINITY)
                .hint_text("validation/");
            let typed = ui.add(edit).labelled_by(label.id);
            let enter = ui.input(|input| input.key_pressed(egui::Key::Enter));
            if is_named && (read.clicked() || (typed.lost_focus() && enter)) {
                match Validation::read(state.report.trim().as_ref()) {
                    Ok(report) => state.validation = report,
                    Err(error) => state.warn(error.to_string()),
                }
            }
        });
    });
    let from = &state.validation.from;
    let told = format!(
        "{from}. What lies with its whole interval in the published band agrees. {COMMAND} makes a report anew."
    );
    ui.label(RichText::new(told).small().weak());
}

/// How many quantities came out each way.
fn counted(found: &[Found]) -> String {
    let count = |verdict| found.iter().filter(|found| found.verdict == verdict).count();
    format!(
        "{} agree, {} differ, {} open",
        count(Verdict::Agrees),
        count(Verdict::Differs),
        count(Verdict::NotDecided)
    )
}

fn table(ui: &mut Ui, found: &[Found]) {
    let dark = ui.visuals().dark_mode;
    let weak = ui.visuals().weak_text_color();
    row(ui, ["measured", "published", "verdict"], weak, "");
    for Found { quantity, system, published, measured, verdict, .. } in found {
        let Published { low, high, provenance, source } = published;
        let hint = format!("{quantity} of {system}. Published ({provenance}): {source}");
        ui.label(RichText::new(quantity).small()).on_hover_text(&hint);
        let (text, colour) = words(*verdict, dark, weak);
        row(ui, [&interval(measured), &band(*low, *high), text], colour, &hint);
    }
}

/// A row of three columns, the last in a colour of its own.
fn row(ui: &mut Ui, texts: [&str; 3], colour: Color32, hint: &str) {
    ui.columns_const(|columns: &mut [Ui; 3]| {
        for (index, (column, text)) in columns.iter_mut().zip(texts).enumerate() {
            let text = RichText::new(text).small();
            let text = if index == 2 { text.color(colour) } else { text.weak() };
            // Broken into lines a number is none.
            let shown = column.add(egui::Label::new(text).extend());
            if !hint.is_empty() {
                shown.on_hover_text(hint);
            }
        }
    });
}

fn words(verdict: Verdict, dark: bool, weak: Color32) -> (&'static str, Color32) {
    match verdict {
        Verdict::Agrees => ("● agrees", theme::good(dark)),
        Verdict::Differs => ("● differs", theme::warning(dark)),
        Verdict::NotDecided => ("○ open", weak),
    }
}

fn short(number: f64) -> String {
    let digits = if number.abs() < 10.0 { 3 } else { 1 };
    format!("{number:.digits$}").replace('-', "−")
}

fn interval(measured: &Measured) -> String {
    let Measured { mean, low, high } = measured;
    match (mean, low, high) {
        (Some(mean), Some(low), Some(high)) => {
            format!("{} ± {}", short(*mean), short(0.5 * (high - low)))
        }
        (Some(mean), ..) => short(*mean),
        _ => "none".to_owned(),
    }
}

fn band(low: Option<f64>, high: Option<f64>) -> String {
    match (low, high) {
        (Some(low), Some(high)) => format!("{} … {}", short(low), short(high)),
        (None, Some(high)) => format!("≤ {}", short(high)),
        (Some(low), None) => format!("≥ {}", short(low)),
        (None, None) => "none".to_owned(),
    }
}
