//! Whether settings go together. Every simulation is asked, so no door leads around it.

use super::remedies::ROWS;
use super::settings::Settings;
use crate::error::{Error, Result};
use crate::setting::Group;

impl Settings {
    /// Checks every number against its range, and what goes with the stepper.
    ///
    /// # Errors
    /// Names the first setting that is outside its range or that the stepper does not take.
    pub fn validate(&self) -> Result<()> {
        self.parameters.validate()?;
        (self.stepper.info().check)(&self.parameters)?;
        self.solver.validate()?;
        self.remedies.validate_each()?;
        for remedy in &ROWS {
            if remedy.is_on(&self.remedies) && !remedy.taken_by.contains(&self.stepper) {
                let takers: Vec<_> = remedy.taken_by.iter().map(|taker| taker.name()).collect();
                let allowed = format!(
                    "left out where stepper is {}: it goes with {}",
                    self.stepper,
                    takers.join(" and ")
                );
                return Err(Error::value(remedy.name, "given", allowed));
            }
        }
        Ok(())
    }

    /// The same without the remedies that its stepper does not take.
    pub fn with_remedies_taken(mut self) -> Self {
        for remedy in ROWS.iter().filter(|remedy| !remedy.taken_by.contains(&self.stepper)) {
            remedy.leave_out(&mut self.remedies);
        }
        self
    }
}
