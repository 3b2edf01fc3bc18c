//! Tests of smoothed fields (quantities of grains averaged over their surroundings): their sums over all cells equal
//! those over the grains for any position of the periodic borders, and their width is the stated width.

use glam::DMat2;
use slump::granular::{Fields, PileMeasures};
use slump::scene::built_in;
use slump::sim::Moment;

use crate::common::*;

/// Names of scenes with moving grains, each with the number of steps that are run: with walls, with cells that are
/// periodic in x or in both directions, and with shear.
const SCENES: [(&str, u64); 5] =
    [("pile", 60), ("collapse", 100), ("shear", 400), ("shear-periodic", 300), ("drum", 200)];

fn moment_of(name: &str, steps: u64) -> Moment {
    let mut run = built_in(name).expect("a scene").simulation().expect("a sound scene");
    run.take_steps(steps).expect("finite states");
    run.moment()
}

fn cell_area(fields: &Fields) -> f64 {
    fields.cell.x * fields.cell.y
}

fn components(tensor: DMat2) -> [f64; 4] {
    tensor.transpose().to_cols_array()
}

#[test]
fn sums_over_all_cells_are_those_of_grains_and_contacts() {
    let mut periodic = 0;
    for (name, steps) in SCENES {
        let moment = moment_of(name, steps);
        let cell = moment.surroundings.periodic.unwrap_or_default();
        periodic += usize::from(cell.x.is_some());
        let there = || moment.grains.iter().filter(|grain| !grain.lost);
        let mass: f64 = there().map(|grain| grain.mass).sum();
        let momentum: DVec2 = there().map(|grain| grain.mass * grain.velocity).sum();
        let fastest = there().fold(0f64, |most, grain| most.max(grain.velocity.length()));
        let pile = PileMeasures::of(&moment);
        let stresses = [pile.stress_xx, pile.stress_xy, pile.stress_yx, pile.stress_yy];
        for width in [0.4, 1.0, 2.7] {
            let what = format!("{name}, {width} d");
            let fields =
                Fields::of(&moment, width * moment.surroundings.mean_diameter).expect("fields");
            let area = cell_area(&fields);
            let found = area * fields.density.iter().sum::<f64>();
            assert!((found / mass - 1.0).abs() < 1e-12, "{what}: {found} {mass}");
            let found = area * fields.momentum.iter().sum::<DVec2>();
            let off = (found - momentum).length() / (mass * fastest);
            // Momentum that is smoothed across a sheared border gets the velocity of the other side.
            let crossing = if cell.border_speed() == 0.0 { 1e-12 } else { 0.1 };
            assert!(off < crossing, "{what}: {found} {momentum}");
            let found =
                components(fields.contact_stress.iter().fold(DMat2::ZERO, |sum, &part| sum + part));
            let largest = stresses.iter().fold(0f64, |most, stress| most.max(stress.abs()));
            for (found, stress) in found.into_iter().zip(stresses) {
                let off = (area * found - pile.area * stress).abs() / (pile.area * largest);
                assert!(off < 1e-11, "{what}: {found} {stress}");
            }
            // The kinetic energy is the energy of the mean flow plus the energy of the fluctuations.
            let flow = fields.momentum.iter().zip(&fields.velocity);
            let flow = flow.filter(|(_, velocity)| velocity.is_finite());
            let flow: f64 = flow.map(|(momentum, velocity)| momentum.dot(*velocity)).sum();
            let about =
                fields.kinetic_stress.iter().map(|stress| stress.x_axis.x + stress.y_axis.y);
            let found = 0.5 * area * (flow + about.sum::<f64>());
            let energy: f64 = there().map(|it| 0.5 * it.mass * it.velocity.length_squared()).sum();
            assert!((found - energy).abs() < 10.0 * crossing * energy, "{what}: {found} {energy}");
            assert!(fields.kinetic_stress.iter().all(|stress| stress.x_axis.x >= 0.0), "{what}");
        }
    }
    assert!(periodic >= 2, "the situation: {periodic} with borders that wrap");
}

#[test]
fn a_grain_is_smeared_over_the_width_that_is_said() {
    let mut moment = moment_of("pile", 0);
    moment.grains.truncate(1);
    moment.contacts.clear();
    let centre = DVec2::new(0.0123, 0.3);
    moment.grains[0].position = centre;
    for width in [2e-3, 0.1] {
        let fields = Fields::of(&moment, width).expect("fields");
        let [x, y] = fields.centres();
        let shares =
            |cell: usize| cell_area(&fields) * fields.density[cell] / moment.grains[0].mass;
        let (mut mean, mut squares) = (DVec2::ZERO, DVec2::ZERO);
        for (row, y) in y.iter().enumerate() {
            for (column, x) in x.iter().enumerate() {
                let off = DVec2::new(*x, *y) - centre;
                let share = shares(row * x_count(&fields) + column);
                mean += share * off;
                squares += share * off * off;
            }
        }
        // The content of a cell counts at the cell's middle, which adds the variance of a uniform distribution over the
        // cell.
        let expected = (width * width + fields.cell * fields.cell / 12.0).x;
        assert!(mean.length() < 1e-3 * width, "{width}: {mean}");
        assert!((squares / expected - 1.0).abs().max_element() < 2e-3, "{squares} {expected}");
    }
}

fn x_count(fields: &Fields) -> usize {
    fields.counts[0]
}

#[test]
fn a_flow_that_shears_has_its_rate_to_the_borders_and_beyond() {
    let mut moment = moment_of("shear-periodic", 1);
    let cell = moment.surroundings.periodic.expect("borders that wrap");
    let [low, high] = cell.y.expect("borders above and below");
    let middle = 0.5 * (low + high);
    for grain in &mut moment.grains {
        grain.velocity = DVec2::new(cell.shear_rate * (grain.position.y - middle), 0.0);
    }
    let fields = Fields::of(&moment, moment.surroundings.mean_diameter).expect("fields");
    let [_, y] = fields.centres();
    let speed = cell.border_speed().abs();
    assert!(speed > 0.0, "the situation");
    for (number, velocity) in fields.velocity.iter().enumerate() {
        let expected = cell.shear_rate * (y[number / fields.counts[0]] - middle);
        // The largest difference of grain speeds within one smoothing width.
        let most = 2.0 * cell.shear_rate.abs() * fields.width;
        assert!(
            (velocity.x - expected).abs() < most && most < 0.3 * speed,
            "{velocity} {expected}"
        );
    }
}

#[test]
fn a_force_lies_between_the_centres_that_it_acts_on() {
    let moment = moment_of("shear-periodic", 300);
    let d = moment.surroundings.mean_diameter;
    let cell = moment.surroundings.periodic.expect("borders that wrap");
    let mut crossing = 0;
    for index in 0..moment.contacts.len() {
        let mut alone = moment.clone();
        alone.contacts = vec![moment.contacts[index]];
        let fields = Fields::of(&alone, 0.25 * d).expect("fields");
        let [x, y] = fields.centres();
        let contact = &alone.contacts[0];
        let centre = alone.grains[contact.grain as usize].position;
        let middle = centre - 0.5 * contact.branch;
        crossing += usize::from(cell.wrap(centre - contact.branch) != centre - contact.branch);
        for (number, stress) in fields.contact_stress.iter().enumerate() {
            let at = DVec2::new(x[number % x.len()], y[number / x.len()]);
            let far = cell.shortest(at - middle).length();
            let reach = 0.5 * contact.branch.length() + 1.5 * d;
            assert!(*stress == DMat2::ZERO || far < reach, "{index}: {far} {reach}");
        }
    }
    assert!(crossing > 3, "the situation: {crossing}");
}

#[test]
fn where_all_grains_are_lost_there_is_nothing() {
    let mut moment = moment_of("pile", 5);
    moment.grains.iter_mut().for_each(|grain| grain.lost = true);
    let fields = Fields::of(&moment, 0.01).expect("fields");
    assert!(!fields.density.is_empty() && fields.density.iter().all(|&density| density == 0.0));
    assert!(fields.contact_stress.iter().all(|&stress| stress == DMat2::ZERO));
}

#[test]
fn widths_that_are_none_and_grids_that_are_too_large_are_refused() {
    let moment = moment_of("pile", 0);
    for (width, expected) in [
        (0.0, "width is 0, but must be a finite length > 0 in m"),
        (f64::NAN, "width is NaN, but must be"),
        (1e-7, "width is 0.0000001, but must be so large that"),
    ] {
        let said = Fields::of(&moment, width).expect_err(expected).to_string();
        assert!(said.starts_with(expected), "{said}");
    }
}
