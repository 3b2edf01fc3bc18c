//! Tests that Slump refuses scenes with impossible values in one sentence, and that good scenes are equal after writing
//! and reading.

use slump::config::{parse_discs, read_scene, scene_to_toml, write_discs};
use slump::error::Error;

use crate::common::*;
use crate::program::*;

fn good() -> Scene {
    let grains = vec![Grain::at_rest(DVec2::Y, 0.1), Grain::at_rest(2.0 * DVec2::Y, 0.1)];
    under_g(parameters(20.0, 1e-3, 0.1, 0.5), grains)
}

/// Applies the change `spoil` to a valid scene and checks that Slump refuses the changed scene with the expected
/// message.
#[track_caller]
fn check(spoil: impl FnOnce(&mut Scene), expected: &str) {
    let mut scene = good();
    scene.simulation().expect("it was good");
    spoil(&mut scene);
    assert_eq!(refused(&scene), expected);
}

#[test]
fn parameters_outside_their_range_are_named_with_value_and_range() {
    let dt = "but must be a finite number of seconds > 0";
    check(|s| s.parameters.time_step_secs = f64::NAN, &format!("dt is NaN, {dt}"));
    check(|s| s.parameters.time_step_secs = 0.0, &format!("dt is 0, {dt}"));
    check(|s| s.parameters.time_step_secs = -1e-3, &format!("dt is -0.001, {dt}"));
    check(|s| s.parameters.time_step_secs = f64::INFINITY, &format!("dt is inf, {dt}"));
    check(|s| s.parameters.restitution = 1.5, "rho is 1.5, but must be between 0 and 1");
    check(|s| s.parameters.restitution = -0.1, "rho is -0.1, but must be between 0 and 1");
    check(|s| s.parameters.restitution = f64::NAN, "rho is NaN, but must be between 0 and 1");
    check(|s| s.parameters.bond = -1.0, "bond is -1, but must be a finite number ≥ 0");
    check(|s| s.parameters.bond = f64::NAN, "bond is NaN, but must be a finite number ≥ 0");
    check(|s| s.parameters.friction = -0.5, "mu is -0.5, but must be a finite number ≥ 0");
    check(|s| s.solver.tolerance = 0.0, "tolerance is 0, but must be a finite number > 0");
    check(|s| s.solver.max_sweeps = 0, "max-sweeps is 0, but must be at least 1");
    let stiffness = "but must be a finite number of N/m ≥ 0; 0 takes it from the pile's weight";
    check(|s| s.parameters.stiffness = -1.0, &format!("stiffness is -1, {stiffness}"));
    check(|s| s.parameters.stiffness = f64::NAN, &format!("stiffness is NaN, {stiffness}"));
    let damping = "but must be a finite number ≥ 0; 0 takes it from the restitution";
    check(|s| s.parameters.damping_ratio = -0.1, &format!("damping-ratio is -0.1, {damping}"));
    check(
        |s| s.parameters.damping_ratio = f64::INFINITY,
        &format!("damping-ratio is inf, {damping}"),
    );
    check(
        |s| s.parameters.substeps = 100_001,
        "substeps is 100001, but must be at most 100000; 0 leaves it to the stepper",
    );
}

#[test]
fn a_running_simulation_refuses_them_too_and_keeps_what_it_had() {
    let mut simulation = good().simulation().expect("good");
    let before = *simulation.parameters();
    let spoilt = Parameters { restitution: 2.0, ..before };
    let error = simulation.set_parameters(spoilt).expect_err("outside its range");
    assert!(matches!(error, Error::Value { ref field, .. } if field == "rho"));
    assert_eq!(*simulation.parameters(), before);
    let settings = *simulation.solver();
    let spoilt = SolverSettings { tolerance: f64::NAN, ..settings };
    assert!(simulation.set_solver(spoilt).is_err());
    assert_eq!(*simulation.solver(), settings);
}

#[test]
fn bodies_and_lengths_outside_their_range_are_named() {
    let positive = |unit: &str| format!("but must be a finite number > 0 {unit}");
    for (value, shown) in [(f64::NAN, "NaN"), (0.0, "0"), (-2.0, "-2"), (f64::INFINITY, "inf")] {
        let is = |field: &str, unit: &str| format!("{field} is {shown}, {}", positive(unit));
        check(|s| s.grains[1].radius = value, &is("grains[1].radius", "m"));
        check(|s| s.areal_density = value, &is("areal_density", "kg/m²"));
        check(|s| s.duration_secs = value, &is("duration", "s"));
        check(|s| s.mean_diameter = value, &is("mean_diameter", "m"));
        let spoil = |s: &mut Scene| s.fixed_discs = vec![fixed(DVec2::ZERO, value)];
        check(spoil, &is("fixed_discs[0].radius", "m"));
    }
    check(|s| s.grains.clear(), "grains is 0, but must be at least one disc");
    // A scene whose lengths are not in metres is refused.
    for (factor, expected) in [
        (1e-3, ", a hundredth of the mean diameter of the grains"),
        (1e3, "100 times the diameter of the largest grain"),
    ] {
        let mut scene = good();
        scene.mean_diameter *= factor;
        let said = refused(&scene);
        assert!(said.starts_with("mean_diameter is ") && said.ends_with(expected), "{said}");
        let mut scene = good();
        scene.grains.iter_mut().for_each(|grain| grain.radius /= factor);
        let said = refused(&scene);
        assert!(said.starts_with("mean_diameter is ") && said.ends_with(expected), "{said}");
    }
    for spoil in [
        |grain: &mut Grain| grain.position.x = f64::NAN,
        |grain: &mut Grain| grain.velocity.y = f64::INFINITY,
        |grain: &mut Grain| grain.angular_velocity = f64::NAN,
    ] {
        let mut scene = good();
        spoil(&mut scene.grains[1]);
        let message = refused(&scene);
        assert!(message.starts_with("grains[1] is ") && message.ends_with("finite throughout"));
    }
    for tolerance in [-1e-9, f64::NAN, 0.1] {
        let mut scene = good();
        scene.gap_tolerance = tolerance;
        assert!(refused(&scene).starts_with(&format!("gap_tolerance is {tolerance}, but must be")));
    }
}

#[test]
fn gravity_that_is_none_is_refused() {
    let attraction =
        |magnitude: f64, x: f64| Gravity::Attraction { centre: DVec2::new(x, 0.0), magnitude };
    let uniform = Gravity::Uniform { acceleration: DVec2::new(f64::NAN, 0.0) };
    for gravity in
        [attraction(f64::NAN, 0.0), attraction(-2.0, 0.0), attraction(2.0, f64::NAN), uniform]
    {
        let mut scene = good();
        scene.gravity = gravity;
        assert!(refused(&scene).starts_with("gravity"), "{gravity:?}");
    }
}

#[test]
fn a_line_scene_off_its_line_is_refused() {
    let bad = |spoil: fn(&mut Scene), field: &str| {
        let mut scene = collision();
        spoil(&mut scene);
        let message = refused(&scene);
        assert!(message.starts_with(field), "{message}");
    };
    bad(|s| s.grains[0].position.y = 1e-9, "grains[0] is ");
    bad(|s| s.grains[0].velocity.y = 1.0, "grains[0] is ");
    bad(|s| s.fixed_discs[0].position.y = -1.0, "fixed_discs[0] is ");
    let segment = |s: &mut Scene| {
        s.boundaries = vec![Boundary::Segment { from: DVec2::X, to: 2.0 * DVec2::X }];
    };
    bad(segment, "boundaries[0] is ");
    bad(
        |s| s.physics.friction = true,
        "physics.friction is true, but must be false where physics.axes is 1",
    );
    check(|s| s.physics.axes = 3, "physics.axes is 3, but must be 1 or 2");
    check(
        |s| s.physics.friction = false,
        "physics.rotation is true, but must be false where physics.friction is false",
    );
}

#[test]
fn a_bad_line_of_discs_is_named() {
    let bad = |text: &str, expected: &str| {
        let error = parse_discs(text, Path::new("discs.csv")).expect_err("a bad line");
        let message = error.to_string();
        assert!(message.starts_with("discs.csv: "), "{message}");
        assert!(message.contains(expected) && !message.contains('\n'), "{message}");
    };
    bad("# made by hand\nx,y,radius\n0,0,1\n0,zero,1\n", "line 4: y: ");
    bad("x,y,radius\n0,0,1\n0,0,-1\n", "line 3: radius is -1");
    bad("x,y,radius\n0,0,nan\n", "line 2: radius is NaN");
    bad("x,y,radius\n\n0,inf,1\n", "line 3: y is inf");
    bad("x,y,radius\n# one\n0,0,1\n# two\n\n# three\n0,inf,1", "line 7: y is inf");
    bad("x,y,radius\r\n\r\n# one\r\n0,0,inf\r\n", "line 4: radius is inf");
    bad("x,y,radius\n0,0,1\n0,0\n", "line");
    bad("x,y,mass\n0,0,1\n", "'x,y,mass', but must be one that names x, y and radius");
    bad("x,y,radius,colour\n0,0,1,2\n", "colour");
    bad("x,y,radius\n", "no disc");
    bad("", "one that names x, y and radius");
}

/// Writes a text to a new file and reads the file as a scene.
fn read_text(text: &str) -> Result<Scene, String> {
    let folder = folder();
    let path = folder.path().join("test.toml");
    write(&path, text);
    read_scene(&path).map_err(|error| {
        let message = error.to_string();
        assert!(!message.trim_end().contains('\n'), "one sentence: {message}");
        message.replace(&path.display().to_string(), "test.toml")
    })
}

#[test]
fn a_bad_scene_file_names_its_line() {
    let text = scene_to_toml(&good()).expect("it can be written");
    let line_of = |start: &str| {
        let is = |line: &str| line.starts_with(start);
        1 + text.lines().position(is).unwrap_or_else(|| panic!("no {start} in\n{text}"))
    };
    let bad = |from: &str, to: &str, expected: &[&str]| {
        assert!(text.contains(from), "no {from} in\n{text}");
        let message = read_text(&text.replacen(from, to, 1)).expect_err("a fault");
        for part in expected {
            assert!(message.contains(part), "{part} in: {message}");
        }
    };
    let line = |start: &str| format!("test.toml: line {}: ", line_of(start));
    bad("bond = ", "bond == ", &[&line("bond")]);
    bad("bond = 20.0", "bond = \"much\"", &[&line("bond"), "much"]);
    bad("bond = ", "bondage = ", &[&line("bond"), "unknown field `bondage`"]);
    bad("axes = 2", "axes = 2\ncolour = 3", &["unknown field `colour`"]);
    bad("cone = \"shifted\"", "cone = \"round\"", &["round", "shifted"]);
    bad("radius = 0.1", "radius = 0.0", &["grains[0].radius is 0, but must be"]);
    bad("duration_secs", "#", &["missing field `duration_secs`"]);
    assert!(
        read_scene(Path::new("no/such.toml")).is_err_and(|e| e.to_string().contains("such.toml"))
    );
}

#[test]
fn grains_come_from_one_place() {
    let text = scene_to_toml(&good()).expect("it can be written");
    let with_source = format!("{text}\n[source]\nfrom = \"csv\"\npath = \"discs.csv\"\n");
    let message = read_text(&with_source).expect_err("two sources");
    assert!(message.starts_with("source is given, but must be left out"), "{message}");
    let unknown = with_source.replace("path = ", "colour = 1\npath = ");
    let message = read_text(&unknown).expect_err("no field of a source");
    assert!(message.contains("unknown field `colour`"), "{message}");
    let scene = Scene {
        source: Some(GrainSource::Csv { path: "absent.csv".into() }),
        grains: Vec::new(),
        ..good()
    };
    let message =
        read_text(&scene_to_toml(&scene).expect("it can be written")).expect_err("absent");
    assert!(message.contains("absent.csv"), "{message}");
}

#[test]
fn an_unknown_built_in_scene_is_told_of_with_those_there_are() {
    let message = built_in("heap").expect_err("no such scene").to_string();
    assert!(message.starts_with("scene is heap, but must be one of pile, cradle, collision"));
}

#[test]
fn every_built_in_scene_survives_its_own_file() {
    for info in SCENES {
        let scene = (info.make)().expect("a built-in scene");
        let text = scene_to_toml(&scene).expect("it can be written");
        assert_eq!(read_text(&text).expect("it can be read"), scene, "{}", info.name);
    }
    let points = || vec![DVec2::ZERO, DVec2::X, DVec2::ONE];
    let shapes = Scene {
        boundaries: vec![
            plane(DVec2::ZERO, DVec2::new(0.1, 0.3)),
            Boundary::Segment { from: DVec2::ZERO, to: DVec2::new(1.0 / 3.0, 0.0) },
            Boundary::Polyline { points: points() },
            Boundary::ConvexPolygon { points: points() },
        ],
        gravity: Gravity::Attraction { centre: DVec2::ONE, magnitude: 0.1 },
        ..good()
    };
    let text = scene_to_toml(&shapes).expect("it can be written");
    assert_eq!(read_text(&text).expect("it can be read"), shapes);
}

#[test]
fn written_discs_read_back_bit_for_bit() {
    let mut random = random(9);
    let mut number = || random.random_range(-1.0..1.0) * 10f64.powi(random.random_range(-12..12));
    for still in [true, false] {
        let grains: Vec<Grain> = (0..200)
            .map(|_| {
                let place = DVec2::new(number(), number());
                let velocity = DVec2::new(number(), number());
                let (radius, spin) = (number().abs(), number());
                if still {
                    return Grain::at_rest(place, radius);
                }
                Grain { angular_velocity: spin, ..moving(place, radius, velocity) }
            })
            .collect();
        let text = write_discs(&grains, "two lines\nof comment");
        let read = parse_discs(&text, Path::new("discs.csv")).expect("what was written");
        assert_eq!(read, grains);
        let bits = |grains: &[Grain]| -> Vec<u64> {
            let numbers = grains.iter().flat_map(|g| [g.position.x, g.position.y, g.radius]);
            numbers.map(f64::to_bits).collect()
        };
        assert_eq!(bits(&read), bits(&grains));
    }
}

/// The smallest valid scene file: it has only the required fields.
const LEAST: &str = "name = \"least\"
mean_diameter = 0.2
duration_secs = 1.0
[physics]
axes = 2
friction = true
rotation = true
cohesion = true
[gravity]
kind = \"uniform\"
acceleration = [0.0, -9.8]
[parameters]
bond = 0.0
time_step_secs = 1e-3
restitution = 0.1
friction = 0.5
[[grains]]
position = [0.0, 1.0]
radius = 0.1
";

#[test]
fn a_scene_file_that_says_the_least_has_all_defaults() {
    let grains = vec![Grain::at_rest(DVec2::Y, 0.1)];
    let expected = Scene {
        name: "least".into(),
        mean_diameter: 0.2,
        duration_secs: 1.0,
        stepper: Stepper::default(),
        solver: SolverSettings::default(),
        parameters: Parameters { restitution_threshold: 2.0, ..parameters(0.0, 1e-3, 0.1, 0.5) },
        ..under_g(Parameters::default(), grains)
    };
    assert_eq!(read_text(LEAST).expect("a scene"), expected);
    for left_out in LEAST.lines().filter(|line| line.contains(" = ")) {
        let lines = LEAST.lines().filter(|line| line != &left_out);
        let message = read_text(&lines.collect::<Vec<_>>().join("\n")).expect_err(left_out);
        let field = left_out.split(' ').next().expect("a name");
        assert!(message.contains(&format!("missing field `{field}`")), "{left_out}: {message}");
    }
}

#[test]
fn what_a_table_of_a_scene_file_leaves_out_has_its_default() {
    let table = |group: &dyn Fn() -> Result<toml::Table, toml::ser::Error>| group().expect("TOML");
    let solver = SolverSettings {
        method: Method::Nsgs,
        ordering: Ordering::Symmetric,
        stop: StopTest::Residual,
        tolerance: 1e-3,
        max_sweeps: 7,
        warm_start: false,
        friction_model: FrictionModel::Coulomb,
        model_solves: 2,
    };
    let remedies = Remedies {
        push_out: true,
        max_travel: 0.25,
        sequential_impacts: true,
        speculative: true,
        turning_bonds: true,
    };
    let parameters = Parameters {
        cone: FrictionCone::Compressive,
        restitution_threshold: 2.0,
        debonding_distance: 0.02,
        tilt: 10.0,
        stiffness: 100.0,
        damping_ratio: 0.5,
        substeps: 3,
        ..parameters(0.0, 1e-3, 0.1, 0.5)
    };
    let data = slump::data::DataSettings {
        folder: None,
        every_secs: Some(0.5),
        formats: vec![slump::data::FormatName::Csv],
    };
    let needed = &["bond", "time_step_secs", "restitution", "friction"];
    let groups: [(&str, toml::Table, &[&str]); 4] = [
        ("solver", table(&|| toml::Table::try_from(solver)), &[]),
        ("remedies", table(&|| toml::Table::try_from(remedies)), &[]),
        ("parameters", table(&|| toml::Table::try_from(parameters)), needed),
        ("data", table(&|| toml::Table::try_from(&data)), &[]),
    ];
    let least: toml::Table = toml::from_str(LEAST).expect("TOML");
    let read = |name: &str, table: toml::Table| {
        let whole = toml::Table::from_iter([(name.to_owned(), table.into())]);
        let others = least.clone().into_iter().filter(|(other, _)| other != name);
        let text = toml::to_string(&others.chain(whole).collect::<toml::Table>()).expect("TOML");
        read_text(&text).unwrap_or_else(|message| panic!("{message} in\n{text}"))
    };
    for (name, all, needed) in groups {
        assert!(all.len() >= 2, "{name}");
        let of_least = match least.get(name) {
            Some(toml::Value::Table(table)) => table.clone(),
            _ => toml::Table::new(),
        };
        let before = toml::Table::try_from(read(name, of_least.clone())).expect("TOML");
        for (field, value) in all.iter().filter(|(field, _)| !needed.contains(&field.as_str())) {
            let mut given = of_least.clone();
            given.insert(field.clone(), value.clone());
            let found = toml::Table::try_from(read(name, given)).expect("TOML");
            let mut expected = before.clone();
            let of_group = expected.entry(name).or_insert(toml::Table::new().into());
            let of_group = of_group.as_table_mut().expect("a table");
            of_group.insert(field.clone(), value.clone());
            for (other, expected) in of_group.iter() {
                assert_eq!(&found[name][other], expected, "{name}.{other} where {field} is given");
            }
        }
    }
}
