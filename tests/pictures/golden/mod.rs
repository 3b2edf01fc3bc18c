//! Pictures that must not change: what is made of stored states against the files in `screenshots/`.
//!
//! A picture may differ by 3/255 anywhere: the files were drawn on a GPU. A mismatch leaves
//! `target/golden/NAME.actual.png` and `.difference.png` (twenty times amplified). After a change that is meant, look
//! at those and renew the files with
//!
//! ```text
//! SLUMP_BLESS=1 cargo test --release --test pictures
//! ```

mod compare;
mod pictures;
mod states;

use std::path::{Path, PathBuf};

use compare::{Difference, Tolerance, difference_image};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, RgbaImage};
use pictures::{GOLDENS, Golden};

const TOLERANCE: Tolerance = Tolerance { channel: 3, pixels: 1.0 };

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn golden_path(name: &str) -> PathBuf {
    root().join("screenshots").join(format!("{name}.png"))
}

/// Writes a PNG file as small as the format allows: it stays in the history for ever.
fn save_small(picture: &RgbaImage, path: &Path) {
    let file = std::fs::File::create(path).unwrap();
    let encoder = PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::NoFilter);
    let opaque = DynamicImage::ImageRgba8(picture.clone()).to_rgb8();
    opaque.write_with_encoder(encoder).unwrap();
}

/// The complaint about one picture, if there is one.
fn compare(golden: &Golden) -> Option<String> {
    let (name, draw) = golden;
    let actual = match draw() {
        Ok(actual) => actual,
        Err(error) => return Some(format!("{name}: {error}")),
    };
    let expected: RgbaImage = match image::open(golden_path(name)) {
        Ok(expected) => expected.to_rgba8(),
        Err(error) => return Some(format!("{name}: {error}; SLUMP_BLESS=1 makes the file")),
    };
    let difference = Difference::between(&actual, &expected);
    println!("{name}: {difference}");
    if difference.within(TOLERANCE) {
        return None;
    }
    let folder = root().join("target/golden");
    std::fs::create_dir_all(&folder).unwrap();
    actual.save(folder.join(format!("{name}.actual.png"))).unwrap();
    difference_image(&actual, &expected)
        .save(folder.join(format!("{name}.difference.png")))
        .unwrap();
    Some(format!("{name}: {difference}; see {}", folder.display()))
}

#[test]
fn pictures_are_those_in_screenshots() {
    if std::env::var_os("SLUMP_BLESS").is_some() {
        for (name, draw) in GOLDENS {
            let picture = draw().unwrap();
            let (width, height) = picture.dimensions();
            assert!(width <= 800 && height <= 500, "{name} is {width}x{height}, too large to keep");
            save_small(&picture, &golden_path(name));
        }
    }
    let complaints: Vec<_> = GOLDENS.iter().filter_map(compare).collect();
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}
