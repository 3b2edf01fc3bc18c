//! The control of a setting, made from its declaration.

use egui::{ComboBox, Rect, Ui};

use super::number::Number;
use crate::setting::{About, Control, Kind, Value};
use crate::sim::Settings;

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
