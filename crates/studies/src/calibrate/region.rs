//! Computes the confidence region of a calibration: the values of the varied parameters, within their ranges, with
//! which the scene agrees with the measured targets. The ranges form a box, and a point of the box has one value per
//! parameter.

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::surrogate::{Surrogate, inverted, times};

/// Confidence level of the region of parameters that agree with the measured targets.
const CONFIDENCE: f64 = 0.9;
/// Number of points that fill the ranges of the varied parameters evenly, to find the confidence region. With this
/// number, the fraction of the points that belong to the region has an error of about 0.1 %.
const POINTS: usize = 16_384;

/// A confidence region of parameters. It consists of the parameter values at which Hotelling's T² of the differences
/// between predicted results and measured targets is at most a limit, which follows from the confidence level of 90 %
/// and the F-distribution. Polynomials fitted to runs predict the results. The covariance in T² is the sum of the
/// covariances of the predictions and of the targets.
#[derive(Clone, Debug)]
pub struct Region {
    space: Vec<[f64; 2]>,
    targets: Vec<[f64; 2]>,
    pub(super) surrogate: Surrogate,
    limit: f64,
    /// Points (parameter values) that fill the ranges of the parameters evenly. With each point is its
    /// [`Region::misfit`], a measure of the disagreement between predicted results and targets, which is at most 1 in
    /// the confidence region.
    pub(super) points: Vec<(Vec<f64>, f64)>,
}

impl Region {
    /// Computes the confidence region. `space` contains the range of each parameter, `targets` the measured value and
    /// the standard error of each target. `points` contains the parameter values of each run, and `results` the results
    /// of each run, which begin with the quantities of the targets. Returns `None` if there are too few runs.
    pub fn new(
        space: &[[f64; 2]],
        targets: &[[f64; 2]],
        points: &[Vec<f64>],
        results: &[Vec<f64>],
    ) -> Option<Self> {
        let places: Vec<_> = points.iter().map(|point| place_of(space, point)).collect();
        let surrogate = Surrogate::fit(&places, results)?;
        let count = targets.len() as f64;
        let freedom = surrogate.freedom() as f64 - count + 1.0;
        let quantile = FisherSnedecor::new(count, freedom).ok()?.inverse_cdf(CONFIDENCE);
        let limit = count * surrogate.freedom() as f64 / freedom * quantile;
        let (space, targets) = (space.to_vec(), targets.to_vec());
        let mut region = Self { space, targets, surrogate, limit, points: Vec::new() };
        let misfit = |number| {
            let point = point_of_box(&region.space, number);
            let misfit = region.misfit(&point);
            (point, misfit)
        };
        region.points = (0..POINTS).map(misfit).collect();
        Some(region)
    }

    /// Returns a measure of the disagreement between predicted results and targets for the parameter values `point`.
    /// The measure is Hotelling's T², divided by the largest T² in the confidence region, so it is at most 1 in the
    /// region.
    pub fn misfit(&self, point: &[f64]) -> f64 {
        let place = place_of(&self.space, point);
        let values = self.surrogate.values(&place);
        let mut covariance = self.surrogate.covariance(&place, self.targets.len());
        let mut differences = Vec::new();
        for (number, [target, error]) in self.targets.iter().enumerate() {
            covariance[number][number] += error * error;
            differences.push(values[number] - target);
        }
        let Some(inverse) = inverted(covariance) else { return f64::INFINITY };
        let solved = times(&inverse, &differences);
        solved.iter().zip(&differences).map(|(one, other)| one * other).sum::<f64>() / self.limit
    }

    fn inside(&self) -> impl Iterator<Item = &[f64]> {
        self.points.iter().filter(|(_, misfit)| *misfit <= 1.0).map(|(point, _)| &**point)
    }

    /// Returns the volume of the confidence region, as a fraction of the volume of all allowed parameter values.
    pub fn share(&self) -> f64 {
        self.inside().count() as f64 / POINTS as f64
    }

    /// Returns the parameter values with which the scene agrees best with the measured targets.
    pub fn best(&self) -> &[f64] {
        let best = self.points.iter().min_by(|(_, one), (_, other)| one.total_cmp(other));
        best.map_or(&[], |(point, _)| point)
    }

    /// Returns the least and the largest value of the varied parameter with the index `parameter` in the confidence
    /// region; NaN if the region is empty.
    pub(super) fn range(&self, parameter: usize) -> [f64; 2] {
        let values = || self.inside().map(|point| point[parameter]);
        [f64::min, f64::max].map(|best| values().fold(f64::NAN, best))
    }

    /// Returns the value of the result with the index `result` that the fitted polynomial predicts for the parameter
    /// values `point`, and the standard error of this value.
    pub(super) fn value(&self, point: &[f64], result: usize) -> [f64; 2] {
        let place = place_of(&self.space, point);
        let variance = self.surrogate.covariance(&place, result + 1)[result][result];
        [self.surrogate.values(&place)[result], variance.sqrt()]
    }

    /// Returns the standard deviation of the predicted values of the result with the index `result` over all points of
    /// the confidence region.
    pub(super) fn spread(&self, result: usize) -> f64 {
        let value = |point| self.surrogate.values(&place_of(&self.space, point))[result];
        let values: Vec<f64> = self.inside().map(value).collect();
        crate::statistics::mean(&values).spread()
    }
}

/// Scales the parameter values `point` so that the range of each parameter, given in `space`, becomes −1 to 1. The
/// fitted polynomials are functions of these scaled parameters.
fn place_of(space: &[[f64; 2]], point: &[f64]) -> Vec<f64> {
    let place = |([from, to], x): (&[f64; 2], &f64)| 2.0 * (x - from) / (to - from) - 1.0;
    space.iter().zip(point).map(place).collect()
}

/// Returns point number `number` of a sequence of parameter values that fills the ranges in `space` evenly, however
/// many points are taken. Within its range, each value is a multiple of a power of 1/φ modulo 1, with the generalised
/// golden ratio φ (M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018).
pub(super) fn point_of_box(space: &[[f64; 2]], number: usize) -> Vec<f64> {
    let root = 1.0 / (space.len() + 1) as f64;
    let ratio = (0..60).fold(2.0, |ratio: f64, _| (1.0 + ratio).powf(root));
    let coordinate = |(index, [from, to]): (i32, &[f64; 2])| {
        let share = (0.5 + (number + 1) as f64 * ratio.powi(-index)).fract();
        from + (to - from) * share
    };
    (1..).zip(space).map(coordinate).collect()
}
