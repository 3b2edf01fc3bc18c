//! Files that this program alone reads: a line, and what it tells of.
//!
//! > ⟨magic⟩ ⟨format⟩ ⟨version of the program⟩ ⟨bytes that follow⟩ ⟨their BLAKE3 checksum⟩
//!
//! What follows is MessagePack with the names of all fields. Nothing of it is looked at before the
//! checksum is found to be its own, and nothing of another version ever: what a number means, and what the
//! next step makes of it, may differ.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::{Error, Result};
use crate::input::open;

const VERSION: &str = env!("CARGO_PKG_VERSION");
/// No first line is longer.
const MOST_OF_LINE: u64 = 256;
/// Of a file that is not what was once written.
const DAMAGED: &str = "is damaged: its checksum is not that of its content, but must be, as it was when it was written";

/// What files of one kind begin with, and how messages call them.
pub struct Seal {
    /// The first word and the space after it.
    pub magic: &'static str,
    /// Counts the changes of what is in a file, or of what it means, within a version of the program.
    pub format: u32,
    /// What a file holds, in a word.
    pub what: &'static str,
    /// What it is of, after that word.
    pub of: &'static str,
    /// What a file must be.
    pub form: &'static str,
}

impl Seal {
    /// The bytes of a file. The same content is the same bytes.
    ///
    /// # Errors
    /// Where it cannot be put into bytes.
    pub fn written(&self, content: &impl Serialize) -> Result<Vec<u8>> {
        let refuse = |error| Error::value(self.what, "there", format!("written ({error})"));
        let content = rmp_serde::to_vec_named(content).map_err(refuse)?;
        Ok([self.first_line(&content).as_bytes(), &content].concat())
    }

    /// What is in a file.
    ///
    /// # Errors
    /// Where it cannot be read, is damaged or of another version, or is no such file.
    pub fn open<T: DeserializeOwned>(&self, path: &Path) -> Result<T> {
        self.read(BufReader::new(open(path, self.form)?), path)
    }

    /// True if a file is one of these, of whatever version.
    pub(crate) fn is_on(&self, path: &Path) -> bool {
        let mut start = vec![0; self.magic.len()];
        let read = open(path, self.form).map(|mut file| file.read_exact(&mut start));
        read.is_ok_and(|read| read.is_ok()) && start == self.magic.as_bytes()
    }

    /// The same of what is at hand; `path` is for messages.
    pub(crate) fn read<T: DeserializeOwned>(
        &self,
        mut file: impl BufRead,
        path: &Path,
    ) -> Result<T> {
        let unread = |error| Error::unread(path, error, self.form);
        let mut line = Vec::new();
        file.by_ref().take(MOST_OF_LINE).read_until(b'\n', &mut line).map_err(unread)?;
        let length = self.length_of_content(&line).map_err(|reason| Error::file(path, reason))?;
        // No more than a byte too many is read, and no more room taken than there are bytes.
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
            // Of what is not known, the list of all that is would be longer than all else.
            let said = error.to_string();
            let error = said.split(", expected one of").next().unwrap_or(&said);
            let Self { what, form, .. } = self;
            let reason = format!("holds no {what} of this layout ({error}), but must be {form}");
            Error::file(path, format!("{reason} with this very program"))
        })
    }

    /// The first line of a file with that content.
    fn first_line(&self, content: &[u8]) -> String {
        let (length, checksum) = (content.len(), blake3::hash(content));
        format!("{}{} {VERSION} {length} {checksum}\n", self.magic, self.format)
    }

    /// How many bytes follow a first line; or, as the rest of a sentence, why it is none of this version.
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
