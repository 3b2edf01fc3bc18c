//! Text files that grow by whole rows.

use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::locks::is_at;
use crate::error::{Error, Result};

/// Bytes of a page of memory on most machines, and a part of one on all others.
const PAGE: u64 = 4096;

/// A file that grows by whole rows, so that a run that is killed, or that fills the disk, leaves a table
/// that can be read.
pub struct GrowingFile {
    path: PathBuf,
    file: File,
    /// Length of the rows that are in the file, bytes.
    whole: u64,
}

impl GrowingFile {
    /// Starts an empty file.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub fn start(path: PathBuf) -> Result<Self> {
        let file = File::create(&path)
            .map_err(|error| Error::file(&path, format!("cannot be written ({error})")))?;
        Ok(Self { path, file, whole: 0 })
    }

    /// Goes on with the first `whole` bytes of a file, of which none need be there if it is 0; what is
    /// behind them is dropped.
    ///
    /// # Errors
    /// Names the file and what the system says, or that it is shorter.
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

    /// Length of the rows that are in the file, bytes.
    pub fn length(&self) -> u64 {
        self.whole
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes rows, each with its line end.
    ///
    /// # Errors
    /// Names the file and what the system says; it ends with a whole row.
    pub(crate) fn add(&mut self, rows: &[u8]) -> Result<()> {
        self.add_rows(rows).map_err(|error| Error::file(&self.path, error))
    }

    /// Writes rows, each with its line end.
    ///
    /// # Errors
    /// What the system says; it ends with a whole row.
    pub fn add_rows(&mut self, mut rows: &[u8]) -> std::io::Result<()> {
        while !rows.is_empty() {
            let (now, later) = rows.split_at(self.uncut(rows));
            if let Err(error) = self.file.write_all(now) {
                // A part of a row may be there. A pipe has taken it; a file gives it back.
                let _ = self.file.set_len(self.whole);
                return Err(error);
            }
            self.whole += now.len() as u64;
            rows = later;
        }
        Ok(())
    }

    /// Writes rows with a head, each with its line end, so that they are there in one go: the rows are written
    /// below a line that begins with `draft`, which readers are to skip with what follows, and last of all
    /// the head takes its place. A kill can cut a write where a page of the file ends, so a head that lies in
    /// two pages is written from its end: what stands in the second page still belongs to the draft until
    /// what stands in the first has changed, all of it or nothing. Where the first page ends within the word
    /// of the draft, the head's letters may follow those of it that are left; where it ends in what `draft`
    /// and the head have in common, the second page says it all. So a reader must know a draft by the first
    /// letter that no head has there.
    ///
    /// # Errors
    /// Names the file and what the system says; then it has nothing of them.
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

    /// Writes over what stands behind what is whole, the last page first.
    fn put_from_its_end(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.pages_from_the_last(bytes.len())
            .into_iter()
            .try_for_each(|part| self.put(part.start, &bytes[part]))
    }

    /// The parts of so many bytes behind what is whole that lie in one page each, the last first.
    fn pages_from_the_last(&self, length: usize) -> Vec<std::ops::Range<usize>> {
        let room = (PAGE - self.whole % PAGE) as usize;
        let starts = std::iter::once(0).chain((room..length).step_by(PAGE as usize));
        let ends = (room..length).step_by(PAGE as usize).chain([length]);
        let mut pages: Vec<_> = starts.zip(ends).map(|(start, end)| start..end).collect();
        pages.reverse();
        pages
    }

    /// Writes so many bytes behind what is whole.
    fn put(&mut self, behind: usize, bytes: &[u8]) -> std::io::Result<()> {
        self.file.seek(SeekFrom::Start(self.whole + behind as u64))?;
        self.file.write_all(bytes)
    }

    /// How many bytes to write at once. A kill can cut a write where a page of the file ends, and only
    /// there: so rows that lie in one page are written together, and one that lies in two alone, which
    /// leaves some 0.1 µs in which it can be cut.
    fn uncut(&self, rows: &[u8]) -> usize {
        let room = (PAGE - self.whole % PAGE) as usize;
        let first = || rows.iter().position(|&byte| byte == b'\n').map(|last| last + 1);
        end_of_last(&rows[..room.min(rows.len())]).or_else(first).unwrap_or(rows.len())
    }

    /// Has all of it on the disk.
    ///
    /// # Errors
    /// Where it is no longer at its place.
    pub fn sync(&self) -> Result<()> {
        // Pipes and devices know no such thing.
        let _ = self.file.sync_all();
        if is_at(&self.file, &self.path) {
            return Ok(());
        }
        let reason = "was removed or replaced, but must stay as long as it is written to";
        Err(Error::file(&self.path, reason))
    }
}

/// Rows below a line of draft that is as long as the head. The padding of `format!` ends at 65,535 characters.
fn below_draft(draft: &str, head: &str, rows: &str) -> String {
    let room = head.len().saturating_sub(draft.len() + 1);
    format!("{draft}{}\n{rows}", " ".repeat(room))
}

/// Where the last row ends that does.
pub fn end_of_last(rows: &[u8]) -> Option<usize> {
    rows.iter().rposition(|&byte| byte == b'\n').map(|last| last + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a file says after every write of a head, wherever its pages end.
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
