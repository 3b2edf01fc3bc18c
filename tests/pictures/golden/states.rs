//! Handmade states of grains for pictures: stored numbers and plain arithmetic without any simulation, so that the
//! pictures do not change with the physics.

use std::sync::Arc;

use glam::DVec2;
use slump::sim::{ContactView, GrainView, Observables, Snapshot, Surroundings};
use slump::world::{Boundary, Disc};

/// Mean diameter of the pile, m.
const D: f64 = 0.005;
/// Radii of the pile's grains in units of d/2 (d: mean diameter). The first seven grains have these radii in this
/// order, the next seven again, and so on.
const RADII: [f64; 7] = [0.97, 0.88, 1.0, 0.93, 0.9, 0.99, 0.95];
/// Grey values of the pile's grains, from 0 (black) to 255 (white). The first five grains have these values in this
/// order, the next five again, and so on.
const TONES: [u8; 5] = [205, 225, 190, 240, 175];

fn grain(position: DVec2, radius: f64, tone: u8) -> GrainView {
    GrainView {
        position,
        radius,
        angle: 0.0,
        velocity: DVec2::ZERO,
        angular_velocity: 0.0,
        overlap: 0.0,
        force: 0.0,
        coordination: 0,
        tone,
        material: 0,
    }
}

/// Returns a heap of ten rows on a rough base. Its flanks move outwards. The snapshot contains the left wall of the box
/// in which the heap was made.
pub fn pile() -> Snapshot {
    let base = |k: i32| Disc { position: DVec2::new(f64::from(k) * D, 0.0), radius: D / 2.0 };
    let fixed_discs: Vec<Disc> = (-12..=12).map(base).collect();
    let mut grains = Vec::new();
    for row in 1..=10 {
        let count = 17 - row - row / 3;
        for place in 0..count {
            let x = (f64::from(place) - 0.5 * f64::from(count - 1)) * D + 0.25 * D;
            let y = f64::from(row) * 0.86 * D;
            let index = grains.len();
            let radius = RADII[index % RADII.len()] * D / 2.0;
            let mut grain = grain(DVec2::new(x, y), radius, TONES[index % TONES.len()]);
            grain.angle = 0.37 * index as f64;
            // The grains at the flanks are fast, the grains in the middle are at rest.
            let flank = x / (8.0 * D);
            grain.velocity = DVec2::new(0.3 * flank.powi(3), -0.05 * flank * flank);
            grains.push(grain);
        }
    }
    let contacts = pile_contacts(&mut grains, &fixed_discs);
    let wall =
        Boundary::Segment { from: DVec2::new(-8.9 * D, 0.0), to: DVec2::new(-8.9 * D, 8.0 * D) };
    Snapshot {
        observables: Observables::default(),
        grains,
        contacts,
        surroundings: Arc::new(Surroundings {
            fixed_discs,
            boundaries: vec![wall],
            centre_of_attraction: None,
            periodic: None,
            materials: Vec::new(),
            mean_diameter: D,
            gravity_magnitude: 9.8,
            moving: Vec::new(),
        }),
    }
}

/// Returns contacts between all neighbours whose centres are closer than 1.06 times the sum of their radii. Steep
/// contacts push; nearly horizontal contacts in the upper rows pull.
fn pile_contacts(grains: &mut [GrainView], fixed: &[Disc]) -> Vec<ContactView> {
    let mut contacts = Vec::new();
    for i in 0..grains.len() {
        let partners: Vec<(Option<usize>, DVec2, f64)> = (i + 1..grains.len())
            .map(|j| (Some(j), grains[j].position, grains[j].radius))
            .chain(fixed.iter().map(|disc| (None, disc.position, disc.radius)))
            .collect();
        for (j, position, radius) in partners {
            let apart = grains[i].position - position;
            let gap = apart.length() - grains[i].radius - radius;
            if gap > 0.06 * (grains[i].radius + radius) {
                continue;
            }
            let steepness = (apart.y / apart.length()).abs();
            let depth = 10.0 - grains[i].position.y / (0.86 * D);
            let force = if steepness > 0.5 { 0.02 * (1.0 + depth) } else { -0.03 - 0.004 * depth };
            let uneven = 1.0 + 0.6 * (3.1 * i as f64).sin();
            let force = force * uneven;
            let overlap = (0.002 + 0.001 * depth) * D * uneven;
            for index in [Some(i), j].into_iter().flatten() {
                grains[index].force += force.abs();
                grains[index].coordination += 1;
                grains[index].overlap = grains[index].overlap.max(overlap);
            }
            contacts.push(ContactView {
                grain: i as u32,
                other_grain: j.map(|j| j as u32),
                from: grains[i].position,
                to: position,
                normal_force: force,
                tangential_force: 0.1 * force,
                gap,
            });
        }
    }
    contacts
}

/// Returns three discs on a line around a centre of attraction, above a hatched ground, next to a tilted half-space, a
/// polygon and a bent wall.
pub fn cradle() -> Snapshot {
    let radius = 0.15;
    let grains = [(-0.55, 90), (0.0, 205), (0.3, 245)]
        .map(|(x, tone)| grain(DVec2::new(x, 0.0), radius, tone));
    let mut grains = grains.to_vec();
    grains[0].angle = 0.6;
    let points = |corners: &[(f64, f64)]| corners.iter().copied().map(DVec2::from).collect();
    Snapshot {
        observables: Observables::default(),
        grains,
        contacts: Vec::new(),
        surroundings: Arc::new(Surroundings {
            fixed_discs: vec![Disc { position: DVec2::new(0.75, -0.2), radius: 0.1 }],
            boundaries: vec![
                Boundary::HalfSpace { point: DVec2::new(0.0, -0.3), normal: DVec2::Y },
                Boundary::HalfSpace { point: DVec2::new(1.0, 0.0), normal: DVec2::new(-2.0, 1.0) },
                Boundary::ConvexPolygon {
                    points: points(&[(-1.0, -0.25), (-0.75, -0.25), (-0.8, 0.0), (-0.95, 0.05)]),
                },
                Boundary::Polyline { points: points(&[(0.5, 0.2), (0.6, 0.05), (0.75, 0.05)]) },
            ],
            centre_of_attraction: Some(DVec2::ZERO),
            periodic: None,
            materials: Vec::new(),
            mean_diameter: 2.0 * radius,
            gravity_magnitude: 2.0,
            moving: Vec::new(),
        }),
    }
}
