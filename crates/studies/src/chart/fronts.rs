//! Common parts of charts of cost and error: Pareto fronts, and labels at the ends of curves.

use super::{Axis, Chart, Layer, Rgb};

/// The points (speed, error) that no other point beats in both, by increasing speed. Of equal points the first is kept.
pub fn pareto_front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    // Fastest first; among equally fast points, the most accurate first.
    order.sort_by(|&one, &other| {
        let ((speed, error), (other_speed, other_error)) = (points[one], points[other]);
        other_speed.total_cmp(&speed).then(error.total_cmp(&other_error))
    });
    let mut front = Vec::new();
    let mut least_error = f64::INFINITY;
    for index in order {
        if points[index].1 < least_error {
            least_error = points[index].1;
            front.push(index);
        }
    }
    front.reverse();
    front
}

/// Width of a character and height of a label, as fractions of a chart.
const CHARACTER: f64 = 0.018;
const HIGH: f64 = 0.05;

impl Chart {
    /// Adds labels at the ends of curves on logarithmic axes, to the right of all points near them, and spaced apart.
    pub fn add_end_labels(&mut self, mut ends: Vec<(String, Rgb, (f64, f64))>) {
        let part = |axis: &Axis, share: f64| (axis.to / axis.from).powf(share);
        let high = part(&self.y, HIGH);
        ends.sort_by(|(.., one), (.., other)| one.1.total_cmp(&other.1));
        let curves = self.layers.iter().filter_map(|layer| match layer {
            Layer::Curve { points, .. } => Some(points),
            _ => None,
        });
        let all: Vec<(f64, f64)> = curves.flatten().map(|point| (point.x, point.y)).collect();
        let mut last = 0.0;
        for (text, colour, (x, y)) in ends {
            last = f64::max(y, last * high);
            let long = part(&self.x, CHARACTER * (text.chars().count() + 1) as f64);
            let is_in_the_way = |(other_x, other_y): &&(f64, f64)| {
                // A point slightly below would also run into the label.
                let heights = last / (high * high)..last * high;
                (1.0..long).contains(&(other_x / x)) && heights.contains(other_y)
            };
            let behind = all.iter().filter(is_in_the_way).map(|(other_x, _)| *other_x);
            let at = (1.18 * behind.fold(x, f64::max), last);
            self.layers.push(Layer::Words { at, text, colour });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Look, PALETTE, points};
    use super::*;

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let points = [(1.0, 0.1), (2.0, 0.2), (1.5, 0.3), (4.0, 0.2), (0.5, 0.1), (5.0, 0.9)];
        assert_eq!(pareto_front(&points), [0, 3, 5]);
        assert_eq!(pareto_front(&[(1.0, 1.0), (1.0, 1.0)]), [0]);
        assert!(pareto_front(&[]).is_empty());
    }

    #[test]
    fn labels_of_curves_that_end_together_stand_apart_and_beside_all_of_them() {
        let axis = || Axis::log("", 1e-4, 1e4);
        let mut chart = Chart::new("", axis(), axis());
        let ends = PALETTE.map(|colour| ("one".to_owned(), colour, (1.0, 0.01)));
        // The curve begins next to the labels and ends elsewhere.
        let near = [(3.0, 0.01), (9.0, 1e-4)];
        chart.layers.push(Layer::quiet("near", points(near), PALETTE[0], Look::LineAndDots));
        chart.add_end_labels(ends.to_vec());
        let places = chart.layers.iter().filter_map(|label| match label {
            Layer::Words { at, .. } => Some(*at),
            _ => None,
        });
        let places: Vec<(f64, f64)> = places.collect();
        assert!(places.windows(2).all(|pair| pair[1].1 >= 2.4 * pair[0].1), "{places:?}");
        assert!(places[0].0 > 3.0, "{places:?}");
    }
}
