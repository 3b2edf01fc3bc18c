//! What the tables of moments must be.

use slump::granular::measure;
use slump::sim::{ContactState, GrainState, Moment, Observables, OtherBody, Stepper};

use super::tables::{Cell, Columns};

/// Rows of columns, in any order of the columns.
struct Rows(Columns);

impl Rows {
    fn add(&mut self, cells: Vec<(&str, Cell)>) {
        for (name, cell) in cells {
            self.0.entry(name.to_owned()).or_default().push(cell);
        }
    }
}

pub fn word(word: &str) -> Cell {
    Cell::Word(word.to_owned())
}

fn optional(number: Option<f64>) -> Cell {
    number.map_or(Cell::Nothing, Cell::from)
}

fn grain_cells(moment: &Moment, id: usize, grain: &GrainState) -> Vec<(&'static str, Cell)> {
    vec![
        ("step", Cell::Whole(moment.observables.step)),
        ("time", moment.observables.time_secs.into()),
        ("id", Cell::Whole(id as u64)),
        ("x", grain.position.x.into()),
        ("y", grain.position.y.into()),
        ("angle", grain.angle.into()),
        ("vx", grain.velocity.x.into()),
        ("vy", grain.velocity.y.into()),
        ("omega", grain.angular_velocity.into()),
        ("radius", grain.radius.into()),
        ("mass", grain.mass.into()),
        ("kind", word(if grain.lost { "lost" } else { "grain" })),
    ]
}

pub fn grains(moments: &[Moment]) -> Columns {
    let mut rows = Rows(Columns::new());
    for moment in moments {
        for (id, grain) in moment.grains.iter().enumerate() {
            rows.add(grain_cells(moment, id, grain));
        }
        for (index, disc) in moment.surroundings.fixed_discs.iter().enumerate() {
            let still = GrainState {
                position: disc.position,
                radius: disc.radius,
                angle: 0.0,
                velocity: glam::DVec2::ZERO,
                angular_velocity: 0.0,
                lost: false,
                ..moment.grains[0]
            };
            let mut cells = grain_cells(moment, moment.grains.len() + index, &still);
            for (name, cell) in &mut cells {
                match *name {
                    "mass" => *cell = Cell::Nothing,
                    "kind" => *cell = word("fixed"),
                    _ => {}
                }
            }
            rows.add(cells);
        }
    }
    rows.0
}

fn contact_cells(moment: &Moment, contact: &ContactState) -> Vec<(&'static str, Cell)> {
    let discs = moment.grains.len() + moment.surroundings.fixed_discs.len();
    let (id, kind, name) = match contact.other {
        OtherBody::Grain(index) => (index as usize, "grain", String::new()),
        OtherBody::FixedDisc(index) => {
            (moment.grains.len() + index as usize, "fixed", String::new())
        }
        OtherBody::Boundary(index) => {
            let boundary = &moment.surroundings.boundaries[index as usize];
            let said = serde_json::to_value(boundary).expect("JSON");
            let shape = said["shape"].as_str().expect("a word").to_owned();
            (discs + index as usize, "boundary", format!("{shape} {index}"))
        }
    };
    let bond = match moment.settings.stepper {
        Stepper::Range => Cell::Flag(contact.bond_stretch.is_some()),
        _ => Cell::Nothing,
    };
    vec![
        ("step", Cell::Whole(moment.observables.step)),
        ("time", moment.observables.time_secs.into()),
        ("id_i", Cell::Whole(contact.grain.into())),
        ("id_j", Cell::Whole(id as u64)),
        ("kind_j", word(kind)),
        ("name_j", Cell::Word(name)),
        ("x", contact.point.x.into()),
        ("y", contact.point.y.into()),
        ("nx", contact.normal.x.into()),
        ("ny", contact.normal.y.into()),
        ("gap", contact.gap.into()),
        ("normal_force", contact.normal_force.into()),
        ("tangential_force", contact.tangential_force.into()),
        ("status", word(contact.status.name())),
        ("bond", bond),
        ("stretch", optional(contact.bond_stretch)),
        ("age", Cell::Whole(contact.age_steps)),
    ]
}

pub fn contacts(moments: &[Moment]) -> Columns {
    let mut rows = Rows(Columns::new());
    for moment in moments {
        moment.contacts.iter().for_each(|contact| rows.add(contact_cells(moment, contact)));
    }
    rows.0
}

pub fn observables(all: &[Observables]) -> Columns {
    let mut rows = Rows(Columns::new());
    for row in all {
        let Observables { step, time_secs, time_step_secs, residual, slump, converged, .. } = *row;
        rows.add(vec![
            ("step", Cell::Whole(step)),
            ("time", time_secs.into()),
            ("time_step", time_step_secs.into()),
            ("sweeps", Cell::Whole(row.sweeps.into())),
            ("factorisations", Cell::Whole(row.factorisations.into())),
            ("converged", Cell::Flag(converged)),
            ("stalled", Cell::Flag(row.stalled)),
            ("residual", residual.into()),
            ("model_residual", optional(row.model_residual)),
            ("duality_gap", optional(row.duality_gap)),
            ("fell_back", optional(row.fell_back.map(|fell_back| u8::from(fell_back).into()))),
            ("contacts", Cell::Whole(row.contacts.into())),
            ("compressive_contacts", Cell::Whole(row.compressive_contacts.into())),
            ("tensile_contacts", Cell::Whole(row.tensile_contacts.into())),
            ("mean_overlap", row.mean_overlap.into()),
            ("max_overlap", row.max_overlap.into()),
            ("kinetic_energy", row.kinetic_energy.into()),
            ("potential_energy", row.potential_energy.into()),
            ("normal_work", row.normal_work.into()),
            ("tangential_work", row.tangential_work.into()),
            ("drive_energy", optional(row.drive_energy)),
            ("drive_work", optional(row.drive_work)),
            ("border_work", optional(row.border_work)),
            ("gravity_work", row.gravity_work.into()),
            ("slump", slump.into()),
            ("bond_work", optional(row.bond_work)),
            ("bond_energy", optional(row.bond_energy)),
            ("broken_bond_energy", optional(row.broken_bond_energy)),
            ("lost_grains", Cell::Whole(row.lost_grains.into())),
        ]);
    }
    rows.0
}

fn measured(number: f64) -> Cell {
    optional((!number.is_nan()).then_some(number))
}

/// Columns of grains that are measured.
pub fn grain_measures(moments: &[Moment]) -> Columns {
    let mut rows = Rows(Columns::new());
    for moment in moments {
        for of_grain in measure(moment).grains {
            rows.add(vec![
                ("coordination", f64::from(of_grain.coordination).into()),
                ("rattler", Cell::Flag(of_grain.rattler)),
                ("pressure", measured(of_grain.pressure)),
                ("deviator", measured(of_grain.deviator)),
                ("stress_xy", measured(of_grain.stress_xy)),
                ("cell_area", measured(of_grain.cell_area)),
                ("solid_fraction", measured(of_grain.solid_fraction)),
            ]);
        }
        for _ in &moment.surroundings.fixed_discs {
            let names = ["coordination", "rattler", "pressure", "deviator", "stress_xy"];
            let names = names.into_iter().chain(["cell_area", "solid_fraction"]);
            rows.add(names.map(|name| (name, Cell::Nothing)).collect());
        }
    }
    rows.0
}

pub fn measures(moments: &[Moment]) -> Columns {
    let mut rows = Rows(Columns::new());
    for moment in moments {
        let pile = measure(moment).pile;
        rows.add(vec![
            ("step", Cell::Whole(moment.observables.step)),
            ("time", moment.observables.time_secs.into()),
            ("grains", Cell::Whole(pile.grains.into())),
            ("stress_xx", measured(pile.stress_xx)),
            ("pressure", measured(pile.pressure)),
            ("fabric_anisotropy", measured(pile.fabric_anisotropy)),
            ("coordination", measured(pile.coordination)),
            ("rattlers", Cell::Whole(pile.rattlers.into())),
            ("solid_fraction_cells", measured(pile.solid_fraction_cells)),
            ("strong_share", measured(pile.strong_share)),
        ]);
    }
    rows.0
}

pub fn histograms(moments: &[Moment]) -> Columns {
    let mut rows = Rows(Columns::new());
    for moment in moments {
        for histogram in measure(moment).histograms {
            for (bin, &count) in histogram.counts.iter().enumerate() {
                rows.add(vec![
                    ("step", Cell::Whole(moment.observables.step)),
                    ("time", moment.observables.time_secs.into()),
                    ("quantity", word(histogram.quantity)),
                    ("unit", word(histogram.unit)),
                    ("from", histogram.edges[bin].into()),
                    ("to", histogram.edges[bin + 1].into()),
                    ("count", Cell::Whole(count)),
                ]);
            }
        }
    }
    rows.0
}
