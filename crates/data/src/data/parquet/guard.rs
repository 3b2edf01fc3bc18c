//! What a Parquet file says of itself, looked at before it is decoded: what the crate takes room for, or calls itself for,
//! on no more than a file's word. A file takes no more memory than some 200 times its size, or 256 MiB where it is small.
//!
//! Thrift's compact protocol (apache/thrift, doc/specs/thrift-compact-protocol.md) and what of it Parquet's headers are
//! (apache/parquet-format, parquet.thrift).

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

use crate::input::MOST_BYTES;

/// Structures within structures, of which a file needs six.
const MOST_DEPTH: usize = 16;
/// Snappy writes 64 bytes as three, at best.
const MOST_EXPANSION: i64 = 32;
/// Bytes of a page that need no reason.
const SMALL_PAGE: i64 = 4096;
/// Rows that are read of a file that has not as many bytes: of a column that is the same everywhere a file says little.
const FREE_ROWS: i64 = 1 << 20;
/// Encodings that say before their values how many there are: by lengths, and by common beginnings.
const COUNTED: [i64; 2] = [6, 7];

/// Why a file is not decoded, as the rest of a sentence.
type Checked<T> = Result<T, String>;

/// A value, as far as it matters here.
enum Value {
    Whole(i64),
    List(Vec<Value>),
    Fields(Vec<(i64, Value)>),
    Other,
}

impl Value {
    fn field(&self, wanted: i64) -> Option<&Self> {
        let Self::Fields(fields) = self else { return None };
        fields.iter().find(|(id, _)| *id == wanted).map(|(_, value)| value)
    }

    fn whole(&self, wanted: i64) -> Option<i64> {
        if let Some(Self::Whole(number)) = self.field(wanted) { Some(*number) } else { None }
    }
}

/// Bytes that are read from the front.
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

    fn structure(&mut self, depth: usize) -> Checked<Value> {
        if depth == 0 {
            return Err(format!("has headers nested deeper than {MOST_DEPTH}"));
        }
        let (mut fields, mut id) = (Vec::new(), 0_i64);
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Ok(Value::Fields(fields));
            }
            id = if head >> 4 == 0 { self.whole()? } else { id.wrapping_add(i64::from(head >> 4)) };
            // Whether it is so is in the kind.
            let value = if head & 15 < 3 { Value::Other } else { self.value(head & 15, depth)? };
            fields.push((id, value));
        }
    }

    fn value(&mut self, kind: u8, depth: usize) -> Checked<Value> {
        match kind {
            1..=3 => self.byte().map(|_| Value::Other),
            4..=6 => self.whole().map(Value::Whole),
            7 => self.skip(8).map(|()| Value::Other),
            8 => {
                let length = self.varint()?;
                self.skip(length).map(|()| Value::Other)
            }
            9 | 10 => self.list(depth),
            12 => self.structure(depth - 1),
            _ => Err(format!("has a header of kind {kind}")),
        }
    }

    fn list(&mut self, depth: usize) -> Checked<Value> {
        let head = self.byte()?;
        let count = if head >> 4 == 15 { self.varint()? } else { u64::from(head >> 4) };
        if count > self.0.len() as u64 {
            return Err(format!("has a list of {count} in {} bytes", self.0.len()));
        }
        (0..count).map(|_| self.value(head & 15, depth)).collect::<Checked<_>>().map(Value::List)
    }
}

/// Looks at the footer of a file of so many bytes.
pub(super) fn check_footer(footer: &[u8], bytes: u64) -> Checked<()> {
    let footer = Reader(footer).structure(MOST_DEPTH)?;
    let Some(Value::List(schema)) = footer.field(2) else { return Err("has no schema".into()) };
    // Children that are still to come, of each group that the element is in.
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
        Some(rows) if rows > most => Err(format!("has {rows} rows in {bytes} bytes")),
        _ => Ok(()),
    }
}

/// Looks at all pages of a column; `bytes` are those of the column in the file.
pub(super) fn check_pages(bytes: &[u8]) -> Checked<()> {
    let mut rest = Reader(bytes);
    while !rest.0.is_empty() {
        let header = rest.structure(MOST_DEPTH)?;
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
    /// True while what panics is the crate's own affair.
    static IS_CAUGHT: Cell<bool> = const { Cell::new(false) };
}

/// Does what may panic on a file that is damaged, and says so where it does.
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
    // What is half done is dropped.
    let done = catch_unwind(AssertUnwindSafe(act));
    IS_CAUGHT.set(false);
    done.map_err(|_| "is damaged".to_owned())
}
