//! `slump stability`: every method on scenes made to break methods.

use std::path::{Path, PathBuf};

use crate::error::Result;
use crate::output::{Progress, check_file, check_writable, print_line, print_text, write_file};
use crate::study::chart::{png, svg};
use crate::study::stability::{
    CHALLENGES, Challenge, StabilityTable, count_of_maps, maps, picture,
};

/// Arguments of `slump stability`.
#[derive(clap::Args)]
pub(super) struct StabilityCommand {
    /// Challenges; all where none is given
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    /// Folder for the table and its picture, and, unless challenges are given, the stability maps
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// File for the table alone, as CSV
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
    /// Leave the longest runs out: under a minute, and what the tests compare with
    #[arg(long)]
    quick: bool,
}

impl StabilityCommand {
    /// Does what is asked.
    pub(super) fn run(self) -> Result<()> {
        let named: Result<Vec<_>> = self.scenes.iter().map(|name| Challenge::named(name)).collect();
        let challenges = match named? {
            named if named.is_empty() => CHALLENGES.iter().collect(),
            named => named,
        };
        if let Some(folder) = &self.out {
            check_writable("out", folder)?;
        }
        self.table.as_deref().map(|table| check_file("table", table)).transpose()?;
        let count = StabilityTable::count(&challenges, self.quick) as u64;
        let progress = Progress::new("stability", count);
        let table = StabilityTable::run(&challenges, self.quick, || {
            progress.advance(1);
        });
        progress.finish();
        let table = table?;
        print_text(&table);
        if let Some(folder) = &self.out {
            write_file(&folder.join("table.csv"), &table.to_csv()?)?;
            self.draw(&table, folder)?;
            print_line(folder.display());
        }
        if let Some(path) = &self.table {
            write_file(path, &table.to_csv()?)?;
            print_line(path.display());
        }
        Ok(())
    }

    fn draw(&self, table: &StabilityTable, folder: &Path) -> Result<()> {
        let mut sheets = vec![("table".to_owned(), picture(table))];
        if self.scenes.is_empty() {
            let progress = Progress::new("maps", count_of_maps() as u64);
            let found = maps(self.quick, || progress.advance(1));
            progress.finish();
            sheets.extend(found?);
        }
        let quick = if self.quick { " --quick" } else { "" };
        let scenes: String = self.scenes.iter().map(|name| format!(" {name}")).collect();
        let command = format!("slump stability{quick}{scenes} --out stability");
        for (name, sheet) in &sheets {
            write_file(&folder.join(format!("{name}.png")), &png(sheet, &command)?)?;
            write_file(&folder.join(format!("{name}.svg")), svg(sheet)?.as_bytes())?;
            if name != "table" {
                write_file(&folder.join(format!("{name}.csv")), &sheet.to_csv()?)?;
            }
        }
        Ok(())
    }
}
