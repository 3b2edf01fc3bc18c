//! Compares the computing times of solver methods over many contact problems. Some methods do not solve some of the
//! problems, and the means take this into account.

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Timing {
    /// Computing time until the method solved the problem, or until it stopped without a solution, s.
    pub secs: f64,
    pub solved: bool,
}

/// Returns the geometric mean of values above 0; `None` if there are no values.
pub(super) fn geometric_mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0usize);
    for value in values {
        sum += value.ln();
        count += 1;
    }
    (count > 0).then(|| (sum / count as f64).exp())
}

pub(super) fn share_solved(timings: &[Timing]) -> f64 {
    let solved = timings.iter().filter(|timing| timing.solved).count();
    solved as f64 / timings.len().max(1) as f64
}

/// Returns how many times as fast as a base method a method is: the geometric mean of the ratio of their computing
/// times, over the problems that the method solves. If the base method does not solve a problem, the time until it
/// stopped counts, which is a lower bound of the time that it would need.
pub(super) fn speed_ratio(base: &[Timing], method: &[Timing]) -> Option<f64> {
    let pairs = base.iter().zip(method).filter(|(_, method)| method.solved);
    geometric_mean(pairs.map(|(base, method)| base.secs / method.secs))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solved(secs: f64) -> Timing {
        Timing { secs, solved: true }
    }

    fn failed(secs: f64) -> Timing {
        Timing { secs, solved: false }
    }

    #[test]
    fn geometric_means() {
        let mean = geometric_mean([1.0, 10.0, 100.0]).expect("a mean");
        assert!((mean - 10.0).abs() < 1e-12);
        assert_eq!(geometric_mean([]), None);
        assert_eq!(share_solved(&[solved(1.0), failed(1.0), solved(2.0), solved(9.0)]), 0.75);
    }

    #[test]
    fn a_ratio_counts_failures_of_the_base_as_a_bound_and_leaves_out_the_methods_own() {
        let base = [solved(8.0), failed(50.0), solved(4.0), failed(50.0)];
        let method = [solved(2.0), solved(1.0), failed(0.1), failed(0.1)];
        let ratio = speed_ratio(&base, &method).expect("a ratio");
        // The ratios of the two solved problems are 8/2 = 4 and at least 50/1 = 50, with the geometric mean √(4 · 50).
        assert!((ratio - 200f64.sqrt()).abs() < 1e-12);
        assert_eq!(speed_ratio(&base, &[failed(1.0); 4]), None);
    }
}
