//! Lanes as arrays, for any machine.

use super::{COUNT, Lanes};

/// Eight numbers in an array.
#[derive(Clone, Copy, Debug)]
pub struct Portable;

#[inline(always)]
fn each<A: Copy, B: Copy, R>(a: [A; COUNT], b: [B; COUNT], of: impl Fn(A, B) -> R) -> [R; COUNT] {
    std::array::from_fn(|lane| of(a[lane], b[lane]))
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "what processors do with eight numbers at a time"
)]
impl Lanes for Portable {
    type F = [f32; COUNT];
    type I = [i32; COUNT];
    type M = [bool; COUNT];

    #[inline(always)]
    fn run<R>(self, work: impl FnOnce() -> R) -> R {
        work()
    }
    #[inline(always)]
    fn splat(self, value: f32) -> Self::F {
        [value; COUNT]
    }
    #[inline(always)]
    fn floats(self, values: [f32; COUNT]) -> Self::F {
        values
    }
    #[inline(always)]
    fn array(self, a: Self::F) -> [f32; COUNT] {
        a
    }
    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> Self::F {
        each(a, b, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> Self::F {
        each(a, b, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> Self::F {
        each(a, b, |a, b| a * b)
    }
    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> Self::F {
        each(a, b, |a, b| a / b)
    }
    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> Self::F {
        each(a, b, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> Self::F {
        each(a, b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn less(self, a: Self::F, b: Self::F) -> Self::M {
        each(a, b, |a, b| a < b)
    }
    #[inline(always)]
    fn at_least(self, a: Self::F, b: Self::F) -> Self::M {
        each(a, b, |a, b| a >= b)
    }
    #[inline(always)]
    fn select(self, is: Self::M, a: Self::F, b: Self::F) -> Self::F {
        std::array::from_fn(|lane| if is[lane] { a[lane] } else { b[lane] })
    }
    #[inline(always)]
    fn both(self, a: Self::M, b: Self::M) -> Self::M {
        each(a, b, |a, b| a & b)
    }
    #[inline(always)]
    fn bits(self, a: Self::M) -> u32 {
        (0..COUNT).fold(0, |bits, lane| bits | (u32::from(a[lane]) << lane))
    }
    #[inline(always)]
    fn whole(self, value: i32) -> Self::I {
        [value; COUNT]
    }
    #[inline(always)]
    fn truncated(self, a: Self::F) -> Self::I {
        a.map(|a| a as i32)
    }
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "as the instruction does")]
    fn float(self, a: Self::I) -> Self::F {
        a.map(|a| a as f32)
    }
    #[inline(always)]
    fn add_whole(self, a: Self::I, b: Self::I) -> Self::I {
        each(a, b, i32::wrapping_add)
    }
    #[inline(always)]
    fn mul_whole(self, a: Self::I, b: Self::I) -> Self::I {
        each(a, b, i32::wrapping_mul)
    }
    #[inline(always)]
    fn byte<const FROM: i32>(self, a: Self::I) -> Self::F {
        a.map(|a| f32::from((a as u32 >> FROM) as u8))
    }
    #[inline(always)]
    fn half<const FROM: i32>(self, a: Self::I) -> Self::F {
        a.map(|a| f32::from((a as u32 >> FROM) as u16))
    }
    #[inline(always)]
    fn of_bits(self, a: Self::I) -> Self::F {
        a.map(|a| f32::from_bits(a as u32))
    }
    #[inline(always)]
    fn power(self, a: Self::I) -> Self::F {
        a.map(|a| f32::from_bits((a.wrapping_add(127) as u32) << 23))
    }
    #[inline(always)]
    fn sqrt(self, a: Self::F) -> Self::F {
        a.map(f32::sqrt)
    }
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "eight bits")]
    fn parts(self, a: Self::F) -> (Self::F, Self::F) {
        let part = |a: f32| f32::from_bits((a.to_bits() & 0x7f_ffff) | (127 << 23));
        let power = |a: f32| ((a.to_bits() >> 23) as i32 - 127) as f32;
        (a.map(part), a.map(power))
    }
    #[inline(always)]
    fn max_bytes(self, a: Self::I, b: Self::I) -> Self::I {
        each(a, b, |a, b| {
            let (a, b) = (a.to_ne_bytes(), b.to_ne_bytes());
            i32::from_ne_bytes(std::array::from_fn(|i| a[i].max(b[i])))
        })
    }
    #[inline(always)]
    fn highest_byte(self, a: Self::I) -> Self::F {
        a.map(|a| f32::from(a.to_ne_bytes().into_iter().fold(0, u8::max)))
    }
    #[inline(always)]
    fn inverted(self, a: Self::I) -> Self::I {
        a.map(|a| !a)
    }
    #[inline(always)]
    fn gather(self, words: &[u32], at: Self::I) -> Self::I {
        let Some(last) = words.len().checked_sub(1) else {
            return [0; COUNT];
        };
        at.map(|at| words[(at as u32 as usize).min(last)] as i32)
    }
    #[inline(always)]
    fn gather_rows(self, rows: &[[f32; 4]], at: Self::I) -> [Self::F; 4] {
        let found = at.map(|at| rows.get(at as u32 as usize).copied().unwrap_or_default());
        std::array::from_fn(|column| found.map(|row| row[column]))
    }
}
