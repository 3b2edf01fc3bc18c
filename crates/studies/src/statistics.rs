//! Computes means, proportions, slopes and turning points of data, with confidence intervals and p-values. The crate
//! statrs provides the probability distributions.

use glam::{DMat3, DVec3};
use statrs::distribution::{Beta, ContinuousCDF, StudentsT};

/// Default confidence level: the fraction of confidence intervals that contain the true value.
const CONFIDENCE: f64 = 0.95;

/// Returns the p-value of the statement that at least one of two claims is true, from the p-values of the two claims
/// (Bonferroni).
pub(super) fn p_of_either(one: f64, other: f64) -> f64 {
    (2.0 * one.min(other)).min(1.0)
}

/// A mean of several values, with its confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    /// Mean of the values.
    pub mean: f64,
    /// Lower end of the confidence interval.
    pub low: f64,
    /// Upper end of the confidence interval.
    pub high: f64,
    /// Standard error of the mean.
    pub standard_error: f64,
    /// Number of values.
    pub count: usize,
}

/// Returns the mean of independent values with its 95 % interval by Student's t-distribution. With fewer than two
/// values the interval is unbounded.
pub fn mean(values: &[f64]) -> Mean {
    mean_with(values, CONFIDENCE)
}

/// Returns the mean of independent values with its interval at the level `confidence`, between 0 and 1, by Student's
/// t-distribution. With fewer than two values the interval is unbounded.
pub(super) fn mean_with(values: &[f64], confidence: f64) -> Mean {
    let count = values.len();
    let mean = values.iter().sum::<f64>() / count.max(1) as f64;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    let Some(student) = student(count) else {
        let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
        return Mean { mean, low, high, standard_error: f64::INFINITY, count };
    };
    let standard_error = (squares / (count - 1) as f64 / count as f64).sqrt();
    let half = student.inverse_cdf(0.5 + 0.5 * confidence) * standard_error;
    Mean { mean, low: mean - half, high: mean + half, standard_error, count }
}

fn student(count: usize) -> Option<StudentsT> {
    if count < 2 { None } else { StudentsT::new(0.0, 1.0, (count - 1) as f64).ok() }
}

impl Mean {
    /// Returns the one-sided p-value of the claim that the true mean is above `bound`: the probability of a mean this
    /// high if the true mean is at most `bound`.
    pub(super) fn p_above(&self, bound: f64) -> f64 {
        let Some(student) = student(self.count) else { return 1.0 };
        if self.standard_error == 0.0 {
            return if self.mean > bound { 0.0 } else { 1.0 };
        }
        1.0 - student.cdf((self.mean - bound) / self.standard_error)
    }

    /// Returns the standard deviation of the averaged values; infinite for fewer than two values.
    pub(super) fn spread(&self) -> f64 {
        self.standard_error * (self.count as f64).sqrt()
    }

    /// Returns the one-sided p-value of the claim that the true mean is below `bound`: the probability of a mean this
    /// low if the true mean is at least `bound`.
    pub(super) fn p_below(&self, bound: f64) -> f64 {
        Self { mean: -self.mean, ..*self }.p_above(-bound)
    }

    /// Formats the mean and its confidence interval with signs and with `decimals` decimals, as in "+0.12 (+0.10 …
    /// +0.14)".
    pub(super) fn signed(&self, decimals: usize) -> String {
        let Self { mean, low, high, .. } = self;
        format!("{mean:+.decimals$} ({low:+.decimals$} … {high:+.decimals$})")
    }

    /// Returns the p-value of the claim that the true mean is between −`margin` and +`margin`, by two one-sided tests.
    pub(super) fn p_within(&self, margin: f64) -> f64 {
        self.p_above(-margin).max(self.p_below(margin))
    }
}

/// Returns the slope of the least-squares line through points (x, y).
pub(super) fn slope(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let x_mean = points.iter().map(|(x, _)| x).sum::<f64>() / count;
    let y_mean = points.iter().map(|(_, y)| y).sum::<f64>() / count;
    let products: f64 = points.iter().map(|(x, y)| (x - x_mean) * (y - y_mean)).sum();
    let squares: f64 = points.iter().map(|(x, _)| (x - x_mean).powi(2)).sum();
    products / squares
}

/// Returns the proportion of `hits` in `count` trials, and the lower and upper end of its 95 % interval (Clopper and
/// Pearson 1934).
pub(super) fn share(hits: usize, count: usize) -> (f64, f64, f64) {
    let tail = 0.5 * (1.0 - CONFIDENCE);
    let (k, n) = (hits as f64, count as f64);
    let quantile =
        |a: f64, b: f64, p: f64| Beta::new(a, b).map_or(f64::NAN, |beta| beta.inverse_cdf(p));
    let low = if hits == 0 { 0.0 } else { quantile(k, n - k + 1.0, tail) };
    let high = if hits >= count { 1.0 } else { quantile(k + 1.0, n - k, 1.0 - tail) };
    (k / n, low, high)
}

/// Fits a line with one bend to points (x, y), which are sorted by x, and returns the x at which the line bends: the
/// value of `candidates` with the smallest sum of squared deviations. Returns `None` if no candidate has at least two
/// points on each side.
pub(super) fn turning_point(points: &[(f64, f64)], candidates: &[f64]) -> Option<f64> {
    let misfit = |at: f64| -> Option<f64> {
        let left = points.iter().filter(|(x, _)| *x < at).count();
        if left < 2 || points.len() - left < 2 {
            return None;
        }
        // The normal equations of the least-squares fit y = a + b·min(x − at, 0) + c·max(x − at, 0), which bends at x =
        // `at`.
        let row = |(x, y): &(f64, f64)| (DVec3::new(1.0, (x - at).min(0.0), (x - at).max(0.0)), *y);
        let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for (basis, y) in points.iter().map(row) {
            matrix += DMat3::from_cols(basis * basis.x, basis * basis.y, basis * basis.z);
            right += basis * y;
        }
        let fit = matrix.inverse() * right;
        let squares = points.iter().map(row).map(|(basis, y)| (y - basis.dot(fit)).powi(2));
        Some(squares.sum()).filter(|sum: &f64| sum.is_finite())
    };
    let best = candidates.iter().filter_map(|&at| Some((misfit(at)?, at)));
    best.min_by(|one, other| one.0.total_cmp(&other.0)).map(|(_, at)| at)
}

pub(super) fn p_value(p: f64) -> String {
    if p < 1e-4 { "p < 0.0001".into() } else { format!("p = {p:.4}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(one: f64, other: f64, by: f64) {
        assert!((one - other).abs() < by, "{one} is not {other}");
    }

    #[test]
    fn mean_and_interval_of_student() {
        // From tables of Student's distribution: t(0.975; 4) = 2.776445.
        let mean = mean(&[1.0, 2.0, 3.0, 4.0, 5.0]);
        near(mean.mean, 3.0, 1e-12);
        near(mean.standard_error, 0.5f64.sqrt(), 1e-12);
        near(mean.high, 3.0 + 2.776_445 * 0.5f64.sqrt(), 1e-5);
        // From tables of Student's distribution: t(0.95; 4) = 2.131847.
        near(mean.p_above(3.0 - 2.131_847 * 0.5f64.sqrt()), 0.05, 1e-6);
        near(mean.p_below(3.0 + 2.131_847 * 0.5f64.sqrt()), 0.05, 1e-6);
        near(mean.p_above(3.0), 0.5, 1e-9);
        near(mean.p_within(1.0), mean.p_below(1.0), 1e-12);
    }

    #[test]
    fn one_value_proves_nothing() {
        let mean = mean(&[7.0]);
        assert_eq!((mean.low, mean.high), (f64::NEG_INFINITY, f64::INFINITY));
        assert_eq!((mean.p_above(0.0), mean.p_below(9.0)), (1.0, 1.0));
    }

    #[test]
    fn intervals_hold_the_true_mean_in_95_of_100_samples() {
        use rand::{RngExt, SeedableRng};
        let mut random = rand_pcg::Pcg64::seed_from_u64(1);
        let holding = (0..4000).filter(|_| {
            // The sum of twelve uniform random numbers has the mean 6 and is sufficiently close to a normal
            // distribution here.
            let values: Vec<f64> =
                (0..8).map(|_| (0..12).map(|_| random.random_range(0.0..1.0)).sum()).collect();
            let mean = mean(&values);
            (mean.low..=mean.high).contains(&6.0)
        });
        near(holding.count() as f64 / 4000.0, 0.95, 0.012);
    }

    #[test]
    fn where_neither_is_so_one_of_two_is_seen_in_five_of_a_hundred() {
        // The p-values of both claims run over an even grid, as they would be distributed if both claims were false.
        // Then the test should find at least one claim true at the rate 1 − 0.975².
        let side = 400;
        let p = |place: usize| (place as f64 + 0.5) / side as f64;
        let seen = (0..side * side).filter(|at| p_of_either(p(at % side), p(at / side)) < 0.05);
        near(seen.count() as f64 / (side * side) as f64, 0.049_375, 1e-12);
        assert_eq!(p_of_either(0.7, 0.9), 1.0);
    }

    #[test]
    fn shares_of_clopper_and_pearson() {
        // From tables of the interval by Clopper and Pearson: 2 hits in 10 trials give 2.52 % … 55.61 %, and 0 hits in
        // 10 trials give 0 … 30.85 %.
        let (share_of, low, high) = share(2, 10);
        near(share_of, 0.2, 1e-12);
        near(low, 0.0252, 1e-4);
        near(high, 0.5561, 1e-4);
        let (_, low, high) = share(0, 10);
        assert_eq!(low, 0.0);
        near(high, 0.3085, 1e-4);
        assert_eq!(share(10, 10).2, 1.0);
    }

    #[test]
    fn slopes_and_turning_points_of_lines() {
        near(slope(&[(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)]), 2.0, 1e-12);
        let bent: Vec<_> =
            (0..20).map(|k| f64::from(k) * 0.1).map(|x| (x, (x - 0.73).abs())).collect();
        let candidates: Vec<_> = (0..200).map(|k| f64::from(k) * 0.01).collect();
        near(turning_point(&bent, &candidates).expect("a turning point"), 0.73, 1e-9);
        assert_eq!(turning_point(&bent[..3], &candidates), None);
    }
}
