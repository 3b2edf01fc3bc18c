//! Saved runs in the window.

use slump::scene::{SavedState, built_in};
use slump::sim::Tally;

use crate::robot::{Robot, bits, pile};

#[test]
fn a_saved_run_goes_on_in_the_window_as_it_would_have_without() {
    let scene = built_in("moving-walls").expect("a scene");
    let mut simulation = scene.simulation().expect("a sound scene");
    simulation.take_steps(40).expect("finite states");
    let saved = SavedState::new(scene, simulation.clone(), Tally::default());
    let saved = SavedState::from_bytes(&saved.to_bytes().expect("bytes"), "a.slump");

    let mut robot = Robot::open(pile());
    robot.state_mut().load_run(saved.expect("a sound state"));
    robot.until("the saved run", |state| {
        state.world().is_some_and(|world| world.snapshot.observables.step == 40)
    });
    assert_eq!(robot.state().frame.time_secs(), simulation.time_secs());
    for _ in 0..20 {
        robot.state_mut().step();
    }
    robot.settle();
    simulation.take_steps(20).expect("finite states");
    assert_eq!(robot.steps(), 60);
    let positions = |place: [u64; 6]| [place[0], place[1]].map(f64::from_bits);
    let shown: Vec<_> = bits(robot.world()).into_iter().map(positions).collect();
    let expected = simulation.world().grains.positions.iter().map(|place| place.to_array());
    assert!(shown.into_iter().eq(expected));
}
