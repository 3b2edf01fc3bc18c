//! What figures hang on: the same runs with one free choice, or one number of the scene, changed at a time.

use super::claims::{Claim, Verdict};
use super::comparison::{PairedSlumps, claim, columns, margin};
use super::fig8::{PAPER, agreed, is_open};
use super::studies::Rows;
use super::{Figure, StudyRunner};
use crate::chart::{Axis, Chart, Layer, LegendCorner, Look, PALETTE, Sheet, points};
use crate::config::Config;
use crate::error::Result;
use crate::report::ReportTable;
use crate::statistics::p_value;
use crate::world::FrictionCone;

/// The sign that the paper's figure gives to the change at the smallest Bond of the study, and at the largest.
const SIGNS: [f64; 2] = [-1.0, 1.0];

/// Runs that are alike in all that is chosen.
struct Variant<'a> {
    /// What is other than in the first.
    name: String,
    rows: Rows<'a>,
}

/// What is chosen, each with its value.
type Chosen = [(&'static str, String); 9];

/// What can be chosen, each written.
fn chosen(config: &Config) -> Chosen {
    let parameters = &config.parameters;
    let number = |value: Option<f64>| match value {
        None => String::new(),
        Some(value) if value != 0.0 && value.abs() < 1e-2 => format!("{value:e}").replace('-', "−"),
        Some(value) => value.to_string(),
    };
    let cone = match parameters.cone {
        Some(FrictionCone::Compressive) => "compressive",
        _ => "shifted",
    };
    [
        ("cone", cone.to_owned()),
        ("stop", number(config.solver.tolerance)),
        ("ρ", number(parameters.restitution)),
        ("no bounce below, in g·Δt,", number(parameters.restitution_threshold)),
        (
            "warm start",
            if config.solver.warm_start == Some(true) { "yes" } else { "no" }.to_owned(),
        ),
        ("start of k", number(config.source.start)),
        ("μ", number(parameters.friction)),
        ("δc", number(parameters.debonding_distance)),
        ("grains", config.source.grains.map_or_else(String::new, |grains| grains.to_string())),
    ]
}

/// The variants that are among runs, in their order.
fn variants<'a>(rows: &Rows<'a>) -> Vec<Variant<'a>> {
    let mut all: Vec<Chosen> = Vec::new();
    for (config, _) in &rows.0 {
        let here = chosen(config);
        if !all.contains(&here) {
            all.push(here);
        }
    }
    let Some(first) = all.first().cloned() else { return Vec::new() };
    let name = |here: &Chosen| {
        let others = here.iter().zip(&first).filter(|(one, other)| one != other);
        let changes: Vec<String> =
            others.map(|((what, value), _)| format!("{what} {value}")).collect();
        if changes.is_empty() { "as it is".to_owned() } else { changes.join(", ") }
    };
    let variant = |here: &Chosen| Variant {
        name: name(here),
        rows: rows.such_that(|config| &chosen(config) == here),
    };
    all.iter().map(variant).collect()
}

/// What Fig. 8 hangs on: the paper's pattern of open and closed bonds.
pub(super) fn of_cradle(studies: &StudyRunner) -> Result<Figure> {
    let rows = studies.rows("cradle-choices")?;
    let variants = variants(&rows);
    let place = |index: usize| -(index as f64);
    let mut y = Axis::linear("", place(variants.len()), 2.2);
    let named = variants.iter().enumerate().map(|(index, one)| (place(index), one.name.clone()));
    y.ticks = named.collect();
    let x = Axis::log("Δt (s)", 8e-5, 1.3e-2);
    let mut chart = Chart::new("The bond of i and j with one choice changed", x, y);
    chart.legend = LegendCorner::UpperRight;
    for (name, open, colour, look) in
        [("open", true, PALETTE[6], Look::Dots(7)), ("closed", false, PALETTE[1], Look::Rings(7))]
    {
        let of_variant = |(index, variant): (usize, &Variant<'_>)| {
            let here = variant.rows.0.iter().filter(|(_, result)| is_open(result) == open);
            let step = |(config, _): &(&Config, _)| config.parameters.time_step_secs.unwrap_or(0.0);
            here.map(|run| (step(run), place(index))).collect::<Vec<_>>()
        };
        let all = variants.iter().enumerate().flat_map(of_variant);
        chart.layers.push(Layer::curve(name, points(all), colour, look));
    }
    let mut sheet = Sheet::of(chart);
    sheet.size = (1400, 900);
    sheet.caption = vec![
        "The first row is that of Fig. 8; each other differs from it in what it is named for."
            .into(),
    ];
    let agreed: Vec<(&str, usize)> =
        variants.iter().map(|one| (one.name.as_str(), agreed(&one.rows))).collect();
    let listed: Vec<_> = agreed.iter().map(|(name, agreed)| format!("{name}: {agreed}")).collect();
    let claim = Claim::new(
        "§4: the pattern of open and closed bonds comes out whatever is chosen",
        format!("of {} outcomes {}", PAPER.len(), listed.join("; ")),
        agreed.iter().all(|(_, agreed)| *agreed == PAPER.len()).into(),
    )
    .by_chance(
        "nothing is drawn at random: a run a choice and time step; fig8-share has many starts",
    )
    .hanging_on("the choices that were tried, one at a time");
    let row = |(name, agreed): &(&str, usize)| vec![(*name).to_owned(), agreed.to_string()];
    let table = ReportTable {
        name: "cradle-choices-outcomes",
        columns: vec!["choice", "of_14_outcomes"],
        rows: agreed.iter().map(row).collect(),
    };
    Ok(Figure { name: "cradle-choices", sheet, claims: vec![claim], table: Some(table) })
}

/// A chart of changes of slump from the least Δt to the most, with a place for each of some numbered variants.
fn chart_of_changes(count: usize, [least, most]: [f64; 2], y: Axis) -> Chart {
    let ends = (-0.5, count as f64 - 0.5);
    let mut x = Axis::linear("", ends.0, ends.1);
    x.ticks = (0..count).map(|index| (index as f64, (index + 1).to_string())).collect();
    let title = format!("Slump at Δt = {most:e} s less that at {least:e} s");
    let mut chart = Chart::new(title.replace("e-", "e−"), x, y);
    chart.legend = LegendCorner::UpperRight;
    let zero = points([(ends.0, 0.0), (ends.1, 0.0)]);
    chart.layers.push(Layer::quiet("none", zero, PALETTE[0], Look::Dashes(2)));
    chart
}

/// What Fig. 5a hangs on: by how much slump changes from the smallest to the largest Δt.
pub(super) fn of_piles(studies: &StudyRunner) -> Result<Figure> {
    let rows = studies.rows("pile-choices")?;
    let steps = rows.steps();
    let [least, most] = [steps[0], steps[steps.len() - 1]];
    let bonds = rows.bonds();
    let variants = variants(&rows);
    let y = Axis::linear("change of slump", -0.45, 0.3);
    let mut chart = chart_of_changes(variants.len(), [least, most], y);
    let (mut claims, mut table) = (Vec::new(), Vec::new());
    for (index, (&bond, sign)) in bonds.iter().zip(SIGNS).enumerate() {
        let change = |variant: &Variant<'_>| {
            let here = variant.rows.of_bond(bond);
            PairedSlumps::at(bond, most, &here.of_step(least), &here.of_step(most))
        };
        let changes: Vec<PairedSlumps> = variants.iter().map(change).collect();
        let places = changes.iter().enumerate().map(|(index, change)| change.point(index as f64));
        let name = format!("Bond {bond}");
        let curve = Layer::curve(name, places.collect(), PALETTE[1 + index], Look::Dots(6));
        chart.layers.push(curve.beside(index, bonds.len()));
        table.extend(variants.iter().zip(&changes).map(|(one, change)| {
            let PairedSlumps { reference, other, difference, .. } = change;
            let (low, high) = (difference.low, difference.high);
            let p = difference.p_not_zero();
            let numbers = [reference.mean, other.mean, difference.mean, low, high, p];
            let written = numbers.map(|number| format!("{number:.4}"));
            [one.name.clone(), bond.to_string()].into_iter().chain(written).collect()
        }));
        claims.push(claim_of_sign(bond, sign, &variants, &changes));
    }
    let mut sheet = Sheet::of(chart);
    let named =
        variants.iter().enumerate().map(|(index, one)| format!("{}: {}", index + 1, one.name));
    sheet.caption = vec![
        format!(
            "Means over {} states that have no part in Fig. 5a, with 95 % intervals.",
            rows.seeds().len()
        ),
        named.collect::<Vec<_>>().join("; "),
    ];
    let own = ["choice", "bond", "slump_least_dt", "slump_most_dt"];
    let columns = [&own[..], &["change", "low", "high", "p_two_sided"]].concat();
    let table = ReportTable { name: "pile-choices-changes", columns, rows: table };
    Ok(Figure { name: "pile-choices", sheet, claims, table: Some(table) })
}

/// That the sign of the change hangs on no choice that was changed.
fn claim_of_sign(
    bond: f64,
    sign: f64,
    variants: &[Variant<'_>],
    changes: &[PairedSlumps],
) -> Claim {
    let p_of = |PairedSlumps { difference, .. }: &PairedSlumps| {
        let [above, below] = [difference.p_above(0.0), difference.p_below(0.0)];
        if sign > 0.0 { (above, below) } else { (below, above) }
    };
    let verdict = |change: &PairedSlumps| Verdict::of(p_of(change).0, p_of(change).1);
    let verdicts: Vec<Verdict> = changes.iter().map(verdict).collect();
    let listed = variants.iter().zip(changes).map(|(one, change)| {
        let p = p_value(p_of(change).0);
        format!("{} {:+.3} ({p})", one.name, change.difference.mean)
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

/// Where slump under `range` does not depend on Δt, and where it does.
pub(super) fn of_range(studies: &StudyRunner) -> Result<Figure> {
    let mut rows = studies.rows("range-regimes")?;
    rows.0.extend(studies.rows("range-size")?.0);
    let bonds = rows.bonds();
    let variants = variants(&rows);
    let all: Vec<Vec<PairedSlumps>> = variants.iter().map(of_later_steps).collect();
    let steps = variants.first().map(|one| one.rows.steps()).unwrap_or_default();
    let [least, most] = [steps.first(), steps.last()].map(|step| step.copied().unwrap_or(f64::NAN));
    let y = Axis::linear("difference of slump", -0.2, 0.2);
    let mut chart = chart_of_changes(variants.len(), [least, most], y);
    for (index, &bond) in bonds.iter().enumerate() {
        let of_variant = |(number, pairs): (usize, &Vec<PairedSlumps>)| {
            Some(pairs.iter().rfind(|pairs| pairs.bond == bond)?.point(number as f64))
        };
        let points = all.iter().enumerate().filter_map(of_variant).collect();
        let colour = PALETTE[1 + index % (PALETTE.len() - 1)];
        let layer = Layer::curve(format!("Bond {bond}"), points, colour, Look::Dots(5));
        chart.layers.push(layer.beside(2 * index, 2 * bonds.len()));
    }
    let mut sheet = Sheet::of(chart);
    let named = variants.iter().enumerate().map(|(index, one)| {
        let other = one.rows.steps().first().copied().filter(|&first| first != least);
        let other = other.map_or_else(String::new, |first| format!(" (less that at {first:e} s)"));
        format!("{}: {}{other}", index + 1, one.name)
    });
    sheet.caption = vec![
        format!(
            "Means over up to {} states with 95 % intervals, state by state.",
            rows.seeds().len()
        ),
        named.collect::<Vec<_>>().join("; "),
    ];
    let claims = variants.iter().zip(&all).map(|(one, pairs)| no_dependence(one, pairs)).collect();
    let row = |variant: &Variant<'_>, one: &PairedSlumps| {
        let own = [variant.name.clone(), one.bond.to_string(), format!("{:e}", one.step)];
        own.into_iter().chain(one.cells()).collect::<Vec<_>>()
    };
    let rows = variants.iter().zip(&all);
    let rows = rows.flat_map(|(variant, pairs)| pairs.iter().map(move |one| row(variant, one)));
    let table = ReportTable {
        name: "range-regimes-differences",
        columns: columns(&["choice", "bond", "dt"], "slump_least_dt"),
        rows: rows.collect(),
    };
    Ok(Figure { name: "range-regimes", sheet, claims, table: Some(table) })
}

/// Every Bond of a variant at each of its Δt but the smallest, against that.
fn of_later_steps(variant: &Variant<'_>) -> Vec<PairedSlumps> {
    let steps = variant.rows.steps();
    let of_bond = |bond: f64| {
        let here = variant.rows.of_bond(bond);
        let later = steps.iter().skip(1);
        let pairs = later.map(|&step| {
            PairedSlumps::at(bond, step, &here.of_step(steps[0]), &here.of_step(step))
        });
        pairs.collect::<Vec<_>>()
    };
    variant.rows.bonds().into_iter().flat_map(of_bond).collect()
}

/// That slump does not depend on Δt in a variant.
fn no_dependence(variant: &Variant<'_>, pairs: &[PairedSlumps]) -> Claim {
    let grains = variant.rows.0.iter().filter_map(|(config, _)| config.source.grains).max();
    let margin = margin(grains.unwrap_or_default());
    let said = format!(
        "Beyond the paper: under range slump is that at Δt = {:e} s, within {margin}, with {}",
        variant.rows.steps().first().copied().unwrap_or(f64::NAN),
        variant.name
    );
    claim(said, pairs, margin)
        .hanging_on("newton to a residual of 1e−6, restitution threshold 2 g·Δt; shifted cone")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RunResult;

    #[test]
    fn a_choice_is_named_for_what_is_changed_and_has_its_runs() {
        let config = |tolerance, cone, step| {
            let mut config = Config::default();
            config.solver.tolerance = Some(tolerance);
            config.parameters.cone = Some(cone);
            config.parameters.time_step_secs = Some(step);
            config
        };
        use FrictionCone::{Compressive, Shifted};
        let configs = [
            config(1e-7, Shifted, 1e-3),
            config(1e-7, Compressive, 1e-3),
            config(1e-7, Shifted, 5e-3),
            config(0.5, Shifted, 1e-3),
        ];
        let result = RunResult::of_slump(0.0);
        let rows = Rows(configs.iter().map(|config| (config, &result)).collect());
        let found: Vec<_> =
            variants(&rows).into_iter().map(|one| (one.name, one.rows.0.len())).collect();
        let expected = [("as it is", 2), ("cone compressive", 1), ("stop 0.5", 1)];
        assert_eq!(found, expected.map(|(name, count)| (name.to_owned(), count)));
    }
}
