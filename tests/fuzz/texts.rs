//! Texts that are nearly right.

use arbitrary::{Result, Unstructured};

/// Numbers that break what was not made for them.
pub const NUMBERS: [&str; 24] = [
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
pub const WORDS: [&str; 20] = [
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

/// One of the texts with a few changes, most often one.
pub fn changed(u: &mut Unstructured<'_>, texts: &[String]) -> Result<String> {
    let mut text = u.choose(texts)?.clone();
    for _ in 0..*u.choose(&[1, 1, 1, 1, 2, 3, 6])? {
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
    let changed = match u.int_in_range(0..=15)? {
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
        3 => with_bit_flipped(u, line)?,
        4 | 5 => {
            let word = u.choose(&WORDS)?;
            with_token(u, &line, word)?
        }
        6 => {
            let digits = "7".repeat(u.int_in_range(1..=400)?);
            with_token(u, &line, &digits)?
        }
        7..=10 => {
            let number = u.choose(&NUMBERS)?;
            with_token(u, &line, number)?
        }
        // What one place can say, another one may have to hear.
        _ => {
            let other = lines[u.choose_index(lines.len())?];
            let tokens = tokens(other);
            if tokens.is_empty() {
                return Ok(text.to_owned());
            }
            let (from, to) = *u.choose(&tokens)?;
            with_token(u, &line, &other[from..to])?
        }
    };
    lines[at] = &changed;
    Ok(lines.join("\n"))
}

fn with_bit_flipped(u: &mut Unstructured<'_>, line: String) -> Result<String> {
    let mut bytes = line.into_bytes();
    if !bytes.is_empty() {
        let place = u.choose_index(bytes.len())?;
        bytes[place] ^= 1 << u.int_in_range(0..=6)?;
    }
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Where the words and numbers of a line begin and end.
fn tokens(line: &str) -> Vec<(usize, usize)> {
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
    ends
}

/// The line with one of its words or numbers replaced.
fn with_token(u: &mut Unstructured<'_>, line: &str, token: &str) -> Result<String> {
    let tokens = tokens(line);
    if tokens.is_empty() {
        return Ok(format!("{line}{token}"));
    }
    let (from, to) = *u.choose(&tokens)?;
    Ok(format!("{}{token}{}", &line[..from], &line[to..]))
}
