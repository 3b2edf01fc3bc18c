//! Declares the columns of the tables of a recording, and fills the tables with values.

use super::means;
use super::other_bodies::{OTHER_KINDS, OtherBodies};
use super::table::{Table, place_of};
use super::walls::fixed_discs;
use crate::column_spec::{ColumnSpec, table_columns};
use crate::granular::{GrainMeasures, Histogram, PileMeasures, histograms};
use crate::sim::{ContactState, ContactStatus, GrainState, Moment, Observables, Stepper};

/// Returns the six tables of a recording to which every frame adds rows (grains, contacts, pairs, walls, measures and
/// histograms), with their columns but without rows.
pub(super) fn empty_tables_of_frames() -> [Table; 6] {
    let histograms = histogram_table(&Observables::default(), &[]);
    let contacts = Table::new(CONTACTS, CONTACT_COLUMNS, &[], &[]);
    let walls = Table::no_walls().beside(means::of_walls(&[]));
    let measures = measures(None).beside(means::of_pile(&[]));
    [empty_grains(), contacts, means::no_pairs(), walls, measures, histograms]
}

/// Returns all tables of a recording, including the table of steps, with their columns but without rows.
pub(super) fn empty_tables() -> impl Iterator<Item = Table> {
    empty_tables_of_frames().into_iter().chain([Table::of_steps(&[])])
}

/// Makes single tables of a recording, for callers that do not need a whole frame.
impl Table {
    /// Makes the table of grains of a snapshot: one row per grain, then one row per fixed disc.
    pub fn of_grains(moment: &Moment) -> Self {
        grains(moment, &GrainMeasures::of_each(moment))
    }

    /// Makes the table of contacts of a snapshot: one row per contact.
    pub fn of_contacts(moment: &Moment) -> Self {
        let (step, time_secs) = (moment.observables.step, moment.observables.time_secs);
        let has_bonds = moment.settings.stepper == Stepper::Range;
        let others = OtherBodies::of(moment);
        let row = |state: &ContactState| {
            let (kind, other_id, name) = others.told(state.other);
            let id = moment.id(state.grain);
            ContactTableRow { step, time_secs, id, other_id, kind, name, has_bonds, state: *state }
        };
        let rows: Vec<ContactTableRow> = moment.contacts.iter().map(row).collect();
        Self::new(CONTACTS, CONTACT_COLUMNS, &rows, &others.names)
    }

    /// Makes the table of measures of a snapshot, such as stress and solid fraction: one row for the whole pile.
    pub fn of_measures(moment: &Moment) -> Self {
        measures(Some((&moment.observables, &PileMeasures::of(moment))))
    }

    /// Makes the table of histograms of a snapshot: one row per bin of each histogram.
    pub fn of_histograms(moment: &Moment) -> Self {
        histogram_table(&moment.observables, &histograms(moment))
    }

    /// Makes the table of the quantities that are measured in every step: one row per step.
    pub fn of_steps(rows: &[Observables]) -> Self {
        Self::new("steps", STEP_COLUMNS, rows, &[])
    }
}

/// Words of the column `kind` of the table of grains: grain, fixed disc, or lost grain.
pub(super) const KINDS: &[&str] = &["grain", "fixed", "lost"];
/// Index in [`KINDS`] of the word for a grain, a disc that can move freely.
pub(super) const GRAIN: usize = 0;
/// Index in [`KINDS`] of the word for a fixed disc, which is at rest or has a prescribed motion.
pub(super) const FIXED: usize = 1;
/// Index in [`KINDS`] of the word for a lost grain, which went through a wall or left the scene.
pub(super) const LOST: usize = 2;

struct GrainTableRow {
    step: u64,
    time_secs: f64,
    kind: usize,
    state: GrainState,
}

const UNWRAPPED: &str =
    "centre at the start plus all displacements since then, not wrapped at periodic borders";

const GRAIN_COLUMNS: &[ColumnSpec<GrainTableRow>] = table_columns! { step and time of row;
    "id", "", Count(row.state.id.into()),
        "number of the disc, the same in all frames: grains first, then fixed discs, boundaries, and grains that were \
         added later";
    "x", "m", Number(row.state.position.x), "centre";
    "y", "m", Number(row.state.position.y), "centre";
    "angle", "rad", Number(row.state.angle), "rotation since the start, anticlockwise";
    "vx", "m/s", Number(row.state.velocity.x), "velocity of the centre";
    "vy", "m/s", Number(row.state.velocity.y), "velocity of the centre";
    "omega", "rad/s", Number(row.state.angular_velocity), "angular velocity, anticlockwise";
    "radius", "m", Number(row.state.radius), "radius";
    "mass", "kg", SomeNumber((row.kind != FIXED).then_some(row.state.mass)), "mass; missing for fixed discs";
    "kind", "", Word(KINDS, row.kind as u32),
        "grain, fixed (a fixed disc), or lost: a grain that went through a wall or left the world";
    "x_unwrapped", "m", Number(row.state.unwrapped.x), UNWRAPPED;
    "y_unwrapped", "m", Number(row.state.unwrapped.y), UNWRAPPED;
    "material", "", Name(row.state.material.into()), "name of the material; empty in a scene without materials";
};

pub(super) fn empty_grains() -> Table {
    grains_of(&[], &[], &[]).beside(means::of_grains(&[]))
}

pub(super) fn grains(moment: &Moment, measures: &[GrainMeasures]) -> Table {
    let (step, time_secs) = (moment.observables.step, moment.observables.time_secs);
    let moving = moment.grains.iter().map(|state| (if state.lost { LOST } else { GRAIN }, *state));
    let fixed = fixed_discs(moment).map(|state| (FIXED, state));
    let row = |(kind, state)| GrainTableRow { step, time_secs, kind, state };
    let rows: Vec<GrainTableRow> = moving.chain(fixed).map(row).collect();
    let materials = &moment.surroundings.materials;
    let names: Vec<_> = materials.iter().map(|material| material.name.clone()).collect();
    let names = if names.is_empty() { vec![String::new()] } else { names };
    grains_of(&rows, measures, &names)
}

/// Makes the table of grains from rows of discs, the measures of the grains, and the names of materials. The last rows
/// are those of fixed discs; they have no measures.
fn grains_of(rows: &[GrainTableRow], measures: &[GrainMeasures], materials: &[String]) -> Table {
    let measures = Table::new("grains", GrainMeasures::COLUMNS, measures, &[]);
    Table::new("grains", GRAIN_COLUMNS, rows, materials).beside(measures)
}

const CONTACTS: &str = "contacts";

const STATUSES: &[&str] =
    &[ContactStatus::Open.name(), ContactStatus::Stick.name(), ContactStatus::Slip.name()];

struct ContactTableRow {
    step: u64,
    time_secs: f64,
    id: u32,
    other_id: u64,
    kind: u32,
    /// Index of the name of body j (the body that grain i touches) in the table's list of names.
    name: u32,
    has_bonds: bool,
    state: ContactState,
}

const CONTACT_COLUMNS: &[ColumnSpec<ContactTableRow>] = table_columns! { step and time of row;
    "id_i", "", Count(row.id.into()), "grain i";
    "id_j", "", Count(row.other_id), "id of body j: grains first, then fixed discs, then boundaries";
    "kind_j", "", Word(OTHER_KINDS, row.kind), "kind of body j";
    "name_j", "", Name(row.name), "shape and number of a boundary";
    "x", "m", Number(row.state.point.x), "contact point";
    "y", "m", Number(row.state.point.y), "contact point";
    "nx", "1", Number(row.state.normal.x), "normal, from j to i";
    "ny", "1", Number(row.state.normal.y), "normal, from j to i";
    "gap", "m", Number(row.state.gap), "distance of the surfaces at the beginning of the step; negative for an overlap";
    "normal_force", "N", Number(row.state.normal_force),
        "force on i along the normal at the beginning of the step, mean over the step with its shocks; negative pulls";
    "tangential_force", "N", Number(row.state.tangential_force),
        "force on i along (-ny, nx), mean over the step with its shocks; multiplied by -radius, the torque on either \
         grain";
    "status", "", Word(STATUSES, match row.state.status {
        ContactStatus::Open => 0,
        ContactStatus::Stick => 1,
        ContactStatus::Slip => 2,
    }), "status under the contact law and friction";
    "bond", "", Flag(row.has_bonds.then_some(row.state.bond_stretch.is_some())),
        "true if the pair is bonded; missing under laws without bonds";
    "stretch", "m", SomeNumber(row.state.bond_stretch), "stretch of the bond; missing without a bond";
    "age", "", Count(row.state.age_steps), "steps since the pair began to touch";
    "fx", "N", Number(row.state.force.x), "force on i, mean over the step with its shocks";
    "fy", "N", Number(row.state.force.y), "force on i, mean over the step with its shocks";
};

const TIME_COLUMNS: &[ColumnSpec<Observables>] = table_columns! { step and time of now; };

/// Makes the table of measures of the whole pile: one row for the given step, or no rows if `row` is `None`.
pub(super) fn measures(row: Option<(&Observables, &PileMeasures)>) -> Table {
    let (now, pile): (Vec<_>, Vec<_>) = row.into_iter().map(|(now, pile)| (*now, *pile)).unzip();
    let mut measures = Table::new("measures", TIME_COLUMNS, &now, &[]);
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

const BIN_COLUMNS: &[ColumnSpec<Bin>] = table_columns! { step and time of bin;
    "quantity", "", Name(bin.quantity), "counted quantity";
    "unit", "", Name(bin.unit), "unit of from and to";
    "from", "", Number(bin.from), "lower end of the bin, which belongs to it";
    "to", "", Number(bin.to), "upper end of the bin, which belongs to the next";
    "count", "", Count(bin.count), "number in the bin";
};

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

/// Row of the file `frames.csv`, which lists the frames that have been written completely, in all file formats of the
/// recording.
pub(super) struct FrameRow {
    pub step: u64,
    pub time_secs: f64,
    pub number: u64,
}

const FRAME_COLUMNS: &[ColumnSpec<FrameRow>] = table_columns! { step and time of row;
    "number", "", Count(row.number), "frames before this one";
};

pub(super) fn frames(rows: &[FrameRow]) -> Table {
    Table::new("frames", FRAME_COLUMNS, rows, &[])
}

/// Columns of the table of steps, which has one row per step.
pub const STEP_COLUMNS: &[ColumnSpec<Observables>] = table_columns! { step and time of row;
    "time_step", "s", Number(row.time_step_secs), "time step";
    "sweeps", "", Count(row.sweeps.into()), "sweeps of the solver";
    "factorisations", "", Count(row.factorisations.into()), "matrices that the solver factorised";
    "converged", "", Flag(Some(row.converged)), "true if the stopping test was met";
    "stalled", "", Flag(Some(row.stalled)), "true if more sweeps would not help";
    "residual", "1", Number(row.residual), "common residual of the step's problem";
    "model_residual", "1", SomeNumber(row.model_residual),
        "residual of the friction model, if one was solved in place of Coulomb friction";
    "velocity_error", "m/s", Number(row.velocity_error),
        "estimated distance of the velocities from those of Coulomb friction: root mean square, weighted with mass, \
         over the grains in contact";
    "contacts", "", Count(row.contacts.into()), "contacts";
    "compressive_contacts", "", Count(row.compressive_contacts.into()), "contacts that push";
    "tensile_contacts", "", Count(row.tensile_contacts.into()), "contacts that pull";
    "mean_overlap", "1", Number(row.mean_overlap), "mean overlap of grains in touch, in mean diameters";
    "max_overlap", "1", Number(row.max_overlap), "largest overlap, in mean diameters";
    "kinetic_energy", "J", Number(row.kinetic_energy), "kinetic energy";
    "potential_energy", "J", Number(row.potential_energy),
        "potential energy of the grains in the gravity field at their positions; a step of moreau, which moves grains \
         by their velocities at its end, changes it by -gravity_work plus half the time step times -g times the change \
         of momentum";
    "normal_work", "J", Number(row.normal_work), "work of the normal contact forces in the step";
    "tangential_work", "J", Number(row.tangential_work),
        "work of the tangential contact forces and of the moments against rolling in the step";
    "wall_work", "J", Number(row.wall_work), "part of normal_work and tangential_work that moving surfaces did";
    "drive_energy", "J", SomeNumber(row.drive_energy), "kinetic energy of walls that a force drives";
    "drive_work", "J", SomeNumber(row.drive_work),
        "work in the step of the forces that drive walls, minus the work of their damping";
    "border_work", "J", SomeNumber(row.border_work),
        "work of shearing borders in the step, in addition to the other works";
    "gravity_work", "J", Number(row.gravity_work),
        "work of gravity and external forces: their impulse in the step times the mean of the velocities before and \
         after; together with the other works it is the change of kinetic energy";
    "slump", "1", Number(row.slump),
        "decrease of the mean height of the grains, divided by its initial value; NaN if all grains are lost";
    "bond_work", "J", SomeNumber(row.bond_work), "work of the bonds in the step";
    "bond_energy", "J", SomeNumber(row.bond_energy), "energy that stretched the present bonds";
    "broken_bond_energy", "J", SomeNumber(row.broken_bond_energy), "energy that stretched the bonds that have broken";
    "lost_grains", "", Count(row.lost_grains.into()), "grains that went through a wall or left the world";
};

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
        observables.sort();
        columns.sort();
        assert_eq!(observables, columns);
    }
}
