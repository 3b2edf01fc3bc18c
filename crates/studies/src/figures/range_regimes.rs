//! Where slump under `range` does not depend on Δt, and where it does: one number of the scene changed at a time.

use super::choices::{Choice, choices};
use super::paired::{Comparison, Place, claim, columns, pairs};
use super::table::Table;
use super::{Claim, Figure, Workshop};
use crate::chart::{Axis, Chart, Corner, Layer, Look, PALETTE, Sheet, points};
use crate::error::Result;

/// A difference of slump up to which one Δt stands for another, of 138 grains and of more.
const MARGINS: [f64; 2] = [0.02, 0.04];

pub(super) fn make(workshop: &Workshop) -> Result<Figure> {
    let mut rows = workshop.rows("range-regimes")?;
    rows.0.extend(workshop.rows("range-size")?.0);
    let bonds = rows.values(|config| config.parameters.bond);
    let choices = choices(&rows);
    let all: Vec<Vec<Place>> = choices.iter().map(places).collect();
    let x = Axis::linear("", -0.5, choices.len() as f64 - 0.5);
    let ticks = (0..choices.len()).map(|index| (index as f64, (index + 1).to_string()));
    let x = Axis { ticks: ticks.collect(), ..x };
    let steps = choices.first().map(steps_of).unwrap_or_default();
    let [least, most] = [steps.first(), steps.last()].map(|step| step.copied().unwrap_or(f64::NAN));
    let title = format!("Slump at Δt = {most:e} s less that at {least:e} s");
    let y = Axis::linear("difference of slump", -0.2, 0.2);
    let mut chart = Chart::new(title.replace("e-", "e−"), x, y);
    chart.legend = Corner::UpperRight;
    let zero = points([(-0.5, 0.0), (choices.len() as f64 - 0.5, 0.0)]);
    chart.layers.push(Layer::quiet("none", zero, PALETTE[0], Look::Dashes(2)));
    for (index, &bond) in bonds.iter().enumerate() {
        let of_choice = |(number, places): (usize, &Vec<Place>)| {
            let of_bond = places.iter().rfind(|place| place.at.0 == bond);
            of_bond.map(|place| place.comparison().point(number as f64))
        };
        let points = all.iter().enumerate().filter_map(of_choice).collect();
        let colour = PALETTE[1 + index % (PALETTE.len() - 1)];
        let layer = Layer::curve(format!("Bond {bond}"), points, colour, Look::Dots(5));
        chart.layers.push(layer.beside(2 * index, 2 * bonds.len()));
    }
    let mut sheet = Sheet::of(chart);
    let named = choices.iter().enumerate().map(|(index, one)| {
        let other = steps_of(one).first().copied().filter(|&first| first != least);
        let told = other.map_or_else(String::new, |first| format!(" (less that at {first:e} s)"));
        format!("{}: {}{told}", index + 1, one.name)
    });
    sheet.caption = vec![
        format!(
            "Means over up to {} states with 95 % intervals, state by state.",
            rows.seeds().len()
        ),
        named.collect::<Vec<_>>().join("; "),
    ];
    sheet.caption.extend(workshop.note());
    let claims = choices.iter().zip(&all).map(|(one, places)| of_choice(one, places)).collect();
    let mut table = Table {
        name: "range-regimes-differences",
        columns: columns(&["choice", "bond", "dt"], "slump_least_dt"),
        rows: Vec::new(),
    };
    for (choice, places) in choices.iter().zip(&all) {
        let row = |one: Comparison| {
            let own = [choice.name.clone(), one.bond.to_string(), format!("{:e}", one.step)];
            own.into_iter().chain(one.cells()).collect::<Vec<_>>()
        };
        table.rows.extend(places.iter().map(|place| row(place.comparison())));
    }
    Ok(Figure { name: "range-regimes", sheet, claims, table: Some(table) })
}

/// The Δt of a choice, rising.
fn steps_of(choice: &Choice<'_>) -> Vec<f64> {
    choice.rows.values(|config| config.parameters.time_step_secs)
}

/// Every Bond of a choice at every of its Δt but the smallest, against that.
fn places(choice: &Choice<'_>) -> Vec<Place> {
    let steps = steps_of(choice);
    let bonds = choice.rows.values(|config| config.parameters.bond);
    let of = |bond: f64, step: f64| {
        choice.rows.such_that(|config| {
            config.parameters.bond == Some(bond) && config.parameters.time_step_secs == Some(step)
        })
    };
    let place = |bond: f64, step: f64| Place {
        name: format!("Bond {bond} at {step:e} s"),
        at: (bond, step),
        pairs: pairs(&of(bond, steps[0]), &of(bond, step)),
    };
    let later = || steps.iter().skip(1);
    bonds.iter().flat_map(|&bond| later().map(move |&step| place(bond, step))).collect()
}

/// That slump does not depend on Δt with that choice.
fn of_choice(choice: &Choice<'_>, places: &[Place]) -> Claim {
    let grains = choice.rows.0.iter().filter_map(|(config, _)| config.source.grains).max();
    let margin = MARGINS[usize::from(grains.is_some_and(|grains| grains > 138))];
    let said = format!(
        "Beyond the paper: under range slump is that at Δt = {:e} s, within {margin}, with {}",
        steps_of(choice).first().copied().unwrap_or(f64::NAN),
        choice.name
    );
    claim(said, places, margin)
        .hanging_on("newton to a residual of 1e−6, restitution threshold 2 g·Δt; shifted cone")
}
