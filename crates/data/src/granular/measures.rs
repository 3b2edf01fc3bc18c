//! Computes measures of a pile, such as contacts, stress and solid fraction: around each of its grains, and for the
//! whole pile.

use glam::DVec2;

use super::MomentParts;
use super::mean_flow::peculiar_energy;
use super::stress::{self, Tensor};
use crate::column_spec::{CellValue, ColumnSpec};
use crate::sim::{ContactStatus, Moment};

/// Declares a structure for the rows of a table, and a [`ColumnSpec`] for each of its fields. The doc comment of a
/// field is also the description of its column in tables. The unit of a field follows its type.
macro_rules! columns {
    (@value f64 $field:ident) => {
        CellValue::SomeNumber(|row| (!row.$field.is_nan()).then_some(row.$field))
    };
    (@value u32 $field:ident) => {
        CellValue::Count(|row| u64::from(row.$field))
    };
    (@value bool $field:ident) => {
        CellValue::Flag(|row| Some(row.$field))
    };
    (
        $(#[$meta:meta])* $vis:vis struct $Name:ident {
            $($(#[doc = $about:literal])+ $field:ident: $type:ident, $unit:literal;)*
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
        $vis struct $Name {
            $(
                $(#[doc = $about])+
                #[doc = concat!("\n\nUnit: ", $unit, ".")]
                pub $field: $type,
            )*
        }

        impl $Name {
            /// Columns of the table, one per field, in the order of the declaration.
            pub const COLUMNS: &'static [ColumnSpec<Self>] = &[$(
                ColumnSpec {
                    name: stringify!($field),
                    unit: $unit,
                    about: concat!($($about),+).trim_ascii(),
                    value: columns!(@value $type $field),
                },
            )*];
        }
    };
}

columns! {
    /// Measures of the pile around one grain, at one time of the simulation. A lost grain (which went through a wall or
    /// left the scene) has no contacts, and its other numbers are NaN.
    pub struct GrainMeasures {
        /// Number of contacts with other grains, fixed discs and boundaries.
        coordination: u32, "1";
        /// True for a rattler, a grain that transmits no force.
        rattler: bool, "1";
        /// Area a of the grain's cell (the region that is nearer to the grain than to any other disc), as far as the
        /// cell belongs to the packing.
        cell_area: f64, "m²";
        /// Stress component σ_xx of σ = (1/a) Σ f ⊗ ℓ over the contacts of the grain, compression positive. f is the
        /// force on the grain, and ℓ leads from the contact point to the grain's centre. The mean over all grains,
        /// weighted by a, is the stress of the pile. NaN without a cell.
        stress_xx: f64, "N/m";
        /// Stress component σ_xy: x component of the contact forces, y component of the branch vectors ℓ, which lead
        /// from the contact points to the centre of the grain.
        stress_xy: f64, "N/m";
        /// Stress component σ_yx: y component of the contact forces, x component of the branch vectors ℓ, which lead
        /// from the contact points to the centre of the grain.
        stress_yx: f64, "N/m";
        /// Stress component σ_yy: y components of the contact forces and of the branch vectors ℓ, which lead from the
        /// contact points to the centre of the grain.
        stress_yy: f64, "N/m";
        /// Pressure p = (σ_1 + σ_2)/2: the mean of the principal stresses σ_1 and σ_2, which is half the trace of the
        /// stress σ.
        pressure: f64, "N/m";
        /// Deviatoric stress q = (σ_1 − σ_2)/2, never negative: half the difference of the principal values σ_1 ≥ σ_2
        /// of the symmetric part of the stress σ.
        deviator: f64, "N/m";
        /// Area of the grain's disc divided by the area of the grain's cell; NaN if the cell is at a free surface or a
        /// hole.
        solid_fraction: f64, "1";
    }
}

impl GrainMeasures {
    /// Computes the measures around each grain of a pile, in the order of the grains.
    pub fn of_each(moment: &Moment) -> Vec<Self> {
        Self::of_parts(&MomentParts::of(moment))
    }

    pub(super) fn of_parts(parts: &MomentParts) -> Vec<Self> {
        let MomentParts { network, cells, coordination, .. } = parts;
        let sums = stress::stress_of_grains(network);
        let of_grain = |(index, sum): (usize, Tensor)| {
            let cell_area = cells.areas[index];
            // A disc inside a larger disc may have no cell.
            let stress = sum.over(if cell_area > 0.0 { cell_area } else { f64::NAN });
            Self {
                coordination: coordination.of_grains[index],
                rattler: coordination.rattlers[index],
                cell_area,
                stress_xx: stress.xx,
                stress_xy: stress.xy,
                stress_yx: stress.yx,
                stress_yy: stress.yy,
                pressure: stress.mean(),
                deviator: stress.deviator(),
                solid_fraction: cells.solid_fractions[index],
            }
        };
        sums.into_iter().enumerate().map(of_grain).collect()
    }
}

columns! {
    /// Measures of the whole pile at one time of the simulation. An undefined measure is NaN, such as a mean over no
    /// contacts, or a principal direction if both principal values are equal.
    pub struct PileMeasures {
        /// Number of grains that are not lost. All other measures are those of these grains.
        grains: u32, "1";
        /// Number of touching contacts.
        contacts: u32, "1";
        /// Area A of the cells of all grains, as far as the cells belong to the packing.
        area: f64, "m²";
        /// Area of the axis-parallel box around all grains.
        box_area: f64, "m²";
        /// Stress component σ_xx of σ = (1/A) Σ f ⊗ ℓ over all contacts, compression positive. f is the force on grain
        /// i. ℓ leads to the centre of grain i from the centre of the other grain, or from the touched point of a body
        /// that no grain moves.
        stress_xx: f64, "N/m";
        /// Stress component σ_xy: x component of the contact forces, y component of the branch vectors ℓ, which lead to
        /// the centre of grain i from the body that it touches.
        stress_xy: f64, "N/m";
        /// Stress component σ_yx: y component of the contact forces, x component of the branch vectors ℓ, which lead to
        /// the centre of grain i from the body that it touches. It equals σ_xy if the torques on each grain balance.
        stress_yx: f64, "N/m";
        /// Stress component σ_yy: y components of the contact forces and of the branch vectors ℓ, which lead to the
        /// centre of grain i from the body that it touches.
        stress_yy: f64, "N/m";
        /// Pressure p = (σ_1 + σ_2)/2: the mean of the principal stresses σ_1 and σ_2, which is half the trace of the
        /// stress σ.
        pressure: f64, "N/m";
        /// Deviatoric stress q = (σ_1 − σ_2)/2, never negative: half the difference of the principal values σ_1 ≥ σ_2
        /// of the symmetric part of the stress σ.
        deviator: f64, "N/m";
        /// Direction of the largest compression, anticlockwise from the x axis, at least 0 and below 180.
        principal_direction: f64, "degree";
        /// Kinetic pressure (1/2A) Σ m |v − v̄|², a sum over all grains with the mass m and the velocity v of each
        /// grain, the mean flow v̄ at the grain and the area A of the pile: the part of the pressure that is the
        /// momentum carried by the fluctuations of grains. No stress component contains it. The mean flow v̄ at a grain
        /// is a linear fit to the velocities of all grains less than 3 mean diameters away, including the grain itself.
        /// With n of them, the factor n/(n − 3) corrects for the fit. With fewer than 7, v̄ is the velocity of the
        /// centre of mass of all grains.
        kinetic_pressure: f64, "N/m";
        /// Fabric component F_xx. The fabric F is the mean of n ⊗ n over all contacts with the normals n; its trace is
        /// 1.
        fabric_xx: f64, "1";
        /// Fabric component F_xy: mean of n_x·n_y over all contacts with the normals n.
        fabric_xy: f64, "1";
        /// Fabric component F_yy: mean of n_y² over all contacts with the normals n.
        fabric_yy: f64, "1";
        /// Fabric anisotropy F_1 − F_2, the difference of the principal values of the fabric: 0 if the normals have no
        /// preferred direction, 1 if all have the same direction.
        fabric_anisotropy: f64, "1";
        /// Preferred direction of the normals, anticlockwise from the x axis, at least 0 and below 180.
        fabric_direction: f64, "degree";
        /// Mean number of contacts per grain, with other grains, fixed discs and boundaries.
        coordination: f64, "1";
        /// Mean number of contacts per grain without rattlers (grains that transmit no force). Only contacts count that
        /// bear a force and do not involve a rattler.
        coordination_without_rattlers: f64, "1";
        /// Number of rattlers: grains that transmit no force, because they have fewer than two force-bearing contacts
        /// with bodies that are not rattlers.
        rattlers: u32, "1";
        /// Area of all discs, overlaps counted twice, divided by the area of the axis-parallel box around them.
        solid_fraction_box: f64, "1";
        /// Area of the discs whose cells are closed (not at a free surface or a hole), divided by the area of these
        /// cells.
        solid_fraction_cells: f64, "1";
        /// Number of grains with closed cells: the pores around such a grain are too small for another grain of the
        /// mean radius.
        closed_cells: u32, "1";
        /// Fraction of the contacts that slip.
        sliding_share: f64, "1";
        /// Fraction of the contacts that open: they pull with the largest force that the law allows, which is 0 without
        /// cohesion.
        open_share: f64, "1";
        /// Fraction of the contacts that pull.
        tensile_share: f64, "1";
        /// Number of sets of grains that are connected by contacts; an isolated grain is a set. Fixed discs and
        /// boundaries connect no grains.
        clusters: u32, "1";
        /// Number of grains in the largest cluster, a set of grains that are connected by contacts.
        largest_cluster: u32, "1";
        /// Mean magnitude ⟨|N|⟩ of the normal forces N of contacts that bear a force: the unit of the relative normal
        /// forces f = N/⟨|N|⟩.
        mean_normal_force: f64, "N";
        /// Second moment ⟨f²⟩ of the relative normal forces f = N/⟨|N|⟩ (normal force N divided by its mean magnitude):
        /// 1 if all forces are equal, 2 if they are distributed exponentially.
        normal_force_second_moment: f64, "1";
        /// Third moment ⟨|f|³⟩ of the relative normal forces f = N/⟨|N|⟩ (normal force N divided by its mean
        /// magnitude): 1 if all forces are equal, 6 if they are distributed exponentially.
        normal_force_third_moment: f64, "1";
        /// Largest magnitude |f| of the relative normal forces f = N/⟨|N|⟩ (normal force N divided by its mean
        /// magnitude).
        largest_normal_force: f64, "1";
        /// Fraction of the force-bearing contacts whose normal force is larger in magnitude than the mean magnitude of
        /// the normal forces: the strong network.
        strong_share: f64, "1";
    }
}

impl PileMeasures {
    /// Computes the measures of a whole pile. If the measures around its grains are also needed,
    /// [`measure`](super::measure) is cheaper.
    pub fn of(moment: &Moment) -> Self {
        Self::of_parts(&MomentParts::of(moment))
    }

    pub(super) fn of_parts(parts: &MomentParts) -> Self {
        let MomentParts { network, cells, coordination, forces, clusters, surroundings } = parts;
        let stress = stress::stress_of_contacts(network).over(cells.area);
        let fabric = stress::fabric(network);
        Self {
            grains: network.len() as u32,
            contacts: network.links.len() as u32,
            area: cells.area,
            box_area: cells.box_area,
            stress_xx: stress.xx,
            stress_xy: stress.xy,
            stress_yx: stress.yx,
            stress_yy: stress.yy,
            pressure: stress.mean(),
            deviator: stress.deviator(),
            principal_direction: stress.direction(),
            kinetic_pressure: peculiar_energy(network, surroundings) / cells.area,
            fabric_xx: fabric.xx,
            fabric_xy: fabric.xy,
            fabric_yy: fabric.yy,
            fabric_anisotropy: 2.0 * fabric.deviator(),
            fabric_direction: fabric.direction(),
            coordination: coordination.mean,
            coordination_without_rattlers: coordination.mean_without_rattlers,
            rattlers: coordination.rattlers.iter().filter(|&&rattler| rattler).count() as u32,
            solid_fraction_box: cells.disc_area / cells.box_area,
            solid_fraction_cells: cells.solid_fraction,
            closed_cells: cells.closed,
            sliding_share: network.share(|link| link.status == ContactStatus::Slip),
            open_share: network.share(|link| link.status == ContactStatus::Open),
            tensile_share: network.share(|link| link.normal_force < 0.0),
            clusters: clusters.count,
            largest_cluster: clusters.largest,
            mean_normal_force: forces.mean,
            normal_force_second_moment: forces.moment(2),
            normal_force_third_moment: forces.moment(3),
            largest_normal_force: forces.largest(),
            strong_share: forces.strong_share(),
        }
    }
}

columns! {
    /// Shape of a heap at one time of the simulation, described by a triangle. The mass of the triangle and the mass of
    /// the heap have the same mean height above the lowest point and the same mean horizontal distance from the middle.
    pub struct HeapShape {
        /// Angle of repose: slope of the sides of the triangle that represents the heap.
        repose_angle: f64, "degree";
        /// Run-out: half the base of the triangle that represents the heap.
        run_out: f64, "m";
    }
}

impl HeapShape {
    /// Computes the triangle that describes the shape of a heap.
    pub fn of(moment: &Moment) -> Self {
        let grains = || moment.grains.iter().filter(|grain| !grain.lost);
        let mean = |of: &dyn Fn(DVec2) -> f64| {
            let mass: f64 = grains().map(|grain| grain.mass).sum();
            grains().map(|grain| grain.mass * of(grain.position)).sum::<f64>() / mass
        };
        let lowest = grains().map(|grain| grain.position.y - grain.radius).fold(f64::NAN, f64::min);
        let middle = mean(&|position| position.x);
        let distance = mean(&|position| (position.x - middle).abs());
        let height = mean(&|position| position.y - lowest);
        Self { repose_angle: (height / distance).atan().to_degrees(), run_out: 3.0 * distance }
    }
}
