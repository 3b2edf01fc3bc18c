//! Pictures that must not change: what every renderer makes of stored states against the files in
//! `screenshots/`.
//!
//! A GPU may differ by 2/255 in any channel and in 1 % of the pixels at all, the processor by 3/255
//! anywhere. A mismatch leaves `target/golden/NAME.BACKEND.actual.png` and `.difference.png` (twenty
//! times amplified). After a change that is meant, look at those and renew the files with
//!
//! ```text
//! SLUMP_BLESS=1 cargo test --release --test pictures
//! ```
//!
//! which draws them on Vulkan, or else on OpenGL, never on the processor. Without any GPU driver the
//! test fails: nothing would be compared.

mod compare;
mod pictures;
mod states;

use std::path::{Path, PathBuf};

use compare::{Difference, Tolerance, difference_image};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, RgbaImage};
use pictures::{GOLDENS, Golden};
use slump::render::{Renderer, RendererChoice};

const GPU: Tolerance = Tolerance { channel: 2, pixels: 0.01 };
const CPU: Tolerance = Tolerance { channel: 3, pixels: 1.0 };

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn golden_path(name: &str) -> PathBuf {
    root().join("screenshots").join(format!("{name}.png"))
}

/// Every GPU of this machine, by the kind of its driver.
fn gpus() -> Vec<(&'static str, Renderer)> {
    let mut found = Vec::new();
    for (kind, choice) in [("vulkan", RendererChoice::Vulkan), ("gl", RendererChoice::Gl)] {
        match Renderer::new(choice) {
            Ok(renderer) => found.push((kind, renderer)),
            Err(error) => println!("not compared on {kind}: {error}"),
        }
    }
    assert!(
        !found.is_empty(),
        "no GPU driver was found, so no golden picture can be compared: install the Debian packages \
         mesa-vulkan-drivers and libvulkan1, or libegl1 and libgl1-mesa-dri"
    );
    found
}

/// Writes a PNG file as small as the format allows: it stays in the history for ever.
fn save_small(picture: &RgbaImage, path: &Path) {
    let file = std::fs::File::create(path).unwrap();
    let encoder = PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::NoFilter);
    let opaque = DynamicImage::ImageRgba8(picture.clone()).to_rgb8();
    opaque.write_with_encoder(encoder).unwrap();
}

/// The complaint about one picture on one renderer, if there is one.
fn compare(
    golden: &Golden,
    kind: &str,
    renderer: &mut Renderer,
    tolerance: Tolerance,
) -> Option<String> {
    let (name, draw) = golden;
    let actual = match draw(renderer) {
        Ok(actual) => actual,
        Err(error) => return Some(format!("{name} on {kind}: {error}")),
    };
    let expected: RgbaImage = match image::open(golden_path(name)) {
        Ok(expected) => expected.to_rgba8(),
        Err(error) => return Some(format!("{name}: {error}; SLUMP_BLESS=1 makes the file")),
    };
    let difference = Difference::between(&actual, &expected);
    println!("{name} on {kind}: {difference}");
    if difference.within(tolerance) {
        return None;
    }
    let folder = root().join("target/golden");
    std::fs::create_dir_all(&folder).unwrap();
    actual.save(folder.join(format!("{name}.{kind}.actual.png"))).unwrap();
    difference_image(&actual, &expected)
        .save(folder.join(format!("{name}.{kind}.difference.png")))
        .unwrap();
    Some(format!("{name} on {kind}: {difference}; see {}", folder.display()))
}

#[test]
fn pictures_are_those_in_screenshots() {
    let mut renderers = gpus();
    if std::env::var_os("SLUMP_BLESS").is_some() {
        let (_, renderer) = &mut renderers[0];
        for (name, draw) in GOLDENS {
            let picture = draw(renderer).unwrap();
            let (width, height) = picture.dimensions();
            assert!(width <= 800 && height <= 500, "{name} is {width}x{height}, too large to keep");
            save_small(&picture, &golden_path(name));
            println!("{name} drawn on {}", renderer.name());
        }
    }
    let mut complaints = Vec::new();
    for golden in &GOLDENS {
        for (kind, renderer) in &mut renderers {
            complaints.extend(compare(golden, kind, renderer, GPU));
        }
        let mut cpu = Renderer::new(RendererChoice::Cpu).unwrap();
        complaints.extend(compare(golden, "cpu", &mut cpu, CPU));
    }
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}
