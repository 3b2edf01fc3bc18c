//! The data of a scene, with the fields of a scene file, and the checks of these data.

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
    Boundary, Disc, Grain, Grains, Gravity, GravityTurn, Material, MaterialPair, Motion,
    Parameters, Periodic, Physics, TurningGravity, World, check_name,
};

/// A scene, built-in or from a TOML file with the same field names. The fields are public. They are checked when a
/// simulation is created ([`Scene::validate`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Name of the scene.
    pub name: String,
    /// Mean diameter d that the scene gives, m: the unit of length for settings in diameters.
    pub mean_diameter: f64,
    /// Areal density σ of the discs, kg/m².
    #[serde(default = "one")]
    pub areal_density: f64,
    /// Gap tolerance for rounding, m: grains touch if their gap is below it.
    #[serde(default)]
    pub gap_tolerance: f64,
    /// Simulated time of a run, s.
    pub duration_secs: f64,
    /// The effects that the mechanics includes: one or two axes, friction, rotation and cohesion.
    pub physics: Physics,
    /// Gravity: the acceleration field of the grains.
    pub gravity: Gravity,
    /// Rotation of the direction of gravity over time. `None` if gravity keeps its direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity_turn: Option<GravityTurn>,
    /// Periodic borders of the scene. `None` if it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub periodic: Option<Periodic>,
    /// The stepper, which advances the state by one time step with its contact law.
    #[serde(default)]
    pub stepper: Stepper,
    /// Parameters of the contact laws, and the time step. They may change during a run.
    pub parameters: Parameters,
    /// Settings of the solver, which computes the contact impulses of each step.
    #[serde(default)]
    pub solver: SolverSettings,
    /// Remedies: optional corrections of known errors of the stepper. None are applied by default.
    #[serde(default, skip_serializing_if = "Remedies::is_none")]
    pub remedies: Remedies,
    /// The rectangle that pictures show. If it is missing, it is computed from the initial positions of the grains.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub view: Option<View>,
    /// File from which the grains are read, or method by which they are generated. `None` if the scene lists its
    /// grains.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<GrainSource>,
    /// Settings for recordings of runs of this scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub data: Option<DataSettings>,
    /// Materials of which grains, fixed discs and boundaries consist.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<Material>,
    /// Contact laws of pairs of materials. A pair that is not listed has the coefficients in `parameters`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pairs: Vec<MaterialPair>,
    /// Walls and other shapes, other than discs, that are at rest or have a prescribed or force-driven motion.
    #[serde(default)]
    pub boundaries: Vec<Boundary>,
    /// Fixed discs: discs that are at rest or have a prescribed or force-driven motion.
    #[serde(default)]
    pub fixed_discs: Vec<Disc>,
    /// Prescribed or force-driven motions of boundaries and fixed discs. Bodies without a motion stay at rest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motions: Vec<Motion>,
    /// The grains: discs that move.
    #[serde(default)]
    pub grains: Vec<Grain>,
}

/// A rectangle in the plane of the scene, which pictures show.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct View {
    /// Lower left corner, m.
    pub min: DVec2,
    /// Upper right corner, m.
    pub max: DVec2,
}

/// File from which the grains of a scene are read, or method by which they are generated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "from", rename_all = "kebab-case", deny_unknown_fields)]
pub enum GrainSource {
    /// A CSV file with a list of discs.
    Csv {
        /// Path of the CSV file. In a scene file it is relative to the folder of the scene file.
        path: std::path::PathBuf,
    },
    /// A recording of a run, or a table of discs in one of the formats of recordings.
    Data {
        /// Path of the recording or the table. In a scene file it is relative to the folder of the scene file.
        path: std::path::PathBuf,
        /// Number of the recorded step from which the grains are taken. Default: the last step.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        step: Option<u64>,
    },
    /// A new pile: grains that are put into a box over a rough base and left to come to rest.
    #[serde(alias = "rain")]
    NewPile(NewPile),
}

fn one() -> f64 {
    1.0
}

/// Largest allowed distance of a disc from the origin along either axis, in radii of the disc. At this distance,
/// rounding moves the disc by up to about a tenth of its radius. At ten times this distance it would move the disc by
/// about its radius, and so onto other discs.
const FARTHEST_IN_RADII: f64 = 1e15;

/// Largest allowed ratio of the mean diameter of the listed grains to the mean diameter d that the scene gives. A
/// larger ratio comes from an error of units, such as grains in millimetres. If the limit were smaller, a scene with
/// grains of several sizes could not choose one of these sizes as its unit of length.
const MOST_DIAMETERS_OF_MEAN: f64 = 100.0;

/// Checks that a value is finite and above 0. `field` names the value in the error message. The name is formatted only
/// if there is an error. This saves time, because a study (a list of runs) checks each disc of each run.
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
    /// Returns a scene that contains only grains, with the effects of full mechanics (two axes, friction, rotation,
    /// cohesion), the stepper `moreau` and the default solver. Callers change the other fields.
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
            materials: Vec::new(),
            pairs: Vec::new(),
            boundaries: Vec::new(),
            fixed_discs: Vec::new(),
            motions: Vec::new(),
            grains,
        }
    }

    /// Returns the settings of the scene: its stepper, parameters, solver settings and remedies (optional corrections
    /// of a step, such as pushing overlapping grains apart).
    pub fn settings(&self) -> Settings {
        let Self { stepper, parameters, solver, remedies, .. } = *self;
        Settings { stepper, parameters, solver, remedies }
    }

    /// Replaces the settings of the scene: its stepper, parameters, solver settings and remedies (optional corrections
    /// of a step, such as pushing overlapping grains apart).
    pub fn set_settings(&mut self, settings: Settings) {
        let Settings { stepper, parameters, solver, remedies } = settings;
        (self.stepper, self.parameters, self.solver, self.remedies) =
            (stepper, parameters, solver, remedies);
    }

    /// Checks all data of the scene except the shapes of the boundaries.
    ///
    /// # Errors
    /// If a field is outside its range. The error names the first such field.
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
            if let Some(mass) = grain.mass {
                positive(format_args!("grains[{index}].mass"), mass, " kg")?;
            }
            if let Some(name) = &grain.material {
                check_name(|| format!("grains[{index}].material"), name, &self.materials)?;
            }
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
        // Lower limit of `mean_diameter`. The upper limit depends on the largest grain; `reach_in` checks it.
        let least = mean / MOST_DIAMETERS_OF_MEAN;
        let is_large = self.mean_diameter >= least;
        let allowed = format!("at least {least} m, a hundredth of the mean diameter of the grains");
        error::check(is_large, "mean_diameter", self.mean_diameter, allowed)?;
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
        let is_norm = magnitude >= 0.0 && magnitude.is_finite();
        error::check(is_norm, "gravity", magnitude, "a finite norm ≥ 0 m/s²")?;
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

    /// Returns the world at time 0, from which a simulation starts: the bodies of the scene, their motions and
    /// materials, gravity and the periodic borders.
    fn world(&self) -> World {
        World {
            fixed_discs: self.fixed_discs.clone(),
            boundaries: self.boundaries.clone(),
            motions: self.motions.clone(),
            gravity_turn: TurningGravity::of(self.gravity, self.gravity_turn.as_ref()),
            periodic: self.periodic,
            materials: self.materials.clone(),
            pairs: self.pairs.clone(),
            ..World::of(
                Grains::of_materials(&self.grains, self.areal_density, &self.materials),
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

    /// Returns the rectangle that pictures show: the `view` of the scene or, if that is missing, a rectangle around the
    /// initial grains. Without periodic borders this is the bounding box of the grains, with margins to the left and
    /// right as wide as the box is high (no margins in scenes on a line). Along an axis with periodic borders it is the
    /// periodic cell with margins of half a mean diameter. The rectangle is extended to the fixed discs above and below
    /// it.
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

    /// Extends a view downwards and upwards so that it contains the fixed discs below and above it.
    fn with_fixed_discs_beside(&self, View { mut min, mut max }: View) -> View {
        for disc in &self.fixed_discs {
            if (min.x..max.x).contains(&disc.position.x) {
                min.y = min.y.min(disc.position.y - disc.radius);
                max.y = max.y.max(disc.position.y + disc.radius);
            }
        }
        View { min, max }
    }

    /// Removes the mass that a grain lists, if this mass equals, bit by bit, the mass that follows from the material
    /// and the radius of the grain.
    pub fn without_implied_masses(mut self) -> Self {
        for grain in &mut self.grains {
            let given = grain.mass.take();
            let (_, implied) = grain.material_and_mass(self.areal_density, &self.materials);
            grain.mass = given.filter(|&mass| mass != implied);
        }
        self
    }

    /// Returns this scene with `grains` in place of its grains. The grey levels of the new grains show the layers in
    /// which they start.
    pub fn with_settled(mut self, grains: Vec<Grain>) -> Self {
        self.grains = grains;
        tone_in_layers(&mut self.grains, self.mean_diameter);
        self
    }

    /// Creates a simulation of the scene at time 0.
    ///
    /// # Errors
    /// If a field is outside its range. The error names the first such field.
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

/// Settings of the recording of a run, in scene files and studies (lists of runs).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DataSettings {
    /// Folder to which the recording is written. In a scene file it is relative to the folder of the scene file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub folder: Option<PathBuf>,
    /// Simulated time between two frames of the recording, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub every_secs: Option<f64>,
    /// File formats of the recording. If the list is empty, the program that reads these settings uses its default.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub formats: Vec<FormatName>,
}

impl DataSettings {
    /// Checks the time between two frames of a recording. `field` is the name of this setting in error messages.
    ///
    /// # Errors
    /// If the time is outside its range.
    pub fn validate(&self, field: &str) -> Result<()> {
        match self.every_secs {
            Some(secs) if !(secs > 0.0 && secs.is_finite()) => {
                Err(Error::value(field, secs, "a finite number of seconds > 0"))
            }
            _ => Ok(()),
        }
    }
}
