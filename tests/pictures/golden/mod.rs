//! Golden pictures: drawings of stored states by every renderer are compared with the picture files in this folder.
//!
//! On a GPU, each colour channel of a pixel may differ by 2 of 255, and 1 % of the pixels may differ at all. On the
//! processor, the channels may differ by 3 of 255 in all pixels. If the difference is larger, the test writes the files
//! `target/golden/NAME.BACKEND.actual.png` and `.difference.png` (amplified twenty times). After an intended change,
//! look at these files and write the golden pictures again with
//!
//! ```text
//! SLUMP_BLESS=1 cargo test --release --test pictures -- --ignored with_driver
//! ```
//!
//! This command draws the pictures with Vulkan or else with OpenGL, never on the processor. The tests in `with_driver`
//! need Vulkan or OpenGL.

mod compare;
mod states;

use compare::{FilterType, Tolerance, complaint, save_small};
use image::RgbaImage;
use slump::error::Result;
use slump::render::{
    ColourBy, PanelGrid, Renderer, RendererChoice, Style, Theme, bounds, draw_scene,
};
use slump::sim::Snapshot;
use slump::world::Material;

const GPU: Tolerance = Tolerance { channel: 2, pixels: 0.01 };
const CPU: Tolerance = Tolerance { channel: 3, pixels: 1.0 };

#[test]
fn the_processor_draws_the_pictures_that_are_kept() {
    let mut cpu = Renderer::new(RendererChoice::Cpu).unwrap();
    assert_kept(&mut [("cpu", &mut cpu)], CPU);
}

#[test]
fn grains_of_a_material_share_a_colour_that_the_legend_shows() {
    let mut cpu = Renderer::new(RendererChoice::Cpu).unwrap();
    let style = Style { colour_by: ColourBy::Material, ..Style::default() };
    let mut snapshot = states::pile();
    let names = ["glass", "steel"].map(str::to_owned);
    std::sync::Arc::make_mut(&mut snapshot.surroundings).materials =
        names.map(|name| Material { name, ..Material::default() }).to_vec();
    let mut counts = |snapshot: &Snapshot| {
        let picture = scene(&mut cpu, snapshot, &style, 640, 400).unwrap();
        // The colours orange and sky blue, counted in the scene and in the strip of the legend.
        [[230, 159, 0, 255], [86, 180, 233, 255]].map(|colour| {
            [0..500, 530..640].map(|columns| {
                let is_there = |&(x, _, pixel): &(u32, u32, &image::Rgba<u8>)| {
                    columns.contains(&x) && pixel.0 == colour
                };
                picture.enumerate_pixels().filter(is_there).count()
            })
        })
    };
    let [[grains, swatch], [none, other_swatch]] = counts(&snapshot);
    assert!(grains > 10_000 && none == 0, "{grains}, {none}");
    assert!(swatch > 100 && swatch == other_swatch, "{swatch}, {other_swatch}");
    snapshot.grains.iter_mut().step_by(2).for_each(|grain| grain.material = 1);
    let [[one, _], [other, _]] = counts(&snapshot);
    assert!(one.abs_diff(other) < grains / 10 && one + other > grains * 9 / 10, "{one}, {other}");
}

/// Draws each golden picture (a picture that is also stored in a file) with each of the renderers and compares it with
/// its file. `renderers` also contains the kind of each renderer, such as "vulkan".
fn assert_kept(renderers: &mut [(&'static str, &mut Renderer)], tolerance: Tolerance) {
    let mut complaints = Vec::new();
    for (name, draw) in &GOLDENS {
        for (kind, renderer) in &mut *renderers {
            let drawn = draw(renderer).map_err(|error| format!("{name} on {kind}: {error}"));
            complaints.extend(
                drawn.map_or_else(Some, |actual| complaint(&actual, name, kind, tolerance)),
            );
        }
    }
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}

mod with_driver {
    use super::*;

    /// Returns a renderer for each graphics driver of this machine, with its kind ("vulkan" or "gl").
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

    #[test]
    #[ignore = "needs a graphics driver"]
    fn gpus_draw_the_pictures_that_are_kept() {
        let mut renderers = gpus();
        if std::env::var_os("SLUMP_BLESS").is_some() {
            let (_, renderer) = &mut renderers[0];
            for (name, draw) in GOLDENS {
                let picture = draw(renderer).unwrap();
                let (width, height) = picture.dimensions();
                assert!(
                    width <= 800 && height <= 500,
                    "{name} is {width}x{height}, too large to keep"
                );
                save_small(&picture, name, FilterType::NoFilter);
                println!("{name} drawn on {}", renderer.name());
            }
        }
        let mut renderers: Vec<_> = renderers.iter_mut().map(|(kind, it)| (*kind, it)).collect();
        assert_kept(&mut renderers, GPU);
    }
}

/// Name of the picture file without its ending, and the function that draws the picture.
pub type Golden = (&'static str, fn(&mut Renderer) -> Result<RgbaImage>);

pub const GOLDENS: [Golden; 5] = [
    ("pile-greys", |renderer| scene(renderer, &states::pile(), &Style::default(), 640, 400)),
    ("pile-forces", |renderer| {
        let style = Style { show_forces: true, ..Style::default() };
        scene(renderer, &states::pile(), &style, 640, 400)
    }),
    ("pile-speed", |renderer| {
        let style = Style { colour_by: ColourBy::Speed, ..Style::default() };
        scene(renderer, &states::pile(), &style, 640, 400)
    }),
    ("cradle", |renderer| {
        let style = Style { angles: true, ..Style::default() };
        scene(renderer, &states::cradle(), &style, 640, 320)
    }),
    ("figure", figure),
];

fn scene(
    renderer: &mut Renderer,
    snapshot: &Snapshot,
    style: &Style,
    width: u32,
    height: u32,
) -> Result<RgbaImage> {
    let [min, max] = bounds(snapshot).expect("the hand-made states are not empty");
    let camera = style.camera(min, max, width, height);
    draw_scene(renderer, snapshot, style, &camera, width, height)
}

fn figure(renderer: &mut Renderer) -> Result<RgbaImage> {
    let light = Style { scale_bar: false, ..Style::default() };
    let dark = Style { theme: Theme::Dark, ..light.clone() };
    let styles = [
        Style { colour_by: ColourBy::Overlap, ..light.clone() },
        Style { colour_by: ColourBy::Coordination, ..light },
        Style { colour_by: ColourBy::Force, ..dark.clone() },
        Style { colour_by: ColourBy::Coordination, show_forces: true, ..dark },
    ];
    let pile = states::pile();
    let panels = styles
        .iter()
        .map(|style| scene(renderer, &pile, style, 330, 190))
        .collect::<Result<Vec<_>>>()?;
    let mut grid = PanelGrid::new(2, 2, panels);
    grid.title = "Panels, labels and themes".to_owned();
    grid.column_labels = vec!["Δt = 10⁻⁴ s".to_owned(), "Δt = 5·10⁻³ s".to_owned()];
    grid.row_labels = vec!["Bond 0".to_owned(), "Bond −20 ≤ √μ".to_owned()];
    grid.caption =
        "A caption goes on below the panels and, where it is longer than they are wide, \
                    breaks into lines: Δ ρ μ · − × √ ≤ v_{n} = −Δt·C₀/m_{ij}, 10^{−3}."
            .to_owned();
    Ok(grid.draw())
}
