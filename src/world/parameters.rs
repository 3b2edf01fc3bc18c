//! What a scene can do, and the numbers that may change between any two steps.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// The physics that a scene needs. A step is compiled for just that.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Physics {
    /// 1 (all on the x axis) or 2.
    pub axes: u8,
    /// Whether contacts carry tangential impulses.
    pub friction: bool,
    /// Whether grains turn. Without friction nothing changes a disc's spin, so this asks for
    /// friction.
    pub rotation: bool,
    /// Whether contacts can pull.
    pub cohesion: bool,
}

impl Physics {
    /// Two axes, friction, rotation and cohesion.
    pub const FULL: Self = Self { axes: 2, friction: true, rotation: true, cohesion: true };

    /// Checks that the parts fit each other.
    ///
    /// # Errors
    /// Names the field that does not fit.
    pub fn validate(&self) -> Result<()> {
        match (self.axes, self.friction, self.rotation) {
            (1 | 2, false, true) => {
                Err(Error::value("physics.rotation", true, "false where physics.friction is false"))
            }
            (1, true, _) => Err(Error::value(
                "physics.friction",
                true,
                "false where physics.axes is 1: a line has no tangent",
            )),
            (1 | 2, ..) => Ok(()),
            (axes, ..) => Err(Error::value("physics.axes", axes, "1 or 2")),
        }
    }
}

/// Which part of the normal force bounds friction (the paper leaves both readings open).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum FrictionCone {
    /// |T| ≤ μ (N + C₀): the cone's apex is at −C₀.
    #[default]
    Shifted,
    /// |T| ≤ μ max(N, 0).
    Compressive,
}

/// How long a bond lives, and what a contact sees of its gap.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum ContactLaw {
    /// The paper's: a contact and its cohesion live while the gap is negative.
    #[default]
    Moreau,
    /// A bond lives until it has been stretched by the debonding distance (`contact::range`).
    Range,
}

/// Numbers that may change between any two steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameters {
    /// Bond number: C₀ = Bond · m_ij · g (paper eq. 10).
    pub bond: f64,
    /// Δt, s.
    pub time_step_secs: f64,
    /// ρ, 0 … 1.
    pub restitution: f64,
    /// μ.
    pub friction: f64,
    /// Which part of the normal force bounds friction.
    #[serde(default)]
    pub cone: FrictionCone,
    /// Contacts whose |v_n^{n−1}| is below this many g·Δt do not bounce; 0 in the paper's scheme.
    ///
    /// The term ρ v_n^{n−1} of a wedged contact can contradict that of its neighbours, and the step
    /// then has no solution. Below about 2 g·Δt it stands for no bounce that anyone could see.
    /// Without effect under the law `range`, whose shocks have a solution always.
    #[serde(default)]
    pub restitution_threshold: f64,
    /// How long a bond lives.
    #[serde(default)]
    pub law: ContactLaw,
    /// δ_c of the law `range`, in mean diameters.
    #[serde(default = "default_debonding_distance")]
    pub debonding_distance: f64,
}

/// δ_c where none is given, in mean diameters.
pub const DEBONDING_DISTANCE: f64 = 0.01;

/// The largest δ_c, in mean diameters: within it no third grain fits between two bonded ones.
const LARGEST_DEBONDING_DISTANCE: f64 = 0.1;

fn default_debonding_distance() -> f64 {
    DEBONDING_DISTANCE
}

impl Default for Parameters {
    /// The paper's scheme at Δt = 1e-3 s, with contacts that neither pull, bounce nor rub.
    fn default() -> Self {
        Self {
            bond: 0.0,
            time_step_secs: 1e-3,
            restitution: 0.0,
            friction: 0.0,
            cone: FrictionCone::Shifted,
            restitution_threshold: 0.0,
            law: ContactLaw::Moreau,
            debonding_distance: DEBONDING_DISTANCE,
        }
    }
}

impl Parameters {
    /// Checks every number against its range.
    ///
    /// # Errors
    /// Names the first field outside its range, its value and the range.
    pub fn validate(&self) -> Result<()> {
        let Self {
            bond,
            time_step_secs,
            restitution,
            friction,
            cone,
            restitution_threshold,
            law,
            debonding_distance,
        } = *self;
        // Written so that NaN fails each of them.
        if !(bond >= 0.0 && bond.is_finite()) {
            return Err(Error::value("bond", bond, "a finite number ≥ 0"));
        }
        if !(time_step_secs > 0.0 && time_step_secs.is_finite()) {
            return Err(Error::value("dt", time_step_secs, "a finite number of seconds > 0"));
        }
        if !(0.0..=1.0).contains(&restitution) {
            return Err(Error::value("rho", restitution, "between 0 and 1"));
        }
        if !(friction >= 0.0 && friction.is_finite()) {
            return Err(Error::value("mu", friction, "a finite number ≥ 0"));
        }
        if !(restitution_threshold >= 0.0 && restitution_threshold.is_finite()) {
            let field = "restitution-threshold";
            return Err(Error::value(field, restitution_threshold, "a finite number ≥ 0"));
        }
        if !(debonding_distance > 0.0 && debonding_distance <= LARGEST_DEBONDING_DISTANCE) {
            let allowed = format!("above 0 and at most {LARGEST_DEBONDING_DISTANCE} diameters");
            return Err(Error::value("debonding-distance", debonding_distance, allowed));
        }
        // In the compressive cone the sweep needs the capture speed, which differs between contacts.
        if law == ContactLaw::Range && cone == FrictionCone::Compressive {
            return Err(Error::value("cone", "compressive", "shifted where law is range"));
        }
        Ok(())
    }

    /// ρ v_n^{n−1}, m/s, of a contact with that normal velocity at the beginning of the step.
    pub fn restitution_velocity(&self, normal_velocity: f64, gravity_magnitude: f64) -> f64 {
        let least = self.restitution_threshold * gravity_magnitude * self.time_step_secs;
        if normal_velocity.abs() < least { 0.0 } else { self.restitution * normal_velocity }
    }

    /// Bond·Δt/√(d/g), dimensionless (paper §3.3).
    pub fn cohesive_time(&self, mean_diameter: f64, gravity_magnitude: f64) -> f64 {
        self.bond * self.time_step_secs / (mean_diameter / gravity_magnitude).sqrt()
    }

    /// Bond·g·Δt, m/s: the opening speed that one step of cohesion cancels (paper eq. 9).
    pub fn capture_speed(&self, gravity_magnitude: f64) -> f64 {
        self.bond * gravity_magnitude * self.time_step_secs
    }
}
