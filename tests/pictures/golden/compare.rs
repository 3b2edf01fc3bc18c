//! Computes the difference of two pictures, as numbers and as a picture.

use std::path::{Path, PathBuf};

pub use image::codecs::png::FilterType;
use image::codecs::png::{CompressionType, PngEncoder};
use image::{DynamicImage, Rgba, RgbaImage};

/// Largest allowed difference of a picture from its golden picture (the stored picture with which it is compared).
#[derive(Clone, Copy)]
pub struct Tolerance {
    /// Largest difference in any colour channel of any pixel, from 0 to 255.
    pub channel: u8,
    /// Largest fraction of pixels that may differ from the golden (stored) picture, 0 to 1.
    pub pixels: f64,
}

struct Difference {
    channel: u8,
    pixels: f64,
    sizes: [(u32, u32); 2],
}

impl Difference {
    fn between(actual: &RgbaImage, golden: &RgbaImage) -> Self {
        let mut channel = 0;
        let mut differing = 0;
        for (a, b) in actual.pixels().zip(golden.pixels()) {
            let largest = a.0.iter().zip(b.0).map(|(a, b)| a.abs_diff(b)).max().unwrap_or(0);
            channel = channel.max(largest);
            differing += u64::from(largest > 0);
        }
        let all = u64::from(golden.width()) * u64::from(golden.height());
        let sizes = [actual.dimensions(), golden.dimensions()];
        Self { channel, pixels: differing as f64 / all.max(1) as f64, sizes }
    }

    fn within(&self, tolerance: Tolerance) -> bool {
        let Self { channel, pixels, sizes: [actual, golden] } = *self;
        actual == golden && channel <= tolerance.channel && pixels <= tolerance.pixels
    }
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [actual, golden] = self.sizes;
        if actual != golden {
            return write!(f, "size {actual:?} instead of {golden:?}");
        }
        write!(f, "largest difference {}/255, {:.2} % of pixels", self.channel, 100.0 * self.pixels)
    }
}

/// Returns a picture of the absolute differences between two pictures, amplified twenty times, on black.
fn difference_image(actual: &RgbaImage, golden: &RgbaImage) -> RgbaImage {
    let width = actual.width().max(golden.width());
    let height = actual.height().max(golden.height());
    RgbaImage::from_fn(width, height, |x, y| {
        match (actual.get_pixel_checked(x, y), golden.get_pixel_checked(x, y)) {
            (Some(a), Some(b)) => {
                let channel = |k: usize| a.0[k].abs_diff(b.0[k]).saturating_mul(20);
                Rgba([channel(0), channel(1), channel(2), 255])
            }
            _ => Rgba([255, 0, 255, 255]),
        }
    })
}

/// Returns the path of the golden picture (stored for comparison) with this name.
pub fn golden_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pictures/golden").join(format!("{name}.png"))
}

/// Writes a PNG file that is as small as possible, because the Git history keeps all its versions.
pub fn save_small(picture: &RgbaImage, name: &str, filter: FilterType) {
    let file = std::fs::File::create(golden_path(name)).unwrap();
    let encoder = PngEncoder::new_with_quality(file, CompressionType::Best, filter);
    let opaque = DynamicImage::ImageRgba8(picture.clone()).to_rgb8();
    opaque.write_with_encoder(encoder).unwrap();
}

/// Compares a picture with the golden picture (stored for comparison). `kind` is the kind of the renderer that has
/// drawn the picture. If the difference is too large, returns a message and writes the picture and the difference to
/// files.
pub fn complaint(
    actual: &RgbaImage,
    name: &str,
    kind: &str,
    tolerance: Tolerance,
) -> Option<String> {
    let golden = match image::open(golden_path(name)) {
        Ok(golden) => golden.to_rgba8(),
        Err(error) => return Some(format!("{name}: {error}; SLUMP_BLESS=1 makes the file")),
    };
    let difference = Difference::between(actual, &golden);
    println!("{name} on {kind}: {difference}");
    if difference.within(tolerance) {
        return None;
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/golden");
    std::fs::create_dir_all(&folder).unwrap();
    actual.save(folder.join(format!("{name}.{kind}.actual.png"))).unwrap();
    let where_it_differs = difference_image(actual, &golden);
    where_it_differs.save(folder.join(format!("{name}.{kind}.difference.png"))).unwrap();
    Some(format!("{name} on {kind}: {difference}; see {}", folder.display()))
}
