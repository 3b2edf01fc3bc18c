//! The models that a step is compiled for.

use super::kinematics::Kinematics;
use crate::contact::{Lanes, law};
use crate::world::{FrictionCone, Parameters, Periodic, Physics};

/// What a step computes. Everything here is known when the step is compiled, so a leaner model
/// has no branch for what it leaves out.
///
/// Cohesion is not among it: in shifted impulses (`contact::law`) it costs the sweep nothing.
pub trait Model: Copy + 'static {
    /// How bodies move.
    type Kinematics: Kinematics;
    /// Whether contacts carry tangential impulses.
    const FRICTION: bool;
    /// Whether only the compressive part of the normal force rubs.
    const COMPRESSIVE_CONE: bool;

    /// The largest |λ_t| that a shifted normal impulse allows, m/s. The capture speed matters in the
    /// compressive cone alone.
    #[inline(always)]
    fn friction_bound<T: Lanes>(friction: f64, shifted_impulse: T, capture_speed: f64) -> T {
        if Self::COMPRESSIVE_CONE {
            law::friction_bound::<true, _>(friction, shifted_impulse, capture_speed)
        } else {
            law::friction_bound::<false, _>(friction, shifted_impulse, 0.0)
        }
    }
}

/// A model as a type: kinematics, then friction, compressive cone.
#[derive(Clone, Copy, Debug)]
pub struct StepModel<K, const FRICTION: bool, const COMPRESSIVE_CONE: bool>(
    std::marker::PhantomData<K>,
);

impl<K: Kinematics, const FRICTION: bool, const COMPRESSIVE_CONE: bool> Model
    for StepModel<K, FRICTION, COMPRESSIVE_CONE>
{
    type Kinematics = K;
    const FRICTION: bool = FRICTION;
    const COMPRESSIVE_CONE: bool = COMPRESSIVE_CONE;
}

/// Something to be done once the model is known.
pub trait ModelVisitor {
    /// What it gives.
    type Output;
    /// Does it.
    fn visit<M: Model>(self) -> Self::Output;
}

/// What a model computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModelParts {
    /// 1 or 2.
    pub axes: u8,
    /// Whether borders shear.
    pub sheared: bool,
    /// Whether contacts carry tangential impulses.
    pub friction: bool,
    /// Whether grains turn; without friction nothing turns them.
    pub rotation: bool,
    /// Whether only the compressive part of the normal force rubs.
    pub compressive_cone: bool,
}

impl ModelParts {
    /// The leanest model that computes what the scene has (`physics`) and what is switched on at
    /// present: without friction where μ = 0, with one cone where Bond = 0. Each gives the same
    /// impulses as the fuller model would.
    pub(crate) fn leanest(
        physics: Physics,
        periodic: Option<Periodic>,
        parameters: &Parameters,
    ) -> Self {
        let cohesion = physics.cohesion && parameters.bond > 0.0;
        Self {
            axes: physics.axes,
            sheared: periodic.is_some_and(Periodic::is_sheared),
            friction: physics.friction && parameters.friction > 0.0,
            rotation: physics.rotation,
            compressive_cone: cohesion && parameters.cone == FrictionCone::Compressive,
        }
    }
}
