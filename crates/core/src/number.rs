//! Functions that write numbers to files and round them, with the same result from every compiler. The attribute
//! `#[serde(with = "number")]` writes infinities and NaN as strings, because JSON does not have such numbers and
//! `null` could not be read back as a number.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serializer};

/// Writes a finite number as a number, and any other number as the string `inf`, `-inf` or `NaN`.
pub fn serialize<S: Serializer>(number: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if number.is_finite() {
        serializer.serialize_f64(*number)
    } else {
        serializer.serialize_str(&number.to_string())
    }
}

/// Reads a number that [`serialize`] has written.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Said {
        Number(f64),
        Word(String),
    }
    match Said::deserialize(deserializer)? {
        Said::Number(number) => Ok(number),
        Said::Word(word) => word.parse().map_err(D::Error::custom),
    }
}

/// True if a number is 0. A field with this value is not written to files.
pub(crate) fn is_zero<N: Default + PartialEq>(number: &N) -> bool {
    *number == N::default()
}

/// The positive and the negative part of a number, with the same bits from every compiler. `f64::max` and `f64::min`
/// do not specify if they return 0.0 or -0.0, and compilers differ.
pub trait Parts {
    /// Returns the larger of the number and 0. Returns 0.0 for NaN and for both zeros.
    fn positive_part(self) -> Self;
    /// Returns the smaller of the number and 0. Returns 0.0 for NaN and for both zeros.
    fn negative_part(self) -> Self;
}

impl Parts for f64 {
    #[inline(always)]
    fn positive_part(self) -> Self {
        if self > 0.0 { self } else { 0.0 }
    }

    #[inline(always)]
    fn negative_part(self) -> Self {
        if self < 0.0 { self } else { 0.0 }
    }
}

/// Rounds a number > 0 down to two significant digits.
pub(crate) fn rounded_down(number: f64) -> f64 {
    let unit = libm::pow(10.0, libm::log10(number).floor() - 1.0);
    let below = (number / unit).floor() * unit;
    // Parse the decimal form, because the product has a rounding error.
    format!("{below:.1e}").parse().unwrap_or(below)
}

/// Returns a time, given in seconds, as text in milliseconds with the unit, such as `12.5 ms`, with up to four digits.
pub fn millis_text(secs: f64) -> String {
    let millis = 1e3 * secs;
    format!("{} ms", format!("{millis:.3e}").parse().unwrap_or(millis))
}

#[cfg(test)]
mod tests {
    use super::Parts;

    #[test]
    fn parts_have_the_positive_zero_whichever_zero_they_are_of() {
        for number in [0.0, -0.0, f64::NAN] {
            assert_eq!(number.positive_part().to_bits(), 0.0f64.to_bits(), "{number:?}");
            assert_eq!(number.negative_part().to_bits(), 0.0f64.to_bits(), "{number:?}");
        }
        for number in [5e-324, 1.0, f64::INFINITY] {
            assert_eq!([number.positive_part(), (-number).positive_part()], [number, 0.0]);
            assert_eq!([number.negative_part(), (-number).negative_part()], [0.0, -number]);
        }
    }

    #[derive(Debug, PartialEq, serde::Serialize, serde::Deserialize)]
    struct Row {
        #[serde(with = "super")]
        number: f64,
    }

    #[test]
    fn numbers_that_are_not_finite_read_back_as_what_they_were() {
        for number in [0.1 + 0.2, -0.0, 1.0, 5e-324, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            let text = serde_json::to_string(&Row { number }).expect("JSON");
            let read: Row = serde_json::from_str(&text).expect("what was written");
            assert_eq!(read.number.is_nan(), number.is_nan(), "{text}");
            assert!(number.is_nan() || read.number.to_bits() == number.to_bits(), "{text}");
        }
        assert!(serde_json::from_str::<Row>("{\"number\":null}").is_err());
        assert!(serde_json::from_str::<Row>("{\"number\":\"much\"}").is_err());
    }
}
