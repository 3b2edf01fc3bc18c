//! Tests of the cell areas of grains (the area that belongs to each grain), against known areas and against counting
//! the points of a raster.

use std::f64::consts::PI;

use crate::common::*;

use super::packings::triangular_discs;
use super::packings::{among, box_walls, disc, discs};

const EXACT: f64 = 1e-12;

/// Returns the index of the disc to whose cell (the region that belongs to the disc) a point belongs: the disc for
/// which the power (squared distance from the centre minus r²) is smallest, if this power is below `largest_power` =
/// 3r̄² (r̄: mean radius). Otherwise the point is outside the packing, and the result is `None`.
fn owner(point: DVec2, discs: &[(DVec2, f64)], largest_power: f64) -> Option<usize> {
    let power =
        |&(centre, radius): &(DVec2, f64)| (point - centre).length_squared() - radius * radius;
    let powers = discs.iter().map(power).enumerate();
    let (index, least) = powers.min_by(|(_, a), (_, b)| a.total_cmp(b))?;
    (least < largest_power).then_some(index)
}

/// Returns two areas for each grain, m², found by counting points of a raster: the area of the part of its cell (the
/// region nearer to the grain than to any other disc) that is in the box around all grains and in the box `room` (lower
/// left and upper right corner, m), and the area of the part that is in the box `room`. The raster divides the box
/// around all grains into `steps` steps along each side.
fn areas_by_counting(moment: &Moment, steps: i32, room: [DVec2; 2]) -> Vec<[f64; 2]> {
    let grains = &moment.grains;
    let radii: f64 = grains.iter().map(|grain| grain.radius).sum();
    let largest_power = 3.0 * (radii / grains.len() as f64).powi(2);
    let disc = |grain: &GrainState| (grain.position, grain.radius);
    let fixed = moment.surroundings.fixed_discs.iter().map(|disc| (disc.position, disc.radius));
    let all: Vec<_> = grains.iter().map(disc).chain(fixed).collect();
    let corner = |sign: f64, of: fn(DVec2, DVec2) -> DVec2| {
        grains.iter().map(|grain| grain.position + sign * grain.radius).reduce(of)
    };
    let low = corner(-1.0, DVec2::min).expect("a grain");
    let high = corner(1.0, DVec2::max).expect("a grain");
    let step = (high - low) / f64::from(steps);
    let beyond = steps / 8;
    let mut areas = vec![[0.0; 2]; grains.len()];
    for (row, column) in pairs(-beyond..steps + beyond, -beyond..steps + beyond) {
        let point = low + step * (DVec2::new(f64::from(column), f64::from(row)) + 0.5);
        if !(point.cmpgt(room[0]).all() && point.cmplt(room[1]).all()) {
            continue;
        }
        let in_box = (0..steps).contains(&row) && (0..steps).contains(&column);
        if let Some([inside, everywhere]) =
            owner(point, &all, largest_power).and_then(|index| areas.get_mut(index))
        {
            *everywhere += step.x * step.y;
            *inside += if in_box { step.x * step.y } else { 0.0 };
        }
    }
    areas
}

/// Returns `count` discs of very different sizes at random positions; some overlap, touch or are isolated.
fn scattered(count: usize, seed: u64) -> Vec<GrainState> {
    let mut random = random(seed);
    let grains = (0..count).map(|_| {
        let place = DVec2::new(random.random_range(0.0..9.0), random.random_range(0.0..7.0));
        disc(place, 0.15 * 4f64.powf(random.random()))
    });
    grains.collect()
}

#[track_caller]
fn assert_counted(moment: &Moment, room: [DVec2; 2]) {
    let counted = areas_by_counting(moment, 500, room);
    let (mut sum_of_cells, mut sum_counted) = (0.0, 0.0);
    for (measured, [inside, everywhere]) in GrainMeasures::of_each(moment).iter().zip(counted) {
        let is_open = measured.solid_fraction.is_nan();
        let counted = if is_open { inside } else { everywhere };
        let off = measured.cell_area - counted;
        // A border of 1 m length crosses about 60 squares of the raster.
        assert!(off.abs() < 0.01 * counted + 6e-3, "{measured:?} of {counted}");
        sum_of_cells += measured.cell_area;
        sum_counted += counted;
    }
    assert_close(sum_of_cells, sum_counted, 1e-3, "area of all cells");
}

#[test]
fn every_point_is_in_the_cell_of_its_disc_of_least_power() {
    for (count, seed) in [(150, 1), (300, 2), (600, 3)] {
        let moment = discs(scattered(count, seed));
        let closed = measure(&moment).pile.closed_cells;
        let open = count as u32 - closed;
        assert!(open > 5 && closed > 3, "{open} of {count} cells are open");
        assert_counted(&moment, [DVec2::NEG_INFINITY, DVec2::INFINITY]);
    }
}

#[test]
fn fixed_discs_and_walls_take_their_room() {
    let inside = |grain: &GrainState| {
        let (low, high) = (grain.position - grain.radius, grain.position + grain.radius);
        low.cmpge(DVec2::ZERO).all() && high.cmple(DVec2::new(9.0, 7.0)).all()
    };
    let grains: Vec<_> = scattered(300, 5).into_iter().filter(inside).collect();
    let base: Vec<Disc> = (0..10).map(|k| fixed(DVec2::new(f64::from(k), 0.2), 0.4)).collect();
    let room = [DVec2::ZERO, DVec2::new(9.0, 7.0)];
    assert_counted(&among(discs(grains), box_walls(room[0], room[1]), base), room);
}

#[test]
fn cells_of_unequal_discs_that_lie_close_fill_their_box() {
    let mut random = random(11);
    let grains: Vec<_> = (0..20 * 15)
        .map(|index| {
            let place = DVec2::new((index % 20) as f64, (index / 20) as f64);
            let shift = DVec2::new(random.random_range(0.0..0.1), random.random_range(0.0..0.1));
            disc(place + 0.45 + shift, random.random_range(0.4..0.6))
        })
        .collect();
    let walls = box_walls(DVec2::ZERO, DVec2::new(20.0, 15.0));
    let measured = measure(&among(discs(grains), walls, Vec::new()));
    assert_eq!(measured.pile.closed_cells, 300);
    assert_close(measured.pile.area, 300.0, EXACT, "A");
    let discs: f64 = measured.pile.solid_fraction_box * measured.pile.box_area;
    assert_close(measured.pile.solid_fraction_cells, discs / 300.0, EXACT, "by cells");
}

#[test]
fn two_discs_that_touch_part_at_their_contact() {
    // A large and a small disc in a box with the height of the large disc.
    let (large, small) = (3.0, 1.0);
    let grains = vec![
        disc(DVec2::new(large, large), large),
        disc(DVec2::new(2.0 * large + small, large), small),
    ];
    let high = DVec2::new(2.0 * (large + small), 2.0 * large);
    let moment = among(discs(grains), box_walls(DVec2::ZERO, high), Vec::new());
    let measured = GrainMeasures::of_each(&moment);
    assert_close(measured[0].cell_area, 4.0 * large * large, EXACT, "the large one's");
    assert_close(measured[0].solid_fraction, PI / 4.0, EXACT, "its solid fraction");
    assert_close(measured[1].cell_area, 4.0 * large * small, EXACT, "the small one's");
    assert_close(measured[1].solid_fraction, PI / 12.0, EXACT, "its solid fraction");
}

#[test]
fn a_disc_alone_has_the_room_within_its_reach() {
    let alone = |moment: &Moment| GrainMeasures::of_each(moment)[0];
    let one = alone(&discs(vec![disc(DVec2::new(0.3, 0.7), 1.0)]));
    assert_close(one.cell_area, 4.0, EXACT, "in the box around it");
    assert!(one.solid_fraction.is_nan());
    // Two discs in a row, far apart in a long box. Each disc owns the points within 2r of its centre.
    let two = discs(vec![disc(DVec2::ZERO, 1.0), disc(DVec2::new(50.0, 0.0), 1.0)]);
    let expected = 2.0 + 3f64.sqrt() + 2.0 * PI / 3.0;
    assert_close(alone(&two).cell_area, expected, EXACT, "in a long box");
    // The lower left disc in a wide box owns a quarter of a circle, two strips, and the square in the corner.
    let far = [DVec2::ZERO, DVec2::new(90.0, 30.0), DVec2::new(20.0, 80.0)];
    let three = discs(far.map(|place| disc(place, 1.0)).to_vec());
    let strip = 0.5 * 3f64.sqrt() + PI / 3.0;
    assert_close(alone(&three).cell_area, PI + 2.0 * strip + 1.0, EXACT, "at a wide box's corner");
}

#[test]
fn a_vacancy_opens_the_cells_around_it_and_a_pore_does_not() {
    let mut moment = triangular_discs(9, 9);
    let PileMeasures { area, closed_cells: closed, .. } = measure(&moment).pile;
    assert_eq!(closed, 7 * 7);
    moment.grains[4 * 9 + 4].lost = true;
    let measured = measure(&moment);
    assert_eq!(measured.pile.closed_cells, closed - 7);
    let empty: Vec<_> = measured.grains.iter().filter(|grain| grain.cell_area.is_nan()).collect();
    assert_eq!(empty.len(), 1);
    // The middle of the hole is exactly on the border of the packing, so the packing includes the whole hole.
    assert_close(measured.pile.area, area, EXACT, "A");
}

#[test]
fn walls_made_of_sides_cut_as_the_planes_they_lie_in() {
    let (width, height) = (18.0, 20.0);
    let grains: Vec<_> = (0..81)
        .map(|index| {
            let place = DVec2::new(f64::from(index % 9), f64::from(index / 9));
            disc(2.0 * place + 1.0, 1.0 - 1e-3 * f64::from(index % 7))
        })
        .collect();
    let of = |walls: Vec<Boundary>| measure(&among(discs(grains.clone()), walls, Vec::new()));
    let point = DVec2::new;
    let mut planes = box_walls(DVec2::ZERO, point(width, height));
    planes.pop();
    let planes = of(planes);
    let bin = [point(0.0, height), DVec2::ZERO, point(width, 0.0), point(width, height)];
    let joint = [bin[0], bin[1], point(7.3, 0.0), bin[2], bin[3]];
    let bars = |ends: &[DVec2]| {
        let segments = ends.windows(2);
        segments.map(|ends| Boundary::Segment { from: ends[0], to: ends[1] }).collect::<Vec<_>>()
    };
    let slab = |low: DVec2, high: DVec2| Boundary::ConvexPolygon {
        points: vec![low, point(high.x, low.y), high, point(low.x, high.y)],
    };
    let slabs = vec![
        slab(point(-1.0, -1.0), point(0.0, height)),
        slab(point(-1.0, -2.0), point(width + 1.0, 0.0)),
        slab(point(width, -1.0), point(width + 1.0, height)),
    ];
    for (name, walls) in [
        ("polyline", vec![Boundary::Polyline { points: bin.to_vec() }]),
        ("jointed polyline", vec![Boundary::Polyline { points: joint.to_vec() }]),
        ("segments", bars(&bin)),
        ("polygons", slabs),
    ] {
        let measured = of(walls);
        assert_eq!(measured.pile.closed_cells, 9 * 8, "{name}");
        for (found, expected) in measured.grains.iter().zip(&planes.grains) {
            assert_close(found.cell_area, expected.cell_area, 1e-9, name);
        }
    }
    assert_close(planes.pile.area, planes.pile.box_area, 1e-2, "A");
}

#[test]
fn a_corner_cuts_the_cell_of_what_rests_on_it() {
    // The upper corner of a square, which stands on its opposite corner, is half a radius below the centre of the disc.
    let tip = DVec2::new(0.0, -0.5);
    let others = [DVec2::NEG_ONE, DVec2::new(0.0, -2.0), DVec2::new(1.0, -1.0)];
    let square = others.map(|corner| tip + corner).into_iter().chain([tip]).collect();
    // The bisecting line through the end point (0.6, 0.8), perpendicular to the direction of the wall, leaves the box
    // at (1/3, 1) and (1, 1/2).
    let end = Boundary::Segment { from: DVec2::new(0.6, 0.8), to: DVec2::new(6.0, 8.0) };
    for (wall, expected) in
        [(Boundary::ConvexPolygon { points: square }, 3.0), (end, 4.0 - 0.5 * (2.0 / 3.0) * 0.5)]
    {
        let moment = among(discs(vec![disc(DVec2::ZERO, 1.0)]), vec![wall], Vec::new());
        assert_close(GrainMeasures::of_each(&moment)[0].cell_area, expected, EXACT, "cut");
    }
}
