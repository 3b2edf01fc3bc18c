//! The pictures that are kept in `screenshots/`, each as a function of a renderer.

use image::RgbaImage;
use slump::error::Result;
use slump::render::{ColourBy, PanelGrid, Renderer, Style, Theme, bounds, draw_scene};
use slump::sim::Snapshot;

use crate::golden::states;

/// Name of the file without its ending, and what draws it.
pub type Golden = (&'static str, fn(&mut Renderer) -> Result<RgbaImage>);

/// All golden pictures.
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
    grid.draw()
}
