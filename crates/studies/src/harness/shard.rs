//! Parts of a study that run on several machines.

use crate::error::{Error, Result};

/// Part `index` of `count`, counted from 1. It contains every count-th run, so that cheap and expensive runs are
/// distributed evenly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 1 to `count`.
    pub index: usize,
    /// Number of parts.
    pub count: usize,
}

impl Shard {
    /// True if run number `run` belongs to this part.
    pub(crate) fn has(self, run: usize) -> bool {
        run % self.count == self.index - 1
    }

    /// The name of the part's journal; `of` is the name of the whole journal.
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
