//! Tests of the first view of the window: the visible controls, the most important gesture (dragging the time step),
//! and the statement on how far the result can be trusted.

use crate::robot::*;
use egui::Role;
use slump::app::lessons::LESSONS;

/// Opens a window in which changing a slider restarts the run, as in a new installation.
fn open(config: Config) -> Robot {
    let mut robot = Robot::open(config);
    robot.state_mut().preferences.starts_again = true;
    robot
}

/// Drags the handle of the slider of the time step to its right end.
fn drag_time_step(robot: &mut Robot) {
    let (from, to) = (robot.place("Δt", 0.66, 0.5), robot.place("Δt", 1.0, 0.5));
    robot.drag(from, to);
    robot.button(to, false);
    robot.settle();
}

#[test]
fn a_slider_that_is_let_go_starts_the_pile_again_and_leaves_a_ghost() {
    let mut robot = open(pile());
    robot.take_steps(20);
    let before = robot.settings().parameters.time_step_secs;
    drag_time_step(&mut robot);
    let after = robot.settings().parameters.time_step_secs;
    assert!(after > 4e-3, "{after} s");
    robot
        .until("the new run", |state| state.run.frame.playing && state.run.frame.time_secs() > 0.0);
    let row = robot.observables();
    assert_eq!(
        row.time_secs,
        row.step as f64 * row.time_step_secs,
        "with the new value from the start"
    );
    let past = &robot.state().run.frame.past;
    assert_eq!(past.len(), 1, "one gesture, one run");
    assert_eq!(past[0].worlds[0].controls.settings.parameters.time_step_secs, before);
}

#[test]
fn the_ghost_is_at_the_simulated_time_of_the_run_and_says_what_it_is() {
    let mut robot = open(pile());
    robot.take_steps(40);
    let before = robot.bits();
    drag_time_step(&mut robot);
    robot.until("the new run", |state| state.run.frame.time_secs() > 0.025);
    robot.send(Command::Pause);
    let long = robot.settings().parameters.time_step_secs;
    for secs in [4.0 * long, 2.0 * long] {
        robot.seek(secs);
        let ghost = robot.state().run.frame.ghosts[0].observables;
        assert!((ghost.time_secs - robot.observables().time_secs).abs() < 1.01e-3);
        assert_eq!(ghost.time_step_secs, 1e-3);
        robot.harness.step();
        let texts = robot.painted_texts();
        let label = format!("earlier run (grey): Δt 1 ms, at {:.1} ms", 1e3 * ghost.time_secs);
        assert!(texts.iter().any(|text| text.text == label), "{label}");
    }
    // After its last step the earlier run stays at its end. If the user undoes the change, the earlier run comes back
    // with all recorded states.
    robot.take_steps(12);
    let ghost = robot.state().run.frame.ghosts[0].clone();
    assert!((ghost.observables.time_secs - 0.04).abs() < 1e-9);
    robot.command_key(egui::Key::Z);
    robot.settle();
    robot.seek(0.04);
    assert_eq!(robot.bits(), before);
}

#[test]
fn nothing_starts_while_a_slider_is_held() {
    let mut robot = open(pile());
    robot.take_steps(20);
    let (from, to) = (robot.place("Δt", 0.66, 0.5), robot.place("Δt", 1.0, 0.5));
    robot.drag(from, to);
    robot.settle();
    assert_eq!((robot.steps(), robot.state().run.frame.past.len()), (20, 0));
    robot.button(to, false);
    robot.settle();
    assert_eq!(robot.state().run.frame.past.len(), 1);
}

#[test]
fn a_number_that_is_typed_starts_the_pile_again_as_well() {
    let mut robot = open(pile());
    robot.take_steps(5);
    robot.type_number("Bond, cohesion", "75");
    assert_eq!(robot.settings().parameters.bond, 75.0);
    assert!(robot.state().run.frame.playing && robot.state().run.frame.past.len() == 1);
}

/// Checks that a changed time step Δt restarts every scene, also scenes with walls driven by a force, with grains that
/// do not move, or with one dimension.
#[test]
fn every_scene_starts_again_with_the_new_value() {
    let mut robot = open(pile());
    for info in SCENES {
        robot.load(Config::of_scene(info.name));
        let start = robot.bits();
        robot.take_steps(3);
        let time_step_secs = 0.5 * robot.settings().parameters.time_step_secs;
        robot.type_number("Δt, time step", &format!("{time_step_secs} s"));
        assert!(robot.state().run.frame.playing, "{}", info.name);
        robot.key(egui::Key::Space);
        let row = robot.observables();
        assert_eq!(row.time_step_secs, time_step_secs, "{}", info.name);
        let since_start = (row.time_secs / time_step_secs).round() as u64;
        assert_eq!(row.step, since_start, "{}: no step of the old length", info.name);
        robot.seek(0.0);
        assert_eq!(robot.bits(), start, "{}", info.name);
    }
}

#[test]
fn in_a_comparison_only_the_chosen_world_changes() {
    let mut robot = open(pile());
    let base = robot.settings();
    robot.send(Command::Compare(vec![base, base.with_bond(100.0)]));
    robot.take_steps(5);
    drag_time_step(&mut robot);
    let told = robot.of_worlds(|world| {
        let parameters = world.controls.settings.parameters;
        (parameters.bond, parameters.time_step_secs > 4e-3)
    });
    assert_eq!(told, [(20.0, true), (100.0, false)]);
}

#[test]
fn switched_off_the_run_goes_on_and_the_hint_says_what_is_true_then() {
    let mut robot = open(pile());
    robot.click("start again when I move a slider");
    robot.take_steps(20);
    drag_time_step(&mut robot);
    assert_eq!((robot.steps(), robot.state().run.frame.past.len()), (20, 0));
    robot.harness.step();
    assert!(robot.shows("A new value acts from the next step on"));
}

/// Returns role and label of all controls that can be clicked, dragged or typed into. A slider and its number field
/// count as one control.
fn controls(robot: &Robot) -> Vec<(Role, String)> {
    let is_control = |role: Role| {
        matches!(
            role,
            Role::Button
                | Role::ComboBox
                | Role::CheckBox
                | Role::Slider
                | Role::SpinButton
                | Role::TextInput
        )
    };
    let root = robot.harness.root();
    let all = root.children_recursive().map(|node| node.accesskit_node());
    let all = all.filter(|node| is_control(node.role()));
    let mut all: Vec<_> = all.map(|node| (node.role(), node.label().unwrap_or_default())).collect();
    let sliders: Vec<String> = all
        .iter()
        .filter_map(|(_, label)| Some(label.strip_suffix(" slider")?.to_owned()))
        .collect();
    all.retain(|(role, label)| *role != Role::TextInput || !sliders.contains(label));
    all
}

#[test]
fn a_newcomer_sees_no_more_than_twenty_controls() {
    let mut robot = Robot::open(Config::default());
    robot.state_mut().visit(0);
    robot.settle();
    robot.frames(5);
    let all = controls(&robot);
    assert!(all.len() >= 12, "the situation: {all:?}");
    assert!(all.len() <= 20, "{}: {all:?}", all.len());
}

#[test]
fn no_text_of_the_front_is_cut_at_usual_sizes() {
    for size in [[1024.0, 700.0], [1280.0, 800.0], [1920.0, 1080.0], [2560.0, 1440.0]] {
        let mut robot = Robot::open(Config::default());
        robot.harness.set_size(egui::vec2(size[0], size[1]));
        for at in 0..LESSONS.len() {
            robot.state_mut().visit(at);
            robot.settle();
            robot.frames(20);
            assert_eq!(robot.cut_texts(), [""; 0], "{size:?}: lesson {} at its start", at + 1);
            robot.take_steps(3);
            robot.frames(5);
            assert_eq!(robot.cut_texts(), [""; 0], "{size:?}: lesson {}", at + 1);
        }
    }
}

#[test]
fn a_text_that_is_cut_is_found() {
    let mut robot = Robot::open(Config::default());
    robot.harness.set_size(egui::vec2(530.0, 700.0));
    robot.state_mut().visit(4);
    robot.settle();
    robot.frames(10);
    assert_eq!(robot.cut_texts(), [LESSONS[4].title]);
}

#[test]
fn the_bars_fold_away() {
    let mut robot = Robot::open(pile());
    robot.key(egui::Key::B);
    robot.frames(5);
    let scene = robot.state().controls["scene"];
    assert!(scene.width() > 980.0 && scene.height() > 680.0, "{scene:?}");
    robot.click("Unfold");
    robot.frames(5);
    assert!(robot.state().controls["scene"].height() < 500.0);
}

#[test]
fn what_cannot_be_trusted_is_called_so_and_what_nobody_knows_too() {
    let mut robot = Robot::open(pile());
    robot.frames(2);
    assert!(robot.shows("Can I trust this? not known yet"));
    let mut robot = Robot::open(Config::of_scene("thin-wall"));
    robot.take_steps(40);
    robot.harness.step();
    assert!(robot.shows("Can I trust this? no"), "grains are lost");
}

#[test]
fn the_list_behind_the_word_has_a_budget_of_the_run_that_is_shown() {
    let cache = folder();
    let mut config = Config::of_scene("cradle");
    config.source.duration = Some(0.05);
    let mut robot = Robot::open(config);
    robot.state_mut().ensemble.keep_in(cache.path().to_owned());
    let scene = robot.state().controls["scene"];
    robot.click("Can I trust this? not known yet");
    let is_under_way = (0..20).any(|_| {
        robot.frames(1);
        // The first answer may come between two frames.
        robot.shows("Idle cores compute an error budget") || robot.shows("mean(kinetic_energy) is ")
    });
    assert!(is_under_way);
    let stop = robot.harness.get_by_label("Stop").rect();
    assert!(stop.max.y < 150.0, "Stop is always visible: {stop}");
    robot.frames(20);
    let beside = robot.state().controls["scene"];
    assert!(beside.width() < scene.width() - 300.0, "the answer covers nothing");
    let begun = Instant::now();
    while !robot.shows("mean(kinetic_energy) is ") {
        assert!(begun.elapsed() < Duration::from_secs(300), "waited in vain for the budget");
        robot.harness.step();
        std::thread::sleep(Duration::from_millis(20));
    }
    let told = |robot: &Robot| {
        let labels = robot.harness.query_all_by_label_contains("mean(kinetic_energy) is ");
        labels.filter_map(|label| label.accesskit_node().value()).collect::<String>()
    };
    let before = told(&robot);
    assert!(before.contains("kinetic_energy"), "{before}");
    // Other settings have their own error budget (the estimated contributions to the error), which may arrive at once.
    let mut settings = robot.settings();
    settings.parameters.time_step_secs *= 0.5;
    robot.change(0, settings);
    robot.harness.step();
    assert_ne!(told(&robot), before, "the answer was of other settings");
}

#[test]
fn a_budget_is_computed_to_its_end_though_its_list_is_closed() {
    let cache = folder();
    let mut config = Config::of_scene("cradle");
    config.source.duration = Some(0.05);
    let mut robot = Robot::open(config);
    robot.state_mut().ensemble.keep_in(cache.path().to_owned());
    let at = robot.place("trust", 0.5, 0.5);
    for pressed in [true, false, true, false] {
        robot.harness.hover_at(at);
        robot.button(at, pressed);
    }
    // The answer is drawn before the button that closes the page.
    robot.frames(2);
    assert!(!robot.shows("Idle cores compute an error budget"), "the list is closed");
    let begun = Instant::now();
    while robot.shows("Can I trust this? not known yet") {
        assert!(begun.elapsed() < Duration::from_secs(300), "waited in vain for the answer");
        robot.harness.step();
        std::thread::sleep(Duration::from_millis(20));
    }
    // Other settings have no error budget until the user asks for one.
    let mut settings = robot.settings();
    settings.parameters.time_step_secs *= 0.5;
    robot.change(0, settings);
    robot.frames(2);
    assert!(robot.shows("Can I trust this? not known yet"));
}

const BEYOND_REASON: [(&str, &str, &str); 3] = [
    ("Bond, cohesion", "1e308", "Bond is 1e308, but must be at most 1e6"),
    ("μ, friction", "1e9", "μ is 1e9, but must be at most 1e6"),
    ("Δt, time step", "5000", "Δt is 5000 ms, but must be at most 1000 ms"),
];

#[test]
fn a_time_step_that_is_too_long_is_warned_of_instead_of_praised() {
    let mut robot = Robot::open(pile());
    assert!(robot.shows("A larger Δt makes these grains stick better"), "the situation");
    robot.type_number("Δt, time step", "1 s");
    robot.frames(2);
    assert!(robot.shows("Δt is too long: in one step a grain at rest falls by 19"));
    assert!(!robot.shows("stick better") && robot.shows("Can I trust this? no"));
}

#[test]
fn numbers_beyond_all_reason_are_refused() {
    let mut robot = Robot::open(pile());
    let before = robot.settings();
    for (field, value, refusal) in BEYOND_REASON {
        robot.type_number(field, value);
        robot.frames(2);
        assert!(robot.shows(refusal), "{refusal}");
        assert_eq!(robot.settings(), before);
    }
    robot.type_number("ρ, restitution", "2");
    robot.frames(2);
    assert!(robot.shows("ρ is 2, but must be between 0 and 1"));
}

/// Checks that extreme numbers (such as Bond 1e308) do not widen the panel. They can come from a scene file or from the
/// stored preferences of the last window.
#[test]
fn numbers_beyond_all_reason_widen_nothing_though_a_window_opens_with_them() {
    let places = |config: Config| {
        let mut robot = Robot::open(config);
        robot.click("Law, solver");
        robot.take_steps(4);
        robot.frames(10);
        let failed = robot.world().failure.is_some();
        (failed, ["Pile", "μ", "release"].map(|name| robot.state().controls[name]))
    };
    let (failed, usual) = places(pile());
    assert!(!failed);
    let mut config = pile();
    let parameters = &mut config.parameters;
    (parameters.bond, parameters.friction) = (Some(1e308), Some(1e9));
    parameters.time_step_secs = Some(0.5);
    let (failed, odd) = places(config);
    assert!(failed, "the situation");
    assert_eq!(odd, usual);
}

#[test]
fn the_answer_on_trust_begins_with_a_sentence_and_closes_with_escape() {
    let mut robot = Robot::open(Config::of_scene("thin-wall"));
    robot.take_steps(40);
    robot.harness.step();
    robot.click("Can I trust this? no");
    robot.frames(20);
    let alarms = &robot.world().alarms;
    let lost = alarms.iter().find(|alarm| alarm.kind == AlarmKind::GrainLost).expect("an alarm");
    let sentence = robot.harness.query_all_by_label(&lost.text).map(|node| node.rect());
    let sentence = sentence.reduce(|one, other| if one.top() < other.top() { one } else { other });
    let sentence = sentence.expect("the reason");
    let heading = robot.harness.query_all_by_label("Can I trust this? no");
    let heading = heading.map(|node| node.rect().bottom()).fold(f32::INFINITY, f32::min);
    assert!(sentence.top() - heading < 20.0, "the reason comes first: {heading}, {sentence:?}");
    robot.key(egui::Key::Escape);
    robot.frames(20);
    assert!(!robot.shows("Nobody has computed") && !robot.shows("no error budget"));
    assert_eq!(robot.state().preferences.page, None);
}
