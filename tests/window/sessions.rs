//! Sessions and links: what is open now, opened again later or elsewhere.

use std::path::{Path, PathBuf};

use slump::app::AppState;
use slump::config::Config;
use slump::live::Command;
use slump::sim::{Pull, Stepper};

use crate::recordings::take_steps;
use crate::robot::{Robot, bits, pile};

/// All that is recorded of a window's worlds, and where they are.
fn shown(robot: &Robot) -> Vec<(u64, f64, Vec<[u64; 6]>)> {
    let of_world = |world: &slump::live::WorldFrame| {
        (world.snapshot.observables.step, world.recorded_secs, bits(world))
    };
    robot.state().frame.worlds.iter().map(of_world).collect()
}

/// Two worlds with a change on the way, looked at before their end, and a run before them.
fn two_worlds() -> Robot {
    let mut robot = Robot::open(pile());
    let base = robot.world().controls.settings;
    take_steps(&mut robot, 5);
    let variants = vec![base.over(1e-3), base.over(2e-3)];
    robot.state_mut().live.send(Command::Compare(variants));
    take_steps(&mut robot, 20);
    robot.state_mut().change(0, base.over(1e-3).with_bond(3.0));
    take_steps(&mut robot, 20);
    robot.state_mut().live.send(Command::Seek(0.06));
    robot.settle();
    robot
}

/// Saves a session into a folder, and gives the file.
fn saved(robot: &mut Robot, folder: &Path) -> PathBuf {
    robot.state_mut().preferences.folder = folder.to_owned();
    robot.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::S);
    robot.harness.step();
    written(robot)
}

/// The file that is being written.
fn written(robot: &mut Robot) -> PathBuf {
    robot.until("the file", |state| !state.is_writing());
    let told = robot.state().notice().expect("what became of it").0.text.clone();
    told.strip_prefix("Saved ").unwrap_or_else(|| panic!("{told}")).into()
}

/// A window that opens a file.
fn opened(path: &Path) -> Robot {
    let mut robot = Robot::open(Config::of_scene("cradle"));
    robot.state_mut().load_saved(path);
    robot.settle();
    robot
}

#[test]
fn a_session_brings_back_worlds_record_past_and_window() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = two_worlds();
    robot.state_mut().preferences.theme = egui::ThemePreference::Dark;
    robot.state_mut().preferences.plots = false;
    robot.click("Solver");
    let path = saved(&mut robot, folder.path());
    assert!(path.extension().is_some_and(|ending| ending == "session"));
    let (before, past) = (shown(&robot), robot.state().frame.past.len());

    let mut again = opened(&path);
    assert!(again.state().frame.refusal.is_none(), "{:?}", again.state().frame.refusal);
    assert_eq!(shown(&again), before);
    assert_eq!((again.state().frame.past.len(), past), (1, 1), "the run before is there");
    assert_eq!(again.state().preferences.theme, egui::ThemePreference::Dark);
    assert!(!again.state().preferences.plots);
    // The panel that was open is so again: its contents are there.
    use egui_kittest::kittest::Queryable;
    for window in [&mut robot, &mut again] {
        (0..20).for_each(|_| window.harness.step());
        assert!(window.harness.query_by_label("Trusted").is_some());
    }

    // Every recorded moment, and what comes after it, is the same.
    for window in [&mut robot, &mut again] {
        window.state_mut().live.send(Command::Seek(0.024));
        window.settle();
    }
    assert_eq!(shown(&again), shown(&robot));
    for window in [&mut robot, &mut again] {
        window.state_mut().live.send(Command::Seek(1.0));
        window.settle();
        take_steps(window, 7);
    }
    assert_eq!(shown(&again), shown(&robot));
    assert_ne!(shown(&again), before);
}

#[test]
fn the_tour_goes_on_at_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = Robot::open(Config::default());
    robot.state_mut().visit(2);
    robot.settle();
    let path = saved(&mut robot, folder.path());
    let mut again = opened(&path);
    assert!(again.state().touring);
    assert_eq!(again.state().preferences.tour.at, 2);
    let before = robot.state().preferences.speed;
    assert_eq!(again.state().preferences.speed, before);
    again.click("Leave");
    assert!(!again.state().touring);
}

#[test]
fn a_file_that_is_no_whole_session_is_refused_in_a_sentence() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = Robot::open(Config::of_scene("cradle"));
    take_steps(&mut robot, 3);
    robot.state_mut().preferences.folder = folder.path().to_owned();
    robot.click("Data");
    robot.click("Save session");
    let path = written(&mut robot);
    let bytes = std::fs::read(&path).expect("a file");
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 1;
    let cases: [(&str, &[u8], &str); 4] = [
        ("cut", &bytes[..bytes.len() / 2], "has been cut"),
        ("flipped", &flipped, "is damaged"),
        ("text", b"x,y,radius\n", "holds no session, but must be a session that the window saved"),
        ("empty", b"", "holds no session"),
    ];
    for (name, bytes, said) in cases {
        let file = folder.path().join(format!("{name}.session"));
        std::fs::write(&file, bytes).expect("a file");
        robot.state_mut().load_saved(&file);
        robot.settle();
        let notice = robot.state().notice().expect("a complaint").0.text.clone();
        assert!(notice.contains(said), "{name}: {notice}");
        assert_eq!(robot.steps(), 3, "the run before is still there");
        // And before a window opens.
        let mut program = std::process::Command::new(assert_cmd::cargo::cargo_bin!("slump"));
        let output = program.arg("--session").arg(&file).output().expect("the program starts");
        let stderr = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!((output.status.code(), stderr), (Some(2), format!("slump: {notice}\n")));
    }
}

/// The text that was copied last.
fn copied(robot: &mut Robot) -> String {
    let context = robot.harness.ctx.clone();
    robot.state_mut().copy_link(&context);
    for _ in 0..200 {
        robot.harness.step();
        for command in &robot.harness.output().platform_output.commands {
            if let egui::OutputCommand::CopyText(text) = command {
                return text.clone();
            }
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    panic!("nothing is copied: {:?}", robot.state().notice().map(|(notice, _)| &notice.text));
}

#[test]
fn a_link_opens_the_moment_that_it_was_copied_at() {
    let mut robot = two_worlds();
    let mut settings = robot.state().frame.worlds[1].controls.settings;
    settings.stepper = Stepper::Range;
    robot.state_mut().change(1, settings);
    robot.settle();
    let text = copied(&mut robot);
    assert!(text.starts_with("slump://run?") && !text.contains(' '), "{text}");
    let places = |robot: &Robot| -> Vec<_> {
        shown(robot).into_iter().map(|(step, _, bits)| (step, bits)).collect()
    };
    let mut again = Robot::open(Config::of_scene("cradle"));
    again.harness.event(egui::Event::Paste(format!(" {text}\n")));
    again.harness.step();
    again.settle();
    assert!(again.state().frame.refusal.is_none(), "{:?}", again.state().frame.refusal);
    assert_eq!(places(&again), places(&robot), "{text}");
    let settings = |state: &AppState| -> Vec<_> {
        state.frame.worlds.iter().map(|world| world.controls.settings).collect()
    };
    assert_eq!(settings(again.state()), settings(robot.state()));
    // It is a run like any other: its link is the same, and it goes on alike.
    assert_eq!(copied(&mut again), text);
    for window in [&mut robot, &mut again] {
        take_steps(window, 3);
    }
    assert_eq!(places(&again), places(&robot));
}

#[test]
fn a_link_says_what_it_leaves_out_and_what_is_none_is_refused() {
    let mut robot = Robot::open(pile());
    let pull = Pull { grain: 100, target: glam::DVec2::new(0.0, 0.1) };
    robot.state_mut().live.send(Command::SetPull(0, Some(pull)));
    take_steps(&mut robot, 3);
    copied(&mut robot);
    assert!(robot.state().notice().expect("a word").0.text.contains("pulled by hand"));
    robot.harness.event(egui::Event::Paste("slump://run?scene=no-such&to=3".into()));
    robot.harness.step();
    robot.settle();
    let said = robot.state().notice().expect("a complaint").0.text.clone();
    assert!(said.contains("no-such"), "{said}");
    robot.harness.event(egui::Event::Paste("slump://walk".into()));
    robot.harness.step();
    let said = robot.state().notice().expect("a complaint").0.text.clone();
    assert!(said.starts_with("link is slump://walk, but must be"), "{said}");
    assert_eq!(robot.steps(), 3);
}
