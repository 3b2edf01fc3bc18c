//! One look a method, the same on every chart: a colour, and dashes after the colours run out. After the dashes
//! run out too, other colours.

use crate::chart::{Layer, Look, PALETTE, Point, Rgb, points};

/// In the place of black, which would come dashed a second time.
const WINE: Rgb = (136, 34, 85);
/// In the place of blue, likewise.
const OLIVE: Rgb = (153, 153, 51);

/// The colour of method number `index` of the registry.
pub(super) fn colour(index: usize) -> Rgb {
    match index % PALETTE.len() {
        0 if index >= 2 * PALETTE.len() => WINE,
        1 if index >= 2 * PALETTE.len() => OLIVE,
        place => PALETTE[place],
    }
}

fn dashed(index: usize) -> bool {
    index >= PALETTE.len()
}

/// Its line.
pub(super) fn stroke(index: usize) -> Look {
    if dashed(index) { Look::Dashes(3) } else { Look::Line(3) }
}

/// Its dots, of that radius.
pub(super) fn dots(index: usize, radius: u32) -> Look {
    if dashed(index) { Look::Rings(radius) } else { Look::Dots(radius) }
}

/// A curve with its points marked.
pub(super) fn line_layers(
    index: usize,
    name: String,
    places: Vec<(f64, f64)>,
    in_legend: bool,
) -> Vec<Layer> {
    let colour = colour(index);
    let make = if in_legend { Layer::curve } else { Layer::quiet };
    let points = points(places);
    if dashed(index) {
        let marks = Layer::quiet(format!("{name} "), points.clone(), colour, Look::Rings(5));
        return vec![make(name, points, colour, Look::Dashes(3)), marks];
    }
    vec![make(name, points, colour, Look::LineAndDots)]
}

/// A staircase's corners as a line that ends at `end`.
pub(super) fn staircase(corners: &[(f64, f64)], end: f64) -> Vec<Point> {
    let mut line: Vec<(f64, f64)> = Vec::new();
    for &(x, y) in corners {
        if let Some(&(_, before)) = line.last() {
            line.push((x, before));
        }
        line.push((x, y));
    }
    if let Some(&(x, y)) = line.last()
        && x < end
    {
        line.push((end, y));
    }
    points(line)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::super::entrants::{all, models, of_problems};
    use super::*;

    #[test]
    fn no_two_of_a_chart_look_alike() {
        let with_models = all().into_iter().chain(models()).collect();
        for entrants in [of_problems(true), with_models] {
            let looks = entrants.iter().map(|entrant| (colour(entrant.look), dashed(entrant.look)));
            let names: Vec<_> = entrants.iter().map(|entrant| &entrant.name).collect();
            assert_eq!(looks.collect::<HashSet<_>>().len(), entrants.len(), "{names:?}");
        }
    }
}
