//! Opens and reads input files that may come from anywhere and may be damaged. Only regular files are read (no devices
//! or pipes), and the sizes of text files and the lengths of lines are limited.

use std::io::{self, Read};
use std::path::Path;

use crate::draft::DraftFile;
use crate::error::{Error, Result};

/// Largest accepted size, in bytes, of an unpacked page (block of data) of a Parquet file, and of a file with a contact
/// problem. The limit keeps a damaged file from exhausting the memory.
pub(crate) const MOST_BYTES: u64 = 256 << 20;
/// Size of the largest accepted TOML file, bytes. Parsing a file takes about 60 times its size in memory. The file of a
/// scene with 10,000 grains has about one MiB.
pub const MOST_OF_TOML: u64 = 32 << 20;
/// Length of the longest accepted line of a table in a text file, bytes. The limit keeps a file without line breaks
/// from exhausting the memory.
const MOST_OF_LINE: usize = 1 << 20;

/// Opens a regular file for reading. `form` describes the expected content, for error messages. Devices and pipes are
/// refused, because they may have no end or cannot be read twice.
///
/// # Errors
/// The error names the file and gives the system's message, or says that the file is a device or a pipe.
pub(crate) fn open(path: &Path, form: &str) -> Result<DraftFile> {
    let refuse = |said: &dyn std::fmt::Display| Error::unread(path, said, form);
    #[cfg(target_arch = "wasm32")]
    return crate::memory::given_file(path).map_err(|error| refuse(&error));
    #[cfg(not(target_arch = "wasm32"))]
    open_plain(path, &refuse)
}

#[cfg(not(target_arch = "wasm32"))]
fn open_plain(path: &Path, refuse: &dyn Fn(&dyn std::fmt::Display) -> Error) -> Result<DraftFile> {
    let there = std::fs::metadata(path).map_err(|error| refuse(&error))?;
    if !there.is_file() && !there.is_dir() {
        return Err(refuse(&"is a device or a pipe"));
    }
    DraftFile::open(path).map_err(|error| refuse(&error))
}

/// Reads a text file of at most `most` bytes. `form` describes the expected content, for error messages.
///
/// # Errors
/// The error names the file and gives the system's message, or says that the file is a device or a pipe, not text, or
/// too long.
pub fn read_text(path: &Path, form: &str, most: u64) -> Result<String> {
    let mut text = String::new();
    let read = open(path, form)?.take(most + 1).read_to_string(&mut text);
    if text.len() as u64 > most {
        let reason = format!("has more than {most} bytes, but must have no more");
        return Err(Error::file(path, reason));
    }
    read.map(|_| text).map_err(|error| Error::unread(path, error, form))
}

/// Wrapper of a source of bytes that limits the length of lines: reading a longer line fails.
pub(crate) struct BoundedLines<Source> {
    source: Source,
    length: usize,
}

impl<Source> BoundedLines<Source> {
    pub(crate) fn new(source: Source) -> Self {
        Self { source, length: 0 }
    }
}

impl<Source: Read> Read for BoundedLines<Source> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.source.read(bytes)?;
        self.length = match bytes[..count].iter().rposition(|&byte| byte == b'\n') {
            Some(last) => count - last - 1,
            None => self.length + count,
        };
        if self.length > MOST_OF_LINE {
            let said = format!("a line has more than {MOST_OF_LINE} bytes, but must have no more");
            return Err(io::Error::other(said));
        }
        Ok(count)
    }
}
