//! How far long work has come: a bar on a terminal, a line for each finished part elsewhere.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};

use super::lines::note_line;
use crate::error::escaped;

/// Progress of one piece of work on stderr.
#[derive(Clone, Debug)]
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// Starts work of `length` units of any kind. `what` stands in front of the bar.
    pub fn new(what: &str, length: u64) -> Self {
        let bar = if std::io::stderr().is_terminal() {
            let template = "{prefix} {wide_bar} {percent:>3} %  {left}";
            let style = ProgressStyle::with_template(template)
                .unwrap_or_else(|_| ProgressStyle::default_bar())
                .with_key("left", |state: &ProgressState, out: &mut dyn std::fmt::Write| {
                    // What cannot be written on a terminal is no reason to end.
                    let _ = out.write_str(&left(state.pos(), state.eta()));
                });
            let bar = ProgressBar::new(length).with_style(style).with_prefix(escaped(what));
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        } else {
            ProgressBar::hidden()
        };
        Self { bar }
    }

    /// Counts units done.
    pub fn advance(&self, units: u64) {
        self.bar.inc(units);
    }

    /// Sets the units done.
    pub fn set(&self, units: u64) {
        self.bar.set_position(units);
    }

    /// Whether there is a terminal that shows a bar.
    pub fn is_drawn(&self) -> bool {
        !self.bar.is_hidden()
    }

    /// Says something in a line of its own.
    pub fn say(&self, line: &str) {
        self.bar.suspend(|| note_line(line));
    }

    /// Ends the work.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// How long work will take yet, in words; nothing where no part is done, from which one could tell.
fn left(done: u64, estimate: Duration) -> String {
    match done {
        0 => String::new(),
        _ if estimate < Duration::from_secs(1) => "less than a second left".into(),
        _ => format!("{} left", HumanDuration(estimate)),
    }
}

/// More steps than this are told of before they begin: they take minutes of the smallest scene.
const MANY_STEPS: u64 = 100_000_000;

/// Says on stderr how many steps were asked for, where they are very many.
pub fn warn_of_steps(steps: u64) {
    if steps > MANY_STEPS {
        note_line(format_args!("slump: this asks for {steps} steps, which take long"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_said_of_the_time_left_before_anything_is_done() {
        let said = |done, secs| left(done, Duration::from_secs_f64(secs));
        assert_eq!(said(0, 0.0), "");
        assert_eq!(said(1, 0.2), "less than a second left");
        assert_eq!(said(1, 30.0), "30 seconds left");
    }
}
