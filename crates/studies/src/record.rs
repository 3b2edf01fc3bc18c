//! Lines and files that tell whether they are what was once written: each with a checksum of its own.

/// Hexadecimal digits of a checksum: 64 bits, far more than damage needs.
const DIGITS: usize = 16;
const BEFORE: &str = "{\"checksum\":\"";
const BETWEEN: &str = "\",\"record\":";
/// What stands before the checksum at the end of a file whose comments begin with `#`.
const COMMENT: &str = "# checksum ";

/// The checksum of some bytes.
pub(super) fn checksum(text: &[u8]) -> String {
    blake3::hash(text).to_hex()[..DIGITS].to_owned()
}

/// A line of JSON around a record that is JSON.
pub(super) fn sealed_line(record: &str) -> String {
    format!("{BEFORE}{}{BETWEEN}{record}}}\n", checksum(record.as_bytes()))
}

/// The record of a line without its end; nothing where it is damaged.
pub(super) fn of_line(line: &[u8]) -> Option<&str> {
    let rest = str::from_utf8(line).ok()?.strip_prefix(BEFORE)?;
    let (found, rest) = rest.split_at_checked(DIGITS)?;
    let record = rest.strip_prefix(BETWEEN)?.strip_suffix('}')?;
    (checksum(record.as_bytes()) == found).then_some(record)
}

/// A text with its checksum as a last line, a comment.
pub(super) fn sealed_text(text: &str) -> String {
    format!("{text}{COMMENT}{}\n", checksum(text.as_bytes()))
}

/// The text that was sealed; nothing where it is damaged.
pub(super) fn of_text(bytes: &[u8]) -> Option<&str> {
    let (text, found) = str::from_utf8(bytes).ok()?.rsplit_once(COMMENT)?;
    (checksum(text.as_bytes()) == found.strip_suffix('\n')?).then_some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_flipped_bit_goes_unseen() {
        let line = sealed_line("{\"key\":\"ab\",\"slump\":0.25}");
        let line = line.trim_end().as_bytes();
        let text = sealed_text("# A state.\nx,y,radius\n1,2,3\n");
        assert_eq!(of_line(line), Some("{\"key\":\"ab\",\"slump\":0.25}"));
        assert_eq!(of_text(text.as_bytes()), Some("# A state.\nx,y,radius\n1,2,3\n"));
        let flipped = |bytes: &[u8], bit: usize| {
            let mut bytes = bytes.to_vec();
            bytes[bit / 8] ^= 1 << (bit % 8);
            bytes
        };
        for bit in 0..8 * line.len() {
            assert_eq!(of_line(&flipped(line, bit)), None, "bit {bit}");
        }
        for bit in 0..8 * text.len() {
            assert_eq!(of_text(&flipped(text.as_bytes(), bit)), None, "bit {bit}");
        }
        for end in 0..text.len() {
            assert_eq!(of_text(&text.as_bytes()[..end]), None, "cut at {end}");
        }
    }
}
