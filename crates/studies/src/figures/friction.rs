//! Whether a pile slumps under a model of friction as it does under Coulomb's law, from the same states at the
//! same Bond and Δt, by the number of grains.

use super::paired::{Paired, columns, widest};
use super::table::Table;
use super::verdict::Claim;
use super::workshop::Rows;
use super::{Figure, Workshop};
use crate::chart::{Axis, Chart, Layer, Look, PALETTE, Sheet};
use crate::config::Config;
use crate::error::Result;
use crate::solver::FrictionModel;

/// One number of grains under one model.
struct Size<'a> {
    model: FrictionModel,
    /// Runs under Coulomb's law and under the model.
    runs: Paired<'a>,
}

pub(super) fn make(workshop: &Workshop) -> Result<Figure> {
    let rows = workshop.rows("friction")?;
    let sizes = sizes(&rows);
    let mut charts: Vec<Chart> = sizes.iter().map(chart).collect();
    // Axes that show the same span can be compared.
    let widest = charts.iter().map(|chart| chart.y.to).fold(0.0, f64::max);
    for chart in &mut charts {
        (chart.y.from, chart.y.to) = (-widest, widest);
    }
    let caption = vec![
        "Slump under the model less that under Coulomb's law, from the same states at the same Bond and Δt: means \
         with 95 % intervals."
            .into(),
    ];
    let mut sheet = Sheet { size: (620 * charts.len().max(1) as u32, 560), charts, caption };
    sheet.caption.extend(workshop.note());
    let claims = sizes.iter().map(claim).collect();
    Ok(Figure { name: "friction", sheet, claims, table: Some(table(&sizes)) })
}

fn sizes<'a>(rows: &Rows<'a>) -> Vec<Size<'a>> {
    let grains = rows.values(|config| config.source.grains.map(|grains| grains as f64));
    let model_of = |config: &Config| config.solver.friction_model.unwrap_or_default();
    let mut all = Vec::new();
    for grains in grains.into_iter().map(|grains| grains as usize) {
        let here = rows.such_that(|config| config.source.grains == Some(grains));
        for &model in FrictionModel::ALL {
            let reference = here.such_that(|config| model_of(config) == FrictionModel::Coulomb);
            let other = here.such_that(|config| model_of(config) == model);
            if model != FrictionModel::Coulomb && !other.0.is_empty() {
                all.push(Size { model, runs: Paired { grains, reference, other } });
            }
        }
    }
    all
}

fn chart(size: &Size<'_>) -> Chart {
    let all = size.runs.comparisons();
    let steps = size.runs.other.values(|config| config.parameters.time_step_secs);
    let most = all.iter().map(|one| one.bond).fold(1.0, f64::max);
    let widest = widest(&all);
    let title = format!("{}, {} grains", size.model, size.runs.grains);
    let x = Axis::linear("Bond", -0.08 * most, 1.08 * most);
    let mut chart =
        Chart::new(title, x, Axis::linear("difference of slump", -1.05 * widest, 1.05 * widest));
    for (index, &step) in steps.iter().enumerate() {
        let here = all.iter().filter(|one| one.step == step);
        let points = here.map(|one| one.point(one.bond));
        let name = format!("Δt {step:e} s").replace("e-", "e−");
        let curve = Layer::curve(name, points.collect(), PALETTE[index], Look::LineAndDots);
        chart.layers.push(curve.beside(index, steps.len()));
    }
    chart
}

/// What is said of a model at a number of grains.
fn claim(Size { model, runs }: &Size<'_>) -> Claim {
    runs.claim(&format!("under {model} as under Coulomb's law"))
}

/// The numbers behind the claims.
fn table(sizes: &[Size<'_>]) -> Table {
    let columns = columns(&["model", "grains", "bond", "dt"], "slump_coulomb");
    let mut rows = Vec::new();
    for size in sizes {
        for one in size.runs.comparisons() {
            let mut row = vec![size.model.to_string(), size.runs.grains.to_string()];
            row.extend([one.bond.to_string(), format!("{:e}", one.step)]);
            row.extend(one.cells());
            rows.push(row);
        }
    }
    Table { name: "friction-differences", columns, rows }
}

#[cfg(test)]
mod tests {
    use super::super::verdict::Verdict;
    use super::*;
    use crate::Outcome;

    /// Runs of 138 grains, those of the model shifted at Bond 20 beside a scatter.
    fn runs(shift: f64, scatter: f64) -> Vec<(Config, Outcome)> {
        let mut runs = Vec::new();
        for model in [FrictionModel::Tresca, FrictionModel::Coulomb] {
            for bond in [0.0, 20.0] {
                // States differ by far more than what a shift is measured against.
                for seed in (1..=16u64).filter(|seed| model == FrictionModel::Tresca || *seed != 7)
                {
                    let sign = [1.0, -1.0][seed as usize % 2];
                    let is_model = model == FrictionModel::Tresca;
                    let moved = if is_model { scatter * sign } else { 0.0 };
                    let moved = moved + if is_model && bond == 20.0 { shift } else { 0.0 };
                    let mut config = Config::default();
                    config.source.seed = Some(seed);
                    config.source.grains = Some(138);
                    config.solver.friction_model = Some(model);
                    config.parameters.bond = Some(bond);
                    config.parameters.time_step_secs = Some(1e-3);
                    runs.push((config, Outcome::of_slump(0.1 * seed as f64 + moved)));
                }
            }
        }
        runs
    }

    fn told(shift: f64, scatter: f64) -> (Claim, Table) {
        let runs = runs(shift, scatter);
        let rows = Rows(runs.iter().map(|(config, outcome)| (config, outcome)).collect());
        let sizes = sizes(&rows);
        assert_eq!(sizes.len(), 1);
        (claim(&sizes[0]), table(&sizes))
    }

    #[test]
    fn states_are_paired_and_a_model_stands_for_coulombs_law_within_a_margin_alone() {
        let (claim, table) = told(0.0, 1e-3);
        assert_eq!(claim.verdict, Verdict::Holds, "{}", claim.measured);
        assert!(table.rows.iter().all(|row| row[4] == "15"), "{:?}", table.rows);
        assert_eq!(told(0.0, 0.2).0.verdict, Verdict::Open);
        let (claim, _) = told(0.1, 0.02);
        assert_eq!(claim.verdict, Verdict::Fails);
        assert!(claim.measured.contains("1 of 2 differences"), "{}", claim.measured);
        assert!(claim.measured.contains("Bond 20 at 1e−3 s (+0.10"), "{}", claim.measured);
    }
}
