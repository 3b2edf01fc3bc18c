//! The parameters of the contact laws, and the time step. All of them may change between any two steps.

use crate::error::{Error, Result};
use crate::number::is_zero;
use crate::setting::{settings, words};

words! {
    /// The bound of the friction force T: the friction coefficient μ times either the sum N + C₀ of the normal force N
    /// and the cohesion force C₀, or only the normal force N, if it pushes. The text of Abramian & Staron (2020) allows
    /// both readings.
    #[derive(Default)]
    pub enum FrictionCone {
        #[default]
        Shifted = "shifted", "|T| ≤ μ (N + C₀): the cone's apex is at −C₀";
        Compressive = "compressive", "|T| ≤ μ max(N, 0)";
    }
}

/// Default of the debonding distance δ_c (opening at which a bond of the law `range` breaks), in mean diameters. With a
/// larger distance, a bond takes more work to break: C₀·δ_c with the cohesion force C₀ (N) and δ_c in m.
pub const DEBONDING_DISTANCE: f64 = 0.01;

/// Default of [`Parameters::restitution_threshold`], in units of g·Δt (gravity times time step). With 0, the value of
/// Abramian & Staron (2020), four times as many steps of a cohesive pile are unsolved (`assets/reports/threshold.json`).
pub const RESTITUTION_THRESHOLD: f64 = 2.0;

/// Default of the touch tolerance (largest gap at which grains touch), in mean diameters. With a smaller tolerance,
/// rounding would separate discs that a scene file places in contact, and a pyramid of logs in equilibrium would
/// collapse.
const TOUCH_TOLERANCE: f64 = 1e-5;

/// Largest allowed number of substeps (equal parts) per step. With a larger number, a single step of a pile would take
/// many seconds of computing time.
pub(crate) const MAX_SUBSTEPS: u32 = 100_000;

/// Largest allowed number of steps of a run. Even in the smallest scene more steps would take months of computing
/// time.
const MOST_STEPS: f64 = 1e12;
/// Smallest usual time step, s. If a run with a smaller time step has too many steps, the error message names the time
/// step as the cause.
const SMALL_TIME_STEP_SECS: f64 = 1e-7;

settings! {
    /// Parameters of the contact laws, and the time step. They may change between any two steps. The fields are
    /// public, and a simulation checks them when it takes them over.
    ///
    /// The default is the scheme of Abramian & Staron (2020) at a time step of 1e-3 s, without cohesion, restitution or
    /// friction.
    pub struct Parameters, changes ParameterChanges, heading "Physics" {
        /// The cohesion force is C₀ = Bond · m_ij · a (Abramian & Staron 2020, eq. 10), with the effective mass m_ij
        /// and the acceleration a of [`Parameters::cohesion_acceleration`].
        bond: f64 = 0.0, "bond" ("BOND"), "Bond number: cohesion force divided by the effective weight of a \
            contact, at least 0; pairs of materials may have their own", {
            allowed: "a finite number ≥ 0",
            holds: |value| value >= 0.0 && value.is_finite(),
            control: Some(Control {
                label: "Bond, cohesion",
                symbol: "Bond",
                hint: "Cohesion: a contact pulls with up to so many times the weight of its effective mass \
                       m_i·m_j/(m_i + m_j), which for two equal discs is half a disc's, and on a base a whole one's.",
                range: [0.0, 200.0],
                most: 1e6,
                ..Control::PLAIN
            }),
        }
        #[serde(default, skip_serializing_if = "is_zero")]
        bond_acceleration: f64 = 0.0, "bond-acceleration" ("A"),
            "Acceleration a in the cohesion force Bond·m·a, m/s²; 0 uses the gravity of the scene", {
            allowed: "a finite number of m/s² ≥ 0; 0 takes the scene's gravity",
            holds: |value| value >= 0.0 && value.is_finite(),
            needs: Needs::Cohesion,
        }
        /// Time step Δt, s.
        time_step_secs: f64 = 1e-3, "dt" ("SECONDS"), "Time step Δt, seconds", {
            allowed: "a finite number of seconds > 0",
            holds: |value| value > 0.0 && value.is_finite(),
            control: Some(Control {
                label: "Δt, time step",
                symbol: "Δt",
                unit: "s",
                hint: "One step of the computation; cohesion cancels the opening speed Bond·g·Δt \
                       in each.",
                range: [1e-5, 1e-2],
                most: 1.0,
                logarithmic: true,
            }),
        }
        /// Coefficient of restitution ρ, from 0 to 1: speed after a bounce divided by the speed before.
        restitution: f64 = 0.0, "rho" ("RHO"), "Restitution, 0 to 1; pairs of materials may have \
            their own", {
            allowed: "between 0 and 1",
            holds: |value| (0.0..=1.0).contains(&value),
            control: Some(Control {
                label: "ρ, restitution",
                symbol: "ρ",
                hint: "Fraction of the approach speed with which grains bounce apart.",
                ..Control::PLAIN
            }),
        }
        /// Friction coefficient μ.
        friction: f64 = 0.0, "mu" ("MU"), "Friction, at least 0; pairs of materials may have \
            their own", {
            allowed: "a finite number ≥ 0",
            holds: |value| value >= 0.0 && value.is_finite(),
            needs: Needs::Friction,
            control: Some(Control {
                label: "μ, friction",
                symbol: "μ",
                hint: "Largest tangential force, in units of the normal force plus cohesion.",
                range: [0.0, 2.0],
                most: 1e6,
                ..Control::PLAIN
            }),
        }
        #[serde(default)]
        cone: FrictionCone = FrictionCone::Shifted, "cone" ("CONE"),
            "Part of the normal force that bounds friction", {
            needs: Needs::Friction,
        }
        /// A contact transmits a moment M (N·m) against rolling, with |M| ≤ μ_r R F. μ_r is the coefficient of rolling
        /// friction, R (m) the reduced radius of the two bodies, from 1/R = 1/r_i + 1/r_j with their radii r_i and r_j,
        /// and F (N) the part of the normal force that bounds friction.
        #[serde(default, skip_serializing_if = "is_zero")]
        rolling_friction: f64 = 0.0, "rolling-friction" ("MU_R"),
            "Rolling friction of moreau, at least 0: the largest moment against rolling, divided by the reduced radius \
                and by the force that bounds friction", {
            allowed: "a finite number ≥ 0",
            holds: |value| value >= 0.0 && value.is_finite(),
            needs: Needs::Rotation,
            control: Some(Control {
                label: "μr, rolling friction",
                symbol: "μr",
                hint: "Largest moment against rolling, in units of the reduced radius times the force that bounds \
                    friction.",
                range: [0.0, 1.0],
                most: 1e6,
                ..Control::PLAIN
            }),
        }
        /// Restitution threshold, in units of g·Δt (gravity times time step): contacts do not bounce if their closing
        /// speed |v_n| at the beginning of the step is below it. 0 in the scheme of Abramian & Staron (2020).
        ///
        /// The restitution term ρ v_n of a contact that is wedged between others can contradict the terms of its
        /// neighbours, and then the step has no solution. Bounces slower than about 2 g·Δt are too small to be seen.
        #[serde(default = "default_restitution_threshold")]
        restitution_threshold: f64 = RESTITUTION_THRESHOLD, "restitution-threshold" ("X"),
            "Contacts that close slower than this many g·dt do not bounce; the paper has 0, where more steps have \
                no solution", {
            allowed: "a finite number ≥ 0",
            holds: |value| value >= 0.0 && value.is_finite(),
        }
        /// Debonding distance δ_c of the law `range`: the opening at which a bond breaks, in mean diameters. The
        /// upper limit is so small that a third grain does not fit between two bonded grains.
        #[serde(default = "default_debonding_distance")]
        debonding_distance: f64 = DEBONDING_DISTANCE, "debonding-distance" ("D"),
            "Distance by which a bond of the stepper range opens before it breaks, in mean diameters", {
            allowed: "above 0 and at most 0.1 diameters",
            holds: |value| value > 0.0 && value <= 0.1,
            needs: Needs::Cohesion,
            control: Some(Control {
                label: "δc, debonding distance",
                symbol: "δc",
                unit: "d",
                hint: "Distance by which a bond opens before it breaks, in mean diameters.",
                range: [1e-3, 0.1],
                logarithmic: true,
                ..Control::PLAIN
            }),
        }
        /// Touch tolerance: the largest gap at which grains touch, in mean diameters. The upper limit is so small
        /// that a third grain does not fit between two bonded grains.
        #[serde(default = "default_touch_tolerance")]
        touch_tolerance: f64 = TOUCH_TOLERANCE, "touch-tolerance" ("D"),
            "Largest gap at which grains touch, and cohere if they have cohesion, in mean diameters; they push each \
                other only at gap 0; the paper has 0", {
            allowed: "between 0 and 0.1 diameters",
            holds: |value| (0.0..=0.1).contains(&value),
            control: Some(Control {
                label: "Touch tolerance",
                symbol: "τ",
                unit: "d",
                hint: "Largest gap at which grains touch, and cohere if they have cohesion, in mean diameters.",
                range: [0.0, 0.1],
                logarithmic: true,
                ..Control::PLAIN
            }),
        }
        #[serde(default, skip_serializing_if = "is_zero")]
        tilt: f64 = 0.0, "tilt" ("DEGREES"),
            "Angle by which the gravity of the scene is turned, degrees; a positive angle turns downward gravity to \
                the right", {
            allowed: "between -180 and 180 degrees",
            holds: |value| (-180.0..=180.0).contains(&value),
            needs: Needs::Direction,
            control: Some(Control {
                label: "Tilt",
                symbol: "tilt",
                unit: "°",
                hint: "Turns gravity; a positive angle acts like tilting the ground to the right.",
                range: [-45.0, 45.0],
                ..Control::PLAIN
            }),
        }
        #[serde(default, skip_serializing_if = "is_zero")]
        stiffness: f64 = 0.0, "stiffness" ("K"),
            "Stiffness of the springs of the stepper dem, N/m; 0 derives it from the weight of the pile", {
            allowed: "a finite number of N/m ≥ 0; 0 takes it from the pile's weight",
            holds: |value| value >= 0.0 && value.is_finite(),
            control: Some(Control {
                label: "k, stiffness",
                symbol: "k",
                unit: "N/m",
                hint: "Force per overlap; a softer bond takes more work to break. At 0 the stiffness is chosen so \
                    that the weight of the pile makes an overlap of 1e-3 d.",
                range: [0.0, 1e5],
                logarithmic: true,
                ..Control::PLAIN
            }),
        }
        /// Damping ratio ζ of a single contact of the stepper `dem`, relative to critical damping. 0 means the ratio
        /// that follows from the restitution ρ. For a contact without damping, set ρ to 1.
        #[serde(default, skip_serializing_if = "is_zero")]
        damping_ratio: f64 = 0.0, "damping-ratio" ("ZETA"),
            "Damping ratio of the contacts of the stepper dem; 0 derives it from rho", {
            allowed: "a finite number ≥ 0; 0 takes it from the restitution",
            holds: |value| value >= 0.0 && value.is_finite(),
            control: Some(Control {
                label: "ζ, damping ratio",
                symbol: "ζ",
                hint: "Damping of a single contact divided by critical damping. 0 derives it from ρ.",
                range: [0.0, 2.0],
                ..Control::PLAIN
            }),
        }
        #[serde(default, skip_serializing_if = "is_zero")]
        substeps: u32 = 0, "substeps",
            "Substeps per step; 0 means 4 for tgs-soft, 1 for avbd, and for dem the number that keeps it stable", {
            allowed: "at most 100000; 0 leaves it to the stepper",
            holds: |value| value <= MAX_SUBSTEPS,
            control: Some(Control {
                label: "Substeps",
                symbol: "substeps",
                hint: "Substeps per step; 0 means 4 for tgs-soft, 1 for avbd, and for dem the number that keeps it \
                    stable.",
                range: [0.0, 100.0],
                ..Control::PLAIN
            }),
        }
    }
}

fn default_touch_tolerance() -> f64 {
    TOUCH_TOLERANCE
}

fn default_restitution_threshold() -> f64 {
    RESTITUTION_THRESHOLD
}

fn default_debonding_distance() -> f64 {
    DEBONDING_DISTANCE
}

impl Parameters {
    /// Returns a copy of these parameters with another time step, s.
    pub fn over(self, time_step_secs: f64) -> Self {
        Self { time_step_secs, ..self }
    }

    /// Returns the number of steps into which a simulated time (s) is divided.
    pub fn steps_in(&self, secs: f64) -> u64 {
        (secs / self.time_step_secs).round() as u64
    }

    /// Checks that a simulated time (s) does not need more steps than a run may have.
    ///
    /// # Errors
    /// If it needs too many steps. The error names `field`, the option that sets the simulated time, or the time step
    /// if that is unusually small.
    pub fn check_steps(&self, field: &str, secs: f64) -> Result<()> {
        let steps = secs / self.time_step_secs;
        if steps <= MOST_STEPS {
            return Ok(());
        }
        let (least, most) = (secs / MOST_STEPS, MOST_STEPS * self.time_step_secs);
        let asked = format!("which asks for {steps:.1e} steps");
        Err(if self.time_step_secs < SMALL_TIME_STEP_SECS {
            let found = format!("{} s where {field} is {secs} s, {asked}", self.time_step_secs);
            Error::value("dt", found, format!("at least {least:e} s: no more than 1e12 steps"))
        } else {
            let found = format!("{secs} s where dt is {} s, {asked}", self.time_step_secs);
            Error::value(field, found, format!("at most {most:e} s: no more than 1e12 steps"))
        })
    }

    /// Returns the restitution term ρ v_n of a contact, m/s, from its normal velocity v_n (m/s) at the beginning of
    /// the step. 0 if the contact closes so slowly that it does not bounce.
    pub fn restitution_velocity(&self, normal_velocity: f64, gravity_magnitude: f64) -> f64 {
        let least = self.restitution_threshold * gravity_magnitude * self.time_step_secs;
        if normal_velocity.abs() < least { 0.0 } else { self.restitution * normal_velocity }
    }

    /// Returns the acceleration a in the cohesion force C₀ = Bond · m_ij · a, m/s²: the parameter `bond_acceleration`
    /// if it is given, otherwise the gravity of the scene.
    pub fn cohesion_acceleration(&self, gravity_magnitude: f64) -> f64 {
        match self.bond_acceleration {
            0.0 => gravity_magnitude,
            given => given,
        }
    }

    /// Returns the acceleration a, m/s², that sets the scale of speeds, √(a·d) for the mean diameter d: the gravity of
    /// the scene, or `bond_acceleration` in a scene without gravity.
    pub fn accelerating(&self, gravity_magnitude: f64) -> f64 {
        match gravity_magnitude {
            0.0 => self.bond_acceleration,
            gravity => gravity,
        }
    }

    /// Returns the dimensionless cohesive time Bond·a·Δt/√(g·d), with the acceleration a of cohesion, the time step Δt,
    /// gravity g and the mean diameter d. If a is g, it equals Bond·Δt/√(d/g) (Abramian & Staron 2020, §3.3). Without
    /// gravity, a replaces g.
    pub fn cohesive_time(&self, mean_diameter: f64, gravity_magnitude: f64) -> f64 {
        let g = self.accelerating(gravity_magnitude);
        let ratio = match self.bond_acceleration {
            0.0 => 1.0,
            given => given / g,
        };
        ratio * self.bond * self.time_step_secs / (mean_diameter / g).sqrt()
    }

    /// Returns the capture speed Bond·a·Δt, m/s: the opening speed that one step of cohesion cancels (Abramian & Staron
    /// 2020, eq. 9; a: gravity of the scene, or the parameter `bond_acceleration` if it is given; Δt: time step).
    pub fn capture_speed(&self, gravity_magnitude: f64) -> f64 {
        self.bond * self.cohesion_acceleration(gravity_magnitude) * self.time_step_secs
    }
}
