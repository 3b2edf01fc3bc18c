//! The pictures that are kept in `screenshots/`, each as a function.

use image::RgbaImage;
use slump::error::Result;
use slump::render::{ColourBy, PanelGrid, Style, Theme, bounds, draw_scene};
use slump::sim::Snapshot;

use crate::golden::states;

/// Name of the file without its ending, and what draws it.
pub type Golden = (&'static str, fn() -> Result<RgbaImage>);

/// All golden pictures.
pub const GOLDENS: [Golden; 5] = [
    ("pile-greys", || scene(&states::pile(), &Style::default(), 640, 400)),
    ("pile-forces", || {
        let style = Style { show_forces: true, ..Style::default() };
        scene(&states::pile(), &style, 640, 400)
    }),
    ("pile-speed", || {
        let style = Style { colour_by: ColourBy::Speed, ..Style::default() };
        scene(&states::pile(), &style, 640, 400)
    }),
    ("cradle", || {
        let style = Style { angles: true, ..Style::default() };
        scene(&states::cradle(), &style, 640, 320)
    }),
    ("figure", figure),
];

fn scene(snapshot: &Snapshot, style: &Style, width: u32, height: u32) -> Result<RgbaImage> {
    let [min, max] = bounds(snapshot).expect("the hand-made states are not empty");
    let camera = style.camera(min, max, width, height);
    draw_scene(snapshot, style, &camera, width, height)
}

fn figure() -> Result<RgbaImage> {
    let light = Style { scale_bar: false, ..Style::default() };
    let dark = Style { theme: Theme::Dark, ..light.clone() };
    let styles = [
        Style { colour_by: ColourBy::Overlap, ..light.clone() },
        Style { colour_by: ColourBy::Coordination, ..light },
        Style { colour_by: ColourBy::Force, ..dark.clone() },
        Style { colour_by: ColourBy::Coordination, show_forces: true, ..dark },
    ];
    let pile = states::pile();
    let panels =
        styles.iter().map(|style| scene(&pile, style, 330, 190)).collect::<Result<Vec<_>>>()?;
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
