//! Where the charts of a sheet stand.

use super::{Chart, Sheet};

/// Left, top, right and bottom edge of each chart, pixels from the corner of a sheet that has that height for
/// charts. Charts share the width of their row by their own; a legend that ends a sheet of several rows stands
/// beside all of them.
pub(super) fn edges(sheet: &Sheet, height: u32) -> Vec<[i32; 4]> {
    let (width, height) = (f64::from(sheet.size.0), f64::from(height));
    let breaks = || sheet.charts.iter().skip(1).filter(|chart| chart.begins_row);
    let rows = 1 + breaks().count();
    let (charts, beside) = match sheet.charts.split_last() {
        Some((legend, charts)) if rows > 1 && legend.only_legend => (charts, Some(legend)),
        _ => (&sheet.charts[..], None),
    };
    let rows_of_charts: Vec<&[Chart]> = charts.chunk_by(|_, next| !next.begins_row).collect();
    let sum = |row: &[Chart]| row.iter().map(|chart| chart.width).sum::<f64>();
    let widest = rows_of_charts.iter().map(|row| sum(row)).fold(0.0, f64::max);
    let total = widest + beside.map_or(0.0, |legend| legend.width);
    let mut edges = Vec::new();
    for (number, row) in rows_of_charts.iter().enumerate() {
        let [top, bottom] = [number, number + 1].map(|at| at as f64 / rows as f64 * height);
        let mut left = 0.0;
        for chart in *row {
            let right = left + chart.width / total * width;
            edges.push([left, top, right, bottom].map(|edge| edge as i32));
            left = right;
        }
        // Rounding leaves no strip at the right.
        if let Some([.., last_right, _]) = edges.last_mut()
            && (left - width).abs() < 0.5
        {
            *last_right = width as i32;
        }
    }
    edges.extend(
        beside.map(|_| [widest / total * width, 0.0, width, height].map(|edge| edge as i32)),
    );
    edges
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::Axis;

    #[test]
    fn charts_fill_their_rows_and_a_legend_stands_beside_all() {
        let nowhere = Axis::linear("", 0.0, 1.0);
        let chart = |begins_row: bool| Chart {
            begins_row,
            ..Chart::new("", nowhere.clone(), nowhere.clone())
        };
        let mut charts = vec![chart(false), chart(false), chart(true)];
        let sheet = |charts: &[Chart]| Sheet {
            size: (500, 0),
            charts: charts.to_vec(),
            caption: Vec::new(),
        };
        assert_eq!(
            edges(&sheet(&charts), 300),
            [[0, 0, 250, 150], [250, 0, 500, 150], [0, 150, 250, 300]]
        );
        charts.push(Chart::legend_of(&mut charts.clone(), 0.5));
        assert_eq!(
            edges(&sheet(&charts), 300),
            [[0, 0, 200, 150], [200, 0, 400, 150], [0, 150, 200, 300], [400, 0, 500, 300]]
        );
        assert_eq!(
            edges(&sheet(&charts[..2]), 300),
            [[0, 0, 250, 300], [250, 0, 500, 300]],
            "one row has all of the height"
        );
    }
}
