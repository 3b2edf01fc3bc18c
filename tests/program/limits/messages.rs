//! Every message says what is allowed.

use slump::config::scene_to_toml;
use slump::scene::collision;

use super::{folder, refusal};

#[test]
fn every_message_of_the_command_line_says_what_is_allowed() {
    let long = "9".repeat(300);
    let cases: [&[&str]; 19] = [
        &["--bond", "much"],
        &["--bond"],
        &["--bond", "1", "--bond", "2"],
        &["--max-sweeps", "-1"],
        &["--max-sweeps", "99999999999"],
        &["--seed", "x"],
        &["--grains", "1.5"],
        &["--warm-start", "maybe"],
        &["--solver", "magic"],
        &["--colour", "pink"],
        &["--nonsense"],
        &["--headles"],
        &["nonsense"],
        &["problem"],
        &["problem", "dump"],
        &["problem", "solve", "x", "--repeat", "x"],
        &["--initial", "a.csv", "--seed", "3"],
        &["--headless=3"],
        &["sweep", "a.toml", "b.toml"],
    ];
    for case in cases {
        let said = refusal(case);
        assert!(said.contains("but must be "), "{case:?}: {said}");
        assert!(said.len() < 3000, "{case:?}: {said}");
    }
    assert!(refusal(&["--bond", "much"]).contains("--bond is much, but must be a number (Bond"));
    let said = refusal(&["--headless", "--frames", "no-folder", "--bond", &format!("-{long}")]);
    assert!(said.contains("bond is -1e300, but must be a fin"), "{said}");
    assert!(refusal(&["nonsense"]).contains("problem (dump, solve)"));
    assert!(refusal(&["--seed", "\u{1b}[31mred\u{7}"]).contains("\\u{1b}[31mred\\u{7}"));
}

/// Has the program read a file of that text where the arguments end, and checks what it says.
fn check(arguments: &[&str], name: &str, text: impl AsRef<[u8]>) {
    let folder = folder();
    let path = folder.path().join(name);
    std::fs::write(&path, &text).expect("a file");
    let said = refusal(&[arguments, &[path.to_str().expect("UTF-8")]].concat());
    let text = String::from_utf8_lossy(text.as_ref());
    assert!(said.contains(" must "), "{text}: {said}");
    assert!(said.len() < 3000, "{text}: {said}");
}

const OF_SCENE: [&str; 4] = ["--headless", "--frames", "no-folder", "--scene"];
const OF_DISCS: [&str; 4] = ["--headless", "--frames", "no-folder", "--initial"];
const OF_STUDY: [&str; 2] = ["sweep", "count"];
const OF_PROBLEM: [&str; 2] = ["problem", "solve"];

#[test]
fn every_message_of_a_scene_file_says_what_is_allowed() {
    let good = scene_to_toml(&collision()).expect("TOML");
    for text in [
        "name",
        "name = \"a\nb\"",
        "name = 3",
        "= 3",
        "[[[",
        "a = 1\na = 2",
        "a = 99999999999999999999",
    ] {
        check(&OF_SCENE, "a.toml", text);
    }
    for (from, to) in [
        ("duration_secs", "#"),
        ("axes = 1", "axes = -1"),
        ("axes = 1", "axes = 1.5"),
        ("friction = false", "friction = 0"),
        ("bond = ", "bondage = "),
        ("bond = ", "\"a\\u0007\\u001b[2J\" = "),
        ("stepper = \"moreau\"", "stepper = \"running\""),
    ] {
        assert!(good.contains(from), "no {from} in {good}");
        check(&OF_SCENE, "a.toml", good.replacen(from, to, 1));
    }
}

#[test]
fn every_message_of_other_files_says_what_is_allowed() {
    for text in
        ["x,y,radius\n0,zero,1\n", "x,y,radius\n0,0\n", "x,y,radius,z\n0,0,1,1\n", "", "x,y"]
    {
        check(&OF_DISCS, "a.csv", text);
    }
    for text in [
        "",
        "name = 3",
        "name = \"a\"\n[vary]\nbond = 3",
        "name = \"a\"\n[vary]\nbund = [3]",
        "name = \"a\"\n[vary]\nbond = [\"x\"]",
        "name = \"a\"\n[base]\nmax-sweeps = -1",
        "colour = 1",
    ] {
        check(&OF_STUDY, "a.toml", text);
    }
    for text in ["{", "{}", "{\"nc\": -1}", "{\"nc\": 1, \"mu\": [[]]}", "[", "2\n1\n"] {
        check(&OF_PROBLEM, "a.json", text);
    }
    let commands: [(&[&str], &str); 4] = [
        (&OF_SCENE, "no/such.toml"),
        (&OF_DISCS, "no/such.csv"),
        (&OF_STUDY, "no/such.toml"),
        (&OF_PROBLEM, "no/such.json"),
    ];
    for (arguments, missing) in commands {
        check(arguments, "a.toml", [0xff, 0xfe, 0x00]);
        let said = refusal(&[arguments, &[missing]].concat());
        assert!(said.contains("No such file") && said.contains(" must be "), "{said}");
    }
}
