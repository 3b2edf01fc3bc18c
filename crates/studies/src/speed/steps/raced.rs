//! A collection of steps, and what the methods made of it.

use super::super::entrants::Entrant;
use super::super::race::Race;
use crate::performance::{SpeedRatio, Timing, geometric_mean, share_solved, speed_ratio};
use crate::solver::{Method, Ordering};

/// Residuals of the profiles' panels, and of the tables in words.
pub(super) const PROFILED: [f64; 3] = [1e-3, 1e-6, 1e-8];
/// The method that the others are compared with.
const BASE: (Method, Ordering) = (Method::Nsgs, Ordering::Interleaved);
/// A warm start below this residual leaves next to nothing to be told about a method: the pile rests.
const FAR: f64 = 1e-3;

/// A collection and what the methods made of it.
#[derive(Clone)]
pub(super) struct Raced {
    /// In the names of files.
    pub label: &'static str,
    /// In titles.
    pub title: String,
    pub entrants: Vec<Entrant>,
    /// `races[entrant][problem]`.
    pub races: Vec<Vec<Race>>,
}

impl Raced {
    pub(super) fn timings(&self, method: usize, tolerance: f64) -> Vec<Timing> {
        self.races[method].iter().map(|race| race.timing(tolerance)).collect()
    }

    /// The steps that begin far from their solution.
    pub(super) fn far(&self) -> Self {
        let far = |races: &Vec<Race>| {
            races.iter().filter(|race| race.start_residual > FAR).cloned().collect()
        };
        let races: Vec<Vec<Race>> = self.races.iter().map(far).collect();
        let count = races.first().map_or(0, Vec::len);
        let title = format!("the {count} of them that begin with a residual above {FAR:e}");
        Self { label: self.label, title, entrants: self.entrants.clone(), races }
    }

    pub(super) fn all_timings(&self, tolerance: f64) -> Vec<Vec<Timing>> {
        (0..self.races.len()).map(|method| self.timings(method, tolerance)).collect()
    }

    /// The smallest residual that any method reached, problem by problem.
    pub(super) fn floors(&self) -> Vec<f64> {
        let problems = self.races.first().map_or(0, Vec::len);
        let smallest = |problem: usize| {
            let of_method = self.races.iter().map(|races| races[problem].smallest_residual);
            of_method.fold(f64::INFINITY, f64::min)
        };
        (0..problems).map(smallest).collect()
    }
}

/// A row of what the methods come to at one residual.
pub(super) fn summary(
    raced: &Raced,
    method: usize,
    tolerance: f64,
) -> (f64, Option<f64>, SpeedRatio) {
    let timings = raced.timings(method, tolerance);
    let is_base = |entrant: &Entrant| (entrant.solver.method, entrant.solver.ordering) == BASE;
    let base = raced.entrants.iter().position(is_base).unwrap_or(0);
    let solved = timings.iter().filter(|timing| timing.solved).map(|timing| timing.secs);
    let ratio = speed_ratio(&raced.timings(base, tolerance), &timings);
    (share_solved(&timings), geometric_mean(solved), ratio)
}
