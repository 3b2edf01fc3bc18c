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

use crate::number::Parts;
use crate::world::Disc;

/// Part of the reach that is rounding: by so much a disc may overlap one that it passes, or lie above where
/// its fall began. None, and a disc between two that leave it just the room is handed from one to the other
/// without end, and one that falls off where it touches the next falls through that; with it, each
/// fall still ends lower, by a millionth of the reach at least.
const GRAZING: f64 = 1e-12;

/// What a disc can be dropped on: fixed discs, those that were dropped before, a floor, two walls. Discs are kept by
/// columns, so that what a falling disc meets is found in constant time.
#[derive(Clone, Debug)]
pub struct Deposit {
    discs: Vec<Disc>,
    /// The discs whose centres lie in each column, by height.
    columns: Vec<Vec<u32>>,
    column_width: f64,
    largest_radius: f64,
    floor: f64,
    half_width: f64,
}

impl Deposit {
    /// A box with a floor at height `floor` and walls at ± `half_width`, m, for discs of at most
    /// `largest_radius`, m. All are finite, and `half_width` is at least `largest_radius`, above 0.
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

    /// Puts a disc in place. Those farther outside of the walls than a column's width are met by none.
    pub fn add(&mut self, disc: Disc) {
        let index = self.discs.len() as u32;
        let column = self.column(disc.position.x);
        self.discs.push(disc);
        let (discs, column) = (&self.discs, &mut self.columns[column]);
        let is_lower = |&other: &u32| discs[other as usize].position.y <= disc.position.y;
        let above = column.iter().rev().take_while(|other| !is_lower(other)).count();
        column.insert(column.len() - above, index);
    }

    /// All that are in place, as they came.
    pub fn discs(&self) -> &[Disc] {
        &self.discs
    }

    /// The highest place at x, not above `highest`, where a disc that falls comes to lie on one of those in place but for
    /// `left`, the one that it falls from; and that one's index. Nothing where it falls to the floor.
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

    /// Calls `visit` with the index of each disc that one of that radius may touch whose centre is within
    /// the rectangle; of others as well.
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
        // A column more on either side holds the fixed discs that stand out beyond the walls.
        let at = ((x + self.half_width) / self.column_width).floor() + 1.0;
        at.clamp(0.0, (self.columns.len() - 1) as f64) as usize
    }

    fn columns_within(&self, x: f64, reach: f64) -> &[Vec<u32>] {
        &self.columns[self.column(x - reach)..=self.column(x + reach)]
    }
}

/// What holds a disc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// The disc of that index on the deposit.
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
        // Each fall ends lower than the one before, so there is a last one.
        match rolled(deposit, RollingDisc { radius, centre, on: index, side }) {
            RollEnd::Rests(rest) => return rest,
            RollEnd::FallsOff(next) => fall = next,
        }
    }
}

/// A disc that falls from there, off the disc `left`, rolled to that side so far.
struct FallingDisc {
    from: DVec2,
    left: Option<usize>,
    side: f64,
}

/// A disc that rolls on another to the side +1 (right) or −1.
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

/// What a disc that rolls meets.
#[derive(Clone, Copy)]
enum Obstacle {
    Disc(usize),
    Wall,
    Floor,
    Nothing,
}

/// Rolls to one side, from disc to disc, until something holds it or it falls off.
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
            // It goes on sideways, and past each disc once.
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
        // What it would but graze it rolls past.
        if cosine.abs() < 1.0 - GRAZING {
            let angle = libm::atan2(there.x, there.y) - libm::acos(cosine);
            // The first time at or after now, but for rounding.
            let ahead = (angle - now + ROUNDING).rem_euclid(TAU) - ROUNDING;
            meet(now + ahead, Obstacle::Disc(index));
        }
    });
    first.1
}

/// The centre of a disc that has rolled to what it meets. Square roots alone, where sines would differ in
/// their last digits from one machine to another.
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
