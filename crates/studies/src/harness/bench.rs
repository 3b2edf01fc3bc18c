//! Manages the folder of an experiment: its measurements, pictures, tables and report.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::effort::Effort;
use super::machine::Machine;
use super::report::{ReportTable, write_sheet};
use super::runner::Runner;
use crate::chart::Sheet;
use crate::error::Result;
use crate::output::{check_writable, print_line, remove_drafts, write_file};

pub(crate) struct Bench {
    pub folder: PathBuf,
    pub effort: Effort,
    pub machine: Machine,
}

impl Bench {
    /// Checks that the folder of an experiment is writable, and records the machine. `version` is the version of the
    /// program, for captions.
    pub(crate) fn new(folder: &Path, effort: Effort, version: &str) -> Result<Self> {
        check_writable("out", folder)?;
        Ok(Self { folder: folder.to_owned(), effort, machine: Machine::this(version)? })
    }

    pub(crate) fn states_folder(&self) -> PathBuf {
        self.folder.join("states")
    }

    /// Opens a runner, which computes the runs of the experiment and stores each result in a journal, a file with one
    /// line per finished run. Each build of the program and each type of processor has its own journals, and so have
    /// the quick pass (with fewer and smaller systems) and the full pass of an experiment.
    pub(crate) fn runner<T: Clone + Send + Sync + Serialize + DeserializeOwned>(
        &self,
        name: &str,
    ) -> Result<Runner<T>> {
        let of_program = self.folder.join("measured").join(&self.machine.fingerprint);
        let folder = of_program.join(self.effort.name());
        check_writable("out", &folder)?;
        Runner::open(name, &folder, name)
    }

    /// Returns the caption of a sheet of charts: the given lines, and a last line with the machine, the date and the
    /// command.
    pub(crate) fn caption(&self, lines: &[&str]) -> Vec<String> {
        let mut caption: Vec<String> = lines.iter().map(|&line| line.to_owned()).collect();
        caption.push(format!("{}{}", self.effort.note(), self.machine.words()));
        caption
    }

    /// Writes a sheet of charts as PNG, SVG and CSV, and each of `tables` as a CSV file. The PNG file also contains the
    /// `command` that makes the sheet.
    pub(crate) fn write<'a>(
        &self,
        (name, sheet): (&str, &Sheet),
        tables: impl IntoIterator<Item = &'a ReportTable>,
        command: &str,
    ) -> Result<()> {
        write_sheet(&self.folder, name, sheet, command)?;
        tables.into_iter().try_for_each(|table| {
            write_file(&self.folder.join(format!("{}.csv", table.name)), &table.to_csv()?)
        })
    }

    /// Writes the text `report` of the experiment to the file `name`, and removes the unfinished files that killed
    /// processes left in the folder.
    pub(crate) fn finish(&self, name: &str, report: &str) -> Result<()> {
        let path = self.folder.join(name);
        write_file(&path, report.as_bytes())?;
        remove_drafts(&self.folder)?;
        print_line(path.display());
        Ok(())
    }
}
