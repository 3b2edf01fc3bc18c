//! Numbers in files, whether or not they are finite: JSON has no word for those that are not, and what
//! is written as `null` reads back as nothing. For `#[serde(with = "number")]`.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serializer};

/// A number, or as a string `inf`, `-inf` or `NaN`.
pub fn serialize<S: Serializer>(number: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if number.is_finite() {
        serializer.serialize_f64(*number)
    } else {
        serializer.serialize_str(&number.to_string())
    }
}

/// What [`serialize`] wrote.
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

/// True where a number is 0, which files leave out.
pub(crate) fn is_zero<N: Default + PartialEq>(number: &N) -> bool {
    *number == N::default()
}

#[cfg(test)]
mod tests {
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
