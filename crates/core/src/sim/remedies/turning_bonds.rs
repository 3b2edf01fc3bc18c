//! Remedy `turning-bonds`: bonded grains circle each other without losing their bond.
//!
//! A step takes the normal n of a contact from its beginning, and grains move along straight lines. Let two grains with
//! the distance L between their centres have the relative velocity v_n n + v_t t (v_t: velocity of the centres along the
//! tangent t, m/s; Δt: time step, s). At the end of the step their distance is
//!
//! > √((L + v_nΔt)² + v_t²Δt²).
//!
//! With v_n = 0 it has grown by about v_t²Δt²/(2L) (`sim::turned_bonds`), which ends the bond at touch tolerance 0. The
//! distance stays L if the grains approach at the speed
//!
//! > a = (L − √(L² − v_t²Δt²))/Δt.
//!
//! So this remedy lets cohesive contacts approach at the speed a: it requires v_n + a = 0 instead of the condition v_n
//! = 0 of Abramian & Staron (2020). In the next step the normal has turned by the angle v_tΔt/L, so that the same
//! relative velocity has the normal component +a. The impulse that turns the velocity in a step is thus about m_ij
//! v_t²Δt/L (m_ij: effective mass), which is Δt times the centripetal force m_ij v_t²/L of the circular motion. The
//! bond ends if the centripetal force exceeds the cohesion force Bond·m_ij·g (Bond: Bond number, g: gravity): for two
//! grains of radius r above the angular velocity √(Bond·g/(2r)).

use crate::contact::{Contact, Numbering, Other};
use crate::sim::state::State;
use crate::sim::stepping::Stage;
use crate::solver::Model;

/// Changes the contact law of cohesive contacts so that the two bodies approach each other at the speed that keeps the
/// distance between their centres although they circle each other. This concerns contacts between grains, and between
/// grains and fixed discs that do not move. Contacts with walls stay unchanged, because walls are flat or bounded by
/// corners. The time step is `time_step_secs`, s.
pub(in crate::sim) fn let_turn<M: Model>(stage: &mut Stage<'_, M>, time_step_secs: f64) {
    let Stage { state, problem, .. } = stage;
    if M::AXES < 2 || problem.law.capture_speed() == 0.0 {
        return;
    }
    let centre = |body: &M::Body<f64>| {
        let [x, y, _] = M::coordinates(body);
        M::from_coordinates([x, y, 0.0])
    };
    let before = &problem.bodies.before;
    let approach = |number: usize| {
        let row = problem.rows.get(number);
        let i = centre(&before[row.i as usize]);
        let [_, tangential] = match problem.rows.is_pair(number) {
            true => M::relative_velocity(row.normal, &i, &centre(&before[row.j as usize])),
            false => M::velocity(row.normal, &i),
        };
        let contact = &state.contacts.contacts()[problem.rows.contacts[number] as usize];
        let distance = distance(state, contact)?;
        let way = (tangential * time_step_secs).abs().min(distance);
        let kept = (distance * distance - way * way).sqrt();
        (problem.capture(number) > 0.0).then(|| way * way / (distance + kept) / time_step_secs)
    };
    let approaches: Vec<_> = (0..problem.rows.len()).map(approach).collect();
    for (number, approach) in approaches.into_iter().enumerate() {
        problem.rows.get_mut(number).restitution_velocity += approach.unwrap_or(0.0);
    }
}

/// Returns the distance between the centres of the two discs of a contact, m; `None` if the second body is a wall, or a
/// fixed disc that moves.
fn distance(State { world, walls, .. }: &State, contact: &Contact) -> Option<f64> {
    let other = match Numbering::of(world).other(contact.other) {
        Other::Grain(grain) => world.grains.radii[grain],
        Other::FixedDisc(disc) if walls.surface(world, contact).is_none() => {
            world.fixed_discs[disc].radius
        }
        _ => return None,
    };
    Some(world.grains.radii[contact.grain as usize] + other + contact.gap)
}
