//! Tests of saved and resumed runs, which are bitwise equal to uninterrupted runs.

mod program;
mod states;

use slump::config::SavedState;
use slump::scene::{Scene, built_in};
use slump::sim::{Simulation, Tally};

use crate::program::*;

/// Returns all bytes of a saved state. Equal bytes mean equal states.
fn bytes_of(scene: &Scene, simulation: &Simulation) -> Vec<u8> {
    let state = SavedState::new(scene.clone(), simulation.clone(), Tally::default());
    state.to_bytes().expect("bytes")
}

/// Reads a saved state from bytes.
fn read_back(bytes: &[u8]) -> SavedState {
    SavedState::from_bytes(bytes, "state.slump").expect("a sound state")
}

/// Returns the bytes of a small saved state, and the offset of its content behind the first line.
fn small(scene: &str, steps: u64) -> (Vec<u8>, usize) {
    let scene = built_in(scene).expect("a scene");
    let mut simulation = scene.simulation().expect("a sound scene");
    simulation.take_steps(steps).expect("finite states");
    let bytes = bytes_of(&scene, &simulation);
    let line = 1 + bytes.iter().position(|&byte| byte == b'\n').expect("a first line");
    (bytes, line)
}

/// Checks that the bytes are refused as a saved state, in one sentence that says which form a saved state must have.
/// Returns the sentence.
#[track_caller]
fn refusal(bytes: &[u8]) -> String {
    let said = SavedState::from_bytes(bytes, "a.slump").expect_err("no state").to_string();
    assert!(said.starts_with("a.slump: ") && said.contains("must be"), "{said}");
    assert!(said.len() < 400 && said.lines().count() == 1, "{said}");
    said
}

/// Returns a saved state that consists of this content and a first line with its length and checksum.
fn sealed(content: &[u8]) -> Vec<u8> {
    let version = env!("CARGO_PKG_VERSION");
    let line = format!("slump-state 8 {version} {} {}\n", content.len(), blake3::hash(content));
    [line.as_bytes(), content].concat()
}

#[test]
fn a_state_that_is_cut_anywhere_is_refused() {
    let (bytes, line) = small("collision", 3);
    for length in 0..bytes.len() {
        let said = refusal(&bytes[..length]);
        assert!(length < line || said.contains("has been cut"), "{length}: {said}");
    }
    refusal(&[&bytes[..], b"x"].concat());
}

#[test]
fn no_flipped_bit_goes_unseen() {
    let (mut bytes, _) = small("collision", 3);
    assert!(bytes.len() < 20_000, "{} bytes", bytes.len());
    for bit in 0..8 * bytes.len() {
        bytes[bit / 8] ^= 1 << (bit % 8);
        refusal(&bytes);
        bytes[bit / 8] ^= 1 << (bit % 8);
    }
    read_back(&bytes);
}

#[test]
fn what_is_no_state_or_of_another_version_says_so() {
    let (bytes, line) = small("collision", 3);
    assert!(refusal(b"x,y,radius\n0,0,1\n").contains("holds no state of a run"));
    assert!(refusal(b"").contains("holds no state of a run"));
    assert!(refusal(&[0xff; 5000]).contains("holds no state of a run"));
    let text = String::from_utf8_lossy(&bytes[..line]).into_owned();
    let version = env!("CARGO_PKG_VERSION");
    for (other, named) in [
        (text.replace(version, "99.0.1"), "version 99.0.1 of the program"),
        (text.replace("state 8 ", "state 77 "), "format 77"),
    ] {
        let said = refusal(&[other.as_bytes(), &bytes[line..]].concat());
        assert!(said.contains(named) && said.contains(&format!("version {version}")), "{said}");
    }
    // A length that no file can have must not be trusted.
    let length = (bytes.len() - line).to_string();
    let huge = text.replacen(&length, "18446744073709551615", 1);
    assert!(refusal(&[huge.as_bytes(), &bytes[line..]].concat()).contains("has been cut"));

    let folder = folder();
    let missing = folder.path().join("none.slump");
    for path in [folder.path(), &missing] {
        let said = SavedState::open(path).expect_err("no file").to_string();
        assert!(said.contains("must be a state that --save"), "{said}");
    }
}

#[test]
fn content_that_someone_made_up_is_refused_or_harmless() {
    let (bytes, line) = small("collision", 3);
    let content = &bytes[line..];
    assert_eq!(sealed(content), bytes);
    let mut refused = 0;
    for at in 0..content.len() {
        for byte in [0x00, 0x7f, 0xc0, 0xdd, 0xff, content[at].wrapping_add(1)] {
            let mut made_up = content.to_vec();
            made_up[at] = byte;
            if SavedState::from_bytes(&sealed(&made_up), "a.slump").is_err() {
                refusal(&sealed(&made_up));
                refused += 1;
            }
        }
    }
    assert!(refused > 3 * content.len(), "{refused} of {}", 6 * content.len());
    for end in 0..content.len() {
        refusal(&sealed(&content[..end]));
    }
}

#[test]
fn parts_that_do_not_go_together_are_refused() {
    let (bytes, line) = small("column", 2);
    // The test changes the other body of the second contact. Its number is below 128, so it is the single byte after
    // its name.
    let content = &bytes[line..];
    let name = b"\xa5other";
    let mut places = content.windows(name.len()).enumerate().filter(|(_, window)| window == name);
    let (at, _) = places.nth(1).expect("a second contact");
    for (byte, is_sound) in [(content[at + name.len()], true), (0x7f, false)] {
        let mut changed = content.to_vec();
        changed[at + name.len()] = byte;
        let read = SavedState::from_bytes(&sealed(&changed), "a.slump");
        assert_eq!(read.is_ok(), is_sound);
        if let Err(error) = read {
            assert!(error.to_string().contains("contacts is of other grains"), "{error}");
        }
    }
}

#[test]
fn a_state_is_written_and_read_as_a_file() {
    let folder = folder();
    let path = folder.path().join("a.slump");
    let (bytes, _) = small("collision", 3);
    read_back(&bytes).save(&path).expect("a file");
    assert_eq!(crate::program::bytes(&path), bytes);
    assert!(SavedState::is_in(&path) && !SavedState::is_in(folder.path()));
    let mut state = SavedState::open(&path).expect("a state");
    state.tally = Tally { steps: 3, largest_residual: f64::INFINITY, ..Tally::default() };
    assert_eq!(read_back(&state.to_bytes().expect("bytes")).tally, state.tally);
}
