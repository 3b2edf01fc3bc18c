//! From numbers to places along an axis, and the numbers written at it.

/// How an axis is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// In ratio.
    Log,
}

/// Marks on a linear axis, about.
const MARKS: f64 = 6.0;

/// On a logarithmic axis that ends below this many times its beginning, 2 and 5 have words too.
const SHORT: f64 = 80.0;

impl Scale {
    /// Where a number stands, in a unit that grows evenly along the axis.
    pub(super) fn place(self, number: f64) -> f64 {
        match self {
            Self::Linear => number,
            Self::Log => number.max(f64::MIN_POSITIVE).log10(),
        }
    }

    /// Round numbers between two others, with the words for them; those without words are minor.
    pub(super) fn marks(self, from: f64, to: f64) -> Vec<(f64, String)> {
        match self {
            Self::Linear => linear_marks(from, to),
            Self::Log => log_marks(from, to),
        }
    }
}

fn linear_marks(from: f64, to: f64) -> Vec<(f64, String)> {
    let rough = (to - from) / MARKS;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power).into_iter();
    let step = step.min_by(|a, b| (a - rough).abs().total_cmp(&(b - rough).abs())).unwrap_or(power);
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let first = (from / step - 1e-9).ceil() as i64;
    let last = (to / step + 1e-9).floor() as i64;
    (first..=last)
        .map(|index| index as f64 * step)
        .map(|number| (number, format!("{number:.decimals$}").replace('-', "−")))
        .collect()
}

fn log_marks(from: f64, to: f64) -> Vec<(f64, String)> {
    let (first, last) = (from.log10().floor() as i32, to.log10().ceil() as i32);
    let mut marks = Vec::new();
    for exponent in first..=last {
        for digit in 1..10 {
            let number = f64::from(digit) * 10f64.powi(exponent);
            if number >= from * (1.0 - 1e-9) && number <= to * (1.0 + 1e-9) {
                let words = match digit {
                    1 => power_of_ten(exponent),
                    2 | 5 if to < SHORT * from && PLAIN.contains(&exponent) => format!("{number}"),
                    2 | 5 if to < SHORT * from => format!("{digit}·{}", power_of_ten(exponent)),
                    _ => String::new(),
                };
                marks.push((number, words));
            }
        }
    }
    marks
}

/// Exponents of numbers that are written out.
const PLAIN: std::ops::RangeInclusive<i32> = -2..=2;

/// 10⁻⁴, and plain numbers from 0.01 to 100.
fn power_of_ten(exponent: i32) -> String {
    if PLAIN.contains(&exponent) {
        return format!("{}", 10f64.powi(exponent));
    }
    let digits = exponent.to_string();
    let raised = digits.chars().map(|sign| match sign {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32('⁰' as u32 + digit.to_digit(10).unwrap_or(0)).unwrap_or(digit),
    });
    format!("10{}", raised.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_round_numbers() {
        let words = |scale: Scale, from, to| -> Vec<String> {
            let marks = scale.marks(from, to).into_iter().map(|(_, words)| words);
            marks.filter(|words| !words.is_empty()).collect()
        };
        assert_eq!(
            words(Scale::Linear, 0.0, 0.6),
            ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6"]
        );
        assert_eq!(
            words(Scale::Linear, -10.0, 5.0),
            ["−10", "−8", "−6", "−4", "−2", "0", "2", "4"]
        );
        assert_eq!(
            words(Scale::Log, 8e-5, 6e-3),
            ["10⁻⁴", "2·10⁻⁴", "5·10⁻⁴", "10⁻³", "2·10⁻³", "5·10⁻³"]
        );
        assert_eq!(words(Scale::Log, 1e-12, 1e-11), ["10⁻¹²", "2·10⁻¹²", "5·10⁻¹²", "10⁻¹¹"]);
        assert_eq!(words(Scale::Log, 2.0, 100.0), ["2", "5", "10", "20", "50", "100"]);
        assert_eq!(words(Scale::Log, 1e-4, 1e-2), ["10⁻⁴", "10⁻³", "0.01"]);
    }
}
