//! Moments made by hand: discs and contacts with forces that are known.

use std::sync::Arc;

use crate::common::*;

/// A disc at rest.
pub fn disc(position: DVec2, radius: f64) -> GrainState {
    GrainState {
        position,
        angle: 0.0,
        velocity: DVec2::ZERO,
        angular_velocity: 0.0,
        radius,
        mass: std::f64::consts::PI * radius * radius,
        feels_gravity: true,
        tone: 0,
        lost: false,
    }
}

/// Discs without contacts.
pub fn discs(grains: Vec<GrainState>) -> Moment {
    let mean_diameter = grains.first().map_or(1.0, |grain| 2.0 * grain.radius);
    Moment {
        observables: Observables::default(),
        settings: Settings::default(),
        grains,
        contacts: Vec::new(),
        surroundings: Arc::new(Surroundings {
            fixed_discs: Vec::new(),
            boundaries: Vec::new(),
            centre_of_attraction: None,
            periodic: None,
            mean_diameter,
            gravity_magnitude: 9.8,
            moving: Vec::new(),
        }),
    }
}

/// The same among these fixed bodies.
pub fn among(mut moment: Moment, boundaries: Vec<Boundary>, fixed_discs: Vec<Disc>) -> Moment {
    let Surroundings { centre_of_attraction, mean_diameter, gravity_magnitude, .. } =
        *moment.surroundings;
    moment.surroundings = Arc::new(Surroundings {
        fixed_discs,
        boundaries,
        centre_of_attraction,
        periodic: None,
        mean_diameter,
        gravity_magnitude,
        moving: Vec::new(),
    });
    moment
}

/// Lets grains i and j touch with N and T.
pub fn touch(moment: &mut Moment, [i, j]: [usize; 2], [normal_force, tangential_force]: [f64; 2]) {
    let (grain, other) = (moment.grains[i], moment.grains[j]);
    let branch = grain.position - other.position;
    let gap = branch.length() - grain.radius - other.radius;
    let normal = branch.normalize();
    moment.contacts.push(ContactState {
        grain: i as u32,
        other: OtherBody::Grain(j as u32),
        normal,
        gap,
        point: grain.position - (grain.radius + 0.5 * gap) * normal,
        branch,
        normal_force,
        tangential_force,
        status: status(normal_force),
        bond_stretch: None,
        age_steps: 0,
    });
}

/// Lets grain i touch the half-space of that number with N and T.
pub fn lean(
    moment: &mut Moment,
    i: usize,
    wall: usize,
    [normal_force, tangential_force]: [f64; 2],
) {
    let Boundary::HalfSpace { point, normal } = moment.surroundings.boundaries[wall] else {
        panic!("boundary {wall} is no half-space");
    };
    let grain = moment.grains[i];
    let height = (grain.position - point).dot(normal);
    moment.contacts.push(ContactState {
        grain: i as u32,
        other: OtherBody::Boundary(wall as u32),
        normal,
        gap: height - grain.radius,
        point: grain.position - 0.5 * (height + grain.radius) * normal,
        branch: height * normal,
        normal_force,
        tangential_force,
        status: status(normal_force),
        bond_stretch: None,
        age_steps: 0,
    });
}

fn status(normal_force: f64) -> ContactStatus {
    if normal_force == 0.0 { ContactStatus::Open } else { ContactStatus::Stick }
}

/// The walls of a box: left, right, bottom, top.
pub fn box_walls(low: DVec2, high: DVec2) -> Vec<Boundary> {
    let wall = |point, normal| Boundary::HalfSpace { point, normal };
    vec![
        wall(low, DVec2::X),
        wall(high, DVec2::NEG_X),
        wall(low, DVec2::Y),
        wall(high, DVec2::NEG_Y),
    ]
}
