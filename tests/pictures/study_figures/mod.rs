//! Figures: the same numbers and pictures from every run, and charts that look as they did.
//!
//! After a wanted change of how charts look, look at the new one and bless it:
//! `SLUMP_BLESS=1 cargo test --release --test pictures`.

mod validation;

use std::path::{Path, PathBuf};
use std::process::Command;

use slump::study::chart::{Axis, Chart, Layer, Look, MapCell, PALETTE, Point, Sheet, png, svg};

/// Figures that take no more than a few seconds.
const FAST: [&str; 5] = ["fig2", "two-body", "fig8", "cradle-choices", "cradle-map"];
/// Share of pixels that may differ between two processors' roundings.
const MOST_DIFFERENT: f64 = 0.002;

fn reproduce(folder: &Path) {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slump"));
    command.arg("reproduce").args(FAST).arg("--quick").arg("--out").arg(folder);
    let output = command.output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn figures_are_the_same_bit_for_bit_from_every_run() {
    let folders = [tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder")];
    for folder in &folders {
        reproduce(folder.path());
    }
    for figure in FAST {
        for ending in ["csv", "png", "svg"] {
            let read = |folder: &tempfile::TempDir| {
                std::fs::read(folder.path().join(format!("{figure}.{ending}"))).expect("a file")
            };
            let (one, other) = (read(&folders[0]), read(&folders[1]));
            assert!(!one.is_empty() && one == other, "{figure}.{ending} differs");
        }
    }
    let report = std::fs::read_to_string(folders[0].path().join("report.md")).expect("a report");
    assert!(report.contains("Quick pass"), "{report}");
    for figure in FAST {
        assert!(report.contains(&format!("## {figure}\n")), "{figure} in {report}");
    }
    assert!(!report.contains("NaN"), "{report}");
    // The paper's claims, each with how often its test would say so by chance and with what it hangs on.
    for claim in report.split("\n* ").skip(1).filter(|claim| claim.starts_with(['§', 'F'])) {
        assert!(claim.contains("\n  By chance: ") && claim.contains("\n  Hangs on: "), "{claim}");
    }
}

#[test]
fn an_unknown_figure_is_refused_with_the_names_of_all() {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slump"));
    let output =
        command.args(["reproduce", "fig99", "--out", "unused"]).output().expect("it starts");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(
        said.contains("fig99") && said.contains("fig5a") && said.lines().count() == 1,
        "{said}"
    );
}

fn stored(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pictures/study_figures").join(name)
}

/// A sheet of what `chart.csv` holds: curves of each look, and a map.
fn sheet() -> Sheet {
    let mut chart =
        Chart::new("Every look", Axis::log("Δt (s)", 1e-4, 1e-2), Axis::linear("δ/d", -0.2, 1.2));
    let mut map =
        Chart::new("A map", Axis::linear("Bond", 0.0, 3.0), Axis::log("Δt (s)", 1e-4, 1e-2));
    let mut cells = Vec::new();
    let mut curves: Vec<(String, Vec<Point>)> = Vec::new();
    let mut reader = csv::Reader::from_path(stored("chart.csv")).expect("the stored points");
    for record in reader.records() {
        let record = record.expect("a record");
        let number = |index: usize| record[index].parse::<f64>().ok();
        let (x, y) = (number(2).expect("x"), number(3).expect("y"));
        if let Some(value) = number(6) {
            let edges = if y < 1e-3 { [1e-4, 1e-3] } else { [1e-3, 1e-2] };
            cells.push(MapCell { x: (x, [x - 0.5, x + 0.5]), y: (y, edges), value });
            continue;
        }
        let point = Point { x, y, interval: number(4).zip(number(5)) };
        match curves.last_mut().filter(|(name, _)| *name == record[1]) {
            Some((_, points)) => points.push(point),
            None => curves.push((record[1].to_owned(), vec![point])),
        }
    }
    let looks = [Look::LineAndDots, Look::Dashes(3), Look::Rings(7)];
    for (index, ((name, points), look)) in curves.into_iter().zip(looks).enumerate() {
        chart.layers.push(Layer::curve(name, points, PALETTE[index + 1], look).beside(index, 3));
    }
    let colour = |value: f64| if value > 0.5 { (240, 176, 80) } else { (70, 120, 175) };
    map.layers.push(Layer::Cells { name: "map".into(), cells, colour });
    let at = (1.1, 1e-3);
    map.layers.push(Layer::Words { at, text: "words".into(), colour: (255, 255, 255) });
    Sheet {
        size: (900, 420),
        charts: vec![chart, map],
        caption: vec!["From stored points.".into()],
    }
}

#[test]
fn a_chart_of_stored_points_looks_as_it_did() {
    let sheet = sheet();
    // What a sheet writes is what it was read from.
    let written = String::from_utf8(sheet.to_csv().expect("CSV")).expect("UTF-8");
    let read = std::fs::read_to_string(stored("chart.csv")).expect("the stored points");
    assert_eq!(written, read);
    let bytes = png(&sheet, "slump reproduce").expect("a picture");
    let golden = stored("chart.png");
    if std::env::var_os("SLUMP_BLESS").is_some() {
        std::fs::write(&golden, &bytes).expect("the golden picture");
    }
    let now = image::load_from_memory(&bytes).expect("a PNG").to_rgb8();
    let then = image::open(&golden).expect("the golden picture").to_rgb8();
    assert_eq!(now.dimensions(), then.dimensions());
    let differ = now
        .pixels()
        .zip(then.pixels())
        .filter(|(a, b)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 24));
    let share = differ.count() as f64 / f64::from(now.width() * now.height());
    assert!(share <= MOST_DIFFERENT, "{:.2} % of the pixels differ", 100.0 * share);
    let svg = svg(&sheet).expect("a picture");
    assert!(svg.starts_with("<svg") && svg.contains("Every look") && svg.contains("polyline"));
}
