//! Tests that snapshots are drawn as the right discs, lines and texts.

use std::sync::Arc;

use glam::DVec2;

use super::colour::map_colour;
use super::colour_scale::ColourScale;
use super::scene::scene_picture;
use super::*;
use crate::sim::{ContactView, GrainView, Observables, Snapshot, Surroundings};
use crate::world::{Boundary, Disc, Periodic};

/// Returns a snapshot of four grains in a row with three contacts. The first grain is at the position `at`, m.
fn row_of_grains(at: DVec2) -> Snapshot {
    let grain = |k: u32| GrainView {
        position: at + DVec2::new(f64::from(k), 0.25),
        radius: 0.5,
        angle: 0.7 * f64::from(k),
        velocity: DVec2::new(0.1 * f64::from(k), 0.0),
        angular_velocity: 0.0,
        overlap: 0.001 * f64::from(k),
        force: 3.0 * f64::from(k),
        coordination: k,
        tone: 205,
        material: 0,
    };
    let grains: Vec<_> = (0..4).map(grain).collect();
    let contact = |k: usize, normal_force| ContactView {
        grain: k as u32,
        other_grain: Some(k as u32 + 1),
        from: grains[k].position,
        to: grains[k + 1].position,
        normal_force,
        tangential_force: 0.0,
        gap: 0.0,
    };
    let contacts = vec![contact(0, 2.0), contact(1, -1.0), contact(2, 0.0)];
    Snapshot {
        observables: Observables::default(),
        grains,
        contacts,
        surroundings: Arc::new(Surroundings {
            fixed_discs: vec![Disc { position: at - DVec2::Y, radius: 0.5 }],
            boundaries: vec![Boundary::HalfSpace { point: at - 1.5 * DVec2::Y, normal: DVec2::Y }],
            centre_of_attraction: Some(at),
            periodic: None,
            materials: Vec::new(),
            mean_diameter: 1.0,
            gravity_magnitude: 9.8,
            moving: Vec::new(),
        }),
    }
}

fn drawn(snapshot: &Snapshot, style: &Style) -> image::RgbaImage {
    let mut renderer = Renderer::new(RendererChoice::Cpu).unwrap();
    let [min, max] = bounds(snapshot).unwrap();
    let camera = style.camera(min, max, 300, 200);
    draw_scene(&mut renderer, snapshot, style, &camera, 300, 200).unwrap()
}

fn links(picture: &Picture) -> Vec<LinkInstance> {
    let batches = picture.batches.iter();
    batches
        .flat_map(|batch| if let Batch::Links(links) = batch { links.clone() } else { Vec::new() })
        .collect()
}

#[test]
fn a_million_diameters_from_the_origin_nothing_changes() {
    let style = Style { show_forces: true, angles: true, ..Style::default() };
    let near = drawn(&row_of_grains(DVec2::ZERO), &style);
    let far = drawn(&row_of_grains(DVec2::new(1e6, -1e6)), &style);
    let furthest = near.as_raw().iter().zip(far.as_raw()).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(furthest <= Some(1), "{furthest:?}");
    assert!(near.pixels().any(|pixel| pixel.0[0] < 100), "there is something to compare");
}

#[test]
fn an_empty_snapshot_is_an_empty_picture() {
    let mut snapshot = row_of_grains(DVec2::ZERO);
    (snapshot.grains, snapshot.contacts) = (Vec::new(), Vec::new());
    let surroundings = Arc::make_mut(&mut snapshot.surroundings);
    (surroundings.fixed_discs, surroundings.boundaries) = (Vec::new(), Vec::new());
    surroundings.centre_of_attraction = None;
    assert_eq!(bounds(&snapshot), None);
    let style = Style { show_forces: true, scale_bar: false, ..Style::default() };
    let camera = Camera { centre: DVec2::ZERO, metres_per_pixel: 0.01 };
    let picture = scene_picture(&snapshot, &style, &camera, 300, 200);
    assert_eq!(picture, Picture::new(Colour::WHITE));
}

#[test]
fn forces_are_as_wide_as_they_are_large_and_tell_push_from_pull() {
    let snapshot = row_of_grains(DVec2::ZERO);
    let style = Style { show_forces: true, scale_bar: false, ..Style::default() };
    assert_eq!(force_reference(&style, &snapshot), 2.0);
    let camera = Camera { centre: DVec2::ZERO, metres_per_pixel: 0.02 };
    let palette = style.theme.palette();
    let widths = |style: &Style| {
        let links = links(&scene_picture(&snapshot, style, &camera, 400, 300));
        let width = |colour| links.iter().find(|l| l.colour == colour).map(|l| l.half_width);
        (width(palette.push).unwrap(), width(palette.pull).unwrap())
    };
    let (push, pull) = widths(&style);
    assert_eq!(push, 2.0 * pull);
    let (weak_push, weak_pull) = widths(&Style { force_reference: Some(20.0), ..style });
    assert!((push / weak_push - 10.0).abs() < 1e-4 && (pull / weak_pull - 10.0).abs() < 1e-4);
}

#[test]
fn what_lies_outside_the_picture_is_not_drawn() {
    let mut snapshot = row_of_grains(DVec2::ZERO);
    snapshot.grains[0].position = DVec2::new(f64::NAN, 0.0);
    snapshot.grains[1].position = DVec2::new(1e9, 0.0);
    let camera = Camera { centre: DVec2::ZERO, metres_per_pixel: 0.02 };
    let picture = scene_picture(&snapshot, &Style::default(), &camera, 400, 300);
    let discs = picture.batches.iter().map(|batch| match batch {
        Batch::Discs(discs) => discs.len(),
        Batch::Links(_) => 0,
    });
    assert_eq!(discs.sum::<usize>(), 4, "two grains, a fixed disc and the centre of attraction");
}

#[test]
fn a_given_range_holds_over_the_snapshots_own() {
    let snapshot = row_of_grains(DVec2::ZERO);
    let own = Style { colour_by: ColourBy::Speed, ..Style::default() };
    let automatic = ColourScale::new(&own, &snapshot);
    assert!(automatic.low == 0.0 && (automatic.high - 0.3).abs() < 1e-12);
    let given = Style { range: Some((0.1, 2.0)), ..own };
    let scale = ColourScale::new(&given, &snapshot);
    assert_eq!((scale.low, scale.high), (0.1, 2.0));
    assert_eq!(scale.colour(&snapshot.grains[0], 1.0), map_colour(0.0));
}

#[test]
fn a_legend_changes_no_pixel_of_the_scene() {
    let snapshot = row_of_grains(DVec2::ZERO);
    let style = Style { colour_by: ColourBy::Overlap, ..Style::default() };
    let strip = style.legend_width(600, 400);
    assert!(strip > 0);
    let camera = style.camera(DVec2::new(-0.5, -2.0), DVec2::new(3.5, 1.0), 600, 400);
    let mut renderer = Renderer::new(RendererChoice::Cpu).unwrap();
    let whole = draw_scene(&mut renderer, &snapshot, &style, &camera, 600, 400).unwrap();
    let bare = Style { legend: false, ..style };
    let scene = draw_scene(&mut renderer, &snapshot, &bare, &camera, 600 - strip, 400).unwrap();
    assert!(scene.enumerate_pixels().all(|(x, y, pixel)| whole.get_pixel(x, y) == pixel));
}

#[test]
fn what_straddles_a_periodic_border_is_drawn_on_both_sides() {
    let mut snapshot = row_of_grains(DVec2::ZERO);
    let style = Style { show_forces: true, scale_bar: false, ..Style::default() };
    let camera = Camera { centre: DVec2::new(1.5, 0.0), metres_per_pixel: 0.02 };
    let drawn = |snapshot: &Snapshot| {
        let picture = scene_picture(snapshot, &style, &camera, 400, 300);
        let discs = picture.batches.iter().map(|batch| match batch {
            Batch::Discs(discs) => discs.len(),
            Batch::Links(_) => 0,
        });
        let forces = [style.theme.palette().push, style.theme.palette().pull];
        let chains = links(&picture).iter().filter(|link| forces.contains(&link.colour)).count();
        (discs.sum::<usize>(), chains)
    };
    let alone = drawn(&snapshot);
    // The grains are at x = 0, 1, 2 and 3 m, and links connect the first three.
    Arc::make_mut(&mut snapshot.surroundings).periodic = Some(Periodic::along_x([0.8, 4.2]));
    let (discs, chains) = drawn(&snapshot);
    // Periodic images appear beyond the left border: the first two grains, the fixed disc and the first link.
    assert_eq!((discs, chains), (alone.0 + 3, alone.1 + 1));
    let borders = scene_picture(&snapshot, &style, &camera, 400, 300);
    let upright = |link: &&LinkInstance| link.start[0] == link.end[0];
    let columns: Vec<f32> =
        links(&borders).iter().filter(upright).map(|dash| dash.start[0]).collect();
    for x in [0.8, 4.2] {
        let column = ((x - 1.5) / 0.02) as f32;
        assert!(columns.iter().filter(|at| (**at - column).abs() < 0.01).count() > 5, "{x}");
    }
}

#[test]
fn a_picture_of_one_world_carries_its_title() {
    let mut renderer = Renderer::new(RendererChoice::Cpu).unwrap();
    let (snapshot, style) = (row_of_grains(DVec2::ZERO), Style::default());
    let [min, max] = bounds(&snapshot).unwrap();
    let camera = style.camera(min, max, 300, 200);
    let world = WorldPanel { snapshot: &snapshot, title: "Bond 20", note: "" };
    let titled = draw_worlds(&mut renderer, &[world], &style, &camera, 1, [300, 200]).unwrap();
    let plain = drawn(&snapshot, &style);
    let changed =
        titled.enumerate_pixels().filter(|(x, y, pixel)| *pixel != plain.get_pixel(*x, *y));
    let places: Vec<_> = changed.map(|(x, y, _)| (x, y)).collect();
    assert!(places.len() > 20 && places.iter().all(|&(x, y)| x < 150 && y < 50), "{places:?}");
}
