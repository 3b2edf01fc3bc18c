//! What is asked of piles beyond the paper, state by state.

use super::claims::{Claim, Verdict};
use super::fig6::cohesive_time;
use super::paired::{Comparison, PairedExperiment, PairedSlumps, seconds};
use super::studies::{Rows, changes};
use crate::RunResult;
use crate::config::Config;
use crate::sim::Stepper;
use crate::solver::{Fallback, FrictionModel, StopTest};
use crate::statistics::{mean, p_value, slope};

/// Initial states from which on a difference that is not seen counts as none.
const FEWEST_STATES: usize = 8;
/// The sign that the paper's figure gives to the change at the smallest Bond of the study, and at the largest.
const SIGNS: [f64; 2] = [-1.0, 1.0];

/// What Fig. 5a hangs on: by how much slump changes from the smallest to the largest Δt.
pub(super) const PILE_CHOICES: PairedExperiment = PairedExperiment {
    name: "pile-choices",
    studies: &["pile-choices"],
    group: changes,
    level: step,
    splits: &[from_least_step],
    claims: |_, all| {
        let bonds = [f64::min, f64::max].map(|pick| {
            all.iter().flat_map(Comparison::pairs).map(|one| one.bond).reduce(pick).unwrap_or(0.0)
        });
        bonds.into_iter().zip(SIGNS).map(|(bond, sign)| claim_of_sign(bond, sign, all)).collect()
    },
};

/// Slump against the number of grains, at three cohesive times.
pub(super) const PILE_SIZE: PairedExperiment = PairedExperiment {
    name: "pile-size",
    studies: &["pile-size"],
    group: |config, _| of_cohesive_time(config),
    level: grains,
    splits: &[|rows| {
        let count = |config: &Config| config.source.grains.map(|grains| grains as f64);
        rows.parted(|config| count(config) == rows.values(count).first().copied())
    }],
    claims: |rows, _| rows.steps().into_iter().map(|step| grows(&rows.of_step(step))).collect(),
};

/// How well a step must be solved in the paper's scheme, at three cohesive times.
pub(super) const PILE_TOLERANCE: PairedExperiment = PairedExperiment {
    name: "pile-tolerance",
    studies: &["pile-tolerance"],
    group: |config, _| of_cohesive_time(config),
    level: |config| format!("{:e}", config.solver.tolerance.unwrap_or_default()),
    splits: &[|rows| {
        let tightest = rows.tolerances().first().copied();
        rows.parted(|config| config.solver.tolerance == tightest)
    }],
    claims: |_, all| all.iter().map(settles).collect(),
};

/// The law `range` beside the paper's.
pub(super) const RANGE: PairedExperiment = PairedExperiment {
    name: "range",
    studies: &["range"],
    group: |config, _| config.stepper.map_or("", Stepper::name).to_owned(),
    level: step,
    splits: &[from_least_step],
    claims: |_, all| {
        alike(
            all,
            "Beyond the paper: under {group} slump is that at Δt = {base}, within {margin}",
            "",
        )
    },
};

/// Where slump under `range` does not depend on Δt, and where it does.
pub(super) const RANGE_REGIMES: PairedExperiment = PairedExperiment {
    name: "range-regimes",
    studies: &["range-regimes", "range-size"],
    group: changes,
    level: step,
    splits: &[from_least_step],
    claims: |_, all| {
        let said = "Beyond the paper: under range slump is that at Δt = {base}, within {margin}, with {group}";
        alike(all, said, "newton to a residual of 1e−6, restitution threshold 2 g·Δt; shifted cone")
    },
};

/// Dry piles that bounce: `range` against `moreau` at a small Δt, and against `dem`.
pub(super) const DRY: PairedExperiment = PairedExperiment {
    name: "dry",
    studies: &["dry"],
    group: |config, _| format!("ρ = {}", config.parameters.restitution.unwrap_or_default()),
    level: |config| format!("{} at {}", config.stepper.map_or("", Stepper::name), step(config)),
    splits: &[|rows| against(rows, Stepper::Moreau), |rows| against(rows, Stepper::Dem)],
    claims: |_, all| {
        let said = "Beyond the paper: dry piles of {group} slump under range at every Δt as under {base}, within {margin}";
        let hangs_on = "restitution without which nothing below 2 g·Δt bounces, but under dem; the rough base; slump alone";
        alike(all, said, hangs_on)
    },
};

/// A model of friction against Coulomb's law, by the number of grains.
pub(super) const FRICTION: PairedExperiment = PairedExperiment {
    name: "friction",
    studies: &["friction"],
    group: |config, _| grains(config),
    level: |config| config.solver.friction_model.unwrap_or_default().to_string(),
    splits: &[|rows| {
        rows.parted(|config| config.solver.friction_model == Some(FrictionModel::Coulomb))
    }],
    claims: |_, all| by_level(all, "under {level} as under Coulomb's law"),
};

/// How well a step must be solved, by the number of grains: by so many sweeps, to such a residual of Coulomb's law, or
/// certified under bounds of friction that are taken anew so often.
pub(super) const TOLERANCE: PairedExperiment = PairedExperiment {
    name: "tolerance",
    studies: &["tolerance"],
    group: |config, _| grains(config),
    level: accuracy,
    splits: &[|rows| rows.parted(|config| accuracy(config) == "certified ×1")],
    claims: |_, all| by_level(all, "by {level} as by steps that are {base}"),
};

fn step(config: &Config) -> String {
    seconds(config.parameters.time_step_secs.unwrap_or_default())
}

fn grains(config: &Config) -> String {
    format!("{} grains", config.source.grains.unwrap_or_default())
}

fn accuracy(config: &Config) -> String {
    let solver = &config.solver;
    let tolerance = format!("{:e}", solver.tolerance.unwrap_or_default());
    if solver.friction_model == Some(FrictionModel::Tresca) {
        return format!("certified ×{}", solver.model_solves.unwrap_or(1));
    }
    match (solver.stop, solver.fallback) {
        (Some(StopTest::Residual), Some(Fallback::Tresca)) => {
            format!("a residual of {tolerance} or bounds of friction")
        }
        (Some(StopTest::Residual), _) => format!("a residual of {tolerance}"),
        _ => format!("{} sweeps", solver.max_sweeps.unwrap_or_default()),
    }
}

fn of_cohesive_time(config: &Config) -> String {
    format!("cohesive time of {:.1}", cohesive_time(config))
}

fn from_least_step<'a>(rows: &Rows<'a>) -> [Rows<'a>; 2] {
    let least = rows.steps().first().copied();
    rows.parted(|config| config.parameters.time_step_secs == least)
}

/// The runs of a law at its smallest Δt, and those of `range`.
fn against<'a>(rows: &Rows<'a>, law: Stepper) -> [Rows<'a>; 2] {
    let of = |law| rows.such_that(|config| config.stepper == Some(law));
    let [least, _] = from_least_step(&of(law));
    [least, of(Stepper::Range)]
}

fn alike(all: &[Comparison], said: &str, hangs_on: &str) -> Vec<Claim> {
    all.iter().map(|one| one.alike(said).hanging_on(hangs_on)).collect()
}

/// The same of each level of each.
fn by_level(all: &[Comparison], how: &str) -> Vec<Claim> {
    let said =
        format!("Beyond the paper: {{group}} slump {how}, within {{margin}} at every Bond and Δt");
    let claims = all.iter().flat_map(|one| {
        one.levels
            .iter()
            .map(|(level, pairs)| one.alike_at(&said, level, &pairs.iter().collect::<Vec<_>>()))
    });
    claims.collect()
}

fn claim_of_sign(bond: f64, sign: f64, all: &[Comparison]) -> Claim {
    let changes = || {
        all.iter().filter_map(|one| Some((&one.group, one.pairs().find(|one| one.bond == bond)?)))
    };
    let p_of = |PairedSlumps { difference, .. }: &PairedSlumps| {
        let [above, below] = [difference.p_above(0.0), difference.p_below(0.0)];
        if sign > 0.0 { (above, below) } else { (below, above) }
    };
    let verdict = |(_, change): (_, &PairedSlumps)| Verdict::of(p_of(change).0, p_of(change).1);
    let verdicts: Vec<Verdict> = changes().map(verdict).collect();
    let listed: Vec<_> = changes()
        .map(|(group, change)| {
            format!("{group} {:+.3} ({})", change.difference.mean, p_value(p_of(change).0))
        })
        .collect();
    let verdict = if verdicts.contains(&Verdict::Fails) {
        Verdict::Fails
    } else if verdicts.iter().all(|verdict| *verdict == Verdict::Holds) {
        Verdict::Holds
    } else {
        Verdict::Open
    };
    let what = if sign > 0.0 { "rises" } else { "falls" };
    let said = format!("Fig. 5a: at Bond {bond} slump {what} with Δt whatever is chosen");
    Claim::new(said, listed.join("; ").replace('-', "−"), verdict)
        .by_chance(
            "each choice alone comes out so in 5 % of studies, all of them together in fewer: they share states",
        )
        .hanging_on("the choices that were tried; two Δt of six; states that have no part in Fig. 5a")
}

fn grows(rows: &Rows<'_>) -> Claim {
    let of_seed = |seed| {
        let run = rows.of_seed(seed);
        let place = |(config, result): &(&Config, &RunResult)| {
            Some(((config.source.grains? as f64).log10(), result.slump))
        };
        slope(&run.0.iter().filter_map(place).collect::<Vec<_>>())
    };
    let slope = mean(&rows.seeds().into_iter().map(of_seed).collect::<Vec<_>>());
    let time = rows.0.first().map_or_else(String::new, |(config, _)| of_cohesive_time(config));
    let measured = format!(
        "slope per decade of grains {}, {} states; not 0: {}",
        slope.signed(3),
        slope.count,
        p_value(slope.p_not_zero())
    );
    let said = format!("Beyond the paper: at a {time} the slump hangs on the number of grains");
    Claim::new(said, measured, Verdict::of(slope.p_not_zero(), 1.0))
}

/// The loosest tolerance from which on no slump differs from that of the tightest one.
fn settles(one: &Comparison) -> Claim {
    let mut levels: Vec<_> = one.levels.iter().collect();
    levels.reverse();
    let is_settled =
        |level: &&&(String, Vec<PairedSlumps>)| !level.1.iter().any(PairedSlumps::differs);
    let settled = levels.iter().take_while(is_settled).last();
    let states = one.pairs().map(|one| one.difference.count).min().unwrap_or(0);
    // That no difference is seen says little where few states were looked at.
    let undecided = settled.is_none() || states < FEWEST_STATES;
    let settled = settled.map_or(&one.base, |(level, _)| level);
    let measured = format!(
        "no difference from a relative change of {} is seen at {settled} and tighter, {states} states",
        one.base
    );
    Claim::new(
        format!("Beyond the paper: how well a step must be solved, at a {}", one.group),
        measured.replace("e-", "e−"),
        if undecided { Verdict::Open } else { Verdict::Holds },
    )
}
