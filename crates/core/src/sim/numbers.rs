//! What the numbers of a simulation's settings come to in its world.

use serde::{Deserialize, Serialize};

use crate::contact::most_contacts_joined;
use crate::sim::Settings;
use crate::sim::simulation::Simulation;
use crate::sim::steppers::{FractureWork, Stepper};
use crate::solver::{Method, picked};
use crate::world::Gravity;

impl Simulation {
    /// Substeps of the next step: 1 where its problem is solved as a whole.
    pub fn substeps(&self) -> u32 {
        let Settings { stepper, parameters, .. } = &self.settings;
        (stepper.info().substeps)(&self.state.world, self.state.physics, parameters)
    }

    /// The method that solves a problem as large as that of the last step, or as its largest island where islands are
    /// solved by themselves: that of the settings, or the one that `auto` picks.
    pub fn picked_method(&self) -> Method {
        let Settings { solver, .. } = &self.settings;
        let model = solver.model(self.is_driven());
        picked(solver, model, || self.contacts_together(), self.is_driven())
    }

    /// Contacts of the largest problem that the method was given in the last step: all, or those of the largest
    /// island.
    pub fn contacts_together(&self) -> usize {
        let contacts = self.state.contacts.contacts();
        if self.settings.solver.islands && !self.is_driven() {
            most_contacts_joined(contacts, self.state.world.grains.len())
        } else {
            contacts.len()
        }
    }

    fn is_driven(&self) -> bool {
        self.state.world.motions.iter().any(|motion| motion.drive.is_some())
    }

    /// The longest substep, s, with which the springs of the next step are surely stable; none
    /// where there are no springs.
    pub fn critical_time_step_secs(&self) -> Option<f64> {
        let Settings { stepper, parameters, .. } = &self.settings;
        (stepper.info().critical_time_step_secs)(&self.state.world, self.state.physics, parameters)
    }

    /// How long two grains of the mean mass that meet push each other, s; none where contacts are no springs.
    pub fn contact_time_secs(&self) -> Option<f64> {
        let Settings { stepper, parameters, .. } = &self.settings;
        (stepper.info().contact_time_secs)(&self.state.world, self.state.physics, parameters)
    }

    /// What it takes to break the bond of two grains of the mean mass slowly; none where the law does not say, or
    /// nothing coheres.
    pub fn fracture_work(&self) -> Option<FractureWork> {
        let Settings { stepper, parameters, .. } = &self.settings;
        (stepper.info().fracture_work)(&self.state.world, self.state.physics, parameters)
    }
}

/// What steps by a number of sweeps make of a pile: an elastic body.
///
/// The solver's error in physical units: what sweeps leave undone makes contacts springs.
///
/// Where each step is N sweeps from the impulses of the step before, a row of discs on a wall behaves as one of springs
/// κ = q m N/Δt² and dashpots q m N/Δt (T. Unger, L. Brendel, D. E. Wolf, J. Kertész, Phys. Rev. E 65, 061305, 2002): a
/// sweep is a step of diffusion of the velocities, q d² a sweep. In N sweeps a force spreads over √N d, and to what lies
/// farther the pile is an elastic body with the sound speed c = √(qN) d/Δt. In a pile of more than one column κ and c
/// scale alike, with factors near 1 that hang on the packing.
///
/// q on a row: ½ where all contacts are updated at once, and half of that under mass splitting, which cuts discs with
/// two contacts in two; 1 for sweeps in an order that stays the same, since a row has no loops (D. M. Young 1971: each
/// sweep of Gauss–Seidel shrinks an error as two of Jacobi's do).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SweepElasticity {
    /// q: how far the velocities of a row diffuse in a sweep, d².
    pub diffusion: f64,
    /// N: sweeps of a step.
    pub sweeps: f64,
    /// κ = q m N/Δt² of two grains of the mean mass, N/m.
    pub stiffness: f64,
    /// c = √(qN) d/Δt, m/s.
    pub sound_speed: f64,
    /// ℓ = √N d: how far a force spreads in a step, m.
    pub spreading_length: f64,
    /// How high the grains stand against gravity, m. Where ℓ is less, what holds the pile is not in balance.
    pub height: f64,
}

/// q of a method on a row; none where a step is no number of sweeps.
pub const fn diffusion_of_sweep(method: Method) -> Option<f64> {
    match method {
        Method::Nsgs | Method::NsgsParallel => Some(1.0),
        Method::Jacobi => Some(0.25),
        _ => None,
    }
}

impl Simulation {
    /// What steps of so many sweeps make of the pile as it stands; none where steps are not swept, start from nothing,
    /// or there are no sweeps.
    pub fn sweep_elasticity(&self, sweeps: f64) -> Option<SweepElasticity> {
        let settings = self.settings();
        let method = self.picked_method();
        let is_swept = settings.stepper == Stepper::Moreau && settings.solver.warm_start;
        let diffusion = diffusion_of_sweep(method).filter(|_| is_swept && sweeps > 0.0)?;
        let (world, step_secs) = (self.world(), settings.parameters.time_step_secs);
        let mass = world.grains.masses.iter().sum::<f64>() / world.grains.len() as f64;
        let spread = diffusion * sweeps;
        Some(SweepElasticity {
            diffusion,
            sweeps,
            stiffness: spread * mass / (step_secs * step_secs),
            sound_speed: spread.sqrt() * world.mean_diameter / step_secs,
            spreading_length: sweeps.sqrt() * world.mean_diameter,
            height: self.height(),
        })
    }

    /// From the lowest point of a grain that is not lost to the highest, along uniform gravity, else along y, m.
    fn height(&self) -> f64 {
        let world = self.world();
        let up = match world.gravity {
            Gravity::Uniform { acceleration } => (-acceleration).try_normalize(),
            Gravity::Attraction { .. } => None,
        };
        let up = up.unwrap_or(glam::DVec2::Y);
        let grains = world.grains.positions.iter().zip(&world.grains.radii).enumerate();
        let there = grains.filter(|(index, _)| !self.is_lost(*index));
        let (lowest, highest) = there
            .map(|(_, (place, radius))| (place.dot(up) - radius, place.dot(up) + radius))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |all, one| {
                (all.0.min(one.0), all.1.max(one.1))
            });
        (highest - lowest).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::sim::Settings;
    use crate::solver::SolverSettings;
    use crate::world::{Boundary, Grain, Grains, Physics, World};

    /// A row of ten discs of 1 cm and a tenth of a gram on a floor.
    fn row(change: impl Fn(&mut Settings)) -> Simulation {
        let disc = |k: u32| Grain::at_rest(DVec2::new(0.0, 0.01 * (0.5 + f64::from(k))), 5e-3);
        let discs: Vec<Grain> = (0..10).map(disc).collect();
        let grains = Grains::new(&discs, 1e-4 / (std::f64::consts::PI * 25e-6));
        let mut world = World::of(grains, Gravity::Uniform { acceleration: -9.8 * DVec2::Y }, 0.01);
        world.boundaries.push(Boundary::HalfSpace { point: DVec2::ZERO, normal: DVec2::Y });
        let mut settings = Settings { solver: SolverSettings::SWEEPS, ..Settings::default() };
        change(&mut settings);
        Simulation::new(world, Physics::FULL, settings, 0.0).expect("a sound world")
    }

    #[test]
    fn sweeps_make_springs_of_contacts() {
        let told = row(|_| ()).sweep_elasticity(100.0).expect("a swept pile");
        let near = |one: f64, other: f64| assert!((one / other - 1.0).abs() < 1e-12, "{one}");
        near(told.stiffness, 1e4);
        near(told.sound_speed, 100.0);
        near(told.spreading_length, 0.1);
        near(told.height, 0.1);
        let jacobi = row(|settings| settings.solver.method = Method::Jacobi);
        near(jacobi.sweep_elasticity(100.0).expect("a swept pile").sound_speed, 50.0);
    }

    #[test]
    fn where_steps_are_not_swept_there_is_no_such_spring() {
        let newton = row(|settings| settings.solver.method = Method::Newton);
        assert_eq!(newton.sweep_elasticity(100.0), None);
        let springs = row(|settings| settings.stepper = Stepper::Dem);
        assert_eq!(springs.sweep_elasticity(100.0), None);
        let cold = row(|settings| settings.solver.warm_start = false);
        assert_eq!(cold.sweep_elasticity(100.0), None);
        assert_eq!(row(|_| ()).sweep_elasticity(0.0), None);
    }
}
