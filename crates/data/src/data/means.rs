//! Computes means of contact forces and stresses over the time between two frames: the table of pairs of bodies, and
//! the mean columns of the tables of grains, walls and the pile. The means come from sums over all steps in that time,
//! so they include pairs that have separated since.

use glam::{DMat2, DVec2};

use super::other_bodies::{OTHER_KINDS, OtherBodies};
use super::table::Table;
use super::walls::{is_of, place_of, walls};
use crate::column_spec::{ColumnSpec, table_columns};
use crate::granular::GrainMeasures;
use crate::sim::{ForceSums, Moment, PairSum, Surroundings};

/// Means of contact forces and stresses over the time since the previous frame: the table of pairs of bodies, and
/// columns for the tables of grains, walls and the pile.
pub(super) struct Means {
    pub pairs: Table,
    pub grains: Table,
    pub walls: Table,
    pub pile: Table,
}

impl Means {
    /// Computes the means. `sums` are the sums of contact forces since the previous frame, `moment` is the present
    /// snapshot, `grains` are the measures of the grains in this snapshot, and `area` is the area of the pile in this
    /// snapshot, m².
    pub(super) fn of(
        sums: &ForceSums,
        moment: &Moment,
        grains: &[GrainMeasures],
        area: f64,
    ) -> Self {
        let ForceSums { secs, pairs, stresses, .. } = sums;
        // A lost grain has no cell, and its stress is NaN.
        let mean = |stress: DMat2, area: f64| {
            stress * if area > 0.0 { 1.0 / (secs * area) } else { f64::NAN }
        };
        let of_grains = stresses.iter().zip(grains);
        let of_grains: Vec<_> =
            of_grains.map(|(&stress, grain)| mean(stress, grain.cell_area)).collect();
        let counts = |(_, grain): &(&DMat2, &GrainMeasures)| !grain.cell_area.is_nan();
        let of_pile = stresses.iter().zip(grains).filter(counts).map(|(&stress, _)| stress);
        let of_pile = PileMeans { secs: *secs, stress: mean(of_pile.sum(), area) };
        let Surroundings { periodic, .. } = *moment.surroundings;
        let of_wall = |(wall, _)| {
            let sums = || pairs.iter().filter(|pair| is_of(pair.other, &wall));
            let impulse = sums().map(|pair| pair.impulse).sum::<DVec2>();
            let about_origin = sums().map(|pair| pair.moment).sum::<f64>();
            let torque = place_of(&wall, &moment.surroundings).perp_dot(impulse) - about_origin;
            WallMeans {
                force: -impulse / *secs,
                // In a periodic scene a wall has images, so the point about which the torque acts is not unique.
                torque: if periodic.is_none() { torque / *secs } else { f64::NAN },
                work: if *secs > 0.0 { sums().map(|pair| pair.work).sum() } else { f64::NAN },
            }
        };
        Self {
            pairs: Table::of_pairs(sums, moment),
            grains: self::of_grains(&of_grains),
            walls: of_walls(
                &walls(&moment.surroundings).into_iter().map(of_wall).collect::<Vec<_>>(),
            ),
            pile: self::of_pile(&[of_pile]),
        }
    }
}

struct PairTableRow {
    step: u64,
    time_secs: f64,
    secs: f64,
    id: u32,
    other_id: u64,
    kind: u32,
    /// Index of the name of body j (the body that grain i touches) in the table's list of names.
    name: u32,
    sum: PairSum,
}

const OVER: &str =
    "time over which means are taken: since the previous frame, or since the recording began";

const PAIR_COLUMNS: &[ColumnSpec<PairTableRow>] = table_columns! { step and time of row;
    "mean_time", "s", Number(row.secs), OVER;
    "id_i", "", Count(row.id.into()), "grain i";
    "id_j", "", Count(row.other_id), "id of body j, as in contacts";
    "kind_j", "", Word(OTHER_KINDS, row.kind), "kind of body j";
    "name_j", "", Name(row.name), "shape and number of a boundary";
    "steps", "", Count(row.sum.steps), "steps in which the pair transmitted a force";
    "normal_force", "N", Number(row.sum.normal / row.secs),
        "force on i along the normal of each step, mean over mean_time, with 0 while the pair is apart; negative pulls";
    "tangential_force", "N", Number(row.sum.tangential / row.secs),
        "force on i along (-ny, nx), mean over mean_time; multiplied by -radius, the torque on either grain";
    "fx", "N", Number(row.sum.impulse.x / row.secs), "force on i, mean over mean_time";
    "fy", "N", Number(row.sum.impulse.y / row.secs), "force on i, mean over mean_time";
};

impl Table {
    /// Makes the table of pairs: one row per pair of bodies between which a contact force acted since the previous
    /// frame.
    pub fn of_pairs(sums: &ForceSums, moment: &Moment) -> Self {
        let (step, time_secs) = (moment.observables.step, moment.observables.time_secs);
        let others = OtherBodies::of(moment);
        let row = |&sum: &PairSum| {
            let (kind, other_id, name) = others.told(sum.other);
            let id = moment.id(sum.grain);
            PairTableRow { step, time_secs, secs: sums.secs, id, other_id, kind, name, sum }
        };
        let rows: Vec<PairTableRow> = sums.pairs.iter().map(row).collect();
        Self::new("pairs", PAIR_COLUMNS, &rows, &others.names)
    }
}

pub(super) fn no_pairs() -> Table {
    Table::new("pairs", PAIR_COLUMNS, &[], &[])
}

fn some(number: f64) -> Option<f64> {
    (!number.is_nan()).then_some(number)
}

/// Columns of the mean stress σ, N/m: Σ f ⊗ ℓ over contacts, averaged over the time since the previous frame and
/// divided by the area, with the contact force f (N) and the branch vector ℓ (m), which leads to the centre of grain i
/// from the centre of grain j, or from the touched point of a wall or fixed disc.
const STRESS_COLUMNS: &[ColumnSpec<DMat2>] = table_columns! { stress;
    "mean_stress_xx", "N/m", SomeNumber(some(stress.x_axis.x)),
        "mean of stress_xx over mean_time, with the area of this frame";
    "mean_stress_xy", "N/m", SomeNumber(some(stress.y_axis.x)),
        "mean of stress_xy over mean_time, with the area of this frame";
    "mean_stress_yx", "N/m", SomeNumber(some(stress.x_axis.y)),
        "mean of stress_yx over mean_time, with the area of this frame";
    "mean_stress_yy", "N/m", SomeNumber(some(stress.y_axis.y)),
        "mean of stress_yy over mean_time, with the area of this frame";
};

pub(super) fn of_grains(stresses: &[DMat2]) -> Table {
    Table::new("grains", STRESS_COLUMNS, stresses, &[])
}

#[derive(Clone, Copy)]
pub(super) struct PileMeans {
    secs: f64,
    stress: DMat2,
}

pub(super) fn of_pile(means: &[PileMeans]) -> Table {
    const SECS: &[ColumnSpec<PileMeans>] = table_columns! { means;
        "mean_time", "s", Number(means.secs), OVER;
    };
    let stresses: Vec<DMat2> = means.iter().map(|means| means.stress).collect();
    let stresses = Table::new("measures", STRESS_COLUMNS, &stresses, &[]);
    Table::new("measures", SECS, means, &[]).beside(stresses)
}

pub(super) struct WallMeans {
    force: DVec2,
    torque: f64,
    work: f64,
}

pub(super) fn of_walls(means: &[WallMeans]) -> Table {
    const COLUMNS: &[ColumnSpec<WallMeans>] = table_columns! { means;
        "mean_fx", "N", SomeNumber(some(means.force.x)),
            "force of the grains on the wall, mean over the time since the previous frame";
        "mean_fy", "N", SomeNumber(some(means.force.y)),
            "force of the grains on the wall, mean over the time since the previous frame";
        "mean_torque", "N m", SomeNumber(some(means.torque)),
            "torque of the grains on the wall about the present (x, y), mean over the same time; missing with periodic \
             borders";
        "work_between", "J", SomeNumber(some(means.work)),
            "work on grains since the previous frame, with the wall's velocity at the end of each step";
    };
    Table::new("walls", COLUMNS, means, &[])
}
