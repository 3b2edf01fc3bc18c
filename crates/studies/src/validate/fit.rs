//! Fits laws, such as a damped wave or a power law, to measured points.

use crate::statistics::{mean, slope};

/// The change per step of a damped wave x_n = c rⁿ cos(nθ + φ): the factor r of the amplitude and the angle θ. Here n
/// is the number of the step, c the amplitude and φ the phase at n = 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct DampedWave {
    /// Angle θ by which the phase of the wave advances per step, rad.
    pub angle: f64,
    /// Factor r by which the amplitude of the wave changes per step.
    pub shrinkage: f64,
}

/// Fits a damped wave x_n = c rⁿ cos(nθ + φ) to evenly spaced values x_n. The result contains r, the factor of the
/// amplitude per value, and θ, the change of the phase per value; c and φ are the amplitude and the phase at n = 0. The
/// fit uses G. de Prony's recursion between values at the distance `lag` = m,
///
/// > x_{n+m} = 2 r^m cos(mθ) x_n − r^{2m} x_{n−m},
///
/// whose two coefficients are determined by least squares. A lag of about a quarter of a period separates the
/// coefficients best. The result is NaN if the values are not a damped wave with a period longer than twice the lag.
pub(super) fn damped_wave(values: &[f64], lag: usize) -> DampedWave {
    let (mut xx, mut xy, mut yy, mut xz, mut yz) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for window in values.windows(2 * lag + 1) {
        let (y, x, z) = (window[0], window[lag], window[2 * lag]);
        xx += x * x;
        xy += x * y;
        yy += y * y;
        xz += x * z;
        yz += y * z;
    }
    let determinant = xx * yy - xy * xy;
    let forward = (xz * yy - yz * xy) / determinant;
    let back = (xz * xy - yz * xx) / determinant;
    let steps = lag as f64;
    DampedWave {
        angle: (0.5 * forward / back.sqrt()).acos() / steps,
        shrinkage: back.powf(0.5 / steps),
    }
}

/// Returns the power p and the time τ of the law y = y₀ (1 + t/τ)^−p, with the time t and the value y₀ of y at t = 0,
/// that best fits points (t, y) in the logarithm of y. All y must be positive, and t must increase from 0. For a given
/// τ, ln y is a linear function of ln(1 + t/τ), so p follows from a straight line; τ is searched.
pub(super) fn cooling_law(points: &[(f64, f64)]) -> [f64; 2] {
    let line = |tau: f64| {
        let line: Vec<(f64, f64)> =
            points.iter().map(|(t, y)| ((t / tau).ln_1p(), y.ln())).collect();
        line_through(&line)
    };
    let tau = nearest(points.last().map_or(1.0, |(t, _)| *t), |tau| line(tau).1);
    [-line(tau).0, tau]
}

/// Returns the number for which the function `misfit` is smallest, searched on a geometric grid around the first guess
/// `guess`. The grid is refined three times.
pub(super) fn nearest(guess: f64, misfit: impl Fn(f64) -> f64) -> f64 {
    let (mut best, mut ratio) = (guess, 1e3f64);
    for _ in 0..4 {
        let tried = (-40..=40).map(|number| best * ratio.powf(f64::from(number) / 40.0));
        let least = tried.min_by(|one, other| misfit(*one).total_cmp(&misfit(*other)));
        best = least.unwrap_or(f64::NAN);
        ratio = ratio.powf(0.1);
    }
    best
}

/// Returns the slope of the least-squares line through points (x, y), and the sum of the squared deviations of y from
/// this line.
pub(super) fn line_through(points: &[(f64, f64)]) -> (f64, f64) {
    let slope = slope(points);
    let (x_mean, y_mean) = middle(points);
    let left = |(x, y): &(f64, f64)| (y - y_mean - slope * (x - x_mean)).powi(2);
    (slope, points.iter().map(left).sum())
}

/// Returns the mean x and the mean y of points (x, y). The least-squares line passes through this mean point.
pub(super) fn middle(points: &[(f64, f64)]) -> (f64, f64) {
    let mean = |of: fn(&(f64, f64)) -> f64| mean(&points.iter().map(of).collect::<Vec<_>>()).mean;
    (mean(|point| point.0), mean(|point| point.1))
}

/// Returns the power law that best fits points (x, y) in the logarithms of x and y: its exponent, and its value at x =
/// 1.
pub(super) fn power_law(points: &[(f64, f64)]) -> (f64, f64) {
    let logarithms: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let exponent = slope(&logarithms);
    let (x, y) = middle(&logarithms);
    (exponent, (y - exponent * x).exp())
}

/// Returns the rank correlation of x and y in pairs (x, y) (C. Spearman 1904). Equal values get their mean rank. The
/// result is NaN if a value is NaN, or if all x or all y are equal.
pub(super) fn rank_correlation(pairs: &[(f64, f64)]) -> f64 {
    // Twice the difference of the rank of each value from the mean rank.
    let ranks = |of: fn(&(f64, f64)) -> f64| -> Vec<f64> {
        let compare = |one: &(f64, f64), other: &(f64, f64)| {
            of(one).partial_cmp(&of(other)).map_or(f64::NAN, |order| f64::from(order as i8))
        };
        pairs.iter().map(|one| pairs.iter().map(|other| compare(one, other)).sum()).collect()
    };
    let (first, second) = (ranks(|pair| pair.0), ranks(|pair| pair.1));
    let product = |one: &[f64], other: &[f64]| -> f64 {
        one.iter().zip(other).map(|(one, other)| one * other).sum()
    };
    product(&first, &second) / (product(&first, &first) * product(&second, &second)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damped_wave_is_found_again() {
        let wave: Vec<f64> =
            (0..400).map(|n| 0.99f64.powi(n) * (0.07 * f64::from(n) + 0.4).cos()).collect();
        for lag in [5, 20, 30] {
            let DampedWave { angle, shrinkage } = damped_wave(&wave, lag);
            assert!((angle - 0.07).abs() < 1e-9 && (shrinkage - 0.99).abs() < 1e-9, "lag {lag}");
        }
    }

    #[test]
    fn a_cooling_law_is_found_again() {
        for (power, tau) in [(2.0, 3.0), (1.4, 0.2)] {
            let law = |t: f64| 0.7 * (1.0 + t / tau).powf(-power);
            let points: Vec<(f64, f64)> =
                (0..60).map(|n| f64::from(n) * 0.3).map(|t| (t, law(t))).collect();
            let [p, found] = cooling_law(&points);
            assert!((p / power - 1.0).abs() < 2e-3, "{p} is not {power}");
            assert!((found / tau - 1.0).abs() < 5e-3, "{found} is not {tau}");
        }
    }

    #[test]
    fn ranks_correlate_as_tables_say() {
        assert_eq!(rank_correlation(&[(1.0, 9.0), (2.0, 7.0), (5.0, 1.0)]), -1.0);
        assert_eq!(rank_correlation(&[(1.0, 1.0), (2.0, 7.0), (5.0, 9.0)]), 1.0);
        assert_eq!(rank_correlation(&[(1.0, 2.0), (2.0, 1.0), (3.0, 3.0)]), 0.5);
        // The ranks are 1 to 5 against 1, 2, 4, 4, 4. Pearson's coefficient of these ranks is 8/√(10·8).
        let tied = [(1.0, 1.0), (2.0, 2.0), (3.0, 9.0), (4.0, 9.0), (5.0, 9.0)];
        assert!((rank_correlation(&tied) - 0.8f64.sqrt()).abs() < 1e-12);
        assert!(rank_correlation(&tied.map(|(x, _)| (x, 9.0))).is_nan());
        assert!(rank_correlation(&[(1.0, 1.0), (2.0, f64::NAN), (3.0, 2.0)]).is_nan());
    }
}
