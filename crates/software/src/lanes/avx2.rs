//! Lanes as registers of AVX2.

use bytemuck::cast;
use pulp::x86::V3;
use pulp::{f32x8, i32x8, m32x8, u32x8};

use super::{COUNT, Lanes, four};

/// That this machine has AVX2.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx2(V3);

impl Avx2 {
    pub(super) fn find() -> Option<Self> {
        V3::try_new().map(Self)
    }
}

struct Called<F>(F);

impl<F: FnOnce() -> R, R> pulp::NullaryFnOnce for Called<F> {
    type Output = R;
    #[inline(always)]
    fn call(self) -> R {
        (self.0)()
    }
}

impl Lanes for Avx2 {
    type F = f32x8;
    type I = i32x8;
    type M = m32x8;

    #[inline(always)]
    fn run<R>(self, work: impl FnOnce() -> R) -> R {
        self.0.vectorize(Called(work))
    }
    #[inline(always)]
    fn splat(self, value: f32) -> f32x8 {
        self.0.splat_f32x8(value)
    }
    #[inline(always)]
    fn floats(self, values: [f32; COUNT]) -> f32x8 {
        cast(values)
    }
    #[inline(always)]
    fn array(self, a: f32x8) -> [f32; COUNT] {
        cast(a)
    }
    #[inline(always)]
    fn add(self, a: f32x8, b: f32x8) -> f32x8 {
        self.0.add_f32x8(a, b)
    }
    #[inline(always)]
    fn sub(self, a: f32x8, b: f32x8) -> f32x8 {
        self.0.sub_f32x8(a, b)
    }
    #[inline(always)]
    fn mul(self, a: f32x8, b: f32x8) -> f32x8 {
        self.0.mul_f32x8(a, b)
    }
    #[inline(always)]
    fn div(self, a: f32x8, b: f32x8) -> f32x8 {
        self.0.div_f32x8(a, b)
    }
    #[inline(always)]
    fn min(self, a: f32x8, b: f32x8) -> f32x8 {
        self.0.min_f32x8(a, b)
    }
    #[inline(always)]
    fn max(self, a: f32x8, b: f32x8) -> f32x8 {
        self.0.max_f32x8(a, b)
    }
    #[inline(always)]
    fn less(self, a: f32x8, b: f32x8) -> m32x8 {
        self.0.cmp_lt_f32x8(a, b)
    }
    #[inline(always)]
    fn at_least(self, a: f32x8, b: f32x8) -> m32x8 {
        self.0.cmp_ge_f32x8(a, b)
    }
    #[inline(always)]
    fn select(self, is: m32x8, a: f32x8, b: f32x8) -> f32x8 {
        self.0.select_f32x8(is, a, b)
    }
    #[inline(always)]
    fn both(self, a: m32x8, b: m32x8) -> m32x8 {
        self.0.and_m32x8(a, b)
    }
    #[inline(always)]
    fn bits(self, a: m32x8) -> u32 {
        self.0.avx._mm256_movemask_ps(cast(a)).cast_unsigned()
    }
    #[inline(always)]
    fn whole(self, value: i32) -> i32x8 {
        self.0.splat_i32x8(value)
    }
    #[inline(always)]
    fn truncated(self, a: f32x8) -> i32x8 {
        cast(self.0.avx._mm256_cvttps_epi32(cast(a)))
    }
    #[inline(always)]
    fn float(self, a: i32x8) -> f32x8 {
        self.0.convert_i32x8_to_f32x8(a)
    }
    #[inline(always)]
    fn add_whole(self, a: i32x8, b: i32x8) -> i32x8 {
        self.0.wrapping_add_i32x8(a, b)
    }
    #[inline(always)]
    fn mul_whole(self, a: i32x8, b: i32x8) -> i32x8 {
        self.0.wrapping_mul_i32x8(a, b)
    }
    #[inline(always)]
    fn byte<const FROM: i32>(self, a: i32x8) -> f32x8 {
        let shifted: u32x8 = self.0.shr_const_u32x8::<FROM>(cast(a));
        if FROM == 24 {
            return self.float(cast(shifted));
        }
        self.float(cast(self.0.and_u32x8(shifted, self.0.splat_u32x8(0xff))))
    }
    #[inline(always)]
    fn half<const FROM: i32>(self, a: i32x8) -> f32x8 {
        let shifted: u32x8 = self.0.shr_const_u32x8::<FROM>(cast(a));
        if FROM == 16 {
            return self.float(cast(shifted));
        }
        self.float(cast(self.0.and_u32x8(shifted, self.0.splat_u32x8(0xffff))))
    }
    #[inline(always)]
    fn of_bits(self, a: i32x8) -> f32x8 {
        cast(a)
    }
    #[inline(always)]
    fn power(self, a: i32x8) -> f32x8 {
        let biased = self.add_whole(a, self.whole(127));
        cast(self.0.shl_const_i32x8::<23>(biased))
    }
    #[inline(always)]
    fn sqrt(self, a: f32x8) -> f32x8 {
        cast(self.0.avx._mm256_sqrt_ps(cast(a)))
    }
    #[inline(always)]
    fn parts(self, a: f32x8) -> (f32x8, f32x8) {
        let bits: u32x8 = cast(a);
        let power = self.0.shr_const_u32x8::<23>(bits);
        let power = self.float(self.add_whole(cast(power), self.whole(-127)));
        let digits = self.0.and_u32x8(bits, self.0.splat_u32x8(0x7f_ffff));
        let part = self.0.or_u32x8(digits, self.0.splat_u32x8(127 << 23));
        (cast(part), power)
    }
    #[inline(always)]
    fn max_bytes(self, a: i32x8, b: i32x8) -> i32x8 {
        cast(self.0.avx2._mm256_max_epu8(cast(a), cast(b)))
    }
    #[inline(always)]
    fn highest_byte(self, a: i32x8) -> f32x8 {
        let halves: u32x8 = self.0.shr_const_u32x8::<16>(cast(a));
        let of_two = self.max_bytes(a, cast(halves));
        let other: u32x8 = self.0.shr_const_u32x8::<8>(cast(of_two));
        self.byte::<0>(self.max_bytes(of_two, cast(other)))
    }
    #[inline(always)]
    fn inverted(self, a: i32x8) -> i32x8 {
        cast(self.0.xor_u32x8(cast(a), self.0.splat_u32x8(u32::MAX)))
    }
    #[inline(always)]
    fn gather(self, words: &[u32], at: i32x8) -> i32x8 {
        // Offsets of the instruction are signed: the last one must be a positive number.
        let Some(last) = words.len().min(1 << 31).checked_sub(1) else {
            return self.whole(0);
        };
        #[expect(clippy::cast_possible_truncation, reason = "less than 2^31")]
        let last = self.0.splat_u32x8(last as u32);
        let at = self.0.min_u32x8(cast(at), last);
        // SAFETY: all places are at most `last`, which is a word of the slice and fits a positive i32. The compiler makes
        // no gather of eight checked loads, and they are most of the time of a picture.
        #[expect(unsafe_code, reason = "see above")]
        let found = unsafe {
            self.0
                .avx2
                ._mm256_i32gather_epi32::<4>(words.as_ptr().cast(), cast(at))
        };
        cast(found)
    }
    #[inline(always)]
    fn gather_rows(self, rows: &[[f32; 4]], at: i32x8) -> [f32x8; 4] {
        let at: [u32; COUNT] = cast(at);
        let avx = self.0.avx;
        let [a, b, c, d] = four(
            #[inline(always)]
            |lane| {
                let [low, high] = [at[lane], at[lane + 4]];
                let low = *rows.get(low as usize).unwrap_or(&[0.0; 4]);
                let high = *rows.get(high as usize).unwrap_or(&[0.0; 4]);
                avx._mm256_insertf128_ps::<1>(avx._mm256_castps128_ps256(cast(low)), cast(high))
            },
        );
        let (xy_ab, zw_ab) = (avx._mm256_unpacklo_ps(a, b), avx._mm256_unpackhi_ps(a, b));
        let (xy_cd, zw_cd) = (avx._mm256_unpacklo_ps(c, d), avx._mm256_unpackhi_ps(c, d));
        [
            cast(avx._mm256_shuffle_ps::<0x44>(xy_ab, xy_cd)),
            cast(avx._mm256_shuffle_ps::<0xee>(xy_ab, xy_cd)),
            cast(avx._mm256_shuffle_ps::<0x44>(zw_ab, zw_cd)),
            cast(avx._mm256_shuffle_ps::<0xee>(zw_ab, zw_cd)),
        ]
    }
}
