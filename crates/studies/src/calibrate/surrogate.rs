//! Fits a surrogate model, which predicts the results of runs: polynomials in the varied parameters, by least squares,
//! with the covariance of their values.

/// Number of runs per coefficient of a cubic polynomial, at and above which the fitted polynomials are cubic instead of
/// quadratic. With fewer runs, the random scatter of a cubic polynomial is larger than the error of a quadratic
/// polynomial (measured for the slump of small piles).
const RUNS_PER_COEFFICIENT: usize = 6;

/// Polynomials that predict several results of a run from its parameters. The parameters are scaled so that each range
/// becomes −1 to 1; such scaled parameters are called a place.
#[derive(Clone, Debug)]
pub(super) struct Surrogate {
    degree: usize,
    /// Values of the basis functions (products of Legendre polynomials) for each run: the rows of a matrix X.
    rows: Vec<Vec<f64>>,
    /// The matrix (XᵀX)⁻¹, where X has one row per run and one column per basis function.
    inverse: Vec<Vec<f64>>,
    /// Coefficients of the polynomial of each result.
    coefficients: Vec<Vec<f64>>,
    /// Residuals of each run, one per result, as if the run were left out of the fit: e/(1 − h), with the residual e of
    /// the full fit and the leverage h of the run.
    residuals: Vec<Vec<f64>>,
}

/// Returns the number of coefficients of a polynomial of this degree in this many parameters.
pub(super) fn coefficients(parameters: usize, degree: usize) -> usize {
    (1..=degree).fold(1, |count, k| count * (parameters + k) / k)
}

impl Surrogate {
    /// Fits polynomials to the results of runs. `places` contains the parameters of each run, scaled to −1 … 1. Returns
    /// `None` if too few runs have different parameters.
    pub(super) fn fit(places: &[Vec<f64>], results: &[Vec<f64>]) -> Option<Self> {
        let parameters = places.first()?.len();
        let is_cubic = places.len() >= RUNS_PER_COEFFICIENT * coefficients(parameters, 3);
        let degree = if is_cubic { 3 } else { 2 };
        let terms = coefficients(parameters, degree);
        if places.len() < 2 * terms {
            return None;
        }
        let rows: Vec<_> = places.iter().map(|place| basis(place, degree)).collect();
        let sum = |of: &dyn Fn(usize) -> f64| (0..places.len()).map(of).sum::<f64>();
        let product = |one, other| sum(&|run| rows[run][one] * rows[run][other]);
        let square = (0..terms).map(|one| (0..terms).map(|other| product(one, other)).collect());
        let inverse = inverted(square.collect())?;
        let fitted = |result: usize| {
            let right = (0..terms).map(|term| sum(&|run| rows[run][term] * results[run][result]));
            times(&inverse, &right.collect::<Vec<_>>())
        };
        let coefficients: Vec<_> = (0..results[0].len()).map(fitted).collect();
        let residual = |(row, results): (&Vec<f64>, &Vec<f64>)| {
            let leverage = dot(row, &times(&inverse, row));
            let of = |(result, fit): (&f64, &Vec<f64>)| (result - dot(fit, row)) / (1.0 - leverage);
            results.iter().zip(&coefficients).map(of).collect()
        };
        let residuals = rows.iter().zip(results).map(residual).collect();
        Some(Self { degree, rows, inverse, coefficients, residuals })
    }

    /// Returns the number of degrees of freedom of the residuals: the number of runs minus the number of coefficients.
    pub(super) fn freedom(&self) -> usize {
        self.rows.len() - self.inverse.len()
    }

    pub(super) fn degree(&self) -> usize {
        self.degree
    }

    /// Returns the results that the polynomials predict at a place (parameters scaled to −1 … 1).
    pub(super) fn values(&self, place: &[f64]) -> Vec<f64> {
        let row = basis(place, self.degree);
        self.coefficients.iter().map(|fit| dot(fit, &row)).collect()
    }

    /// Returns the covariance of the first `count` predicted results at a place (parameters scaled to −1 … 1): the sum
    /// of w² e eᵀ over the runs, with the weight w of a run in the predicted value and its vector e of residuals. This
    /// formula does not assume that the results scatter equally at all places (HC3: J. G. MacKinnon, H. White, J.
    /// Econometrics 29, 305, 1985).
    pub(super) fn covariance(&self, place: &[f64], count: usize) -> Vec<Vec<f64>> {
        let direction = times(&self.inverse, &basis(place, self.degree));
        let mut sums = vec![vec![0.0; count]; count];
        for (row, residuals) in self.rows.iter().zip(&self.residuals) {
            let weight = dot(row, &direction);
            for one in 0..count {
                for other in 0..count {
                    sums[one][other] += weight * weight * residuals[one] * residuals[other];
                }
            }
        }
        sums
    }

    /// Returns the root mean square error of the predictions of the result with the index `result`. The result of each
    /// run is predicted by the fit to all other runs.
    pub(super) fn scatter(&self, result: usize) -> f64 {
        let squares = self.residuals.iter().map(|residuals| residuals[result].powi(2));
        (squares.sum::<f64>() / self.residuals.len() as f64).sqrt()
    }
}

/// Returns the values of the basis functions at a place (parameters scaled to −1 … 1): all products of Legendre
/// polynomials up to the total degree `degree`, which is at most 3.
fn basis(place: &[f64], degree: usize) -> Vec<f64> {
    let mut products = vec![(1.0, 0)];
    for &x in place {
        let powers = [1.0, x, 1.5 * x * x - 0.5, 2.5 * x * x * x - 1.5 * x];
        let with = |&(product, used): &(f64, usize)| {
            (0..=degree - used).map(move |power| (product * powers[power], used + power))
        };
        products = products.iter().flat_map(with).collect();
    }
    products.into_iter().map(|(product, _)| product).collect()
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(one, other)| one * other).sum()
}

pub(super) fn times(matrix: &[Vec<f64>], vector: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| dot(row, vector)).collect()
}

/// Returns the inverse of a symmetric positive definite matrix, by Gauss–Jordan elimination; `None` if the matrix is
/// singular.
pub(super) fn inverted(mut matrix: Vec<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    let size = matrix.len();
    let largest = (0..size).map(|k| matrix[k][k]).fold(0.0, f64::max);
    for k in 0..size {
        let pivot = matrix[k][k];
        // A pivot that is NaN also counts as singular.
        if pivot.partial_cmp(&(1e-14 * largest)) != Some(std::cmp::Ordering::Greater) {
            return None;
        }
        matrix[k][k] = 1.0;
        matrix[k].iter_mut().for_each(|entry| *entry /= pivot);
        let pivot_row = matrix[k].clone();
        for (_, row) in matrix.iter_mut().enumerate().filter(|(index, _)| *index != k) {
            let factor = std::mem::take(&mut row[k]);
            row.iter_mut().zip(&pivot_row).for_each(|(entry, other)| *entry -= factor * other);
        }
    }
    Some(matrix)
}
