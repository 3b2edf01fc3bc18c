//! Trait for the numbers with which the contact laws are computed: a single number, or a vector register that holds the
//! numbers of several contacts.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

use fearless_simd::{Select, Simd, SimdBase, f64x4};

/// A number, or a vector register with one number per lane. Each lane gives exactly the same bits as the code for a
/// single number, also for signed zeros and NaN. For this, operations are done in the order of the code, and a
/// multiplication and an addition are never fused.
pub trait Lanes:
    Copy
    + Debug
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + 'static
{
    /// Returns a number of this type that has the value `number` in each lane.
    fn same(self, number: f64) -> Self;
    /// Returns the larger of two numbers, lane by lane, in one machine instruction; `other` if either is NaN.
    fn larger(self, other: Self) -> Self;
    /// Returns the smaller of two numbers, lane by lane, in one machine instruction; `other` if either is NaN.
    fn smaller(self, other: Self) -> Self;
    /// Returns the absolute value, lane by lane.
    fn magnitude(self) -> Self;
}

impl Lanes for f64 {
    #[inline(always)]
    fn same(self, number: f64) -> Self {
        number
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }
}

impl<S: Simd> Lanes for f64x4<S> {
    #[inline(always)]
    fn same(self, number: f64) -> Self {
        Self::splat(self.simd, number)
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        if SECOND_WHERE_UNDECIDED {
            self.max(other)
        } else {
            self.simd_gt(other).select(self, other)
        }
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        if SECOND_WHERE_UNDECIDED {
            self.min(other)
        } else {
            self.simd_lt(other).select(self, other)
        }
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }
}

/// True if the minimum and maximum instructions of the processor return the second operand if either operand is NaN
/// or both are zeros.
const SECOND_WHERE_UNDECIDED: bool = cfg!(any(target_arch = "x86_64", target_arch = "x86"));

/// Returns the vector instruction sets that this processor supports.
#[cfg(test)]
pub(crate) fn levels() -> Vec<fearless_simd::Level> {
    let best = fearless_simd::Level::new();
    #[cfg(target_arch = "x86_64")]
    let lower = [best.as_sse2().map(Simd::level), best.as_avx2().map(Simd::level)];
    #[cfg(not(target_arch = "x86_64"))]
    let lower = [None; 0];
    lower.into_iter().flatten().chain([best]).collect()
}

#[cfg(test)]
mod tests {
    use fearless_simd::{SimdFrom, dispatch};

    use super::*;

    #[test]
    fn a_lane_does_just_what_a_number_does() {
        let numbers = [0.0, -0.0, 1.0, -1.0, 1e-310, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
        let bits = |numbers: [f64; 4]| numbers.map(f64::to_bits);
        for level in levels() {
            for a in numbers {
                let b = [0, 4].map(|at| [0, 1, 2, 3].map(|lane| numbers[at + lane]));
                for b in b {
                    dispatch!(level, simd => {
                        let (left, right) = (f64x4::simd_from(simd, [a; 4]), f64x4::simd_from(simd, b));
                        let what = format!("{level:?}, {a} and {b:?}");
                        let found = [left.larger(right), left.smaller(right), right.magnitude()];
                        let wanted = [b.map(|b| a.larger(b)), b.map(|b| a.smaller(b)), b.map(f64::abs)];
                        assert_eq!(found.map(|found| bits(found.to_array())), wanted.map(bits), "{what}");
                    });
                }
            }
        }
    }
}
