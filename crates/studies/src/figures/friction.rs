//! Whether a pile slumps under a model of friction as it does under Coulomb's law, from the same states at the
//! same Bond and Δt, by the number of grains.

use super::claims::Claim;
use super::comparison::{PairedSlumps, claim_of_size, columns, widest};
use super::studies::Rows;
use super::{Figure, StudyRunner};
use crate::chart::{Axis, Chart, Layer, Look, PALETTE, Sheet};
use crate::config::Config;
use crate::error::Result;
use crate::report::ReportTable;
use crate::solver::FrictionModel;

/// Piles of one number of grains under a model and under Coulomb's law.
struct ModelPiles {
    model: FrictionModel,
    grains: usize,
    all: Vec<PairedSlumps>,
}

pub(super) fn make(studies: &StudyRunner) -> Result<Figure> {
    let rows = studies.rows("friction")?;
    let piles = compare(&rows);
    let mut charts: Vec<Chart> = piles.iter().map(chart).collect();
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
    let sheet = Sheet { size: (620 * charts.len().max(1) as u32, 560), charts, caption };
    let claims = piles.iter().map(claim).collect();
    Ok(Figure { name: "friction", sheet, claims, table: Some(table(&piles)) })
}

fn compare(rows: &Rows<'_>) -> Vec<ModelPiles> {
    let grains = rows.values(|config| config.source.grains.map(|grains| grains as f64));
    let model_of = |config: &Config| config.solver.friction_model.unwrap_or_default();
    let mut all = Vec::new();
    for grains in grains.into_iter().map(|grains| grains as usize) {
        let here = rows.such_that(|config| config.source.grains == Some(grains));
        for &model in FrictionModel::ALL {
            let reference = here.such_that(|config| model_of(config) == FrictionModel::Coulomb);
            let other = here.such_that(|config| model_of(config) == model);
            if model != FrictionModel::Coulomb && !other.0.is_empty() {
                all.push(ModelPiles { model, grains, all: PairedSlumps::all(&reference, &other) });
            }
        }
    }
    all
}

fn chart(ModelPiles { model, grains, all }: &ModelPiles) -> Chart {
    let mut steps: Vec<f64> = all.iter().map(|one| one.step).collect();
    steps.dedup();
    let most = all.iter().map(|one| one.bond).fold(1.0, f64::max);
    let widest = widest(all);
    let title = format!("{model}, {grains} grains");
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
fn claim(ModelPiles { model, grains, all }: &ModelPiles) -> Claim {
    claim_of_size(*grains, &format!("under {model} as under Coulomb's law"), all)
}

/// The numbers behind the claims.
fn table(piles: &[ModelPiles]) -> ReportTable {
    let columns = columns(&["model", "grains", "bond", "dt"], "slump_coulomb");
    let row = |model: FrictionModel, grains: usize, one: &PairedSlumps| {
        let own = [model.to_string(), grains.to_string(), one.bond.to_string()];
        own.into_iter().chain([format!("{:e}", one.step)]).chain(one.cells()).collect()
    };
    let rows = piles.iter().flat_map(|ModelPiles { model, grains, all }| {
        all.iter().map(move |one| row(*model, *grains, one))
    });
    ReportTable { name: "friction-differences", columns, rows: rows.collect() }
}

#[cfg(test)]
mod tests {
    use super::super::claims::Verdict;
    use super::*;
    use crate::RunResult;

    /// Runs of 138 grains, those of the model shifted at Bond 20 beside a scatter.
    fn runs(shift: f64, scatter: f64) -> Vec<(Config, RunResult)> {
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
                    runs.push((config, RunResult::of_slump(0.1 * seed as f64 + moved)));
                }
            }
        }
        runs
    }

    fn claim_and_table(shift: f64, scatter: f64) -> (Claim, ReportTable) {
        let runs = runs(shift, scatter);
        let rows = Rows(runs.iter().map(|(config, result)| (config, result)).collect());
        let piles = compare(&rows);
        assert_eq!(piles.len(), 1);
        (claim(&piles[0]), table(&piles))
    }

    #[test]
    fn states_are_paired_and_a_model_stands_for_coulombs_law_within_a_margin_alone() {
        let (claim, table) = claim_and_table(0.0, 1e-3);
        assert_eq!(claim.verdict, Verdict::Holds, "{}", claim.measured);
        assert!(table.rows.iter().all(|row| row[4] == "15"), "{:?}", table.rows);
        assert_eq!(claim_and_table(0.0, 0.2).0.verdict, Verdict::Open);
        let (claim, _) = claim_and_table(0.1, 0.02);
        assert_eq!(claim.verdict, Verdict::Fails);
        assert!(claim.measured.contains("1 of 2 differences"), "{}", claim.measured);
        assert!(claim.measured.contains("Bond 20 at 1e−3 s (+0.10"), "{}", claim.measured);
    }
}
