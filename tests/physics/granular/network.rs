//! Rattlers, clusters and shares of contacts, where they can be counted by hand.

use crate::common::*;

use super::by_hand::{among, box_walls, disc, discs, lean, touch};
use super::packings::RADIUS;

const EXACT: f64 = 1e-12;

/// A ring of four discs, to which a chain of two is hung, in which a disc lies that pushes no other, and beside which
/// two discs press each other and one lies alone.
fn ring_and_chain() -> Moment {
    let place = |x: f64, y: f64| disc(2.0 * RADIUS * DVec2::new(x, y), RADIUS);
    let ring = [place(0.0, 0.0), place(1.0, 0.0), place(1.0, 1.0), place(0.0, 1.0)];
    let chain = [place(2.0, 0.0), place(3.0, 0.0)];
    let rattler = disc(2.0 * RADIUS * DVec2::splat(0.5), (2f64.sqrt() - 1.0) * RADIUS);
    let apart = [place(8.0, 0.0), place(9.0, 0.0), place(20.0, 0.0)];
    let mut moment = discs([ring.as_slice(), &chain, &[rattler], &apart].concat());
    for pair in [[1, 0], [2, 1], [3, 2], [3, 0]] {
        touch(&mut moment, pair, [10.0, 0.0]);
    }
    touch(&mut moment, [4, 1], [2.0, 0.0]);
    touch(&mut moment, [5, 4], [2.0, 0.0]);
    // What a solver leaves undone is no force.
    for corner in 0..4 {
        touch(&mut moment, [6, corner], [if corner < 2 { 1e-6 } else { 0.0 }, 0.0]);
    }
    touch(&mut moment, [8, 7], [5.0, 0.0]);
    moment
}

#[test]
fn rattlers_are_taken_away_until_none_is_left() {
    let measured = measure(&ring_and_chain());
    let rattlers: Vec<usize> = (0..10).filter(|&index| measured.grains[index].rattler).collect();
    assert_eq!(rattlers, [4, 5, 6, 7, 8, 9]);
    assert_eq!(measured.pile.rattlers, 6);
    assert_close(measured.pile.coordination, 22.0 / 10.0, EXACT, "Z");
    assert_close(measured.pile.coordination_without_rattlers, 2.0, EXACT, "Z without rattlers");
    let contacts: Vec<u32> = measured.grains.iter().map(|grain| grain.coordination).collect();
    assert_eq!(contacts, [3, 4, 3, 3, 2, 1, 4, 1, 1, 0]);
}

#[test]
fn a_body_that_does_not_move_holds_grains() {
    // Leant into a corner a disc has two contacts; on the floor beside it another has one.
    let floor = [RADIUS, 9.0 * RADIUS].map(|x| disc(DVec2::new(x, RADIUS), RADIUS));
    let walls = box_walls(DVec2::ZERO, DVec2::splat(1.0));
    let mut moment = among(discs(floor.to_vec()), walls, Vec::new());
    lean(&mut moment, 0, 0, [1.0, 0.0]);
    lean(&mut moment, 0, 2, [1.0, 0.0]);
    lean(&mut moment, 1, 2, [1.0, 0.0]);
    let pile = PileMeasures::of(&moment);
    assert_eq!((pile.rattlers, pile.clusters, pile.largest_cluster), (1, 2, 1));
    assert_close(pile.coordination, 1.5, EXACT, "Z");
    assert_close(pile.coordination_without_rattlers, 2.0, EXACT, "Z without rattlers");
}

#[test]
fn clusters_are_what_contacts_join() {
    let mut moment = ring_and_chain();
    let clusters = |moment: &Moment| {
        let pile = PileMeasures::of(moment);
        (pile.clusters, pile.largest_cluster)
    };
    assert_eq!(clusters(&moment), (3, 7));
    // Without the disc that joins the chain's last with the ring.
    moment.grains[4].lost = true;
    assert_eq!(clusters(&moment), (4, 5));
    moment.contacts.clear();
    assert_eq!(clusters(&moment), (9, 1));
}

#[test]
fn shares_are_parts_of_all_contacts() {
    let mut moment = ring_and_chain();
    let count = moment.contacts.len() as f64;
    for index in [0, 4, 7] {
        moment.contacts[index].status = ContactStatus::Slip;
    }
    moment.contacts[1].normal_force = -1.0;
    let pile = PileMeasures::of(&moment);
    let open = moment.contacts.iter().filter(|contact| contact.status == ContactStatus::Open);
    assert_close(pile.sliding_share, 3.0 / count, EXACT, "sliding");
    assert_close(pile.open_share, open.count() as f64 / count, EXACT, "open");
    assert_close(pile.tensile_share, 1.0 / count, EXACT, "tensile");
    assert!(pile.open_share > 0.0);
}

/// Discs beside each other on a plane, under gravity that is turned by an angle (rad).
fn on_a_slope(angle: f64, friction: f64) -> Scene {
    let radius = 0.1;
    let grains = (0..5)
        .map(|k| Grain::at_rest(DVec2::new(4.0 * radius * f64::from(k), radius - 1e-9), radius));
    let gravity = G * DVec2::new(angle.sin(), -angle.cos());
    Scene {
        boundaries: vec![level()],
        ..scene(Physics::FULL, gravity, parameters(0.0, 1e-3, 0.0, friction), grains.collect())
    }
}

#[test]
fn on_a_slope_discs_slip_where_friction_is_below_a_third_of_its_tangent() {
    let angle = 0.5f64;
    for (friction, share) in [(0.9 * angle.tan() / 3.0, 1.0), (1.1 * angle.tan() / 3.0, 0.0)] {
        let run = after(&on_a_slope(angle, friction), 10);
        let pile = PileMeasures::of(&run.moment());
        assert_eq!((pile.contacts, pile.sliding_share), (5, share), "μ = {friction}");
        assert_eq!((pile.open_share, pile.clusters, pile.rattlers), (0.0, 5, 5));
    }
}
