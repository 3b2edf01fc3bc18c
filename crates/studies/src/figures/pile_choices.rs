//! What Fig. 5a hangs on: by how much slump changes from the smallest to the largest Δt, with one choice changed at a
//! time.

use super::choices::{Choice, choices};
use super::table::Table;
use super::verdict::Verdict;
use super::workshop::Rows;
use super::{Claim, Figure, Workshop};
use crate::chart::{Axis, Chart, Corner, Layer, Look, PALETTE, Point, Sheet, points};
use crate::config::Config;
use crate::error::Result;
use crate::statistics::{Mean, mean, p_value};

/// The sign that the paper's figure gives to the change at the smallest Bond of the study, and at the largest.
const SIGNS: [f64; 2] = [-1.0, 1.0];

/// A change of slump over Δt.
struct Change {
    slumps: [f64; 2],
    change: Mean,
}

impl Change {
    fn of(rows: &Rows<'_>, bond: f64, steps: [f64; 2]) -> Self {
        let of_step = |step: f64| {
            let here = |config: &Config| {
                config.parameters.bond == Some(bond)
                    && config.parameters.time_step_secs == Some(step)
            };
            rows.such_that(here).outcomes(|outcome| outcome.slump)
        };
        let [least, most] = steps.map(of_step);
        let pairs: Vec<f64> = most.iter().zip(&least).map(|(most, least)| most - least).collect();
        Self { slumps: [mean(&least).mean, mean(&most).mean], change: mean(&pairs) }
    }

    fn verdict(&self, sign: f64) -> Verdict {
        let [above, below] = [self.change.p_above(0.0), self.change.p_below(0.0)];
        if sign > 0.0 { Verdict::of(above, below) } else { Verdict::of(below, above) }
    }
}

pub(super) fn make(workshop: &Workshop) -> Result<Figure> {
    let rows = workshop.rows("pile-choices")?;
    let steps = rows.values(|config| config.parameters.time_step_secs);
    let steps = [steps[0], steps[steps.len() - 1]];
    let bonds = rows.values(|config| config.parameters.bond);
    let choices = choices(&rows);
    let x = Axis::linear("", -0.5, choices.len() as f64 - 0.5);
    let ticks = (0..choices.len()).map(|index| (index as f64, (index + 1).to_string()));
    let x = Axis { ticks: ticks.collect(), ..x };
    let title = format!("Slump at Δt = {:e} s less that at {:e} s", steps[1], steps[0]);
    let y = Axis::linear("change of slump", -0.45, 0.3);
    let mut chart = Chart::new(title.replace("e-", "e−"), x, y);
    chart.legend = Corner::UpperRight;
    let ends = points([(-0.5, 0.0), (choices.len() as f64 - 0.5, 0.0)]);
    chart.layers.push(Layer::quiet("none", ends, PALETTE[0], Look::Dashes(2)));
    let (mut claims, mut table) = (Vec::new(), Vec::new());
    for (index, (&bond, sign)) in bonds.iter().zip(SIGNS).enumerate() {
        let changes: Vec<Change> =
            choices.iter().map(|one| Change::of(&one.rows, bond, steps)).collect();
        let places = changes.iter().enumerate().map(|(index, Change { change, .. })| Point {
            x: index as f64,
            y: change.mean,
            interval: (change.count > 2).then_some((change.low, change.high)),
        });
        let name = format!("Bond {bond}");
        let curve = Layer::curve(name, places.collect(), PALETTE[1 + index], Look::Dots(6));
        chart.layers.push(curve.beside(index, bonds.len()));
        table.extend(choices.iter().zip(&changes).map(|(one, change)| cells(one, bond, change)));
        claims.push(claim(bond, sign, &choices, &changes));
    }
    let mut sheet = Sheet::of(chart);
    let named =
        choices.iter().enumerate().map(|(index, one)| format!("{}: {}", index + 1, one.name));
    sheet.caption = vec![
        format!(
            "Means over {} states that have no part in Fig. 5a, with 95 % intervals.",
            rows.seeds().len()
        ),
        named.collect::<Vec<_>>().join("; "),
    ];
    sheet.caption.extend(workshop.note());
    let columns = vec![
        "choice",
        "bond",
        "slump_least_dt",
        "slump_most_dt",
        "change",
        "low",
        "high",
        "p_two_sided",
    ];
    let table = Table { name: "pile-choices-changes", columns, rows: table };
    Ok(Figure { name: "pile-choices", sheet, claims, table: Some(table) })
}

fn cells(choice: &Choice<'_>, bond: f64, Change { slumps, change }: &Change) -> Vec<String> {
    let p = (2.0 * change.p_above(0.0).min(change.p_below(0.0))).min(1.0);
    let numbers = [slumps[0], slumps[1], change.mean, change.low, change.high, p];
    let written = numbers.map(|number| format!("{number:.4}"));
    [choice.name.clone(), bond.to_string()].into_iter().chain(written).collect()
}

/// That the sign of the change hangs on no choice that was changed.
fn claim(bond: f64, sign: f64, choices: &[Choice<'_>], changes: &[Change]) -> Claim {
    let verdicts: Vec<Verdict> = changes.iter().map(|change| change.verdict(sign)).collect();
    let listed = choices.iter().zip(changes).map(|(one, Change { change, .. })| {
        let p = if sign > 0.0 { change.p_above(0.0) } else { change.p_below(0.0) };
        format!("{} {:+.3} ({})", one.name, change.mean, p_value(p))
    });
    let verdict = if verdicts.contains(&Verdict::Fails) {
        Verdict::Fails
    } else if verdicts.iter().all(|verdict| *verdict == Verdict::Holds) {
        Verdict::Holds
    } else {
        Verdict::Open
    };
    let what = if sign > 0.0 { "rises" } else { "falls" };
    let said = format!("Fig. 5a: at Bond {bond} slump {what} with Δt whatever is chosen");
    Claim::new(said, listed.collect::<Vec<_>>().join("; ").replace('-', "−"), verdict)
        .by_chance(
            "each choice alone comes out so in 5 % of studies, all of them together in fewer: they share states",
        )
        .hanging_on("the choices that were tried; two Δt of six; states that have no part in Fig. 5a")
}
