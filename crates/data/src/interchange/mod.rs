//! Writes the contact problem of one step to a file, and reads and solves such files, also those of other programs.
//!
//! A problem file is JSON with these fields: `nc`, the number of contacts; `W` as `row`, `col`, `val`, the matrix W
//! that maps contact impulses to changes of relative velocities (2 nc × 2 nc, 1/kg, rows and columns in the order N0,
//! T0, N1, T1, …); `q` (2 nc, m/s), the relative velocities without contact impulses, including restitution; and `mu`,
//! the coefficient of friction, as a number or a list. With cohesion it also has `c0`, the cohesion impulse C₀Δt of
//! each contact (N·s), and `cone`, the bound of friction: `"shifted"`, μ(P_n + C₀Δt), or `"compressive"`, μ max(P_n, 0)
//! (μ: coefficient of friction, Δt: time step). A solution consists of contact impulses r = (P_n, P_t) (normal and
//! tangential) in N·s and relative velocities u = W r + q; `start` optionally gives initial impulses. Problems that
//! Slump writes also contain their `bodies` ([`BodyForm`]). Text files of the program Siconos with plane problems can
//! be read as well (`siconos`).

mod bodies;
mod several;
mod siconos;
mod solution;

pub use bodies::{BodyForm, problem_file_at, problem_file_of};
pub use several::{FoundSolution, MOST_STARTS, solutions_of_file};
pub use solution::{Solution, solve_file};

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::{self, Error, Result};
use crate::input::{MOST_BYTES, read_text};
use crate::output::write_file;
use crate::solver::{DelassusProblem, Triplets};
use crate::world::FrictionCone;

/// Description of a valid problem file, for error messages.
const FORM: &str = "the JSON of a contact problem, or Siconos' text of a plane one";

/// Coefficient of friction μ, dimensionless: one value for all contacts, or one value for each contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "mu must be a number or a list of numbers")]
pub enum Friction {
    /// One coefficient of friction for all contacts.
    Same(f64),
    /// One coefficient of friction for each contact.
    Each(Vec<f64>),
}

/// Content of a problem file, the contact problem of one step. The documentation of this module lists the fields and
/// their units. Values may be wrong: they are checked before the problem is solved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProblemFile {
    /// Comment that says where the problem comes from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comment: Option<String>,
    /// Number of contacts.
    pub nc: usize,
    /// Coefficient of friction μ, dimensionless.
    pub mu: Friction,
    /// Friction cone, the bound of the friction impulse, N·s: μ(P_n + C₀Δt) (`shifted`) or μ max(P_n, 0)
    /// (`compressive`), with the coefficient of friction μ, the normal impulse P_n and the cohesion impulse C₀Δt
    /// (cohesion force times time step).
    #[serde(default)]
    pub cone: FrictionCone,
    /// Relative velocities q that the contacts would have after the step without contact impulses, including
    /// restitution, m/s: a normal and a tangential value for each contact.
    pub q: Vec<f64>,
    /// Cohesion impulse C₀Δt (cohesion force times time step) of each contact, N·s; `None` without cohesion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub c0: Option<Vec<f64>>,
    /// Initial guess of the contact impulses: (P_n, P_t) (normal and tangential) of each contact, N·s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<Vec<f64>>,
    /// Bodies from which the matrix W and the relative velocities q were computed; `None` if only W and q are known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bodies: Option<BodyForm>,
    /// Matrix W, which maps contact impulses to changes of relative velocities, 1/kg.
    #[serde(rename = "W")]
    pub matrix: Triplets,
}

impl ProblemFile {
    /// Reads a problem file, or a text file of the program Siconos, and checks it.
    ///
    /// # Errors
    /// The error is one sentence that names the file and the fault in it.
    pub fn read(path: &Path) -> Result<Self> {
        let text = read_text(path, FORM, MOST_BYTES)?;
        Self::parse(&text).map_err(|error| Error::file(path, error))
    }

    /// Writes a problem file.
    ///
    /// # Errors
    /// If the file would be larger than the largest file that Slump reads, or the system refuses to write it.
    pub fn write(&self, path: &Path) -> Result<()> {
        let text = self.text();
        let (length, allowed) = (text.len(), format!("at most {MOST_BYTES} bytes"));
        let is_small = length as u64 <= MOST_BYTES;
        error::check(is_small, "the length of the problem's file", length, allowed)?;
        write_file(path, text.as_bytes())
    }

    /// Parses the text of a problem file, or of a text file of the program Siconos, and checks it.
    ///
    /// # Errors
    /// The error is one sentence that names the fault.
    pub fn parse(text: &str) -> Result<Self> {
        let file: Self = if text.trim_start().starts_with('{') {
            serde_json::from_str(text).map_err(|error| {
                Error::value(
                    "the problem",
                    format!("not readable ({error})"),
                    "the JSON of a contact problem",
                )
            })?
        } else {
            siconos::parse(text)?
        };
        file.delassus()?;
        if let Some(bodies) = &file.bodies {
            bodies.check(&file)?;
        }
        Ok(file)
    }

    /// Returns the text of the problem file. Numbers are as short as possible, but reading them back gives exactly the
    /// same values.
    pub fn text(&self) -> String {
        // Serialising strings, numbers and lists of them cannot fail.
        serde_json::to_string(self).expect("a problem is always written") + "\n"
    }

    /// Returns the coefficient of friction μ of each contact.
    pub(crate) fn friction(&self) -> Vec<f64> {
        match &self.mu {
            Friction::Same(mu) => vec![*mu; self.nc],
            Friction::Each(list) => list.clone(),
        }
    }

    /// Returns the cohesion impulse C₀Δt (cohesion force times time step) of each contact, N·s; 0 without cohesion.
    pub(crate) fn cohesion_impulses(&self) -> Vec<f64> {
        self.c0.clone().unwrap_or_else(|| vec![0.0; self.nc])
    }

    /// Returns the contact problem in terms of the matrix W, without bodies. Its initial guess is the initial impulses
    /// of the file.
    ///
    /// # Errors
    /// The error names the field whose length or value is not valid.
    pub fn delassus(&self) -> Result<DelassusProblem> {
        error::check(self.nc != 0, "nc", 0, "at least 1")?;
        // This is checked before any memory is allocated whose size is given by `nc` and not by the size of the file.
        let (length, allowed) = (self.q.len(), format!("{} (2 nc)", 2 * self.nc as u128));
        let is_whole = Some(length) == self.nc.checked_mul(2);
        error::check(is_whole, "the length of q", length, allowed)?;
        let friction = self.friction();
        let allowed = format!("{} (nc)", self.nc);
        error::check(friction.len() == self.nc, "the length of mu", friction.len(), allowed)?;
        let cohesion = self.cohesion_impulses();
        let mut problem =
            DelassusProblem::new(&self.matrix, &self.q, &friction, &cohesion, self.cone)?;
        if let Some(start) = &self.start {
            let allowed = format!("{} (2 nc)", 2 * self.nc);
            error::check(start.len() == 2 * self.nc, "the length of start", start.len(), allowed)?;
            if let Some(at) = start.iter().position(|value| !value.is_finite()) {
                return Err(Error::value(format!("start[{at}]"), start[at], "a finite number"));
            }
            problem.set_impulses(pairs(start));
        }
        Ok(problem)
    }
}

/// Splits a list with a normal and a tangential value for each contact into pairs (normal, tangential).
fn pairs(list: &[f64]) -> impl ExactSizeIterator<Item = [f64; 2]> {
    list.chunks_exact(2).map(|pair| [pair[0], pair[1]])
}
