//! How well a step must be solved: the slump of piles whose steps get so many sweeps, reach such a residual of
//! Coulomb's law, or are certified under bounds of friction taken anew so often, by the number of grains.

use super::comparison::{PairedSlumps, claim_of_size, columns, widest};
use super::studies::Rows;
use super::{Figure, StudyRunner};
use crate::chart::{Axis, Chart, Layer, LegendCorner, Look, PALETTE, Sheet, points};
use crate::config::Config;
use crate::error::Result;
use crate::report::ReportTable;
use crate::solver::{Fallback, FrictionModel, SolverChanges, StopTest};
use crate::statistics::mean;

/// How steps are solved.
#[derive(Clone, Copy, Debug, PartialEq)]
enum StepAccuracy {
    /// So many sweeps under Coulomb's law.
    Sweeps(u32),
    /// To a residual of Coulomb's law, as far as that is to be had.
    Residual(f64),
    /// The same, and under bounds of friction where it is not.
    FallingBack(f64),
    /// With a certificate, under bounds of friction that are taken anew so often.
    Certified(u32),
}

/// What others are compared with: solved in every step, at every size.
const REFERENCE: StepAccuracy = StepAccuracy::Certified(1);

impl StepAccuracy {
    fn of(config: &Config) -> Self {
        let SolverChanges {
            friction_model,
            model_solves,
            stop,
            tolerance,
            max_sweeps,
            fallback,
            ..
        } = config.solver;
        let tolerance = tolerance.unwrap_or_default();
        if friction_model.unwrap_or_default() != FrictionModel::Coulomb {
            return Self::Certified(model_solves.unwrap_or(1));
        }
        match (stop, fallback) {
            (Some(StopTest::Residual), Some(Fallback::Tresca)) => Self::FallingBack(tolerance),
            (Some(StopTest::Residual), _) => Self::Residual(tolerance),
            _ => Self::Sweeps(max_sweeps.unwrap_or_default()),
        }
    }

    /// At a mark of the axis.
    fn short(self) -> String {
        match self {
            Self::Sweeps(sweeps) => format!("{sweeps}"),
            Self::Residual(residual) => format!("{residual:e}"),
            Self::FallingBack(residual) => format!("{residual:e}†"),
            Self::Certified(solves) => format!("×{solves}"),
        }
        .replace('-', "−")
    }

    /// In a sentence.
    fn long(self) -> String {
        match self {
            Self::Sweeps(sweeps) => format!("{sweeps} sweeps a step"),
            Self::Residual(residual) => format!("steps solved to a residual of {residual:e}"),
            Self::FallingBack(residual) => {
                format!("steps solved to a residual of {residual:e} or under bounds of friction")
            }
            Self::Certified(solves) => {
                format!("certified steps whose bounds are taken {solves} times")
            }
        }
        .replace("e-", "e−")
    }
}

/// Piles of one number of grains, solved within every accuracy.
struct Piles<'a> {
    grains: usize,
    rows: Rows<'a>,
}

impl<'a> Piles<'a> {
    fn all(rows: &Rows<'a>) -> Vec<Self> {
        let counts = rows.values(|config| config.source.grains.map(|grains| grains as f64));
        let of_count = |count: f64| {
            let grains = count as usize;
            Self { grains, rows: rows.such_that(|config| config.source.grains == Some(grains)) }
        };
        counts.into_iter().map(of_count).collect()
    }

    /// In the order of the study.
    fn accuracies(&self) -> Vec<StepAccuracy> {
        let mut accuracies = Vec::new();
        for (config, _) in &self.rows.0 {
            let accuracy = StepAccuracy::of(config);
            if !accuracies.contains(&accuracy) {
                accuracies.push(accuracy);
            }
        }
        accuracies
    }

    fn by(&self, accuracy: StepAccuracy) -> Rows<'a> {
        self.rows.such_that(|config| StepAccuracy::of(config) == accuracy)
    }

    fn against_reference(&self, accuracy: StepAccuracy) -> Vec<PairedSlumps> {
        PairedSlumps::all(&self.by(REFERENCE), &self.by(accuracy))
    }

    /// Those that are no reference.
    fn others(&self) -> impl Iterator<Item = (usize, StepAccuracy)> {
        self.accuracies().into_iter().enumerate().filter(|(_, accuracy)| *accuracy != REFERENCE)
    }
}

pub(super) fn make(studies: &StudyRunner) -> Result<Figure> {
    let rows = studies.rows("tolerance")?;
    let piles = Piles::all(&rows);
    let mut charts: Vec<Chart> = piles.iter().map(chart).collect();
    let widest = charts.iter().map(|chart| chart.y.to).fold(0.0, f64::max);
    for chart in &mut charts {
        (chart.y.from, chart.y.to) = (-widest, widest);
    }
    let caption = vec![
        "Slump less that of certified steps (tresca, ×1), from the same states: means, with 95 % intervals from \
         three states up."
            .into(),
        "Sweeps of nsgs; residual of Coulomb's law by auto; † falling back on bounds of friction; × certified, bounds taken \
         so often."
            .into(),
    ];
    let sheet = Sheet { size: (760 * charts.len().max(2) as u32, 640), charts, caption };
    let claims_of = |of_size: &Piles<'_>| {
        let claim = |(_, accuracy): (usize, StepAccuracy)| {
            let how = format!("by {} as by certified ones", accuracy.long());
            claim_of_size(of_size.grains, &how, &of_size.against_reference(accuracy))
        };
        of_size.others().map(claim).collect::<Vec<_>>()
    };
    let claims = piles.iter().flat_map(claims_of).collect();
    Ok(Figure { name: "tolerance", sheet, claims, table: Some(table(&piles)) })
}

fn chart(of_size: &Piles<'_>) -> Chart {
    let accuracies = of_size.accuracies();
    let bonds = of_size.rows.bonds();
    let ends = (-0.6, accuracies.len() as f64 - 0.4);
    let mut x = Axis::linear("sweeps; residual; certified ×", ends.0, ends.1);
    let marks = accuracies.iter().enumerate();
    x.ticks = marks.map(|(at, accuracy)| (at as f64, accuracy.short())).collect();
    let all: Vec<_> =
        of_size.others().map(|(at, accuracy)| (at, of_size.against_reference(accuracy))).collect();
    let reach = all.iter().map(|(_, comparisons)| widest(comparisons)).fold(0.0, f64::max);
    let y = Axis::linear("difference of slump", -1.05 * reach, 1.05 * reach);
    let mut chart = Chart::new(format!("{} grains", of_size.grains), x, y);
    chart.legend = LegendCorner::LowerLeft;
    for (index, &bond) in bonds.iter().enumerate() {
        let here = all.iter().flat_map(|(at, comparisons)| {
            let of_bond = comparisons.iter().filter(|one| one.bond == bond);
            of_bond.map(|one| one.point(*at as f64))
        });
        let colour = PALETTE[1 + index % (PALETTE.len() - 1)];
        let curve = Layer::curve(format!("Bond {bond}"), here.collect(), colour, Look::Dots(5));
        chart.layers.push(curve.beside(2 * index, 2 * bonds.len() - 1));
    }
    let zero = [ends.0, ends.1].map(|x| (x, 0.0));
    let zero = points(zero);
    chart.layers.push(Layer::quiet("none", zero, PALETTE[0], Look::Dashes(1)));
    chart
}

/// The numbers behind the claims.
fn table(piles: &[Piles<'_>]) -> ReportTable {
    let columns = columns(&["grains", "effort", "bond", "dt", "unsolved"], "slump_reference");
    let mut rows = Vec::new();
    for of_size in piles {
        for (_, accuracy) in of_size.others() {
            for one in of_size.against_reference(accuracy) {
                let share = of_size.by(accuracy).of_bond(one.bond).results(|result| {
                    let unsolved = result.tally.unconverged_steps - result.tally.fallback_steps;
                    unsolved as f64 / result.tally.steps as f64
                });
                let mut row =
                    vec![of_size.grains.to_string(), accuracy.long(), one.bond.to_string()];
                row.extend([format!("{:e}", one.step), format!("{:.4}", mean(&share).mean)]);
                row.extend(one.cells());
                rows.push(row);
            }
        }
    }
    ReportTable { name: "tolerance-differences", columns, rows }
}

#[cfg(test)]
mod tests {
    use super::super::claims::Verdict;
    use super::*;
    use crate::RunResult;
    use crate::solver::Method;

    fn run(grains: usize, seed: u64, accuracy: StepAccuracy, slump: f64) -> (Config, RunResult) {
        let mut config = Config::default();
        (config.source.seed, config.source.grains) = (Some(seed), Some(grains));
        config.parameters.bond = Some(20.0);
        config.parameters.time_step_secs = Some(1e-3);
        let SolverChanges {
            method,
            friction_model,
            model_solves,
            stop,
            tolerance,
            max_sweeps,
            fallback,
            ..
        } = &mut config.solver;
        *method = Some(Method::Auto);
        match accuracy {
            StepAccuracy::Sweeps(sweeps) => *max_sweeps = Some(sweeps),
            StepAccuracy::Residual(residual) | StepAccuracy::FallingBack(residual) => {
                (*stop, *tolerance) = (Some(StopTest::Residual), Some(residual));
                let falls_back = accuracy == StepAccuracy::FallingBack(residual);
                *fallback = Some(if falls_back { Fallback::Tresca } else { Fallback::None });
            }
            StepAccuracy::Certified(solves) => {
                (*friction_model, *model_solves) = (Some(FrictionModel::Tresca), Some(solves));
            }
        }
        (config, RunResult::of_slump(slump))
    }

    #[test]
    fn accuracies_are_told_apart_and_compared_with_certified_steps_state_by_state() {
        let others = [
            (StepAccuracy::Sweeps(10), 0.1),
            (StepAccuracy::Residual(1e-3), 1e-4),
            (StepAccuracy::FallingBack(1e-3), 1e-4),
            (StepAccuracy::Certified(4), 1e-4),
        ];
        let mut runs = Vec::new();
        for seed in 1..=8 {
            let slump = 0.1 * seed as f64;
            for (accuracy, shift) in others.into_iter().chain([(REFERENCE, 0.0)]) {
                // Not quite the same shift in each state: else there is no scatter to judge by.
                let shift = shift * (1.0 + 0.1 * (seed % 3) as f64);
                runs.push(run(500, seed, accuracy, slump + shift));
            }
        }
        let rows = Rows(runs.iter().map(|(config, result)| (config, result)).collect());
        let piles = Piles::all(&rows);
        assert_eq!(piles.len(), 1);
        let found: Vec<_> = piles[0].others().collect();
        let expected: Vec<_> = others.iter().map(|(accuracy, _)| *accuracy).enumerate().collect();
        assert_eq!(found, expected);
        let verdict =
            |accuracy| claim_of_size(500, "alike", &piles[0].against_reference(accuracy)).verdict;
        assert_eq!(verdict(StepAccuracy::Sweeps(10)), Verdict::Fails);
        let table = table(&piles);
        assert_eq!(table.rows.len(), 4);
        assert!(table.rows[0].contains(&"0.1112".to_owned()), "{:?}", table.rows[0]);
        assert_eq!(chart(&piles[0]).x.ticks[1], (1.0, "1e−3".to_owned()));
    }
}
