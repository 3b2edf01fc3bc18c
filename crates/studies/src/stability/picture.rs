//! The table as a picture: a row a challenge, a column a contender, in each cell the level from which
//! on the worst verdict holds.

use super::table::{number, summary};
use super::{CONTENDERS, StabilityTable, Verdict};
use crate::chart::{Axis, Cell, Chart, INK, Layer, Rgb, Sheet};

/// Width of a column and height of a row, pixels.
const COLUMN: u32 = 144;
const ROW: u32 = 44;
/// Room for words beside and below, pixels.
const BESIDE: u32 = 260;
const BELOW: u32 = 220;

/// Parameters that a line of the caption names.
const DRIVERS_A_LINE: usize = 7;

/// Colours of holding, degrading and failing, told apart also by their lightness.
const COLOURS: [Rgb; 3] = [(206, 234, 214), (253, 226, 147), (240, 150, 130)];

/// The colour of a verdict, given as 0, 1 or 2.
pub(super) fn colour(verdict: f64) -> Rgb {
    COLOURS[(verdict as usize).min(2)]
}

/// The table as a picture.
pub fn picture(table: &StabilityTable) -> Sheet {
    let challenges = table.challenges();
    let (columns, rows) = (CONTENDERS.len(), challenges.len());
    let mut x = Axis::linear("", 0.0, columns as f64);
    x.ticks = (0..columns).map(|k| (k as f64 + 0.5, CONTENDERS[k].name.to_owned())).collect();
    let mut y = Axis::linear("", 0.0, rows as f64);
    let height = |row: usize| (rows - row) as f64 - 0.5;
    y.ticks = (0..rows).map(|row| (height(row), challenges[row].name.to_owned())).collect();
    let mut chart = Chart::new("Where methods fail", x, y);
    let mut cells = Vec::new();
    let mut words = Vec::new();
    for (row, challenge) in challenges.iter().enumerate() {
        for (column, contender) in CONTENDERS.iter().enumerate() {
            let levels = table.levels(challenge, contender);
            let (verdict, from) = summary(&levels);
            let middle = (column as f64 + 0.5, height(row));
            cells.push(Cell {
                x: (middle.0, [middle.0 - 0.49, middle.0 + 0.49]),
                y: (middle.1, [middle.1 - 0.47, middle.1 + 0.47]),
                value: f64::from(verdict as u8),
            });
            let text = match (verdict, from) {
                (Verdict::Holds, _) | (_, None) => "holds".to_owned(),
                (_, Some(level)) => format!("from {}", number(level)),
            };
            words.push(Layer::Words { at: (middle.0 - 0.4, middle.1 + 0.22), text, colour: INK });
        }
    }
    chart.layers.push(Layer::Cells { name: "verdict".into(), cells, colour });
    chart.layers.extend(words);
    let mut caption = vec![
        "Green holds; yellow degrades and red fails, from that value of the parameter on:".into(),
    ];
    let drivers =
        challenges.iter().map(|challenge| format!("{}: {}", challenge.name, challenge.driver));
    let drivers: Vec<String> = drivers.collect();
    caption.extend(drivers.chunks(DRIVERS_A_LINE).map(|line| line.join("; ")));
    Sheet {
        size: (BESIDE + COLUMN * columns as u32, BELOW + ROW * rows as u32),
        charts: vec![chart],
        caption,
    }
}
