//! The values of an array: as text, as base64 or raw, compressed or not.
//!
//! Uncompressed, a length in bytes stands ahead of the values. Compressed, there stand ahead of the blocks
//! their number, the length that each but the last has when it is unpacked, that of the last if it differs,
//! and of each its packed length. In base64 lengths and blocks are encoded apart, length and values that
//! are not compressed together.

use std::io::Read;

use base64::Engine as _;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use flate2::read::ZlibDecoder;

use super::Said;
use super::xml::{DataArray, Document};

/// The only compressor that is known here, and VTK's own choice.
const ZLIB: &str = "vtkZLibDataCompressor";

/// What is asked for may end within a run of characters.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// The numbers of an array; or what is amiss.
pub(in crate::data) fn values(document: &Document<'_>, array: &DataArray) -> Said<Vec<f64>> {
    if array.format == "ascii" {
        let number =
            |word: &str| word.parse().map_err(|_| format!("says '{word}', which is no number"));
        return array.text.split_ascii_whitespace().map(number).collect();
    }
    let bytes = bytes(document, array)?;
    let swap = document.is_big_endian();
    macro_rules! of {
        ($kind:ty) => {
            numbers(&bytes, swap, |bytes| <$kind>::from_le_bytes(bytes) as f64)
        };
    }
    match array.kind.as_str() {
        "Float64" => of!(f64),
        "Float32" => of!(f32),
        "Int64" => of!(i64),
        "UInt64" => of!(u64),
        "Int32" => of!(i32),
        "UInt32" => of!(u32),
        "Int16" => of!(i16),
        "UInt16" => of!(u16),
        "Int8" => of!(i8),
        "UInt8" => of!(u8),
        kind => Err(format!("is of the type {kind}, but must be of numbers")),
    }
}

fn numbers<const SIZE: usize>(
    bytes: &[u8],
    swap: bool,
    number: impl Fn([u8; SIZE]) -> f64,
) -> Said<Vec<f64>> {
    let (whole, rest) = bytes.as_chunks::<SIZE>();
    if !rest.is_empty() {
        return Err(format!("has {} bytes, but must have {SIZE} a number", bytes.len()));
    }
    let in_order = whole.iter().map(|&(mut bytes)| {
        if swap {
            bytes.reverse();
        }
        number(bytes)
    });
    Ok(in_order.collect())
}

/// The words of an array; or what is amiss.
pub(in crate::data) fn words(document: &Document<'_>, array: &DataArray) -> Said<Vec<String>> {
    let bytes =
        bytes(document, array).map_err(|said| format!("the array {} {said}", array.name))?;
    let text = String::from_utf8_lossy(&bytes);
    Ok(text.split_terminator('\0').map(str::to_owned).collect())
}

/// The bytes of an array; or what is amiss.
fn bytes(document: &Document<'_>, array: &DataArray) -> Said<Vec<u8>> {
    let (data, is_base64) = match array.format.as_str() {
        "appended" => {
            let (data, is_base64) = document.appended.ok_or("has no appended data")?;
            (data.get(array.offset..).ok_or("begins behind the end of the file")?, is_base64)
        }
        "binary" => (array.text.trim().as_bytes(), true),
        "ascii" => return Err("is text".into()),
        format => {
            return Err(format!(
                "has the format '{format}', but must be ascii, binary or appended"
            ));
        }
    };
    let size = document.length_size();
    let source = Source { data, is_base64, size, is_big_endian: document.is_big_endian() };
    let bytes = match document.compressor() {
        None => source.unpacked(),
        Some(ZLIB) => source.packed()?,
        Some(other) => {
            return Err(format!(
                "is compressed with {other}, but must be with {ZLIB} or not at all"
            ));
        }
    };
    bytes.ok_or_else(|| "is cut off".to_owned())
}

/// Where the bytes of an array come from.
struct Source<'a> {
    data: &'a [u8],
    is_base64: bool,
    /// Bytes of a length.
    size: usize,
    is_big_endian: bool,
}

impl Source<'_> {
    /// Bytes that are not compressed; none where they are cut off.
    fn unpacked(&self) -> Option<Vec<u8>> {
        let length = *self.lengths(1)?.first()?;
        let mut bytes = self.decoded(0, self.size.checked_add(length)?)?;
        bytes.drain(..self.size);
        Some(bytes)
    }

    /// Bytes in compressed blocks; none where they are cut off, or what is amiss.
    fn packed(&self) -> Said<Option<Vec<u8>>> {
        let Some((packed, lengths)) = self.blocks() else { return Ok(None) };
        let mut rest = &packed[..];
        let mut bytes = Vec::new();
        for length in lengths {
            // They are as long as all lengths together.
            let (block, later) = rest.split_at(length);
            let unpacked = ZlibDecoder::new(block).read_to_end(&mut bytes);
            unpacked.map_err(|error| format!("is not packed by zlib ({error})"))?;
            rest = later;
        }
        Ok(Some(bytes))
    }

    /// Compressed blocks one after the other, and the length of each.
    fn blocks(&self) -> Option<(Vec<u8>, Vec<usize>)> {
        let count = *self.lengths(1)?.first()?;
        if count == 0 {
            return Some((Vec::new(), Vec::new()));
        }
        // Behind the count, the lengths of unpacked blocks.
        let before = 3;
        let head = self.lengths(count.checked_add(before)?)?;
        let lengths = head.get(before..)?.to_vec();
        let total = lengths.iter().try_fold(0usize, |sum, &length| sum.checked_add(length))?;
        let behind_head = self.encoded_size(head.len() * self.size);
        Some((self.decoded(behind_head, total)?, lengths))
    }

    /// The lengths that stand in front.
    fn lengths(&self, count: usize) -> Option<Vec<usize>> {
        let bytes = self.decoded(0, count.checked_mul(self.size)?)?;
        let length = |bytes: &[u8]| {
            let mut length = [0; 8];
            length[..self.size].copy_from_slice(bytes);
            if self.is_big_endian {
                length[..self.size].reverse();
            }
            usize::try_from(u64::from_le_bytes(length)).ok()
        };
        bytes.chunks_exact(self.size).map(length).collect()
    }

    /// As many bytes from a place of the data on.
    fn decoded(&self, from: usize, count: usize) -> Option<Vec<u8>> {
        let encoded = self.data.get(from..)?.get(..self.encoded_size(count))?;
        if !self.is_base64 {
            return Some(encoded.to_vec());
        }
        let mut bytes = BASE64.decode(encoded).ok()?;
        bytes.truncate(count);
        (bytes.len() == count).then_some(bytes)
    }

    /// How much of the data that many bytes take.
    fn encoded_size(&self, count: usize) -> usize {
        if self.is_base64 { count.div_ceil(3).saturating_mul(4) } else { count }
    }
}
