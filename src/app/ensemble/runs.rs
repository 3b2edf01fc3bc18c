//! The other initial states of a scene ("other piles", made from other seeds), the computation of one run, and the mean
//! over finished runs.

use std::ops::ControlFlow;

use crate::config::Config;
use crate::error::Result;
use crate::live::LiveStart;
use crate::scene::{NewPile, Scene, built_in};
use crate::sim::{RunEnding, Settings, Simulation};
use crate::study::{self, Mean};
use crate::world::Grain;

/// The slump Δy of a run (relative drop of the mean height) against simulated time: pairs of time, s, and slump.
pub(crate) type SlumpSeries = Vec<[f64; 2]>;

/// Mean slump of several runs against simulated time with its 95 % confidence interval (Student's distribution), at the
/// times that all runs have in common.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Band {
    pub times_secs: Vec<f64>,
    pub means: Vec<f64>,
    /// Upper ends of the confidence intervals of the means; ∞ for fewer than [`LEAST_COUNT`] runs.
    pub highs: Vec<f64>,
    pub count: usize,
    /// The slump curves of the runs, each with the index of its initial state among the other initial states of the
    /// scene.
    pub runs: Vec<(usize, SlumpSeries)>,
}

/// Smallest number of runs whose mean is shown with a confidence interval. Half the width of the interval of two runs is
/// six times the difference of their slumps, so the interval says almost nothing about the mean.
pub(super) const LEAST_COUNT: usize = 3;

impl Band {
    /// Computes the mean slumps of runs that have the same settings and therefore the same times.
    pub(crate) fn of(runs: &[(usize, &SlumpSeries)]) -> Self {
        let all = runs.iter().map(|&(pile, run)| (pile, run.clone())).collect();
        let mut band = Self { count: runs.len(), runs: all, ..Self::default() };
        let shared = runs.iter().map(|(_, run)| run.len()).min().unwrap_or(0);
        for index in 0..shared {
            let slumps: Vec<f64> = runs.iter().map(|(_, run)| run[index][1]).collect();
            let mean = study::mean(&slumps);
            band.times_secs.push(runs[0].1[index][0]);
            band.means.push(mean.mean);
            band.highs.push(if band.count < LEAST_COUNT { f64::INFINITY } else { mean.high });
        }
        band
    }

    /// Returns the mean slump and the half-width of its confidence interval at the simulated time `time_secs`, s: the
    /// values of the last computed time at or before it. `None` if `time_secs` is before the first computed time, or
    /// after the last one by at least the interval between two computed times.
    pub(crate) fn at(&self, time_secs: f64) -> Option<(f64, f64)> {
        let index = self.index_at(time_secs)?;
        Some((self.means[index], self.highs[index] - self.means[index]))
    }

    fn index_at(&self, time_secs: f64) -> Option<usize> {
        let (&last, spacing) = (self.times_secs.last()?, self.times_secs.get(1)?);
        let index = self.times_secs.partition_point(|&at| at <= time_secs + 1e-3 * spacing);
        index.checked_sub(1).filter(|_| time_secs < last + spacing)
    }

    /// Compares runs under two settings at a simulated time, s. Only the piles that ran under both settings count.
    /// Returns the mean slump under the settings of `self`, the mean slump under those of `other`, and the mean
    /// difference, `other` − `self`. `None` if the runs under one of the settings have no value at this time.
    pub(super) fn paired(&self, other: &Self, time_secs: f64) -> Option<[Mean; 3]> {
        let (index, other_index) = (self.index_at(time_secs)?, other.index_at(time_secs)?);
        let pair = |(pile, run): &(usize, SlumpSeries)| {
            let (_, twin) = other.runs.iter().find(|(own, _)| own == pile)?;
            Some([run[index][1], twin[other_index][1]])
        };
        let pairs: Vec<_> = self.runs.iter().filter_map(pair).collect();
        let mean =
            |value: fn(&[f64; 2]) -> f64| study::mean(&pairs.iter().map(value).collect::<Vec<_>>());
        Some([mean(|pair| pair[0]), mean(|pair| pair[1]), mean(|pair| pair[1] - pair[0])])
    }
}

/// Largest number of points in the slump curve of a run, not counting the last point. If the run has more steps, the
/// points are several steps apart. A larger number shows faster changes of the slump, but takes more memory.
const MOST_POINTS: u64 = 400;
/// Computes the slump curve of a scene from its initial state to its end. `goes_on` is called after each step; if it
/// returns false, the run stops and the result is `None`.
pub(super) fn slump(
    scene: &Scene,
    mut goes_on: impl FnMut() -> bool,
) -> Result<Option<SlumpSeries>> {
    let mut simulation = scene.simulation()?;
    let steps = simulation.step_at(scene.duration_secs);
    let stride = steps.div_ceil(MOST_POINTS).max(1);
    let point = |simulation: &Simulation| [simulation.time_secs(), simulation.observables().slump];
    let mut series = vec![point(&simulation)];
    let ended = simulation.run(steps, |simulation| {
        let step = simulation.observables().step;
        if step.is_multiple_of(stride) || step == steps {
            series.push(point(simulation));
        }
        Ok(if goes_on() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
    })?;
    match ended {
        RunEnding::Done => Ok(Some(series)),
        RunEnding::Stopped => Ok(None),
        RunEnding::NotFinite(failure) => Err(failure),
    }
}

/// Number of other initial states that are run to compute a mean slump. More initial states give a narrower confidence
/// interval, but take longer.
const COUNT: usize = 8;
/// Largest number of grains of a pile that is also made from other seeds. The deposition of a larger pile takes
/// minutes.
const MOST_GRAINS: usize = 1_000;

/// Returns the descriptions of the other piles of the open scene, which differ only in their seed. The seeds are 1, 2,
/// …, without the scene's own seed and the seed of the built-in pile. The list is empty if the grains of the scene were
/// not made from a seed, or if the scene is too large.
pub(super) fn others_of(opened: &LiveStart) -> Vec<NewPile> {
    let Some(own) = pile_of(opened).filter(|pile| pile.grains <= MOST_GRAINS) else {
        return Vec::new();
    };
    let chosen = NewPile::default().seed;
    let seeds = (1..).filter(|&seed| seed != own.seed && seed != chosen);
    seeds.take(COUNT).map(|seed| NewPile { seed, ..own.clone() }).collect()
}

/// Returns the description from which the pile of a scene was made (seed, number of grains, box); `None` if the grains
/// were not made from a seed.
pub(super) fn pile_of(opened: &LiveStart) -> Option<NewPile> {
    let LiveStart { config, scene, .. } = opened;
    if config.source.initial.is_some() {
        return None;
    }
    // A saved run states only the name of its scene.
    let is_shipped = || {
        let shipped = built_in(Config::DEFAULT_SCENE).ok()?;
        let places = |scene: &Scene| -> Vec<_> {
            scene.grains.iter().map(|grain| (grain.position, grain.radius)).collect()
        };
        (scene.name == shipped.name && places(scene) == places(&shipped)).then(NewPile::default)
    };
    config.new_pile().ok()?.or_else(is_shipped)
}

/// Returns the open scene with the settings `settings`, and with `pile` (the same pile made from another seed) instead
/// of its own. `grains` are the grains of this pile at rest.
pub(super) fn scene_of(
    opened: &LiveStart,
    pile: &NewPile,
    grains: Vec<Grain>,
    settings: &Settings,
) -> Result<Scene> {
    let Config { mut source, .. } = opened.config.clone();
    if opened.config.source.makes_new_pile() || opened.config.new_pile()?.is_none() {
        source.set_new_pile(pile);
    }
    let config = Config { source, ..Config::default() };
    config.with_settings(settings).scene_from(grains)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::scene_start::start;

    fn run(slumps: [f64; 3]) -> SlumpSeries {
        [0.0, 0.5, 1.0].into_iter().zip(slumps).map(|(time, slump)| [time, slump]).collect()
    }

    #[test]
    fn means_and_intervals_are_those_of_student() {
        let runs = [[0.0, 1.0, 2.0], [0.0, 2.0, 4.0], [0.0, 3.0, 9.0]].map(run);
        let band = Band::of(&runs.iter().enumerate().collect::<Vec<_>>());
        assert_eq!((band.count, &band.means), (3, &vec![0.0, 2.0, 5.0]));
        // From tables: t(0.975; 2) = 4.302653. The standard error of 1, 2, 3 is 1/√3.
        let half = band.highs[1] - band.means[1];
        assert!((half - 4.302_653 / 3f64.sqrt()).abs() < 1e-5, "{half}");
        assert_eq!(band.at(0.7), Some((2.0, half)));
        assert_eq!(band.at(0.5 - 1e-12), Some((2.0, half)), "rounding of times is none");
        assert_eq!(band.at(1.0).map(|(mean, _)| mean), Some(5.0));
        assert_eq!((band.at(-0.1), band.at(1.6)), (None, None));
    }

    #[test]
    fn differences_are_those_of_the_piles_that_ran_under_both_settings() {
        let runs = [[0.0, 1.0, 2.0], [0.0, 2.0, 4.0], [0.0, 3.0, 9.0], [0.0, 9.0, 9.0]].map(run);
        let band = |piles: &[(usize, usize)]| {
            Band::of(&piles.iter().map(|&(pile, one)| (pile, &runs[one])).collect::<Vec<_>>())
        };
        let (before, after) = (band(&[(0, 0), (1, 1), (2, 2)]), band(&[(5, 3), (2, 3), (1, 2)]));
        let [one, other, difference] = before.paired(&after, 1.0).unwrap();
        assert_eq!([one.mean, other.mean, difference.mean], [6.5, 9.0, 2.5]);
        assert_eq!(difference.count, 2);
        // From tables: t(0.975; 1) = 12.7062. The standard error of 5 and 0 is 2.5.
        assert!((difference.high - difference.mean - 12.7062 * 2.5).abs() < 1e-3);
        assert!(before.paired(&after, 2.0).is_none());
    }

    #[test]
    fn one_run_and_two_have_no_interval_and_none_nothing() {
        let run = run([0.0, 1.0, 2.0]);
        for runs in [&[(0, &run)][..], &[(0, &run), (1, &run)]] {
            assert_eq!(Band::of(runs).at(0.5), Some((1.0, f64::INFINITY)));
        }
        assert_eq!(Band::of(&[]).at(0.0), None);
    }

    fn opened(config: Config) -> LiveStart {
        start(&config.without_settling().unwrap(), config).unwrap()
    }

    fn seeds(config: Config) -> Vec<u64> {
        others_of(&opened(config)).iter().map(|pile| pile.seed).collect()
    }

    #[test]
    fn others_are_of_other_seeds_and_never_the_one_that_was_chosen() {
        assert_eq!(seeds(Config::default()), [1, 2, 3, 4, 5, 6, 7, 9]);
        let mut config = Config::default();
        config.source.seed = Some(3);
        assert_eq!(seeds(config.clone()), [1, 2, 4, 5, 6, 7, 9, 10]);
        config.source.grains = Some(MOST_GRAINS + 1);
        assert_eq!(seeds(config), [0; 0]);
        assert_eq!(seeds(Config::of_scene("cradle")), [0; 0]);
    }

    #[test]
    fn grains_that_came_from_elsewhere_have_no_others() {
        let mut opened = opened(Config::default());
        opened.scene.grains[0].position.x += 1e-9;
        assert!(others_of(&opened).is_empty());
    }

    #[test]
    fn another_pile_is_the_scene_with_other_grains() {
        let opened = opened(Config::default());
        let mut settings = opened.scene.settings();
        settings.parameters.bond = 33.0;
        let pile = others_of(&opened).remove(0);
        let grains = opened.scene.grains[..100].to_vec();
        let scene = scene_of(&opened, &pile, grains, &settings).unwrap();
        assert_eq!((scene.grains.len(), scene.settings()), (100, settings));
        assert_eq!(scene.duration_secs, opened.scene.duration_secs);
    }
}
