//! a·b + c rounded once, where the processor has no such operation.
//!
//! The product is uₕ + uₗ without error (Veltkamp's splitting, Dekker's product), and so is what the sum leaves over; of
//! that the last bit is made odd where it is not exact, so that the last sum is rounded as if it were the first (S. Boldo
//! and G. Melquiond 2008, *Emulation of FMA and correctly rounded sums*, algorithm 5). It takes some 50 operations; the
//! general one of a library, which unpacks its numbers, takes several times as long.

/// Largest and smallest product of which no part leaves the range of numbers.
const MOST: f64 = 1e250;
const LEAST: f64 = 1e-250;
/// Cuts a number in two halves of 26 bits: 2²⁷ + 1.
const SPLIT: f64 = 134_217_729.0;

/// a·b + c.
#[inline(always)]
pub(super) fn multiply_add(a: f64, b: f64, c: f64) -> f64 {
    let product = a * b;
    if product == 0.0 && (a == 0.0 || b == 0.0) {
        return product + c;
    }
    let is_within = |number: f64| number.abs() < MOST;
    if !(is_within(a) && is_within(b) && is_within(c) && is_within(product))
        || product.abs() < LEAST
    {
        return a.mul_add(b, c);
    }
    let product_rest = rest_of_product(a, b, product);
    let (small, small_rest) = sum(c, product_rest);
    let (large, large_rest) = sum(product, small);
    large + sum_to_odd(small_rest, large_rest)
}

/// a·b less what it is rounded to.
#[inline(always)]
fn rest_of_product(a: f64, b: f64, product: f64) -> f64 {
    let halves = |number: f64| {
        let scaled = SPLIT * number;
        let high = scaled - (scaled - number);
        (high, number - high)
    };
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low)
}

/// A sum and what it is rounded by (Knuth).
#[inline(always)]
fn sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// A sum; where it is not exact, that of its two neighbours whose last bit is 1.
#[inline(always)]
fn sum_to_odd(a: f64, b: f64) -> f64 {
    let (sum, rest) = sum(a, b);
    let bits = sum.to_bits();
    let is_even = bits & 1 == 0;
    let step = if (rest > 0.0) == (sum > 0.0) { 1 } else { u64::MAX };
    f64::from_bits(bits.wrapping_add(if rest != 0.0 && is_even { step } else { 0 }))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Numbers of all sizes, with few bits and with many, so that sums cancel, tie and vanish.
    fn number() -> impl Strategy<Value = f64> {
        let few =
            (-9i32..=9, -60i32..60).prop_map(|(digit, power)| f64::from(digit) * 2f64.powi(power));
        let many = (any::<u64>(), -80i32..80).prop_map(|(bits, power)| {
            let digits = 1.0 + (bits >> 12) as f64 * f64::EPSILON;
            digits * 2f64.powi(power) * if bits & 1 == 0 { 1.0 } else { -1.0 }
        });
        prop_oneof![few, many, any::<f64>()]
    }

    fn assert_fused(a: f64, b: f64, c: f64) {
        let (ours, exact) = (multiply_add(a, b, c), a.mul_add(b, c));
        assert!(
            ours.to_bits() == exact.to_bits() || ours.is_nan() && exact.is_nan(),
            "{a:e} · {b:e} + {c:e}: {ours:e}, not {exact:e}"
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn it_is_rounded_once(a in number(), b in number(), c in number()) {
            assert_fused(a, b, c);
            // What is left of a product, and what lies half a last bit beside it.
            assert_fused(a, b, -(a * b));
            let half_a_bit = 0.5 * f64::EPSILON * (a * b);
            assert_fused(a, b, half_a_bit);
            assert_fused(a, 1.0, half_a_bit);
            assert_fused(a, b, half_a_bit * (1.0 + f64::EPSILON));
        }
    }

    #[test]
    fn the_cases_that_two_roundings_get_wrong_are_among_them() {
        let one = 1.0 + 2f64.powi(-30);
        let (a, b) = (one, one);
        assert_ne!(a * b - 1.0, a.mul_add(b, -1.0), "two roundings differ");
        for (a, b, c) in [
            (a, b, -1.0),
            (0.0, -3.0, -0.0),
            (-0.0, 3.0, -0.0),
            (f64::INFINITY, 0.0, 1.0),
            (f64::MAX, 2.0, -f64::MAX),
            (f64::MIN_POSITIVE, f64::MIN_POSITIVE, f64::MIN_POSITIVE),
        ] {
            assert_fused(a, b, c);
        }
    }
}
