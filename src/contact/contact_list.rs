//! The contacts of one step, with the impulses of the step before where a contact lives on.

use glam::DVec2;

use super::Candidates;
use crate::world::World;

/// One touching pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Grain i.
    pub grain: u32,
    /// Body j, numbered through: grains, fixed discs, features of boundaries.
    pub other: u32,
    /// n, from j to i. On a line its y component is 0.
    pub normal: DVec2,
    /// m; negative is overlap.
    pub gap: f64,
}

impl Contact {
    fn pair(&self) -> (u32, u32) {
        (self.grain, self.other)
    }
}

/// The impulses of one contact, N·s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Impulse {
    /// P_n.
    pub normal: f64,
    /// P_t.
    pub tangential: f64,
}

/// The contacts of a step, sorted by (i, other), and their impulses. Memory is kept between steps.
#[derive(Clone, Debug, Default)]
pub struct ContactList {
    contacts: Vec<Contact>,
    impulses: Vec<Impulse>,
    contacts_before: Vec<Contact>,
    impulses_before: Vec<Impulse>,
}

impl ContactList {
    /// The contacts, sorted by (i, other).
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// The impulses, one a contact.
    pub fn impulses(&self) -> &[Impulse] {
        &self.impulses
    }

    /// The impulses, one a contact, to be filled in by the solver.
    pub fn impulses_mut(&mut self) -> &mut [Impulse] {
        &mut self.impulses
    }

    /// Multiplies all impulses, so that a change of Δt leaves the forces as they were.
    pub fn scale_impulses(&mut self, factor: f64) {
        for impulse in &mut self.impulses {
            impulse.normal *= factor;
            impulse.tangential *= factor;
        }
    }

    /// Finds the contacts at the present positions: candidates with a gap below the tolerance. A
    /// contact that was there the step before starts from its impulses of then, any other from 0.
    pub fn detect<const AXES: usize>(&mut self, world: &World, candidates: &Candidates) {
        std::mem::swap(&mut self.contacts, &mut self.contacts_before);
        std::mem::swap(&mut self.impulses, &mut self.impulses_before);
        self.contacts.clear();
        self.impulses.clear();
        let grains = &world.grains;
        let gap_tolerance = candidates.gap_tolerance();
        let mut before = 0;
        for index in 0..grains.len() {
            let (position, radius) = (grains.positions[index], grains.radii[index]);
            for &other in candidates.of(index) {
                let Some((normal, gap)) =
                    approach::<AXES>(world, candidates, position, radius, other as usize)
                else {
                    continue;
                };
                if gap >= gap_tolerance {
                    continue;
                }
                let contact = Contact { grain: index as u32, other, normal, gap };
                // Both lists are sorted alike, so one walk over the old one serves all.
                while before < self.contacts_before.len()
                    && self.contacts_before[before].pair() < contact.pair()
                {
                    before += 1;
                }
                let lives_on = self
                    .contacts_before
                    .get(before)
                    .is_some_and(|old| old.pair() == contact.pair());
                self.impulses.push(if lives_on {
                    self.impulses_before[before]
                } else {
                    Impulse::default()
                });
                self.contacts.push(contact);
            }
        }
    }
}

/// Normal and gap between a disc and another body, or nothing where another feature tells of the
/// touched point.
#[inline(always)]
fn approach<const AXES: usize>(
    world: &World,
    candidates: &Candidates,
    position: DVec2,
    radius: f64,
    other: usize,
) -> Option<(DVec2, f64)> {
    let grains = &world.grains;
    if other < grains.len() {
        return Some(disc_gap::<AXES>(
            position,
            grains.positions[other],
            radius + grains.radii[other],
        ));
    }
    let fixed = other - grains.len();
    if fixed < world.fixed_discs.len() {
        let disc = world.fixed_discs[fixed];
        return Some(disc_gap::<AXES>(position, disc.position, radius + disc.radius));
    }
    let feature = &candidates.features()[fixed - world.fixed_discs.len()];
    feature.distance(position).map(|(normal, distance)| (normal, distance - radius))
}

/// Normal (from j to i) and gap of two discs. Centres that coincide are told apart along x, so that
/// the step stays finite.
#[inline(always)]
fn disc_gap<const AXES: usize>(i: DVec2, j: DVec2, radii: f64) -> (DVec2, f64) {
    if AXES == 1 {
        let offset = i.x - j.x;
        return (DVec2::new(1f64.copysign(offset), 0.0), offset.abs() - radii);
    }
    let offset = i - j;
    let distance = offset.length();
    let normal = if distance > 0.0 { offset / distance } else { DVec2::X };
    (normal, distance - radii)
}
