//! Computes the path of one dropped disc: the disc falls, rolls over other discs, and comes to rest where two discs,
//! or one disc and a wall, support it (W. M. Visscher, M. Bolsterli, *Random packing of equal and unequal spheres in
//! two and three dimensions*, 1972; W. S. Jodrey, E. M. Tory, *Simulation of random packing of spheres*, 1979).
//!
//! The path is computed from geometry, without time steps. Let a disc of radius r roll on a disc i of radius r_i with
//! the centre c_i. Its centre is on the circle of radius R = r + r_i about c_i, at an angle φ from the vertical. The
//! disc rolls until the first of these events:
//!
//! * It meets another disc k of radius r_k. Then φ = α − β, where α is the angle from the vertical at which the
//!   centre c_k is seen from c_i, D is the distance of the two centres, and
//!
//! > cos β = (R² + D² − (r + r_k)²) / (2 R D).
//!
//! * It meets a wall. Then sin φ is the horizontal distance from c_i to the disc's centre at the wall, divided by R.
//! * It meets the floor.
//! * φ = 90°, and the disc falls off.
//!
//! An obstacle supports the disc if the centre of the disc is horizontally between the centre of disc i and the
//! obstacle. Otherwise the disc continues to roll, now on the obstacle.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec2;

use crate::number::Parts;
use crate::world::Disc;

/// Length, as a fraction of the sum of two radii, that counts as a rounding error. A rolling disc may overlap a disc
/// that it passes by this length, and a falling disc may land this length above the point where its fall began. With
/// the value 0, a disc between two discs that leave it exactly enough room would roll from one to the other endlessly.
/// And a disc that falls off one disc at the point where it touches the next disc would fall through that next disc.
/// Although a fall may end above its beginning, a disc does not fall endlessly. A falling disc passes a disc whose side
/// it would overlap by less than this length. So where it lands, it rolls down by at least a millionth of the sum of
/// the radii before it falls again.
const GRAZING: f64 = 1e-12;

/// The surface onto which discs are dropped: fixed discs, discs that were dropped before, a floor and two walls. The
/// discs are sorted into columns, so that the obstacles of a falling disc are found in constant time.
#[derive(Clone, Debug)]
pub struct Deposit {
    discs: Vec<Disc>,
    /// For each column, the indices of the discs whose centres are in it, sorted by height.
    columns: Vec<Vec<u32>>,
    column_width: f64,
    largest_radius: f64,
    floor: f64,
    half_width: f64,
}

impl Deposit {
    /// Returns a deposit without discs: a box with a floor at the height `floor` and walls at ±`half_width`, for discs
    /// with radii of at most `largest_radius`. All numbers are finite and in m. `largest_radius` is above 0, and
    /// `half_width` is at least `largest_radius`.
    pub fn new(floor: f64, half_width: f64, largest_radius: f64) -> Self {
        let column_width = 2.0 * largest_radius;
        let count = (2.0 * half_width / column_width).ceil() as usize + 2;
        Self {
            discs: Vec::new(),
            columns: vec![Vec::new(); count],
            column_width,
            largest_radius,
            floor,
            half_width,
        }
    }

    /// Adds a disc to the deposit. A disc that is outside the walls by more than the width of a column is never an
    /// obstacle for a dropped disc.
    pub fn add(&mut self, disc: Disc) {
        let index = self.discs.len() as u32;
        let column = self.column(disc.position.x);
        self.discs.push(disc);
        let (discs, column) = (&self.discs, &mut self.columns[column]);
        let is_lower = |&other: &u32| discs[other as usize].position.y <= disc.position.y;
        let above = column.iter().rev().take_while(|other| !is_lower(other)).count();
        column.insert(column.len() - above, index);
    }

    /// All discs, in the order in which they were added.
    pub fn discs(&self) -> &[Disc] {
        &self.discs
    }

    /// Finds the highest point at the coordinate `x` (m), not above `highest` (m), at which a falling disc lands on
    /// another disc. The disc `left`, off which it falls, is ignored. Returns the height of the falling disc's centre
    /// (m) and the index of the disc on which it lands, or `None` if it falls to the floor.
    fn landing(
        &self,
        x: f64,
        radius: f64,
        highest: f64,
        left: Option<usize>,
    ) -> Option<(f64, usize)> {
        let mut best = None;
        let mut best_height = self.floor + radius;
        for column in self.columns_within(x, radius + self.largest_radius) {
            for &index in column.iter().rev() {
                let Disc { position, radius: other } = self.discs[index as usize];
                let reach = radius + other;
                if position.y + radius + self.largest_radius <= best_height {
                    break;
                }
                let aside = x - position.x;
                if aside.abs() > (1.0 - GRAZING) * reach || left == Some(index as usize) {
                    continue;
                }
                let height = position.y + ((reach - aside) * (reach + aside)).sqrt();
                if height > best_height && height <= highest + GRAZING * reach {
                    (best, best_height) = (Some((height, index as usize)), height);
                }
            }
        }
        best
    }

    /// Calls `visit` for each disc that a disc of radius `radius` (m) may touch while its centre is within the
    /// rectangle from `min` to `max` (m). It is also called for some other discs.
    fn each_near(&self, [min, max]: [DVec2; 2], radius: f64, mut visit: impl FnMut(usize, &Disc)) {
        let reach = radius + self.largest_radius;
        let middle = 0.5 * (min.x + max.x);
        for column in self.columns_within(middle, 0.5 * (max.x - min.x) + reach) {
            for &index in column.iter().rev() {
                let disc = &self.discs[index as usize];
                if disc.position.y < min.y - reach {
                    break;
                }
                if disc.position.y <= max.y + reach {
                    visit(index as usize, disc);
                }
            }
        }
    }

    fn column(&self, x: f64) -> usize {
        // There is one extra column on either side, for fixed discs that extend beyond the walls.
        let at = ((x + self.half_width) / self.column_width).floor() + 1.0;
        at.clamp(0.0, (self.columns.len() - 1) as f64) as usize
    }

    fn columns_within(&self, x: f64, reach: f64) -> &[Vec<u32>] {
        &self.columns[self.column(x - reach)..=self.column(x + reach)]
    }
}

/// A body that supports a disc at rest: another disc, a wall or the floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// The disc with this index in the list of all discs.
    Disc(usize),
    /// The left or the right wall: the one that is nearer to the supported disc.
    Wall,
    /// The floor.
    Floor,
}

/// Position of rest of a dropped disc, and the bodies that support the disc there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Centre of the disc, m.
    pub centre: DVec2,
    /// The body on which the disc lies, and a second support if one body is not enough.
    pub supports: (Support, Option<Support>),
}

/// Tolerance for rounding errors of an angle, rad. A rolling disc that touches an obstacle can, by rounding, have
/// rolled past the angle of this contact. If it is past by less than the tolerance, it still meets the obstacle.
const ROUNDING: f64 = 1e-9;

/// Returns the position of rest of a disc of radius `radius` (m) that is dropped at the coordinate `x` (m) from above
/// all other discs. The caller must choose `radius` not larger than the largest radius of the deposit, and `x` so that
/// the disc is between the walls.
pub fn dropped(deposit: &Deposit, x: f64, radius: f64) -> Rest {
    let mut fall = FallingDisc { from: DVec2::new(x, f64::INFINITY), left: None, side: 1.0 };
    loop {
        let DVec2 { x, y } = fall.from;
        let Some((height, index)) = deposit.landing(x, radius, y, fall.left) else {
            let centre = DVec2::new(x, deposit.floor + radius);
            return Rest { centre, supports: (Support::Floor, None) };
        };
        let centre = DVec2::new(x, height);
        let aside = x - deposit.discs()[index].position.x;
        let side = if aside == 0.0 { fall.side } else { aside.signum() };
        // Each fall ends lower than the previous fall, so the loop ends.
        match rolled(deposit, RollingDisc { radius, centre, on: index, side }) {
            RollEnd::Rests(rest) => return rest,
            RollEnd::FallsOff(next) => fall = next,
        }
    }
}

/// A disc that starts to fall at `from` (m), after it has left the disc with the index `left` and has rolled to `side`
/// (+1: right, −1: left).
struct FallingDisc {
    from: DVec2,
    left: Option<usize>,
    side: f64,
}

/// A disc that rolls on the disc with the index `on`, to the right (`side` +1) or to the left (−1).
struct RollingDisc {
    radius: f64,
    centre: DVec2,
    on: usize,
    side: f64,
}

enum RollEnd {
    Rests(Rest),
    FallsOff(FallingDisc),
}

/// The first obstacle that a rolling disc meets.
#[derive(Clone, Copy)]
enum Obstacle {
    Disc(usize),
    Wall,
    Floor,
    Nothing,
}

/// Rolls a disc to one side, from disc to disc, until it meets a second support or falls off. Returns its position of
/// rest, or the beginning of its fall.
fn rolled(deposit: &Deposit, mut roll: RollingDisc) -> RollEnd {
    loop {
        let RollingDisc { radius, on, side, .. } = roll;
        let met = first_met(deposit, &roll);
        let centre = place_at(deposit, &roll, met);
        let held = |by| RollEnd::Rests(Rest { centre, supports: (Support::Disc(on), Some(by)) });
        match met {
            Obstacle::Wall => return held(Support::Wall),
            Obstacle::Floor => return held(Support::Floor),
            Obstacle::Disc(index)
                if side * (deposit.discs()[index].position.x - centre.x) > 0.0 =>
            {
                return held(Support::Disc(index));
            }
            // The disc continues to the same side, so it passes each disc only once.
            Obstacle::Disc(index) => roll = RollingDisc { radius, centre, on: index, side },
            Obstacle::Nothing => {
                return RollEnd::FallsOff(FallingDisc { from: centre, left: Some(on), side });
            }
        }
    }
}

fn first_met(deposit: &Deposit, roll: &RollingDisc) -> Obstacle {
    let &RollingDisc { radius, centre, on, side } = roll;
    let below = &deposit.discs()[on];
    let reach = radius + below.radius;
    let mirrored = |place: DVec2| {
        let from = place - below.position;
        DVec2::new(side * from.x, from.y)
    };
    let now = mirrored(centre);
    let now = libm::atan2(now.x, now.y);
    let mut first = (FRAC_PI_2, Obstacle::Nothing);
    let mut meet = |angle: f64, met| {
        if angle < first.0 {
            first = (angle, met);
        }
    };
    let to_wall = (deposit.half_width - radius - side * below.position.x) / reach;
    if to_wall < 1.0 {
        meet(libm::asin(to_wall.max(-1.0)), Obstacle::Wall);
    }
    let to_floor = (deposit.floor + radius - below.position.y) / reach;
    if to_floor > 0.0 {
        meet(libm::acos(to_floor.min(1.0)), Obstacle::Floor);
    }
    let end = below.position + DVec2::new(side * reach, 0.0);
    let way = [centre.min(end), centre.max(end)];
    deposit.each_near(way, radius, |index, other| {
        if index == on {
            return;
        }
        let there = mirrored(other.position);
        let (distance, other_reach) = (there.length(), radius + other.radius);
        let cosine = (reach * reach + distance * distance - other_reach * other_reach)
            / (2.0 * reach * distance);
        // The disc rolls past a disc that it would only graze.
        if cosine.abs() < 1.0 - GRAZING {
            let angle = libm::atan2(there.x, there.y) - libm::acos(cosine);
            // Angle from the present position to the position at which the two discs touch. It is not negative,
            // except for rounding.
            let ahead = (angle - now + ROUNDING).rem_euclid(TAU) - ROUNDING;
            meet(now + ahead, Obstacle::Disc(index));
        }
    });
    first.1
}

/// Returns the centre (m) of a rolling disc at the point where it meets its obstacle `met`. Uses only square roots,
/// because sines would differ between machines in their last digits.
fn place_at(deposit: &Deposit, roll: &RollingDisc, met: Obstacle) -> DVec2 {
    let &RollingDisc { radius, on, side, .. } = roll;
    let below = &deposit.discs()[on];
    let reach = radius + below.radius;
    let other_leg = |leg: f64| ((reach - leg) * (reach + leg)).positive_part().sqrt();
    match met {
        Obstacle::Disc(index) => {
            let other = &deposit.discs()[index];
            let apart = other.position - below.position;
            let distance = apart.length();
            let other_reach = radius + other.radius;
            let along = 0.5 * (distance + (reach - other_reach) * (reach + other_reach) / distance);
            let towards = apart / distance;
            below.position + along * towards + side * other_leg(along) * towards.perp()
        }
        Obstacle::Wall => {
            let x = side * (deposit.half_width - radius);
            DVec2::new(x, below.position.y + other_leg(x - below.position.x))
        }
        Obstacle::Floor => {
            let y = deposit.floor + radius;
            DVec2::new(below.position.x + side * other_leg(y - below.position.y), y)
        }
        Obstacle::Nothing => below.position + DVec2::new(side * reach, 0.0),
    }
}
