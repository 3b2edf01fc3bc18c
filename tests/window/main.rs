//! Tests of the window: the real panels with a real solver thread, controlled through their accessibility tree.
//!
//! Pictures of panels are compared with the files `tests/pictures/golden/window-*.png`. Each colour channel of a pixel
//! may differ by 2 of 255, and 1 % of the pixels may differ at all. After an intended change, look at the pictures that
//! a failure writes to `target/golden/`, and write the files again with
//!
//! ```text
//! SLUMP_BLESS=1 cargo test --release --test window -- --ignored with_driver
//! ```

mod alarms;
mod controls;
mod dialogs;
mod exports;
mod front;
mod hand;
mod hard_scenes;
mod lessons;
mod looking;
mod monkey;
mod other_piles;
mod recording;
mod recordings;
mod remote;
mod robot;
mod sessions;
mod with_driver;

#[path = "../common/probed.rs"]
#[allow(dead_code, reason = "tests of the command line use more of it")]
mod probed;
#[path = "../common/program.rs"]
mod program;
#[path = "../recordings/data/tables.rs"]
#[allow(dead_code, reason = "tests of recordings use more of it")]
mod tables;
