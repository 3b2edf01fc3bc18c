//! Checks that the recorded contact forces explain the change of the grains' momentum and the work of the periodic
//! borders.

use glam::DVec2;
use slump::data::{Frame, Table, Values};
use slump::sim::{ForceSums, Simulation, Stepper};
use slump::solver::{SolverSettings, StopTest};
use slump::world::Gravity;

use super::*;

fn numbers(table: &Table, name: &str) -> Vec<f64> {
    let column = table.columns.iter().find(|column| column.name == name);
    match &column.unwrap_or_else(|| panic!("no column {name}")).values {
        Values::Numbers(numbers) => numbers.clone(),
        Values::SomeNumbers(numbers) => {
            numbers.iter().map(|number| number.unwrap_or(f64::NAN)).collect()
        }
        Values::Counts(counts) => counts.iter().map(|&count| count as f64).collect(),
        other => panic!("{name} has {other:?}"),
    }
}

fn vectors(table: &Table, names: [&str; 2]) -> Vec<DVec2> {
    let [x, y] = names.map(|name| numbers(table, name));
    x.into_iter().zip(y).map(DVec2::from).collect()
}

/// Data of a frame: grains, and contacts of the last step or of all steps since the previous frame.
struct FrameTables {
    places: Vec<DVec2>,
    /// For each grain, the y coordinate of its unwrapped position (which continues across periodic borders) minus the y
    /// coordinate of its position in the periodic cell, m.
    brought_back: Vec<f64>,
    velocities: Vec<DVec2>,
    spins: Vec<f64>,
    radii: Vec<f64>,
    masses: Vec<f64>,
    /// Indices of the grains i and j of each contact; j is `None` if the other body is not a grain.
    pairs: Vec<(usize, Option<usize>)>,
    forces: Vec<DVec2>,
    tangential: Vec<f64>,
}

impl FrameTables {
    fn of(Frame { grains, moment, .. }: &Frame, contacts: &Table) -> Self {
        let count = moment.grains.len();
        let [i, j] = ["id_i", "id_j"].map(|name| numbers(contacts, name));
        let ends = i.into_iter().zip(j);
        let heights = numbers(grains, "y_unwrapped").into_iter().zip(numbers(grains, "y"));
        Self {
            places: vectors(grains, ["x", "y"]),
            brought_back: heights.map(|(unwrapped, y)| unwrapped - y).collect(),
            velocities: vectors(grains, ["vx", "vy"]),
            spins: numbers(grains, "omega"),
            radii: numbers(grains, "radius"),
            masses: numbers(grains, "mass"),
            pairs: ends
                .map(|(i, j)| (i as usize, Some(j as usize).filter(|&j| j < count)))
                .collect(),
            forces: vectors(contacts, ["fx", "fy"]),
            tangential: numbers(contacts, "tangential_force"),
        }
    }
}

/// Largest errors in all frames of a run, relative. Errors of momentum are divided by the largest impulse of a contact
/// between two frames, errors of angular momentum by the largest angular impulse on a grain. Errors of the work of the
/// sheared borders and of the stress are divided by the largest work of the borders.
#[derive(Debug, Default)]
struct Off {
    momentum: f64,
    spin: f64,
    border_work: f64,
    stress: f64,
    /// Number of contacts with a force that is not zero.
    contacts: usize,
    crossing: usize,
    /// Number of contacts that had a force since the previous frame but no longer exist in the frame itself.
    parted: usize,
}

const STRESSES: [&str; 4] = ["stress_xx", "stress_xy", "stress_yx", "stress_yy"];
const MEAN_STRESSES: [&str; 4] =
    ["mean_stress_xx", "mean_stress_xy", "mean_stress_yx", "mean_stress_yy"];

/// Compares two values of each stress component, in J·s: the mean stress of a frame (N/m) times the area and the
/// duration of the frame, and `summed`, the sum of stress times area times time step over the steps of the frame.
/// Returns the largest difference and the largest sum.
fn off_of_means(frame: &Frame, summed: [f64; 4]) -> [f64; 2] {
    let number = |name: &str| numbers(&frame.measures, name)[0];
    let areas = numbers(&frame.grains, "cell_area");
    let (mut off, mut largest) = (0f64, 0f64);
    for (name, summed) in MEAN_STRESSES.iter().zip(summed) {
        let of_pile = number("area") * number(name);
        let of_grains = numbers(&frame.grains, name);
        let of_grains = areas.iter().zip(of_grains).map(|(area, stress)| area * stress);
        let of_grains: f64 = of_grains.filter(|number| !number.is_nan()).sum();
        for found in [of_pile, of_grains] {
            off = off.max((number("mean_time") * found - summed).abs());
        }
        largest = largest.max(summed.abs());
    }
    let on_walls = vectors(&frame.walls, ["mean_fx", "mean_fy"]).into_iter().sum::<DVec2>();
    let fixed = numbers(&frame.pairs, "id_j").into_iter().map(|id| id as usize);
    let forces = fixed.zip(vectors(&frame.pairs, ["fx", "fy"]));
    let fixed = forces.filter(|(id, _)| *id >= frame.moment.grains.len()).map(|(_, force)| force);
    assert!((on_walls + fixed.sum::<DVec2>()).length() <= 1e-12 * on_walls.length(), "{on_walls}");
    [off, largest]
}

/// Runs this many frames, with `every` steps per frame. Returns the largest errors of the balances of momentum, work
/// and stress.
fn off_by(run: &mut Simulation, frames: usize, every: usize) -> Off {
    let mut off = Off::default();
    let mut sums = ForceSums::default();
    sums.follow(run);
    let frame = Frame::new(0, run.moment(), &sums.take());
    assert!(frame.pairs.is_empty() && numbers(&frame.measures, "mean_stress_xx")[0].is_nan());
    let mut before = FrameTables::of(&frame, &frame.contacts);
    let (mut largest_impulse, mut largest_torque, mut largest_work) = (0f64, 0f64, 0f64);
    for _ in 0..frames {
        let mut summed = [0.0; 4];
        for _ in 0..every {
            let secs = run.step().expect("a finite state").time_step_secs;
            sums.follow(run);
            let measures = Table::of_measures(&run.moment());
            let area = numbers(&measures, "area")[0];
            for (sum, name) in summed.iter_mut().zip(STRESSES) {
                *sum += secs * area * numbers(&measures, name)[0];
            }
        }
        let now = *run.observables();
        let frame = Frame::new(0, run.moment(), &sums.take());
        let secs = numbers(&frame.measures, "mean_time")[0];
        let of_step = FrameTables::of(&frame, &frame.contacts);
        let after = FrameTables::of(&frame, &frame.pairs);
        let there = |pair| of_step.pairs.contains(pair);
        off.parted += after.pairs.iter().filter(|&pair| !there(pair)).count();
        let [off_of_means, largest_stress] = off_of_means(&frame, summed);
        assert!(off_of_means <= EXACT * largest_stress, "{off_of_means} of {largest_stress}");
        let after = if every == 1 { of_step } else { after };
        let moment = &frame.moment;
        let world = run.world();
        let Gravity::Uniform { acceleration } = world.gravity else { panic!("uniform gravity") };
        let mut impulses: Vec<DVec2> = moment
            .grains
            .iter()
            .map(|grain| {
                f64::from(u8::from(grain.feels_gravity)) * secs * grain.mass * acceleration
            })
            .collect();
        let mut torques = vec![0.0; impulses.len()];
        let rows = after.pairs.iter().zip(&after.forces).zip(&after.tangential);
        for ((&(i, j), &force), &tangential) in rows.clone() {
            off.contacts += usize::from(force != DVec2::ZERO);
            impulses[i] += secs * force;
            largest_impulse = largest_impulse.max(secs * force.length());
            for grain in std::iter::once(i).chain(j) {
                torques[grain] -= secs * after.radii[grain] * tangential;
                largest_torque = largest_torque.max(torques[grain].abs());
            }
            if let Some(j) = j {
                impulses[j] -= secs * force;
            }
        }
        let cell = world.periodic.unwrap_or_default();
        let heights = |offset: f64| match cell.y {
            Some([low, high]) => (offset / (high - low)).round(),
            None => 0.0,
        };
        let mut crossing_work = 0.0;
        let mut change_of_moment = 0.0;
        for grain in 0..impulses.len() {
            // A grain that leaves through the upper border of a sheared cell comes back slower: the speed of the upper
            // image is subtracted.
            let crossed = heights(before.brought_back[grain] - after.brought_back[grain]);
            let slid = crossed * cell.border_speed() * DVec2::X;
            let unslid = after.velocities[grain] - slid;
            let (mass, radius) = (after.masses[grain], after.radii[grain]);
            let change = unslid - before.velocities[grain];
            off.momentum = off.momentum.max((mass * change - impulses[grain]).length());
            crossing_work +=
                0.5 * mass * (after.velocities[grain].length_squared() - unslid.length_squared());
            change_of_moment += before.places[grain].y * mass * change.x / secs;
            if run.physics().rotation {
                let spun = after.spins[grain] - before.spins[grain];
                let inertia = 0.5 * mass * radius * radius;
                off.spin = off.spin.max((inertia * spun - torques[grain]).abs());
            }
        }
        if let (Some(border_work), 1) = (now.border_work, every) {
            let mut through_contacts = 0.0;
            for ((&(i, j), &force), _) in rows {
                let Some(j) = j else { continue };
                let across = heights(before.places[i].y - before.places[j].y);
                off.crossing += usize::from(across != 0.0 && force != DVec2::ZERO);
                through_contacts += secs * cell.border_speed() * across * force.x;
            }
            let measures = &frame.measures;
            let [area, stress] = ["area", "stress_xy"].map(|name| numbers(measures, name)[0]);
            // Σ y F_x over the grains (height times horizontal force) is Σ f_x ℓ_y over the contacts (force times
            // height of the branch vector), plus one cell height for each contact across the border.
            let by_stress = secs * cell.shear_rate * (change_of_moment - area * stress);
            largest_work = largest_work.max(through_contacts.abs());
            let found = through_contacts + crossing_work;
            off.border_work = off.border_work.max((found - border_work).abs());
            off.stress = off.stress.max((by_stress - through_contacts).abs());
        }
        before = after;
    }
    off.momentum /= largest_impulse;
    off.spin /= largest_torque.max(f64::MIN_POSITIVE);
    off.border_work /= largest_work.max(f64::MIN_POSITIVE);
    off.stress /= largest_work.max(f64::MIN_POSITIVE);
    off
}

/// Largest allowed relative error of the balances of momentum, energy, work and stress; it allows for rounding.
const EXACT: f64 = 1e-10;

/// Test cases: scene, Bond number, time step (s), number of steps before the comparison, and number of compared steps.
const CASES: [(&str, f64, f64, u64, usize); 10] = [
    ("pile", 0.0, 1e-3, 20, 30),
    // These steps are divided into substeps.
    ("pile", 50.0, 5e-3, 5, 20),
    ("pile", 20.0, 1e-3, 20, 30),
    ("collapse", 0.0, 5e-4, 60, 20),
    ("drum", 0.0, 1e-3, 150, 30),
    ("shear", 1.0, 2e-4, 300, 20),
    ("shear-periodic", 0.0, 1e-3, 60, 60),
    ("shear-periodic", 5.0, 1e-3, 60, 60),
    ("vibrated", 0.0, 1e-3, 60, 30),
    ("newtons-cradle", 0.0, 1e-3, 0, 800),
];

fn case(
    stepper: Stepper,
    (name, bond, time_step_secs, ..): (&str, f64, f64, u64, usize),
) -> Option<Simulation> {
    let mut scene = scene(name);
    scene.stepper = stepper;
    scene.parameters.bond = bond;
    scene.parameters.time_step_secs = time_step_secs;
    scene.solver = SolverSettings { stop: StopTest::Residual, tolerance: 1e-6, ..scene.solver };
    scene.simulation().ok()
}

#[test]
fn forces_between_two_frames_are_the_grains_change_and_the_borders_work() {
    for &stepper in Stepper::ALL {
        for of_case in CASES {
            let Some(mut run) = case(stepper, of_case) else { continue };
            let (name, bond, _, until, steps) = of_case;
            run.take_steps(until).expect("finite states");
            let off = off_by(&mut run, steps, 1);
            let what = format!("{stepper}, {name} at Bond {bond}: {off:?}");
            assert!(off.contacts > 0, "{what}");
            assert!(off.crossing > 100 || name != "shear-periodic", "{what}");
            assert!(off.border_work < EXACT, "{what}");
            if stepper == Stepper::Avbd {
                // The stepper `avbd` does not conserve momentum: a body feels a force before the other body of the
                // contact has reacted.
                assert!(off.momentum > EXACT, "{what}");
                continue;
            }
            assert!(off.momentum < EXACT && off.spin < EXACT, "{what}");
            // The stress uses one branch vector per contact and step, but under `dem` the branch vector changes from
            // substep to substep.
            let of_stress = if stepper == Stepper::Dem { 0.01 } else { EXACT };
            assert!(off.stress < of_stress, "{what}");
        }
    }
}

#[test]
fn means_between_two_frames_are_the_grains_change_though_contacts_have_opened() {
    for &stepper in Stepper::ALL {
        let mut parted = 0;
        for of_case in CASES {
            let Some(mut run) = case(stepper, of_case) else { continue };
            let (name, bond, _, until, steps) = of_case;
            run.take_steps(until).expect("finite states");
            let off = off_by(&mut run, steps.div_ceil(15), 15);
            parted += off.parted;
            let what = format!("{stepper}, {name} at Bond {bond}: {off:?}");
            let is_exact = off.momentum < EXACT && off.spin < EXACT;
            assert!(off.contacts > 0 && (is_exact || stepper == Stepper::Avbd), "{what}");
        }
        assert!(parted > 20, "{stepper}: {parted} pairs have parted");
    }
}

#[test]
fn energies_close_as_columns_say() {
    let mut run = scene("pile").simulation().expect("a scene");
    run.take_steps(20).expect("finite states");
    let secs = run.parameters().time_step_secs;
    let Gravity::Uniform { acceleration } = run.world().gravity else { panic!("uniform gravity") };
    let work_of_momentum = |run: &Simulation| {
        let grains = &run.world().grains;
        let momenta = grains.masses.iter().zip(&grains.velocities);
        let momentum: DVec2 = momenta.map(|(&mass, &velocity)| mass * velocity).sum();
        0.5 * secs * acceleration.dot(momentum)
    };
    let mut largest = 0f64;
    for _ in 0..30 {
        let (before, then) = (*run.observables(), work_of_momentum(&run));
        let now = *run.step().expect("a finite state");
        let works = now.normal_work + now.tangential_work + now.gravity_work;
        let kinetic = now.kinetic_energy - before.kinetic_energy;
        let potential = now.potential_energy - before.potential_energy;
        assert!((kinetic - works).abs() < EXACT * now.kinetic_energy, "{kinetic} {works}");
        let rest = work_of_momentum(&run) - then;
        let found = potential + now.gravity_work;
        assert!((found + rest).abs() < EXACT * now.potential_energy, "{found} {rest}");
        largest = largest.max(rest.abs() / now.gravity_work.abs());
    }
    assert!(largest > 1e-3, "the two differ: {largest}");
}

#[test]
fn kinetic_energy_changes_by_four_works_whatever_moves() {
    for &stepper in Stepper::ALL {
        let mut worst = 0f64;
        for of_case in CASES {
            let Some(mut run) = case(stepper, of_case) else { continue };
            let (mut missing, mut largest) = (0f64, 0f64);
            for _ in 0..of_case.3 + of_case.4 as u64 {
                let before = run.observables().kinetic_energy;
                let now = run.step().expect("a finite state");
                let works = now.normal_work + now.tangential_work + now.gravity_work;
                let works = works + now.border_work.unwrap_or(0.0);
                missing = missing.max((now.kinetic_energy - before - works).abs());
                largest = largest.max(now.kinetic_energy);
            }
            worst = worst.max(missing / largest);
        }
        // The stepper `avbd` sets positions and derives the velocities from them, so its energy balance has an error.
        let allowed = if stepper == Stepper::Avbd { 0.01..0.1 } else { 0.0..EXACT };
        assert!(allowed.contains(&worst), "{stepper}: {worst}");
    }
}

#[test]
fn pieces_of_a_step_add_up_too() {
    let mut scene = scene("pile");
    scene.parameters.time_step_secs = 5e-3;
    scene.remedies.max_travel = 0.05;
    for stepper in [Stepper::Moreau, Stepper::Range] {
        scene.stepper = stepper;
        let mut run = scene.simulation().expect("a scene");
        run.take_steps(5).expect("finite states");
        let off = off_by(&mut run, 20, 1);
        assert!(
            off.contacts > 50 && off.momentum < EXACT && off.spin < EXACT,
            "{stepper}: {off:?}"
        );
    }
}

#[test]
fn fixed_discs_that_move_are_recorded_as_they_go() {
    let mut turned = 0.0;
    for name in ["drum", "shear"] {
        let mut run = scene(name).simulation().expect("a scene");
        run.take_steps(50).expect("finite states");
        let (grains, secs) = (run.moment().grains.len(), run.parameters().time_step_secs);
        let before = Table::of_grains(&run.moment());
        run.step().expect("a finite state");
        let after = Table::of_grains(&run.moment());
        let mut fastest = 0f64;
        for disc in grains..after.len() {
            let [from, to] = [&before, &after].map(|it| vectors(it, ["x", "y"])[disc]);
            let cell = run.world().periodic.unwrap_or_default();
            let way = cell.shortest(to - from);
            let velocity = vectors(&after, ["vx", "vy"])[disc];
            // On a circle the mean velocity of a step differs from the velocity at its end by about ½ωΔt times the
            // speed (ω: angular velocity).
            let spin = numbers(&after, "omega")[disc];
            let bend = (0.51 * secs * spin.abs() + 1e-9) * velocity.length();
            assert!((way / secs).distance(velocity) <= bend + 1e-12, "{name} {disc}: {velocity}");
            let [from, to] = [&before, &after].map(|it| numbers(it, "angle")[disc]);
            assert!((to - from - secs * spin).abs() < 1e-12, "{name} {disc}: {spin}");
            turned += to.abs();
            fastest = fastest.max(velocity.length());
        }
        assert!(fastest > 0.01, "{name}: {fastest}");
    }
    assert!(turned > 0.0, "the drum turned");
}

#[test]
fn walls_tell_of_strain_force_and_work() {
    // Forces and works at the floor, the sides and the lid of a biaxial test.
    let mut run = scene("biaxial").simulation().expect("a scene");
    let before = Table::of_walls(&run.moment());
    run.take_steps(600).expect("finite states");
    let walls = Table::of_walls(&run.moment());
    assert_eq!(numbers(&walls, "motion")[..3], [0.0, 1.0, 2.0]);
    let names = walls.columns.iter().find(|column| column.name == "name").map(|it| &it.values);
    let Some(Values::Words { words, .. }) = names else { panic!("{names:?}") };
    assert_eq!(words, &["half-space 1", "half-space 2", "half-space 3", "half-space 0"]);
    let [left, right, lid, floor] = [0, 1, 2, 3].map(|wall| {
        let way = vectors(&walls, ["x", "y"])[wall] - vectors(&before, ["x", "y"])[wall];
        (way, vectors(&walls, ["fx", "fy"])[wall], numbers(&walls, "work")[wall])
    });
    assert!(left.0.x > 0.0 && right.0.x < 0.0 && lid.0.y < 0.0 && floor.0 == DVec2::ZERO);
    assert!(left.1.x < 0.0 && right.1.x > 0.0 && lid.1.y > 0.0 && floor.1.y < 0.0);
    assert!(lid.2 > 0.0 && floor.2 == 0.0, "{lid:?}");

    // The torque of a drum times its angular velocity ω is its work in the table. Steps report nearly the same work:
    // they also count the inward component ½ω²Δt·R of the wall's mean velocity (R: radius of the drum), which is of
    // first order in Δt.
    let off = |time_step_secs: f64| {
        let mut drum = scene("drum");
        drum.parameters.time_step_secs = time_step_secs;
        let mut run = drum.simulation().expect("a scene");
        run.take_steps((0.2 / time_step_secs).round() as u64).expect("finite states");
        let walls = Table::of_walls(&run.moment());
        let [torque, spin, work] = ["torque", "omega", "work"].map(|name| numbers(&walls, name)[0]);
        let by_torque = -time_step_secs * torque * spin;
        assert!((work - by_torque).abs() < 1e-9 * work.abs(), "{work} {torque} {spin}");
        (work - run.observables().wall_work).abs() / work.abs()
    };
    let offs = [1e-3, 2.5e-4, 1e-4].map(off);
    assert!(offs[0] < 0.05 && offs[1] < 0.4 * offs[0], "{offs:?}");
}

#[test]
fn walls_have_the_work_and_torque_of_all_steps_between_two_frames() {
    // The works in the table equal the works of the steps, with two exceptions. Walls driven by a force (scene
    // `biaxial`) have two speeds in a step. For a turning wall, the table uses the sliding velocity at the end of each
    // step, and the step uses the sliding velocity at its beginning.
    for (name, bond, time_step_secs, off_by, off_torque) in [
        ("vibrated", 0.0, 1e-3, 1e-10, 0.0),
        ("biaxial", 0.0, 1e-3, 5e-3, 0.0),
        ("drum", 10.0, 1e-3, 1e-5, 0.02),
        ("drum", 10.0, 2.5e-4, 2.5e-6, 0.005),
    ] {
        let mut scene = scene(name);
        scene.parameters.time_step_secs = time_step_secs;
        scene.parameters.bond = bond;
        let mut run = scene.simulation().expect("a scene");
        let steps_in = |secs: f64| (secs / time_step_secs).round() as u64;
        run.take_steps(steps_in(0.2)).expect("finite states");
        let mut sums = ForceSums::default();
        sums.follow(&run);
        let (mut works, mut size) = (0.0, 0.0);
        for _ in 0..steps_in(0.04) {
            let work = run.step().expect("a finite state").wall_work;
            works += work;
            size += work.abs();
            sums.follow(&run);
        }
        let frame = Frame::new(0, run.moment(), &sums.take());
        let found = numbers(&frame.walls, "work_between");
        let off = (found.iter().sum::<f64>() - works).abs() / size;
        assert!(size > 0.0 && off < off_by, "{name}: {off} of {works}, {found:?}");
        if name == "drum" {
            let [torque, spin] =
                ["mean_torque", "omega"].map(|name| numbers(&frame.walls, name)[0]);
            let by_torque = -0.04 * torque * spin;
            assert!(
                (by_torque - found[0]).abs() < off_torque * works.abs(),
                "{by_torque} {found:?}"
            );
        }
    }
}
