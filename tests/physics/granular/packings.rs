//! Functions that build handmade states of grains and contacts, and tests of the measured quantities of square and
//! triangular packings under known loads.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::common::*;

pub fn disc(position: DVec2, radius: f64) -> GrainState {
    GrainState {
        id: 0,
        position,
        unwrapped: position,
        angle: 0.0,
        velocity: DVec2::ZERO,
        angular_velocity: 0.0,
        radius,
        mass: std::f64::consts::PI * radius * radius,
        feels_gravity: true,
        tone: 0,
        material: 0,
        lost: false,
    }
}

pub fn discs(grains: Vec<GrainState>) -> Moment {
    let mean_diameter = grains.first().map_or(1.0, |grain| 2.0 * grain.radius);
    Moment {
        first_fixed_id: grains.len() as u32,
        observables: Observables::default(),
        settings: Settings::default(),
        grains,
        contacts: Vec::new(),
        surroundings: Arc::new(Surroundings {
            fixed_discs: Vec::new(),
            boundaries: Vec::new(),
            centre_of_attraction: None,
            periodic: None,
            materials: Vec::new(),
            mean_diameter,
            gravity_magnitude: 9.8,
            moving: Vec::new(),
        }),
    }
}

/// Returns a copy of the state with these boundaries and these discs that are not grains.
pub fn among(mut moment: Moment, boundaries: Vec<Boundary>, fixed_discs: Vec<Disc>) -> Moment {
    let around = (*moment.surroundings).clone();
    moment.surroundings = Arc::new(Surroundings { fixed_discs, boundaries, ..around });
    moment
}

/// Adds a contact of grain i with the body `other`, with this vector from the centre of the body to the centre of the
/// grain (`branch`, m), gap (m), and normal and tangential force (N).
fn press_on(
    moment: &mut Moment,
    i: usize,
    (other, branch, gap): (OtherBody, DVec2, f64),
    [normal_force, tangential_force]: [f64; 2],
) {
    let (grain, normal) = (moment.grains[i], branch.normalize());
    let is_open = normal_force == 0.0;
    moment.contacts.push(ContactState {
        grain: i as u32,
        other,
        normal,
        gap,
        point: grain.position - (grain.radius + 0.5 * gap) * normal,
        branch,
        force: normal_force * normal + tangential_force * normal.perp(),
        normal_force,
        tangential_force,
        status: if is_open { ContactStatus::Open } else { ContactStatus::Stick },
        bond_stretch: None,
        age_steps: 0,
    });
}

/// Adds a contact between the grains i and j with these normal and tangential forces (N).
pub fn touch(moment: &mut Moment, [i, j]: [usize; 2], forces: [f64; 2]) {
    let (grain, other) = (moment.grains[i], moment.grains[j]);
    let branch = grain.position - other.position;
    let gap = branch.length() - grain.radius - other.radius;
    press_on(moment, i, (OtherBody::Grain(j as u32), branch, gap), forces);
}

/// Adds a contact of grain i with the half-space number `wall`, with these normal and tangential forces (N).
pub fn lean(moment: &mut Moment, i: usize, wall: usize, forces: [f64; 2]) {
    let Boundary::HalfSpace { point, normal } = moment.surroundings.boundaries[wall] else {
        panic!("boundary {wall} is no half-space");
    };
    let grain = moment.grains[i];
    let height = (grain.position - point).dot(normal);
    let wall = OtherBody::Boundary(wall as u32);
    press_on(moment, i, (wall, height * normal, height - grain.radius), forces);
}

/// Returns the four walls of a box between its lower left and upper right corner, in the order left, right, bottom,
/// top.
pub fn box_walls(low: DVec2, high: DVec2) -> Vec<Boundary> {
    let wall = |point, normal| Boundary::HalfSpace { point, normal };
    vec![
        wall(low, DVec2::X),
        wall(high, DVec2::NEG_X),
        wall(low, DVec2::Y),
        wall(high, DVec2::NEG_Y),
    ]
}

pub const RADIUS: f64 = 2e-3;
const EXACT: f64 = 1e-12;

/// Stress of a packing (force per length), N/m: σ_xx, σ_yy, and the shear stress σ_xy = σ_yx.
#[derive(Clone, Copy)]
struct Loads {
    xx: f64,
    yy: f64,
    xy: f64,
}

/// Returns a state of discs in rows and columns that fill a box whose lower left corner is `corner`.
fn square_discs(columns: usize, rows: usize, corner: DVec2) -> Moment {
    let centre = |index: usize| {
        let place = DVec2::new((index % columns) as f64, (index / columns) as f64);
        corner + 2.0 * RADIUS * (place + 0.5)
    };
    let grains = (0..columns * rows).map(|index| disc(centre(index), RADIUS)).collect();
    let size = 2.0 * RADIUS * DVec2::new(columns as f64, rows as f64);
    among(discs(grains), box_walls(corner, corner + size), Vec::new())
}

/// Returns the state of [`square_discs`] with contact forces that give a homogeneous stress.
fn square_packing(columns: usize, rows: usize, corner: DVec2, loads: Loads) -> Moment {
    let mut moment = square_discs(columns, rows, corner);
    let [along_x, along_y] = [loads.xx, loads.yy].map(|load| 2.0 * RADIUS * load);
    // For a body on the right the tangent t is +y, the direction of the shear force. For a body above, t is −x.
    let shear = 2.0 * RADIUS * loads.xy;
    for row in 0..rows {
        for column in 0..columns {
            let index = row * columns + column;
            if column > 0 {
                touch(&mut moment, [index, index - 1], [along_x, shear]);
            }
            if row > 0 {
                touch(&mut moment, [index, index - columns], [along_y, -shear]);
            }
        }
        lean(&mut moment, row * columns, 0, [along_x, shear]);
        lean(&mut moment, row * columns + columns - 1, 1, [along_x, shear]);
    }
    for column in 0..columns {
        lean(&mut moment, column, 2, [along_y, -shear]);
        lean(&mut moment, (rows - 1) * columns + column, 3, [along_y, -shear]);
    }
    moment
}

/// Returns a state of touching discs without walls, in rows of `columns` discs. Every second row is shifted by a
/// radius.
pub fn triangular_discs(columns: usize, rows: usize) -> Moment {
    let centre = |index: usize| {
        let (row, column) = (index / columns, index % columns);
        let shift = if row % 2 == 0 { 0.0 } else { 0.5 };
        2.0 * RADIUS * DVec2::new(column as f64 + shift, row as f64 * 0.75f64.sqrt())
    };
    discs((0..columns * rows).map(|index| disc(centre(index), RADIUS)).collect())
}

/// Adds contacts to all touching pairs. The three normal forces (N) are for pairs in the directions 0°, 60° and 120°.
fn press(moment: &mut Moment, forces: [f64; 3]) {
    let centres: Vec<DVec2> = moment.grains.iter().map(|grain| grain.position).collect();
    for i in 0..centres.len() {
        for j in 0..i {
            let branch = centres[i] - centres[j];
            if branch.length() < 2.0001 * RADIUS {
                let degrees = branch.to_angle().to_degrees().rem_euclid(180.0);
                let force = forces[(degrees / 60.0).round() as usize % 3];
                touch(moment, [i, j], [force, 0.0]);
            }
        }
    }
}

/// Returns true if a grain of a triangular packing touches six neighbours.
fn is_inside(moment: &Moment, grain: &GrainState) -> bool {
    let near = |other: &&GrainState| other.position.distance(grain.position) < 2.0001 * RADIUS;
    moment.grains.iter().filter(near).count() == 7
}

#[test]
fn a_square_packing_bears_just_its_loads() {
    for (corner, loads) in [
        (DVec2::ZERO, Loads { xx: 30.0, yy: 70.0, xy: 0.0 }),
        (DVec2::new(3.0, -0.7), Loads { xx: 50.0, yy: 20.0, xy: -10.0 }),
        (DVec2::ZERO, Loads { xx: 25.0, yy: 25.0, xy: 0.0 }),
    ] {
        let (columns, rows) = (5, 3);
        let exact = if corner == DVec2::ZERO { EXACT } else { 1e-10 };
        let measured = measure(&square_packing(columns, rows, corner, loads));
        let PileMeasures { stress_xx, stress_xy, stress_yx, stress_yy, .. } = measured.pile;
        let area = (columns * rows) as f64 * 4.0 * RADIUS * RADIUS;
        assert_close(measured.pile.area, area, exact, "A");
        assert_close(measured.pile.box_area, area, exact, "area of the box");
        assert_close(stress_xx, loads.xx, exact, "σ_xx");
        assert_close(stress_yy, loads.yy, exact, "σ_yy");
        assert_close(stress_xy, loads.xy, exact, "σ_xy");
        assert_close(stress_yx, loads.xy, exact, "σ_yx");
        let deviator = DVec2::new(0.5 * (loads.xx - loads.yy), loads.xy).length();
        assert_close(measured.pile.pressure, 0.5 * (loads.xx + loads.yy), exact, "p");
        assert!((measured.pile.deviator - deviator).abs() < exact * loads.xx, "q");
        for grain in &measured.grains {
            assert_close(grain.stress_xx, loads.xx, exact, "σ_xx of a grain");
            assert_close(grain.stress_xy, loads.xy, exact, "σ_xy of a grain");
            assert_close(grain.stress_yx, loads.xy, exact, "σ_yx of a grain");
            assert_close(grain.stress_yy, loads.yy, exact, "σ_yy of a grain");
            assert_close(grain.solid_fraction, PI / 4.0, exact, "solid fraction of a cell");
            assert_eq!(grain.coordination, 4);
        }
        assert_eq!(measured.pile.closed_cells, 15);
        assert_close(measured.pile.solid_fraction_cells, PI / 4.0, exact, "by cells");
        assert_close(measured.pile.solid_fraction_box, PI / 4.0, exact, "by the box");
    }
}

#[test]
fn the_principal_direction_is_that_of_largest_compression() {
    let direction = |xx, yy, xy| {
        let moment = square_packing(4, 4, DVec2::ZERO, Loads { xx, yy, xy });
        PileMeasures::of(&moment).principal_direction
    };
    assert_eq!(direction(2.0, 1.0, 0.0), 0.0);
    assert_close(direction(1.0, 2.0, 0.0), 90.0, EXACT, "along y");
    assert_close(direction(1.0, 1.0, 0.5), 45.0, 1e-9, "up to the right");
    assert_close(direction(1.0, 1.0, -0.5), 135.0, 1e-9, "up to the left");
}

#[test]
fn a_square_packing_has_no_fabric_and_a_chain_all_of_it() {
    let loads = Loads { xx: 1.0, yy: 0.0, xy: 0.0 };
    // All sides have walls, so there are as many contacts along x as along y.
    let square = PileMeasures::of(&square_packing(4, 4, DVec2::ZERO, loads));
    assert_close(square.fabric_xx, 0.5, EXACT, "F_xx of a square packing");
    assert_close(square.fabric_yy, 0.5, EXACT, "F_yy of a square packing");
    assert_eq!(square.fabric_xy, 0.0);
    assert!(square.fabric_anisotropy.abs() < EXACT && square.fabric_direction.is_nan());
    for degrees in [0.0f64, 30.0, 90.0, 150.0] {
        let along = DVec2::from_angle(degrees.to_radians());
        let mut chain =
            discs((0..6).map(|k| disc(2.0 * RADIUS * f64::from(k) * along, RADIUS)).collect());
        for k in 1..6 {
            touch(&mut chain, [k, k - 1], [1.0, 0.0]);
        }
        let chain = PileMeasures::of(&chain);
        assert_close(chain.fabric_xx, along.x * along.x, 1e-9, "F_xx of a chain");
        assert!((chain.fabric_xy - along.x * along.y).abs() < EXACT, "F_xy of a chain");
        assert_close(chain.fabric_anisotropy, 1.0, EXACT, "anisotropy of a chain");
        assert_close(chain.fabric_direction, degrees, 1e-9, "direction of a chain");
    }
}

#[test]
fn cells_of_a_triangular_packing_have_its_stress_and_its_density() {
    let mut moment = triangular_discs(7, 6);
    let forces = [3.0, 5.0, 11.0];
    press(&mut moment, forces);
    let directions = [0.0f64, 60.0, 120.0].map(|degrees| DVec2::from_angle(degrees.to_radians()));
    // In each direction, an inner grain has two halves of a branch vector. The area of its cell is 2√3 r².
    let scale = 2.0 * RADIUS / (2.0 * 3f64.sqrt() * RADIUS * RADIUS);
    let sum = |of: fn(DVec2) -> f64| {
        scale * directions.iter().zip(forces).map(|(&n, force)| force * of(n)).sum::<f64>()
    };
    let mut inside = 0;
    for (grain, measured) in moment.grains.iter().zip(GrainMeasures::of_each(&moment)) {
        if is_inside(&moment, grain) {
            inside += 1;
            let exact = |found, of, what| assert_close(found, sum(of), EXACT, what);
            exact(measured.stress_xx, |n| n.x * n.x, "σ_xx");
            exact(measured.stress_xy, |n| n.x * n.y, "σ_xy");
            exact(measured.stress_yx, |n| n.x * n.y, "σ_yx");
            exact(measured.stress_yy, |n| n.y * n.y, "σ_yy");
            let density = PI / (2.0 * 3f64.sqrt());
            assert_close(measured.solid_fraction, density, EXACT, "solid fraction");
            assert_eq!(measured.coordination, 6);
        }
    }
    assert_eq!(inside, 5 * 4);
}

#[test]
fn a_triangular_packing_without_walls_fills_the_box_around_it() {
    // Each second row has one disc less, so that the first and last rows reach both sides.
    let mut moment = triangular_discs(9, 5);
    let is_last_of_short_row = |index: usize| index % 18 == 17;
    let mut index = 0..;
    moment.grains.retain(|_| index.next().is_some_and(|index| !is_last_of_short_row(index)));
    press(&mut moment, [1.0; 3]);
    let measured = measure(&moment);
    let (width, height) = (18.0 * RADIUS, (2.0 + 4.0 * 3f64.sqrt()) * RADIUS);
    assert_close(measured.pile.box_area, width * height, EXACT, "the box");
    assert_close(measured.pile.area, width * height, EXACT, "A");
    // Cells of the first and last rows are open, and so are the cells at both ends of all other rows.
    assert_eq!(measured.pile.closed_cells, 6 + 7 + 6);
}

#[test]
fn grains_have_their_parts_of_the_piles_stress() {
    let mut moment = triangular_discs(5, 5);
    press(&mut moment, [1.0, 2.0, -0.5]);
    let measured = measure(&moment);
    let whole = |of: fn(&GrainMeasures) -> f64| {
        measured.grains.iter().map(|grain| grain.cell_area * of(grain)).sum::<f64>()
            / measured.pile.area
    };
    assert_close(whole(|_| 1.0), 1.0, EXACT, "areas");
    assert_close(whole(|grain| grain.stress_xx), measured.pile.stress_xx, EXACT, "σ_xx");
    assert_close(whole(|grain| grain.stress_xy), measured.pile.stress_xy, EXACT, "σ_xy");
    assert_close(whole(|grain| grain.stress_yy), measured.pile.stress_yy, EXACT, "σ_yy");
    assert_close(whole(|grain| grain.pressure), measured.pile.pressure, EXACT, "p");
    let contacts: u32 = measured.grains.iter().map(|grain| grain.coordination).sum();
    assert_close(f64::from(contacts) / 25.0, measured.pile.coordination, EXACT, "Z");
    assert_eq!(contacts, 2 * measured.pile.contacts);
}
