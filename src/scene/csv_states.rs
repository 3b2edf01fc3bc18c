//! Discs as CSV: header `x,y,radius` and, where there are any, `vx,vy,omega`; SI units; lines that
//! start with `#` are comments. Numbers are written so that they read back bit for bit.

use std::fmt::Write as _;
use std::path::Path;

use glam::DVec2;
use serde::Deserialize;

use crate::error::{Error, Result, with_allowed};
use crate::world::Grain;

/// What a file of discs must be, for messages.
const FORM: &str = "a CSV of discs: a header line x,y,radius, with vx,vy,omega where they move, and as \
                    many numbers in each line below";

/// Characters of a header that a message shows.
const MOST_SHOWN: usize = 80;

/// One line. Velocities may be left out.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    x: f64,
    y: f64,
    radius: f64,
    #[serde(default)]
    vx: f64,
    #[serde(default)]
    vy: f64,
    #[serde(default)]
    omega: f64,
}

/// Reads the discs of a CSV file.
///
/// # Errors
/// Where the file cannot be read, or a line is none; the message names the line.
pub fn read_discs(path: &Path) -> Result<Vec<Grain>> {
    let text = std::fs::read_to_string(path).map_err(|error| Error::unread(path, error, FORM))?;
    parse_discs(&text, path)
}

/// Reads discs from the text of a CSV file; `path` is for messages.
///
/// # Errors
/// Where a line is none; the message names it.
pub fn parse_discs(text: &str, path: &Path) -> Result<Vec<Grain>> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let headers = reader.headers().map_err(|error| Error::unread(path, error, FORM))?.clone();
    for needed in ["x", "y", "radius"] {
        if !headers.iter().any(|header| header == needed) {
            let found = headers.iter().collect::<Vec<_>>().join(",");
            let found: String = found.chars().take(MOST_SHOWN).collect();
            let reason =
                format!("the header line is '{found}', but must be one that names x, y and radius");
            return Err(Error::file(path, reason));
        }
    }
    let mut grains = Vec::new();
    let mut record = csv::StringRecord::new();
    loop {
        match reader.read_record(&mut record) {
            Ok(true) => {}
            Ok(false) => break,
            Err(error) => return Err(Error::unread(path, error, FORM)),
        }
        let line_number = record.position().map_or(0, |place| line_of_record(text, place));
        let refuse = |reason: String| Error::file(path, format!("line {line_number}: {reason}"));
        let line: Line = record.deserialize(Some(&headers)).map_err(|error| {
            let reason = match error.kind() {
                csv::ErrorKind::Deserialize { err, .. } => {
                    let field = err.field().and_then(|field| headers.get(field as usize));
                    let place = field.map_or(String::new(), |field| format!("{field}: "));
                    with_allowed(&format!("{place}{}", err.kind()), FORM)
                }
                _ => with_allowed(&error.to_string(), FORM),
            };
            refuse(reason)
        })?;
        if !(line.radius > 0.0 && line.radius.is_finite()) {
            return Err(refuse(format!("radius is {}, but must be finite and > 0", line.radius)));
        }
        let numbers =
            [("x", line.x), ("y", line.y), ("vx", line.vx), ("vy", line.vy), ("omega", line.omega)];
        if let Some((field, value)) = numbers.iter().find(|(_, value)| !value.is_finite()) {
            return Err(refuse(format!("{field} is {value}, but must be finite")));
        }
        grains.push(Grain {
            velocity: DVec2::new(line.vx, line.vy),
            angular_velocity: line.omega,
            ..Grain::at_rest(DVec2::new(line.x, line.y), line.radius)
        });
    }
    if grains.is_empty() {
        return Err(Error::file(path, "holds no disc, but must hold at least one"));
    }
    Ok(grains)
}

/// The line of the record that was read from `place` on: the reader's own place is before the blank
/// lines and comments that it skipped.
fn line_of_record(text: &str, place: &csv::Position) -> u64 {
    let rest = text.get(place.byte() as usize..).unwrap_or_default();
    let skipped = rest.lines().take_while(|line| line.is_empty() || line.starts_with('#')).count();
    place.line() + skipped as u64
}

/// The text of a CSV file of discs; `comment` goes in front, each line of it behind `# `.
pub fn write_discs(grains: &[Grain], comment: &str) -> String {
    let mut text = String::new();
    for line in comment.lines() {
        let _ = writeln!(text, "# {line}");
    }
    let moving =
        grains.iter().any(|grain| grain.velocity != DVec2::ZERO || grain.angular_velocity != 0.0);
    text.push_str(if moving { "x,y,radius,vx,vy,omega\n" } else { "x,y,radius\n" });
    for grain in grains {
        let DVec2 { x, y } = grain.position;
        // Rust's shortest form reads back as the same number.
        let _ = write!(text, "{x:e},{y:e},{:e}", grain.radius);
        if moving {
            let DVec2 { x, y } = grain.velocity;
            let _ = write!(text, ",{x:e},{y:e},{:e}", grain.angular_velocity);
        }
        text.push('\n');
    }
    text
}
