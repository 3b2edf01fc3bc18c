//! Checks a Parquet file before the crate `parquet` decodes it. That crate allocates as much memory and recurses as
//! deeply as the file says, so a damaged file could exhaust the memory or the stack. With these checks, decoding takes
//! at most about 200 times the file's size in memory, or 256 MiB for a small file.
//!
//! References: Thrift's compact protocol (apache/thrift, doc/specs/thrift-compact-protocol.md), and the headers of
//! Parquet in that protocol (apache/parquet-format, parquet.thrift).

use std::cell::Cell;
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

use crate::input::MOST_BYTES;

/// Largest accepted nesting depth of structures and lists in a header of a Parquet file. A valid file needs eight
/// levels.
const MOST_DEPTH: usize = 16;
/// Largest accepted ratio of the unpacked to the packed size of a page (block of data). Snappy, the only compression
/// that is accepted, writes at best 64 bytes as three.
const MOST_EXPANSION: i64 = 32;
/// Unpacked size of a page (block of data), bytes, up to which the page is always accepted, even if its packed size is
/// very small.
const SMALL_PAGE: i64 = 4096;
/// Number of rows up to which a file is always accepted, even if it has fewer bytes than rows, because columns with a
/// constant value take little space.
const FREE_ROWS: i64 = 1 << 20;
/// Parquet's numbers of two encodings that state a number of values ahead of the values: `DELTA_LENGTH_BYTE_ARRAY`
/// (stores lengths) and `DELTA_BYTE_ARRAY` (stores common prefixes). Both are refused, because the stated number is
/// inside the page (block of data) and cannot be checked here.
const COUNTED: [i64; 2] = [6, 7];

/// Result of a check. The error is the reason for refusing a file, as the rest of a sentence after the file's name.
type Checked<T> = Result<T, String>;

/// Value of a field in a header of a Parquet file, reduced to the properties that are checked.
enum FieldValue {
    Whole(i64),
    Text,
    Switch,
    List(Vec<FieldValue>),
    Fields(Vec<(i64, FieldValue)>),
    Other,
}

/// Type that the decoder expects for a field in a header, no matter which type the file states. If the two types
/// differ, the decoder loses its position and misreads all following bytes.
enum FieldShape {
    Whole,
    Text,
    Switch,
    /// Type of a field with a fixed size whose value is not checked: a single byte, or a floating-point number of eight
    /// bytes.
    Plain,
    List(&'static FieldShape),
    /// Types of the fields of a structure, in the order of their numbers from 1 on.
    Fields(&'static [FieldShape]),
    /// A field that the decoder does not know. It may have any type.
    Any,
    /// A field that is refused because no table of discs has it, such as encryption keys.
    Refused,
}

use FieldShape::{Any, Fields, List, Plain, Refused, Switch, Text, Whole};

const NONE: FieldShape = Fields(&[]);
const WHOLES: FieldShape = List(&Whole);
const TEXTS: FieldShape = List(&Text);
const PAIRS: FieldShape = List(&Fields(&[Text, Text]));
const STATISTICS: FieldShape = Fields(&[Text, Text, Whole, Whole, Text, Text, Switch, Switch]);
const DECIMAL: FieldShape = Fields(&[Whole, Whole]);
const TIME: FieldShape = Fields(&[Switch, NONE]);
const INTEGER: FieldShape = Fields(&[Plain, Switch]);
const LOGICAL: FieldShape = Fields(&[
    Any, Any, Any, Any, DECIMAL, Any, TIME, TIME, Any, INTEGER, Any, Any, Any, Any, Any, Refused,
    Refused, Refused,
]);
const SORTED: FieldShape = List(&Fields(&[Whole, Switch, Switch]));
const PAGES: FieldShape = List(&Fields(&[Whole, Whole, Whole]));
const SIZES: FieldShape = Fields(&[Whole, WHOLES, WHOLES]);
const COLUMN: FieldShape = Fields(&[
    Whole, WHOLES, TEXTS, Whole, Whole, Whole, Whole, PAIRS, Whole, Whole, Whole, STATISTICS,
    PAGES, Whole, Whole, SIZES, Refused,
]);
const CHUNKS: FieldShape =
    List(&Fields(&[Text, Whole, COLUMN, Whole, Whole, Whole, Whole, Refused, Text]));
const ROW_GROUPS: FieldShape = List(&Fields(&[CHUNKS, Whole, Whole, SORTED, Whole, Whole, Whole]));
const SCHEMA: FieldShape =
    List(&Fields(&[Whole, Whole, Whole, Text, Whole, Whole, Whole, Whole, Whole, LOGICAL]));
const FOOTER: FieldShape =
    Fields(&[Whole, SCHEMA, Whole, ROW_GROUPS, PAIRS, Text, List(&NONE), Refused, Text]);
const DATA_PAGE: FieldShape = Fields(&[Whole, Whole, Whole, Whole, STATISTICS]);
const DICTIONARY: FieldShape = Fields(&[Whole, Whole, Switch]);
const DATA_PAGE_2: FieldShape =
    Fields(&[Whole, Whole, Whole, Whole, Whole, Whole, Switch, STATISTICS]);
const PAGE_HEADER: FieldShape =
    Fields(&[Whole, Whole, Whole, Whole, DATA_PAGE, NONE, DICTIONARY, DATA_PAGE_2]);

impl FieldShape {
    /// True if a value in a header has this type. A structure fits if each of its fields occurs only once, and if each
    /// field that the decoder knows has the type that the decoder expects.
    fn fits(&self, value: &FieldValue) -> bool {
        match (self, value) {
            (Any, _)
            | (Whole, FieldValue::Whole(_))
            | (Text, FieldValue::Text)
            | (Switch, FieldValue::Switch)
            | (Plain, FieldValue::Other) => true,
            (List(shape), FieldValue::List(items)) => items.iter().all(|item| shape.fits(item)),
            (Fields(shapes), FieldValue::Fields(fields)) => {
                let mut seen = BTreeSet::new();
                fields.iter().all(|(id, value)| {
                    let place = id.checked_sub(1).and_then(|place| usize::try_from(place).ok());
                    let shape = place.and_then(|place| shapes.get(place)).unwrap_or(&Any);
                    seen.insert(id) && shape.fits(value)
                })
            }
            _ => false,
        }
    }
}

impl FieldValue {
    fn field(&self, wanted: i64) -> Option<&Self> {
        let Self::Fields(fields) = self else { return None };
        fields.iter().find(|(id, _)| *id == wanted).map(|(_, value)| value)
    }

    fn whole(&self, wanted: i64) -> Option<i64> {
        if let Some(Self::Whole(number)) = self.field(wanted) { Some(*number) } else { None }
    }
}

/// Reader of values in Thrift's compact protocol. It contains the bytes that are not read yet.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn byte(&mut self) -> Checked<u8> {
        let (first, rest) = self.0.split_first().ok_or("ends within a header")?;
        self.0 = rest;
        Ok(*first)
    }

    fn skip(&mut self, count: u64) -> Checked<()> {
        let rest = usize::try_from(count).ok().and_then(|count| self.0.get(count..));
        self.0 = rest.ok_or("ends within a header")?;
        Ok(())
    }

    fn varint(&mut self) -> Checked<u64> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(number);
            }
        }
        Err("has a number of more than 64 bits".into())
    }

    fn whole(&mut self) -> Checked<i64> {
        let number = self.varint()?;
        Ok((number >> 1) as i64 ^ -((number & 1) as i64))
    }

    fn structure(&mut self, depth: usize) -> Checked<FieldValue> {
        let below = depth_below(depth)?;
        let (mut fields, mut id) = (Vec::new(), 0_i64);
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Ok(FieldValue::Fields(fields));
            }
            if head & 15 == 0 {
                return Err("has a header of kind 0".into());
            }
            id = if head >> 4 == 0 { self.whole()? } else { id.wrapping_add(i64::from(head >> 4)) };
            // A Boolean field has no bytes of its own: its type states whether it is true or false.
            let value =
                if head & 15 < 3 { FieldValue::Switch } else { self.value(head & 15, below)? };
            fields.push((id, value));
        }
    }

    fn value(&mut self, kind: u8, depth: usize) -> Checked<FieldValue> {
        match kind {
            1..=3 => self.byte().map(|_| FieldValue::Other),
            4..=6 => self.whole().map(FieldValue::Whole),
            7 => self.skip(8).map(|()| FieldValue::Other),
            8 => {
                let length = self.varint()?;
                self.skip(length).map(|()| FieldValue::Text)
            }
            9 | 10 => self.list(depth),
            12 => self.structure(depth),
            _ => Err(format!("has a header of kind {kind}")),
        }
    }

    fn list(&mut self, depth: usize) -> Checked<FieldValue> {
        let below = depth_below(depth)?;
        let head = self.byte()?;
        let count = if head >> 4 == 15 { self.varint()? } else { u64::from(head >> 4) };
        if count > self.0.len() as u64 {
            return Err(format!("has a list of {count} in {} bytes", self.0.len()));
        }
        (0..count)
            .map(|_| self.value(head & 15, below))
            .collect::<Checked<_>>()
            .map(FieldValue::List)
    }
}

/// Returns the number of nesting levels that remain for the contents of a structure or list, which itself takes one of
/// `depth` levels. Fails if `depth` is 0.
fn depth_below(depth: usize) -> Checked<usize> {
    depth.checked_sub(1).ok_or_else(|| format!("has headers nested deeper than {MOST_DEPTH}"))
}

/// Checks the footer of a Parquet file, the metadata at its end. `bytes` is the size of the whole file, bytes.
pub(super) fn check_footer(footer: &[u8], bytes: u64) -> Checked<()> {
    let footer = Reader(footer).structure(MOST_DEPTH)?;
    check_shape(&FOOTER, &footer)?;
    let Some(FieldValue::List(schema)) = footer.field(2) else {
        return Err("has no schema".into());
    };
    // For each open group of columns, the number of its members that have not been listed yet.
    let mut open: Vec<i64> = vec![1];
    for element in schema {
        while open.last() == Some(&0) {
            open.pop();
        }
        let last = open.last_mut().ok_or("has more columns than its schema")?;
        *last -= 1;
        let children = element.whole(5).unwrap_or(0);
        if !(0..schema.len() as i64).contains(&children) {
            return Err(format!(
                "has a group of {children} columns in a schema of {}",
                schema.len()
            ));
        }
        open.push(children);
        if open.len() > MOST_DEPTH {
            return Err(format!("has columns nested deeper than {MOST_DEPTH}"));
        }
    }
    if open.iter().any(|&left| left > 0) {
        return Err("has fewer columns than its schema".into());
    }
    let most = FREE_ROWS.max(i64::try_from(bytes).unwrap_or(i64::MAX));
    match footer.whole(3) {
        Some(rows) if rows <= most => Ok(()),
        Some(rows) => Err(format!("has {rows} rows in {bytes} bytes")),
        None => Err("has no number of rows".into()),
    }
}

fn check_shape(shape: &FieldShape, header: &FieldValue) -> Checked<()> {
    let refuse = || "has a header with a field of another kind than it is of".to_owned();
    shape.fits(header).then_some(()).ok_or_else(refuse)
}

/// Checks all pages (blocks of data) of a column. `bytes` is the section of the file with these pages.
pub(super) fn check_pages(bytes: &[u8]) -> Checked<()> {
    let mut rest = Reader(bytes);
    while !rest.0.is_empty() {
        let header = rest.structure(MOST_DEPTH)?;
        check_shape(&PAGE_HEADER, &header)?;
        let (Some(unpacked), Some(packed)) = (header.whole(2), header.whole(3)) else {
            return Err("has a page without its size".into());
        };
        rest.skip(u64::try_from(packed).unwrap_or(u64::MAX))?;
        let most = (packed.saturating_mul(MOST_EXPANSION) + SMALL_PAGE).min(MOST_BYTES as i64);
        if !(0..=most).contains(&unpacked) {
            return Err(format!("has a page of {unpacked} bytes packed into {packed}"));
        }
        let listed = header.field(7).and_then(|dictionary| dictionary.whole(1)).unwrap_or(0);
        if !(0..=unpacked).contains(&listed) {
            return Err(format!("has a dictionary of {listed} values in {unpacked} bytes"));
        }
        let encoding = |page: i64, field| header.field(page).and_then(|page| page.whole(field));
        if [encoding(5, 2), encoding(8, 4)].into_iter().flatten().any(|it| COUNTED.contains(&it)) {
            return Err("is encoded by lengths or by common beginnings".into());
        }
    }
    Ok(())
}

thread_local! {
    /// True while a panic of the crate `parquet` is to be caught without a message.
    static IS_CAUGHT: Cell<bool> = const { Cell::new(false) };
}

/// Calls a function that may panic on a damaged file, and turns the panic into an error.
pub(super) fn caught<T>(act: impl FnOnce() -> T) -> Checked<T> {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| {
        let before = take_hook();
        set_hook(Box::new(move |panic| {
            if !IS_CAUGHT.get() {
                before(panic);
            }
        }));
    });
    IS_CAUGHT.set(true);
    // After a panic no result is returned, so no inconsistent state can be seen.
    let done = catch_unwind(AssertUnwindSafe(act));
    IS_CAUGHT.set(false);
    done.map_err(|_| "is damaged".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_within_lists_are_refused_before_the_stack_ends() {
        // A list that contains a list, and so on, to a depth of thousands.
        let footer = [0x19; 20_000];
        let said = check_footer(&footer, 20_000);
        assert_eq!(said, Err(format!("has headers nested deeper than {MOST_DEPTH}")));
    }

    #[test]
    fn fields_that_nobody_knows_are_looked_at_once_each() {
        // The bytes of a structure of Boolean fields whose field numbers are distinct, from 100 on.
        let header = |fields: usize| [&[0x01, 200, 1][..], &vec![0x11_u8; fields]].concat();
        let secs = |fields: usize| {
            let footer = [&header(fields)[..], &[0]].concat();
            let look = || {
                let begun = std::time::Instant::now();
                assert_eq!(check_footer(&footer, 200_000), Err("has no schema".into()));
                begun.elapsed().as_secs_f64()
            };
            (0..5).map(|_| look()).fold(f64::INFINITY, f64::min)
        };
        // With 16 times the fields, the time grows about 16-fold, not 256-fold.
        let ratio = secs(64_000) / secs(4_000);
        assert!(ratio < 80.0, "16 times the fields took {ratio} times the time");
        let twice = check_footer(&[&header(100)[..], &[0x01, 200, 1, 0]].concat(), 200_000);
        assert!(
            twice.is_err_and(|said| said.contains("of another kind")),
            "a field that is there twice"
        );
    }
}
