//! Texts that are nearly right.

use std::path::Path;

use arbitrary::{Result, Unstructured};

/// Numbers that break what was not made for them.
const NUMBERS: [&str; 24] = [
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "1e-300",
    "-1e-300",
    "1e300",
    "1e308",
    "1e309",
    "nan",
    "inf",
    "-inf",
    "1e17",
    "1e9",
    "4294967296",
    "18446744073709551616",
    "-9223372036854775809",
    "0.1",
    "1e-17",
    "1000000",
    "NaN",
    "0x10",
    "1e18",
];
/// Words that files know, and some that they do not.
const WORDS: [&str; 20] = [
    "true",
    "false",
    "null",
    "\"\"",
    "\"nsgs\"",
    "\"range\"",
    "\"moreau\"",
    "\"dem\"",
    "[]",
    "{}",
    "[[]]",
    "\"piston\"",
    "\"segment\"",
    "\"half-space\"",
    "\u{1b}[31m",
    "\u{0}",
    "\u{202e}",
    "ö",
    ",",
    "=",
];

/// One of the texts with a few changes.
pub fn changed(u: &mut Unstructured<'_>, texts: &[String]) -> Result<String> {
    let mut text = u.choose(texts)?.clone();
    for _ in 0..u.int_in_range(1..=6)? {
        text = change(u, &text)?;
    }
    Ok(text)
}

fn change(u: &mut Unstructured<'_>, text: &str) -> Result<String> {
    let mut lines: Vec<&str> = text.lines().collect();
    if lines.is_empty() {
        return Ok((*u.choose(&WORDS)?).to_owned());
    }
    let at = u.choose_index(lines.len())?;
    let line = lines[at].to_owned();
    let changed = match u.int_in_range(0..=7)? {
        0 => {
            lines.remove(at);
            return Ok(lines.join("\n"));
        }
        1 => {
            let again = lines[u.choose_index(lines.len())?];
            lines.insert(at, again);
            return Ok(lines.join("\n"));
        }
        2 => {
            let mut end = u.choose_index(text.len() + 1)?;
            while !text.is_char_boundary(end) {
                end -= 1;
            }
            return Ok(text[..end].to_owned());
        }
        3 | 4 => with_token(u, &line, &NUMBERS)?,
        5 => with_token(u, &line, &WORDS)?,
        6 => {
            let digits = "7".repeat(u.int_in_range(1..=400)?);
            with_token(u, &line, &[&digits])?
        }
        _ => {
            let mut bytes = line.into_bytes();
            if !bytes.is_empty() {
                let place = u.choose_index(bytes.len())?;
                bytes[place] ^= 1 << u.int_in_range(0..=6)?;
            }
            String::from_utf8_lossy(&bytes).into_owned()
        }
    };
    lines[at] = &changed;
    Ok(lines.join("\n"))
}

/// The line with one of its words or numbers replaced.
fn with_token(u: &mut Unstructured<'_>, line: &str, tokens: &[&str]) -> Result<String> {
    let is_part = |c: char| c.is_alphanumeric() || "._-+\"".contains(c);
    let mut ends = Vec::new();
    let mut begin = None;
    for (place, c) in line.char_indices().chain([(line.len(), ' ')]) {
        match (begin, is_part(c)) {
            (None, true) => begin = Some(place),
            (Some(from), false) => {
                ends.push((from, place));
                begin = None;
            }
            _ => {}
        }
    }
    let token = u.choose(tokens)?;
    if ends.is_empty() {
        return Ok(format!("{line}{token}"));
    }
    let (from, to) = *u.choose(&ends)?;
    Ok(format!("{}{token}{}", &line[..from], &line[to..]))
}

/// The files of a folder of the corpus, beside those given.
pub fn with_corpus(name: &str, mut texts: Vec<String>) -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus").join(name);
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .map(|entries| entries.flatten().map(|entry| entry.path()).collect())
        .unwrap_or_default();
    paths.sort();
    texts.extend(paths.iter().map(|path| std::fs::read_to_string(path).expect("a text")));
    texts
}
