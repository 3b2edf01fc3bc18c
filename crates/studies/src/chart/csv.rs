//! A sheet as CSV.

use super::{Layer, Sheet};
use crate::error::{Error, Result};

impl Sheet {
    /// Every point of every layer: panel, layer, x, y, low, high, value.
    pub fn to_csv(&self) -> Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let refuse = |error: csv::Error| Error::file("figure", error);
        writer
            .write_record(["panel", "layer", "x", "y", "low", "high", "value"])
            .map_err(refuse)?;
        for (panel, chart) in self.charts.iter().enumerate() {
            let panel = (panel + 1).to_string();
            for layer in &chart.layers {
                match layer {
                    Layer::Curve { name, points, .. } => {
                        let name = &name.replace('\n', " ");
                        for point in points {
                            let (low, high) =
                                point.interval.map_or_else(Default::default, |(a, b)| {
                                    (a.to_string(), b.to_string())
                                });
                            let place = [point.x.to_string(), point.y.to_string()];
                            writer
                                .write_record([&panel, name, &place[0], &place[1], &low, &high, ""])
                                .map_err(refuse)?;
                        }
                    }
                    Layer::Cells { name, cells, .. } => {
                        for cell in cells {
                            let place = [cell.x.0, cell.y.0, cell.value];
                            let [x, y, value] = place.map(|number| number.to_string());
                            writer
                                .write_record([&panel, name, &x, &y, "", "", &value])
                                .map_err(refuse)?;
                        }
                    }
                    Layer::Words { .. } => {}
                }
            }
        }
        writer.into_inner().map_err(|error| Error::file("figure", error.error()))
    }
}
