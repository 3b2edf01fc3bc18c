//! Divides the runs of a study into parts, so that several machines can share the study.

use crate::error::{Error, Result};

/// One of `count` parts of a study: part number `index`, counted from 1. The part contains every count-th run, so that
/// cheap and expensive runs are distributed evenly over the parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Number of this part, from 1 to `count`.
    pub index: usize,
    /// Number of parts into which the study is divided.
    pub count: usize,
}

impl Shard {
    /// True if run number `run` belongs to this part.
    pub(crate) fn has(self, run: usize) -> bool {
        run % self.count == self.index - 1
    }

    /// Returns the name of the journal (the file that stores the results of finished runs) of this part of a study.
    /// `of` is the name of the journal of the whole study.
    pub(crate) fn journal(self, of: &str) -> String {
        format!("{of}-{}-of-{}", self.index, self.count)
    }
}

impl std::str::FromStr for Shard {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let refuse = || Error::value("shard", text, "k/n with k between 1 and n, as in 3/16");
        let (index, count) = text.split_once('/').ok_or_else(refuse)?;
        match (index.parse(), count.parse()) {
            (Ok(index), Ok(count)) if (1..=count).contains(&index) => Ok(Self { index, count }),
            _ => Err(refuse()),
        }
    }
}
