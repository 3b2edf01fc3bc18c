//! Piles that start from the same states and differ in one thing: slumps state by state, what is claimed of their
//! differences, their table and their picture. The experiments are in `beyond.rs`.

use std::collections::BTreeMap;

use super::claims::{Claim, SIGNIFICANT, Verdict};
use super::studies::Rows;
use super::{Figure, StudyRunner};
use crate::chart::{Axis, Chart, INK, Layer, Look, PALETTE, Point, Sheet, points};
use crate::config::Config;
use crate::error::Result;
use crate::report::ReportTable;
use crate::statistics::{Mean, mean, p_value};

/// A difference of slump up to which one variant stands for the other, by the largest number of grains that it is
/// asked of. Slumps are 0.05 to 0.5, and those of two states of a size differ by 0.1 and more.
const MARGINS: [(usize, f64); 2] = [(138, 0.02), (usize::MAX, 0.04)];
/// More groups than this share one chart.
const MOST_CHARTS: usize = 4;
/// Width of a chart, of one that all groups share, and of a character, pixels.
const CHART: u32 = 560;
const SHARED_CHART: u32 = 1200;
const CHARACTER: usize = 12;

/// An experiment that compares slumps state by state.
pub(super) struct PairedExperiment {
    pub name: &'static str,
    pub studies: &'static [&'static str],
    /// The group that a run belongs to, in words, from its config and that of the first run.
    pub group: fn(&Config, &Config) -> String,
    /// What differs within a group, in words.
    pub level: fn(&Config) -> String,
    /// Of a group's runs, those that others are compared with, and the others.
    pub splits: &'static [for<'a> fn(&Rows<'a>) -> [Rows<'a>; 2]],
    pub claims: fn(&Rows<'_>, &[Comparison]) -> Vec<Claim>,
}

/// The runs of one group against its base, level by level.
pub(super) struct Comparison {
    pub group: String,
    /// What the levels are compared with, in words.
    pub base: String,
    pub levels: Vec<(String, Vec<PairedSlumps>)>,
    pub grains: usize,
}

/// The slumps of all states that ended in both variants, at one Bond and Δt.
pub(super) struct PairedSlumps {
    pub name: String,
    pub bond: f64,
    /// Δt of the other, s.
    pub step: f64,
    pub base: Mean,
    /// The other's less the base's, state by state.
    pub difference: Mean,
    /// Share of the other's steps that were not solved as asked.
    unsolved: f64,
    /// The difference of each state, by its seed.
    of_states: Vec<(Option<u64>, f64)>,
}

impl PairedSlumps {
    pub(super) fn new(name: String, bond: f64, base: &Rows<'_>, other: &Rows<'_>) -> Self {
        let pairs = pairs(base, other);
        let of_states: Vec<_> = pairs.iter().map(|(seed, one, two)| (*seed, two - one)).collect();
        let unsolved = other.results(|result| {
            let unsolved = result.tally.unconverged_steps - result.tally.fallback_steps;
            unsolved as f64 / result.tally.steps as f64
        });
        Self {
            name,
            bond,
            step: other.steps().first().copied().unwrap_or(f64::NAN),
            base: mean(&pairs.iter().map(|(_, one, _)| *one).collect::<Vec<_>>()),
            difference: mean(&of_states.iter().map(|(_, apart)| *apart).collect::<Vec<_>>()),
            unsolved: mean(&unsolved).mean,
            of_states,
        }
    }

    /// Every Δt of the other with every Bond of it, against the same Bond and, if there is one, the same Δt.
    fn all(base: &Rows<'_>, other: &Rows<'_>) -> Vec<Self> {
        let mut all = Vec::new();
        for step in other.steps() {
            for bond in other.bonds() {
                let name = format!("Bond {bond} at {step:e} s");
                let base = base.of_bond(bond);
                let at_step = base.of_step(step);
                let base = if at_step.0.is_empty() { base } else { at_step };
                all.push(Self::new(name, bond, &base, &other.of_bond(bond).of_step(step)));
            }
        }
        all
    }

    /// How far its 95 % interval goes from 0.
    fn reach(&self) -> f64 {
        self.difference.low.abs().max(self.difference.high.abs())
    }

    /// True if its 95 % interval is without 0.
    pub(super) fn differs(&self) -> bool {
        self.difference.low > 0.0 || self.difference.high < 0.0
    }

    fn point(&self, x: f64) -> Point {
        let Mean { mean, low, high, count, .. } = self.difference;
        // Two states tell next to nothing of their spread.
        Point { x, y: mean, interval: (count > 2).then_some((low, high)) }
    }
}

/// The states that ended in both: seed, slump of the base, that of the other.
pub(super) fn pairs(base: &Rows<'_>, other: &Rows<'_>) -> Vec<(Option<u64>, f64, f64)> {
    let with = |seed| other.0.iter().find(move |(config, _)| config.source.seed == seed);
    let of_base = base.0.iter().filter_map(|(config, result)| {
        let seed = config.source.seed;
        Some((seed, result.slump, with(seed)?.1.slump))
    });
    of_base.collect()
}

impl PairedExperiment {
    pub(super) fn figure(&self, studies: &StudyRunner) -> Result<Figure> {
        let mut rows = Rows(Vec::new());
        for study in self.studies {
            rows.0.extend(studies.rows(study)?.0);
        }
        let all = self.compare(&rows);
        let mut sheet = sheet(&all);
        let states = rows.seeds().len();
        sheet.caption.push(format!("Up to {states} initial states."));
        let claims = (self.claims)(&rows, &all);
        Ok(Figure { name: self.name, sheet, claims, table: Some(table(self.name, &all)) })
    }

    pub(super) fn compare(&self, rows: &Rows<'_>) -> Vec<Comparison> {
        let Some((first, _)) = rows.0.first() else { return Vec::new() };
        let mut all = Vec::new();
        for (group, of_group) in parts(rows, |config| (self.group)(config, first)) {
            for split in self.splits {
                let [base, others] = split(&of_group);
                let Some((config, _)) = base.0.first() else { continue };
                let levels = parts(&others, self.level).into_iter();
                let levels = levels.map(|(level, other)| (level, PairedSlumps::all(&base, &other)));
                let grains = others.0.iter().filter_map(|(config, _)| config.source.grains).max();
                all.push(Comparison {
                    group: group.clone(),
                    base: (self.level)(config),
                    levels: levels.collect(),
                    grains: grains.unwrap_or_default(),
                });
            }
        }
        all
    }
}

/// Runs by what is said of them, in their order.
pub(super) fn parts<'a>(
    rows: &Rows<'a>,
    words: impl Fn(&Config) -> String,
) -> Vec<(String, Rows<'a>)> {
    let mut parts: Vec<(String, Rows<'a>)> = Vec::new();
    for &(config, result) in &rows.0 {
        let words = words(config);
        match parts.iter_mut().find(|(known, _)| *known == words) {
            Some((_, part)) => part.0.push((config, result)),
            None => parts.push((words, Rows(vec![(config, result)]))),
        }
    }
    parts
}

impl Comparison {
    pub(super) fn pairs(&self) -> impl Iterator<Item = &PairedSlumps> {
        self.levels.iter().flat_map(|(_, pairs)| pairs)
    }

    /// What is said, with the comparison's words in the place of {group}, {base} and {margin}, and that its slumps are
    /// alike within the margin.
    pub(super) fn alike(&self, said: &str) -> Claim {
        self.alike_at(said, "", &self.pairs().collect::<Vec<_>>())
    }

    /// The same of some of its pairs, with words for them in the place of {level}.
    ///
    /// With many comparisons some differ by chance, so p-values are multiplied by their number (Bonferroni).
    pub(super) fn alike_at(&self, said: &str, level: &str, all: &[&PairedSlumps]) -> Claim {
        let fits = MARGINS.iter().find(|(most, _)| self.grains <= *most);
        let margin = fits.map_or(0.0, |(_, margin)| *margin);
        let outside: Vec<_> = all
            .iter()
            .filter(|one| one.differs())
            .map(|one| format!("{} ({:+.3})", one.name, one.difference.mean))
            .collect();
        // A value a state: its mean difference over all of them.
        let mut of_states: BTreeMap<Option<u64>, Vec<f64>> = BTreeMap::new();
        for (seed, difference) in all.iter().flat_map(|one| &one.of_states) {
            of_states.entry(*seed).or_default().push(*difference);
        }
        let of_states: Vec<_> = of_states.values().map(|some| mean(some).mean).collect();
        let pooled = mean(&of_states);
        let count = all.len();
        let least = all.iter().map(|one| one.difference.p_not_zero()).fold(1.0, f64::min);
        let p = (least * count as f64).min(1.0);
        let by_chance = 100.0 * (1.0 - 0.95f64.powi(count as i32));
        let farthest = all.iter().map(|one| one.reach()).fold(0.0, f64::max);
        let measured = format!(
            "{} of {count} differences have a 95 % interval without 0{}{}, where without any effect at least one \
             has in {by_chance:.0} % of such studies; any difference: {}; mean over all {:+.4} ± {:.4}; the intervals \
             reach to ±{farthest:.3}; {} states",
            outside.len(),
            if outside.is_empty() { "" } else { ": " },
            outside.join(", "),
            p_value(p),
            pooled.mean,
            pooled.standard_error,
            of_states.len(),
        );
        let verdict = match (p < SIGNIFICANT, farthest <= margin) {
            (true, _) => Verdict::Fails,
            (false, true) => Verdict::Holds,
            (false, false) => Verdict::Open,
        };
        let said = said.replace("{group}", &self.group).replace("{base}", &self.base);
        let said = said.replace("{level}", level).replace("{margin}", &margin.to_string());
        Claim::new(said.replace("e-", "e−"), measured.replace('-', "−"), verdict)
    }
}

pub(super) fn table(name: &str, all: &[Comparison]) -> ReportTable {
    let columns =
        "group base level bond dt states unsolved slump_base difference standard_error low high p";
    let mut rows = Vec::new();
    for Comparison { group, base, levels, .. } in all {
        for (level, one) in
            levels.iter().flat_map(|(level, all)| all.iter().map(move |one| (level, one)))
        {
            let Mean { mean, standard_error, low, high, count, .. } = one.difference;
            let mut row = vec![group.clone(), base.clone(), level.clone(), one.bond.to_string()];
            row.extend([format!("{:e}", one.step), count.to_string()]);
            let p = one.difference.p_not_zero();
            let numbers = [one.unsolved, one.base.mean, mean, standard_error, low, high, p];
            row.extend(numbers.map(|number| format!("{number:.4}")));
            rows.push(row);
        }
    }
    let columns = columns.split(' ').collect();
    ReportTable { name: format!("{name}-differences"), columns, rows }
}

/// Draws every difference: a chart a group with a place for each level, or, of many groups, one with a place for each.
fn sheet(all: &[Comparison]) -> Sheet {
    let mut bonds: Vec<f64> = all.iter().flat_map(Comparison::pairs).map(|one| one.bond).collect();
    bonds.sort_by(f64::total_cmp);
    bonds.dedup();
    let ends = all.iter().flat_map(Comparison::pairs).map(|one| {
        let Point { y, interval, .. } = one.point(0.0);
        interval.map_or(y.abs(), |_| one.reach())
    });
    let reach = 1.05 * ends.fold(0.05, f64::max);
    let (shared, mut width) = (all.len() > MOST_CHARTS, CHART);
    let mut parts: Vec<(String, Vec<Place<'_>>)> = Vec::new();
    if shared {
        let places = all.iter().map(|one| (one.group.clone(), one.pairs().collect()));
        parts.push(("Difference of slump".into(), places.collect()));
        width = SHARED_CHART;
    } else {
        let title = |one: &Comparison| format!("{}, less {}", one.group, one.base);
        parts.extend(all.iter().map(|one| (title(one), one.places())));
    }
    let mut caption: Vec<String> = Vec::new();
    let mut charts = Vec::new();
    let signed = |words: &str| words.replace("e-", "e−");
    for (title, places) in parts {
        let ends = (-0.6, places.len() as f64 - 0.4);
        let mut x = Axis::linear("", ends.0, ends.1);
        let room: usize =
            places.iter().map(|(name, _)| CHARACTER * (name.chars().count() + 1)).sum();
        let is_numbered = room > width as usize * 3 / 4;
        let tick = |(at, (name, _)): (usize, &Place<'_>)| {
            (at as f64, if is_numbered { (at + 1).to_string() } else { signed(name) })
        };
        x.ticks = places.iter().enumerate().map(tick).collect();
        if is_numbered && caption.is_empty() {
            let numbered =
                places.iter().zip(1..).map(|((name, _), number)| format!("{number}: {name}"));
            caption.push(signed(&numbered.collect::<Vec<_>>().join("; ")));
        }
        let y = Axis::linear("difference of slump", -reach, reach);
        let mut chart = Chart::new(signed(&title), x, y);
        let zero = points([(ends.0, 0.0), (ends.1, 0.0)]);
        chart.layers.push(Layer::quiet("none", zero, INK, Look::Dashes(1)));
        for (index, &bond) in bonds.iter().enumerate() {
            let here = places.iter().enumerate().flat_map(|(at, (_, pairs))| {
                let of_bond = pairs.iter().filter(|one| one.bond == bond);
                of_bond.map(move |one| one.point(at as f64))
            });
            let colour = PALETTE[index % PALETTE.len()];
            let curve = Layer::curve(format!("Bond {bond}"), here.collect(), colour, Look::Dots(5));
            chart.layers.push(curve.beside(2 * index, 2 * bonds.len() - 1));
        }
        charts.push(chart);
    }
    let size = (width * charts.len() as u32, 620);
    caption.push(
        "Differences from the same states: means, with 95 % intervals from three states up.".into(),
    );
    Sheet { size, charts, caption }
}

/// A place of a chart: its name, and what is drawn there.
type Place<'a> = (String, Vec<&'a PairedSlumps>);

impl Comparison {
    /// A place for each level, or for each Δt of the only one.
    fn places(&self) -> Vec<Place<'_>> {
        if let [(_, only)] = &self.levels[..] {
            let by_step = only.chunk_by(|one, next| one.step == next.step);
            return by_step.map(|all| (seconds(all[0].step), all.iter().collect())).collect();
        }
        let levels = self.levels.iter();
        levels.map(|(level, pairs)| (level.clone(), pairs.iter().collect())).collect()
    }
}

pub(super) fn seconds(secs: f64) -> String {
    format!("{secs:e} s")
}

#[cfg(test)]
mod tests {
    use super::super::beyond::{FRICTION, PILE_CHOICES, RANGE, TOLERANCE};
    use super::*;
    use crate::RunResult;
    use crate::sim::Stepper;
    use crate::solver::{Fallback, FrictionModel, Method, StopTest};
    use crate::world::FrictionCone;

    /// A run of 138 grains at a Bond and Δt from a state.
    fn run(bond: f64, step: f64, seed: u64) -> Config {
        let mut config = Config::default();
        (config.source.seed, config.source.grains) = (Some(seed), Some(138));
        (config.parameters.bond, config.parameters.time_step_secs) = (Some(bond), Some(step));
        config
    }

    /// Claims and table of an experiment with these runs and their slumps.
    fn judged(experiment: &PairedExperiment, runs: &[(Config, f64)]) -> (Vec<Claim>, ReportTable) {
        let results: Vec<_> = runs.iter().map(|(_, slump)| RunResult::of_slump(*slump)).collect();
        let rows = Rows(runs.iter().map(|(config, _)| config).zip(&results).collect());
        let all = experiment.compare(&rows);
        ((experiment.claims)(&rows, &all), table(experiment.name, &all))
    }

    #[test]
    fn a_choice_is_named_for_what_is_changed_and_has_its_runs() {
        use FrictionCone::{Compressive, Shifted};
        let config = |tolerance, cone, step| {
            let mut config = run(20.0, step, 1);
            config.solver.tolerance = Some(tolerance);
            config.parameters.cone = Some(cone);
            (config, 0.0)
        };
        let runs = [
            config(1e-7, Shifted, 1e-3),
            config(1e-7, Compressive, 1e-3),
            config(1e-7, Shifted, 5e-3),
            config(0.5, Shifted, 1e-3),
            config(0.5, Shifted, 5e-3),
        ];
        let rows = judged(&PILE_CHOICES, &runs).1.rows;
        let groups: Vec<_> = rows.iter().map(|row| (&*row[0], &*row[2])).collect();
        assert_eq!(groups, [("as it is", "5e-3 s"), ("tolerance 0.5", "5e-3 s")]);
        let first = &runs[0].0;
        assert_eq!(super::super::studies::changes(&runs[1].0, first), "cone compressive");
    }

    #[test]
    fn states_are_paired_and_a_model_stands_for_coulombs_law_within_a_margin_alone() {
        let of = |shift: f64, scatter: f64| {
            let mut runs = Vec::new();
            for model in [FrictionModel::Tresca, FrictionModel::Coulomb] {
                let is_model = model == FrictionModel::Tresca;
                for bond in [0.0, 20.0] {
                    // States differ by far more than what a shift is measured against.
                    for seed in (1..=16u64).filter(|seed| is_model || *seed != 7) {
                        let moved =
                            if is_model { scatter * [1.0, -1.0][seed as usize % 2] } else { 0.0 };
                        let moved = moved + if is_model && bond == 20.0 { shift } else { 0.0 };
                        let mut config = run(bond, 1e-3, seed);
                        config.solver.friction_model = Some(model);
                        runs.push((config, 0.1 * seed as f64 + moved));
                    }
                }
            }
            let (mut claims, table) = judged(&FRICTION, &runs);
            assert_eq!(claims.len(), 1);
            (claims.remove(0), table)
        };
        let (claim, table) = of(0.0, 1e-3);
        assert_eq!(claim.verdict, Verdict::Holds, "{}", claim.measured);
        assert!(table.rows.iter().all(|row| row[5] == "15"), "{:?}", table.rows);
        assert_eq!(of(0.0, 0.2).0.verdict, Verdict::Open);
        let (claim, _) = of(0.1, 0.02);
        assert_eq!(claim.verdict, Verdict::Fails);
        assert!(claim.measured.contains("1 of 2 differences"), "{}", claim.measured);
        assert!(claim.measured.contains("Bond 20 at 1e−3 s (+0.10"), "{}", claim.measured);
    }

    #[test]
    fn a_shift_beyond_the_interval_is_told_and_one_within_is_not() {
        let mut runs = Vec::new();
        for (step, shift) in [(1e-4, 0.0), (1e-3, 0.02), (1e-2, -0.1)] {
            for seed in 1..=6u64 {
                let scatter =
                    if step == 1e-4 { 0.0 } else { 0.03 * [1.0, -1.0][seed as usize % 2] };
                let mut config = run(10.0, step, seed);
                config.stepper = Some(Stepper::Range);
                runs.push((config, 0.1 * seed as f64 + shift + scatter));
            }
        }
        let (claims, table) = judged(&RANGE, &runs);
        assert_eq!((claims.len(), table.rows.len()), (1, 2));
        assert_eq!(claims[0].verdict, Verdict::Fails, "{}", claims[0].measured);
        assert!(
            claims[0].measured.contains("Bond 10 at 1e−2 s (−0.100)"),
            "{}",
            claims[0].measured
        );
        assert!(!claims[0].measured.contains("1e−3"), "{}", claims[0].measured);
        assert_eq!(table.to_markdown().lines().count(), 4);
    }

    #[test]
    fn accuracies_are_told_apart_and_compared_with_certified_steps_state_by_state() {
        let mut runs = Vec::new();
        for seed in 1..=8 {
            // Not quite the same shift in each state: else there is no scatter to judge by.
            let shift = 1.0 + 0.1 * (seed % 3) as f64;
            for (number, shift) in
                [0.1 * shift, 1e-4 * shift, 1e-4 * shift, 1e-4 * shift, 0.0].into_iter().enumerate()
            {
                let mut config = run(20.0, 1e-3, seed);
                config.source.grains = Some(500);
                let solver = &mut config.solver;
                solver.method = Some(Method::Auto);
                match number {
                    0 => solver.max_sweeps = Some(10),
                    1 | 2 => {
                        (solver.stop, solver.tolerance) = (Some(StopTest::Residual), Some(1e-3));
                        let fallback = if number == 1 { Fallback::None } else { Fallback::Tresca };
                        solver.fallback = Some(fallback);
                    }
                    _ => {
                        solver.friction_model = Some(FrictionModel::Tresca);
                        solver.model_solves = Some(if number == 3 { 4 } else { 1 });
                    }
                }
                runs.push((config, 0.1 * seed as f64 + shift));
            }
        }
        let (claims, table) = judged(&TOLERANCE, &runs);
        let levels: Vec<_> = table.rows.iter().map(|row| &*row[2]).collect();
        let residual = "a residual of 1e-3";
        let falling_back = "a residual of 1e-3 or bounds of friction";
        assert_eq!(levels, ["10 sweeps", residual, falling_back, "certified ×4"]);
        assert_eq!((claims.len(), claims[0].verdict), (4, Verdict::Fails));
        assert!(table.rows[0].contains(&"0.1112".to_owned()), "{:?}", table.rows[0]);
    }
}
