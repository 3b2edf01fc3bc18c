//! The tables of a recording: which columns they have, and what these hold.

use glam::DVec2;

use super::table::{Table, place_of};
use crate::column_spec::ColumnSpec;
use crate::granular::{GrainMeasures, Histogram, PileMeasures, histograms};
use crate::sim::{
    ContactState, ContactStatus, GrainState, Moment, Observables, OtherBody, Stepper,
};
use crate::world::Disc;

/// The tables that formats write for each frame, without a row.
pub(super) fn empty_tables_of_frames() -> [Table; 4] {
    let histograms = histogram_table(&Observables::default(), &[]);
    [empty_grains(), Table::new(CONTACTS, CONTACT_COLUMNS, &[], &[]), measures(None), histograms]
}

/// All tables that formats write, without a row.
pub(super) fn empty_tables() -> impl Iterator<Item = Table> {
    empty_tables_of_frames().into_iter().chain([Table::of_steps(&[])])
}

/// The tables of a recording one by one, for those who want no whole frame.
impl Table {
    /// A row a grain, then a row a fixed disc.
    pub fn of_grains(moment: &Moment) -> Self {
        grains(moment, &GrainMeasures::of_each(moment))
    }

    /// A row a contact.
    pub fn of_contacts(moment: &Moment) -> Self {
        contacts(moment)
    }

    /// One row, of the whole pile.
    pub fn of_measures(moment: &Moment) -> Self {
        measures(Some((&moment.observables, &PileMeasures::of(moment))))
    }

    /// A row a bin of each histogram.
    pub fn of_histograms(moment: &Moment) -> Self {
        histogram_table(&moment.observables, &histograms(moment))
    }

    /// A row a step.
    pub fn of_steps(rows: &[Observables]) -> Self {
        Self::new("steps", STEP_COLUMNS, rows, &[])
    }
}

/// Words of the column `kind`.
pub(super) const KINDS: &[&str] = &["grain", "fixed", "lost"];
/// Place of the word for a disc that moves.
pub(super) const GRAIN: usize = 0;
/// Of one that does not.
pub(super) const FIXED: usize = 1;
/// Of one that went through a wall or left the world.
pub(super) const LOST: usize = 2;

struct GrainTableRow {
    step: u64,
    time_secs: f64,
    id: u64,
    kind: usize,
    state: GrainState,
}

const GRAIN_COLUMNS: &[ColumnSpec<GrainTableRow>] = &[
    ColumnSpec::step(|row| row.step),
    ColumnSpec::time(|row| row.time_secs),
    ColumnSpec::count("id", "number of the disc; fixed discs follow the grains", |row| row.id),
    ColumnSpec::number("x", "m", "centre", |row| row.state.position.x),
    ColumnSpec::number("y", "m", "centre", |row| row.state.position.y),
    ColumnSpec::number("angle", "rad", "turned since the start, anticlockwise", |row| {
        row.state.angle
    }),
    ColumnSpec::number("vx", "m/s", "velocity of the centre", |row| row.state.velocity.x),
    ColumnSpec::number("vy", "m/s", "velocity of the centre", |row| row.state.velocity.y),
    ColumnSpec::number("omega", "rad/s", "angular velocity, anticlockwise", |row| {
        row.state.angular_velocity
    }),
    ColumnSpec::number("radius", "m", "radius", |row| row.state.radius),
    ColumnSpec::some_number("mass", "kg", "mass; none of what is fixed", |row| {
        (row.kind != FIXED).then_some(row.state.mass)
    }),
    ColumnSpec::word(
        "kind",
        "grain, fixed disc, or a grain that went through a wall or left the world",
        KINDS,
        |row| row.kind as u32,
    ),
];

/// The table without a row.
pub(super) fn empty_grains() -> Table {
    with_measures(Table::new("grains", GRAIN_COLUMNS, &[], &[]), &[])
}

/// A row a grain, then a row a fixed disc.
pub(super) fn grains(moment: &Moment, measures: &[GrainMeasures]) -> Table {
    let (step, time_secs) = (moment.observables.step, moment.observables.time_secs);
    let moving = moment.grains.iter().map(|state| (if state.lost { LOST } else { GRAIN }, *state));
    let fixed = moment.surroundings.fixed_discs.iter().map(|disc| (FIXED, at_rest(disc)));
    let rows = moving.chain(fixed).zip(0..);
    let rows: Vec<GrainTableRow> = rows
        .map(|((kind, state), id)| GrainTableRow { step, time_secs, id, kind, state })
        .collect();
    with_measures(Table::new("grains", GRAIN_COLUMNS, &rows, &[]), measures)
}

/// Adds what is measured of grains. Of fixed discs, which follow, there is nothing.
fn with_measures(mut table: Table, measures: &[GrainMeasures]) -> Table {
    let rows = table.len();
    let measured = Table::new("grains", GrainMeasures::COLUMNS, measures, &[]);
    table.columns.extend(measured.columns.into_iter().map(|mut column| {
        column.values = column.values.padded(rows);
        column
    }));
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

const CONTACTS: &str = "contacts";

/// Words of the column `kind_j`.
const OTHER_KINDS: &[&str] = &["grain", "fixed", "boundary"];

/// Words of the column `status`.
const STATUSES: &[&str] =
    &[ContactStatus::Open.name(), ContactStatus::Stick.name(), ContactStatus::Slip.name()];

struct ContactTableRow {
    step: u64,
    time_secs: f64,
    other_id: u64,
    kind: u32,
    /// Place in the list of names.
    name: u32,
    has_bonds: bool,
    state: ContactState,
}

const CONTACT_COLUMNS: &[ColumnSpec<ContactTableRow>] = &[
    ColumnSpec::step(|row| row.step),
    ColumnSpec::time(|row| row.time_secs),
    ColumnSpec::count("id_i", "grain i", |row| row.state.grain.into()),
    ColumnSpec::count(
        "id_j",
        "body j: a grain, after them a fixed disc, after those a boundary",
        |row| row.other_id,
    ),
    ColumnSpec::word("kind_j", "what body j is", OTHER_KINDS, |row| row.kind),
    ColumnSpec::name("name_j", "shape and number of a boundary", |row| row.name),
    ColumnSpec::number("x", "m", "contact point", |row| row.state.point.x),
    ColumnSpec::number("y", "m", "contact point", |row| row.state.point.y),
    ColumnSpec::number("nx", "1", "normal, from j to i", |row| row.state.normal.x),
    ColumnSpec::number("ny", "1", "normal, from j to i", |row| row.state.normal.y),
    ColumnSpec::number(
        "gap",
        "m",
        "distance of the surfaces as the step began; negative is overlap",
        |row| row.state.gap,
    ),
    ColumnSpec::number(
        "normal_force",
        "N",
        "on i along the normal, mean over the step; negative pulls",
        |row| row.state.normal_force,
    ),
    ColumnSpec::number(
        "tangential_force",
        "N",
        "on i along (-ny, nx), mean over the step",
        |row| row.state.tangential_force,
    ),
    ColumnSpec::word(
        "status",
        "what the laws of contact and friction make of it",
        STATUSES,
        |row| match row.state.status {
            ContactStatus::Open => 0,
            ContactStatus::Stick => 1,
            ContactStatus::Slip => 2,
        },
    ),
    ColumnSpec::flag("bond", "whether its bond lives; none where the law knows no bonds", |row| {
        row.has_bonds.then_some(row.state.bond_stretch.is_some())
    }),
    ColumnSpec::some_number("stretch", "m", "how far its bond is stretched", |row| {
        row.state.bond_stretch
    }),
    ColumnSpec::count("age", "steps since the pair was found to touch", |row| row.state.age_steps),
];

/// A row a contact.
pub(super) fn contacts(moment: &Moment) -> Table {
    let (step, time_secs) = (moment.observables.step, moment.observables.time_secs);
    let has_bonds = moment.settings.stepper == Stepper::Range;
    let boundaries = moment.surroundings.boundaries.iter().enumerate();
    let names = boundaries.map(|(number, boundary)| format!("{} {number}", boundary.word()));
    let names: Vec<String> = std::iter::once(String::new()).chain(names).collect();
    let grains = moment.grains.len() as u64;
    let discs = grains + moment.surroundings.fixed_discs.len() as u64;
    let row = |state: &ContactState| {
        let (kind, other_id, name) = match state.other {
            OtherBody::Grain(number) => (0, number.into(), 0),
            OtherBody::FixedDisc(number) => (1, grains + u64::from(number), 0),
            OtherBody::Boundary(number) => (2, discs + u64::from(number), 1 + number),
        };
        ContactTableRow { step, time_secs, other_id, kind, name, has_bonds, state: *state }
    };
    let rows: Vec<ContactTableRow> = moment.contacts.iter().map(row).collect();
    Table::new(CONTACTS, CONTACT_COLUMNS, &rows, &names)
}

/// What is measured of a whole pile at a step: a row, or none.
pub(super) fn measures(row: Option<(&Observables, &PileMeasures)>) -> Table {
    let (now, pile): (Vec<_>, Vec<_>) = row.into_iter().map(|(now, pile)| (*now, *pile)).unzip();
    let of_step =
        [ColumnSpec::step(|now: &Observables| now.step), ColumnSpec::time(|now| now.time_secs)];
    let mut measures = Table::new("measures", &of_step, &now, &[]);
    measures.columns.extend(Table::new("measures", PileMeasures::COLUMNS, &pile, &[]).columns);
    measures
}

struct Bin {
    step: u64,
    time_secs: f64,
    quantity: u32,
    unit: u32,
    from: f64,
    to: f64,
    count: u64,
}

const BIN_COLUMNS: &[ColumnSpec<Bin>] = &[
    ColumnSpec::step(|bin| bin.step),
    ColumnSpec::time(|bin| bin.time_secs),
    ColumnSpec::name("quantity", "what is counted", |bin| bin.quantity),
    ColumnSpec::name("unit", "unit of from and to", |bin| bin.unit),
    ColumnSpec::number("from", "", "where the bin begins, which belongs to it", |bin| bin.from),
    ColumnSpec::number("to", "", "where it ends", |bin| bin.to),
    ColumnSpec::count("count", "how many are in it", |bin| bin.count),
];

/// A row a bin of each histogram.
pub(super) fn histogram_table(now: &Observables, histograms: &[Histogram]) -> Table {
    let mut words: Vec<String> = Vec::new();
    let (step, time_secs) = (now.step, now.time_secs);
    let mut bins = Vec::new();
    for Histogram { quantity, unit, edges, counts } in histograms {
        let (quantity, unit) = (place_of(&mut words, quantity), place_of(&mut words, unit));
        bins.extend(edges.windows(2).zip(counts).map(|(ends, &count)| {
            let [from, to] = [ends[0], ends[1]];
            Bin { step, time_secs, quantity, unit, from, to, count }
        }));
    }
    Table::new("histograms", BIN_COLUMNS, &bins, &words)
}

/// A frame that is there in every format.
pub(super) struct FrameRow {
    pub step: u64,
    pub time_secs: f64,
    pub number: u64,
}

const FRAME_COLUMNS: &[ColumnSpec<FrameRow>] = &[
    ColumnSpec::step(|row| row.step),
    ColumnSpec::time(|row| row.time_secs),
    ColumnSpec::count("number", "frames before this one", |row| row.number),
];

/// A row a frame.
pub(super) fn frames(rows: &[FrameRow]) -> Table {
    Table::new("frames", FRAME_COLUMNS, rows, &[])
}

const STEP_COLUMNS: &[ColumnSpec<Observables>] = &[
    ColumnSpec::step(|row| row.step),
    ColumnSpec::time(|row| row.time_secs),
    ColumnSpec::number("time_step", "s", "time step", |row| row.time_step_secs),
    ColumnSpec::count("sweeps", "sweeps of the solver", |row| row.sweeps.into()),
    ColumnSpec::count("factorisations", "matrices that it factorised", |row| {
        row.factorisations.into()
    }),
    ColumnSpec::flag("converged", "whether the step was solved as asked", |row| {
        Some(row.converged)
    }),
    ColumnSpec::flag("stalled", "whether more sweeps would be of no use", |row| Some(row.stalled)),
    ColumnSpec::number("residual", "1", "common residual of the step's problem", |row| {
        row.residual
    }),
    ColumnSpec::some_number(
        "model_residual",
        "1",
        "the same of the model of friction that was solved in the place of Coulomb's law",
        |row| row.model_residual,
    ),
    ColumnSpec::some_number(
        "duality_gap",
        "1",
        "duality gap of that model, whose square root bounds the error of the velocities",
        |row| row.duality_gap,
    ),
    ColumnSpec::some_number(
        "fell_back",
        "1",
        "1 where it was solved under bounds of friction in the place of Coulomb's law, else 0",
        |row| row.fell_back.map(|fell_back| u8::from(fell_back).into()),
    ),
    ColumnSpec::count("contacts", "contacts", |row| row.contacts.into()),
    ColumnSpec::count("compressive_contacts", "contacts that push", |row| {
        row.compressive_contacts.into()
    }),
    ColumnSpec::count("tensile_contacts", "contacts that pull", |row| row.tensile_contacts.into()),
    ColumnSpec::number(
        "mean_overlap",
        "1",
        "mean overlap of grains in touch, in mean diameters",
        |row| row.mean_overlap,
    ),
    ColumnSpec::number("max_overlap", "1", "largest overlap, in mean diameters", |row| {
        row.max_overlap
    }),
    ColumnSpec::number("kinetic_energy", "J", "kinetic energy", |row| row.kinetic_energy),
    ColumnSpec::number("potential_energy", "J", "potential energy in the gravity field", |row| {
        row.potential_energy
    }),
    ColumnSpec::number(
        "normal_work",
        "J",
        "work of the normal contact forces in the step",
        |row| row.normal_work,
    ),
    ColumnSpec::number(
        "tangential_work",
        "J",
        "work of the tangential contact forces in the step",
        |row| row.tangential_work,
    ),
    ColumnSpec::number(
        "wall_work",
        "J",
        "part of both that surfaces which move did in the step",
        |row| row.wall_work,
    ),
    ColumnSpec::some_number(
        "drive_energy",
        "J",
        "kinetic energy of walls that a force drives",
        |row| row.drive_energy,
    ),
    ColumnSpec::some_number(
        "drive_work",
        "J",
        "work in the step of the forces that drive walls, less that of their damping",
        |row| row.drive_work,
    ),
    ColumnSpec::some_number(
        "border_work",
        "J",
        "work that borders which shear did in the step, beside the others",
        |row| row.border_work,
    ),
    ColumnSpec::number("gravity_work", "J", "work of the gravity field in the step", |row| {
        row.gravity_work
    }),
    ColumnSpec::number(
        "slump",
        "1",
        "how far the centre of mass has sunk, in its first height",
        |row| row.slump,
    ),
    ColumnSpec::some_number("bond_work", "J", "work that bonds did in the step", |row| {
        row.bond_work
    }),
    ColumnSpec::some_number(
        "bond_energy",
        "J",
        "what stretching the bonds that live took",
        |row| row.bond_energy,
    ),
    ColumnSpec::some_number("broken_bond_energy", "J", "what bonds took that have broken", |row| {
        row.broken_bond_energy
    }),
    ColumnSpec::count("lost_grains", "grains that went through a wall or left the world", |row| {
        row.lost_grains.into()
    }),
];

/// Something that each step measures, as tables call it.
pub struct Observed(&'static ColumnSpec<Observables>);

impl Observed {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        STEP_COLUMNS.iter().map(Self)
    }

    /// The one of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|observed| observed.0.name == name)
    }

    /// Its name in tables.
    pub fn name(&self) -> &'static str {
        self.0.name
    }

    /// Name and unit.
    pub fn title(&self) -> String {
        let name = self.0.name.replace('_', " ");
        match self.0.unit {
            "" | "1" => name,
            unit => format!("{name} ({unit})"),
        }
    }

    /// What it is, in a few words.
    pub fn about(&self) -> &'static str {
        self.0.about
    }

    /// Its value in a row that has it; 1 and 0 stand for what is so and what is not.
    pub fn of(&self, row: &Observables) -> Option<f64> {
        self.0.value.number(row)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_observable_has_its_column() {
        let row = Observables::default().with_further_columns();
        let row = serde_json::to_value(row).expect("JSON");
        let mut observables: Vec<&str> =
            row.as_object().expect("fields").keys().map(String::as_str).collect();
        let mut columns: Vec<&str> = STEP_COLUMNS.iter().map(|column| column.name).collect();
        observables.iter_mut().for_each(|name| *name = name.trim_end_matches("_secs"));
        observables.sort();
        columns.sort();
        assert_eq!(observables, columns);
    }
}
