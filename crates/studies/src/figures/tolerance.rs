//! How well a step must be solved: the slump of piles whose steps get so many sweeps, reach such a residual of
//! Coulomb's law, or are certified under bounds of friction taken anew so often, by the number of grains.

use super::paired::{Paired, columns, widest};
use super::table::Table;
use super::workshop::Rows;
use super::{Figure, Workshop};
use crate::chart::{Axis, Chart, Corner, Layer, Look, PALETTE, Sheet};
use crate::config::Config;
use crate::error::Result;
use crate::solver::{Fallback, FrictionModel, SolverChanges, StopTest};
use crate::statistics::mean;

/// How steps are solved.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Effort {
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
const REFERENCE: Effort = Effort::Certified(1);

impl Effort {
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

/// One number of grains, solved in every way.
struct Size<'a> {
    grains: usize,
    rows: Rows<'a>,
}

impl<'a> Size<'a> {
    fn all(rows: &Rows<'a>) -> Vec<Self> {
        let counts = rows.values(|config| config.source.grains.map(|grains| grains as f64));
        let of_count = |count: f64| {
            let grains = count as usize;
            Self { grains, rows: rows.such_that(|config| config.source.grains == Some(grains)) }
        };
        counts.into_iter().map(of_count).collect()
    }

    /// In the order of the study.
    fn efforts(&self) -> Vec<Effort> {
        let mut efforts = Vec::new();
        for (config, _) in &self.rows.0 {
            let effort = Effort::of(config);
            if !efforts.contains(&effort) {
                efforts.push(effort);
            }
        }
        efforts
    }

    fn by(&self, effort: Effort) -> Rows<'a> {
        self.rows.such_that(|config| Effort::of(config) == effort)
    }

    fn against_reference(&self, effort: Effort) -> Paired<'a> {
        let Self { grains, .. } = *self;
        Paired { grains, reference: self.by(REFERENCE), other: self.by(effort) }
    }

    /// Those that are no reference.
    fn others(&self) -> impl Iterator<Item = (usize, Effort)> {
        self.efforts().into_iter().enumerate().filter(|(_, effort)| *effort != REFERENCE)
    }
}

pub(super) fn make(workshop: &Workshop) -> Result<Figure> {
    let rows = workshop.rows("tolerance")?;
    let sizes = Size::all(&rows);
    let mut charts: Vec<Chart> = sizes.iter().map(chart).collect();
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
    let mut sheet = Sheet { size: (760 * charts.len().max(2) as u32, 640), charts, caption };
    sheet.caption.extend(workshop.note());
    let of_size = |size: &Size<'_>| {
        let claim = |(_, effort): (usize, Effort)| {
            let how = format!("by {} as by certified ones", effort.long());
            size.against_reference(effort).claim(&how)
        };
        size.others().map(claim).collect::<Vec<_>>()
    };
    let claims = sizes.iter().flat_map(of_size).collect();
    Ok(Figure { name: "tolerance", sheet, claims, table: Some(table(&sizes)) })
}

fn chart(size: &Size<'_>) -> Chart {
    let efforts = size.efforts();
    let bonds = size.rows.values(|config| config.parameters.bond);
    let ends = (-0.6, efforts.len() as f64 - 0.4);
    let mut x = Axis::linear("sweeps; residual; certified ×", ends.0, ends.1);
    let marks = efforts.iter().enumerate();
    x.ticks = marks.map(|(at, effort)| (at as f64, effort.short())).collect();
    let all: Vec<_> = size
        .others()
        .map(|(at, effort)| (at, size.against_reference(effort).comparisons()))
        .collect();
    let reach = all.iter().map(|(_, comparisons)| widest(comparisons)).fold(0.0, f64::max);
    let y = Axis::linear("difference of slump", -1.05 * reach, 1.05 * reach);
    let mut chart = Chart::new(format!("{} grains", size.grains), x, y);
    chart.legend = Corner::LowerLeft;
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
    let zero = crate::chart::points(zero);
    chart.layers.push(Layer::quiet("none", zero, PALETTE[0], Look::Dashes(1)));
    chart
}

/// The numbers behind the claims.
fn table(sizes: &[Size<'_>]) -> Table {
    let columns = columns(&["grains", "effort", "bond", "dt", "unsolved"], "slump_reference");
    let mut rows = Vec::new();
    for size in sizes {
        for (_, effort) in size.others() {
            let runs = size.against_reference(effort);
            for one in runs.comparisons() {
                let of_bond =
                    runs.other.such_that(|config| config.parameters.bond == Some(one.bond));
                let share = of_bond.outcomes(|outcome| {
                    let unsolved = outcome.unconverged_steps - outcome.fallback_steps;
                    unsolved as f64 / outcome.steps as f64
                });
                let mut row = vec![size.grains.to_string(), effort.long(), one.bond.to_string()];
                row.extend([format!("{:e}", one.step), format!("{:.4}", mean(&share).mean)]);
                row.extend(one.cells());
                rows.push(row);
            }
        }
    }
    Table { name: "tolerance-differences", columns, rows }
}

#[cfg(test)]
mod tests {
    use super::super::verdict::Verdict;
    use super::*;
    use crate::Outcome;
    use crate::solver::Method;

    fn run(grains: usize, seed: u64, effort: Effort, slump: f64) -> (Config, Outcome) {
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
        match effort {
            Effort::Sweeps(sweeps) => *max_sweeps = Some(sweeps),
            Effort::Residual(residual) | Effort::FallingBack(residual) => {
                (*stop, *tolerance) = (Some(StopTest::Residual), Some(residual));
                let falls_back = effort == Effort::FallingBack(residual);
                *fallback = Some(if falls_back { Fallback::Tresca } else { Fallback::None });
            }
            Effort::Certified(solves) => {
                (*friction_model, *model_solves) = (Some(FrictionModel::Tresca), Some(solves));
            }
        }
        (config, Outcome::of_slump(slump))
    }

    #[test]
    fn efforts_are_told_apart_and_compared_with_certified_steps_state_by_state() {
        let others = [
            (Effort::Sweeps(10), 0.1),
            (Effort::Residual(1e-3), 1e-4),
            (Effort::FallingBack(1e-3), 1e-4),
            (Effort::Certified(4), 1e-4),
        ];
        let mut runs = Vec::new();
        for seed in 1..=8 {
            let slump = 0.1 * seed as f64;
            for (effort, shift) in others.into_iter().chain([(REFERENCE, 0.0)]) {
                // Not quite the same shift in each state: else there is no scatter to judge by.
                let shift = shift * (1.0 + 0.1 * (seed % 3) as f64);
                runs.push(run(500, seed, effort, slump + shift));
            }
        }
        let rows = Rows(runs.iter().map(|(config, outcome)| (config, outcome)).collect());
        let sizes = Size::all(&rows);
        assert_eq!(sizes.len(), 1);
        let found: Vec<_> = sizes[0].others().collect();
        let expected: Vec<_> = others.iter().map(|(effort, _)| *effort).enumerate().collect();
        assert_eq!(found, expected);
        let verdict = |effort| sizes[0].against_reference(effort).claim("alike").verdict;
        assert_eq!(verdict(Effort::Sweeps(10)), Verdict::Fails);
        let table = table(&sizes);
        assert_eq!(table.rows.len(), 4);
        assert!(table.rows[0].contains(&"0.1112".to_owned()), "{:?}", table.rows[0]);
        assert_eq!(chart(&sizes[0]).x.ticks[1], (1.0, "1e−3".to_owned()));
    }
}
