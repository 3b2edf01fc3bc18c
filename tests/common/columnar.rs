//! Writes small Parquet files in which a test can make each number of the metadata wrong.

#![allow(dead_code, unused_imports, reason = "every test binary uses its own part of this")]

/// A structure (list of numbered fields) in Thrift's compact protocol, the encoding of Parquet's metadata.
#[derive(Default)]
struct Fields {
    bytes: Vec<u8>,
    last: u8,
}

fn varint(bytes: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}

impl Fields {
    fn head(mut self, id: u8, kind: u8) -> Self {
        self.bytes.push((id - self.last) << 4 | kind);
        self.last = id;
        self
    }

    fn whole(mut self, id: u8, number: i64) -> Self {
        // The encodings of i64 (type 6) and i32 (type 5) differ only in the type number.
        self = self.head(id, if i32::try_from(number).is_ok() { 5 } else { 6 });
        varint(&mut self.bytes, ((number << 1) ^ (number >> 63)) as u64);
        self
    }

    fn long(mut self, id: u8, number: i64) -> Self {
        self = self.head(id, 6);
        varint(&mut self.bytes, ((number << 1) ^ (number >> 63)) as u64);
        self
    }

    fn word(mut self, id: u8, word: &str) -> Self {
        self = self.head(id, 8);
        varint(&mut self.bytes, word.len() as u64);
        self.bytes.extend(word.as_bytes());
        self
    }

    fn list(mut self, id: u8, kind: u8, count: u64, items: &[u8]) -> Self {
        self = self.head(id, 9);
        self.bytes.push(0xf0 | kind);
        varint(&mut self.bytes, count);
        self.bytes.extend(items);
        self
    }

    fn inner(mut self, id: u8, fields: Self) -> Self {
        self = self.head(id, 12);
        self.bytes.extend(fields.end());
        self
    }

    fn end(mut self) -> Vec<u8> {
        self.bytes.push(0);
        self.bytes
    }
}

/// Numbers that [`Columnar::bytes`] writes into a Parquet file of three columns (x, y, radius). The default numbers
/// make a correct file; with other numbers the metadata are wrong.
#[derive(Clone, Debug)]
pub struct Columnar {
    /// Number of rows of the file according to its metadata.
    pub rows: i64,
    /// Number of rows of the file's only row group according to the metadata.
    pub group_rows: i64,
    /// Number of values in the data page of each column according to the metadata.
    pub values: i64,
    /// Number of columns according to the schema.
    pub children: i64,
    /// Number of nested groups in the schema around the three columns.
    pub depth: usize,
    /// Compression code: 0 is none, 1 is Snappy.
    pub codec: i64,
    /// Code for the encoding of the values: 0 is plain, 8 is an index into a dictionary (which is missing by default).
    /// Pages in the encodings 6 and 7 (delta encodings) contain their own number of values.
    pub encoding: i64,
    /// Length of an uncompressed page according to the metadata, bytes.
    pub unpacked: i64,
    /// Length of a page in the file according to the metadata, bytes. `None` stands for the true length.
    pub packed: Option<i64>,
    /// Number of values in the dictionary page before the data page. With `None` the file has no dictionary page.
    pub dictionary: Option<i64>,
    /// Content of each page, bytes.
    pub page: Vec<u8>,
}

impl Default for Columnar {
    fn default() -> Self {
        let page = [0.01_f64, 0.02].into_iter().flat_map(f64::to_le_bytes).collect();
        Self {
            rows: 2,
            group_rows: 2,
            values: 2,
            children: 3,
            depth: 0,
            codec: 0,
            encoding: 0,
            unpacked: 16,
            packed: None,
            dictionary: None,
            page,
        }
    }
}

impl Columnar {
    /// Returns the content of the Parquet file.
    pub fn bytes(&self) -> Vec<u8> {
        let mut file = b"PAR1".to_vec();
        let mut columns = Vec::new();
        for name in ["x", "y", "radius"] {
            let start = file.len() as i64;
            let packed = self.packed.unwrap_or(self.page.len() as i64);
            let sizes =
                |kind| Fields::default().whole(1, kind).whole(2, self.unpacked).whole(3, packed);
            if let Some(values) = self.dictionary {
                let of_dictionary = Fields::default().whole(1, values).whole(2, 0);
                file.extend(sizes(2).inner(7, of_dictionary).end());
                file.extend(&self.page);
            }
            let data =
                start + if self.dictionary.is_some() { file.len() as i64 - start } else { 0 };
            let of_page = Fields::default()
                .whole(1, self.values)
                .whole(2, self.encoding)
                .whole(3, 3)
                .whole(4, 3);
            file.extend(sizes(0).inner(5, of_page).end());
            file.extend(&self.page);
            let length = file.len() as i64 - start;
            let mut path = vec![name.len() as u8];
            path.extend(name.as_bytes());
            let about = Fields::default()
                .whole(1, 5)
                .list(2, 5, 1, &[0])
                .list(3, 8, 1, &path)
                .whole(4, self.codec)
                .long(5, self.values)
                .long(6, length)
                .long(7, length)
                .long(9, data);
            let about = if self.dictionary.is_some() { about.long(11, start) } else { about };
            columns.extend(Fields::default().long(2, start).inner(3, about).end());
        }
        let mut schema = Fields::default().word(4, "discs").whole(5, self.children).end();
        for _ in 0..self.depth {
            schema.extend(Fields::default().whole(3, 0).word(4, "a").whole(5, 1).end());
        }
        for name in ["x", "y", "radius"] {
            schema.extend(Fields::default().whole(1, 5).whole(3, 0).word(4, name).end());
        }
        let group = Fields::default().list(1, 12, 3, &columns).long(2, 99).long(3, self.group_rows);
        let elements = 4 + self.depth as u64;
        let footer = Fields::default()
            .whole(1, 1)
            .list(2, 12, elements, &schema)
            .long(3, self.rows)
            .list(4, 12, 1, &group.end())
            .end();
        file.extend(&footer);
        file.extend((footer.len() as u32).to_le_bytes());
        file.extend(b"PAR1");
        file
    }
}
