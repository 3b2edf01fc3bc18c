//! Provides the common parts of all experiments: cases (the runs to compute), the journal (the file that stores the
//! results of finished cases), the runner (which computes the cases), the machine on which cases are timed, and
//! reports.

mod bench;
mod case;
mod change;
mod effort;
pub(crate) mod journal;
mod machine;
mod measurements;
mod report;
mod runner;
mod shard;

pub(crate) use self::bench::Bench;
pub(crate) use self::case::{Case, FinishedCase};
pub(crate) use self::change::Change;
pub(crate) use self::effort::Effort;
pub(crate) use self::journal::Journal;
pub(crate) use self::machine::Machine;
pub(crate) use self::measurements::{MeasuredCase, Measurements, RunReadings, named};
pub(crate) use self::report::{ReportTable, distinct, write_sheet};
pub(crate) use self::runner::{Runner, Threads};
pub use self::shard::Shard;
