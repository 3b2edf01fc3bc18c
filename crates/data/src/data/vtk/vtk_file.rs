//! Writes one `.vtp` or `.vti` file: points with cells on them, or the cells of a grid, and named arrays, in VTK's XML
//! formats for polygonal data and for images with raw appended arrays (K. Martin, W. Schroeder, B. Lorensen, *VTK File
//! Formats*).
//!
//! For each array the XML states an offset, counted from the character `_` of the section `AppendedData`. At this
//! offset is the length of the array in bytes as a UInt64, followed by the values of the array. All numbers are
//! little-endian and not rounded.

use std::fmt::Write as _;

/// Last bytes of every VTK file that Slump writes.
pub(super) const END: &str = "\n  </AppendedData>\n</VTKFile>\n";

/// A number type of VTK files.
pub(super) trait Scalar: Copy {
    const TYPE: &'static str;
    fn put(self, bytes: &mut Vec<u8>);
}

macro_rules! scalars {
    ($($kind:ty, $name:literal;)*) => {
        $(impl Scalar for $kind {
            const TYPE: &'static str = $name;
            fn put(self, bytes: &mut Vec<u8>) {
                bytes.extend_from_slice(&self.to_le_bytes());
            }
        })*
    };
}

scalars! { f64, "Float64"; i64, "Int64"; i32, "Int32"; i8, "Int8"; }

/// Cells of a VTK file, the geometric elements that readers draw. All cells of a file are of the same type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum VtkCells {
    Points,
    /// A line from each point with an even index to the next point.
    Lines,
    /// An axis-parallel grid without explicit points: the lower left corner of the cell with the index 0 (m), the width
    /// and height of a cell (m), and the indices of the first and the last corner along both axes.
    Grid {
        origin: [f64; 2],
        sides: [f64; 2],
        extent: [[i64; 2]; 2],
    },
}

pub(super) struct VtkFile {
    cells: VtkCells,
    points: usize,
    /// XML text of the arrays that belong to the whole file.
    of_file: String,
    /// XML text of the arrays with a value for each point, line or grid cell.
    of_rows: String,
    /// XML text of the array with the positions of the points.
    of_points: String,
    appended: Vec<u8>,
}

impl VtkFile {
    /// Creates a file with the given points (m) in the plane z = 0.
    pub(super) fn new(cells: VtkCells, points: impl ExactSizeIterator<Item = [f64; 2]>) -> Self {
        let mut file = Self {
            cells,
            points: points.len(),
            of_file: String::new(),
            of_rows: String::new(),
            of_points: String::new(),
            appended: Vec::new(),
        };
        let said = file.append("Points", ["x", "y", "z"], points.map(in_space));
        file.of_points = said;
        file
    }

    /// Adds a number for the whole file. The number is written into the XML as text, which people can read.
    pub(super) fn add_number<N: Scalar + std::fmt::Debug>(&mut self, name: &str, number: N) {
        let _ = writeln!(
            self.of_file,
            "      <DataArray type=\"{}\" Name=\"{name}\" NumberOfTuples=\"1\" format=\"ascii\">\
             {number:?}</DataArray>",
            N::TYPE
        );
    }

    /// Adds an array of numbers for the whole file. The numbers are written in binary form, which can also represent an
    /// empty array.
    pub(super) fn add_numbers<N: Scalar>(
        &mut self,
        name: &str,
        numbers: impl ExactSizeIterator<Item = N>,
    ) {
        let count = numbers.len();
        let offset = self.append_bytes(|bytes| numbers.for_each(|number| number.put(bytes)));
        let _ = writeln!(
            self.of_file,
            "      <DataArray type=\"{}\" Name=\"{name}\" NumberOfTuples=\"{count}\" \
             format=\"appended\" offset=\"{offset}\"/>",
            N::TYPE
        );
    }

    /// Adds an array of words for the whole file.
    pub(super) fn add_words<Word: AsRef<str>>(
        &mut self,
        name: &str,
        words: impl ExactSizeIterator<Item = Word>,
    ) {
        let count = words.len();
        let offset = self.append_bytes(|bytes| {
            for word in words {
                // A zero byte ends a word, so zero bytes inside a word are removed.
                bytes.extend(word.as_ref().bytes().filter(|&byte| byte != 0).chain([0]));
            }
        });
        let _ = writeln!(
            self.of_file,
            "      <Array type=\"String\" Name=\"{name}\" NumberOfTuples=\"{count}\" \
             format=\"appended\" offset=\"{offset}\"/>"
        );
    }

    /// Adds an array with one number per point, line or grid cell.
    pub(super) fn add_column<N: Scalar>(&mut self, name: &str, column: impl Iterator<Item = N>) {
        let said = self.append(name, [], column.map(|number| [number]));
        self.of_rows += &said;
    }

    /// Adds an array with one vector per point, line or grid cell. `x` and `y` are the names of the first two
    /// components.
    pub(super) fn add_vectors(
        &mut self,
        name: &str,
        [x, y]: [&str; 2],
        vectors: impl Iterator<Item = [f64; 2]>,
    ) {
        let said = self.append(name, [x, y, "z"], vectors.map(in_space));
        self.of_rows += &said;
    }

    /// Returns the complete file. ParaView initially colours by the array with the name `scalars`.
    pub(super) fn finish(mut self, scalars: &str) -> Vec<u8> {
        let (cells, each) = match self.cells {
            VtkCells::Points => ("Verts", 1),
            VtkCells::Lines => ("Lines", 2),
            VtkCells::Grid { origin, sides, extent } => {
                return self.finish_image(origin, sides, extent, scalars);
            }
        };
        let count = self.points / each;
        let connectivity = self.append("connectivity", [], (0..self.points as i64).map(|n| [n]));
        let ends = (1..=count as i64).map(|number| [number * each as i64]);
        let offsets = self.append("offsets", [], ends);
        let Self { points, of_file, of_rows, of_points, appended, .. } = &self;
        let of_rows = format!(" Scalars=\"{scalars}\">\n{of_rows}      ");
        let [of_each_point, of_each_cell] = match self.cells {
            VtkCells::Points => [of_rows.as_str(), ">"],
            _ => [">", of_rows.as_str()],
        };
        let counts = ["Verts", "Lines", "Strips", "Polys"]
            .map(|kind| format!(" NumberOf{kind}=\"{}\"", if kind == cells { count } else { 0 }));
        let body = format!(
            "  <PolyData>\n    \
             <FieldData>\n{of_file}    </FieldData>\n    \
             <Piece NumberOfPoints=\"{points}\"{}>\n      \
             <PointData{of_each_point}</PointData>\n      \
             <CellData{of_each_cell}</CellData>\n      \
             <Points>\n{of_points}      </Points>\n      \
             <{cells}>\n{connectivity}{offsets}      </{cells}>\n    \
             </Piece>\n  \
             </PolyData>\n",
            counts.concat()
        );
        whole_file("PolyData", &body, appended)
    }

    fn finish_image(
        self,
        [left, below]: [f64; 2],
        [width, height]: [f64; 2],
        [x, y]: [[i64; 2]; 2],
        scalars: &str,
    ) -> Vec<u8> {
        let Self { of_file, of_rows, appended, .. } = &self;
        let extent = format!("{} {} {} {} 0 0", x[0], x[1], y[0], y[1]);
        let body = format!(
            "  <ImageData WholeExtent=\"{extent}\" Origin=\"{left:?} {below:?} 0\" \
             Spacing=\"{width:?} {height:?} 1\">\n    \
             <FieldData>\n{of_file}    </FieldData>\n    \
             <Piece Extent=\"{extent}\">\n      \
             <CellData Scalars=\"{scalars}\">\n{of_rows}      </CellData>\n    \
             </Piece>\n  \
             </ImageData>\n"
        );
        whole_file("ImageData", &body, appended)
    }

    /// Appends the values of an array to the binary section and returns the array's XML text. `parts` names the
    /// components if there are several.
    fn append<N: Scalar, const EACH: usize, const NAMED: usize>(
        &mut self,
        name: &str,
        parts: [&str; NAMED],
        rows: impl Iterator<Item = [N; EACH]>,
    ) -> String {
        let offset = self.append_bytes(|bytes| {
            rows.flatten().for_each(|number| number.put(bytes));
        });
        let mut components = format!(" NumberOfComponents=\"{EACH}\"");
        for (number, part) in parts.iter().enumerate() {
            let _ = write!(components, " ComponentName{number}=\"{part}\"");
        }
        format!(
            "        <DataArray type=\"{}\" Name=\"{name}\"{components} format=\"appended\" \
             offset=\"{offset}\"/>\n",
            N::TYPE
        )
    }

    /// Appends the bytes that `put` writes to the binary section, after their length. Returns the offset of that
    /// length.
    fn append_bytes(&mut self, put: impl FnOnce(&mut Vec<u8>)) -> usize {
        let offset = self.appended.len();
        let behind_length = offset + size_of::<u64>();
        self.appended.resize(behind_length, 0);
        put(&mut self.appended);
        let length = (self.appended.len() - behind_length) as u64;
        self.appended[offset..behind_length].copy_from_slice(&length.to_le_bytes());
        offset
    }
}

fn whole_file(kind: &str, body: &str, appended: &[u8]) -> Vec<u8> {
    let head = format!(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n\
         {body}  \
         <AppendedData encoding=\"raw\">\n   _"
    );
    [head.as_bytes(), appended, END.as_bytes()].concat()
}

/// Extends a plane vector by z = 0, because VTK expects three components.
fn in_space([x, y]: [f64; 2]) -> [f64; 3] {
    [x, y, 0.0]
}
