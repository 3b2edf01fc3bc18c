//! Flows between borders that shear: momentum and energy are accounted for, profile and stress are those of the shear, and
//! files know of the borders.

use super::saved_and_read;
use super::sheared::{SIZE, cell, gas, ways};
use crate::common::*;
use slump::data::{FormatName, Recording, RunFacts};

#[test]
fn momentum_less_that_of_the_shear_stays() {
    let rate = 20.0;
    for stepper in Stepper::ALL.iter().filter(|&&stepper| stepper != Stepper::Avbd) {
        let mut scene = gas(rate, 0.95, 0.1);
        (scene.stepper, scene.parameters.time_step_secs) = (*stepper, 2e-4);
        let mut run = start(&scene);
        let momentum = |run: &Simulation| -> DVec2 {
            let grains = run.grains();
            let own = |k: usize| grains.velocities[k] - rate * grains.positions[k].y * DVec2::X;
            (0..grains.len()).map(|k| grains.masses[k] * own(k)).sum()
        };
        let (before, mut crossings) = (momentum(&run), 0);
        for _ in 0..500 {
            let old = run.grains().positions.clone();
            take_steps(&mut run, 1);
            let now = run.places();
            crossings += old
                .iter()
                .zip(now)
                .filter(|(old, now)| (old.y - now.y).abs() > 0.5 * SIZE.y)
                .count();
        }
        assert!(crossings > 10, "{stepper}: {crossings}");
        let scale: f64 = run.grains().masses.iter().sum::<f64>() * rate * SIZE.y;
        // Schemes move grains by other velocities than they end a substep with, or by places alone.
        let exact = [Stepper::Moreau, Stepper::Dem].contains(stepper);
        let allowed = if exact { 1e-12 } else { 2e-3 };
        let off = momentum(&run).distance(before) / scale;
        assert!(off < allowed, "{stepper}: {off}");
    }
}

#[test]
fn kinetic_energy_changes_by_the_works_of_contacts_and_borders() {
    for (stepper, method) in ways().filter(|way| way.0 != Stepper::Avbd) {
        let mut scene = gas(20.0, 0.5, 0.3);
        (scene.stepper, scene.solver.method) = (stepper, method);
        scene.parameters.bond = 3.0;
        let mut run = start(&scene);
        let (start_energy, mut works) = (run.observables().kinetic_energy, [0.0; 2]);
        for _ in 0..120 {
            let before = run.observables().kinetic_energy;
            take_steps(&mut run, 1);
            let now = run.observables();
            let of_contacts = now.normal_work + now.tangential_work;
            let of_border = now.border_work.expect("it shears");
            let what = format!("{stepper} {method}: {now:?}");
            let off =
                (now.kinetic_energy - before - of_contacts - of_border - now.gravity_work).abs();
            assert!(off < 1e-12 * start_energy, "{off}: {what}");
            works = [works[0] + of_contacts, works[1] + of_border.abs()];
        }
        let enough = works[0] < -0.1 * start_energy && works[1] > 0.01 * start_energy;
        assert!(enough, "{works:?} J of {start_energy} J");
    }
}

#[test]
fn remedies_know_of_images_that_slide() {
    let with = |change: &dyn Fn(&mut Remedies)| {
        let mut scene = gas(20.0, 0.5, 0.3);
        change(&mut scene.remedies);
        (scene.parameters.time_step_secs, scene.solver) = (1e-3, to_residual(1e-8));
        let mut run = start(&scene);
        let mut deepest = 0f64;
        for _ in 0..200 {
            let before = run.observables().kinetic_energy;
            take_steps(&mut run, 1);
            let now = run.observables();
            let works = now.normal_work + now.tangential_work + now.border_work.expect("it shears");
            assert!((now.kinetic_energy - before - works).abs() < 1e-12 * before, "{now:?}");
            deepest = deepest.max(now.max_overlap);
        }
        deepest
    };
    let none = with(&|_| ());
    assert!(none > 0.05, "grains run into each other: {none}");
    let cut = with(&|remedies| remedies.max_travel = 0.02);
    assert!(cut < 0.05, "{cut}");
    let ahead = with(&|remedies| remedies.speculative = true);
    // What others deflect within the step is not seen ahead.
    assert!(ahead < none, "{ahead}");
    let pushed = with(&|remedies| remedies.push_out = true);
    assert!(pushed < 2.0 * none, "{pushed}");
    with(&|remedies| (remedies.sequential_impacts, remedies.calm_unsolved) = (true, true));
}

#[test]
fn an_elastic_gas_keeps_all_the_work_of_the_borders() {
    let mut scene = gas(20.0, 1.0, 0.0);
    scene.solver.tolerance = 1e-12;
    let mut run = start(&scene);
    let (before, mut work) = (run.observables().kinetic_energy, 0.0);
    for _ in 0..2000 {
        take_steps(&mut run, 1);
        work += run.observables().border_work.expect("it shears");
    }
    let gained = run.observables().kinetic_energy - before;
    assert_close(gained, work, 1e-8, "what it has gained");
    assert!(gained > 0.2 * before, "it is heated: {gained} {before}");
}

#[test]
fn a_dense_flow_takes_the_profile_of_the_borders_from_rest() {
    let rate = 20.0;
    let mut scene = gas(rate, 0.1, 0.5);
    for grain in &mut scene.grains {
        // They nearly fill the cell, and none goes along with the borders.
        (grain.radius, grain.velocity) =
            (0.0058, grain.velocity - rate * grain.position.y * DVec2::X);
    }
    scene.solver.tolerance = 1e-6;
    scene.parameters.time_step_secs = 2e-4;
    let mut run = start(&scene);
    let slope = |run: &Simulation| {
        let grains = run.grains();
        let of = |k: usize| (grains.positions[k].y - 0.5 * SIZE.y, grains.velocities[k].x);
        let pairs: Vec<_> = (0..grains.len()).map(of).collect();
        let squares: f64 = pairs.iter().map(|(y, _)| y * y).sum();
        let mean = pairs.iter().map(|(_, speed)| speed).sum::<f64>() / pairs.len() as f64;
        pairs.iter().map(|(y, speed)| y * (speed - mean)).sum::<f64>() / squares
    };
    assert!(slope(&run).abs() < 0.2 * rate, "{}", slope(&run));
    take_steps(&mut run, 500);
    let mut mean = 0.0;
    for _ in 0..20 {
        take_steps(&mut run, 25);
        mean += slope(&run) / 20.0;
    }
    assert!((mean / rate - 1.0).abs() < 0.15, "{mean} 1/s");
    assert_eq!(run.observables().lost_grains, 0);
}

#[test]
fn a_flow_twice_as_fast_takes_the_same_way_and_bears_four_times_as_much() {
    let run = |factor: f64| {
        let mut scene = gas(20.0 * factor, 0.5, 0.4);
        for grain in &mut scene.grains {
            let rest = grain.velocity - 20.0 * factor * grain.position.y * DVec2::X;
            (grain.radius, grain.velocity) = (0.0055, grain.velocity + (factor - 1.0) * rest);
        }
        scene.parameters.time_step_secs = 2e-4 / factor;
        scene.solver = to_residual(1e-8);
        let run = after(&scene, 400);
        run
    };
    let [one, other] = [1.0, 2.0].map(run);
    assert!(one.world().periodic.expect("a cell").shift != 0.0);
    let places = one.places().iter().zip(other.places());
    let farthest = places.map(|(one, other)| one.distance(*other)).fold(0.0, f64::max);
    assert!(farthest < 1e-9, "{farthest} m");
    let [one, other] = [one, other].map(|run| measure(&run.moment()).pile);
    assert!(one.stress_xy != 0.0);
    assert_close(other.stress_xy, 4.0 * one.stress_xy, 1e-6, "Bagnold's square");
}

#[test]
fn a_run_goes_on_from_a_file_bit_for_bit() {
    for stepper in Stepper::ALL {
        let mut scene = gas(20.0, 0.3, 0.3);
        (scene.stepper, scene.parameters.bond) = (*stepper, 5.0);
        let mut run = after(&scene, 300);
        let mut read = saved_and_read(&scene, &run).simulation;
        take_steps(&mut run, 150);
        take_steps(&mut read, 150);
        assert_eq!(run.world(), read.world(), "{stepper}");
        assert_eq!(run.observables(), read.observables(), "{stepper}");
    }
}

#[test]
fn measures_see_the_images_where_they_are() {
    let mut scene = gas(20.0, 0.3, 0.3);
    for grain in &mut scene.grains {
        grain.radius = 0.0055;
    }
    let run = after(&scene, 137);
    let cell = run.world().periodic.expect("a cell");
    assert!(cell.shift.abs() > 0.1 * SIZE.x, "{cell:?}");
    let moved = |by: DVec2| {
        let mut moment = run.moment();
        for grain in &mut moment.grains {
            grain.position = cell.wrap(grain.position + by);
        }
        measure(&moment).pile
    };
    let one = moved(DVec2::ZERO);
    assert!(one.closed_cells > 60, "{one:?}");
    for by in [DVec2::new(0.02, 0.07), DVec2::splat(0.05), DVec2::new(0.0, -0.03)] {
        let other = moved(by);
        assert_close(other.area, one.area, 1e-9, "the area of all cells");
        assert_eq!(other.closed_cells, one.closed_cells);
        assert_close(other.stress_xy, one.stress_xy, 1e-9, "the stress");
    }
    assert_close(one.area, SIZE.x * SIZE.y, 1e-9, "cells fill the cell");
    let folder = tempfile::tempdir().expect("a folder");
    let place = folder.path().join("run");
    let about: RunFacts = slump::config::scene_facts(&scene).expect("facts");
    let mut recording = Recording::start(&place, FormatName::ALL, &about, false).expect("a start");
    recording.add(run.moment()).expect("a frame");
    recording.finish().expect("an end");
    let dump = std::fs::read_to_string(place.join("ovito/grains.dump")).expect("a dump");
    let (low, high) = (cell.shift.min(0.0), SIZE.x + cell.shift.max(0.0));
    let bounds = format!(
        "ITEM: BOX BOUNDS xy xz yz pp pp ss\n{low:?} {high:?} {:?}\n0.0 0.1 0.0\n",
        cell.shift
    );
    assert!(dump.contains(&bounds), "{bounds}: {}", &dump[..2000.min(dump.len())]);
    let (_, rows) = dump.split_once("ITEM: ATOMS id type element x y ").expect("grains");
    let number = |word: Option<&str>| word.and_then(|word| word.parse().ok()).expect("a number");
    let place = |row: &str| {
        let mut words = row.split(' ').skip(3);
        DVec2::new(number(words.next()), number(words.next()))
    };
    let places: Vec<DVec2> = rows.lines().skip(1).map(place).collect();
    assert_eq!(places, run.grains().positions);
}

#[test]
fn an_image_that_slides_towards_discs_at_rest_is_found() {
    // Both rest, so that nothing but the border's way says that the pairs that were near are no longer those.
    for stepper in Stepper::ALL {
        let at = |x: f64, y: f64| moving(DVec2::new(x, y), 0.01, DVec2::ZERO);
        let grains = vec![at(0.03, 0.005), at(0.08, SIZE.y - 0.005)];
        let parameters = parameters(0.0, 1e-4, 0.0, 0.2);
        let mut scene = scene(Physics::FULL, DVec2::ZERO, parameters, grains);
        (scene.stepper, scene.periodic) = (*stepper, Some(cell(1.0)));
        let mut run = start(&scene);
        // The image goes 0.1 m/s, and after a third of a second it has gone three centimetres and meets the other.
        take_steps(&mut run, 2000);
        assert_eq!(run.observables().contacts, 0, "{stepper}: not yet");
        let mut met = 0;
        for _ in 0..2500 {
            take_steps(&mut run, 1);
            met = met.max(run.observables().contacts);
        }
        assert_eq!(met, 1, "{stepper}: they meet");
        let speeds = run.velocities();
        assert!(speeds[0].length() > 1e-3 && speeds[1].length() > 1e-3, "{stepper}: {speeds:?}");
    }
}
