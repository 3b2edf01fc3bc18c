//! The way of one disc that is dropped: it falls, rolls over what it meets, and comes to lie where two
//! others, or one and a wall, hold it (W. M. Visscher, M. Bolsterli, *Random packing of equal and
//! unequal spheres in two and three dimensions*, 1972; W. S. Jodrey, E. M. Tory, *Simulation of random
//! packing of spheres*, 1979).
//!
//! Nothing is stepped. A disc of radius r on one of radius r_i at c_i has its centre on the circle of
//! radius R = r + r_i about c_i, at an angle φ from the vertical, and rolls to where the first of these
//! happens: another disc k is met, φ = α − β with α the angle of c_k from c_i, D its distance and
//!
//! > cos β = (R² + D² − (r + r_k)²) / (2 R D);
//!
//! the wall is met, sin φ = (distance of the centre's reach from c_i) / R; the floor is met; or φ = 90°,
//! where it falls off. What is met holds the disc where it is on the other side of the disc's centre
//! than i. Else the disc rolls on over what it has met.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec2;

use super::surface::{GRAZING, Surface};

/// What holds a disc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// The disc of that index on the surface.
    Disc(usize),
    /// The nearer wall.
    Wall,
    /// The floor.
    Floor,
}

/// Where a disc has come to lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Its centre, m.
    pub centre: DVec2,
    /// What it lies on, and what else it leans against, if that is needed.
    pub supports: (Support, Option<Support>),
}

/// Angle by which a contact may lie behind a disc that rolls, from rounding alone, rad.
const ROUNDING: f64 = 1e-9;

/// Where a disc of that radius comes to lie that is dropped at `x` from above all others. The radius is
/// at most the surface's largest, and x leaves it between the walls.
pub fn dropped(surface: &Surface, x: f64, radius: f64) -> Rest {
    let mut fall = Fall { from: DVec2::new(x, f64::INFINITY), left: None, side: 1.0 };
    loop {
        let DVec2 { x, y } = fall.from;
        let Some((height, index)) = surface.landing(x, radius, y, fall.left) else {
            let centre = DVec2::new(x, surface.floor() + radius);
            return Rest { centre, supports: (Support::Floor, None) };
        };
        let centre = DVec2::new(x, height);
        let aside = x - surface.discs()[index].position.x;
        let side = if aside == 0.0 { fall.side } else { aside.signum() };
        // Each fall ends lower than the one before, so there is a last one.
        match rolled(surface, Roll { radius, centre, on: index, side }) {
            End::Rests(rest) => return rest,
            End::FallsOff(next) => fall = next,
        }
    }
}

/// A disc that falls from there, off the disc `left`, rolled to that side so far.
struct Fall {
    from: DVec2,
    left: Option<usize>,
    side: f64,
}

/// A disc that rolls on another to the side +1 (right) or −1.
struct Roll {
    radius: f64,
    centre: DVec2,
    on: usize,
    side: f64,
}

enum End {
    Rests(Rest),
    FallsOff(Fall),
}

/// What a disc that rolls meets.
#[derive(Clone, Copy)]
enum Met {
    Disc(usize),
    Wall,
    Floor,
    Nothing,
}

/// Rolls to one side, from disc to disc, until something holds it or it falls off.
fn rolled(surface: &Surface, mut roll: Roll) -> End {
    loop {
        let Roll { radius, on, side, .. } = roll;
        let met = first_met(surface, &roll);
        let centre = place_at(surface, &roll, met);
        let held = |by| End::Rests(Rest { centre, supports: (Support::Disc(on), Some(by)) });
        match met {
            Met::Wall => return held(Support::Wall),
            Met::Floor => return held(Support::Floor),
            Met::Disc(index) if side * (surface.discs()[index].position.x - centre.x) > 0.0 => {
                return held(Support::Disc(index));
            }
            // It goes on sideways, and past each disc once.
            Met::Disc(index) => roll = Roll { radius, centre, on: index, side },
            Met::Nothing => {
                return End::FallsOff(Fall { from: centre, left: Some(on), side });
            }
        }
    }
}

/// What a disc that rolls meets first.
fn first_met(surface: &Surface, roll: &Roll) -> Met {
    let &Roll { radius, centre, on, side } = roll;
    let below = &surface.discs()[on];
    let reach = radius + below.radius;
    let mirrored = |place: DVec2| {
        let from = place - below.position;
        DVec2::new(side * from.x, from.y)
    };
    let now = mirrored(centre);
    let now = now.x.atan2(now.y);
    let mut first = (FRAC_PI_2, Met::Nothing);
    let mut meet = |angle: f64, met| {
        if angle < first.0 {
            first = (angle, met);
        }
    };
    let to_wall = (surface.half_width() - radius - side * below.position.x) / reach;
    if to_wall < 1.0 {
        meet(to_wall.max(-1.0).asin(), Met::Wall);
    }
    let to_floor = (surface.floor() + radius - below.position.y) / reach;
    if to_floor > 0.0 {
        meet(to_floor.min(1.0).acos(), Met::Floor);
    }
    let end = below.position + DVec2::new(side * reach, 0.0);
    let way = [centre.min(end), centre.max(end)];
    surface.each_near(way, radius, |index, other| {
        if index == on {
            return;
        }
        let there = mirrored(other.position);
        let (distance, other_reach) = (there.length(), radius + other.radius);
        let cosine = (reach * reach + distance * distance - other_reach * other_reach)
            / (2.0 * reach * distance);
        // What it would but graze it rolls past.
        if cosine.abs() < 1.0 - GRAZING {
            let angle = there.x.atan2(there.y) - cosine.acos();
            // The first time at or after now, but for rounding.
            let ahead = (angle - now + ROUNDING).rem_euclid(TAU) - ROUNDING;
            meet(now + ahead, Met::Disc(index));
        }
    });
    first.1
}

/// The centre of a disc that has rolled to what it meets. Square roots alone, where sines would differ in
/// their last digits from one machine to another.
fn place_at(surface: &Surface, roll: &Roll, met: Met) -> DVec2 {
    let &Roll { radius, on, side, .. } = roll;
    let below = &surface.discs()[on];
    let reach = radius + below.radius;
    let other_leg = |leg: f64| ((reach - leg) * (reach + leg)).max(0.0).sqrt();
    match met {
        Met::Disc(index) => {
            let other = &surface.discs()[index];
            let apart = other.position - below.position;
            let distance = apart.length();
            let other_reach = radius + other.radius;
            let along = 0.5 * (distance + (reach - other_reach) * (reach + other_reach) / distance);
            let towards = apart / distance;
            below.position + along * towards + side * other_leg(along) * towards.perp()
        }
        Met::Wall => {
            let x = side * (surface.half_width() - radius);
            DVec2::new(x, below.position.y + other_leg(x - below.position.x))
        }
        Met::Floor => {
            let y = surface.floor() + radius;
            DVec2::new(below.position.x + side * other_leg(y - below.position.y), y)
        }
        Met::Nothing => below.position + DVec2::new(side * reach, 0.0),
    }
}
