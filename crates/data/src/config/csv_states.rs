//! Discs as CSV: header `x,y,radius` and, where there are any, `vx,vy,omega`; SI units; lines that
//! start with `#` are comments. Numbers are written so that they read back bit for bit.

use std::fmt::Write as _;
use std::path::Path;

use glam::DVec2;

use crate::data::parse_grains;
use crate::error::Result;
use crate::world::Grain;

/// Reads discs from the text of a CSV file; `path` is for messages.
///
/// # Errors
/// Where a line is none; the message names it.
pub fn parse_discs(text: &str, path: &Path) -> Result<Vec<Grain>> {
    Ok(parse_grains(text, path)?.grains)
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
