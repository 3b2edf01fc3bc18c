//! Tests that the statements of the lessons (each demonstrates one effect in the window, with simulations side by side)
//! are true for the displayed pile and for sixteen other piles.

use crate::robot::*;
use slump::app::lessons::{LESSONS, Lesson};

/// Returns the lesson with this title, and its index in the list of lessons.
fn lesson(title: &str) -> (usize, &'static Lesson) {
    let found = LESSONS.iter().enumerate().find(|(_, lesson)| lesson.title == title);
    found.expect("a lesson")
}

/// Runs all simulations that a lesson compares, without a window, and returns them in their final states. `grains`
/// replaces the grains of the lesson's pile.
fn run_lesson(lesson: &Lesson, grains: Option<&[slump::world::Grain]>) -> Vec<Simulation> {
    let (config, mut scene) = lesson.scene().expect("a scene");
    if let Some(grains) = grains {
        scene = config.scene_from(grains.to_vec()).expect("a scene");
    }
    let run = |settings: Settings| {
        let mut scene = scene.clone();
        scene.set_settings(settings);
        let mut simulation = scene.simulation().expect("a sound scene");
        let steps = simulation.step_at(scene.duration_secs);
        simulation.take_steps(steps).expect("finite states");
        simulation
    };
    (lesson.worlds)(scene.settings()).into_iter().map(run).collect()
}

fn final_rows(lesson: &Lesson, grains: Option<&[slump::world::Grain]>) -> Vec<Observables> {
    run_lesson(lesson, grains).iter().map(|run| *run.observables()).collect()
}

fn slumps(lesson: &Lesson, grains: Option<&[slump::world::Grain]>) -> Vec<f64> {
    final_rows(lesson, grains).iter().map(|row| row.slump).collect()
}

/// Returns the right answer to the question of a lesson, computed from the measured quantities at the end of its
/// simulations.
fn right_answer(lesson: &Lesson, rows: &[Observables]) -> &'static str {
    let question = lesson.question.as_ref().expect("a question");
    let (right, _) = (question.result)(rows).expect("a result");
    question.answers[right]
}

/// Returns the answer that the last page of a lesson gives to the lesson's question.
fn lesson_answer(title: &str) -> &'static str {
    match title {
        "Two time steps" => "not alike",
        "A pile at rest" => "stay",
        "The solver's part" => "worse",
        "Bonds with a length" => "less",
        "What friction depends on" => "right",
        "A heavy disc" => "no",
        "Your own pile" => "more",
        _ => panic!("{title} asks nothing"),
    }
}

/// A statement of a lesson about the slumps of two simulations that it compares.
struct Claim {
    lesson: &'static str,
    /// Indices of the two simulations. The difference is the slump of the first minus the slump of the second.
    worlds: [usize; 2],
    /// Bounds that must contain the 95 % interval of the mean difference of the slumps over many piles.
    between: [f64; 2],
}

/// The statements that the tests check. The bounds follow from differences that were measured over sixteen piles
/// (docs/window.md). These piles have the seeds 1 to 18 except 15, the seed of the pile that the lessons show, and 8,
/// the seed of the default pile.
const CLAIMS: [Claim; 6] = [
    Claim { lesson: "Two time steps", worlds: [0, 1], between: [0.1, 0.3] },
    Claim { lesson: "The solver's part", worlds: [0, 2], between: [0.1, 0.4] },
    Claim { lesson: "The solver's part", worlds: [1, 2], between: [0.0, 0.2] },
    Claim { lesson: "Bonds with a length", worlds: [0, 1], between: [0.08, 0.2] },
    Claim { lesson: "Bonds with a length", worlds: [2, 3], between: [-0.04, 0.04] },
    Claim { lesson: "What friction depends on", worlds: [1, 0], between: [0.2, 0.4] },
];

#[test]
fn the_pile_that_is_shown_does_what_the_lesson_says() {
    for Lesson { title, .. } in &LESSONS {
        let claims = CLAIMS.iter().filter(|claim| claim.lesson == *title);
        let claims: Vec<_> = claims.collect();
        if claims.is_empty() {
            continue;
        }
        let lesson = lesson(title).1;
        let rows = final_rows(lesson, None);
        assert_eq!(right_answer(lesson, &rows), lesson_answer(title), "{title}");
        let slumps: Vec<f64> = rows.iter().map(|row| row.slump).collect();
        for Claim { worlds: [more, less], between: [low, high], .. } in claims {
            let difference = slumps[*more] - slumps[*less];
            // At Bond 8 under `range` the pile that is shown differs from most other piles: its difference is −0.043.
            let [low, high] = if *low < 0.0 { [low - 0.01, high + 0.01] } else { [*low, *high] };
            assert!((low..high).contains(&difference), "{title}: {slumps:?}");
        }
    }
}

/// Smallest number of the sixteen piles for which the answer of the lesson must be right: a lesson states an effect
/// that most piles show.
const MOST: usize = 14;

// The test takes about five minutes on two cores.
#[test]
#[ignore = "sixteen piles under every lesson: cargo test --release --test window lessons -- --ignored"]
fn sixteen_piles_do_what_the_lessons_say_and_the_one_that_is_shown_is_none_of_the_odd_ones() {
    let seeds = (1..=18).filter(|&seed| seed != NewPile::default().seed && seed != 15);
    let piles: Vec<_> = seeds
        .map(|seed| settle(&NewPile { seed, ..NewPile::default() }, |_| true).expect("a pile"))
        .collect();
    let titles =
        ["Two time steps", "The solver's part", "Bonds with a length", "What friction depends on"];
    for title in titles {
        let lesson = lesson(title).1;
        let shown = slumps(lesson, None);
        let rows: Vec<_> = piles.iter().map(|grains| final_rows(lesson, Some(grains))).collect();
        let agree =
            rows.iter().filter(|rows| right_answer(lesson, rows) == lesson_answer(title)).count();
        println!("{title}: {agree} of {} piles give the same answer", rows.len());
        assert!(agree >= MOST, "{title}: {agree}");
        let slumps_of = |rows: &Vec<Observables>| rows.iter().map(|row| row.slump).collect();
        let all: Vec<Vec<f64>> = rows.iter().map(slumps_of).collect();
        for claim in CLAIMS.iter().filter(|claim| claim.lesson == title) {
            let [more, less] = claim.worlds;
            let differences: Vec<f64> =
                all.iter().map(|slumps| slumps[more] - slumps[less]).collect();
            let count = differences.len() as f64;
            let mean = differences.iter().sum::<f64>() / count;
            let variance =
                differences.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / (count - 1.0);
            // Student's t for 95 % and 15 degrees of freedom, from tables: t(0.975; 15) = 2.131.
            let half = 2.131 * (variance / count).sqrt();
            println!("{title}: worlds {more} and {less} differ by {mean:.3} ± {half:.3}");
            let [low, high] = claim.between;
            assert!(mean - half > low && mean + half < high, "{title}: {mean} ± {half}");
        }
        for (world, &shown) in shown.iter().enumerate() {
            let below = all.iter().filter(|slumps| slumps[world] < shown).count();
            println!("{title}, world {world}: {below} of {} slump less than {shown:.3}", all.len());
            let odd = below < all.len() / 4 || below > all.len() - all.len() / 4;
            // At Bond 8, and at Bond 100 in the compressive cone, the pile that is shown slumps less than most other
            // piles. Its differences are tested in another test.
            let may_be_odd = ["Bonds with a length", "What friction depends on"].contains(&title);
            assert!(!odd || may_be_odd, "{title}: world {world} is an odd one");
        }
    }
}

#[test]
fn a_smaller_time_step_moves_nothing_of_a_pile_that_stands() {
    let (_, lesson) = lesson("A pile at rest");
    let mut run = run_lesson(lesson, None).remove(0);
    let before = *run.observables();
    let stood = before.slump;
    let settings = *run.settings();
    run.change(settings.over(1e-4)).expect("sound settings");
    run.take_steps(3_000).expect("finite states");
    let moved = run.observables().slump - stood;
    assert!(moved.abs() < 1e-3, "a slump of {stood} changes by {moved}");
    assert_eq!(right_answer(lesson, &[before, *run.observables()]), lesson_answer(lesson.title));
    // If the smaller time step is used from the start, the final pile is different.
    let [small, large] = slumps(&LESSONS[0], None)[..] else { panic!("two worlds") };
    assert!(large == stood && small > stood + 0.1, "{small}, {large}, {stood}");
}

#[test]
fn ten_sweeps_do_not_carry_a_heavy_disc() {
    let (_, lesson) = lesson("A heavy disc");
    let rows = final_rows(lesson, None);
    let overlaps: Vec<f64> = rows.iter().map(|row| row.max_overlap).collect();
    assert_eq!(right_answer(lesson, &rows), lesson_answer(lesson.title));
    assert!(overlaps[0] > 0.03 && overlaps[1] < 1e-4, "overlaps {overlaps:?}");
}

#[test]
fn the_last_lesson_asks_about_a_slump_that_bond_can_bring_below_the_asked_one() {
    let (_, lesson) = lesson("Your own pile");
    let rows = final_rows(lesson, None);
    assert_eq!(right_answer(lesson, &rows), lesson_answer(lesson.title));
    let held = [Observables { slump: 0.05, ..rows[0] }];
    assert_ne!(right_answer(lesson, &held), lesson_answer(lesson.title));
}

#[test]
fn the_squeezed_disc_is_large_enough_to_be_seen_and_its_overlap_is_plotted() {
    let mut robot = Robot::open(Config::default());
    robot.state_mut().visit(lesson("A heavy disc").0);
    robot.settle();
    robot.take_steps(10);
    assert!(robot.shows("largest overlap δ/d (%)"));
    let start = robot.state().run.frame.start.clone().expect("a start");
    let disc = &robot.world().snapshot.grains[0];
    let part = 2.0 * disc.radius / (start.view[1] - start.view[0]).y;
    assert!((0.4..0.8).contains(&part), "it takes {part} of the height");
    let at = (disc.position - start.view[0]) / (start.view[1] - start.view[0]);
    assert!((at - DVec2::splat(0.5)).abs().max_element() < 0.1, "in the middle: {at}");
}

#[test]
fn the_window_shows_what_was_computed_without_it() {
    for title in ["Two time steps", "Bonds with a length"] {
        let (at, lesson) = lesson(title);
        let mut robot = Robot::open(Config::default());
        robot.state_mut().visit(at);
        robot.settle();
        robot.send(Command::SetPace(Pace::Max));
        robot.send(Command::Play);
        robot.until("the end of the lesson", |state| !state.run.frame.playing);
        let shown = robot.of_worlds(|world| world.snapshot.observables.slump);
        assert_eq!(shown, slumps(lesson, None), "{title}");
    }
}

#[test]
fn the_lessons_go_on_where_they_were_left_and_give_back_what_was_chosen() {
    let mut robot = Robot::open(Config::default());
    assert!(!robot.state().touring, "a scene was asked for");
    let preferences = &mut robot.state_mut().preferences;
    (preferences.speed, preferences.full_speed) = (3.0, true);
    (preferences.quantities, preferences.page) = (vec!["energy".into()], Some(Page::Compare));
    let chosen = preferences.clone();
    robot.clicks(&["Lessons", "1. Two time steps"]);
    assert_eq!(robot.state().run.frame.worlds.len(), 2);
    for number in 2..=LESSONS.len() {
        robot.click("Next ▶");
        assert_eq!(robot.state().preferences.lesson.at + 1, number);
        assert!(robot.state().run.frame.refusal.is_none(), "lesson {number} is refused");
        let worlds = robot.state().run.frame.worlds.len();
        robot.key(egui::Key::ArrowRight);
        assert!(robot.steps() > 0 && worlds > 0, "lesson {number}");
    }
    robot.clicks(&["◀ Back", "Leave"]);
    let Preferences { lesson, scene, .. } = robot.state().preferences.clone();
    assert_eq!((lesson.at, lesson.on), (LESSONS.len() - 2, false));
    assert_eq!(robot.state().preferences, Preferences { lesson, scene, ..chosen });
    robot.clicks(&["Lessons", "6. A heavy disc"]);
    assert!(robot.state().touring && robot.state().preferences.lesson.on);
    robot.load(Config::of_scene("cradle"));
    assert!(!robot.state().touring, "another scene ends the lessons");
}

#[test]
fn a_lesson_says_nothing_of_worlds_that_were_changed_and_its_list_has_them_as_they_were() {
    let mut robot = Robot::open(Config::default());
    robot.state_mut().visit(0);
    robot.settle();
    assert!(robot.shows("One pile twice") && !robot.shows("A number was changed"));
    robot.type_number("Bond, cohesion", "50");
    robot.frames(2);
    assert!(robot.shows("A number was changed") && !robot.shows("One pile twice"));

    robot.harness.get_by_role_and_label(egui::Role::ComboBox, "Lessons").click();
    robot.frames(3);
    for (number, Lesson { title, .. }) in LESSONS.iter().enumerate() {
        assert!(robot.shows(&format!("{}. {title}", number + 1)), "the list has all of them");
    }
    robot.click("1. Two time steps");
    robot.frames(2);
    assert!(robot.shows("One pile twice") && !robot.shows("A number was changed"));
    // The change that the lesson asks for does not invalidate the statements of the lesson.
    robot.state_mut().visit(1);
    robot.settle();
    robot.type_number("Δt, time step", "0.1");
    robot.frames(2);
    assert!(robot.shows("This pile is computed with Δt = 5 ms"));
    robot.type_number("Bond, cohesion", "0");
    robot.frames(2);
    assert!(
        robot.shows("A number was changed") && !robot.shows("This pile is computed with Δt = 5 ms")
    );
    // The last lesson allows any change.
    robot.state_mut().visit(LESSONS.len() - 1);
    robot.settle();
    robot.type_number("Bond, cohesion", "0");
    let base = robot.settings();
    robot.send(Command::Compare(vec![base, base.with_bond(50.0)]));
    robot.frames(2);
    assert!(robot.shows(LESSONS[LESSONS.len() - 1].watch));
}

#[test]
fn a_lesson_asks_first_and_then_says_if_the_prediction_was_right() {
    let mut robot = Robot::open(Config::default());
    robot.state_mut().visit(lesson("A heavy disc").0);
    robot.settle();
    assert!(robot.shows("Will ten sweeps per step carry the heavy disc?"));
    assert_eq!(asked(&robot), ["answers"]);
    robot.clicks(&["yes", "no"]);
    assert_eq!(asked(&robot), ["release"]);
    robot.take_steps(1);
    robot.click("yes");
    assert!(!robot.shows("You said"), "the run has not ended");
    robot.send(Command::SetPace(Pace::Max));
    robot.send(Command::Play);
    robot.until("the end of the lesson", |state| !state.run.frame.playing);
    robot.frames(2);
    let overlap = 100.0 * robot.of_worlds(|world| world.snapshot.observables.max_overlap)[0];
    let verdict =
        format!("✓ You said: no. At the end the largest overlap was {overlap:.1} % of a diameter");
    assert!(robot.shows(&verdict), "{verdict}");
    // Going back to an earlier time does not remove the verdict. After the next run a new answer is judged.
    robot.seek(0.01);
    assert!(robot.shows("✓ You said: no."));
    robot.key(egui::Key::R);
    robot.click("yes");
    robot.send(Command::Play);
    robot.until("the end of the lesson", |state| !state.run.frame.playing);
    robot.frames(2);
    assert!(robot.shows("✗ You said: yes."));
}

#[test]
fn the_last_page_has_the_predictions_and_a_link() {
    use slump::app::Prediction;
    let mut robot = Robot::open(Config::default());
    robot.harness.set_size(SMALL);
    let predictions = &mut robot.state_mut().preferences.lesson.predictions;
    predictions.insert(0, Prediction { answer: 0, was_right: Some(false) });
    predictions.insert(5, Prediction { answer: 1, was_right: Some(true) });
    predictions.insert(2, Prediction { answer: 1, was_right: None });
    robot.state_mut().visit(LESSONS.len() - 1);
    robot.settle();
    robot.click("Summary ▶");
    robot.frames(5);
    assert!(robot.shows("1 of your 2 predictions were right"));
    assert!(robot.shows("✗ 1. Two time steps") && robot.shows("✓ 6. A heavy disc"));
    for Lesson { title, learnt, .. } in &LESSONS {
        assert!(robot.shows(learnt), "{title}");
    }
    assert_eq!(robot.cut_texts(), [""; 0]);
    robot.click("Copy a link to this pile");
    robot.until("the link", |state| state.notice().is_some());
    robot.key(egui::Key::Escape);
    assert!(!robot.shows("Copy a link to this pile"));
    robot.click("Summary ▶");
    robot.click("Begin again");
    assert!(robot.state().preferences.lesson.predictions.is_empty());
    assert_eq!((robot.state().preferences.lesson.at, asked(&robot)), (0, &["answers"][..]));
}

/// Returns the names of the controls that the present lesson asks the user to use next.
fn asked(robot: &Robot) -> &'static [&'static str] {
    let state = robot.state();
    (LESSONS[state.preferences.lesson.at].asks_for)(&state.run, &state.preferences)
}

/// Returns true if the whole control is visible in a window of the size [`SMALL`].
fn is_in_view(robot: &Robot, name: &str) -> bool {
    let window = egui::Rect::from_min_size(egui::Pos2::ZERO, SMALL);
    robot.state().controls.get(name).is_some_and(|rect| window.contains_rect(*rect))
}

/// Size of the smallest window in which all controls that a lesson needs must be visible, in points.
const SMALL: egui::Vec2 = egui::vec2(1024.0, 700.0);

/// Names of the settings that have a slider in the first view of the window, with the labels of these sliders.
const SLIDERS: [(&str, &str); 4] = [
    ("bond", "Bond, cohesion slider"),
    ("dt", "Δt, time step slider"),
    ("rho", "ρ, restitution slider"),
    ("mu", "μ, friction slider"),
];

#[test]
fn all_that_a_lesson_names_is_in_view_and_sliders_only_where_they_are_used() {
    let of_all = ["lessons", "release", "Δt", "start again", "Plots", "trust", "scene"];
    for (at, lesson) in LESSONS.iter().enumerate() {
        let mut robot = Robot::open(Config::default());
        robot.harness.set_size(SMALL);
        robot.state_mut().visit(at);
        robot.settle();
        robot.frames(20);
        let asked = asked(&robot);
        assert!(!asked.is_empty(), "{}", lesson.title);
        for name in asked.iter().chain(&of_all) {
            assert!(is_in_view(&robot, name), "{}: {name}", lesson.title);
        }
        for (setting, slider) in SLIDERS {
            let is_there = robot.harness.query_by_label(slider).is_some();
            assert_eq!(is_there, lesson.sliders.contains(&setting), "{}: {slider}", lesson.title);
        }
    }
}

#[test]
fn the_lesson_on_bonds_asks_for_one_thing_after_the_other() {
    let mut robot = Robot::open(Config::default());
    robot.harness.set_size(SMALL);
    robot.state_mut().visit(lesson("A pile at rest").0);
    robot.settle();
    robot.frames(20);
    let asks_in_view = |robot: &Robot, name: &str| {
        assert_eq!(asked(robot), [name]);
        assert!(is_in_view(robot, name), "{name}");
    };
    asks_in_view(&robot, "answers");
    robot.click("stay");
    asks_in_view(&robot, "release");
    robot.take_steps(3);
    asks_in_view(&robot, "Δt");
    robot.type_number("Δt, time step", "0.1");
    robot.until("time to go on", |state| state.run.frame.time_secs() > 0.016);
    asks_in_view(&robot, "start again");
    robot.click("start again when I move a slider");
    assert!(asked(&robot).is_empty());
    robot.type_number("Δt, time step", "2e-4");
    let row = robot.observables();
    assert_eq!(row.time_secs, row.step as f64 * row.time_step_secs, "from the start");
}

#[test]
fn a_step_while_the_slider_moves_is_not_the_answer_and_the_next_run_asks_nothing() {
    let (at, lesson) = lesson("A pile at rest");
    let mut robot = Robot::open(Config::default());
    robot.state_mut().visit(at);
    robot.settle();
    robot.click("stay");
    robot.take_steps(3);
    for millis in ["1", "0.5"] {
        let before = robot.steps();
        robot.type_number("Δt, time step", millis);
        robot
            .until("a step", |state| state.run.world().unwrap().snapshot.observables.step > before);
    }
    robot.send(Command::SetPace(Pace::Max));
    robot.until("0.3 s", |state| state.run.frame.time_secs() > 0.35);
    robot.frames(2);
    assert!(robot.shows("With 5 ms the pile had slumped by") && robot.shows("with 0.5 ms by"));
    // A run that continues beyond the end of the scene pauses again after the same time.
    robot.until("the end", |state| !state.run.frame.playing && state.run.frame.time_secs() > 0.99);
    robot.type_number("Δt, time step", "0.6");
    robot.until("as much time", |state| {
        !state.run.frame.playing && state.run.frame.time_secs() > 1.99
    });
    assert!(robot.state().run.frame.time_secs() < 2.01);
    robot.click("start again when I move a slider");
    robot.type_number("Δt, time step", "0.4");
    robot.take_steps(2);
    assert!(robot.shows(lesson.learnt) && !robot.shows("What will the pile at rest do"));
}

#[test]
fn lessons_on_piles_draw_the_forces_of_bonds_and_give_the_choice_back() {
    let mut robot = Robot::open(Config::default());
    let shows_forces = |robot: &Robot| robot.state().preferences.style.show_forces;
    assert!(!shows_forces(&robot));
    for (at, lesson) in LESSONS.iter().enumerate() {
        robot.state_mut().visit(at);
        robot.settle();
        assert_eq!(shows_forces(&robot), lesson.scene == "pile", "lesson {}", at + 1);
    }
    robot.click("Leave");
    assert!(!shows_forces(&robot));
}

#[test]
fn the_run_of_another_lesson_answers_no_question() {
    use slump::app::Prediction;
    let mut robot = Robot::open(Config::default());
    robot.state_mut().visit(lesson("A heavy disc").0);
    robot.settle();
    robot.send(Command::SetPace(Pace::Max));
    robot.send(Command::Play);
    robot.until("the end of the lesson", |state| !state.run.frame.playing);
    assert!(robot.state().run.frame.worlds.len() == 2, "as many worlds as in lesson 1");
    let predicted = Prediction { answer: 1, was_right: Some(true) };
    robot.state_mut().preferences.lesson.predictions.insert(0, predicted);
    robot.state_mut().visit(0);
    for _ in 0..20 {
        assert!(!robot.shows("You said"));
        robot.harness.step();
    }
    robot.settle();
    assert_eq!(robot.state().preferences.lesson.predictions[&0], predicted, "and is kept");
}
