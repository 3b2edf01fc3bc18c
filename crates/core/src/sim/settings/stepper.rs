//! Registry of the steppers. Each stepper has a name in [`Stepper`] and a description [`StepperInfo`]; its code is in
//! `sim::steppers`.

use crate::error::{Error, Result, check};
use crate::setting::words;
use crate::sim::settings::fracture_work::{FractureWork, fracture_work_of};
use crate::sim::settings::spring_dashpot::{
    SpringDashpot, check_substeps, contact_time_secs, critical_time_step_secs, substeps,
};
use crate::world::{FrictionCone, Parameters, Physics, World};

words! {
    /// Stepper: the rule that advances the grains by one time step Δt, with its contact law.
    #[derive(Default)]
    pub enum Stepper {
        #[default]
        Moreau = "moreau", "the law of the paper: a contact and its bond end when the grains separate";
        Range = "range", "a bond breaks when it has been opened by δc, at any Δt";
        TgsSoft = "tgs-soft",
            "substeps with soft contacts and a relaxing sweep, as in game engines";
        Avbd = "avbd", "augmented vertex block descent: penalties that stiffen, body by body, as in recent game \
            engines";
        Dem = "dem", "smooth discrete elements: springs, dashpots and a constant attraction";
    }
}

/// Description of a stepper: its source, its settings and its abilities.
#[derive(Clone, Copy, Debug)]
pub struct StepperInfo {
    /// Description of the problem that the stepper solves in each step: one line.
    pub solves: &'static str,
    /// Publication that describes the stepper.
    pub source: &'static str,
    /// Names of the settings that the stepper reads, separated by spaces. If `solver` is among them, a solver solves
    /// the contact problem of each step.
    pub settings: &'static str,
    /// Names of the observables that the stepper has in addition to the observables of all steppers.
    pub observables: &'static [&'static str],
    /// True if the stepper can move walls driven by a force.
    pub takes_drives: bool,
    /// True if the stepper supports separate contact laws for pairs of materials.
    pub takes_pairs: bool,
    /// Checks the parameters; the error names a parameter that the stepper does not support.
    pub check: fn(&Parameters) -> Result<()>,
    /// Checks the parameters for a world; the error names a parameter that the stepper does not support in that world.
    pub check_in: fn(&World, Physics, &Parameters) -> Result<()>,
    /// Returns the number of substeps (equal parts) per step; 1 if the stepper solves a step as a whole.
    pub substeps: fn(&World, Physics, &Parameters) -> u32,
    /// Returns the longest substep (part of a step), s, for which the stepper is always stable; `None` if the stepper
    /// has no such limit.
    pub critical_time_step_secs: fn(&World, Physics, &Parameters) -> Option<f64>,
    /// Returns the duration of a collision of two grains of the mean mass, s; `None` if the contact law does not define
    /// it.
    pub contact_time_secs: fn(&World, Physics, &Parameters) -> Option<f64>,
    /// Returns the work needed to pull a bonded pair apart slowly; `None` if the contact law does not define it, or
    /// without cohesion.
    pub fracture_work: fn(&World, Physics, &Parameters) -> Option<FractureWork>,
}

impl StepperInfo {
    /// Default description of a stepper: it solves the contact problem of a step as a whole, and has no limits and no
    /// additional observables.
    const WHOLE: Self = Self {
        solves: "",
        source: "",
        settings: "",
        observables: &[],
        takes_drives: false,
        takes_pairs: false,
        check: |_| Ok(()),
        check_in: |_, _, _| Ok(()),
        substeps: |_, _, _| 1,
        critical_time_step_secs: |_, _, _| None,
        contact_time_secs: |_, _, _| None,
        fracture_work: |_, _, _| None,
    };
}

impl Stepper {
    /// Returns the description of this stepper.
    pub const fn info(self) -> &'static StepperInfo {
        match self {
            Self::Moreau => &MOREAU,
            Self::Range => &RANGE,
            Self::TgsSoft => &TGS_SOFT,
            Self::Avbd => &AVBD,
            Self::Dem => &DEM,
        }
    }

    /// True if this stepper reads the setting `name`.
    pub fn reads(self, name: &str) -> bool {
        self.info().settings.split(' ').any(|setting| setting == name)
    }

    /// True if this stepper uses a solver for the contact problem of a step.
    pub fn uses_method(self) -> bool {
        self.reads("solver")
    }

    /// True if this stepper measures the energies of bonds, such as the observable `bond_energy`.
    pub(in crate::sim) fn has_bonds(self) -> bool {
        self.info().observables.contains(&"bond_energy")
    }
}

/// Checks that the coefficient of rolling friction is 0, for steppers that do not compute rolling friction.
fn without_rolling(parameters: &Parameters) -> Result<()> {
    let found = parameters.rolling_friction;
    check(found == 0.0, "rolling-friction", found, "0 where stepper is not moreau")
}

const MOREAU: StepperInfo = StepperInfo {
    solves: "each step's problem under Signorini's law with cohesion and Coulomb's law",
    source: "A. Abramian, L. Staron, Time Steps v.s. Cohesion (2020); J. J. Moreau (1988)",
    settings: "bond bond-acceleration dt tilt rho mu cone rolling-friction restitution-threshold touch-tolerance \
        solver ordering stop tolerance max-sweeps warm-start friction-model model-solves",
    takes_drives: true,
    takes_pairs: true,
    ..StepperInfo::WHOLE
};

const RANGE: StepperInfo = StepperInfo {
    solves: "each step's problem under Signorini's law with bonds of finite range and Coulomb's law",
    source: "bonds that cost the work C₀δc; shocks apart from loads",
    settings: "bond bond-acceleration dt tilt rho mu cone restitution-threshold debonding-distance solver \
        ordering stop tolerance max-sweeps warm-start friction-model model-solves",
    observables: &["bond_work", "bond_energy", "broken_bond_energy"],
    // The compressive cone (only the pushing part of the normal force bounds friction) is refused: the sweep would need
    // one capture speed (C₀·Δt/m_ij, m/s), but here contacts have different capture speeds.
    check: |parameters| match parameters.cone {
        FrictionCone::Shifted => without_rolling(parameters),
        cone => Err(Error::value("cone", cone, "shifted where stepper is range")),
    },
    takes_drives: true,
    fracture_work: |world, physics, parameters| {
        let distance = parameters.debonding_distance * world.mean_diameter;
        fracture_work_of(world, physics, parameters, |force| force * distance)
    },
    ..StepperInfo::WHOLE
};

const TGS_SOFT: StepperInfo = StepperInfo {
    solves: "nothing exactly: contacts are damped springs",
    source: "E. Catto, Solver2D (2024)",
    settings: "bond bond-acceleration dt tilt rho mu cone restitution-threshold warm-start substeps",
    takes_drives: true,
    check: without_rolling,
    // More than these 4 substeps give stiffer and more accurate contacts, and cost more.
    substeps: |_, _, parameters| match parameters.substeps {
        0 => 4,
        asked => asked,
    },
    ..StepperInfo::WHOLE
};

const AVBD: StepperInfo = StepperInfo {
    solves: "the step's problem by penalties and multipliers, as far as its iterations get",
    source: "C. Giles, E. Diaz and C. Yuksel (2025)",
    settings: "bond bond-acceleration dt tilt mu cone warm-start substeps",
    check: without_rolling,
    substeps: |_, _, parameters| parameters.substeps.max(1),
    ..StepperInfo::WHOLE
};

/// Description of the stepper `dem`. `warm-start` is not among its settings, because the springs of `dem` always keep
/// their stretch from one step to the next.
const DEM: StepperInfo = StepperInfo {
    solves: "nothing exactly: contacts are damped springs",
    source: "P. A. Cundall, O. D. L. Strack (1979); S. Luding, Cohesive, frictional powders (2008)",
    settings: "bond bond-acceleration dt tilt rho mu cone stiffness damping-ratio substeps",
    takes_drives: true,
    check: without_rolling,
    check_in: check_substeps,
    substeps,
    critical_time_step_secs: |world, physics, parameters| {
        Some(critical_time_step_secs(world, physics, parameters))
    },
    contact_time_secs: |world, physics, parameters| {
        Some(contact_time_secs(world, physics, parameters))
    },
    fracture_work: |world, physics, parameters| {
        let springs = SpringDashpot::of(world, physics.axes, parameters);
        fracture_work_of(world, physics, parameters, |force| springs.fracture_work(force))
    },
    ..StepperInfo::WHOLE
};
