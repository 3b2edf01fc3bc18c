//! Preparation of a curve for a plot: it is thinned in time, and split into pieces at values that cannot be drawn.

use crate::live::Curve;
use crate::sim::Observables;

/// Number of time intervals into which a long curve is divided. A plot draws at most four values per interval.
const BUCKETS: usize = 300;

/// Returns the curve of `value` against time up to `until_secs`, in pieces of points (time, s, and value). Values that
/// are not finite, such as the logarithm of 0, leave a gap between two pieces, unless the gap is too narrow to be
/// visible. In each time interval, a long curve keeps only its first, last, smallest and largest value.
pub(super) fn pieces(
    curve: &Curve,
    until_secs: f64,
    value: impl Fn(&Observables) -> f64,
) -> Vec<Vec<[f64; 2]>> {
    let rows = curve.rows().take_while(|row| row.time_secs <= until_secs);
    let points: Vec<[f64; 2]> = rows.map(|row| [row.time_secs, value(row)]).collect();
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Vec::new() };
    let interval_secs = ((last[0] - first[0]) / BUCKETS as f64).max(f64::MIN_POSITIVE);
    let is_finite = |point: &[f64; 2]| point[1].is_finite();
    let bucket = |point: &[f64; 2]| ((point[0] - first[0]) / interval_secs) as usize;
    let mut pieces: Vec<Vec<[f64; 2]>> = Vec::new();
    for run in points.chunk_by(|one, other| is_finite(one) == is_finite(other)) {
        if !is_finite(&run[0]) {
            continue;
        }
        let is_seen = |piece: &&mut Vec<[f64; 2]>| {
            piece.last().is_some_and(|end| run[0][0] - end[0] <= interval_secs)
        };
        let mut thinned = Vec::new();
        for interval in run.chunk_by(|one, other| bucket(one) == bucket(other)) {
            let by_value = |one: &&[f64; 2], other: &&[f64; 2]| one[1].total_cmp(&other[1]);
            let extremes = [interval.iter().min_by(by_value), interval.iter().max_by(by_value)];
            let ends = [interval.first(), interval.last()];
            let mut kept: Vec<_> = extremes.into_iter().chain(ends).flatten().copied().collect();
            kept.sort_by(|one, other| one[0].total_cmp(&other[0]));
            kept.dedup();
            thinned.extend(kept);
        }
        match pieces.last_mut().filter(is_seen) {
            Some(piece) => piece.extend(thinned),
            None => pieces.push(thinned),
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_keeps_its_beginning_and_extremes_where_later_steps_are_far_shorter() {
        let mut curve = Curve::default();
        let mut push = |step: u64, time_secs: f64, slump: f64| {
            curve.push(Observables { step, time_secs, slump, ..Observables::default() });
        };
        (0..=200).for_each(|step| push(step, 5e-3 * step as f64, step as f64));
        let peak = |step: u64| if step == 4321 { 1e3 } else { 0.0 };
        (1..=10_000).for_each(|step| push(200 + step, 1.0 + 1e-4 * step as f64, peak(step)));
        let pieces = pieces(&curve, f64::INFINITY, |row| row.slump);
        let early = pieces[0].iter().filter(|point| point[0] <= 1.0).count();
        assert!(early > 150, "{early} points of the first second");
        assert!(pieces.len() == 1 && pieces[0].len() <= 4 * (BUCKETS + 1));
        assert!(pieces[0].iter().any(|point| point[1] == 1e3), "the peak");
        let ends = [pieces[0][0][0], pieces[0][pieces[0].len() - 1][0]];
        assert_eq!(ends, [0.0, 2.0]);
    }

    #[test]
    fn a_zero_leaves_a_gap_on_a_logarithmic_axis() {
        let mut curve = Curve::default();
        for (step, slump) in [0.0, 1.0, 10.0, 0.0, 0.0, 100.0].into_iter().enumerate() {
            let time_secs = step as f64;
            curve.push(Observables {
                step: step as u64,
                time_secs,
                slump,
                ..Observables::default()
            });
        }
        let pieces = pieces(&curve, f64::INFINITY, |row| row.slump.log10());
        assert_eq!(pieces, [vec![[1.0, 0.0], [2.0, 1.0]], vec![[5.0, 2.0]]]);
    }
}
