//! The text of numbers and times in the window. The window shows times in milliseconds; files and command lines contain
//! seconds.

use egui::DragValue;

/// Units of time that a text field accepts, each with the power of ten by which a number in this unit is multiplied to
/// convert it to seconds. A number without a unit is in milliseconds.
const UNITS: [(&str, i32); 5] = [("ms", -3), ("us", -6), ("µs", -6), ("μs", -6), ("s", 0)];

/// Converts a text such as "2 ms", "200 us", "1e-3 s" or "2" to a time in seconds; `None` if the text is not a time.
pub(super) fn read_secs(text: &str) -> Option<f64> {
    let with_unit = UNITS.iter().find_map(|(unit, power)| Some((text.strip_suffix(unit)?, *power)));
    let (number, power) = with_unit.unwrap_or((text, -3));
    shifted(number.trim(), power)
}

/// Converts a time (s) to milliseconds. The decimal digits stay the same, so that [`read_secs`] converts the result
/// back to exactly the same time.
pub(super) fn millis(secs: f64) -> f64 {
    shifted(&format!("{secs:e}"), 3).unwrap_or(1e3 * secs)
}

/// Returns the text of a simulated time (s) for display, in milliseconds with one decimal. Very long times are written
/// as powers of ten.
pub(super) fn clock_text(secs: f64) -> String {
    let millis = 1e3 * secs;
    if millis < 1e7 { format!("{millis:.1} ms") } else { format!("{millis:.3e} ms") }
}

/// Returns the text for a slump (relative drop of the mean height), as the window shows it below a pile.
pub(super) fn slump_text(slump: f64) -> String {
    format!("slump Δy {slump:.3}")
}

/// Returns a text field for a time. The time is stored in seconds; the field shows and reads milliseconds.
pub(super) fn time_field(secs: &mut f64) -> DragValue<'_> {
    DragValue::new(secs)
        .custom_formatter(|secs, _| written((1e9 * secs).round() / 1e6))
        .custom_parser(|text| read_secs(text.trim()))
        .suffix(" ms")
}

/// Formats a number as people type it: short, and so that reading the text returns the same number.
pub(super) fn written(value: f64) -> String {
    if value == 0.0 || (1e-2..1e5).contains(&value.abs()) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

/// Returns the decimal number in `text`, multiplied by ten to the power `power`.
fn shifted(text: &str, power: i32) -> Option<f64> {
    let (digits, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let exponent = exponent.parse::<i32>().ok()?.checked_add(power)?;
    format!("{digits}e{exponent}").parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_read_back() {
        for (value, text) in
            [(1e-3, "1e-3"), (2.5e-4, "2.5e-4"), (0.0, "0"), (100.0, "100"), (0.1, "0.1")]
        {
            assert_eq!(written(value), text);
            assert_eq!(text.parse::<f64>(), Ok(value));
        }
    }

    #[test]
    fn a_field_understands_three_units_and_takes_a_plain_number_as_milliseconds() {
        for (text, secs) in [
            ("2", 2e-3),
            ("2 ms", 2e-3),
            ("2ms", 2e-3),
            ("200 us", 2e-4),
            ("200 µs", 2e-4),
            ("200 μs", 2e-4),
            ("1e-3 s", 1e-3),
            ("0.3", 3e-4),
            ("5e-2", 5e-5),
        ] {
            assert_eq!(read_secs(text), Some(secs), "{text}");
        }
        for text in ["", "ms", "s", "2 min", "e3", "two"] {
            assert_eq!(read_secs(text), None, "{text}");
        }
    }

    #[test]
    fn a_time_reads_back_as_the_same_time() {
        for secs in [1e-4, 3e-4, 7e-4, 2.3e-3, 1.0 / 3.0, 0.1 + 0.2, 1e-300, 0.0] {
            assert_eq!(read_secs(&written(millis(secs))), Some(secs), "{secs}");
        }
        assert_eq!(written(millis(3e-4)), "0.3");
        assert_eq!(clock_text(0.35), "350.0 ms");
        assert_eq!(clock_text(1e200), "1.000e203 ms");
    }
}
