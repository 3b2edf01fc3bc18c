//! Whether a pile slumps under a model of friction as it does under Coulomb's law, from the same states at the
//! same Bond and Δt, by the number of grains.

use std::collections::BTreeMap;

use super::table::Table;
use super::verdict::{Claim, SIGNIFICANT, Verdict};
use super::workshop::Rows;
use super::{Figure, Workshop};
use crate::error::Result;
use crate::scene::Config;
use crate::solver::FrictionModel;
use crate::study::Outcome;
use crate::study::chart::{Axis, Chart, Layer, Look, PALETTE, Point, Sheet};
use crate::study::statistics::{Mean, mean, p_value};

/// A difference of slump up to which a model stands for Coulomb's law, by the largest number of grains that it
/// is asked of. Slumps are 0.05 to 0.5, and those of two states of a size differ by 0.1 and more.
const MARGINS: [(usize, f64); 2] = [(138, 0.02), (usize::MAX, 0.04)];

/// A Bond and a Δt at one number of grains.
struct Comparison {
    bond: f64,
    /// Δt, s.
    step: f64,
    /// Under Coulomb's law.
    slump: Mean,
    /// Of the model from Coulomb's law, state by state.
    difference: Mean,
}

impl Comparison {
    /// p-value of no difference.
    fn p(&self) -> f64 {
        (2.0 * self.difference.p_above(0.0).min(self.difference.p_below(0.0))).min(1.0)
    }

    /// How far its 95 % interval goes from 0.
    fn reach(&self) -> f64 {
        self.difference.low.abs().max(self.difference.high.abs())
    }

    fn differs(&self) -> bool {
        self.difference.low > 0.0 || self.difference.high < 0.0
    }
}

/// One number of grains under one model.
struct Size<'a> {
    grains: usize,
    model: FrictionModel,
    of_coulomb: Rows<'a>,
    of_model: Rows<'a>,
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
    let grains = rows.values(|config| config.origin.grains.map(|grains| grains as f64));
    let model_of = |config: &Config| config.solver.friction_model.unwrap_or_default();
    let mut all = Vec::new();
    for grains in grains.into_iter().map(|grains| grains as usize) {
        let here = rows.such_that(|config| config.origin.grains == Some(grains));
        for &model in FrictionModel::ALL {
            let of_coulomb = here.such_that(|config| model_of(config) == FrictionModel::Coulomb);
            let of_model = here.such_that(|config| model_of(config) == model);
            if model != FrictionModel::Coulomb && !of_model.0.is_empty() {
                all.push(Size { grains, model, of_coulomb, of_model });
            }
        }
    }
    all
}

impl Size<'_> {
    /// The states that ended under both: seed, slump under Coulomb's law, that under the model.
    fn pairs(&self, bond: f64, step: f64) -> Vec<(Option<u64>, f64, f64)> {
        let at = |config: &Config| {
            let Config { parameters, .. } = config;
            parameters.bond == Some(bond) && parameters.time_step_secs == Some(step)
        };
        let (one, other) = (self.of_coulomb.such_that(at), self.of_model.such_that(at));
        let with = |seed| other.0.iter().find(move |(config, _)| config.origin.seed == seed);
        let pair = |(config, outcome): &(&Config, &Outcome)| {
            let seed = config.origin.seed;
            Some((seed, outcome.slump, with(seed)?.1.slump))
        };
        one.0.iter().filter_map(pair).collect()
    }

    /// Every Δt with every Bond.
    fn places(&self) -> Vec<(f64, f64)> {
        let bonds = self.of_model.values(|config| config.parameters.bond);
        let steps = self.of_model.values(|config| config.parameters.time_step_secs);
        steps.iter().flat_map(|&step| bonds.iter().map(move |&bond| (bond, step))).collect()
    }

    fn comparisons(&self) -> Vec<Comparison> {
        let compared = |(bond, step)| {
            let pairs = self.pairs(bond, step);
            let slumps: Vec<f64> = pairs.iter().map(|(_, coulomb, _)| *coulomb).collect();
            let differences: Vec<f64> = pairs.iter().map(|(_, one, other)| other - one).collect();
            Comparison { bond, step, slump: mean(&slumps), difference: mean(&differences) }
        };
        self.places().into_iter().map(compared).collect()
    }

    /// The mean difference over all Bonds and Δt, a value a state.
    fn of_all(&self) -> Mean {
        let mut of_states: BTreeMap<Option<u64>, Vec<f64>> = BTreeMap::new();
        for (bond, step) in self.places() {
            for (seed, one, other) in self.pairs(bond, step) {
                of_states.entry(seed).or_default().push(other - one);
            }
        }
        mean(&of_states.values().map(|differences| mean(differences).mean).collect::<Vec<_>>())
    }

    fn margin(&self) -> f64 {
        let found = MARGINS.iter().find(|(grains, _)| self.grains <= *grains);
        found.map_or(0.0, |(_, margin)| *margin)
    }
}

fn chart(size: &Size<'_>) -> Chart {
    let all = size.comparisons();
    let steps = size.of_model.values(|config| config.parameters.time_step_secs);
    let most = all.iter().map(|one| one.bond).fold(1.0, f64::max);
    let widest =
        all.iter().map(Comparison::reach).filter(|reach| reach.is_finite()).fold(0.05, f64::max);
    let title = format!("{}, {} grains", size.model, size.grains);
    let x = Axis::linear("Bond", -0.08 * most, 1.08 * most);
    let mut chart =
        Chart::new(title, x, Axis::linear("difference of slump", -1.05 * widest, 1.05 * widest));
    for (index, &step) in steps.iter().enumerate() {
        let here = all.iter().filter(|one| one.step == step);
        let points = here.map(|one| {
            let Mean { mean, low, high, count, .. } = one.difference;
            Point { x: one.bond, y: mean, interval: (count > 2).then_some((low, high)) }
        });
        let name = format!("Δt {step:e} s").replace("e-", "e−");
        let curve = Layer::curve(name, points.collect(), PALETTE[index], Look::LineAndDots);
        chart.layers.push(curve.beside(index, steps.len()));
    }
    chart
}

/// What is said of a model at a number of grains. With many comparisons some differ by chance, so p-values are
/// multiplied by their number (Bonferroni).
fn claim(size: &Size<'_>) -> Claim {
    let (all, pooled, margin) = (size.comparisons(), size.of_all(), size.margin());
    let outside: Vec<_> = all
        .iter()
        .filter(|one| one.differs())
        .map(|one| format!("Bond {} at {:e} s ({:+.3})", one.bond, one.step, one.difference.mean))
        .collect();
    let count = all.len();
    let p = (all.iter().map(Comparison::p).fold(1.0, f64::min) * count as f64).min(1.0);
    let by_chance = 100.0 * (1.0 - 0.95f64.powi(count as i32));
    let farthest = all.iter().map(Comparison::reach).fold(0.0, f64::max);
    let measured = format!(
        "{} of {count} differences have a 95 % interval without 0{}{}, where without any effect at least one has in \
         {by_chance:.0} % of such studies; any difference: {}; mean over all {:+.4} ± {:.4}; the intervals reach to \
         ±{farthest:.3}; {} states",
        outside.len(),
        if outside.is_empty() { "" } else { ": " },
        outside.join(", "),
        p_value(p),
        pooled.mean,
        pooled.standard_error,
        size.of_model.seeds().len(),
    );
    let verdict = match (p < SIGNIFICANT, farthest <= margin) {
        (true, _) => Verdict::Fails,
        (false, true) => Verdict::Holds,
        (false, false) => Verdict::Open,
    };
    let said = format!(
        "Beyond the paper: {} grains slump under {} as under Coulomb's law, within {margin} at every Bond and Δt",
        size.grains, size.model
    );
    Claim::new(said, measured.replace('-', "−"), verdict)
}

/// The numbers behind the claims.
fn table(sizes: &[Size<'_>]) -> Table {
    let columns = [
        "model",
        "grains",
        "bond",
        "dt",
        "states",
        "slump_coulomb",
        "difference",
        "standard_error",
        "low",
        "high",
        "p",
    ];
    let number = |value: f64| format!("{value:.4}");
    let mut rows = Vec::new();
    for size in sizes {
        for one in size.comparisons() {
            let Mean { mean, standard_error, low, high, count, .. } = one.difference;
            let mut row = vec![size.model.to_string(), size.grains.to_string()];
            row.extend([one.bond.to_string(), format!("{:e}", one.step), count.to_string()]);
            let numbers = [one.slump.mean, mean, standard_error, low, high, one.p()];
            row.extend(numbers.map(number));
            rows.push(row);
        }
    }
    Table { name: "friction-differences", columns: columns.to_vec(), rows }
}

#[cfg(test)]
mod tests {
    use super::*;

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
                    config.origin.seed = Some(seed);
                    config.origin.grains = Some(138);
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
