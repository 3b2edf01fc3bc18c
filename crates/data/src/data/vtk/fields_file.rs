//! Writes the smoothed fields of a frame as a VTK image.
//!
//! Frames of a recording are compared with each other, so all frames use the same smoothing width. A single grain that
//! flies off must not make the images of all other grains coarser or larger. The first frame therefore determines width
//! and region for all frames: the width is a mean diameter, and the fields cover the box around the grains of that
//! frame with some margin.

use std::path::Path;

use glam::DVec2;

use super::head::{add_facts, add_moment, head_of, number_in};
use super::vtk_file::{VtkCells, VtkFile};
use crate::data::format::{Frame, RunFacts};
use crate::error::Result;
use crate::granular::{Fields, box_of};
use crate::output::{counted, note_line};
use crate::sim::Moment;

/// Possible margins between the box around the first frame's grains and the edges of the region that the fields cover,
/// in lengths of the box's longer side. The largest margin that does not give too many grid cells is used. With less
/// margin, grains that flow out of the box are soon left out. With more, a grain that flies off makes images larger for
/// longer.
const ROOM_IN_SIDES: [f64; 4] = [3.0, 1.0, 0.25, 0.0];
/// Smallest side length, in mean diameters, for which the margin is computed. A smaller box around the grains gets the
/// margin of a box with this side length.
const LEAST_SIDE_IN_DIAMETERS: f64 = 10.0;
/// Name under which a file states the smoothing width, m.
const WIDTH: &str = "smoothing_width";
/// Names under which a file states the lower left and the upper right corner of the region that the fields cover, m.
const CORNERS: [&str; 4] = ["least_x", "least_y", "most_x", "most_y"];
/// Name under which a file states the number of grains outside the region that the fields cover.
const LEFT_OUT: &str = "left_out_grains";

/// Descriptions of the fields, which are written into the array `columns` of a file.
const OF_FIELDS: [&str; 11] = [
    "density [kg/m^2]: smoothed with smoothing_width, m, the standard deviation along each axis; means over cells",
    "momentum [kg/(m s)]: likewise",
    "velocity [m/s]: momentum over density; NaN where there is none",
    "kinetic_stress_xx [N/m]: of velocities relative to that of the cell, compression positive",
    "kinetic_stress_xy [N/m]: likewise, and the same as yx",
    "kinetic_stress_yy [N/m]: likewise",
    "contact_stress_xx [N/m]: of forces along the ways between centres, compression positive",
    "contact_stress_xy [N/m]: x of the forces, y of the ways",
    "contact_stress_yx [N/m]: y of the forces, x of the ways",
    "contact_stress_yy [N/m]: likewise",
    "left_out_grains: outside of the box from (least_x, least_y) to (most_x, most_y), m, which fields cover",
];

/// Smoothing width of the fields of a recording, and the region that they cover.
pub(super) struct FieldsBox {
    width: f64,
    corners: [DVec2; 2],
    has_told: bool,
}

impl FieldsBox {
    /// Chooses the smoothing width of a recording's fields and the region that they cover. `moment` is the snapshot of
    /// its first frame. If smoothing over a mean diameter needs too many grid cells, the width is doubled as often as
    /// necessary.
    fn of(moment: &Moment) -> Self {
        let grains = moment.grains.iter().filter(|grain| !grain.lost);
        let [low, high] = box_of(grains.map(|grain| grain.position));
        let around = &moment.surroundings;
        let least = LEAST_SIDE_IN_DIAMETERS * around.mean_diameter;
        let side = (high - low).max_element().max(least);
        let with_room = |room: f64| [low - room * side, high + room * side];
        let mut width = around.mean_diameter;
        loop {
            let is_small = |corners: &[DVec2; 2]| Fields::are_few(around.periodic, *corners, width);
            let found = ROOM_IN_SIDES.map(with_room).into_iter().find(is_small);
            if let Some(corners) = found.or((!width.is_finite()).then_some([low, high])) {
                return Self { width, corners, has_told: false };
            }
            width *= 2.0;
        }
    }

    /// Reads the smoothing width and the covered region from a file of the recording; `None` if the file does not state
    /// them.
    pub(super) fn of_file(path: &Path) -> Option<Self> {
        let head = head_of(path).ok()?;
        let number = |name: &str| number_in(&head, name)?.parse::<f64>().ok();
        let [left, bottom, right, top] = CORNERS.map(number);
        let corners = [DVec2::new(left?, bottom?), DVec2::new(right?, top?)];
        Some(Self { width: number(WIDTH)?, corners, has_told: false })
    }

    /// Returns the number of grains outside the region that the fields cover.
    fn left_out(&self, moment: &Moment) -> u64 {
        let [least, most] = self.corners;
        // Along a periodic axis, all grains are inside the region.
        let [along_x, along_y] = moment.surroundings.periodic.unwrap_or_default().periods();
        let is_out = |at: DVec2| {
            (along_x.is_none() && !(least.x..=most.x).contains(&at.x))
                || (along_y.is_none() && !(least.y..=most.y).contains(&at.y))
        };
        let there = moment.grains.iter().filter(|grain| !grain.lost);
        there.filter(|grain| is_out(grain.position)).count() as u64
    }
}

/// Returns the bytes of the file with the fields of a frame. If smoothing width and covered region are not yet known,
/// they are chosen from this frame.
pub(super) fn fields_file(
    frame: &Frame,
    facts: &RunFacts,
    of_fields: &mut Option<FieldsBox>,
) -> Result<Vec<u8>> {
    let moment = &frame.moment;
    let covered = of_fields.get_or_insert_with(|| FieldsBox::of(moment));
    let left_out = covered.left_out(moment);
    let [least, most] = covered.corners;
    if left_out > 0 && !covered.has_told {
        covered.has_told = true;
        note_line(format_args!(
            "fields: {} left the box from ({:.4}, {:.4}) to ({:.4}, {:.4}) m, which fields cover, by step {}; the fields are \
             those of the rest",
            counted(left_out, "grain"),
            least.x,
            least.y,
            most.x,
            most.y,
            moment.observables.step
        ));
    }
    let fields = Fields::in_box(moment, covered.width, covered.corners)?;
    let along = |axis: usize| [fields.first[axis], fields.first[axis] + fields.counts[axis] as i64];
    let cells = VtkCells::Grid {
        origin: fields.origin.to_array(),
        sides: fields.cell.to_array(),
        extent: [along(0), along(1)],
    };
    let mut file = VtkFile::new(cells, std::iter::empty());
    add_moment(&mut file, frame);
    file.add_number(WIDTH, fields.width);
    for (name, number) in CORNERS.into_iter().zip([least.x, least.y, most.x, most.y]) {
        file.add_number(name, number);
    }
    file.add_number(LEFT_OUT, left_out as i64);
    file.add_words("columns", OF_FIELDS.iter());
    add_facts(&mut file, facts);
    file.add_column("density", fields.density.iter().copied());
    for (name, vectors) in [("momentum", &fields.momentum), ("velocity", &fields.velocity)] {
        file.add_vectors(name, ["x", "y"], vectors.iter().map(DVec2::to_array));
    }
    let kinetic = &fields.kinetic_stress;
    file.add_column("kinetic_stress_xx", kinetic.iter().map(|stress| stress.x_axis.x));
    file.add_column("kinetic_stress_xy", kinetic.iter().map(|stress| stress.y_axis.x));
    file.add_column("kinetic_stress_yy", kinetic.iter().map(|stress| stress.y_axis.y));
    let of_contacts = &fields.contact_stress;
    file.add_column("contact_stress_xx", of_contacts.iter().map(|stress| stress.x_axis.x));
    file.add_column("contact_stress_xy", of_contacts.iter().map(|stress| stress.y_axis.x));
    file.add_column("contact_stress_yx", of_contacts.iter().map(|stress| stress.x_axis.y));
    file.add_column("contact_stress_yy", of_contacts.iter().map(|stress| stress.y_axis.y));
    Ok(file.finish("density"))
}
