//! What the cradle's pattern hangs on: the paper's outcomes with one choice changed at a time.

use super::choices::choices;
use super::fig8::{PAPER, agreed, is_open};
use super::table::Table;
use super::{Claim, Figure, Workshop};
use crate::chart::{Axis, Chart, Corner, Layer, Look, PALETTE, Sheet, points};
use crate::error::Result;

pub(super) fn make(workshop: &Workshop) -> Result<Figure> {
    let rows = workshop.rows("cradle-choices")?;
    let choices = choices(&rows);
    let count = choices.len() as f64;
    let mut y = Axis::linear("", -count, 2.2);
    let places: Vec<f64> = (0..choices.len()).map(|index| -(index as f64)).collect();
    let named = places.iter().zip(&choices).map(|(place, one)| (*place, one.name.clone()));
    y.ticks = named.collect();
    let x = Axis::log("Δt (s)", 8e-5, 1.3e-2);
    let mut chart = Chart::new("The bond of i and j with one choice changed", x, y);
    chart.legend = Corner::UpperRight;
    for (name, open, colour, look) in
        [("open", true, PALETTE[6], Look::Dots(7)), ("closed", false, PALETTE[1], Look::Rings(7))]
    {
        let of_choice = |(place, choice): (&f64, &super::choices::Choice<'_>)| {
            let here = choice.rows.0.iter().filter(|(_, outcome)| is_open(outcome) == open);
            let step = |(config, _): &(&crate::config::Config, _)| {
                (config.parameters.time_step_secs.unwrap_or(0.0), *place)
            };
            here.map(step).collect::<Vec<_>>()
        };
        let all = places.iter().zip(&choices).flat_map(of_choice);
        chart.layers.push(Layer::curve(name, points(all), colour, look));
    }
    let mut sheet = Sheet::of(chart);
    sheet.size = (1400, 900);
    sheet.caption = vec![
        "The first row is that of Fig. 8; each other differs from it in what it is named for."
            .into(),
    ];
    let outcomes: Vec<(String, usize)> =
        choices.iter().map(|one| (one.name.clone(), agreed(&one.rows))).collect();
    let row = |(name, agreed): &(String, usize)| vec![name.clone(), agreed.to_string()];
    let table = Table {
        name: "cradle-choices-outcomes",
        columns: vec!["choice", "of_14_outcomes"],
        rows: outcomes.iter().map(row).collect(),
    };
    let claims = vec![claim(&outcomes)];
    Ok(Figure { name: "cradle-choices", sheet, claims, table: Some(table) })
}

/// That the pattern is there whatever is chosen.
fn claim(outcomes: &[(String, usize)]) -> Claim {
    let kept = outcomes.iter().filter(|(_, agreed)| *agreed == PAPER.len()).count();
    let listed: Vec<String> =
        outcomes.iter().map(|(name, agreed)| format!("{name}: {agreed}")).collect();
    Claim::new(
        "§4: the pattern of open and closed bonds comes out whatever is chosen",
        format!("of {} outcomes {}", PAPER.len(), listed.join("; ")),
        (kept == outcomes.len()).into(),
    )
    .by_chance(
        "nothing is drawn at random: a run a choice and time step; fig8-share has many starts",
    )
    .hanging_on("the choices that were tried, one at a time")
}
