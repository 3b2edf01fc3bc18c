//! Tests of the file names, and of the facts (such as scene and settings) that the window writes into its files.

use crate::robot::*;
use std::collections::BTreeMap;

/// Opens a window that writes its files into a folder.
fn open(folder: &Path) -> Robot {
    let preferences = Preferences {
        folder: folder.to_owned(),
        picture_size: [640, 400],
        ..Preferences::default()
    };
    Robot::open_with_gpu(Config::of_scene("pile"), preferences)
}

/// Uses a key or button (the function `ask`) that lets the window write one file. Returns the path of the newest file
/// with this ending.
fn written(robot: &mut Robot, ask: impl Fn(&mut Robot), ending: &str) -> PathBuf {
    let folder = robot.state().preferences.folder.clone();
    ask(robot);
    robot.written();
    let files = names_in(&folder).into_iter();
    let mut files: Vec<_> = files.map(|name| folder.join(name)).collect();
    files.retain(|path| path.extension().is_some_and(|found| found == ending));
    files.sort_by_key(|path| std::fs::metadata(path).and_then(|about| about.modified()).ok());
    files.pop().expect("a file")
}

/// Returns the texts in a PNG file by their keywords, and width and height of the picture, pixels.
fn texts(path: &Path) -> (BTreeMap<String, String>, [u32; 2]) {
    let file = std::io::BufReader::new(std::fs::File::open(path).expect("a file"));
    let mut reader = png::Decoder::new(file).read_info().expect("a picture");
    reader.finish().expect("a whole picture");
    let info = reader.info();
    let plain = info.uncompressed_latin1_text.iter();
    let mut texts: BTreeMap<String, String> =
        plain.map(|chunk| (chunk.keyword.clone(), chunk.text.clone())).collect();
    for chunk in &info.utf8_text {
        texts.insert(chunk.keyword.clone(), chunk.get_text().expect("a text"));
    }
    (texts, [info.width, info.height])
}

fn name(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).expect("a name")
}

#[test]
#[ignore = "needs a graphics driver"]
fn a_picture_of_a_run_carries_the_command_that_makes_it() {
    let folder = folder();
    let mut robot = open(folder.path());
    let mut settings = robot.settings().with_bond(35.0);
    settings.parameters.time_step_secs = 2e-3;
    robot.state_mut().run.change(0, settings);
    robot.take_steps(5);
    let path = written(&mut robot, |robot| robot.key(egui::Key::S), "png");
    assert_eq!(name(&path), "slump-pile-bond35-dt2e-3-0.0100s.png");
    assert_eq!(robot.notice(), format!("Saved {}", path.display()), "the whole path");
    let (texts, size) = texts(&path);
    assert_eq!(size, [640, 400]);
    assert!(texts["Settings"].contains("--bond 35 --bond-acceleration 0 --dt 0.002"), "{texts:?}");
    assert_eq!((texts["Scene"].as_str(), texts["Time"].as_str()), ("pile", "0.01 s"));
    assert_eq!(texts.get("Changes"), None);
    // The command line in the file computes the same state: its last row equals the row of the window.
    let words = shlex::split(&texts["Command line"]).expect("words");
    let frames = folder.path().join("frames");
    succeed(slump("").args(&words[1..]).arg("--frames").arg(&frames));
    let table = read(frames.join("observables.csv"));
    let last: Vec<&str> = table.lines().last().expect("a row").split(',').collect();
    let header: Vec<&str> = table.lines().next().expect("a header").split(',').collect();
    let column =
        |name: &str| last[header.iter().position(|found| *found == name).expect("a column")];
    let row = robot.observables();
    assert_eq!(column("step"), row.step.to_string());
    assert_eq!(column("slump").parse::<f64>(), Ok(row.slump), "to the last bit");
    // If no command can make the state, the file lists the changes.
    settings.parameters.bond = 5.0;
    robot.state_mut().run.change(0, settings);
    robot.key(egui::Key::ArrowRight);
    let path = written(&mut robot, |robot| robot.key(egui::Key::S), "png");
    assert!(self::texts(&path).0.contains_key("Changes"));
}

#[test]
#[ignore = "needs a graphics driver"]
fn compared_worlds_are_one_picture() {
    let folder = folder();
    let mut robot = open(folder.path());
    robot.state_mut().preferences.style.colour_by = slump::render::ColourBy::Speed;
    let base = robot.settings();
    let worlds = [0.0, 20.0, 50.0, 100.0].map(|bond| base.with_bond(bond)).to_vec();
    robot.send(Command::Compare(worlds));
    robot.key(egui::Key::ArrowRight);
    let path = written(&mut robot, |robot| robot.key(egui::Key::S), "png");
    assert!(name(&path).starts_with("slump-pile-4worlds-"), "{}", name(&path));
    let (texts, size) = texts(&path);
    assert_eq!(size, [640, 400]);
    for (world, bond) in [(1, "0"), (2, "20"), (3, "50"), (4, "100")] {
        let settings = &texts[&format!("World {world}: Settings")];
        assert!(settings.contains(&format!("--bond {bond} ")), "{settings}");
    }
    if let Some(kept) = std::env::var_os("SLUMP_KEEP_PICTURES") {
        std::fs::copy(&path, Path::new(&kept).join("worlds.png")).expect("a copy");
    }
}

#[test]
#[ignore = "needs a graphics driver"]
fn a_table_stays_plain_and_a_text_beside_it_says_what_it_is_of() {
    let folder = folder();
    let mut robot = open(folder.path());
    robot.key(egui::Key::ArrowRight);
    let table = written(&mut robot, |robot| robot.clicks(&["Compare", "Curves as CSV"]), "csv");
    let text = read(&table);
    assert!(text.starts_with("world,step,time,time_step,"), "{text}");
    let beside = read(table.with_extension("csv.txt"));
    assert!(beside.starts_with("Software: slump "), "{beside}");
    assert!(beside.contains("\nCommand line: slump --headless --scene pile"), "{beside}");
}
