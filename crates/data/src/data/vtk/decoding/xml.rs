//! The XML of a `.vtp` file, and the data behind it, which may be no XML.

use quick_xml::de::DeError;
use serde::Deserialize;

use super::Said;
use crate::data::vtk::encoding::STEP;

/// What begins the data.
const APPENDED: &[u8] = b"<AppendedData";

/// A file in parts.
pub(in crate::data) struct Document<'a> {
    root: Root,
    /// What is behind the `_` of `AppendedData`, and whether it is base64.
    pub(super) appended: Option<(&'a [u8], bool)>,
}

#[derive(Deserialize)]
struct Root {
    #[serde(rename = "@type")]
    kind: String,
    #[serde(rename = "@byte_order", default)]
    byte_order: String,
    #[serde(rename = "@header_type", default)]
    header_type: String,
    #[serde(rename = "@compressor")]
    compressor: Option<String>,
    #[serde(rename = "PolyData", default)]
    poly_data: PolyData,
    #[serde(rename = "Collection", default)]
    series: Series,
}

#[derive(Default, Deserialize)]
struct Series {
    #[serde(rename = "DataSet", default)]
    files: Vec<DataSet>,
}

#[derive(Deserialize)]
struct DataSet {
    #[serde(rename = "@file")]
    file: String,
}

#[derive(Default, Deserialize)]
struct PolyData {
    #[serde(rename = "FieldData", default)]
    of_file: Arrays,
    #[serde(rename = "Piece", default)]
    pieces: Vec<Piece>,
}

/// Some points with their arrays.
#[derive(Deserialize)]
pub(in crate::data) struct Piece {
    #[serde(rename = "@NumberOfPoints")]
    pub points: usize,
    #[serde(rename = "PointData", default)]
    of_points: Arrays,
    #[serde(rename = "Points", default)]
    positions: Arrays,
}

#[derive(Default, Deserialize)]
struct Arrays {
    #[serde(rename = "DataArray", default)]
    numbers: Vec<DataArray>,
    #[serde(rename = "Array", default)]
    words: Vec<DataArray>,
}

/// What the XML says of an array.
#[derive(Deserialize)]
pub(in crate::data) struct DataArray {
    #[serde(rename = "@type")]
    pub(super) kind: String,
    #[serde(rename = "@Name", default)]
    pub name: String,
    #[serde(rename = "@NumberOfComponents", default = "one")]
    pub components: usize,
    #[serde(rename = "@format", default)]
    pub(super) format: String,
    #[serde(rename = "@offset", default)]
    pub(super) offset: usize,
    #[serde(rename = "$text", default)]
    pub(super) text: String,
}

fn one() -> usize {
    1
}

impl<'a> Document<'a> {
    /// Takes a file apart; or what is amiss.
    pub(in crate::data) fn of(bytes: &'a [u8]) -> Said<Self> {
        let cut = find(bytes, APPENDED);
        let xml = std::str::from_utf8(&bytes[..cut.unwrap_or(bytes.len())]);
        let mut xml = xml.map_err(|_| "is not text".to_owned())?.to_owned();
        let appended = cut.map(|cut| appended(&bytes[cut..])).transpose()?;
        if cut.is_some() {
            xml += "</VTKFile>";
        }
        let root: Root = quick_xml::de::from_str(&xml).map_err(|error| said(&error))?;
        Ok(Self { root, appended })
    }

    /// The files of a series in the order of their times, if it is one.
    pub(in crate::data) fn files_of_series(&self) -> Option<impl Iterator<Item = &str>> {
        let is_series = self.root.kind == "Collection";
        is_series.then(|| self.root.series.files.iter().map(|entry| entry.file.as_str()))
    }

    /// The piece that all points must be in.
    pub(in crate::data) fn piece(&self) -> Said<&Piece> {
        if self.root.kind != "PolyData" {
            return Err(format!("is a file of the type {}", self.root.kind));
        }
        match &self.root.poly_data.pieces[..] {
            [piece] => Ok(piece),
            pieces => Err(format!("has {} pieces, but must have one", pieces.len())),
        }
    }

    /// The words that go with the file as a whole, by their name.
    pub(in crate::data) fn words_of_file(&self, name: &str) -> Option<&DataArray> {
        self.root.poly_data.of_file.words.iter().find(|array| array.name == name)
    }

    /// The step that a file of ours is of.
    pub(in crate::data) fn step(&self) -> Option<u64> {
        let numbers = &self.root.poly_data.of_file.numbers;
        numbers.iter().find(|array| array.name == STEP)?.text.trim().parse().ok()
    }

    pub(super) fn is_big_endian(&self) -> bool {
        self.root.byte_order == "BigEndian"
    }

    /// Bytes of a length.
    pub(super) fn length_size(&self) -> usize {
        if self.root.header_type == "UInt64" { 8 } else { 4 }
    }

    pub(super) fn compressor(&self) -> Option<&str> {
        self.root.compressor.as_deref()
    }
}

impl Piece {
    /// Arrays of numbers, with one or more for each point.
    pub(in crate::data) fn of_points(&self) -> &[DataArray] {
        &self.of_points.numbers
    }

    /// Those of a name.
    pub(in crate::data) fn array(&self, name: &str) -> Option<&DataArray> {
        self.of_points().iter().find(|array| array.name == name)
    }

    /// Where the points are.
    pub(in crate::data) fn positions(&self) -> Option<&DataArray> {
        self.positions.numbers.first()
    }
}

/// What a parser says, without the names that types have here.
fn said(error: &DeError) -> String {
    match error {
        DeError::InvalidXml(error) => error.to_string(),
        DeError::Custom(said) if said.starts_with("missing field") => said.clone(),
        _ => "does not say what VTK's files say".into(),
    }
}

/// The data of an element `AppendedData`, and whether it is base64.
fn appended(element: &[u8]) -> Said<(&[u8], bool)> {
    let data = find(element, b"_").map(|start| element.split_at(start + 1));
    let (tag, data) = data.ok_or("has no data behind AppendedData")?;
    let is_base64 = find(tag, b"base64").is_some();
    let end = if is_base64 { find(data, b"<") } else { None };
    Ok((&data[..end.unwrap_or(data.len())], is_base64))
}

fn find(bytes: &[u8], wanted: &[u8]) -> Option<usize> {
    bytes.windows(wanted.len()).position(|window| window == wanted)
}
