//! The control of a setting, made from its declaration; a number can be dragged, typed and reset, and refuses what
//! makes no sense.

use egui::{
    Align, ComboBox, Rect, Response, RichText, Role, Slider, SliderClamping, TextEdit, Ui,
    WidgetInfo,
};

use super::theme;
use crate::setting::{About, Control, Kind, Value};
use crate::sim::Settings;
use crate::solver::{METHODS, SolverSettings};

/// Shows a setting and changes it; `start` says what a double click sets. Nothing is shown of a setting that
/// has no control. Where the control's slider or box lies.
pub(super) fn show(
    ui: &mut Ui,
    about: &About,
    settings: &mut Settings,
    start: &Settings,
) -> Option<Rect> {
    about.control.and_then(|control| show_as(ui, about, &control, settings, start))
}

/// The same with another control than the one that is declared.
pub(super) fn show_as(
    ui: &mut Ui,
    about: &About,
    control: &Control,
    settings: &mut Settings,
    start: &Settings,
) -> Option<Rect> {
    let before = settings.get(about.name)?;
    let (value, rect) = match (before, about.kind) {
        (Value::Switch(mut on), _) => {
            let response = ui.checkbox(&mut on, control.label).on_hover_text(control.hint);
            (Value::Switch(on), response.rect)
        }
        (Value::Word(word), Kind::Word(words)) => {
            let (mut chosen, label) = (word, ui.label(control.label).on_hover_text(control.hint));
            let list = ComboBox::from_id_salt(about.name).width(150.0).selected_text(word);
            let shown = list.show_ui(ui, |ui| {
                for word in words {
                    let choice = ui.selectable_value(&mut chosen, word.name, word.name);
                    choice.on_hover_text(word.hint);
                }
            });
            let response = shown.response.labelled_by(label.id);
            (Value::Word(chosen), response.rect)
        }
        _ => {
            let present = *settings;
            let number = Number {
                label: control.label,
                unit: control.unit,
                hint: control.hint,
                range: control.range,
                logarithmic: control.logarithmic,
                default: start.get(about.name).and_then(as_number)?,
                refuse: &|value| refusal(about, &present, value),
            };
            let edited = number.show(ui, as_number(before)?);
            let value = edited.value.and_then(|value| of_number(about.kind, value));
            (value.unwrap_or(before), edited.slider.rect)
        }
    };
    settings.set(about.name, value);
    Some(rect)
}

fn as_number(value: Value) -> Option<f64> {
    match value {
        Value::Number(number) => Some(number),
        Value::Count(count) => Some(f64::from(count)),
        Value::Switch(_) | Value::Word(_) => None,
    }
}

/// What a slider or a field gives; whole numbers are the nearest ones.
fn of_number(kind: Kind, number: f64) -> Option<Value> {
    match kind {
        Kind::Number => Some(Value::Number(number)),
        Kind::Count => Some(Value::Count(number.round().clamp(0.0, f64::from(u32::MAX)) as u32)),
        Kind::Switch | Kind::Word(_) => None,
    }
}

/// Why a typed number is not accepted.
fn refusal(about: &About, settings: &Settings, number: f64) -> Option<String> {
    let whole = number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number);
    if about.kind == Kind::Count && !whole {
        return Some(format!("{} is {number}, but must be a whole number ≥ 0", about.name));
    }
    let mut tried = *settings;
    tried.set(about.name, of_number(about.kind, number)?);
    tried.validate().err().map(|error| error.to_string())
}

/// Digits of a value that comes from a slider: the mouse knows no more.
const SLIDER_DIGITS: usize = 3;
/// Width of the field, points.
const FIELD_WIDTH: f32 = 76.0;

/// How a number is shown, and what it may be.
pub(super) struct Number<'a> {
    /// What it is called; also its name for assistive technology.
    pub label: &'a str,
    /// Its unit, or nothing.
    pub unit: &'a str,
    /// One sentence.
    pub hint: &'a str,
    /// Ends of the slider. Typed values may lie outside.
    pub range: [f64; 2],
    /// Whether equal distances on the slider are equal factors.
    pub logarithmic: bool,
    /// What a double click sets.
    pub default: f64,
    /// Why a value cannot be accepted, if it cannot.
    pub refuse: &'a dyn Fn(f64) -> Option<String>,
}

/// What is being typed.
#[derive(Clone, Default)]
struct TypedNumber {
    text: String,
    refusal: Option<String>,
}

/// What became of a number in this frame.
pub(super) struct Edited {
    /// The new value, where there is one.
    pub value: Option<f64>,
    /// The slider.
    pub slider: Response,
}

impl Number<'_> {
    /// Shows the number as a labelled field above a slider.
    pub(super) fn show(&self, ui: &mut Ui, value: f64) -> Edited {
        let mut edited = None;
        ui.horizontal(|ui| {
            ui.label(self.label).on_hover_text(self.hint);
            ui.with_layout(egui::Layout::right_to_left(Align::Center), |ui| {
                if !self.unit.is_empty() {
                    ui.label(RichText::new(self.unit).weak());
                }
                edited = self.field(ui, value);
            });
        });
        let mut place = value;
        ui.spacing_mut().slider_width = ui.available_width() - 4.0;
        let slider = Slider::new(&mut place, self.range[0]..=self.range[1])
            .logarithmic(self.logarithmic)
            .clamping(SliderClamping::Never)
            .show_value(false);
        let response = ui.add(slider);
        let name = format!("{} slider", self.label);
        response.widget_info(|| WidgetInfo::slider(true, value, &name));
        let response = response.on_hover_text(self.hint);
        if response.double_clicked() {
            edited = Some(self.default);
        } else if response.changed() {
            edited = Some(rounded(place));
        }
        if edited.is_some() {
            self.forget_draft(ui);
        }
        self.show_refusal(ui, &response);
        Edited { value: edited.filter(|edited| *edited != value), slider: response }
    }

    fn id(&self, ui: &Ui) -> egui::Id {
        ui.scope_id().with(("number", self.label))
    }

    fn draft(&self, ui: &Ui) -> Option<TypedNumber> {
        ui.data(|data| data.get_temp(self.draft_id(ui)))
    }

    // Independent of the place in the layout: the field and the refusal lie in different ones.
    fn draft_id(&self, _ui: &Ui) -> egui::Id {
        egui::Id::unique(("draft of", self.label))
    }

    fn forget_draft(&self, ui: &Ui) {
        ui.data_mut(|data| data.remove::<TypedNumber>(self.draft_id(ui)));
    }

    fn field(&self, ui: &mut Ui, value: f64) -> Option<f64> {
        let draft = self.draft(ui);
        let refused = draft.as_ref().is_some_and(|draft| draft.refusal.is_some());
        let mut text = draft.map_or_else(|| written(value), |draft| draft.text);
        let mut edit = TextEdit::singleline(&mut text)
            .id(self.id(ui))
            .desired_width(FIELD_WIDTH)
            .align(egui::Align2::RIGHT_CENTER)
            .margin(egui::vec2(5.0, 2.0));
        if refused {
            edit = edit.text_color(theme::warning(ui.visuals().dark_mode));
        }
        let response = ui.add(edit);
        response.widget_info(|| {
            let mut info = WidgetInfo::new(Role::TextInput);
            info.label = Some(self.label.to_owned());
            info.current_text_value = Some(text.clone());
            info
        });
        if response.double_clicked() && !response.changed() {
            self.forget_draft(ui);
            return Some(self.default);
        }
        if response.lost_focus() {
            let given_up = ui.input(|input| input.key_pressed(egui::Key::Escape));
            return if given_up { self.give_up(ui) } else { self.accept(ui, &text, value) };
        }
        if response.changed() {
            let draft = TypedNumber { text, refusal: None };
            ui.data_mut(|data| data.insert_temp(self.draft_id(ui), draft));
        }
        None
    }

    fn give_up(&self, ui: &Ui) -> Option<f64> {
        self.forget_draft(ui);
        None
    }

    /// Takes what was typed, or keeps it together with the reason why not.
    fn accept(&self, ui: &Ui, text: &str, value: f64) -> Option<f64> {
        let parsed = text.trim().replace('−', "-").replace(',', ".").parse::<f64>();
        let refusal = match &parsed {
            Ok(number) if *number == value => None,
            Ok(number) => (self.refuse)(*number),
            Err(_) => Some(format!("“{}” is no number", text.trim())),
        };
        let Some(refusal) = refusal else {
            self.forget_draft(ui);
            return parsed.ok();
        };
        let draft = TypedNumber { text: text.to_owned(), refusal: Some(refusal) };
        ui.data_mut(|data| data.insert_temp(self.draft_id(ui), draft));
        None
    }

    /// Over what is below: a line of its own would push that down under the mouse.
    fn show_refusal(&self, ui: &Ui, slider: &Response) {
        if let Some(TypedNumber { refusal: Some(refusal), .. }) = self.draft(ui) {
            let colour = theme::warning(ui.visuals().dark_mode);
            egui::Area::new(self.draft_id(ui).with("refusal"))
                .order(egui::Order::Foreground)
                .interactable(false)
                .fixed_pos(slider.rect.left_bottom())
                .show(ui.ctx(), |ui| {
                    egui::Frame::popup(ui.style()).show(ui, |ui| {
                        ui.set_max_width(slider.rect.width() - 12.0);
                        ui.label(RichText::new(refusal).small().color(colour));
                    });
                });
        }
    }
}

/// A number as people type it: short, and read back as the same number.
pub(super) fn written(value: f64) -> String {
    if value == 0.0 || (1e-2..1e5).contains(&value.abs()) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

fn rounded(value: f64) -> f64 {
    let digits = SLIDER_DIGITS - 1;
    format!("{value:.digits$e}").parse().unwrap_or(value)
}

/// Shows the method, and all others to be chosen from; a model of friction that the chosen one does not take
/// is left out.
pub(super) fn method_box(
    ui: &mut Ui,
    salt: impl std::hash::Hash + std::fmt::Debug,
    solver: &mut SolverSettings,
) {
    let mut method = solver.method;
    let list = ComboBox::from_id_salt(egui::Id::unique(salt)).width(100.0);
    let shown = list.selected_text(method.name()).show_ui(ui, |ui| {
        for info in &METHODS {
            ui.selectable_value(&mut method, info.method, info.name).on_hover_text(format!(
                "{}. Solves {} ({}).",
                info.summary, info.solves, info.source
            ));
        }
    });
    if method != solver.method {
        *solver = solver.by(method);
    }
    let about = || egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Method");
    shown.response.widget_info(about);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_read_back() {
        for (value, text) in
            [(1e-3, "1e-3"), (2.5e-4, "2.5e-4"), (0.0, "0"), (100.0, "100"), (0.1, "0.1")]
        {
            assert_eq!(written(value), text);
            assert_eq!(text.parse::<f64>(), Ok(value));
        }
        assert_eq!(rounded(1.23456e-4), 1.23e-4);
    }
}
