//! The engine rapier2d, in single precision (f32).

use rapier2d::prelude::*;

use crate::engine::{Engine, SLOP_IN_DIAMETERS, Setting};
use crate::pile::{AREAL_DENSITY, Disc, GRAVITY, Pile};

/// Distance at which rapier starts to create contacts before grains touch, in mean diameters. By default this distance
/// is proportional to the slop (overlap that is not pushed out). With a small slop, contacts of fast grains would then
/// be created too late.
const PREDICTION: f64 = 0.1;

/// Sets the distance, in mean diameters, at which rapier starts to create contacts.
pub fn set_prediction(parameters: &mut IntegrationParameters, distance: f64) {
    parameters.normalized_prediction_distance =
        (distance / SLOP_IN_DIAMETERS) as f32 * parameters.normalized_allowed_linear_error;
}

pub struct Rapier {
    world: PhysicsWorld,
    grains: Vec<RigidBodyHandle>,
}

impl Rapier {
    /// Puts a pile into the engine. `change` may change the settings that follow from `setting`.
    pub fn new(
        pile: &Pile,
        setting: Setting,
        change: impl FnOnce(&mut IntegrationParameters),
    ) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::new(0.0, -GRAVITY as f32);
        let defaults = IntegrationParameters::default();
        let stiff = |damping_ratio| SpringCoefficients {
            natural_frequency: setting.contact_hertz,
            damping_ratio,
        };
        // Every length of the engine is proportional to this unit, which is chosen to give the requested slop.
        let slop = (SLOP_IN_DIAMETERS * pile.diameter()) as f32;
        let length_unit = slop / defaults.normalized_allowed_linear_error;
        world.integration_parameters = IntegrationParameters {
            dt: setting.time_step_secs as f32,
            num_solver_iterations: setting.substeps as usize,
            contact_softness: stiff(defaults.contact_softness.damping_ratio),
            static_contact_softness: stiff(defaults.static_contact_softness.damping_ratio),
            length_unit,
            // The two following bounds are turned off, because they would also shrink with the unit.
            normalized_max_corrective_velocity: f32::MAX,
            normalized_max_linear_velocity: f32::MAX,
            ..defaults
        };
        set_prediction(&mut world.integration_parameters, PREDICTION);
        change(&mut world.integration_parameters);
        let [friction, restitution] = pile.friction_and_restitution();
        let ball = |disc: &Disc| {
            ColliderBuilder::ball(disc.radius as f32)
                .density(AREAL_DENSITY as f32)
                .friction(friction)
                .restitution(restitution)
        };
        for disc in &pile.base {
            let place = Vector::new(disc.x as f32, disc.y as f32);
            world.insert_collider(ball(disc).translation(place), None);
        }
        let grains = pile
            .grains
            .iter()
            .map(|disc| {
                let place = Vector::new(disc.x as f32, disc.y as f32);
                let body = RigidBodyBuilder::dynamic().translation(place).can_sleep(false);
                world.insert(body, ball(disc)).0
            })
            .collect();
        Self { world, grains }
    }
}

impl Engine for Rapier {
    fn step(&mut self) {
        self.world.step();
    }

    fn positions(&mut self) -> Vec<[f64; 2]> {
        let place = |handle: &RigidBodyHandle| {
            let place = self.world.bodies[*handle].translation();
            [f64::from(place.x), f64::from(place.y)]
        };
        self.grains.iter().map(place).collect()
    }
}
