//! The table of contacts.

use crate::data::table::{Declared, Table, Value, table};
use crate::sim::{ContactState, ContactStatus, Moment, OtherBody, Stepper};

const NAME: &str = "contacts";

/// Words of the column `kind_j`.
const KINDS: &[&str] = &["grain", "fixed", "boundary"];
const GRAIN: u32 = 0;
const FIXED: u32 = 1;
const BOUNDARY: u32 = 2;

/// Words of the column `status`.
const STATUSES: &[&str] =
    &[ContactStatus::Open.word(), ContactStatus::Stick.word(), ContactStatus::Slip.word()];

struct Row {
    step: u64,
    time_secs: f64,
    other_id: u64,
    kind: u32,
    /// Place in the list of names.
    name: u32,
    has_bonds: bool,
    state: ContactState,
}

const COLUMNS: &[Declared<Row>] = &[
    Declared::step(|row| row.step),
    Declared::time(|row| row.time_secs),
    Declared::count("id_i", "grain i", |row| row.state.grain.into()),
    Declared::count(
        "id_j",
        "body j: a grain, after them a fixed disc, after those a boundary",
        |row| row.other_id,
    ),
    Declared::new("kind_j", "", "what body j is", Value::Word(KINDS, |row| row.kind)),
    Declared::new("name_j", "", "shape and number of a boundary", Value::Name(|row| row.name)),
    Declared::number("x", "m", "contact point", |row| row.state.point.x),
    Declared::number("y", "m", "contact point", |row| row.state.point.y),
    Declared::number("nx", "1", "normal, from j to i", |row| row.state.normal.x),
    Declared::number("ny", "1", "normal, from j to i", |row| row.state.normal.y),
    Declared::number(
        "gap",
        "m",
        "distance of the surfaces as the step began; negative is overlap",
        |row| row.state.gap,
    ),
    Declared::number(
        "normal_force",
        "N",
        "on i along the normal, mean over the step; negative pulls",
        |row| row.state.normal_force,
    ),
    Declared::number("tangential_force", "N", "on i along (-ny, nx), mean over the step", |row| {
        row.state.tangential_force
    }),
    Declared::new(
        "status",
        "",
        "what the laws of contact and friction make of it",
        Value::Word(STATUSES, |row| match row.state.status {
            ContactStatus::Open => 0,
            ContactStatus::Stick => 1,
            ContactStatus::Slip => 2,
        }),
    ),
    Declared::new(
        "bond",
        "",
        "whether its bond lives; none where the law knows no bonds",
        Value::Flag(|row| row.has_bonds.then_some(row.state.bond_stretch.is_some())),
    ),
    Declared::new(
        "stretch",
        "m",
        "how far its bond is stretched",
        Value::SomeNumber(|row| row.state.bond_stretch),
    ),
    Declared::count("age", "steps since the pair was found to touch", |row| row.state.age_steps),
];

/// The table without a row.
pub(in crate::data) fn empty_contacts() -> Table {
    table(NAME, COLUMNS, &[], &[])
}

/// A row a contact.
pub(in crate::data) fn contacts(moment: &Moment) -> Table {
    let (step, time_secs) = (moment.observables.step, moment.observables.time_secs);
    let has_bonds = moment.settings.stepper == Stepper::Range;
    let boundaries = moment.surroundings.boundaries.iter().enumerate();
    let names = boundaries.map(|(number, boundary)| format!("{} {number}", boundary.word()));
    let names: Vec<String> = std::iter::once(String::new()).chain(names).collect();
    let grains = moment.grains.len() as u64;
    let discs = grains + moment.surroundings.fixed_discs.len() as u64;
    let row = |state: &ContactState| {
        let (kind, other_id, name) = match state.other {
            OtherBody::Grain(number) => (GRAIN, number.into(), 0),
            OtherBody::FixedDisc(number) => (FIXED, grains + u64::from(number), 0),
            OtherBody::Boundary(number) => (BOUNDARY, discs + u64::from(number), 1 + number),
        };
        Row { step, time_secs, other_id, kind, name, has_bonds, state: *state }
    };
    let rows: Vec<Row> = moment.contacts.iter().map(row).collect();
    table(NAME, COLUMNS, &rows, &names)
}
