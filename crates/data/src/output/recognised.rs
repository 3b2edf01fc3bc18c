//! Recognises the files that Slump wrote. It compares the first bytes of a file, because the name of a file, or a list
//! of files that anyone can edit, is not sufficient evidence for removing a file.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use super::files::final_name;
use crate::error::{Error, Result};

/// Number of bytes at the beginning of a file that are searched for signs that Slump wrote it. They include the
/// description of its run, if the file has one.
const MOST_OF_HEAD: u64 = 1 << 20;
/// Number of bytes at the end of a Parquet file that are searched for the name of the program that wrote it.
const TAIL: u64 = 4096;

/// First bytes of a line in the journal of a study (a list of runs). The journal is the file that lists the finished
/// runs.
const OF_JOURNAL: &[u8] = b"{\"checksum\":\"";
/// Pairs of byte strings that identify files that Slump writes. A file begins with the first string. The second string
/// must also occur near the beginning of the file; it is empty if the first string is sufficient.
const BEGINNINGS: [(&[u8], &[u8]); 13] = [
    (b"\x89PNG\r\n\x1a\n", b"tEXtSoftware\0slump "),
    (b"{\n  \"program\": \"slump\",\n", b""),
    (b"{\n  \"about\": {\n", b"\n  \"program\": \"slump\",\n"),
    (b"{\n  \"study\": ", b"\n  \"fingerprint\": "),
    (OF_JOURNAL, b""),
    (b"run,key,", b""),
    (b"step,time,time_step,", b""),
    (b"# ", b"# column step: "),
    (b"ITEM: UNITS\nsi\nITEM: PARAMETERS\n", b""),
    (b"ITEM: TIMESTEP\n", b" x_unwrapped y_unwrapped "),
    (b"ITEM: TIME\n", b"\nITEM: ENTRIES id name motion "),
    (b"slump-state ", b""),
    (
        b"<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" \
            header_type=\"UInt64\">\n  <ImageData WholeExtent=\"",
        b" Name=\"smoothing_width\" ",
    ),
];
/// First bytes of VTK files that Slump writes. The strings are long, so that files of other programs do not match by
/// chance: no field of VTK files names the program that wrote them.
const OF_VTK: [&[u8]; 2] = [
    b"<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" \
        byte_order=\"LittleEndian\">\n<Collection>\n",
    b"<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
        header_type=\"UInt64\">\n  <PolyData>\n    <FieldData>\n      <DataArray type=\"Int64\" Name=\"step\" ",
];
/// Bytes 8 to 15 of a file that collects states of a run until they are drawn as pictures at the end of the run. Bytes
/// 0 to 7 are the length of the first state.
const STATE: &[u8] = b"\x82\xa6number";

/// True if the content shows that Slump wrote the file, even if the file was cut because the program was killed. A
/// blank file also counts, because nobody loses anything if it is removed.
///
/// # Errors
/// If the file cannot be read.
pub fn is_recognised(path: &Path) -> Result<bool> {
    recognised(path).map_err(|error| Error::file(path, error))
}

fn recognised(path: &Path) -> std::io::Result<bool> {
    let mut file = File::open(path)?;
    let (mut head, mut tail) = (Vec::new(), Vec::new());
    file.by_ref().take(MOST_OF_HEAD).read_to_end(&mut head)?;
    let begins = |beginning: &[u8]| {
        let length = beginning.len().min(head.len());
        head[..length] == beginning[..length]
    };
    let has = |bytes: &[u8], part: &[u8]| {
        part.is_empty() || bytes.windows(part.len()).any(|it| it == part)
    };
    let is_left = path
        .file_name()
        .and_then(|name| name.to_str())
        .is_some_and(|name| final_name(name) != name);
    if head.starts_with(b"PAR1") {
        file.seek(SeekFrom::Start(file.metadata()?.len().saturating_sub(TAIL)))?;
        file.read_to_end(&mut tail)?;
        return Ok(is_left || has(&tail, b"slump "));
    }
    let is_of_lines = head.split(|&byte| byte == b'\n').any(|line| line.starts_with(OF_JOURNAL));
    let is_blank = head.iter().all(u8::is_ascii_whitespace);
    Ok(is_blank
        || is_of_lines
        || BEGINNINGS
            .iter()
            .any(|(beginning, part)| begins(beginning) && (is_left || has(&head, part)))
        || OF_VTK.into_iter().any(begins)
        || head.get(8..).is_some_and(|state| state.starts_with(STATE)))
}

/// Fails if a file that is to be removed or overwritten was not written by Slump. `option` is the name of the
/// command-line option that allows the removal, for the error message.
///
/// # Errors
/// The error names the file.
pub fn check_recognised(path: &Path, option: &str) -> Result<()> {
    if is_recognised(path)? {
        return Ok(());
    }
    let reason = format!(
        "is not as this program writes such files, but must be where --{option} is to remove it"
    );
    Err(Error::file(path, reason))
}
