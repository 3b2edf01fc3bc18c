//! Tests of initial states that are read from recordings.

use slump::config::{Config, SceneSource};
use slump::data::{RecordedGrains, read_grains};
use slump::sim::GrainState;
use slump::world::{Disc, Grain};

use super::tables::{csv, parquet};
use super::*;

/// Returns the bit patterns of all numbers of an initial state that was read from a recording.
fn bits(grains: &RecordedGrains) -> Vec<u64> {
    let of = |grain: &Grain| {
        let (place, velocity) = (grain.position, grain.velocity);
        [place.x, place.y, grain.radius, velocity.x, velocity.y, grain.angular_velocity]
    };
    with_fixed(grains.grains.iter().flat_map(of), &grains.fixed_discs)
}

fn bits_of_moment(moment: &Moment) -> Vec<u64> {
    let of = |grain: &GrainState| {
        let (place, velocity) = (grain.position, grain.velocity);
        [place.x, place.y, grain.radius, velocity.x, velocity.y, grain.angular_velocity]
    };
    let moving = moment.grains.iter().filter(|grain| !grain.lost).flat_map(of);
    with_fixed(moving, &moment.surroundings.fixed_discs)
}

fn with_fixed(moving: impl Iterator<Item = f64>, fixed: &[Disc]) -> Vec<u64> {
    let fixed = fixed.iter().flat_map(|it| [it.position.x, it.position.y, it.radius]);
    moving.chain(fixed).map(f64::to_bits).collect()
}

/// Records the pile. Returns its states after the steps 10, 20, …, 60.
fn recorded_pile(folder: &Path) -> Vec<Moment> {
    let pile = scene("pile");
    let mut recording = start(folder, FormatName::ALL, &pile);
    let mut simulation = pile.simulation().expect("a scene");
    let mut moments = Vec::new();
    for _ in 0..6 {
        record(&mut recording, &mut simulation, 10, 10);
        moments.push(simulation.moment());
    }
    recording.finish().expect("a recording");
    moments
}

/// Returns all files and folders of a recording that can be given to the option `--initial`.
fn sources(folder: &Path) -> Vec<PathBuf> {
    [".", "grains", "grains/part-00000.parquet", "csv/grains.csv"]
        .iter()
        .map(|name| folder.join(name))
        .collect()
}

fn config(path: &Path, step: Option<u64>) -> Config {
    let initial = Some(path.to_owned());
    let source = SceneSource { initial, initial_step: step, ..SceneSource::default() };
    Config { source, ..Config::default() }
}

fn simulation(scene: &Scene) -> Simulation {
    scene.simulation().expect("a scene")
}

#[test]
fn every_format_gives_back_what_was_recorded_bit_for_bit() {
    let folder = folder();
    let moments = recorded_pile(folder.path());
    for source in sources(folder.path()) {
        let last = read_grains(&source, None).expect("grains");
        let expected = moments.last().expect("a moment");
        if !source.ends_with("part-00000.parquet") {
            assert_eq!(bits(&last), bits_of_moment(expected), "the last of {}", source.display());
        }
        for (moment, step) in moments.iter().zip([10, 20, 30, 40, 50, 60]) {
            let Ok(found) = read_grains(&source, Some(step)) else {
                // The first part file does not contain all frames.
                assert!(source.ends_with("part-00000.parquet"), "{}", source.display());
                continue;
            };
            assert_eq!(bits(&found), bits_of_moment(moment), "{step} of {}", source.display());
        }
    }
}

#[test]
fn runs_go_on_from_every_format_alike() {
    let folder = folder();
    recorded_pile(folder.path());
    let end = |source: &Path| {
        let scene = config(source, Some(20)).scene(|_| true).expect("a scene");
        assert!(scene.grains.iter().any(|grain| grain.angular_velocity != 0.0), "it moves");
        let mut simulation = simulation(&scene);
        simulation.take_steps(30).expect("a finite state");
        bits_of_moment(&simulation.moment())
    };
    let sources = sources(folder.path());
    let first = end(&sources[0]);
    for source in &sources[1..] {
        assert_eq!(end(source), first, "{}", source.display());
    }
}

#[test]
fn the_base_of_a_recorded_pile_stays_as_wide_as_it_was() {
    let folder = folder();
    recorded_pile(folder.path());
    let scene = config(folder.path(), None).scene(|_| true).expect("a scene");
    assert_eq!(scene.fixed_discs, super::scene("pile").fixed_discs);
    // Simple tables have no fixed discs. They get the rough base for the width of the box.
    let simple = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/core/assets/pile_138.csv");
    let scene = config(simple.as_ref(), None).scene(|_| true).expect("a scene");
    assert_eq!(scene.grains, super::scene("pile").grains);
    assert_eq!(scene.fixed_discs, super::scene("pile").fixed_discs);
}

#[test]
fn the_command_line_takes_a_step_or_the_last() {
    let folder = folder();
    recorded_pile(folder.path());
    let again = folder.path().join("again");
    for (more, step) in [(&["--initial-step", "30"][..], 30), (&[], 60)] {
        let mut command = slump("--headless --duration 0.001 --data-format parquet --overwrite");
        command.arg("--initial").arg(folder.path()).arg("--data").arg(&again).args(more);
        succeed(&mut command);
        let (from, to) = (parquet(folder.path(), "grains"), parquet(&again, "grains"));
        let at = |step: u64| from["step"].iter().position(|it| super::tables::whole(it) == step);
        let row = at(step).expect("the step is there");
        for column in ["x", "y", "radius", "vx", "vy", "omega"] {
            assert_eq!(to[column][0], from[column][row], "{column} from step {step}");
        }
    }
}

#[test]
fn scene_files_take_grains_out_of_recordings() {
    let folder = folder();
    let moments = recorded_pile(&folder.path().join("data"));
    let mut scene = scene("pile");
    scene.source = Some(slump::scene::GrainSource::Data { path: "data".into(), step: Some(40) });
    scene.grains.clear();
    let path = folder.path().join("scene.toml");
    write(&path, slump::config::scene_to_toml(&scene).expect("TOML"));
    let read = slump::config::read_scene(&path).expect("a scene");
    assert_eq!(bits_of_moment(&simulation(&read).moment()), bits_of_moment(&moments[3]));
}

#[test]
fn fixed_discs_of_a_file_are_those_of_the_scene_or_refused() {
    let folder = folder();
    let moments = recorded_pile(&folder.path().join("data"));
    let mut scene = scene("pile");
    scene.source = Some(slump::scene::GrainSource::Data { path: "data".into(), step: None });
    scene.grains.clear();
    let path = folder.path().join("scene.toml");
    let mut read_with = |fixed_discs: &[Disc]| {
        scene.fixed_discs = fixed_discs.to_vec();
        write(&path, slump::config::scene_to_toml(&scene).expect("TOML"));
        slump::config::read_scene(&path).map_err(|error| error.to_string())
    };
    let recorded = moments[0].surroundings.fixed_discs.clone();
    for listed in [&recorded[..], &[]] {
        assert_eq!(read_with(listed).expect("a scene").fixed_discs, recorded);
    }
    let said = read_with(&recorded[1..]).expect_err("others");
    assert!(said.contains("data: has ") && said.contains("leave fixed_discs out of"), "{said}");
}

#[test]
fn rows_in_any_order_are_put_in_that_of_their_ids() {
    let folder = folder();
    recorded_pile(folder.path());
    let table = folder.path().join("csv/grains.csv");
    let like = parquet(folder.path(), "grains");
    let words = read(&table);
    let (head, rows) = words.split_at(words.find("\n10,").expect("rows") + 1);
    let mut rows: Vec<&str> = rows.lines().collect();
    rows.reverse();
    let turned = folder.path().join("turned.csv");
    write(&turned, format!("{head}{}\n", rows.join("\n")));
    assert_ne!(csv(&turned, &like)["id"], csv(&table, &like)["id"], "the situation");
    for step in [None, Some(30)] {
        let expected = read_grains(&table, step).expect("grains");
        assert_eq!(bits(&read_grains(&turned, step).expect("grains")), bits(&expected));
    }
}

#[test]
fn a_frame_that_is_not_in_every_format_is_none() {
    let folder = folder();
    let moments = recorded_pile(folder.path());
    // The list of frames and a table as they are after a kill in the middle of the last frame.
    let index = folder.path().join("frames.csv");
    let rows = read(&index);
    write(&index, rows.trim_end().rsplit_once('\n').expect("rows").0);
    let table = folder.path().join("csv/grains.csv");
    let rows = read(&table);
    let cut = rows.rfind("\n60,").expect("a row") + 2;
    write(&table, &rows[..cut]);
    for source in [folder.path(), &table] {
        let found = read_grains(source, None).expect("grains");
        assert_eq!(bits(&found), bits_of_moment(&moments[4]), "{}", source.display());
    }
}

#[test]
fn a_step_that_is_not_there_is_told_of_with_those_that_are() {
    let folder = folder();
    recorded_pile(folder.path());
    for source in sources(folder.path()).iter().filter(|it| !it.ends_with("part-00000.parquet")) {
        let arguments = ["--initial", text(source), "--initial-step", "7", "--data", "no"];
        let said = refusal(&arguments);
        assert!(said.starts_with("initial-step is 7, but must be one of the steps of"), "{said}");
        assert!(said.ends_with(": 10, 20, 30, 40, 50, 60"), "{said}");
    }
    let simple = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/core/assets/pile_138.csv");
    let said = refusal(&["--initial", simple, "--initial-step", "7", "--data", "no"]);
    assert!(said.starts_with("initial-step is 7, but must be left out, since"), "{said}");
    let said = refusal(&["--initial-step", "7", "--data", "no"]);
    assert_eq!(said, "initial-step is 7, but must be left out where no initial grains are given");
}

#[test]
fn grains_of_another_scene_start_no_pile_unless_one_is_asked_for() {
    let folder = folder();
    recorded(folder.path(), FormatName::ALL, &scene("drum"), 2, 1);
    for source in sources(folder.path()) {
        let said = refusal(&["--data", "no", "--initial", text(&source)]);
        let expected = "is of the scene drum, but must be of a pile, which would not have its boundaries, \
                        mean_diameter, motions: start from a saved run (--save)";
        assert!(said.contains(expected), "{said}");
        succeed(slump("scene --scene pile --initial").arg(source).stdout(Stdio::null()));
    }
    let said = refusal(&["--data", "no", "--scene", "drum", "--initial", text(folder.path())]);
    assert!(
        said.contains("must be pile where initial grains are given; a saved run (--save)"),
        "{said}"
    );
}

#[test]
fn grains_of_a_cell_that_wraps_start_no_pile() {
    let folder = folder();
    recorded(folder.path(), FormatName::ALL, &scene("shear-periodic"), 2, 1);
    for source in sources(folder.path()) {
        let said = refusal(&["--data", "no", "--initial", text(&source)]);
        assert!(said.contains("periodic borders, but must be of one without"), "{said}");
    }
}
