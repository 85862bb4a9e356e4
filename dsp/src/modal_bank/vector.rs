//! Vectors of the bank: how many modes go side by side, and how they come and go.
#![allow(unsafe_code)]

use super::LANES;
use super::design::{HOT, Lanes, place};
use crate::simd::Set;
use fearless_simd::SimdFloat;
use fearless_simd::prelude::*;

/// A few modes side by side.
pub(super) type Vector<T> = <T as Simd>::f32s;

/// Number of them; divides [`LANES`].
pub(super) const fn len<T: Set>() -> usize {
    <Vector<T> as SimdBase<T>>::LEN
}

/// True where coefficients are read once a chunk, into registers or the stack; otherwise every use
/// reads the group, which is faster where it is one operand of the multiplication.
pub(super) const fn keeps_coefficients<T: Set>() -> bool {
    len::<T>() != 8
}

/// Number of groups that go best at once.
pub(super) const fn groups_at_once<T: Set>() -> usize {
    if len::<T>() == LANES { 3 } else { 4 }
}

/// Reads a vector.
///
/// # Safety
/// There are [`len`] values.
#[inline(always)]
pub(super) unsafe fn load<T: Set>(token: T, from: *const f32) -> Vector<T> {
    // SAFETY: the caller's promise.
    SimdBase::from_slice(token, unsafe { core::slice::from_raw_parts(from, len::<T>()) })
}

/// Reads all lanes of an array whose halves have changed places; `from` is where they lie.
///
/// # Safety
/// There are [`LANES`] values.
#[inline(always)]
pub(super) unsafe fn load_swapped<T: Set>(token: T, from: *const f32) -> Vector<T> {
    // SAFETY: the caller's promise.
    token.swap_halves(unsafe { load(token, from) })
}

/// The lanes from `lane` on of coefficient `i`, wherever [`place`] has put them.
///
/// # Safety
/// There are [`len`] lanes from `lane` on.
#[inline(always)]
pub(super) unsafe fn load_placed<T: Set>(token: T, hot: &[Lanes; HOT], i: usize, lane: usize) -> Vector<T> {
    // SAFETY: the caller's promise.
    unsafe {
        match i % 2 {
            1 if len::<T>() == LANES => load_swapped(token, hot[i].as_ptr()),
            _ => load(token, hot[i].as_ptr().add(place(i, lane))),
        }
    }
}

/// Writes a vector.
///
/// # Safety
/// There is room for [`len`] values, whatever they were.
#[inline(always)]
pub(super) unsafe fn store<T: Set>(x: Vector<T>, to: *mut f32) {
    const { assert!(size_of::<Vector<T>>() == len::<T>() * size_of::<f32>()) }
    // SAFETY: the caller's promise; a vector lies in memory as its lanes do, and no alignment is
    // asked for.
    unsafe { to.cast::<Vector<T>>().write_unaligned(x) }
}

/// x · by + plus; one rounding where the processor has it.
#[inline(always)]
pub(super) fn mul_add<T: Set>(x: Vector<T>, by: Vector<T>, plus: Vector<T>) -> Vector<T> {
    if T::FUSED { x.mul_add(by, plus) } else { x * by + plus }
}

/// Product for a large `x` and small `plus`. Where products are rounded apart, that of the part of
/// `by` beyond 1 is, which is exact from 0.5 on.
#[inline(always)]
pub(super) fn mul_add_near_one<T: Set>(token: T, x: Vector<T>, by: Vector<T>, plus: Vector<T>) -> Vector<T> {
    if T::FUSED {
        return x.mul_add(by, plus);
    }
    let splat = |x| Vector::<T>::splat(token, x);
    let whole = by.simd_ge(splat(0.5)).select(splat(1.0), splat(0.0));
    x * whole + (x * (by - whole) + plus)
}
