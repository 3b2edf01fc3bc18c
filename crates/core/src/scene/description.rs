//! The contents of a scene.

use std::fmt::Arguments;
use std::path::PathBuf;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::error::{self, Error, Result};
use crate::scene::NewPile;
use crate::scene::tones::tone_in_layers;
use crate::setting::words;
use crate::sim::{Remedies, Settings, Simulation, Stepper};
use crate::solver::SolverSettings;
use crate::world::{
    Boundary, Disc, Grain, Grains, Gravity, GravityTurn, Motion, Parameters, Periodic, Physics,
    TurningGravity, World,
};

/// A scene, built-in or from a TOML file with the same field names. Plain data, checked when a simulation is made
/// from it ([`Scene::validate`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Name of the scene.
    pub name: String,
    /// The diameter d, the unit of length for relative quantities, m.
    pub mean_diameter: f64,
    /// Areal density σ of the discs, kg/m².
    #[serde(default = "one")]
    pub areal_density: f64,
    /// Pairs touch below this gap, m: 0 except for rounding.
    #[serde(default)]
    pub gap_tolerance: f64,
    /// Simulated time of a run, s.
    pub duration_secs: f64,
    /// The physics to compute.
    pub physics: Physics,
    /// The field that accelerates the grains.
    pub gravity: Gravity,
    /// Rotation of gravity, if it turns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity_turn: Option<GravityTurn>,
    /// Periodic borders, if there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub periodic: Option<Periodic>,
    /// The stepper, with its contact law.
    #[serde(default)]
    pub stepper: Stepper,
    /// Parameters that may change during a run.
    pub parameters: Parameters,
    /// Solver settings of each step.
    #[serde(default)]
    pub solver: SolverSettings,
    /// Remedies for known failures.
    #[serde(default, skip_serializing_if = "Remedies::is_none")]
    pub remedies: Remedies,
    /// View of the pictures. Default: chosen from the grains' start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub view: Option<View>,
    /// Source of the grains, unless they are listed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<GrainSource>,
    /// Settings for recordings of its runs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub data: Option<DataSettings>,
    /// Fixed shapes.
    #[serde(default)]
    pub boundaries: Vec<Boundary>,
    /// Fixed discs.
    #[serde(default)]
    pub fixed_discs: Vec<Disc>,
    /// Motions of some of these shapes and discs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motions: Vec<Motion>,
    /// The moving discs.
    #[serde(default)]
    pub grains: Vec<Grain>,
}

/// A rectangle of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct View {
    /// Lower left corner, m.
    pub min: DVec2,
    /// Upper right corner, m.
    pub max: DVec2,
}

/// Source of a scene's grains.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "from", rename_all = "kebab-case", deny_unknown_fields)]
pub enum GrainSource {
    /// A CSV file of discs.
    Csv {
        /// Its path; in a scene file, relative to that file.
        path: std::path::PathBuf,
    },
    /// A recording, or a table of discs in any of its formats.
    Data {
        /// Its path; in a scene file, relative to that file.
        path: std::path::PathBuf,
        /// The step whose grains are taken. Default: the last.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        step: Option<u64>,
    },
    /// A new pile: grains put into a box over a rough base and left to come to rest.
    #[serde(alias = "rain")]
    NewPile(NewPile),
}

fn one() -> f64 {
    1.0
}

/// Largest distance of a disc from the origin, in its radii. Farther away, its place is rounded by more than a
/// ten-thousandth of its radius, and soon to the place of other discs.
const FARTHEST_IN_RADII: f64 = 1e15;

/// Upper limit for the mean diameter of the grains, in mean diameters of the scene. Larger values come from an error
/// of units, such as grains in millimetres. If the limit were smaller, a scene with grains of several sizes could not
/// choose one of the sizes as its unit of length.
const MOST_DIAMETERS_OF_MEAN: f64 = 100.0;

/// The name of the field is formatted only for an error, because a study checks each disc of each run.
fn positive(field: Arguments<'_>, value: f64, unit: &str) -> Result<()> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(Error::value(field.to_string(), value, format!("a finite number > 0{unit}")))
    }
}

fn within_reach(field: Arguments<'_>, place: DVec2, radius: f64) -> Result<()> {
    let farthest = FARTHEST_IN_RADII * radius;
    if place.abs().max_element() <= farthest {
        return Ok(());
    }
    let allowed = format!("within {farthest} m of the origin, {FARTHEST_IN_RADII} radii");
    Err(Error::value(field.to_string(), place, allowed))
}

impl Scene {
    /// A scene of grains only, with all physics, under the paper's law. Callers change the rest.
    pub(super) fn of(
        name: &str,
        mean_diameter: f64,
        gravity: Gravity,
        parameters: Parameters,
        grains: Vec<Grain>,
    ) -> Self {
        Self {
            name: name.into(),
            mean_diameter,
            areal_density: 1.0,
            gap_tolerance: 0.0,
            duration_secs: 1.0,
            physics: Physics::FULL,
            gravity,
            gravity_turn: None,
            periodic: None,
            stepper: Stepper::Moreau,
            parameters,
            solver: SolverSettings::default(),
            remedies: Remedies::default(),
            view: None,
            source: None,
            data: None,
            boundaries: Vec::new(),
            fixed_discs: Vec::new(),
            motions: Vec::new(),
            grains,
        }
    }

    /// Its stepper, parameters, solver and remedies.
    pub fn settings(&self) -> Settings {
        let Self { stepper, parameters, solver, remedies, .. } = *self;
        Settings { stepper, parameters, solver, remedies }
    }

    /// Replaces its stepper, parameters, solver and remedies.
    pub fn set_settings(&mut self, settings: Settings) {
        let Settings { stepper, parameters, solver, remedies } = settings;
        (self.stepper, self.parameters, self.solver, self.remedies) =
            (stepper, parameters, solver, remedies);
    }

    /// Checks everything except the shapes of the boundaries.
    ///
    /// # Errors
    /// Names the first field outside its range.
    pub fn validate(&self) -> Result<()> {
        self.physics.validate()?;
        self.settings().validate()?;
        positive(format_args!("areal_density"), self.areal_density, " kg/m²")?;
        positive(format_args!("duration"), self.duration_secs, " s")?;
        positive(format_args!("mean_diameter"), self.mean_diameter, " m")?;
        self.parameters.check_steps("duration", self.duration_secs)?;
        error::check(
            self.parameters.steps_in(self.duration_secs) > 0,
            "dt",
            format!(
                "{} s where duration is {} s",
                self.parameters.time_step_secs, self.duration_secs
            ),
            "such that the duration takes a step at least",
        )?;
        error::check(!self.grains.is_empty(), "grains", 0, "at least one disc")?;
        for (index, grain) in self.grains.iter().enumerate() {
            positive(format_args!("grains[{index}].radius"), grain.radius, " m")?;
            let finite = grain.position.is_finite()
                && grain.velocity.is_finite()
                && grain.angular_velocity.is_finite();
            if !finite {
                let found = format!("{grain:?}");
                return Err(Error::value(format!("grains[{index}]"), found, "finite throughout"));
            }
            within_reach(format_args!("grains[{index}].position"), grain.position, grain.radius)?;
        }
        let mean = 2.0 * self.grains.iter().map(|grain| grain.radius).sum::<f64>()
            / self.grains.len() as f64;
        // `reach_in` checks the other limit: the largest grain.
        let least = mean / MOST_DIAMETERS_OF_MEAN;
        if self.mean_diameter < least {
            let allowed =
                format!("at least {least} m, a hundredth of the mean diameter of the grains");
            return Err(Error::value("mean_diameter", self.mean_diameter, allowed));
        }
        for (index, disc) in self.fixed_discs.iter().enumerate() {
            positive(format_args!("fixed_discs[{index}].radius"), disc.radius, " m")?;
            if !disc.position.is_finite() {
                let field = format!("fixed_discs[{index}].position");
                return Err(Error::value(field, disc.position, "finite"));
            }
            within_reach(
                format_args!("fixed_discs[{index}].position"),
                disc.position,
                disc.radius,
            )?;
        }
        let magnitude = self.gravity.magnitude();
        if !(magnitude >= 0.0 && magnitude.is_finite()) {
            return Err(Error::value("gravity", magnitude, "a finite norm ≥ 0 m/s²"));
        }
        if let Gravity::Attraction { centre, .. } = self.gravity
            && !centre.is_finite()
        {
            return Err(Error::value("gravity.centre", centre, "finite"));
        }
        if let Some(turn) = &self.gravity_turn {
            turn.check(&self.gravity, self.physics)?;
        }
        if let Some(View { min, max }) = self.view
            && !(min.cmplt(max).all() && (max - min).is_finite())
        {
            let allowed = "finite, with min below and left of max";
            return Err(Error::value("view", format!("{min} to {max}"), allowed));
        }
        if let Some(data) = &self.data {
            data.validate("data.every_secs")?;
        }
        if self.physics.axes == 1 {
            self.validate_line()?;
        }
        let world = self.world();
        world.validate(self.physics)?;
        self.settings().check_in(&world, self.physics)
    }

    /// The initial world.
    fn world(&self) -> World {
        World {
            fixed_discs: self.fixed_discs.clone(),
            boundaries: self.boundaries.clone(),
            motions: self.motions.clone(),
            gravity_turn: TurningGravity::of(self.gravity, self.gravity_turn.as_ref()),
            periodic: self.periodic,
            ..World::of(
                Grains::new(&self.grains, self.areal_density),
                self.gravity,
                self.mean_diameter,
            )
        }
    }

    fn validate_line(&self) -> Result<()> {
        let allowed = "on the x axis where physics.axes is 1";
        let off_line = |grain: &Grain| grain.position.y != 0.0 || grain.velocity.y != 0.0;
        if let Some(index) = self.grains.iter().position(off_line) {
            let field = format!("grains[{index}]");
            return Err(Error::value(field, self.grains[index].position, allowed));
        }
        if let Some(index) = self.fixed_discs.iter().position(|disc| disc.position.y != 0.0) {
            let field = format!("fixed_discs[{index}]");
            return Err(Error::value(field, self.fixed_discs[index].position, allowed));
        }
        if let Some(index) = self.boundaries.iter().position(|shape| !shape.is_across_line()) {
            let field = format!("boundaries[{index}]");
            let allowed = "a half-space across the x axis where physics.axes is 1";
            return Err(Error::value(field, format!("{:?}", self.boundaries[index]), allowed));
        }
        Ok(())
    }

    /// The view of its pictures: its own, or the grains' start with a margin of the grains' height on either side.
    pub fn view(&self) -> View {
        if let Some(view) = self.view {
            return view;
        }
        let mut min = DVec2::INFINITY;
        let mut max = DVec2::NEG_INFINITY;
        for grain in &self.grains {
            min = min.min(grain.position - grain.radius);
            max = max.max(grain.position + grain.radius);
        }
        if let Some(periodic) = self.periodic {
            let room = 0.5 * self.mean_diameter * periodic.axes();
            let [min, max] = periodic.borders_or([min, max]);
            return self.with_fixed_discs_beside(View { min: min - room, max: max + room });
        }
        let room = DVec2::new(if self.physics.axes == 1 { 0.0 } else { max.y - min.y }, 0.0);
        self.with_fixed_discs_beside(View { min: min - room, max: max + room })
    }

    /// A view that also includes the fixed discs below or above the grains' range of x.
    fn with_fixed_discs_beside(&self, View { mut min, mut max }: View) -> View {
        for disc in &self.fixed_discs {
            if (min.x..max.x).contains(&disc.position.x) {
                min.y = min.y.min(disc.position.y - disc.radius);
                max.y = max.y.max(disc.position.y + disc.radius);
            }
        }
        View { min, max }
    }

    /// The same scene with these grains, in greys by layer.
    pub fn with_settled(mut self, grains: Vec<Grain>) -> Self {
        self.grains = grains;
        tone_in_layers(&mut self.grains, self.mean_diameter);
        self
    }

    /// Creates a simulation at t = 0.
    ///
    /// # Errors
    /// Names the first field outside its range.
    pub fn simulation(&self) -> Result<Simulation> {
        self.validate()?;
        Simulation::new(self.world(), self.physics, self.settings(), self.gap_tolerance)
    }
}

words! {
    /// File formats of recordings.
    pub enum FormatName {
        Parquet = "parquet", "Parquet, for pandas, polars and similar programs";
        Csv = "csv", "Text with commas";
        Vtk = "vtk", "VTK files, for ParaView";
        Ovito = "ovito", "LAMMPS dumps, for OVITO";
        Fields = "fields", "Density, velocity and stress on a grid, smoothed over a mean diameter, as images for \
            ParaView";
    }
}

/// Settings of a recording in scene files and studies.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DataSettings {
    /// Folder of the recording; in a scene file, relative to that file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub folder: Option<PathBuf>,
    /// Simulated time between two frames, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub every_secs: Option<f64>,
    /// File formats. If empty, the reader's default.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub formats: Vec<FormatName>,
}

impl DataSettings {
    /// Checks the time between frames; `field` is its name in messages.
    ///
    /// # Errors
    /// If it is outside its range.
    pub fn validate(&self, field: &str) -> Result<()> {
        match self.every_secs {
            Some(secs) if !(secs > 0.0 && secs.is_finite()) => {
                Err(Error::value(field, secs, "a finite number of seconds > 0"))
            }
            _ => Ok(()),
        }
    }
}
