//! Whether the slump at each Δt is that at the smallest one, Bond by Bond.

use super::table::Table;
use super::verdict::{Claim, SIGNIFICANT, Verdict};
use super::workshop::Rows;
use crate::config::Config;
use crate::statistics::{Mean, mean, p_value};

/// A Bond and a Δt under one law.
struct Comparison {
    bond: f64,
    /// Δt, s.
    step: f64,
    slump: Mean,
    /// From the slump at the smallest Δt, state by state; none there.
    difference: Option<Mean>,
}

impl Comparison {
    /// Whether the 95 % interval of the difference holds 0.
    fn agrees(&self) -> bool {
        self.difference.is_none_or(|told| told.low <= 0.0 && told.high >= 0.0)
    }
}

/// The slumps of all states at a Bond and a Δt, in the order of the states.
pub(super) fn slumps(rows: &Rows<'_>, bond: f64, step: f64) -> Vec<f64> {
    let here = |config: &Config| {
        config.parameters.bond == Some(bond) && config.parameters.time_step_secs == Some(step)
    };
    rows.such_that(here).outcomes(|outcome| outcome.slump)
}

/// Every Bond at every Δt of `steps`, which rise.
fn compare(rows: &Rows<'_>, steps: &[f64]) -> Vec<Comparison> {
    let mut all = Vec::new();
    for bond in rows.values(|config| config.parameters.bond) {
        let least = slumps(rows, bond, steps[0]);
        for &step in steps {
            let here = slumps(rows, bond, step);
            let pairs = here.iter().zip(&least).map(|(one, other)| one - other);
            let difference = (step != steps[0]).then(|| mean(&pairs.collect::<Vec<_>>()));
            all.push(Comparison { bond, step, slump: mean(&here), difference });
        }
    }
    all
}

/// What is said of a law. With many comparisons some differ by chance, so p-values are multiplied by
/// their number (Bonferroni).
pub(super) fn claim(law: &str, rows: &Rows<'_>, steps: &[f64]) -> Claim {
    let all = compare(rows, steps);
    let differences = || all.iter().filter_map(|one| Some((one, one.difference?)));
    let count = differences().count();
    let outside: Vec<_> = differences()
        .filter(|(one, _)| !one.agrees())
        .map(|(one, told)| format!("Bond {} at {:e} s ({:+.3})", one.bond, one.step, told.mean))
        .collect();
    let two_sided = |told: Mean| 2.0 * told.p_above(0.0).min(told.p_below(0.0));
    let least = differences().map(|(_, told)| two_sided(told)).fold(1.0, f64::min);
    let widest = differences().map(|(_, told)| told.mean.abs()).fold(0.0, f64::max);
    let p = (least * count as f64).min(1.0);
    let measured = format!(
        "{} of {count} means outside the 95 % interval about that at {:e} s{}{}; largest difference \
         {widest:.3}; any difference: {}; {} states",
        outside.len(),
        steps[0],
        if outside.is_empty() { "" } else { ": " },
        outside.join(", "),
        p_value(p),
        rows.seeds().len()
    );
    let verdict = match (p < SIGNIFICANT, outside.is_empty()) {
        (true, _) => Verdict::Fails,
        (false, true) => Verdict::Holds,
        (false, false) => Verdict::Open,
    };
    let said = format!("Beyond the paper: under {law} the slump does not depend on Δt");
    Claim::new(said, measured.replace('-', "−"), verdict)
}

/// The verdict on each Bond and Δt, law by law.
pub(super) fn table(laws: &[(&str, &Rows<'_>)], steps: &[f64]) -> Table {
    let columns = [
        "law",
        "bond",
        "dt",
        "states",
        "slump",
        "half_interval",
        "difference",
        "difference_low",
        "difference_high",
        "agrees",
    ];
    let number = |value: f64| format!("{value:.4}");
    let mut rows = Vec::new();
    for (law, of_law) in laws {
        for one in compare(of_law, steps) {
            let mut row = vec![
                (*law).to_owned(),
                one.bond.to_string(),
                format!("{:e}", one.step),
                one.slump.count.to_string(),
                number(one.slump.mean),
                number(one.slump.high - one.slump.mean),
            ];
            match one.difference {
                Some(told) => row.extend([told.mean, told.low, told.high].map(number)),
                None => row.extend(["", "", ""].map(str::to_owned)),
            }
            let verdict = match (one.difference, one.agrees()) {
                (None, _) => "reference",
                (_, true) => "yes",
                (_, false) => "no",
            };
            row.push(verdict.to_owned());
            rows.push(row);
        }
    }
    Table { name: "range-agreement", columns: columns.to_vec(), rows }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Outcome;

    #[test]
    fn a_shift_beyond_the_interval_is_told_and_one_within_is_not() {
        const STEPS: [f64; 3] = [1e-4, 1e-3, 1e-2];
        let shifts = [0.0, 0.02, -0.1];
        let mut runs = Vec::new();
        for (step, shift) in STEPS.into_iter().zip(shifts) {
            for seed in 1..=6u64 {
                // States differ by far more than what a shift is measured against.
                let scatter =
                    if step == STEPS[0] { 0.0 } else { 0.03 * [1.0, -1.0][seed as usize % 2] };
                let slump = 0.1 * seed as f64 + shift + scatter;
                let mut config = Config::default();
                config.source.seed = Some(seed);
                config.parameters.bond = Some(10.0);
                config.parameters.time_step_secs = Some(step);
                runs.push((config, Outcome::of_slump(slump)));
            }
        }
        let rows = Rows(runs.iter().map(|(config, outcome)| (config, outcome)).collect());
        let told = table(&[("range", &rows)], &STEPS);
        let verdicts: Vec<_> = told.rows.iter().map(|row| row.last().unwrap().as_str()).collect();
        assert_eq!(verdicts, ["reference", "yes", "no"]);
        let claim = claim("range", &rows, &STEPS);
        assert_eq!(claim.verdict, Verdict::Fails, "{}", claim.measured);
        assert!(claim.measured.contains("Bond 10 at 1e−2 s (−0.100)"), "{}", claim.measured);
        assert!(!claim.measured.contains("1e−3"), "{}", claim.measured);
        assert!(told.to_markdown().lines().count() == 2 + STEPS.len());
    }
}
