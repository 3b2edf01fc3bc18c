//! Tests of the figures that `slump reproduce` and `slump validate` compute from many simulations: every call gives the
//! same numbers and pictures, and charts look like the stored charts.
//!
//! After an intended change of the charts, look at the new chart and store it: `SLUMP_BLESS=1 cargo test --release
//! --test pictures`.

use slump::study::chart::{Axis, Chart, Layer, Look, MapCell, PALETTE, Point, Sheet, png, svg};

use crate::program::*;

/// Names of the figures of Abramian & Staron (2020), and of related figures, that take at most a few seconds to
/// compute.
const FAST: [&str; 5] = ["fig2", "two-body", "fig8", "cradle-choices", "cradle-map"];
/// Largest fraction of pixels of a chart that may differ from the stored chart, because processors round differently.
const MOST_DIFFERENT: f64 = 0.002;

fn reproduce(folder: &Path) {
    succeed(slump("reproduce --quick --out").arg(folder).args(FAST));
}

#[test]
fn figures_are_the_same_bit_for_bit_from_every_run() {
    let folders = [folder(), folder()];
    for folder in &folders {
        reproduce(folder.path());
    }
    for figure in FAST {
        for ending in ["csv", "png", "svg"] {
            let read = |folder: &TempDir| bytes(folder.path().join(format!("{figure}.{ending}")));
            let (one, other) = (read(&folders[0]), read(&folders[1]));
            assert!(!one.is_empty() && one == other, "{figure}.{ending} differs");
        }
    }
    let report = read(folders[0].path().join("report.md"));
    assert!(report.contains("Quick pass"), "{report}");
    for figure in FAST {
        assert!(report.contains(&format!("## {figure}\n")), "{figure} in {report}");
    }
    assert!(!report.contains("NaN"), "{report}");
    // The report states for each claim of the paper how often its test would be positive by chance, and on which
    // choices it depends.
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

/// Returns a sheet of the charts whose points are in the file `chart.csv`: curves in each style, and a map.
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
    // Written charts are equal to the text from which they were read.
    let written = String::from_utf8(sheet.to_csv().expect("CSV")).expect("UTF-8");
    assert_eq!(written, read(stored("chart.csv")));
    let bytes = png(&sheet, "slump reproduce").expect("a picture");
    let golden = stored("chart.png");
    if std::env::var_os("SLUMP_BLESS").is_some() {
        write(&golden, &bytes);
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

fn elasticity(folder: &Path) -> String {
    succeed(slump("validate elasticity --quick --out").arg(folder))
}

/// Returns all rows of the table `quantities.csv` that `slump validate` writes, without the columns that depend on the
/// speed of the machine.
fn rows(folder: &Path) -> Vec<Vec<String>> {
    let mut reader = csv::Reader::from_path(folder.join("quantities.csv")).expect("a table");
    let names = reader.headers().expect("names").clone();
    let is_of_clock = |name: &str| ["simulated_secs_per_sec", "wall_secs"].contains(&name);
    let row = |record: csv::StringRecord| {
        let cells = names.iter().zip(record.iter()).filter(|(name, _)| !is_of_clock(name));
        cells.map(|(_, cell)| cell.to_owned()).collect()
    };
    reader.records().map(|record| row(record.expect("a row"))).collect()
}

fn journal(folder: &Path) -> PathBuf {
    let measured = folder.join("measured");
    let of_program = std::fs::read_dir(measured).expect("a folder").next().expect("a program");
    of_program.expect("a folder").path().join("quick").join("validation.jsonl")
}

#[test]
fn a_validation_goes_on_where_it_was_stopped_and_comes_out_the_same() {
    let whole = folder();
    elasticity(whole.path());
    for name in ["quantities.csv", "errors.csv", "errors.png", "errors.svg"] {
        assert!(whole.path().join(name).metadata().expect(name).len() > 40, "{name}");
    }
    check_report(whole.path());
    let rows_of_whole = rows(whole.path());
    // Half of the runs are removed from the journal, and the next line is cut, as after a kill.
    let path = journal(whole.path());
    let text = read(&path);
    let lines: Vec<&str> = text.lines().collect();
    let half = lines.len() / 2;
    let cut = format!("{}\n{}", lines[..half].join("\n"), &lines[half][..40]);
    write(&path, cut);
    let said = elasticity(whole.path());
    assert!(said.contains(&format!("validation: {half} measurements were there")), "{said}");
    assert_eq!(rows(whole.path()), rows_of_whole);
    assert_eq!(read(&path).lines().count(), lines.len());
    // Complete results are not computed again: even the measured times do not change.
    let read = |name: &str| std::fs::read(whole.path().join(name)).expect(name);
    let before = read("quantities.csv");
    elasticity(whole.path());
    assert_eq!(read("quantities.csv"), before);
}

/// Checks the report of `slump validate elasticity`: the apparent elasticity of a row of rigid discs, which is an
/// effect of steps that are not solved accurately, equals the published elasticity, and the report names the source of
/// each number.
fn check_report(folder: &Path) {
    let rows = rows(folder);
    let of = |name: &str| {
        let found = rows.iter().find(|row| row[2].starts_with(name)).expect(name);
        [6, 9].map(|column| found[column].parse::<f64>().expect("a number"))
    };
    for name in ["q of jacobi", "q of nsgs interleaved", "q of nsgs bottom-up"] {
        let [published, measured] = of(name);
        assert!((measured / published - 1.0).abs() < 5e-3, "{name}: {measured} for {published}");
    }
    let report = read(folder.join("report.md"));
    assert!(report.contains("Quick pass") && report.contains("read: Unger et al. 2002"));
    assert!(report.contains("derived: D. M. Young") && report.contains("**agrees**"), "{report}");
    assert!(!report.contains("NaN"), "{report}");
}

#[test]
fn what_is_no_experiment_method_or_number_is_refused_by_name() {
    let folder = folder();
    let cases: [(&[&str], &str); 8] = [
        (&["hourglass"], "elasticity"),
        (&["--methods", "gauss"], "nsgs"),
        (&["--stepper", "euler"], "range"),
        (&["--stepper", "dem", "--sweeps", "5"], "sweeps is given, but must be left out under dem"),
        (&["--time-steps", "1e-3,-1"], "time-steps is -1"),
        (&["--sweeps", "0"], "sweeps is 0"),
        (&["--sweeps", "5,5"], "sweeps is 5 twice"),
        (&["--tolerances", "nan"], "tolerances is NaN"),
    ];
    for (options, part) in cases {
        let said = sentence(slump("validate").args(options).arg("--out").arg(folder.path()));
        assert!(said.contains(part), "{options:?}: {said}");
        assert!(!folder.path().join("measured").exists(), "{options:?} began to work");
    }
}
