//! Tests of files that Slump did not write: the program reads only regular files, stops reading endless files, and
//! removes only files that it wrote itself.
#![cfg(unix)]

use crate::program::*;

/// Runs the program with these arguments and checks that it ends with an error message within a time limit. Returns the
/// message.
fn refusal(words: &[&str]) -> String {
    let program = slump("").get_program().to_owned();
    sentence(Command::new("timeout").arg("30").arg(program).args(words))
}

fn brief_run(out: &Path, more: &[&str]) -> Command {
    let mut command =
        slump("--headless --scene cradle --duration 0.05 --size 64x18 --renderer cpu");
    command.arg("--frames").arg(out).args(more);
    command
}

#[test]
fn devices_and_pipes_are_no_input() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let link = |name: &str| std::os::unix::fs::symlink("/dev/zero", at(name)).expect("a link");
    ["zero.toml", "zero.csv"].into_iter().for_each(link);
    for pipe in ["pipe.toml", "pipe.csv"] {
        assert!(Command::new("mkfifo").arg(at(pipe)).status().expect("mkfifo").success());
    }
    for kind in ["zero", "pipe"] {
        let [toml, csv] = ["toml", "csv"].map(|ending| at(&format!("{kind}.{ending}")));
        let (toml, csv) = (text(&toml), text(&csv));
        let out = at("out");
        let out = text(&out);
        for words in [
            &["--headless", "--data", out, "--scene", toml][..],
            &["--headless", "--data", out, "--initial", csv],
            &["--headless", "--data", out, "--restart", csv],
            &["sweep", toml, "--out", out],
            &["problem", "solve", csv],
        ] {
            let said = refusal(words);
            assert!(said.contains("is a device or a pipe, but must be "), "{words:?}: {said}");
        }
    }
}

#[test]
fn a_text_without_end_is_refused_before_it_is_all_read() {
    let folder = folder();
    for (name, option) in [("a.toml", "--scene"), ("a.csv", "--initial")] {
        let path = folder.path().join(name);
        let file = std::fs::File::create(&path).expect("a file");
        file.set_len(1 << 40).expect("a file of holes");
        let out = folder.path().join("out");
        let said = refusal(&["--headless", "--data", text(&out), option, text(&path)]);
        assert!(said.contains(" bytes, but must have no more"), "{said}");
    }
}

#[test]
fn a_link_opens_no_file() {
    for (link, said) in [
        ("initial=/dev/zero", "link: initial is /dev/zero, but must be left out"),
        ("scene=/tmp/a.toml", "link: scene is /tmp/a.toml, but must be a built-in scene"),
        ("save=a", "--save is given, but must be a setting"),
    ] {
        let refused = refusal(&["--open", &format!("slump://run?{link}&to=3")]);
        assert!(refused.contains(said), "{refused}");
    }
}

#[test]
fn an_edited_manifest_has_no_other_file_removed() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    succeed(&mut brief_run(folder.path(), &[]));
    write(at("thesis.tex"), "mine");
    let told = read(at("manifest.json")).replace("frame_00000.png", "thesis.tex");
    assert!(told.contains("thesis.tex"), "the situation");
    write(at("manifest.json"), told);
    succeed(&mut brief_run(folder.path(), &["--overwrite"]));
    assert_eq!(read(at("thesis.tex")), "mine");
    // A file with the name of a run's file but other contents would be overwritten, so the command is refused.
    for name in ["frame_00007.png", "observables.csv", "checkpoint.slump"] {
        let before = std::fs::read(at(name)).ok();
        write(at(name), "mine as well");
        let said = sentence(&mut brief_run(folder.path(), &["--overwrite"]));
        assert!(said.contains(&format!("{name}: is not as this program writes")), "{said}");
        assert_eq!(read(at(name)), "mine as well");
        assert!(at("frame_00001.png").exists(), "a refusal removes nothing");
        before.map_or_else(
            || std::fs::remove_file(at(name)).expect("a file"),
            |it| write(at(name), it),
        );
    }
}

#[test]
fn a_recording_that_another_program_wrote_is_not_overwritten() {
    let folder = folder();
    let mut record = slump("--headless --scene cradle --duration 0.05 --overwrite --data");
    record.arg(folder.path());
    succeed(&mut record);
    for name in ["steps/part-00007.parquet", "frames.csv", "data.json"] {
        let path = folder.path().join(name);
        let before = std::fs::read(&path).ok();
        write(&path, "{\"precious\": 1}");
        let said = sentence(&mut record);
        assert!(said.contains(&format!("{name}: is not as this program writes")), "{said}");
        assert_eq!(read(&path), "{\"precious\": 1}");
        before.map_or_else(|| std::fs::remove_file(&path).expect("a file"), |it| write(&path, it));
    }
    succeed(&mut record);
}

#[test]
fn names_of_files_cannot_steer_the_terminal() {
    let folder = folder();
    let out = folder.path().join("a\u{1b}[31mb\u{202e}c.csv");
    let output = run(slump("generate --grains 3 --box-width 4 --out").arg(&out));
    assert!(output.status.success() && out.exists());
    let shown = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(shown.ends_with("a\\u{1b}[31mb\\u{202e}c.csv\n"), "{shown:?}");
}
