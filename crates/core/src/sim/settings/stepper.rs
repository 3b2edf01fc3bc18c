//! The registry of steppers: for each one a word of [`Stepper`] and its [`StepperInfo`]. `sim::steppers` has the code.

use crate::error::{Error, Result};
use crate::setting::words;
use crate::sim::settings::fracture_work::{FractureWork, fracture_work_of};
use crate::sim::settings::spring_dashpot::{
    SpringDashpot, check_substeps, contact_time_secs, critical_time_step_secs, substeps,
};
use crate::world::{FrictionCone, Parameters, Physics, World};

words! {
    /// A way to take a step of Δt, with its contact law.
    #[derive(Default)]
    pub enum Stepper {
        #[default]
        Moreau = "moreau", "the law of the paper: a contact and its bond end when the grains separate";
        Range = "range", "a bond breaks when it has been opened by δc, at any Δt";
        TgsSoft = "tgs-soft",
            "substeps with soft contacts and a relaxing sweep, as in game engines";
        Avbd = "avbd", "augmented vertex block descent: penalties that stiffen, body by body, as in recent game engines";
        Dem = "dem", "smooth discrete elements: springs, dashpots and a constant attraction";
    }
}

/// What there is to know of a way to step, beside its name and its line.
#[derive(Clone, Copy, Debug)]
pub struct StepperInfo {
    /// What a step of it solves, one line.
    pub solves: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// The settings that it reads, by name, with spaces between. With `solver` among them it solves the step's problem
    /// by a method.
    pub settings: &'static str,
    /// Observables that it has beside those that all have.
    pub observables: &'static [&'static str],
    /// True where it moves walls that a force drives.
    pub takes_drives: bool,
    /// Refuses numbers that do not go with it.
    pub check: fn(&Parameters) -> Result<()>,
    /// Refuses numbers that do not go with it in a world.
    pub check_in: fn(&World, Physics, &Parameters) -> Result<()>,
    /// Substeps of a step; 1 where its problem is solved as a whole.
    pub substeps: fn(&World, Physics, &Parameters) -> u32,
    /// The longest substep, s, that is stable whatever the grains do; none where that is no question.
    pub critical_time_step_secs: fn(&World, Physics, &Parameters) -> Option<f64>,
    /// How long two grains of the mean mass that meet push each other, s; none where that is no time.
    pub contact_time_secs: fn(&World, Physics, &Parameters) -> Option<f64>,
    /// What it takes to break a bond slowly; none where the law does not say, or the physics has no cohesion.
    pub fracture_work: fn(&World, Physics, &Parameters) -> Option<FractureWork>,
}

impl StepperInfo {
    /// One that solves the problem of the step as a whole.
    const WHOLE: Self = Self {
        solves: "",
        source: "",
        settings: "",
        observables: &[],
        takes_drives: false,
        check: |_| Ok(()),
        check_in: |_, _, _| Ok(()),
        substeps: |_, _, _| 1,
        critical_time_step_secs: |_, _, _| None,
        contact_time_secs: |_, _, _| None,
        fracture_work: |_, _, _| None,
    };
}

impl Stepper {
    /// What there is to know of it.
    pub const fn info(self) -> &'static StepperInfo {
        match self {
            Self::Moreau => &MOREAU,
            Self::Range => &RANGE,
            Self::TgsSoft => &TGS_SOFT,
            Self::Avbd => &AVBD,
            Self::Dem => &DEM,
        }
    }

    /// True where it reads the setting of that name.
    pub fn reads(self, name: &str) -> bool {
        self.info().settings.split(' ').any(|setting| setting == name)
    }

    /// True where it solves the step's problem by one of the methods.
    pub fn uses_method(self) -> bool {
        self.reads("solver")
    }

    /// True where it tells of bonds.
    pub(in crate::sim) fn has_bonds(self) -> bool {
        self.info().observables.contains(&"bond_energy")
    }
}

const MOREAU: StepperInfo = StepperInfo {
    solves: "each step's problem under Signorini's law with cohesion and Coulomb's law",
    source: "A. Abramian, L. Staron, Time Steps v.s. Cohesion (2020); J. J. Moreau (1988)",
    settings: "bond bond-acceleration dt tilt rho mu cone restitution-threshold touch-tolerance solver ordering \
        stop tolerance max-sweeps warm-start friction-model model-solves",
    takes_drives: true,
    ..StepperInfo::WHOLE
};

const RANGE: StepperInfo = StepperInfo {
    solves: "each step's problem under Signorini's law with bonds of finite range and Coulomb's law",
    source: "bonds that cost the work C₀δc; shocks apart from loads",
    settings: "bond bond-acceleration dt tilt rho mu cone restitution-threshold debonding-distance solver \
        ordering stop tolerance max-sweeps warm-start friction-model model-solves",
    observables: &["bond_work", "bond_energy", "broken_bond_energy"],
    // In the compressive cone the sweep needs the capture speed, which differs between contacts.
    check: |parameters| match parameters.cone {
        FrictionCone::Shifted => Ok(()),
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
    // More substeps give stiffer contacts that are better solved, and cost more.
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
    substeps: |_, _, parameters| parameters.substeps.max(1),
    ..StepperInfo::WHOLE
};

/// `warm-start` is not among its settings: springs keep their stretch in any case.
const DEM: StepperInfo = StepperInfo {
    solves: "nothing exactly: contacts are damped springs",
    source: "P. A. Cundall, O. D. L. Strack (1979); S. Luding, Cohesive, frictional powders (2008)",
    settings: "bond bond-acceleration dt tilt rho mu cone stiffness damping-ratio substeps",
    takes_drives: true,
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
