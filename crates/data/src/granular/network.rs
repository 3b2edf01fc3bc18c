//! What of a moment counts: the grains that are not lost, and their contacts.

use glam::DVec2;

use crate::sim::{ContactState, ContactStatus, GrainState, Moment, OtherBody};

/// A contact bears a force where that is more than so much of the mean force of all contacts. Smaller: what a solver
/// leaves undone holds grains that nothing holds; larger: weak contacts do not count.
const BEARS_FROM: f64 = 1e-6;

/// Grains and contacts that count.
pub(super) struct Network<'a> {
    pub grains: &'a [GrainState],
    /// Whether a grain counts. No index of a link is one of those that do not.
    pub counts: Vec<bool>,
    pub links: Vec<Link>,
}

/// A contact that counts. Vectors in m and N.
pub(super) struct Link {
    /// Grain i.
    pub grain: usize,
    /// Grain j, unless i touches a body that no grain moves.
    pub other: Option<usize>,
    pub normal: DVec2,
    pub gap: f64,
    /// From the contact point to the centre of i: half of the gap is its own where j is a grain, else all of it.
    pub own_branch: DVec2,
    /// From the centre of grain j to the contact point, or none.
    pub other_branch: DVec2,
    /// On grain i.
    pub force: DVec2,
    pub normal_force: f64,
    pub status: ContactStatus,
    /// Whether it bears a force.
    pub bears: bool,
}

impl Link {
    /// ℓ: to the centre of i from that of grain j, or from the touched point of another body.
    pub(super) fn branch(&self) -> DVec2 {
        self.own_branch + self.other_branch
    }

    /// The grains at its ends.
    pub(super) fn ends(&self) -> impl Iterator<Item = usize> {
        [Some(self.grain), self.other].into_iter().flatten()
    }
}

impl<'a> Network<'a> {
    pub(super) fn of(moment: &'a Moment) -> Self {
        let grains = &moment.grains;
        let counts: Vec<bool> =
            grains.iter().map(|grain| !grain.lost && grain.position.is_finite()).collect();
        let counted = |index: u32| counts.get(index as usize).is_some_and(|&counts| counts);
        let both_count = |contact: &&ContactState| {
            let other = match contact.other {
                OtherBody::Grain(index) => counted(index),
                OtherBody::FixedDisc(_) | OtherBody::Boundary(_) => true,
            };
            counted(contact.grain) && other
        };
        let mut links: Vec<Link> = moment
            .contacts
            .iter()
            .filter(both_count)
            .map(|contact| link(contact, grains[contact.grain as usize].radius))
            .collect();
        let sum: f64 = links.iter().map(|link| link.force.length()).sum();
        let bears_from = BEARS_FROM * sum / links.len() as f64;
        for link in &mut links {
            link.bears = link.force.length() > bears_from;
        }
        Self { grains, counts, links }
    }

    /// The grains that count, with their indices.
    pub(super) fn grains(&self) -> impl Iterator<Item = (usize, &'a GrainState)> {
        let counted = self.grains.iter().zip(&self.counts).enumerate();
        counted.filter_map(|(index, (grain, &counts))| counts.then_some((index, grain)))
    }

    /// Number of grains that count.
    pub(super) fn len(&self) -> usize {
        self.grains().count()
    }

    /// Part of the contacts of which something is true; NaN without contacts.
    pub(super) fn share(&self, is_so: impl Fn(&Link) -> bool) -> f64 {
        let count = self.links.iter().filter(|&link| is_so(link)).count();
        count as f64 / self.links.len() as f64
    }
}

fn link(contact: &ContactState, radius: f64) -> Link {
    let of_two_grains = matches!(contact.other, OtherBody::Grain(_));
    let own_gap = if of_two_grains { 0.5 * contact.gap } else { contact.gap };
    let own_branch = (radius + own_gap) * contact.normal;
    let (other, other_branch) = match contact.other {
        OtherBody::Grain(index) => (Some(index as usize), contact.branch - own_branch),
        OtherBody::FixedDisc(_) | OtherBody::Boundary(_) => (None, DVec2::ZERO),
    };
    Link {
        grain: contact.grain as usize,
        other,
        normal: contact.normal,
        gap: contact.gap,
        own_branch,
        other_branch,
        force: contact.force(),
        normal_force: contact.normal_force,
        status: contact.status,
        bears: false,
    }
}
