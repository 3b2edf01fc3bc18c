//! Tests of periodic cells (at the sides, in both directions, and sheared): pairs across borders behave like other
//! pairs, momentum is conserved, measured quantities do not depend on the position of the borders, and files store the
//! cell.

use super::periodic::{SIDE, SQUARE, falling, sliding};
use super::sheared::{SIZE, cell, gas as sheared_gas, ways};
use super::{saved_and_read, through_a_file};
use crate::common::*;

/// Returns a scene of moving discs between a frictionless floor and ceiling in a cell that is periodic in x or, if
/// `all_round` is true, in a cell that is periodic in both directions. The diameter of every third disc is `small`
/// times 0.01 m, the diameter of all others 0.0095 m.
pub(super) fn gas(small: f64, all_round: bool) -> Scene {
    let mut random = random(5);
    let (spacing, fall) = if all_round { (1.2, 0.3) } else { (1.1, 0.0) };
    let grains = (0..80).map(|k| {
        let place = DVec2::new(0.5 + f64::from(k % 10), 0.6 + spacing * f64::from(k / 10));
        let mut component = || random.random_range(-1.0..=1.0);
        let velocity = DVec2::new(component() + 0.5, component() - fall);
        moving(0.01 * place, 0.005 * if k % 3 == 0 { small } else { 0.95 }, velocity)
    });
    let mut scene = without_g(parameters(0.0, 1e-4, 1.0, 0.0), grains.collect());
    scene.mean_diameter = 0.01;
    scene.periodic = Some(if all_round { SQUARE } else { Periodic::along_x([0.0, SIDE]) });
    if !all_round {
        scene.boundaries = vec![level(), plane(0.1 * DVec2::Y, DVec2::NEG_Y)];
    }
    scene
}

#[test]
fn the_momentum_of_a_gas_along_its_periods_stays_and_no_grain_is_lost() {
    for (small, axes) in [(0.9, 1), (0.15, 1), (0.9, 2), (0.15, 2)] {
        let what = format!("{small}, {axes} periods");
        let mut run = start(&gas(small, axes == 2));
        let (before, mut crossings) = (momentum(&run), [0; 2]);
        take_steps(&mut run, 1);
        let energy = run.observables().kinetic_energy;
        for _ in 0..3000 {
            let places = run.places().to_vec();
            take_steps(&mut run, 1);
            for (old, new) in places.iter().zip(run.places()) {
                for axis in 0..axes {
                    assert!((0.0..SIDE).contains(&new[axis]), "{what}: {new}");
                    crossings[axis] += u32::from((old[axis] - new[axis]).abs() > 0.5 * SIDE);
                }
            }
        }
        assert!(crossings[..axes].iter().all(|count| *count > 100), "{what}: {crossings:?}");
        let after = momentum(&run);
        if axes == 2 {
            assert!(after.distance(before) < 1e-12 * before.length(), "{what}: {before} {after}");
            assert_close(run.observables().kinetic_energy, energy, 1e-9, &what);
        } else {
            assert_close(after.x, before.x, 1e-12, &what);
        }
        assert_eq!(run.observables().lost_grains, 0, "{what}");
        assert!(run.observables().max_overlap < 0.05, "{what}: {:?}", run.observables());
    }
}

#[test]
fn every_pair_in_touch_is_found_across_borders_and_none_twice() {
    let mut sheared = sheared_gas(30.0, 0.9, 0.3);
    for grain in sheared.grains.iter_mut().step_by(3) {
        grain.radius *= 0.2;
    }
    for (name, scene, steps) in [
        ("sides", gas(0.9, false), 800),
        ("sides, sizes", gas(0.15, false), 800),
        ("all round", gas(0.9, true), 1500),
        ("all round, sizes", gas(0.15, true), 1500),
        ("sheared", sheared, 1500),
    ] {
        let (mut run, mut across) = (start(&scene), [0; 2]);
        let tolerance = scene.parameters.touch_tolerance * scene.mean_diameter;
        for _ in 0..steps {
            let (grains, cell) = (run.grains().clone(), run.world().periodic.expect("a cell"));
            take_steps(&mut run, 1);
            let [width, height] = cell.periods();
            let rows = if height.is_some() { -1..=1 } else { 0..=0 };
            let image = |above: i32, beside: i32| {
                let (above, beside) = (f64::from(above), f64::from(beside));
                let x = beside * width.expect("a width") + above * cell.shift;
                DVec2::new(x, above * height.unwrap_or_default())
            };
            let mut expected = Vec::new();
            for i in 0..grains.len() {
                for j in i + 1..grains.len() {
                    let apart = grains.positions[i] - grains.positions[j];
                    let reach = grains.radii[i] + grains.radii[j] + tolerance;
                    for (above, beside) in
                        rows.clone().flat_map(|above| (-2..=2).map(move |beside| (above, beside)))
                    {
                        if (apart - image(above, beside)).length() < reach {
                            across[0] += u32::from(beside != 0);
                            across[1] += u32::from(above != 0);
                            expected.push((i as u32, j as u32));
                        }
                    }
                }
            }
            let contacts = run.contacts().contacts().iter();
            let pairs = contacts.map(|contact| (contact.grain, contact.other));
            let found: Vec<_> = pairs.filter(|pair| (pair.1 as usize) < grains.len()).collect();
            assert_eq!(found, expected, "{name}");
        }
        let least = if scene.periodic.is_some_and(|cell| cell.y.is_some()) { 20 } else { -1 };
        assert!(across[0] > 20 && i64::from(across[1]) > least, "{name}: {across:?}");
    }
}

/// Returns the velocity of the second disc, or of its periodic image nearest to the first disc, relative to the first
/// disc, m/s.
fn seen(run: &Simulation) -> DVec2 {
    let cell = run.world().periodic.expect("a cell");
    let above = ((run.place(0).y - run.place(1).y) / SIZE.y).round();
    run.velocity(1) + above * cell.shear_rate * SIZE.y * DVec2::X - run.velocity(0)
}

#[test]
fn a_pair_that_meets_across_a_border_is_a_pair_that_meets_inside() {
    let at = DVec2::new;
    let (round, slid) = ([DVec2::ZERO, at(0.5, 0.0), at(0.0, 0.5)], at(0.5, 1.0));
    for (name, periodic, parts) in [
        ("sides", Periodic::along_x([0.0, SIZE.x]), vec![at(0.0, 0.5)]),
        ("all round", cell(0.0), round.to_vec()),
        ("sheared", cell(3.0), vec![DVec2::ZERO, at(0.5, 0.0), slid, DVec2::ONE]),
        ("sheared back", cell(-3.0), vec![DVec2::ZERO, at(0.5, 0.0), slid, DVec2::ONE]),
    ] {
        let slides = periodic.shear_rate != 0.0;
        let exact = if slides { [1e-9, 1e-7] } else { [1e-12, 1e-9] };
        for (stepper, method) in if slides { ways().collect() } else { every_way() } {
            let met = |part: DVec2| {
                let disc = |x: f64, y: f64, speed: f64| {
                    moving(at(x, y) + part * SIZE, 0.01, speed * DVec2::ONE)
                };
                let discs = vec![disc(-0.0073, -0.0071, 0.3), disc(0.0073, 0.0072, -0.1)];
                let mut pair = without_g(parameters(0.0, 1e-3, 0.5, 0.4), discs);
                for grain in pair.grains.iter_mut().filter(|_| !slides) {
                    grain.position = periodic.wrap(grain.position);
                }
                (pair.periodic, pair.stepper, pair.solver.method) =
                    (Some(periodic), stepper, method);
                after(&through_a_file(&pair), 20)
            };
            let inside = met(DVec2::splat(0.5));
            let what = format!("{name}, {stepper} {method}");
            assert!(seen(&inside).x > -0.35, "{what}: they met: {}", seen(&inside));
            for &part in &parts {
                let across = met(part);
                let [one, other] = [&inside, &across].map(seen);
                assert!(one.distance(other) < exact[0], "{what} {part}: {one} {other}");
                for k in 0..2 {
                    let [one, other] = [&inside, &across].map(|run| run.velocity(k));
                    assert!(slides || one.distance(other) < exact[0], "{what}: {one} {other}");
                    let [one, other] =
                        [&inside, &across].map(|run| run.grains().angular_velocities[k]);
                    assert!((one - other).abs() < exact[1], "{what} {part}: {one} {other} rad/s");
                }
                let [one, other] = [&inside, &across].map(|run| {
                    let cell = run.world().periodic.expect("a cell");
                    cell.shortest(run.place(0) - run.place(1))
                });
                assert!(one.distance(other) < 1e-10, "{what} {part}: {one} {other}");
            }
        }
    }
}

#[test]
fn runs_go_on_from_a_file_bit_for_bit_across_crossings() {
    let mut sheared = sheared_gas(20.0, 0.3, 0.3);
    sheared.parameters.bond = 5.0;
    for &stepper in Stepper::ALL {
        for (name, scene, before, later) in [
            ("sliding", sliding(5.0), 40, 60),
            ("falling", falling(5.0), 400, 200),
            ("sheared", sheared.clone(), 300, 150),
        ] {
            let scene = Scene { stepper, ..scene };
            let mut run = after(&scene, before);
            let mut read = saved_and_read(&scene, &run).simulation;
            let begun = run.world().fixed_discs.clone();
            take_steps(&mut run, later);
            take_steps(&mut read, later);
            assert_eq!(run.world(), read.world(), "{stepper}, {name}");
            assert_eq!(run.observables(), read.observables(), "{stepper}, {name}");
            let ways = begun.iter().zip(&run.world().fixed_discs);
            let jumps = ways.filter(|(old, new)| (old.position.x - new.position.x).abs() > 0.03);
            assert!(name != "sliding" || jumps.count() > 0, "{stepper}: a disc crossed");
            assert!(name != "falling" || run.observables().lost_grains == 0, "{stepper}");
        }
    }
    let mut still = falling(0.0);
    still.motions.clear();
    assert_eq!(after(&still, 600).observables().lost_grains, 0, "nothing moves by itself");
}

/// Moves all discs of a run by the same vector (m) within the periodic cell. Returns the measured quantities.
fn moved(run: &Simulation, by: DVec2) -> MomentMeasures {
    let (mut moment, cell) = (run.moment(), run.world().periodic.expect("a cell"));
    moment.grains.iter_mut().for_each(|grain| grain.position = cell.wrap(grain.position + by));
    for disc in &mut std::sync::Arc::make_mut(&mut moment.surroundings).fixed_discs {
        disc.position = cell.wrap(disc.position + by);
    }
    measure(&moment)
}

#[test]
fn measures_do_not_depend_on_where_the_borders_are() {
    let mut round = gas(0.9, true);
    round.parameters.restitution = 0.5;
    let mut sheared = sheared_gas(20.0, 0.3, 0.3);
    sheared.grains.iter_mut().for_each(|grain| grain.radius = 0.0055);
    let run = after(&sheared, 137);
    let shift = run.world().periodic.expect("a cell").shift;
    assert!(shift.abs() > 0.1 * SIZE.x, "{shift}");
    let period = sliding(0.0).periodic.and_then(|cell| cell.periods()[0]).expect("a width");
    let far = [DVec2::new(0.02, 0.07), DVec2::splat(0.05), DVec2::new(0.0, -0.03)];
    for (name, run, closed, ways, box_area) in [
        (
            "sides",
            after(&sliding(0.0), 200),
            5,
            [0.2, 0.5, 0.77].map(|it| it * period * DVec2::X),
            None,
        ),
        ("all round", after(&round, 50), 20, far, Some(SIDE * SIDE)),
        ("sheared", run, 60, far, Some(SIZE.x * SIZE.y)),
    ] {
        let one = moved(&run, DVec2::ZERO);
        assert!(one.pile.closed_cells > closed, "{name}: {:?}", one.pile);
        if let Some(area) = box_area {
            let found = if name == "sheared" { one.pile.area } else { one.pile.box_area };
            assert_close(found, area, if name == "sheared" { 1e-9 } else { 1e-12 }, name);
        }
        for by in ways {
            let other = moved(&run, by);
            let found = |measured: &MomentMeasures| {
                let PileMeasures { area, stress_yy, stress_xy, .. } = measured.pile;
                let of_grains = measured.grains.iter().map(|grain| grain.solid_fraction);
                let more = [measured.pile.box_area, measured.pile.solid_fraction_cells];
                let of_sides = more.into_iter().chain(of_grains).filter(|_| name == "sides");
                [area, stress_yy, stress_xy].into_iter().chain(of_sides).collect::<Vec<f64>>()
            };
            for (k, (one, other)) in found(&one).into_iter().zip(found(&other)).enumerate() {
                assert!(one.is_nan() == other.is_nan(), "{name}, {by}: measure {k}");
                if !one.is_nan() {
                    assert_close(other, one, 1e-9, &format!("{name}, measure {k} moved by {by}"));
                }
            }
            assert_eq!(other.pile.closed_cells, one.pile.closed_cells, "{name}");
        }
    }
}

#[test]
fn recordings_say_where_the_borders_are_and_are_a_start() {
    use slump::data::{FormatName, Recording, read_grains};
    let sheared = sheared_gas(20.0, 0.3, 0.3);
    for (name, scene, steps) in
        [("sides", sliding(0.0), 100), ("all round", gas(0.9, true), 50), ("sheared", sheared, 137)]
    {
        let run = after(&scene, steps);
        let folder = tempfile::tempdir().expect("a folder");
        let place = folder.path().join("run");
        let about = slump::config::scene_facts(&scene).expect("facts");
        let recording = Recording::start(&place, FormatName::ALL, &about, false);
        let mut recording = recording.expect("a start");
        recording.add(run.moment()).expect("a frame");
        recording.finish().expect("an end");
        let cell = run.world().periodic.expect("a cell");
        let ([left, right], shift) = (cell.x.expect("borders"), cell.shift);
        let (low, high) = (shift.min(0.0), SIZE.x + shift.max(0.0));
        let bounds = match name {
            "sides" => format!("pp ss ss\n{left:?} {right:?}\n"),
            "all round" => "pp pp ss\n0.0 0.1\n0.0 0.1\n".to_owned(),
            _ => format!("xy xz yz pp pp ss\n{low:?} {high:?} {shift:?}\n0.0 0.1 0.0\n"),
        };
        let dump = std::fs::read_to_string(place.join("ovito/grains.dump")).expect("a dump");
        let said = &dump[..2000.min(dump.len())];
        assert!(dump.contains(&format!("ITEM: BOX BOUNDS {bounds}")), "{name}, {bounds}: {said}");
        let (_, rows) = dump.split_once("ITEM: ATOMS id type element x y ").expect("grains");
        let number = |word: Option<&str>| word.and_then(|it| it.parse().ok()).expect("a number");
        let of_row = |row: &str| {
            let mut words = row.split(' ').skip(3);
            DVec2::new(number(words.next()), number(words.next()))
        };
        let places: Vec<DVec2> = rows.lines().skip(1).map(of_row).collect();
        assert!(places.starts_with(run.places()), "{name}");
        let (columns, rows) = rows.split_once('\n').expect("rows");
        assert_eq!(columns.ends_with(" ix iy iz"), name != "sheared", "{name}: {columns}");
        if name != "sheared" {
            let width = cell.periods().map(|period| period.unwrap_or(0.0));
            let moment = run.moment();
            let mut gone = 0;
            for (row, grain) in rows.lines().zip(&moment.grains) {
                let images: Vec<f64> = row.rsplit(' ').take(3).map(|it| number(Some(it))).collect();
                let away = DVec2::new(images[2] * width[0], images[1] * width[1]);
                assert!(
                    (grain.position + away - grain.unwrapped).length() < 1e-12,
                    "{name}: {row}"
                );
                gone += usize::from(away != DVec2::ZERO);
            }
            assert!(gone > 0, "{name}: no grain left its cell");
        }
        let manifest = std::fs::read_to_string(place.join("data.json")).expect("a manifest");
        assert!(manifest.contains("periodic"), "{name}: {manifest}");
        let read = read_grains(&place, None).expect("grains").grains;
        assert!(read.iter().map(|grain| grain.position).eq(run.places().iter().copied()), "{name}");
    }
}
