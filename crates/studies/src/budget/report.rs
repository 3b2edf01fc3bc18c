//! Writes the files of an error budget: a report in words, pictures, and the table of effects as CSV and JSON.

use std::fmt::Write as _;
use std::path::Path;

use super::ErrorBudget;
use super::causes::{Share, short};
use super::rows::QuantityBudget;
use crate::chart::{Axis, Chart, INK, Layer, Look, Point, Sheet, points};
use crate::error::Result;
use crate::harness::{ReportTable, write_sheet};
use crate::output::write_file;

pub(super) const REPORT: &str = "report.md";

pub(super) fn write(budget: &ErrorBudget, folder: &Path) -> Result<()> {
    let json = budget.to_json()?;
    write_file(&folder.join("budget.json"), format!("{json}\n").as_bytes())?;
    let mut csv = Vec::new();
    let mut text = format!(
        "# {}: physics, time step or solver?\n\n`{}`\n\n{}, {} to {} s.\n",
        budget.scene,
        budget.command,
        budget.stepped,
        short(budget.from_secs),
        short(budget.to_secs)
    );
    for (one, number) in budget.quantities.iter().zip(1..) {
        let table = table(one);
        let rows = table.to_csv()?;
        // The tables of all quantities are in one CSV file and share one header line.
        let skipped = if csv.is_empty() {
            0
        } else {
            1 + rows.iter().position(|&byte| byte == b'\n').unwrap_or(0)
        };
        csv.extend_from_slice(&rows[skipped..]);
        let name = format!("budget-{number}");
        let _ = write!(
            text,
            "\n## {}\n\nCan it be trusted? **{}**\n\n{}\n\n",
            one.quantity,
            one.trust.words(),
            one.answer
        );
        if one.value.is_some() {
            write_sheet(folder, &name, &sheet(budget, one), &budget.command)?;
            let _ = write!(text, "![{name}]({name}.png)\n\n");
        }
        text.push_str(&table.to_markdown());
    }
    write_file(&folder.join("budget.csv"), &csv)?;
    write_file(&folder.join(REPORT), text.as_bytes())
}

/// Returns the table of the error budget of one quantity, with one row per possible cause: its effect on the quantity
/// with the confidence interval, the fraction of unsolved steps, the computing time relative to the unchanged scene,
/// and the reason if the effect is not known.
pub(super) fn table(budget: &QuantityBudget) -> ReportTable {
    let columns = "quantity share cause changed starts adds low high unsolved cost note";
    let number =
        |value: f64| if value.is_finite() { format!("{value:.6e}") } else { String::new() };
    let row = |[share, cause, changed]: [&str; 3],
               starts: usize,
               ends: Option<[f64; 3]>,
               rest: [String; 3]| {
        let mut row = [&*budget.quantity, share, cause, changed].map(str::to_owned).to_vec();
        row.push(starts.to_string());
        row.extend(ends.map_or_else(<[String; 3]>::default, |ends| ends.map(number)));
        row.extend(rest);
        row
    };
    let rest = [format!("{:.4}", budget.unsolved), "1.00".into(), String::new()];
    let mut rows = vec![row(["grains", "value itself", ""], budget.starts, budget.value, rest)];
    rows.extend(budget.causes.iter().map(|it| {
        let cost = it.cost.map_or_else(String::new, |cost| format!("{cost:.2}"));
        let rest = [format!("{:.4}", it.unsolved), cost, it.failure.clone().unwrap_or_default()];
        row([it.share.word(), it.cause, &it.changed], it.starts, it.adds, rest)
    }));
    rows.extend(budget.limit_adds.map(|limit| {
        let rest = ["", "", "extrapolated"].map(str::to_owned);
        row(["method", "time step", "Δt → 0"], budget.starts, Some(limit), rest)
    }));
    ReportTable::new("budget", columns, rows)
}

/// Draws a bar chart of the effects of all causes on one quantity, the largest effect first. A second chart shows, for
/// the tested time steps, the remaining error of the quantity against the computing time.
fn sheet(budget: &ErrorBudget, one: &QuantityBudget) -> Sheet {
    let rows = one.effects();
    let reach = rows.iter().flat_map(|(_, ends)| *ends).map(f64::abs).filter(|end| end.is_finite());
    let reach = 1.05 * reach.fold(one.within, f64::max);
    let unit = if one.unit.is_empty() { String::new() } else { format!(" ({})", one.unit) };
    let label = format!("what it adds to {}{unit}", one.quantity);
    let places = (rows.len() as f64 - 0.4, -0.6);
    let mut y = Axis::linear("", places.0, places.1);
    y.ticks =
        rows.iter().zip(0..).map(|((row, _), at)| (f64::from(at), row.changed.clone())).collect();
    let title = format!("{}: {}", budget.scene, budget.stepped);
    let mut chart = Chart::new(title, Axis::linear(&*label, -reach, reach), y);
    for share in [Share::Method, Share::Law, Share::Grains] {
        let name = format!("of the {}", share.word());
        let of_share = rows.iter().zip(0..).filter(|((row, _), _)| row.share == share);
        let bars: Vec<Point> = of_share
            .map(|((_, [mean, low, high]), at)| Point {
                x: *mean,
                y: f64::from(at),
                interval: Some((low.max(-reach), high.min(reach))),
            })
            .collect();
        if !bars.is_empty() {
            chart.layers.push(Layer::curve(name, bars, share.colour(), Look::Bars));
        }
    }
    for end in [-one.within, one.within] {
        let line = points([(end, places.0), (end, places.1)]);
        chart.layers.push(Layer::quiet("within", line, INK, Look::Dashes(1)));
    }
    let mut charts = vec![chart];
    charts.extend(by_cost(one, &label));
    let width = 900 + 500 * (charts.len() as u32 - 1);
    let caption = vec![format!(
        "{} starts. Lines of the causes: in 95 % of budgets all intervals contain the true effects; dashes: ± {}.",
        one.starts,
        one.with_unit(&short(one.within))
    )];
    Sheet { size: (width, 200 + 50 * rows.len().max(4) as u32), charts, caption }
}

/// Draws the error due to the time step against the computing time, with one point per tested time step. The error is
/// the value of the quantity minus its value at the smallest tested time step.
fn by_cost(one: &QuantityBudget, label: &str) -> Option<Chart> {
    let tried: Vec<Point> = one
        .left_by_time_step
        .iter()
        .map(|(cost, [mean, low, high])| Point {
            x: *cost,
            y: *mean,
            interval: Some((*low, *high)),
        })
        .collect();
    let most = tried.iter().map(|point| point.x).reduce(f64::max)?;
    let ends = tried.iter().filter_map(|point| point.interval).flat_map(|(low, high)| [low, high]);
    let reach = 1.05 * ends.map(f64::abs).filter(|end| end.is_finite()).fold(one.within, f64::max);
    let x = Axis::log("time, by that of the scene as it is", 0.8, 1.3 * most);
    let y = Axis::linear(label.replace("what it adds", "what the time step adds"), -reach, reach);
    let mut chart = Chart::new("accuracy by cost", x, y);
    for end in [-one.within, one.within] {
        let line = points([(0.8, end), (1.3 * most, end)]);
        chart.layers.push(Layer::quiet("within", line, INK, Look::Dashes(1)));
    }
    chart.layers.push(Layer::quiet("time step", tried, Share::Method.colour(), Look::LineAndDots));
    chart.width = 0.55;
    Some(chart)
}
