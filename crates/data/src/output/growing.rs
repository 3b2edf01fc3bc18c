//! Writes text files that grow during a run and always consist of complete rows.

use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::locks::is_at;
use crate::error::{Error, Result};

/// Size of a memory page on most machines, bytes. On all other machines the page size is a multiple of this number. The
/// system writes a file in blocks of this size, so a killed program can leave a write incomplete only at the end of
/// such a block.
const PAGE: u64 = 4096;

/// A file that grows by whole rows, so that it stays a readable table if the run is killed or the disk is full.
pub struct GrowingFile {
    path: PathBuf,
    file: File,
    /// Length of the complete rows in the file, bytes.
    whole: u64,
}

impl GrowingFile {
    /// Creates an empty file.
    ///
    /// # Errors
    /// The error names the file and gives the system's message.
    pub fn start(path: PathBuf) -> Result<Self> {
        let file = File::create(&path)
            .map_err(|error| Error::file(&path, format!("cannot be written ({error})")))?;
        Ok(Self { path, file, whole: 0 })
    }

    /// Opens a file to continue it after its first `whole` bytes, and removes all later bytes. If `whole` is 0, the
    /// file need not exist.
    ///
    /// # Errors
    /// The error names the file and gives the system's message, or says that the file is shorter than `whole` bytes.
    pub fn go_on(path: PathBuf, whole: u64) -> Result<Self> {
        let refuse = |error| Error::file(&path, error);
        let file = OpenOptions::new().write(true).create(whole == 0).truncate(false).open(&path);
        let mut file = file.map_err(refuse)?;
        let found = file.metadata().map_err(refuse)?.len();
        if found < whole {
            let reason = format!("has {found} bytes, but must have all {whole} that were written");
            return Err(Error::file(&path, reason));
        }
        file.set_len(whole).map_err(refuse)?;
        file.seek(SeekFrom::Start(whole)).map_err(refuse)?;
        Ok(Self { path, file, whole })
    }

    /// Returns the length of the complete rows in the file, bytes.
    pub fn length(&self) -> u64 {
        self.whole
    }

    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes rows at the end of the file. Each row includes its line end.
    ///
    /// # Errors
    /// The error names the file and gives the system's message. The file still ends with a complete row.
    pub(crate) fn add(&mut self, rows: &[u8]) -> Result<()> {
        self.add_rows(rows).map_err(|error| Error::file(&self.path, error))
    }

    /// Writes rows at the end of the file. Each row includes its line end.
    ///
    /// # Errors
    /// The error gives the system's message. The file still ends with a complete row.
    pub fn add_rows(&mut self, mut rows: &[u8]) -> std::io::Result<()> {
        while !rows.is_empty() {
            let (now, later) = rows.split_at(self.uncut(rows));
            if let Err(error) = self.file.write_all(now) {
                // A part of a row may have been written and is cut off. A pipe cannot be shortened, so this result is
                // ignored.
                let _ = self.file.set_len(self.whole);
                return Err(error);
            }
            self.whole += now.len() as u64;
            rows = later;
        }
        Ok(())
    }

    /// Writes header lines (`head`) and rows at the end of the file, so that readers see either all of them or none.
    /// Head and rows include their line ends. The rows are first written below a draft line, which begins with the text
    /// `draft` and is as long as the head. Readers must skip this line and the rows below it. Finally the head replaces
    /// the draft line.
    ///
    /// If the program is killed, a write can only be interrupted at the end of a page, which is a block of [`PAGE`]
    /// bytes of the file. If the head spans two pages, its part in the second page is therefore written first. The rows
    /// remain a draft until the part in the first page is written, which happens completely or not at all. If the
    /// program is killed between the two parts, the line begins like the draft line and ends like the head. A reader
    /// must therefore recognise a draft by the beginning of its first line, up to the first letter that differs from
    /// every head. For example, if all heads begin with `ITEM: T` and the draft line with `ITEM: DRAFT`, each line that
    /// begins with `ITEM: D` is a draft. If even this letter is in the second page, the head is complete as soon as the
    /// second page is written, because the part in the first page is the same in the draft line and in the head.
    ///
    /// # Errors
    /// The error names the file and gives the system's message. The file then contains neither the rows nor the head.
    pub(crate) fn add_at_once(&mut self, draft: &str, head: &str, rows: &str) -> Result<()> {
        let below_draft = below_draft(draft, head, rows);
        let written = self
            .put(0, below_draft.as_bytes())
            .and_then(|()| self.put_from_its_end(head.as_bytes()));
        let whole = self.whole + below_draft.len() as u64;
        let written = written.and_then(|()| self.file.seek(SeekFrom::Start(whole)));
        if let Err(error) = written {
            let _ = self.file.set_len(self.whole);
            return Err(Error::file(&self.path, error));
        }
        self.whole = whole;
        Ok(())
    }

    /// Writes bytes to the file after its complete rows, and replaces bytes that are already there. If the bytes span
    /// several pages (blocks of [`PAGE`] bytes of the file), the last page is written first: until the first page is
    /// written, the replaced part of the file still begins with its old bytes.
    fn put_from_its_end(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.pages_from_the_last(bytes.len())
            .into_iter()
            .try_for_each(|part| self.put(part.start, &bytes[part]))
    }

    /// Splits the `length` bytes that follow the complete rows at the page ends of the file (a page is a block of
    /// [`PAGE`] bytes). Returns the resulting ranges, counted from the end of the complete rows, the last range first.
    fn pages_from_the_last(&self, length: usize) -> Vec<std::ops::Range<usize>> {
        let room = (PAGE - self.whole % PAGE) as usize;
        let starts = std::iter::once(0).chain((room..length).step_by(PAGE as usize));
        let ends = (room..length).step_by(PAGE as usize).chain([length]);
        let mut pages: Vec<_> = starts.zip(ends).map(|(start, end)| start..end).collect();
        pages.reverse();
        pages
    }

    /// Writes bytes into the file, beginning `behind` bytes after the end of the complete rows.
    fn put(&mut self, behind: usize, bytes: &[u8]) -> std::io::Result<()> {
        self.file.seek(SeekFrom::Start(self.whole + behind as u64))?;
        self.file.write_all(bytes)
    }

    /// Returns the number of bytes of `rows` to write in one operation. If the program is killed, a write can only be
    /// interrupted at the end of a page (a block of [`PAGE`] bytes of the file). Rows within one page are therefore
    /// written together. A row that spans two pages is written alone: it is incomplete only if the program is killed in
    /// the 0.1 µs between the two pages.
    fn uncut(&self, rows: &[u8]) -> usize {
        let room = (PAGE - self.whole % PAGE) as usize;
        let first = || rows.iter().position(|&byte| byte == b'\n').map(|last| last + 1);
        end_of_last(&rows[..room.min(rows.len())]).or_else(first).unwrap_or(rows.len())
    }

    /// Waits until all data of the file are on the disk.
    ///
    /// # Errors
    /// If the file is no longer at its path.
    pub fn sync(&self) -> Result<()> {
        // Pipes and devices do not support synchronisation, so its result is ignored.
        let _ = self.file.sync_all();
        if is_at(&self.file, &self.path) {
            return Ok(());
        }
        let reason = "was removed or replaced, but must stay as long as it is written to";
        Err(Error::file(&self.path, reason))
    }
}

/// Returns the text of a draft: a line that begins with `draft`, filled with spaces to the length of the head, and then
/// the rows. The spaces come from `repeat`, because the padding of `format!` is limited to 65,535 characters.
fn below_draft(draft: &str, head: &str, rows: &str) -> String {
    let room = head.len().saturating_sub(draft.len() + 1);
    format!("{draft}{}\n{rows}", " ".repeat(room))
}

/// Returns the number of bytes up to the end of the last complete row in `rows`; `None` if no row is complete.
pub fn end_of_last(rows: &[u8]) -> Option<usize> {
    rows.iter().rposition(|&byte| byte == b'\n').map(|last| last + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that [`GrowingFile::add_at_once`] never leaves incomplete data that look complete if the program is
    /// killed. This function replaces a draft line by header lines (the head), with one write operation for each page
    /// of the file. Before each operation the data must begin with a draft line. After it, they must begin with a draft
    /// line or be the complete head and rows. The test places the end of a page at each position within the head.
    #[test]
    fn a_head_over_the_end_of_a_page_is_a_draft_until_it_is_whole() {
        let folder = tempfile::tempdir().expect("a folder");
        let (draft, head, rows) = ("ITEM: DRAFT", "ITEM: TIME\n0.5\nITEM: TIMESTEP\n7\n", "1 2\n");
        let mut over_an_end = 0;
        for before in PAGE - 40..=PAGE {
            let mut file = GrowingFile::start(folder.path().join("rows")).expect("a file");
            file.add(("x".repeat(before as usize - 1) + "\n").as_bytes()).expect("rows");
            file.put(0, below_draft(draft, head, rows).as_bytes()).expect("a draft");
            let pages = file.pages_from_the_last(head.len());
            over_an_end += usize::from(pages.len() == 2);
            for part in pages {
                let text = std::fs::read_to_string(file.path()).expect("text");
                assert!(text[before as usize..].starts_with("ITEM: D"), "{before}");
                file.put(part.start, &head.as_bytes()[part.clone()]).expect("a part of a head");
                let text = std::fs::read_to_string(file.path()).expect("text");
                let now = &text[before as usize..];
                assert!(
                    now.starts_with("ITEM: D") || now == head.to_owned() + rows,
                    "{before}: {now}"
                );
                if now.starts_with("ITEM: T") {
                    break;
                }
            }
        }
        assert!(over_an_end > 30, "the situation: {over_an_end}");
    }

    #[test]
    fn a_head_may_be_longer_than_format_pads() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut file = GrowingFile::start(folder.path().join("rows")).expect("a file");
        let head = "ITEM: ATOMS ".to_owned() + &"id ".repeat(30_000) + "\n";
        file.add_at_once("ITEM: DRAFT", &head, "1 2\n").expect("a head and a row");
        let text = std::fs::read_to_string(file.path()).expect("text");
        assert!(text == head + "1 2\n", "{:.40}", text);
    }

    #[test]
    fn no_two_rows_are_written_together_over_the_end_of_a_page() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut rows = GrowingFile::start(folder.path().join("rows")).expect("a file");
        let text = "a row of 17 bytes\n".repeat(1000);
        let mut rest = text.as_bytes();
        let mut alone = 0;
        while !rest.is_empty() {
            let now = rows.uncut(rest);
            let pages = [rows.whole, rows.whole + now as u64 - 1].map(|byte| byte / PAGE);
            assert_eq!(rest[now - 1], b'\n');
            assert!(pages[0] == pages[1] || now == 18, "{now} bytes over the end of a page");
            alone += u64::from(pages[0] != pages[1]);
            rows.whole += now as u64;
            rest = &rest[now..];
        }
        assert!(alone >= 3, "{alone}");
    }
}
