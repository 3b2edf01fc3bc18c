//! The table of grains.

use glam::DVec2;

use super::measured;
use crate::data::table::{Declared, Table, Value, table};
use crate::granular::GrainMeasures;
use crate::sim::{GrainState, Moment};
use crate::world::Disc;

const NAME: &str = "grains";

/// Words of the column `kind`.
pub(in crate::data) const KINDS: &[&str] = &["grain", "fixed", "lost"];
/// Place of the word for a disc that moves.
pub(in crate::data) const GRAIN: usize = 0;
/// Of one that does not.
pub(in crate::data) const FIXED: usize = 1;
/// Of one that went through a wall or left the world.
pub(in crate::data) const LOST: usize = 2;

struct Row {
    step: u64,
    time_secs: f64,
    id: u64,
    kind: usize,
    state: GrainState,
}

const COLUMNS: &[Declared<Row>] = &[
    Declared::step(|row| row.step),
    Declared::time(|row| row.time_secs),
    Declared::count("id", "number of the disc; fixed discs follow the grains", |row| row.id),
    Declared::number("x", "m", "centre", |row| row.state.position.x),
    Declared::number("y", "m", "centre", |row| row.state.position.y),
    Declared::number("angle", "rad", "turned since the start, anticlockwise", |row| {
        row.state.angle
    }),
    Declared::number("vx", "m/s", "velocity of the centre", |row| row.state.velocity.x),
    Declared::number("vy", "m/s", "velocity of the centre", |row| row.state.velocity.y),
    Declared::number("omega", "rad/s", "angular velocity, anticlockwise", |row| {
        row.state.angular_velocity
    }),
    Declared::number("radius", "m", "radius", |row| row.state.radius),
    Declared::new(
        "mass",
        "kg",
        "mass; none of what is fixed",
        Value::SomeNumber(|row| (row.kind != FIXED).then_some(row.state.mass)),
    ),
    Declared::new(
        "kind",
        "",
        "grain, fixed disc, or a grain that went through a wall or left the world",
        Value::Word(KINDS, |row| row.kind as u32),
    ),
];

/// The table without a row.
pub(in crate::data) fn empty_grains() -> Table {
    with_measures(table(NAME, COLUMNS, &[], &[]), &[])
}

/// A row a grain, then a row a fixed disc.
pub(in crate::data) fn grains(moment: &Moment, measures: &[GrainMeasures]) -> Table {
    let (step, time_secs) = (moment.observables.step, moment.observables.time_secs);
    let moving = moment.grains.iter().map(|state| (if state.lost { LOST } else { GRAIN }, *state));
    let fixed = moment.surroundings.fixed_discs.iter().map(|disc| (FIXED, at_rest(disc)));
    let rows = moving.chain(fixed).zip(0..);
    let rows: Vec<Row> =
        rows.map(|((kind, state), id)| Row { step, time_secs, id, kind, state }).collect();
    let measures = measures.iter().copied().map(Some).chain(std::iter::repeat(None));
    let measures: Vec<_> = measures.take(rows.len()).collect();
    with_measures(table(NAME, COLUMNS, &rows, &[]), &measures)
}

fn with_measures(mut table: Table, measures: &[Option<GrainMeasures>]) -> Table {
    table.columns.extend(measured::of_grains(measures));
    table
}

fn at_rest(disc: &Disc) -> GrainState {
    GrainState {
        position: disc.position,
        angle: 0.0,
        velocity: DVec2::ZERO,
        angular_velocity: 0.0,
        radius: disc.radius,
        mass: f64::INFINITY,
        feels_gravity: false,
        tone: 0,
        lost: false,
    }
}
