//! How far long work has come: a bar on a terminal, a line for each finished part elsewhere.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::lines::note_line;
use crate::error::escaped;

/// Progress of one piece of work on stderr.
#[derive(Clone, Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// Starts work of `length` units of any kind. `what` stands in front of the bar.
    pub(crate) fn new(what: &str, length: u64) -> Self {
        let bar = if std::io::stderr().is_terminal() {
            let template = "{prefix} {wide_bar} {percent:>3} %  {eta} left";
            let style = ProgressStyle::with_template(template)
                .unwrap_or_else(|_| ProgressStyle::default_bar());
            let bar = ProgressBar::new(length).with_style(style).with_prefix(escaped(what));
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        } else {
            ProgressBar::hidden()
        };
        Self { bar }
    }

    /// Counts units done.
    pub(crate) fn advance(&self, units: u64) {
        self.bar.inc(units);
    }

    /// Sets the units done.
    pub(crate) fn set(&self, units: u64) {
        self.bar.set_position(units);
    }

    /// Whether there is a terminal that shows a bar.
    pub(crate) fn is_drawn(&self) -> bool {
        !self.bar.is_hidden()
    }

    /// Says something in a line of its own.
    pub(crate) fn say(&self, line: &str) {
        self.bar.suspend(|| note_line(line));
    }

    /// Ends the work.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// More steps than this are told of before they begin: they take minutes of the smallest scene.
const MANY_STEPS: u64 = 100_000_000;

/// Says on stderr how many steps were asked for, where they are very many.
pub(crate) fn warn_of_steps(steps: u64) {
    if steps > MANY_STEPS {
        note_line(format_args!("slump: this asks for {steps} steps, which take long"));
    }
}
