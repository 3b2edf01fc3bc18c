//! Draws a map of the slump over Bond number and time step Δt, with contours of the cohesive time Bond·Δt/√(d/g), where
//! d is the mean diameter and g gravity.

use std::ops::RangeInclusive;

use super::claims::{Alike, Claim, Verdict};
use super::fig6::{log_time, unit_secs};
use super::fig8::log_edges;
use super::studies::groups;
use super::{Figure, StudyRunner};
use crate::chart::{Axis, Chart, Layer, Look, MapCell, Rgb, Sheet, points};
use crate::error::Result;
use crate::statistics::{Mean, mean, p_value};

/// Slump at the upper end of the colour scale.
const MOST: f64 = 0.55;
const CONTOURS: [f64; 5] = [0.1, 0.3, 1.0, 3.0, 10.0];
const WHITE: Rgb = (255, 255, 255);
/// Limit of the cohesive times Bond·Δt/√(d/g) that count as near 1, the value at which the slump should be lowest by
/// Fig. 6 of Abramian & Staron (2020), with mean diameter d and gravity g: these are the times from 1/`NEAR` to `NEAR`.
const NEAR: f64 = 3.0;
const SHADES: u32 = 64;

/// Returns the colour of a slump. It is dark for a pile that does not slump.
fn colour(slump: f64) -> Rgb {
    use plotters::style::RGBColor;
    use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};
    let RGBColor(red, green, blue) =
        ViridisRGB.get_color_normalized(slump.clamp(0.0, MOST), 0.0, MOST);
    (red, green, blue)
}

pub(super) fn make(studies: &StudyRunner) -> Result<Figure> {
    let rows = studies.rows("pile-map")?;
    let (bonds, steps) = (rows.values("bond"), rows.values("dt"));
    let half = 0.5 * (bonds[1] - bonds[0]);
    let edges = log_edges(&steps);
    let mut cells = Vec::new();
    let mut lowest = Vec::new();
    for (index, &bond) in bonds.iter().enumerate() {
        // All edges are computed from the first Bond number, so that neighbouring cells share their edges exactly.
        let edge = |number: usize| bonds[0] + half * (2.0 * number as f64 - 1.0);
        let of_bond = rows.with("bond", bond);
        let mut best = (f64::INFINITY, 0.0);
        for (step, edges) in steps.iter().zip(&edges) {
            let slump = mean(&of_bond.with("dt", *step).readings("slump")).mean;
            cells.push(MapCell {
                x: (bond, [edge(index), edge(index + 1)]),
                y: (*step, *edges),
                value: slump,
            });
            if slump < best.0 {
                best = (slump, *step);
            }
        }
        lowest.push((bond, best.1));
    }
    let (x_from, x_to) = (bonds[0] - half, bonds[bonds.len() - 1] + half);
    let (y_from, y_to) = (edges[0][0], edges[edges.len() - 1][1]);
    let mut chart = Chart::new(
        "Slump after 1 s, with contours of Bond·Δt/√(d/g)",
        Axis::linear("Bond", x_from, x_to),
        Axis::log("Δt (s)", y_from, y_to),
    );
    chart.width = 5.0;
    chart.layers.push(Layer::Cells { name: "mean slump".into(), cells, colour });
    chart.layers.extend(contours(x_to, y_from..=y_to));
    let cohesive: Vec<_> = lowest.iter().copied().filter(|(bond, _)| *bond > 0.0).collect();
    let dots = points(cohesive.iter().copied());
    chart.layers.push(Layer::quiet(
        "lowest slump of each Bond",
        dots,
        (230, 60, 60),
        Look::Dots(6),
    ));

    let cohesive = rows.such_that(|run| run.at("bond") > 0.0);
    let groups = groups(&cohesive, log_time, |run| run.reading("slump"));
    let claim = claim(&groups, rows.values("seed").len());
    let sheet = Sheet {
        size: (1200, 818),
        charts: vec![chart, scale()],
        caption: vec![format!(
            "Means over {} initial states; red: the Δt of the lowest slump at each Bond number.",
            rows.values("seed").len()
        )],
    };
    Ok(Figure { name: "pile-map", sheet, claims: vec![claim], table: None })
}

/// Returns lines of constant cohesive time Bond·Δt/√(d/g) (mean diameter d, gravity g) with their labels, clipped to
/// the axes.
fn contours(most_bond: f64, steps: RangeInclusive<f64>) -> Vec<Layer> {
    let mut layers = Vec::new();
    for time in CONTOURS {
        let line: Vec<_> = (1..=400)
            .map(|k| most_bond * f64::from(k) / 400.0)
            .map(|bond| (bond, time * unit_secs() / bond))
            .filter(|(_, step)| steps.contains(step))
            .collect();
        let Some(&(bond, step)) = line.get(line.len() / 2) else { continue };
        let name = format!("cohesive time {time}");
        let look = if time == 1.0 { Look::Line(3) } else { Look::Line(1) };
        layers.push(Layer::quiet(name, points(line), WHITE, look));
        layers.push(Layer::Words { at: (bond, step), text: format!(" {time}"), colour: WHITE });
    }
    layers
}

fn scale() -> Chart {
    let mut scale = Chart::new("", Axis::linear("", 0.0, 1.0), Axis::linear("slump", 0.0, MOST));
    scale.x.ticks = vec![(-1.0, String::new())];
    let shade = |k: u32| {
        let at = |k: u32| MOST * f64::from(k) / f64::from(SHADES);
        MapCell { x: (0.5, [0.0, 1.0]), y: (at(k), [at(k), at(k + 1)]), value: at(k) }
    };
    let cells = (0..SHADES).map(shade).collect();
    scale.layers.push(Layer::Cells { name: "scale".into(), cells, colour });
    scale
}

/// Returns one difference of slumps per initial state: the mean slump of runs whose cohesive time Bond·Δt/√(d/g) (mean
/// diameter d, gravity g) is not near 1 (the value at which the slump should be lowest by Fig. 6 of Abramian & Staron
/// 2020), minus the mean slump of runs whose cohesive time is near 1. The difference is computed for each Bond number
/// that has runs of both kinds, and then averaged over these Bond numbers.
fn depths(groups: &[Alike], states: usize) -> Vec<f64> {
    let of_group = |runs: &Alike| {
        let (near, away): (Vec<_>, Vec<_>) =
            runs.iter().partition(|(x, _)| x.abs() <= NEAR.log10());
        let mean_of = |side: &[(f64, f64)]| {
            let sum: f64 = side.iter().map(|(_, slump)| slump).sum();
            (!side.is_empty()).then(|| sum / side.len() as f64)
        };
        Some(mean_of(&away)? - mean_of(&near)?)
    };
    let of_state = |groups: &[Alike]| {
        let depths: Vec<f64> = groups.iter().filter_map(of_group).collect();
        depths.iter().sum::<f64>() / depths.len() as f64
    };
    let each = (groups.len() / states.max(1)).max(1);
    groups.chunks(each).map(of_state).filter(|depth| depth.is_finite()).collect()
}

/// Tests whether the slump is lower at cohesive times Bond·Δt/√(d/g) (mean diameter d, gravity g) near 1 than at other
/// cohesive times. By Fig. 6 of Abramian & Staron (2020) it should be lowest at 1. The test does not look for the time
/// step with the lowest slump at each Bond number, because such a time step exists even without any effect of Δt.
fn claim(groups: &[Alike], states: usize) -> Claim {
    let depth = |groups: &[Alike]| mean(&depths(groups, states));
    let verdict = |depth: Mean| Verdict::of(depth.p_above(0.0), depth.p_below(0.0));
    let measured = format!(
        "slump at cohesive times beyond {:.2} … {NEAR} less that within, at the same state and Bond: {}, {} states; above \
         0: {}",
        1.0 / NEAR,
        depth(groups).signed(3),
        depth(groups).count,
        p_value(depth(groups).p_above(0.0))
    );
    Claim::new(
        "Beyond the paper: over the plane of Bond and Δt the slump is lower near a cohesive time of 1 than away \
            from it",
        measured.replace('-', "−"),
        verdict(depth(groups)),
    )
    .shuffled(groups, |_| 0.0, |groups| verdict(depth(groups)) == Verdict::Holds)
    .hanging_on("the shifted cone; a factor of 3 as near; the ranges of Bond and Δt, which say what away is")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns made-up slumps of eight initial states at four Bond numbers, for tests. The slump is lower by `depth`
    /// near the cohesive time `at`, which is Bond·Δt/√(d/g) with mean diameter d and gravity g.
    fn plane(depth: f64, at: f64) -> Vec<Alike> {
        let of_group = |group: usize| {
            let run = |step: usize| {
                let x = 0.3 * step as f64 - 1.5 + 0.2 * (group % 4) as f64;
                let scatter = 0.02 * (1.3 * group as f64 + 7.1 * (group * step) as f64).sin();
                (x, 0.3 + scatter - depth * (-(x - at.log10()).powi(2) / 0.1).exp())
            };
            (0..10).map(run).collect()
        };
        (0..32).map(of_group).collect()
    }

    #[test]
    fn a_valley_at_one_holds_one_elsewhere_does_not_and_chance_is_told() {
        let valley = claim(&plane(0.1, 1.0), 8);
        assert_eq!(valley.verdict, Verdict::Holds, "{}", valley.measured);
        let elsewhere = claim(&plane(0.1, 12.0), 8);
        assert_eq!(elsewhere.verdict, Verdict::Fails, "{}", elsewhere.measured);
        let share: f64 =
            valley.by_chance["holds in ".len()..].split(' ').next().unwrap().parse().unwrap();
        assert!((share - 5.0).abs() < 2.0, "{}", valley.by_chance);
    }
}
