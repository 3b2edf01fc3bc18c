//! Controls of settings, built from the declarations of the settings. The user can drag, type and reset a number; a
//! value out of range is refused.

use egui::{
    Align, ComboBox, Rect, Response, RichText, Role, Slider, SliderClamping, TextEdit, Ui,
    WidgetInfo,
};

use super::glossary::explained;
use super::number_text::{millis, read_secs, written};
use super::theme;
use crate::error::Error;
use crate::number::millis_text;
use crate::setting::{About, Control, Kind, Value};
use crate::sim::Settings;

/// Shows the control of a setting, if the setting has a control, and stores the user's choice in `settings`. A double
/// click on the field restores the value that the setting has in `start`, the settings of the initial state. Returns
/// the rectangle of the slider or box.
pub(super) fn show(
    ui: &mut Ui,
    about: &About,
    settings: &mut Settings,
    start: &Settings,
) -> Option<Rect> {
    about.control.and_then(|control| show_as(ui, about, &control, settings, start))
}

/// Shows the control of a setting as [`show`] does, with `control` instead of the declared control.
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
            let default = start.get(about.name).and_then(as_number)?;
            let refuse = |value| refusal(about, control, &present, value);
            let (edited, rect) = number(ui, control, default, refuse, as_number(before)?);
            let value = edited.and_then(|value| of_number(about.kind, value));
            (value.unwrap_or(before), rect)
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

/// Converts the number of a slider or field to the value of a setting whose kind (such as number or count) is `kind`.
/// Counts are rounded.
fn of_number(kind: Kind, number: f64) -> Option<Value> {
    match kind {
        Kind::Number => Some(Value::Number(number)),
        Kind::Count => Some(Value::Count(number.round().clamp(0.0, f64::from(u32::MAX)) as u32)),
        Kind::Switch | Kind::Word(_) => None,
    }
}

/// Returns the short name of a setting: its symbol, or its name if it has no symbol.
pub(super) fn called(about: &About) -> &'static str {
    let symbol = about.control.map_or("", |control| control.symbol);
    if symbol.is_empty() { about.name } else { symbol }
}

/// Returns the reason why the user must not set a setting to `number`; `None` if the number is allowed.
fn refusal(about: &About, control: &Control, settings: &Settings, number: f64) -> Option<String> {
    let is_time = is_time(control);
    let refused = |allowed| {
        let found = shown(control, number);
        let unit = if is_time { " ms" } else { "" };
        Some(format!("{} is {found}{unit}, but must be {allowed}", called(about)))
    };
    let whole = number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number);
    if about.kind == Kind::Count && !whole {
        return refused("a whole number ≥ 0".to_owned());
    }
    if number > control.most {
        return refused(match is_time {
            true => format!("at most {}", millis_text(control.most)),
            false => format!("at most {}", written(control.most)),
        });
    }
    let mut tried = *settings;
    tried.set(about.name, of_number(about.kind, number)?);
    match tried.validate().err()? {
        Error::Value { field, .. } if field == about.name && is_time => {
            refused("above 0 ms".to_owned())
        }
        Error::Value { field, allowed, .. } if field == about.name => refused(allowed),
        of_others => Some(of_others.to_string()),
    }
}

/// Number of significant digits of a value from a slider; the mouse is not more precise.
const SLIDER_DIGITS: usize = 3;
/// Width of the text field for a number, points.
const FIELD_WIDTH: f32 = 76.0;

/// Shows a number as a labelled field above a slider. Returns the new value, if the user changed it, and the rectangle
/// of the slider. A double click on the field sets `default`. `refuse` returns the reason why a typed value is not
/// allowed.
fn number(
    ui: &mut Ui,
    control: &Control,
    default: f64,
    refuse: impl Fn(f64) -> Option<String>,
    value: f64,
) -> (Option<f64>, Rect) {
    // The text that the user is typing, or that was refused. It is stored by name, because the field and the message
    // are in different parts of the layout.
    let draft_id = egui::Id::unique(("draft of", control.label));
    let draft = ui.data(|data| data.get_temp::<String>(draft_id));
    let (mut edited, mut refused) = (None, None);
    ui.horizontal(|ui| {
        let label = ui.label(control.label).on_hover_text(control.hint);
        explained(label, control.symbol);
        ui.with_layout(egui::Layout::right_to_left(Align::Center), |ui| {
            let unit = if is_time(control) { "ms" } else { control.unit };
            if !unit.is_empty() {
                ui.label(RichText::new(unit).weak());
            }
            let id = ui.scope_id().with(("number", control.label));
            let is_refused = draft.is_some() && !ui.memory(|memory| memory.has_focus(id));
            let mut text = draft.clone().unwrap_or_else(|| shown(control, value));
            let response = field(ui, id, control.label, &mut text, is_refused);
            let given_up = ui.input(|input| input.key_pressed(egui::Key::Escape));
            if response.double_clicked() && !response.changed() {
                edited = Some(default);
            } else if response.lost_focus()
                && (given_up || typed(control, &text, value, &refuse).is_ok())
            {
                edited = typed(control, &text, value, &refuse).ok().filter(|_| !given_up);
                ui.data_mut(|data| data.remove::<String>(draft_id));
            } else if response.lost_focus() || response.changed() {
                ui.data_mut(|data| data.insert_temp(draft_id, text));
            } else if let Some(refusal) =
                typed(control, &text, value, &refuse).err().filter(|_| is_refused)
            {
                refused = Some(refusal);
            }
        });
    });
    let mut place = value;
    ui.spacing_mut().slider_width = ui.available_width() - 4.0;
    let slider = Slider::new(&mut place, control.range[0]..=control.range[1])
        .logarithmic(control.logarithmic)
        .clamping(SliderClamping::Never)
        .show_value(false);
    let response = ui.add(slider);
    let name = format!("{} slider", control.label);
    response.widget_info(|| WidgetInfo::slider(true, value, &name));
    let response = response.on_hover_text(control.hint);
    if response.changed() {
        edited = Some(rounded(place));
    }
    if edited.is_some() {
        ui.data_mut(|data| data.remove::<String>(draft_id));
    } else if let Some(refusal) = refused {
        show_refusal(ui, draft_id.with("refusal"), response.rect, refusal);
    }
    (edited.filter(|edited| *edited != value), response.rect)
}

/// Shows the text field in which the user types a number. A refused text has the colour of warnings.
fn field(ui: &mut Ui, id: egui::Id, label: &str, text: &mut String, is_refused: bool) -> Response {
    let mut edit = TextEdit::singleline(text)
        .id(id)
        .desired_width(FIELD_WIDTH)
        .align(egui::Align2::RIGHT_CENTER)
        .margin(egui::vec2(5.0, 2.0));
    if is_refused {
        edit = edit.text_color(theme::warning(ui.visuals().dark_mode));
    }
    let response = ui.add(edit);
    response.widget_info(|| {
        let mut info = WidgetInfo::new(Role::TextInput);
        info.label = Some(label.to_owned());
        info.current_text_value = Some(text.clone());
        info
    });
    response
}

/// Returns the number that the user typed, or the reason why it is not allowed.
fn typed(
    control: &Control,
    text: &str,
    value: f64,
    refuse: impl Fn(f64) -> Option<String>,
) -> Result<f64, String> {
    let text = text.trim();
    let plain = text.replace('−', "-").replace(',', ".");
    let number = match is_time(control) {
        true => read_secs(&plain).ok_or_else(|| format!("“{text}” is not a time, such as 2 ms")),
        false => plain.parse().map_err(|_| format!("“{text}” is not a number")),
    }?;
    let refusal = if number == value { None } else { refuse(number) };
    refusal.map_or(Ok(number), Err)
}

/// Shows the reason why a typed number is not allowed, as a layer over the controls below the slider. A separate line
/// would move these controls under the mouse.
fn show_refusal(ui: &Ui, id: egui::Id, slider: Rect, refusal: String) {
    let colour = theme::warning(ui.visuals().dark_mode);
    egui::Area::new(id)
        .order(egui::Order::Foreground)
        .interactable(false)
        .fixed_pos(slider.left_bottom())
        .show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width(slider.width() - 12.0);
                ui.label(RichText::new(refusal).small().color(colour));
            });
        });
}

/// True if a setting is a time. Times are declared in seconds, and the window shows them in milliseconds.
fn is_time(control: &Control) -> bool {
    control.unit == "s"
}

/// Returns the text that the field of a setting shows for a value.
fn shown(control: &Control, value: f64) -> String {
    written(if is_time(control) { millis(value) } else { value })
}

fn rounded(value: f64) -> f64 {
    let digits = SLIDER_DIGITS - 1;
    format!("{value:.digits$e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slider_gives_three_digits() {
        assert_eq!(rounded(1.23456e-4), 1.23e-4);
    }
}
