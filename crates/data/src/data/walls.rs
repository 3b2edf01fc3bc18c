//! Makes the table of walls. A wall is a rigid body made of boundaries and fixed discs, and has one row in the table.
//!
//! All boundaries and fixed discs that move together are one wall. Each boundary at rest is one wall, and all fixed
//! discs at rest together are one wall. Forces on walls are contact forces, averaged over the step.

use glam::DVec2;

use super::table::Table;
use crate::column_spec::{ColumnSpec, table_columns};
use crate::sim::{self, GrainState, Moment, MotionView, OtherBody, Surroundings};
use crate::world::{Boundary, materials_of};

struct WallTableRow {
    step: u64,
    time_secs: f64,
    id: u64,
    /// Index of the wall's name in the table's list of names.
    name: u32,
    motion: Option<f64>,
    /// Boundaries and fixed discs that form the wall, and their common motion.
    wall: MotionView,
    place: DVec2,
    force: DVec2,
    torque: f64,
    work: f64,
}

const WALL_COLUMNS: &[ColumnSpec<WallTableRow>] = table_columns! { step and time of row;
    "id", "", Count(row.id), "number of the wall";
    "name", "", Name(row.name), "shape and number of each of its boundaries, and number of its fixed discs";
    "motion", "", SomeNumber(row.motion), "number of the motion; missing for pistons and walls at rest";
    "x", "m", Number(row.place.x), "pivot, or a point of the first boundary, or the centre of the first disc";
    "y", "m", Number(row.place.y), "pivot, or a point of the first boundary, or the centre of the first disc";
    "angle", "rad", Number(row.wall.turned), "rotation since the start, anticlockwise";
    "vx", "m/s", Number(row.wall.velocity.x), "velocity; for a turning wall, velocity of the pivot";
    "vy", "m/s", Number(row.wall.velocity.y), "velocity; for a turning wall, velocity of the pivot";
    "omega", "rad/s", Number(row.wall.angular_velocity), "angular velocity, anticlockwise";
    "fx", "N", Number(row.force.x), "force of the grains on the wall, mean over the step";
    "fy", "N", Number(row.force.y), "force of the grains on the wall, mean over the step";
    "torque", "N m", Number(row.torque), "torque of the grains on the wall about (x, y), anticlockwise";
    "work", "J", Number(row.work), "work on grains in the step, from these forces and the wall's velocity";
};

impl Table {
    /// Makes the table of walls of a snapshot: one row per wall.
    pub fn of_walls(moment: &Moment) -> Self {
        let walls = walls(&moment.surroundings).into_iter().enumerate();
        let rows = walls.map(|(number, (wall, motion))| row(moment, number, motion, wall));
        let (walls, names): (Vec<_>, Vec<_>) = rows.unzip();
        Self::new("walls", WALL_COLUMNS, &walls, &names)
    }

    pub(super) fn no_walls() -> Self {
        Self::new("walls", WALL_COLUMNS, &[], &[])
    }
}

/// Returns the fixed discs of a snapshot, which are at rest or have a prescribed motion, in the form of grains. Each
/// disc has the velocity of its prescribed motion.
pub(super) fn fixed_discs(moment: &Moment) -> impl Iterator<Item = GrainState> + '_ {
    let surroundings = &moment.surroundings;
    let discs = &surroundings.fixed_discs;
    let of_disc = materials_of(&surroundings.materials, |it| &it.fixed_discs, discs.len());
    discs.iter().zip(of_disc).enumerate().map(|(number, (disc, material))| {
        let motion = surroundings.moving.iter().find(|it| it.fixed_discs.contains(&number));
        GrainState {
            id: moment.first_fixed_id + number as u32,
            position: disc.position,
            unwrapped: disc.position,
            angle: motion.map_or(0.0, |motion| motion.turned),
            velocity: motion.map_or(DVec2::ZERO, |motion| motion.velocity_at(disc.position)),
            angular_velocity: motion.map_or(0.0, |motion| motion.angular_velocity),
            radius: disc.radius,
            mass: f64::INFINITY,
            feels_gravity: false,
            tone: 0,
            material,
            lost: false,
        }
    })
}

/// Returns all walls of a scene. The second value of each pair is the number of the wall's motion in the scene's list
/// of motions; `None` for walls at rest and for pistons (half-spaces that move by themselves at a given speed, without
/// an entry in that list).
pub(super) fn walls(surroundings: &Surroundings) -> Vec<(MotionView, Option<f64>)> {
    let Surroundings { boundaries, fixed_discs, moving, .. } = surroundings;
    // Pistons come first in the list `moving` and have no number.
    let by_themselves = boundaries.iter().filter(|shape| matches!(shape, Boundary::Piston { .. }));
    let first_motion = by_themselves.count().min(moving.len());
    let moves = |is_it: &dyn Fn(&MotionView) -> bool| moving.iter().any(is_it);
    let still = (0..boundaries.len()).filter(|it| !moves(&|wall| wall.boundaries.contains(it)));
    let still = still.map(|it| MotionView { boundaries: vec![it], ..MotionView::default() });
    let discs: Vec<usize> =
        (0..fixed_discs.len()).filter(|it| !moves(&|wall| wall.fixed_discs.contains(it))).collect();
    let discs =
        (!discs.is_empty()).then(|| MotionView { fixed_discs: discs, ..MotionView::default() });
    let walls = moving.iter().cloned().chain(still).chain(discs);
    walls
        .enumerate()
        .map(|(number, wall)| {
            let motion = (first_motion..moving.len()).contains(&number);
            (wall, motion.then(|| (number - first_motion) as f64))
        })
        .collect()
}

fn row(
    moment: &Moment,
    number: usize,
    motion: Option<f64>,
    wall: MotionView,
) -> (WallTableRow, String) {
    let Surroundings { boundaries, periodic, .. } = &*moment.surroundings;
    let shapes = wall.boundaries.iter().map(|&it| format!("{} {it}", boundaries[it].word()));
    let discs = match wall.fixed_discs.len() {
        0 => None,
        count => Some(format!("{count} fixed discs")),
    };
    let name = shapes.chain(discs).collect::<Vec<_>>().join(", ");
    let place = place_of(&wall, &moment.surroundings);
    let secs = moment.observables.time_step_secs;
    let (mut force, mut torque, mut work) = (DVec2::ZERO, 0.0, 0.0);
    for contact in moment.contacts.iter().filter(|contact| is_of(contact.other, &wall)) {
        // Position of the contact when the forces acted, before the grain moved in this step.
        let touched = contact.point - secs * moment.grains[contact.grain as usize].velocity;
        let offset = touched - place;
        let offset = periodic.map_or(offset, |periodic| periodic.shortest(offset));
        force -= contact.force;
        torque -= offset.perp_dot(contact.force);
        let round = wall.surface_speed * contact.normal.perp();
        work += secs * contact.force.dot(wall.velocity_at(touched) + round);
    }
    let (step, time_secs) = (moment.observables.step, moment.observables.time_secs);
    let row = WallTableRow {
        step,
        time_secs,
        id: number as u64,
        name: number as u32,
        motion,
        wall,
        place,
        force,
        torque,
        work,
    };
    (row, name)
}

/// Returns the point of a wall, m, about which its torque is computed: the pivot if the wall turns, else a point of its
/// first boundary, else the centre of its first disc.
pub(super) fn place_of(wall: &MotionView, surroundings: &Surroundings) -> DVec2 {
    let Surroundings { boundaries, fixed_discs, .. } = surroundings;
    let of_boundary = wall.boundaries.first().map(|&it| sim::place_of(&boundaries[it]));
    let of_disc = || wall.fixed_discs.first().map(|&it| fixed_discs[it].position);
    let turns = wall.angular_velocity != 0.0;
    if turns { wall.pivot } else { of_boundary.or_else(of_disc).unwrap_or_default() }
}

/// True if a body that a grain touches is a part of a wall.
pub(super) fn is_of(body: OtherBody, wall: &MotionView) -> bool {
    match body {
        OtherBody::Grain(_) => false,
        OtherBody::FixedDisc(disc) => wall.fixed_discs.contains(&(disc as usize)),
        OtherBody::Boundary(boundary) => wall.boundaries.contains(&(boundary as usize)),
    }
}
