//! The numbers that a contact's arithmetic is written for.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

use fearless_simd::{Select, Simd, SimdBase, f64x4};

/// A number, or one a lane of a vector register. Every lane does just what the number alone does,
/// to the last bit, signed zeros and NaN included: the order of operations is the code's, and none
/// are fused.
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
    /// `number` in as many lanes as `self` has.
    fn same(self, number: f64) -> Self;
    /// The larger of two numbers as one machine instruction; `other` where `self` is NaN.
    fn larger(self, other: Self) -> Self;
    /// The smaller of two numbers as one machine instruction; `other` where `self` is NaN.
    fn smaller(self, other: Self) -> Self;
    /// The number without its sign.
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

/// Comparisons and choices, since the crate's own `max` and `min` differ between processors in
/// signed zeros and NaN.
impl<S: Simd> Lanes for f64x4<S> {
    #[inline(always)]
    fn same(self, number: f64) -> Self {
        Self::splat(self.simd, number)
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.simd_gt(other).select(self, other)
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        self.simd_lt(other).select(self, other)
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }
}
