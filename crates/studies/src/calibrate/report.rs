//! Writes the files of a calibration: a report in words and tables, and a picture of the confidence region.

use std::path::Path;

use super::asked::{Target, Varied};
use super::region::Region;
use crate::budget::{BudgetQuantity, short};
use crate::chart::{Axis, Chart, INK, Layer, Look, MapCell, PALETTE, Rgb, Sheet, points};
use crate::error::Result;
use crate::harness::{ReportTable, write_sheet};
use crate::output::write_file;
use crate::statistics::Mean;

pub(super) const REPORT: &str = "report.md";
/// Number of cells along each axis of the map of the confidence region.
const CELLS: usize = 40;
/// Number of further quantities that the report recommends to measure, because they would narrow the region most.
const MOST_SEPARATING: usize = 3;
/// Largest distance between the confidence region and an end of a parameter's range at which the report says that the
/// region reaches this end, as a fraction of the range.
const NEAR: f64 = 0.01;

/// The result of a calibration, as the report needs it.
pub(super) struct Found<'a> {
    pub command: String,
    pub targets: &'a [Target],
    pub vary: &'a [Varied],
    /// Parameter values of each run that gave a value for every target.
    pub points: &'a [Vec<f64>],
    /// Number of all runs, including failed runs.
    pub count: usize,
    pub region: &'a Region,
    /// Effects of changes of the numerical method (such as half the time step) on the targets, measured at the
    /// parameter values that agree best with the targets. An entry contains the name of the target, the change, and the
    /// mean difference that the change makes.
    pub effects: Vec<(String, String, Mean)>,
    /// Quantities that the runs recorded and `region` predicts. The quantities of the targets come first.
    pub quantities: &'a [&'a BudgetQuantity],
}

/// Writes all files of a calibration, and returns the text of the report without its heading and picture.
pub(super) fn write(found: &Found<'_>, folder: &Path) -> Result<String> {
    let Found { command, targets, vary, points, count, region, .. } = found;
    let best = region.best();
    let names = vary.iter().map(|varied| &*varied.name).collect::<Vec<_>>().join(" and ");
    let agrees = match region.share() {
        0.0 => format!("no point of the box of {names} agrees with all targets"),
        share => format!("{:.1} % of the box of {names} agrees with the targets", 100.0 * share),
    };
    let rows = vary.iter().enumerate().map(|(number, varied)| {
        let numbers = [varied.range, region.range(number), [best[number]; 2]].concat();
        std::iter::once(varied.name.clone()).chain(numbers.into_iter().take(5).map(short)).collect()
    });
    let columns = "parameter from to region_from region_to best_point";
    let parameters = ReportTable::new("", columns, rows).to_markdown();
    let rows = targets.iter().enumerate().map(|(number, target)| {
        let pair = |[value, error]: [f64; 2]| format!("{} ± {}", short(value), short(error));
        let pairs = [pair([target.value, target.error]), pair(region.value(best, number))];
        let [wanted, fit] = pairs;
        let scatter = short(region.surrogate.scatter(number));
        vec![target.quantity.name.clone(), target.quantity.unit.into(), wanted, fit, scatter]
    });
    let columns = "target unit wanted at_best_point scatter_of_a_run";
    let compared = ReportTable::new("", columns, rows).to_markdown();
    let rows = found.effects.iter().map(|(target, change, mean)| {
        let numbers = [mean.mean, mean.low, mean.high].map(short);
        [target.clone(), change.clone()].into_iter().chain(numbers).collect()
    });
    let effects = ReportTable::new("", "target change adds low high", rows).to_markdown();
    let degree = region.surrogate.degree();
    let mut text = format!(
        "At 90 % confidence, {agrees}.\n\n{parameters}\n{compared}\n± are standard errors. The fit is a polynomial of \
         degree {degree} to {} of {count} runs, each from its own initial state. Effects of the method at the best \
         point, with 95 % intervals over initial states:\n\n{effects}",
        points.len(),
    );
    let mut reached = Vec::new();
    for (number, Varied { name, range: [from, to] }) in vary.iter().enumerate() {
        let near = |end: f64, it: &f64| (end - it).abs() < NEAR * (to - from);
        let reaches = |end: &f64| region.range(number).iter().any(|it| near(*end, it));
        let ends = [*from, *to].into_iter().filter(reaches);
        reached.extend(ends.map(|end| format!("{name} = {}", short(end))));
    }
    if !reached.is_empty() {
        let ends = reached.join(", ");
        text += &format!("\nThe region reaches {ends}: a larger box may contain more of it.\n");
    }
    let mut others: Vec<_> = (targets.len()..found.quantities.len())
        .map(|number| {
            let [spread, scatter] = [region.spread(number), region.surrogate.scatter(number)];
            (spread / scatter, found.quantities[number], spread, scatter)
        })
        .filter(|(ratio, ..)| ratio.is_finite())
        .collect();
    others.sort_by(|one, other| other.0.total_cmp(&one.0));
    if !others.is_empty() {
        text += "\nMeasurements that would narrow the region most:\n\n";
    }
    for (_, BudgetQuantity { name, unit, .. }, spread, scatter) in
        others.iter().take(MOST_SEPARATING)
    {
        let (spread, scatter) = (short(*spread), short(*scatter));
        let unit = if unit.is_empty() { "1" } else { unit };
        text +=
            &format!("* `{name}`: ± {spread} over the region, {scatter} between runs ({unit})\n");
    }
    write_sheet(folder, "region", &sheet(found), command)?;
    let report = format!("# Calibration\n\n`{command}`\n\n{text}\n![Region](region.png)\n");
    write_file(&folder.join(REPORT), report.as_bytes())?;
    Ok(text)
}

/// Returns the colour of a cell in the map of the confidence region. `fraction` is the fraction of the cell that
/// belongs to the region. A larger fraction gives a darker colour.
fn colour(fraction: f64) -> Rgb {
    let (red, green, blue) = PALETTE[1];
    let mix = |end: u8| (255.0 - (255.0 - f64::from(end)) * (0.25 + 0.75 * fraction)).round() as u8;
    (mix(red), mix(green), mix(blue))
}

/// Draws a map of the confidence region for each pair of varied parameters. If only one parameter is varied, it is on
/// both axes.
fn sheet(found: &Found<'_>) -> Sheet {
    let last = found.vary.len() - 1;
    let pairs = (0..=last).flat_map(|y| (0..y.max(usize::from(last == 0))).map(move |x| (x, y)));
    let charts: Vec<Chart> = pairs.map(|pair| map(found, pair)).collect();
    let share = 100.0 * found.region.share();
    let caption =
        format!("Blue: 90 % region, {share:.1} % of the box. Ring: best point. Dots: runs.");
    Sheet { size: (640 * charts.len() as u32, 560), charts, caption: vec![caption] }
}

fn map(found: &Found<'_>, (x, y): (usize, usize)) -> Chart {
    let cell_of = |point: &[f64], number: usize| {
        let [from, to] = found.vary[number].range;
        (((point[number] - from) / (to - from) * CELLS as f64) as usize).min(CELLS - 1)
    };
    let mut counts = vec![[0.0; 2]; CELLS * CELLS];
    for (point, misfit) in &found.region.points {
        let cell = &mut counts[cell_of(point, x) + CELLS * cell_of(point, y)];
        *cell = [cell[0] + 1.0, cell[1] + f64::from(u8::from(*misfit <= 1.0))];
    }
    let edges = |cell: usize, number: usize| {
        let [from, to] = found.vary[number].range;
        let edge = |cell: f64| from + (to - from) * cell / CELLS as f64;
        (edge(cell as f64 + 0.5), [edge(cell as f64), edge(cell as f64 + 1.0)])
    };
    let cells = counts.iter().enumerate().filter(|(_, [_, inside])| *inside > 0.0);
    let cells = cells.map(|(cell, [count, inside])| {
        let value = inside / count;
        MapCell { x: edges(cell % CELLS, x), y: edges(cell / CELLS, y), value }
    });
    let axis = |number: usize| {
        let Varied { name, range: [from, to] } = &found.vary[number];
        Axis::linear(&**name, *from, *to)
    };
    let mut chart = Chart::new("", axis(x), axis(y));
    chart.layers.push(Layer::Cells { name: "region".into(), cells: cells.collect(), colour });
    let dots = points(found.points.iter().map(|point| (point[x], point[y])));
    chart.layers.push(Layer::quiet("runs", dots, INK, Look::Dots(2)));
    let best = found.region.best();
    let ring = points([(best[x], best[y])]);
    chart.layers.push(Layer::quiet("best point", ring, PALETTE[6], Look::Rings(8)));
    chart
}
