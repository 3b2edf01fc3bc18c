//! What the panels look like at the start, before the first step: what is solved how changes nothing.

#[path = "../pictures/golden/compare.rs"]
mod compare;

use std::path::{Path, PathBuf};

use compare::{Difference, Tolerance, difference_image};
use image::RgbaImage;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use slump::app::{GrainRef, Preferences};
use slump::config::Config;

use crate::robot::Robot;

const TOLERANCE: Tolerance = Tolerance { channel: 2, pixels: 0.01 };

fn golden_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("screenshots").join(format!("{name}.png"))
}

/// Draws the window and compares it with its golden picture.
fn check(robot: &mut Robot, name: &str) {
    robot.harness.remove_cursor();
    for _ in 0..30 {
        robot.harness.step();
    }
    let mut actual = robot.harness.render().unwrap();
    // A window is opaque, whatever its pixels say.
    actual.pixels_mut().for_each(|pixel| pixel.0[3] = 255);
    let path = golden_path(name);
    if std::env::var_os("SLUMP_BLESS").is_some() {
        save_small(&actual, &path);
    }
    let golden = image::open(&path)
        .unwrap_or_else(|error| panic!("{name}: {error}; SLUMP_BLESS=1 makes the file"))
        .to_rgba8();
    let difference = Difference::between(&actual, &golden);
    println!("{name}: {difference}");
    if !difference.within(TOLERANCE) {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/golden");
        std::fs::create_dir_all(&folder).unwrap();
        actual.save(folder.join(format!("{name}.actual.png"))).unwrap();
        let where_it_differs = difference_image(&actual, &golden);
        where_it_differs.save(folder.join(format!("{name}.difference.png"))).unwrap();
        panic!("{name}: {difference}; see {}", folder.display());
    }
}

/// Writes a PNG file as small as the format allows: it stays in the history for ever.
fn save_small(picture: &RgbaImage, path: &Path) {
    let file = std::fs::File::create(path).unwrap();
    let encoder = PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::Adaptive);
    let opaque = image::DynamicImage::ImageRgba8(picture.clone()).to_rgb8();
    opaque.write_with_encoder(encoder).unwrap();
}

#[test]
fn the_first_thing_that_a_newcomer_sees() {
    check(&mut Robot::open_with_gpu(Config::default(), Preferences::default()), "window-first");
}

#[test]
fn worlds_side_by_side_in_the_dark() {
    let mut preferences =
        Preferences { theme: egui::ThemePreference::Dark, ..Preferences::default() };
    preferences.style.colour_by = slump::render::ColourBy::Coordination;
    let mut robot = Robot::open_with_gpu(Config::default(), preferences);
    for section in ["Physics", "Run", "Compare"] {
        robot.click(section);
    }
    robot.click("Paper Fig. 4");
    check(&mut robot, "window-compare");
}

#[test]
fn the_panels_of_a_physicist() {
    let preferences = Preferences { plots: false, ..Preferences::default() };
    let mut robot = Robot::open_with_gpu(Config::default(), preferences);
    for section in ["Physics", "Run", "See", "Solver"] {
        robot.click(section);
    }
    robot.state_mut().mouse.pinned = Some(GrainRef { world: 0, grain: 70 });
    check(&mut robot, "window-panels");
}
