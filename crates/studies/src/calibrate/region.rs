//! The parameters that agree with targets: a confidence region in the box of the varied parameters.

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::surrogate::{Surrogate, inverted, times};

/// Confidence of the region.
const CONFIDENCE: f64 = 0.9;
/// Number of points that fill the box evenly. The fraction of the box has an error of about 0.1 %.
const POINTS: usize = 16_384;

/// A confidence region of parameters: with Hotelling's T² of the differences between surrogate and targets, whose
/// covariance is that of the surrogate plus that of the targets.
#[derive(Clone, Debug)]
pub struct Region {
    space: Vec<[f64; 2]>,
    targets: Vec<[f64; 2]>,
    pub(super) surrogate: Surrogate,
    limit: f64,
    /// Points of the box, each with its [`Region::misfit`].
    pub(super) points: Vec<(Vec<f64>, f64)>,
}

impl Region {
    /// The region in a box with these ends of each parameter. Targets have a value and its standard error. Each run has
    /// a point of the box and results, first those with targets. Returns `None` if there are too few runs.
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

    /// T² of a point divided by its limit: at most 1 in the region.
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

    /// Fraction of the box.
    pub fn share(&self) -> f64 {
        self.inside().count() as f64 / POINTS as f64
    }

    /// The point that agrees best.
    pub fn best(&self) -> &[f64] {
        let best = self.points.iter().min_by(|(_, one), (_, other)| one.total_cmp(other));
        best.map_or(&[], |(point, _)| point)
    }

    /// Least and largest value of a parameter in the region; NaN if the region is empty.
    pub(super) fn range(&self, parameter: usize) -> [f64; 2] {
        let values = || self.inside().map(|point| point[parameter]);
        [f64::min, f64::max].map(|best| values().fold(f64::NAN, best))
    }

    /// Value of a result at a point, and its standard error.
    pub(super) fn value(&self, point: &[f64], result: usize) -> [f64; 2] {
        let place = place_of(&self.space, point);
        let variance = self.surrogate.covariance(&place, result + 1)[result][result];
        [self.surrogate.values(&place)[result], variance.sqrt()]
    }

    /// Standard deviation of a result over the region.
    pub(super) fn spread(&self, result: usize) -> f64 {
        let value = |point| self.surrogate.values(&place_of(&self.space, point))[result];
        let values: Vec<f64> = self.inside().map(value).collect();
        crate::statistics::mean(&values).spread()
    }
}

/// A point of the box as a place in the cube from −1 to 1.
fn place_of(space: &[[f64; 2]], point: &[f64]) -> Vec<f64> {
    let place = |([from, to], x): (&[f64; 2], &f64)| 2.0 * (x - from) / (to - from) - 1.0;
    space.iter().zip(point).map(place).collect()
}

/// Point number `number` of a sequence that fills the box evenly, however many points are taken: multiples of powers of
/// 1/φ modulo 1, where φ generalises the golden ratio (M. Roberts, "The Unreasonable Effectiveness of Quasirandom
/// Sequences", 2018).
pub(super) fn point_of_box(space: &[[f64; 2]], number: usize) -> Vec<f64> {
    let root = 1.0 / (space.len() + 1) as f64;
    let ratio = (0..60).fold(2.0, |ratio: f64, _| (1.0 + ratio).powf(root));
    let coordinate = |(index, [from, to]): (i32, &[f64; 2])| {
        let share = (0.5 + (number + 1) as f64 * ratio.powi(-index)).fract();
        from + (to - from) * share
    };
    (1..).zip(space).map(coordinate).collect()
}
