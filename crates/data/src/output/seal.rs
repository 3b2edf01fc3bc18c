//! Writes and reads files that only Slump reads: one line that describes the content, followed by the content.
//!
//! > ⟨magic⟩ ⟨format⟩ ⟨version of the program⟩ ⟨bytes that follow⟩ ⟨their BLAKE3 checksum⟩
//!
//! The content is MessagePack with the names of all fields. It is parsed only after its checksum has been verified. A
//! file of another version of Slump is never parsed, because the meaning of a number or the result of the next step may
//! differ.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::{Error, Result};
use crate::input::open;

const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Largest number of bytes that are read to find the end of a file's first line. All first lines that Slump writes are
/// shorter.
const MOST_OF_LINE: u64 = 256;
/// Error message for a file whose content does not match its checksum.
const DAMAGED: &str = "is damaged: its checksum is not that of its content, but must be, as it was when it was written";

/// Header of a type of file that only Slump reads, and the words by which error messages name a file of this type.
pub struct Seal {
    /// The first word of the file and the space after it.
    pub magic: &'static str,
    /// Number of the format. It is increased if the content of a file or its meaning changes while the version of the
    /// program remains the same.
    pub format: u32,
    /// One word for the content of a file in messages, such as `state`.
    pub what: &'static str,
    /// Text that follows the word `what` in messages, such as ` of a run`.
    pub of: &'static str,
    /// Description of a valid file, for error messages.
    pub form: &'static str,
}

impl Seal {
    /// Returns the bytes of a file with the given content. Equal content gives equal bytes.
    ///
    /// # Errors
    /// If the content cannot be serialised.
    pub fn written(&self, content: &impl Serialize) -> Result<Vec<u8>> {
        let refuse = |error| Error::value(self.what, "there", format!("written ({error})"));
        let content = rmp_serde::to_vec_named(content).map_err(refuse)?;
        Ok([self.first_line(&content).as_bytes(), &content].concat())
    }

    /// Reads the content of a file.
    ///
    /// # Errors
    /// If the file cannot be read, is damaged, is of another version, or does not have this header.
    pub fn open<T: DeserializeOwned>(&self, path: &Path) -> Result<T> {
        self.read(BufReader::new(open(path, self.form)?), path)
    }

    /// True if a file has this header, written by any version of Slump.
    pub(crate) fn is_on(&self, path: &Path) -> bool {
        let mut start = vec![0; self.magic.len()];
        let read = open(path, self.form).map(|mut file| file.read_exact(&mut start));
        read.is_ok_and(|read| read.is_ok()) && start == self.magic.as_bytes()
    }

    /// Reads the content of a file from an open source. `path` is for error messages.
    pub(crate) fn read<T: DeserializeOwned>(
        &self,
        mut file: impl BufRead,
        path: &Path,
    ) -> Result<T> {
        let unread = |error| Error::unread(path, error, self.form);
        let mut line = Vec::new();
        file.by_ref().take(MOST_OF_LINE).read_until(b'\n', &mut line).map_err(unread)?;
        let length = self.length_of_content(&line).map_err(|reason| Error::file(path, reason))?;
        // Reads at most one byte too many, and never allocates more memory than the file needs.
        let mut content = Vec::new();
        file.take(length.saturating_add(1)).read_to_end(&mut content).map_err(unread)?;
        if (content.len() as u64) < length {
            let found = content.len();
            let reason = format!("has been cut: {found} bytes are left, but must be all {length}");
            return Err(Error::file(path, reason));
        }
        if self.first_line(&content).as_bytes() != line {
            return Err(Error::file(path, DAMAGED));
        }
        rmp_serde::from_slice(&content).map_err(|error| {
            // The list of all known names is left out, because it would be longer than the rest of the message.
            let said = error.to_string();
            let error = said.split(", expected one of").next().unwrap_or(&said);
            let Self { what, form, .. } = self;
            let reason = format!("holds no {what} of this layout ({error}), but must be {form}");
            Error::file(path, format!("{reason} with this very program"))
        })
    }

    /// Returns the first line of a file with the given content.
    fn first_line(&self, content: &[u8]) -> String {
        let (length, checksum) = (content.len(), blake3::hash(content));
        format!("{}{} {VERSION} {length} {checksum}\n", self.magic, self.format)
    }

    /// Returns the number of bytes that follow the first line `line` of a file. The error says why the line is not
    /// valid in this version, as the rest of a sentence that begins with the file's name.
    fn length_of_content(&self, line: &[u8]) -> std::result::Result<u64, String> {
        let Self { magic, what, of, form, .. } = self;
        let Some(said) = line.strip_prefix(magic.as_bytes()) else {
            return Err(format!("holds no {what}{of}, but must be {form}"));
        };
        let said = str::from_utf8(said).ok().and_then(|said| said.strip_suffix('\n'));
        let said: Vec<&str> = said.ok_or(DAMAGED)?.split(' ').collect();
        let [format, version, length, _] = said[..] else { return Err(DAMAGED.to_owned()) };
        let expected = self.format;
        if (format, version) != (&*expected.to_string(), VERSION) {
            return Err(format!(
                "is of version {version} of the program, format {format}, but must be of the one that reads \
                 it, version {VERSION}, format {expected}: others may step otherwise"
            ));
        }
        length.parse().map_err(|_| DAMAGED.to_owned())
    }
}
