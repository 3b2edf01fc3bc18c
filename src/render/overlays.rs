//! Overlays that are drawn on the grains: lines for contact forces, arrows for velocities, and arrows for moving walls
//! and other bodies that are not grains.

use std::f64::consts::TAU;

use glam::DVec2;

use super::camera::half_size;
use super::numbers::round_above;
use super::walls::clip;
use super::{Camera, Colour, LinkInstance, Palette, Style};
use crate::sim::{MotionView, Snapshot, Surroundings};
use crate::world::Edge;

/// Full width of the lines that show contact forces, in mean diameters. The reference force ([`force_reference`]) and
/// larger forces have this width; smaller forces have narrower lines.
const FORCE_WIDTH: f64 = 0.4;
/// Smallest contact force that is drawn, as a fraction of the force whose line has the full width
/// ([`force_reference`]). Lines of smaller forces would be too thin to be visible.
const LEAST_FORCE: f64 = 0.004;
/// Quantile that gives the reference force (the force whose line has the full width) if the style states none: this
/// fraction of the contacts whose force is not 0 have a smaller force, so their lines are narrower.
const REFERENCE_QUANTILE: f64 = 0.95;

/// Returns the reference force, newtons: the magnitude of the normal contact force whose line has the full width. It is
/// the force that the style states, or else the 95th percentile of the snapshot's forces, so that a single huge force
/// does not make all other lines invisible. 0 if there are no forces.
pub(crate) fn force_reference(style: &Style, snapshot: &Snapshot) -> f64 {
    style.force_reference.unwrap_or_else(|| {
        let mut forces: Vec<f64> = snapshot
            .contacts
            .iter()
            .map(|contact| contact.normal_force.abs())
            .filter(|force| *force > 0.0 && force.is_finite())
            .collect();
        forces.sort_by(f64::total_cmp);
        let index = (REFERENCE_QUANTILE * forces.len() as f64) as usize;
        forces.get(index).copied().unwrap_or(0.0)
    })
}

/// Returns half of the full width of the lines that show contact forces, pixels. The reference force
/// ([`force_reference`]) and larger forces have lines of full width.
pub(super) fn full_half_width_px(mean_diameter: f64, camera: &Camera) -> f32 {
    camera.pixels(0.5 * FORCE_WIDTH * mean_diameter)
}

/// Returns the force lines of all visible contacts, the strongest force on top.
pub(super) fn force_links(
    snapshot: &Snapshot,
    style: &Style,
    palette: &Palette,
    camera: &Camera,
    size: [u32; 2],
) -> Vec<LinkInstance> {
    let reference = force_reference(style, snapshot);
    if !(reference > 0.0 && reference.is_finite()) {
        return Vec::new();
    }
    let full = full_half_width_px(snapshot.surroundings.mean_diameter, camera);
    let periodic = snapshot.surroundings.periodic;
    let reach = half_size(size) + f64::from(full) + 1.0;
    let mut shown: Vec<_> = snapshot
        .contacts
        .iter()
        .map(|contact| (contact, (contact.normal_force.abs() / reference).min(1.0)))
        .filter(|(_, part)| *part >= LEAST_FORCE)
        .collect();
    shown.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    shown
        .into_iter()
        .flat_map(|(contact, part)| {
            // A contact across a periodic border is drawn on both sides of the period.
            let reach = [contact.from.min(contact.to), contact.from.max(contact.to)];
            let images = periodic.into_iter().flat_map(move |periodic| periodic.images(reach));
            std::iter::once(DVec2::ZERO).chain(images).map(move |by| (contact, part, by))
        })
        .filter_map(|(contact, part, by)| {
            let ends = [camera.offset_px(contact.from + by), camera.offset_px(contact.to + by)];
            let colour = if contact.normal_force < 0.0 { palette.pull } else { palette.push };
            let ends = clip(ends[0], ends[1], reach)?;
            Some(LinkInstance::new(ends, full * part as f32, colour))
        })
        .collect()
}

/// Full length of a velocity arrow, in mean diameters: the length at the reference speed ([`speed_reference`]).
const VELOCITY_LENGTH: f64 = 2.5;
/// Smallest speed of a grain that has a velocity arrow, as a fraction of the speed whose arrow has the full length
/// ([`speed_reference`]). Shorter arrows would look like dots.
const LEAST_VELOCITY: f64 = 0.03;
/// Half of the width of a velocity arrow's shaft, in mean diameters.
const VELOCITY_HALF_WIDTH: f64 = 0.05;
/// Length of the two barbs of the head of a velocity arrow of full length, in mean diameters; barbs of shorter arrows
/// are shorter.
const VELOCITY_BARB: f64 = 0.35;

/// Returns the reference speed, m/s: the speed whose velocity arrow has the full length. It is the speed that the style
/// states, or else a round number above the speed of the fastest grain. 0 if no grain moves.
pub(crate) fn speed_reference(style: &Style, snapshot: &Snapshot) -> f64 {
    if let Some(reference) = style.speed_reference {
        return reference;
    }
    let speeds = snapshot.grains.iter().map(|grain| grain.velocity.length());
    let fastest = speeds.filter(|speed| speed.is_finite()).fold(0.0, f64::max);
    // Below this speed a pile is at rest, and arrows would only show rounding errors.
    let least = 1e-9 * snapshot.surroundings.gravity_magnitude.max(1.0);
    if fastest > least { round_above(fastest) } else { 0.0 }
}

/// Returns the full length of a velocity arrow, m in the scene: the length at the reference speed
/// ([`speed_reference`]).
pub(super) fn full_length(snapshot: &Snapshot) -> f64 {
    VELOCITY_LENGTH * snapshot.surroundings.mean_diameter
}

/// Returns the lines of which the velocity arrows of all visible grains consist.
pub(super) fn velocity_links(
    snapshot: &Snapshot,
    style: &Style,
    colour: Colour,
    camera: &Camera,
    size: [u32; 2],
) -> Vec<LinkInstance> {
    let reference = speed_reference(style, snapshot);
    if reference.is_nan() || reference <= 0.0 {
        return Vec::new();
    }
    let diameter = snapshot.surroundings.mean_diameter;
    let half_width = camera.pixels(VELOCITY_HALF_WIDTH * diameter).max(0.6);
    let reach = half_size(size) + f64::from(half_width) + 1.0;
    let mut links = Vec::new();
    for grain in &snapshot.grains {
        let part = grain.velocity / reference;
        // A NaN velocity has no arrow.
        if part.length().is_nan() || part.length() < LEAST_VELOCITY {
            continue;
        }
        let shaft = part * full_length(snapshot);
        let tip = grain.position + shaft;
        let barb = shaft.normalize_or_zero() * VELOCITY_BARB * diameter * part.length().sqrt();
        let barbs =
            [DVec2::from_angle(2.6), DVec2::from_angle(-2.6)].map(|turn| tip + turn.rotate(barb));
        for (from, to) in [(grain.position, tip), (tip, barbs[0]), (tip, barbs[1])] {
            let ends = [camera.offset_px(from), camera.offset_px(to)];
            let ends = clip(ends[0], ends[1], reach);
            links.extend(ends.map(|ends| LinkInstance::new(ends, half_width, colour)));
        }
    }
    links
}

// All lengths below are in units of the font size of the picture's labels.

/// Length of an arrow that shows how a wall or disc moves, in font sizes of the labels.
const LENGTH_EM: f64 = 1.7;
/// Length of the two barbs of the head of an arrow that shows how a wall or disc moves, in font sizes of the labels.
const BARB_EM: f64 = 0.5;
/// Distance between the two heads of an arrow that shows the force that drives a wall or disc, in font sizes of the
/// labels.
const SECOND_HEAD_EM: f64 = 0.42;
/// Half of the width of the lines of an arrow that shows how a wall or disc moves, in font sizes of the labels.
const HALF_WIDTH_EM: f64 = 0.075;
/// Width of the border around the lines of an arrow that shows how a wall or disc moves, in font sizes of the labels.
/// The border has the colour of the background, so that the arrow is visible on grains.
const HALO_EM: f64 = 0.07;
/// Smallest distance between two arrows that show the motion of the same body or group of bodies, in font sizes of the
/// labels.
const SPACING_EM: f64 = 4.0;
/// Distance from a wall to the arrow that shows that the wall moves parallel to its surface, in font sizes of the
/// labels.
const BESIDE_EM: f64 = 0.75;
/// Distance from a wall or disc to the middle of the arrow that shows the force that drives this wall or disc, in font
/// sizes of the labels.
const LOAD_EM: f64 = 1.75;
/// Radius of the arc that shows a rotation around a pivot, in font sizes of the labels.
const ARC_EM: f64 = 0.9;
/// Angle of the arc that shows a rotation around a pivot, rad.
const ARC_TURN: f64 = 0.75 * TAU;
/// Number of straight pieces of which the arc that shows a rotation consists.
const ARC_PIECES: usize = 18;
/// Speed below which a wall or disc has no arrow, in mean diameters per second.
const LEAST_DIAMETERS_PER_SEC: f64 = 1e-9;
/// Smallest cosine of the angle between a wall and its velocity at which the motion counts as parallel to the wall.
const ALONG: f64 = 0.9;

struct MotionArrows<'a> {
    camera: &'a Camera,
    em: f64,
    reach: DVec2,
    least_speed: f64,
    lines: Vec<[DVec2; 2]>,
}

struct Spot {
    /// Position of the arrow in the scene, m.
    place: DVec2,
    /// Position of the arrow in the picture, pixels from the middle, y up.
    at: DVec2,
    /// For an arrow on a wall: the unit normal of the wall (out of the solid, if one side is solid), and true if
    /// neither side is solid. `None` for an arrow on a disc.
    normal: Option<(DVec2, bool)>,
}

/// Returns the lines of the arrows that show how walls and discs that are not grains move, in a picture of `size`
/// pixels: arrows on moving bodies, arrows with two heads on bodies that a force drives, and an arc with a head around
/// a pivot. An arrow shows the direction, not the speed. Its length depends on the font size, so that the arrow of a
/// slow wall is also visible.
pub(super) fn motion_links(
    surroundings: &Surroundings,
    palette: &Palette,
    camera: &Camera,
    size: [u32; 2],
    text_px: f32,
) -> Vec<LinkInstance> {
    let em = f64::from(text_px);
    let reach = half_size(size) + em;
    let least_speed = LEAST_DIAMETERS_PER_SEC * surroundings.mean_diameter;
    let mut arrows = MotionArrows { camera, em, reach, least_speed, lines: Vec::new() };
    for motion in &surroundings.moving {
        arrows.of_motion(motion, surroundings);
    }
    let links = |half_width: f64, colour: Colour| {
        let clipped = arrows.lines.iter().filter_map(|[from, to]| clip(*from, *to, reach));
        let link = |ends| LinkInstance::new(ends, half_width as f32, colour);
        clipped.map(link).collect::<Vec<_>>()
    };
    let half_width = (HALF_WIDTH_EM * em).max(0.7);
    let mut all = links(half_width + HALO_EM * em, palette.ground);
    all.extend(links(half_width, palette.ink));
    all
}

impl MotionArrows<'_> {
    fn of_motion(&mut self, motion: &MotionView, surroundings: &Surroundings) {
        let spots = self.spots(motion, surroundings);
        for (index, spot) in spots.iter().enumerate() {
            let velocity = motion.velocity_at(spot.place);
            if velocity.length() > self.least_speed {
                let beside = self.beside(spot, velocity);
                self.arrow(spot.at + beside, velocity, 1);
            }
            if motion.surface_speed != 0.0 {
                self.belt(spot, motion.surface_speed);
            }
            // One force drives all bodies of a motion together, so the force has one arrow.
            if motion.force != DVec2::ZERO && index == spots.len() / 2 {
                let before = -LOAD_EM * self.em * motion.force.normalize_or_zero();
                self.arrow(spot.at + before, motion.force, 2);
            }
        }
        if motion.angular_velocity != 0.0 {
            self.arc(self.camera.offset_px(motion.pivot), ARC_EM, motion.angular_velocity);
        }
    }

    /// Returns the positions of the arrows that show a motion: on all bodies with this motion, but not too close to
    /// each other.
    fn spots(&self, motion: &MotionView, surroundings: &Surroundings) -> Vec<Spot> {
        let boundaries =
            motion.boundaries.iter().filter_map(|&index| surroundings.boundaries.get(index));
        let walls = boundaries.flat_map(|boundary| boundary.edges());
        let walls = walls.map(|edge| self.spot_on(edge));
        let discs =
            motion.fixed_discs.iter().filter_map(|&index| surroundings.fixed_discs.get(index));
        let discs = discs.map(|disc| {
            let at = self.camera.offset_px(disc.position);
            Spot { place: disc.position, at, normal: None }
        });
        let mut spots: Vec<Spot> = Vec::new();
        for spot in walls.chain(discs) {
            let is_free = |other: &Spot| other.at.distance(spot.at) >= SPACING_EM * self.em;
            if spot.at.abs().cmple(self.reach).all() && spots.iter().all(is_free) {
                spots.push(spot);
            }
        }
        spots
    }

    /// Returns the position of the arrow on an edge (a line or line segment of the outline of a wall): the middle of
    /// the edge or, on an infinite edge, the point nearest to the middle of the picture.
    fn spot_on(&self, edge: Edge) -> Spot {
        match edge {
            Edge::Endless { point, normal } => {
                let normal = normal.normalize_or_zero();
                let foot = self.camera.offset_px(point).dot(normal) * normal;
                Spot { place: self.camera.unproject(foot), at: foot, normal: Some((normal, false)) }
            }
            Edge::Wall([from, to]) | Edge::Side([from, to]) => {
                let place = 0.5 * (from + to);
                let normal = -(to - from).perp().normalize_or_zero();
                let is_open = matches!(edge, Edge::Wall(_));
                Spot { place, at: self.camera.offset_px(place), normal: Some((normal, is_open)) }
            }
        }
    }

    /// Returns the offset of an arrow from its position on the body, pixels. The arrow of a wall that moves parallel to
    /// its surface is drawn beside the wall; if the wall is the surface of a solid, the arrow is inside the solid. All
    /// other arrows have the offset 0.
    fn beside(&self, spot: &Spot, velocity: DVec2) -> DVec2 {
        let Some((normal, _)) = spot.normal else { return DVec2::ZERO };
        let along = velocity.normalize_or_zero().dot(normal.perp()).abs() > ALONG;
        if along { -BESIDE_EM * self.em * normal } else { DVec2::ZERO }
    }

    /// Draws the arrows of a body whose surface moves although the body does not, such as a conveyor belt.
    fn belt(&mut self, spot: &Spot, speed: f64) {
        let Some((normal, is_open)) = spot.normal else {
            return self.arc(spot.at, ARC_EM, speed);
        };
        let sides: &[f64] = if is_open { &[1.0, -1.0] } else { &[1.0] };
        for side in sides {
            let outward = *side * normal;
            // A wall without a solid has arrows on both sides; a solid has one arrow inside.
            let place = if is_open { outward } else { -outward };
            self.arrow(spot.at + BESIDE_EM * self.em * place, speed * outward.perp(), 1);
        }
    }

    /// Draws an arrow in the direction `along`, with one or two heads. Its middle is at the pixel position `middle`.
    fn arrow(&mut self, middle: DVec2, along: DVec2, heads: u32) {
        let along = along.normalize_or_zero();
        let half = 0.5 * LENGTH_EM * self.em * along;
        self.lines.push([middle - half, middle + half]);
        for head in 0..heads {
            self.head(middle + half - f64::from(head) * SECOND_HEAD_EM * self.em * along, along);
        }
    }

    fn head(&mut self, tip: DVec2, along: DVec2) {
        for turn in [2.5, -2.5] {
            let barb = DVec2::from_angle(turn).rotate(along) * (BARB_EM * self.em);
            self.lines.push([tip, tip + barb]);
        }
    }

    /// Draws an arc with an arrowhead around the pixel position `centre`. Its radius is `radius_em`, in font sizes of
    /// the labels. The arc runs anticlockwise if the rate of rotation, `rate`, is positive, and clockwise if it is
    /// negative.
    fn arc(&mut self, centre: DVec2, radius_em: f64, rate: f64) {
        if !centre.abs().cmple(self.reach).all() {
            return;
        }
        let turn = ARC_TURN * rate.signum() / ARC_PIECES as f64;
        let first = -0.5 * ARC_TURN * rate.signum() + 0.25 * TAU;
        let place = |piece: usize| {
            centre + radius_em * self.em * DVec2::from_angle(first + turn * piece as f64)
        };
        let points: Vec<DVec2> = (0..=ARC_PIECES).map(place).collect();
        self.lines.extend(points.windows(2).map(|ends| [ends[0], ends[1]]));
        let last = points[ARC_PIECES];
        self.head(last, rate.signum() * (last - centre).perp().normalize_or_zero());
    }
}

#[cfg(test)]
mod tests {

    use super::*;
    use crate::render::Theme;
    use crate::world::{Boundary, Disc};

    const CAMERA: Camera = Camera { centre: DVec2::ZERO, metres_per_pixel: 0.01 };

    fn lines(
        boundaries: Vec<Boundary>,
        fixed_discs: Vec<Disc>,
        moving: MotionView,
    ) -> Vec<LinkInstance> {
        let surroundings = Surroundings {
            fixed_discs,
            boundaries,
            centre_of_attraction: None,
            periodic: None,
            materials: Vec::new(),
            mean_diameter: 0.1,
            gravity_magnitude: 9.8,
            moving: vec![moving],
        };
        let palette = Theme::Light.palette();
        let links = motion_links(&surroundings, &palette, &CAMERA, [800, 600], 16.0);
        // The second half of the links is the arrows themselves; the first half is their halo.
        links[links.len() / 2..].to_vec()
    }

    fn wall() -> Vec<Boundary> {
        vec![Boundary::Segment { from: DVec2::new(-1.0, 0.0), to: DVec2::new(1.0, 0.0) }]
    }

    #[test]
    fn an_arrow_lies_on_what_moves_and_points_where_it_goes() {
        let velocity = DVec2::new(0.0, -0.3);
        let motion = MotionView { boundaries: vec![0], velocity, ..MotionView::default() };
        let drawn = lines(wall(), Vec::new(), motion.clone());
        assert_eq!(drawn.len(), 3, "a shaft and two barbs");
        assert_eq!(drawn[0].start[0], 0.0);
        assert!(drawn[0].start[1] > 0.0 && drawn[0].end[1] < 0.0);
        // An arrow with a second head shows a driving force.
        let force = MotionView { force: DVec2::Y, ..motion.clone() };
        assert_eq!(lines(wall(), Vec::new(), force).len(), 3 + 5);
        let still = MotionView { velocity: DVec2::ZERO, ..motion };
        assert!(lines(wall(), Vec::new(), still).is_empty());
    }

    #[test]
    fn what_turns_has_arrows_round_the_pivot_and_an_arc_at_it() {
        let disc = |angle: f64| Disc { position: DVec2::from_angle(angle), radius: 0.05 };
        let discs: Vec<Disc> = (0..8).map(|index| disc(TAU * f64::from(index) / 8.0)).collect();
        let turning = MotionView {
            fixed_discs: (0..8).collect(),
            angular_velocity: -2.0,
            ..MotionView::default()
        };
        let drawn = lines(Vec::new(), discs, turning);
        assert_eq!(drawn.len(), 8 * 3 + ARC_PIECES + 2);
        for shaft in drawn[..24].chunks(3).map(|arrow| &arrow[0]) {
            let [from, to] = [shaft.start, shaft.end].map(|[x, y]| DVec2::new(x.into(), y.into()));
            assert!(from.perp_dot(to - from) < 0.0, "clockwise");
        }
    }

    #[test]
    fn arrows_of_one_motion_keep_apart() {
        let disc =
            |index: u32| Disc { position: DVec2::new(0.01 * f64::from(index), 0.0), radius: 0.05 };
        let motion = MotionView {
            fixed_discs: (0..100).collect(),
            velocity: DVec2::X,
            ..MotionView::default()
        };
        let drawn = lines(Vec::new(), (0..100).map(disc).collect(), motion);
        assert_eq!(drawn.len(), 3 * 2, "100 pixels have room for two");
    }

    #[test]
    fn a_belt_goes_along_its_wall() {
        let floor = vec![Boundary::HalfSpace { point: DVec2::new(3.0, 0.0), normal: DVec2::Y }];
        let belt = MotionView { boundaries: vec![0], surface_speed: 0.5, ..MotionView::default() };
        let drawn = lines(floor, Vec::new(), belt);
        // The arrow points to the left on a floor, below the surface.
        assert!(drawn[0].end[0] < drawn[0].start[0] && drawn[0].start[1] < 0.0);
    }
}
