//! The mean of several runs with its interval, at each of their times.

use std::sync::Arc;

use crate::study;

/// A run's slump: simulated time, s, and Δy.
pub(super) type Series = Vec<[f64; 2]>;

/// Mean slump of some runs and its 95 % interval by Student's distribution, at the times that all of them have.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Band {
    /// Simulated times, s.
    pub times_secs: Vec<f64>,
    /// Means.
    pub means: Vec<f64>,
    /// Lower ends of the intervals; −∞ for one run.
    pub lows: Vec<f64>,
    /// Upper ends of the intervals; ∞ for one run.
    pub highs: Vec<f64>,
    /// Number of runs.
    pub count: usize,
}

impl Band {
    /// Of runs with the same settings, which have the same times.
    pub(super) fn of(runs: &[Arc<Series>]) -> Self {
        let mut band = Self { count: runs.len(), ..Self::default() };
        let shared = runs.iter().map(|run| run.len()).min().unwrap_or(0);
        for index in 0..shared {
            let slumps: Vec<f64> = runs.iter().map(|run| run[index][1]).collect();
            let mean = study::mean(&slumps);
            band.times_secs.push(runs[0][index][0]);
            band.means.push(mean.mean);
            band.lows.push(mean.low);
            band.highs.push(mean.high);
        }
        band
    }

    /// Mean and half the width of the interval at the last time up to `time_secs`; nothing before the first and
    /// after the last.
    pub(crate) fn at(&self, time_secs: f64) -> Option<(f64, f64)> {
        let (&last, spacing) = (self.times_secs.last()?, self.times_secs.get(1)?);
        let index = self.times_secs.partition_point(|&at| at <= time_secs + 1e-3 * spacing);
        let index = index.checked_sub(1).filter(|_| time_secs < last + spacing)?;
        Some((self.means[index], self.highs[index] - self.means[index]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(slumps: [f64; 3]) -> Arc<Series> {
        Arc::new(
            [0.0, 0.5, 1.0].into_iter().zip(slumps).map(|(time, slump)| [time, slump]).collect(),
        )
    }

    #[test]
    fn means_and_intervals_are_those_of_student() {
        let band = Band::of(&[run([0.0, 1.0, 2.0]), run([0.0, 2.0, 4.0]), run([0.0, 3.0, 9.0])]);
        assert_eq!((band.count, &band.means), (3, &vec![0.0, 2.0, 5.0]));
        // Tables: t(0.975; 2) = 4.302653; the standard error of 1, 2, 3 is 1/√3.
        let half = band.highs[1] - band.means[1];
        assert!((half - 4.302_653 / 3f64.sqrt()).abs() < 1e-5, "{half}");
        assert_eq!(band.at(0.7), Some((2.0, half)));
        assert_eq!(band.at(0.5 - 1e-12), Some((2.0, half)), "rounding of times is none");
        assert_eq!(band.at(1.0).map(|(mean, _)| mean), Some(5.0));
        assert_eq!((band.at(-0.1), band.at(1.6)), (None, None));
    }

    #[test]
    fn one_run_has_no_interval_and_none_nothing() {
        let band = Band::of(&[run([0.0, 1.0, 2.0])]);
        assert_eq!(band.at(0.5), Some((1.0, f64::INFINITY)));
        assert_eq!(Band::of(&[]).at(0.0), None);
    }
}
