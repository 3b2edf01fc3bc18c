//! Runs that are saved, and gone on with or begun anew by other commands.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use slump::config::SavedState;
use tempfile::TempDir;

use super::program::{contents, folder, manifest, refusal, slump, succeed};

/// A run of 0.1 s that is saved at 0.05 s.
fn halves(more: &[&str]) -> [TempDir; 3] {
    let folders = [folder(), folder(), folder()];
    let state = folders[1].path().join("half.slump");
    let state = state.to_str().expect("UTF-8");
    let base = [&["--bond", "20", "--dt", "1e-3", "--fps", "100"], more].concat();
    succeed(slump(&base, folders[0].path()).args(["--duration", "0.1"]));
    succeed(slump(&base, folders[1].path()).args(["--duration", "0.05", "--save", state]));
    let mut second = slump(&["--fps", "100", "--restart", state], folders[2].path());
    succeed(second.args(["--duration", "0.1"]));
    folders
}

#[test]
fn a_saved_run_goes_on_as_if_it_had_never_ended() {
    for more in [&[][..], &["--stepper", "range"], &["--stepper", "dem"], &["--solver", "newton"]] {
        let [whole, first, second] = halves(more);
        let rows = |folder: &TempDir| {
            let text = std::fs::read_to_string(folder.path().join("observables.csv"));
            text.expect("a table").lines().skip(1).map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!([rows(&first), rows(&second)].concat(), rows(&whole), "{more:?}");
        let [whole, first, second] = [whole, first, second].map(|folder| contents(folder.path()));
        let frames = whole.keys().filter(|name| name.starts_with("frame_"));
        // What else a file says is how it was asked for.
        let pixels =
            |bytes: &Vec<u8>| image::load_from_memory(bytes).expect("a picture").to_rgba8();
        for name in frames.clone() {
            let half = first.get(name).or(second.get(name)).expect("a frame of one half");
            assert!(pixels(half) == pixels(&whole[name]), "{more:?}: {name}");
        }
        assert_eq!(frames.count(), 11);
        // The moment that both share is a picture of both.
        let shared = [&first, &second].map(|half| pixels(&half["frame_00005.png"]));
        assert!(shared[0] == shared[1]);
        let tally = |files: &BTreeMap<String, Vec<u8>>| {
            let manifest: serde_json::Value =
                serde_json::from_slice(&files["manifest.json"]).expect("JSON");
            manifest["runs"][0].clone()
        };
        assert_eq!(tally(&whole), tally(&second), "{more:?}");
    }
}

#[test]
fn a_saved_run_goes_on_otherwise_where_it_is_asked_to() {
    let [_, first, _] = halves(&[]);
    let state = first.path().join("half.slump");
    let restart = |more: &[&str]| {
        let out = folder();
        let mut command = slump(&["--restart"], out.path());
        // The option's value stands in front of the folder's option.
        let words: Vec<_> = command.get_args().map(ToOwned::to_owned).collect();
        let at = words.iter().position(|word| word == "--restart").expect("the option");
        let mut again = Command::new(command.get_program());
        again.args(&words[..=at]).arg(&state).args(&words[at + 1..]).args(more);
        command = again;
        (out, command)
    };
    let (out, mut command) = restart(&["--bond", "80", "--stepper", "range", "--dt", "5e-4"]);
    let saved = out.path().join("end.slump");
    succeed(command.args(["--duration", "0.1", "--save"]).arg(&saved));
    let state_at_end = SavedState::open(&saved).expect("a state");
    let parameters = state_at_end.simulation.parameters();
    assert_eq!((parameters.bond, parameters.friction), (80.0, 0.5), "what is not changed stays");
    assert_eq!(state_at_end.simulation.observables().step, 50 + 100);
    assert_eq!(state_at_end.tally.steps, 150);
    assert!(state_at_end.simulation.observables().slump > 0.0, "against the first start");
    let run = &manifest(out.path())["runs"][0];
    assert_eq!(run["restarted_from"]["step"], 50);
    assert_eq!(run["scene"]["parameters"]["bond"], 80.0);

    for (more, field) in [
        (&["--duration", "0.05"][..], "duration is 0.05"),
        (&["--times", "0.01", "--duration", "0.2"], "times is 0.01"),
        (&["--scene", "cradle", "--duration", "0.2"], "restart is given"),
        (&["--preset", "robust", "--duration", "0.2"], "restart is given"),
        (&["--bond", "-1", "--duration", "0.2"], "bond is -1"),
        (&["--checkpoint-every", "0", "--duration", "0.2"], "checkpoint-every is 0"),
        (
            &["--stepper", "range", "--cone", "compressive", "--duration", "0.2"],
            "cone is compressive",
        ),
    ] {
        let (out, mut command) = restart(more);
        let said = refusal(&mut command);
        assert!(said.contains(field), "{said}");
        assert!(!out.path().join("manifest.json").exists(), "{more:?}");
    }
}

#[test]
fn a_saved_run_is_an_initial_state_in_its_own_scene() {
    let folder = folder();
    let (state, next) = (folder.path().join("walls.slump"), folder.path().join("next.slump"));
    let saved = |path: &Path, more: &[&str]| {
        let mut command = Command::new(crate::tested::program());
        command.args(["--headless", "--save"]).arg(path).args(more);
        command
    };
    succeed(&mut saved(&state, &["--scene", "moving-walls", "--duration", "0.1"]));
    let before = SavedState::open(&state).expect("a state");
    let initial = ["--initial", state.to_str().expect("UTF-8"), "--duration"];
    succeed(saved(&next, &initial).args(["0.01", "--dt", "2e-4", "--bond", "5"]));
    let after = SavedState::open(&next).expect("a state");
    assert_eq!(after.scene.name, "moving-walls");
    assert_eq!(after.simulation.observables().step, 50, "it begins at t = 0");
    assert_eq!(
        after.scene.boundaries,
        before.simulation.world().boundaries,
        "walls are where they were"
    );
    assert_ne!(after.scene.boundaries, before.scene.boundaries, "which is not where they began");
    let positions = &before.simulation.world().grains.positions;
    assert!(
        after.scene.grains.iter().zip(positions).all(|(grain, &place)| grain.position == place)
    );
    assert_eq!(after.simulation.parameters().bond, 5.0);

    let said = refusal(saved(&next, &initial).args(["0.1", "--scene", "cradle"]));
    assert!(said.contains("scene is cradle") && said.contains("moving-walls"), "{said}");
    let mut bytes = std::fs::read(&state).expect("a file");
    bytes.pop();
    std::fs::write(&state, bytes).expect("a file");
    assert!(refusal(saved(&next, &initial).arg("0.1")).contains("has been cut"));
}
