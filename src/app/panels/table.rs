//! Panel: grains and contacts at the displayed simulated time as a table, which the user can filter and sort. A click
//! on a row pins the grain of that row, so that its state is shown.

use egui::{RichText, ScrollArea, TextEdit, Ui};

use super::grain::unless_at_rest;
use crate::app::theme;
use crate::app::watched_run::{GrainRef, WatchedRun};
use crate::sim::{ContactView, GrainView, Snapshot};

/// Largest height of the visible rows of the table, points.
const HEIGHT: f32 = 240.0;
/// Font size of the table's rows, points.
const FONT: f32 = 10.5;

/// State of the table of grains or contacts.
#[derive(Clone, Debug, Default)]
pub(super) struct BodyTable {
    /// True for a table of contacts, false for a table of grains.
    contacts: bool,
    /// Filter of rows, as the user typed it, for example `y > 2`.
    filter: String,
    /// Index of the sorted column, and true for descending order.
    sort: Option<(usize, bool)>,
}

/// A column of a table whose rows have the type `T`.
struct ShownColumn<T> {
    name: &'static str,
    /// Width of the column in characters.
    width: usize,
    /// True if the values are whole numbers.
    whole: bool,
    hint: &'static str,
    /// Function that returns the value of a row in this column, given the index of the row, its data, and the mean
    /// diameter d (m). Lengths are returned in units of d.
    value: fn(usize, &T, f64) -> f64,
}

const GRAINS: [ShownColumn<GrainView>; 7] = [
    column("grain", 5, true, "Number of the grain.", |index, _, _| index as f64),
    column("x", 8, false, "x over d.", |_, grain, d| grain.position.x / d),
    column("y", 8, false, "y over d.", |_, grain, d| grain.position.y / d),
    column("speed", 8, false, "Speed of the centre, m/s; 0 at rest.", |_, grain, _| {
        unless_at_rest(grain.velocity.length())
    }),
    column("overlap", 8, false, "Deepest overlap over d.", |_, grain, d| grain.overlap / d),
    column("force", 8, false, "Σ|N| over its contacts, N.", |_, grain, _| grain.force),
    column("n", 2, true, "Number of contacts.", |_, grain, _| f64::from(grain.coordination)),
];

/// Number that the table shows as second grain if a grain touches a wall or another body that is not a grain.
const FIXED: f64 = -1.0;

const CONTACTS: [ShownColumn<ContactView>; 7] = [
    column("grain", 5, true, "First grain.", |_, contact, _| f64::from(contact.grain)),
    column("with", 5, true, "Second grain; -1 is a fixed body.", |_, contact, _| {
        contact.other_grain.map_or(FIXED, f64::from)
    }),
    column("N", 8, false, "Normal force, N; negative pulls.", |_, contact, _| contact.normal_force),
    column("T", 8, false, "Tangential force, N.", |_, contact, _| contact.tangential_force),
    column("gap", 8, false, "Gap over d; negative is overlap.", |_, contact, d| contact.gap / d),
    column("x", 6, false, "x over d of the first grain.", |_, contact, d| contact.from.x / d),
    column("y", 6, false, "y over d of the first grain.", |_, contact, d| contact.from.y / d),
];

const fn column<T>(
    name: &'static str,
    width: usize,
    whole: bool,
    hint: &'static str,
    value: fn(usize, &T, f64) -> f64,
) -> ShownColumn<T> {
    ShownColumn { name, width, whole, hint, value }
}

pub(super) fn show(ui: &mut Ui, run: &mut WatchedRun, table: &mut BodyTable) {
    let Some(world) = run.world() else { return };
    let (snapshot, world) = (world.snapshot.clone(), run.selected);
    let pinned = run.pinned.filter(|pinned| pinned.world == world);
    ui.horizontal(|ui| {
        let before = table.contacts;
        ui.selectable_value(&mut table.contacts, false, "Grains");
        ui.selectable_value(&mut table.contacts, true, "Contacts");
        if table.contacts != before {
            *table = BodyTable { contacts: table.contacts, ..BodyTable::default() };
        }
        let hint = if table.contacts { "N < 0 and y > 2" } else { "force > 0.01 and y > 2" };
        let label = ui.label("Filter").on_hover_text(
            "Comparisons of columns with numbers, joined by and. Point at the head of a column to see its meaning \
             and unit.",
        );
        let field = TextEdit::singleline(&mut table.filter).hint_text(hint);
        ui.add(field.desired_width(f32::INFINITY)).labelled_by(label.id);
    });
    let pinned = pinned.map(|pinned| pinned.grain);
    let clicked = if table.contacts {
        let is_pinned = |_, contact: &ContactView| {
            let has = |grain: usize| {
                [Some(contact.grain), contact.other_grain].contains(&Some(grain as u32))
            };
            pinned.is_some_and(has)
        };
        let clicked = rows(ui, table, &snapshot, &snapshot.contacts, &CONTACTS, is_pinned);
        clicked.map(|index| snapshot.contacts[index].grain as usize)
    } else {
        let is_pinned = |index, _: &GrainView| pinned == Some(index);
        rows(ui, table, &snapshot, &snapshot.grains, &GRAINS, is_pinned)
    };
    if let Some(grain) = clicked {
        run.pinned = Some(GrainRef { world, grain });
    }
}

/// Shows the head and the rows of the table. Returns the index of the row that the user clicked.
fn rows<T>(
    ui: &mut Ui,
    table: &mut BodyTable,
    snapshot: &Snapshot,
    all: &[T],
    columns: &[ShownColumn<T>],
    is_pinned: impl Fn(usize, &T) -> bool,
) -> Option<usize> {
    let diameter = snapshot.surroundings.mean_diameter;
    let chosen = match chosen(table, all, columns, diameter) {
        Ok(chosen) => chosen,
        Err(refusal) => {
            ui.label(RichText::new(refusal).color(theme::warning(ui.visuals().dark_mode)));
            return None;
        }
    };
    ui.spacing_mut().item_spacing = egui::vec2(0.0, 1.0);
    ui.spacing_mut().button_padding = egui::vec2(0.0, 0.0);
    ui.spacing_mut().interact_size.y = 0.0;
    let font = |text: String| RichText::new(text).monospace().size(FONT);
    ui.horizontal(|ui| {
        for (index, column) in columns.iter().enumerate() {
            let mark = match table.sort {
                Some((by, true)) if by == index => "▾",
                Some((by, false)) if by == index => "▴",
                _ => "",
            };
            let text = format!("{:>1$} ", format!("{mark}{}", column.name), column.width);
            let head = ui.selectable_label(false, font(text).strong());
            if head.on_hover_text(format!("{} A click sorts.", column.hint)).clicked() {
                let is_down = table.sort == Some((index, true));
                table.sort = Some((index, !is_down));
            }
        }
    });
    let mut clicked = None;
    let height = ui.fonts_mut(|fonts| fonts.row_height(&egui::FontId::monospace(FONT)));
    let area = ScrollArea::vertical().max_height(HEIGHT).auto_shrink([false, true]);
    area.id_salt("rows").show_rows(ui, height, chosen.len(), |ui, seen| {
        for &index in &chosen[seen] {
            let item = &all[index];
            let cells = columns.iter().map(|column| {
                format!(
                    "{:>1$} ",
                    written((column.value)(index, item, diameter), column),
                    column.width
                )
            });
            let row = ui.selectable_label(is_pinned(index, item), font(cells.collect()));
            if row.clicked() {
                clicked = Some(index);
            }
        }
    });
    ui.label(RichText::new(format!("{} of {}", chosen.len(), all.len())).small().weak());
    clicked
}

/// Formats a number for the width of its column.
fn written<T>(value: f64, column: &ShownColumn<T>) -> String {
    if column.whole {
        return format!("{value}");
    }
    let decimals = column.width.saturating_sub(4).min(3);
    let fits = value == 0.0 || (1e-2..1e3).contains(&value.abs());
    if fits { format!("{value:.decimals$}") } else { format!("{value:.1e}") }
}

/// Returns the indices of the rows that pass the filter, sorted by the column that the user chose.
fn chosen<T>(
    table: &BodyTable,
    all: &[T],
    columns: &[ShownColumn<T>],
    diameter: f64,
) -> Result<Vec<usize>, String> {
    let comparisons = read_filter(&table.filter, columns)?;
    let value = |index: usize, column: usize| (columns[column].value)(index, &all[index], diameter);
    let passes = |&index: &usize| {
        comparisons.iter().all(|it| (it.is_true)(&value(index, it.column), &it.number))
    };
    let mut chosen: Vec<usize> = (0..all.len()).filter(passes).collect();
    if let Some((column, is_down)) = table.sort.filter(|&(column, _)| column < columns.len()) {
        chosen.sort_by(|&one, &other| {
            let order = value(one, column).total_cmp(&value(other, column));
            if is_down { order.reverse() } else { order }
        });
    }
    Ok(chosen)
}

/// A comparison of a column with a number, as part of a filter.
struct Comparison {
    column: usize,
    is_true: ComparisonTest,
    number: f64,
}

/// Function that compares the value of a row with the number in a filter.
type ComparisonTest = fn(&f64, &f64) -> bool;

/// Signs of comparison in a filter and their meaning. Longer signs come first, because "<=" begins with "<".
const SIGNS: [(&str, ComparisonTest); 5] =
    [("<=", f64::le), (">=", f64::ge), ("<", f64::lt), (">", f64::gt), ("=", f64::eq)];

/// Reads the text of a filter: comparisons such as `y > 2`, joined by "and". The error message states the wrong
/// comparison.
fn read_filter<T>(text: &str, columns: &[ShownColumn<T>]) -> Result<Vec<Comparison>, String> {
    let parts = text.split(" and ").map(str::trim).filter(|part| !part.is_empty());
    let read = |part: &str| -> Option<Comparison> {
        let split = |&(sign, is_true)| Some((part.split_once(sign)?, is_true));
        let ((name, number), is_true) = SIGNS.iter().find_map(split)?;
        let column = columns.iter().position(|column| column.name == name.trim())?;
        Some(Comparison { column, is_true, number: number.trim().parse().ok()? })
    };
    parts
        .map(|part| {
            read(part).ok_or_else(|| {
                let names: Vec<_> = columns.iter().map(|column| column.name).collect();
                format!(
                    "“{part}” is not a comparison of {} with a number by <, <=, =, >= or >.",
                    names.join(", ")
                )
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::built_in;

    #[test]
    fn rows_are_those_that_a_count_by_hand_has() {
        let mut simulation = built_in("pile").unwrap().simulation().unwrap();
        simulation.take_steps(5).unwrap();
        let snapshot = simulation.snapshot();
        let d = snapshot.surroundings.mean_diameter;
        let table = |contacts, filter: &str| BodyTable {
            contacts,
            filter: filter.into(),
            sort: Some((5, true)),
        };
        let all = chosen(&table(false, ""), &snapshot.grains, &GRAINS, d).unwrap();
        assert_eq!(all.len(), 138);
        let forces: Vec<f64> = all.iter().map(|&index| snapshot.grains[index].force).collect();
        assert!(forces[0] > 0.0 && forces.is_sorted_by(|one, next| one >= next));

        let high = |grain: &&GrainView| grain.position.y / d > 3.0 && grain.coordination == 3;
        let by_hand = snapshot.grains.iter().filter(high).count();
        let found = chosen(&table(false, "y > 3 and n = 3"), &snapshot.grains, &GRAINS, d).unwrap();
        assert!(by_hand > 0 && found.len() == by_hand);

        let on_ground = snapshot.contacts.iter().filter(|contact| contact.other_grain.is_none());
        let found = chosen(&table(true, "with<=-1"), &snapshot.contacts, &CONTACTS, d).unwrap();
        assert!(!found.is_empty() && found.len() == on_ground.count());
    }

    #[test]
    fn a_filter_that_is_none_is_told_with_what_is_allowed() {
        for text in ["forc > 1", "force", "force > much", "force > 1 and", "> 1", "and"] {
            let refusal = read_filter(text, &GRAINS).err();
            let ends_well = text.ends_with(" and") || text == "and";
            match refusal {
                Some(refusal) => assert!(refusal.contains("grain, x, y, speed"), "{refusal}"),
                None => assert!(ends_well, "{text}"),
            }
        }
    }
}
