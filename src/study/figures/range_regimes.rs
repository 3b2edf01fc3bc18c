//! Where slump under `range` does not depend on Δt, and where it does: one number of the scene changed at a time.

use super::choices::{Choice, choices};
use super::paired::{Comparison, Place, claim, columns, pairs};
use super::table::Table;
use super::{Claim, Figure, Workshop};
use crate::error::Result;
use crate::study::chart::{Axis, Chart, Corner, Layer, Look, PALETTE, Sheet, points};

/// A difference of slump up to which one Δt stands for another, of 138 grains and of more.
const MARGINS: [f64; 2] = [0.02, 0.04];

pub(super) fn make(workshop: &Workshop) -> Result<Figure> {
    let rows = workshop.rows("range-regimes")?;
    let steps = rows.values(|config| config.parameters.time_step_secs);
    let bonds = rows.values(|config| config.parameters.bond);
    let choices = choices(&rows);
    let all: Vec<Vec<Place>> = choices.iter().map(|one| places(one, &bonds, &steps)).collect();
    let x = Axis::linear("", -0.5, choices.len() as f64 - 0.5);
    let ticks = (0..choices.len()).map(|index| (index as f64, (index + 1).to_string()));
    let x = Axis { ticks: ticks.collect(), ..x };
    let title =
        format!("Slump at Δt = {:e} s less that at {:e} s", steps[steps.len() - 1], steps[0]);
    let y = Axis::linear("difference of slump", -0.2, 0.2);
    let mut chart = Chart::new(title.replace("e-", "e−"), x, y);
    chart.legend = Corner::UpperRight;
    let zero = points([(-0.5, 0.0), (choices.len() as f64 - 0.5, 0.0)]);
    chart.layers.push(Layer::quiet("none", zero, PALETTE[0], Look::Dashes(2)));
    for (index, &bond) in bonds.iter().enumerate() {
        let largest = |place: &&Place| place.at == (bond, steps[steps.len() - 1]);
        let of_choice = |(number, places): (usize, &Vec<Place>)| {
            places.iter().find(largest).map(|place| place.comparison().point(number as f64))
        };
        let points = all.iter().enumerate().filter_map(of_choice).collect();
        let colour = PALETTE[1 + index % (PALETTE.len() - 1)];
        let layer = Layer::curve(format!("Bond {bond}"), points, colour, Look::Dots(5));
        chart.layers.push(layer.beside(2 * index, 2 * bonds.len()));
    }
    let mut sheet = Sheet::of(chart);
    let named =
        choices.iter().enumerate().map(|(index, one)| format!("{}: {}", index + 1, one.name));
    sheet.caption = vec![
        format!("Means over {} states with 95 % intervals, state by state.", rows.seeds().len()),
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

/// Every Bond at every Δt but the smallest, against that.
fn places(choice: &Choice<'_>, bonds: &[f64], steps: &[f64]) -> Vec<Place> {
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
    bonds.iter().flat_map(|&bond| steps[1..].iter().map(move |&step| place(bond, step))).collect()
}

/// That slump does not depend on Δt with that choice.
fn of_choice(choice: &Choice<'_>, places: &[Place]) -> Claim {
    let grains = choice.rows.0.iter().filter_map(|(config, _)| config.origin.grains).max();
    let margin = MARGINS[usize::from(grains.is_some_and(|grains| grains > 138))];
    let said = format!(
        "Beyond the paper: under range slump is that at the smallest Δt, within {margin}, with {}",
        choice.name
    );
    claim(said, places, margin)
        .hanging_on("newton to a residual of 1e−6, restitution threshold 2 g·Δt; shifted cone")
}
