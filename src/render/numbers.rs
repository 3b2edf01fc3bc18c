//! Round numbers for axes and scale bars, and the text of numbers.

/// Returns the largest number of the form 1, 2 or 5 times a power of ten that is not above `limit`. `limit` must be
/// positive.
pub(crate) fn round_below(limit: f64) -> f64 {
    let power = 10f64.powi(limit.log10().floor() as i32);
    // The tolerance keeps numbers such as 0.2, whose computed logarithm is rounded.
    [10.0, 5.0, 2.0, 1.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|length| *length <= limit * (1.0 + 1e-9))
        .unwrap_or(power)
}

/// Returns a round number, such as 1.5 or 20, that is at least `value`, as the upper end of a scale. `value` must be
/// positive.
pub(crate) fn round_above(value: f64) -> f64 {
    let power = 10f64.powi(value.log10().floor() as i32);
    [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|end| *end >= value * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// Returns at most `most` equally spaced round numbers between `low` and `high`, and their spacing, for the ticks of a
/// scale.
pub(crate) fn ticks(low: f64, high: f64, most: usize) -> (Vec<f64>, f64) {
    let span = high - low;
    if !(span > 0.0 && span.is_finite()) {
        return (vec![low], 1.0);
    }
    let least_step = span / most.saturating_sub(1).max(1) as f64;
    let power = 10f64.powi(least_step.log10().floor() as i32);
    let steps = [10.0, 5.0, 2.0, 1.0, 0.5].map(|factor| factor * power);
    let is_enough = |step: &&f64| **step >= least_step * (1.0 - 1e-9);
    let widest = steps.iter().take_while(is_enough).count().saturating_sub(1);
    let ends = |step: f64| {
        let (first, last) = (low / step - 1e-9, high / step + 1e-9);
        (first.ceil() as i64, last.floor() as i64)
    };
    // A single number does not show the scale of an axis.
    let has_two = |step: &f64| ends(*step).0 < ends(*step).1;
    let step = steps[widest..].iter().copied().find(has_two).unwrap_or(steps[widest]);
    let (first, last) = ends(step);
    ((first..=last).map(|index| index as f64 * step).collect(), step)
}

/// Largest number of decimals, and of zeros before the decimal point. A number that needs more is written as a power of
/// ten.
const MOST_DECIMALS: f64 = 6.0;

/// Returns the text of a number, with enough decimals to distinguish multiples of `step`. If too many digits are
/// needed, the number is written as a power of ten. The minus sign is the typographic one (U+2212).
pub(crate) fn decimal(value: f64, step: f64) -> String {
    let places = -(step.abs().log10() + 1e-9).floor();
    let is_far = places.abs() > MOST_DECIMALS;
    let text = if is_far && value == 0.0 {
        "0".to_owned()
    } else if is_far {
        // The number of digits is the number of decades between the number and the step.
        let digits = (value.abs().log10().floor() + places).clamp(0.0, 15.0) as usize;
        format!("{value:.digits$e}").replace("e-", "e−")
    } else {
        let decimals = places.clamp(0.0, MOST_DECIMALS) as usize;
        format!("{value:.decimals$}")
    };
    match text.strip_prefix('-') {
        // A negative number that rounds to zero is written as zero.
        Some(digits) if digits.bytes().all(|byte| matches!(byte, b'0' | b'.')) => digits.to_owned(),
        Some(digits) => format!("−{digits}"),
        None => text,
    }
}

/// Returns the SI prefix with which numbers up to `largest` are written, and the factor of the prefix, such as "k" and
/// 1000. There is no prefix if `largest` is between 0.1 and 10,000, or below 10⁻¹⁵, where numbers are written as powers
/// of ten.
pub(crate) fn si_prefix(largest: f64) -> (&'static str, f64) {
    let largest = largest.abs();
    if largest < 1e-15 || !largest.is_finite() || (0.1..1e4).contains(&largest) {
        return ("", 1.0);
    }
    [("G", 1e9), ("M", 1e6), ("k", 1e3), ("", 1.0), ("m", 1e-3), ("µ", 1e-6), ("n", 1e-9)]
        .into_iter()
        .find(|(_, factor)| largest >= *factor * (1.0 - 1e-9))
        .unwrap_or(("p", 1e-12))
}

/// Returns the text of a round length, m, with a suitable unit, such as "5 mm", "20 cm" or "1 km".
pub(crate) fn length(metres: f64) -> String {
    let (unit, factor) =
        [("km", 1e3), ("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("µm", 1e-6), ("nm", 1e-9)]
            .into_iter()
            .find(|(_, factor)| metres >= *factor * (1.0 - 1e-9))
            .unwrap_or(("pm", 1e-12));
    let value = metres / factor;
    format!("{} {unit}", decimal(value, round_below(value.max(1e-9)).min(1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_bars_are_round() {
        for (limit, expected) in [
            (1.0, 1.0),
            (0.9, 0.5),
            (0.2, 0.2),
            (0.0499, 0.02),
            (7.0, 5.0),
            (12.0, 10.0),
            (1e-6, 1e-6),
        ] {
            let found = round_below(limit);
            assert!((found / expected - 1.0).abs() < 1e-12, "{limit}: {found}");
        }
    }

    #[test]
    fn lengths_read_well() {
        for (metres, text) in [
            (0.01, "1 cm"),
            (0.005, "5 mm"),
            (0.2, "20 cm"),
            (2.0, "2 m"),
            (5e-4, "500 µm"),
            (1000.0, "1 km"),
            (5e5, "500 km"),
        ] {
            assert_eq!(length(metres), text);
        }
    }

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks(0.0, 1.0, 6).0, [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]);
        assert_eq!(ticks(-3.0, 4.0, 5).0, [-2.0, 0.0, 2.0, 4.0]);
        assert_eq!(ticks(2.0, 2.0, 5).0, [2.0]);
        assert_eq!(ticks(0.1, 6.2, 4).0, [2.0, 4.0, 6.0], "5 alone would say nothing");
        for (low, high) in [(0.0, 0.037), (1.3, 1.9), (-5e-7, 1e-6), (0.0, 8e5)] {
            let (found, _) = ticks(low, high, 6);
            assert!((2..=6).contains(&found.len()), "{low} … {high}: {found:?}");
            assert!(found.iter().all(|tick| (low - 1e-9..=high * 1.000001).contains(tick)));
        }
    }

    #[test]
    fn decimals_follow_the_step() {
        assert_eq!(decimal(0.6000000000000001, 0.2), "0.6");
        assert_eq!(decimal(-2.0, 1.0), "−2");
        assert_eq!(decimal(-1e-18, 0.1), "0.0");
        assert_eq!(decimal(1500.0, 500.0), "1500");
        assert_eq!(decimal(0.025, 0.005), "0.025");
        // A number that would need more zeros than are allowed is written as a power of ten.
        assert_eq!(decimal(2e-10, 1e-10), "2e−10");
        assert_eq!(decimal(-2.5e-8, 5e-9), "−2.5e−8");
        assert_eq!(decimal(0.0, 1e-10), "0");
        assert_eq!(decimal(6e9, 2e9), "6e9");
        assert_eq!(decimal(-2.5e300, 5e299), "−2.5e300");
        assert_ne!(decimal(10.0, 1e-11), decimal(10.0 + 1e-11, 1e-11));
    }

    #[test]
    fn ends_of_scales_are_a_little_above() {
        for (value, end) in [(0.93, 1.0), (1.0, 1.0), (1.2, 1.5), (0.021, 0.03), (9.1, 10.0)] {
            assert!((round_above(value) / end - 1.0).abs() < 1e-12, "{value}");
        }
    }

    #[test]
    fn prefixes_keep_numbers_short() {
        assert_eq!(si_prefix(0.5), ("", 1.0));
        assert_eq!(si_prefix(0.02), ("m", 1e-3));
        assert_eq!(si_prefix(3e-7), ("n", 1e-9));
        assert_eq!(si_prefix(2e4), ("k", 1e3));
        assert_eq!(si_prefix(0.0), ("", 1.0));
        assert_eq!(si_prefix(3e-22), ("", 1.0));
    }
}
