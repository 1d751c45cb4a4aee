//! Eight numbers at a time.
//!
//! Renderers are written once, over [`Lanes`], and run by [`with_lanes`] with the widest instructions that the machine has:
//! AVX2, or arrays that the compiler makes of what it can. A product and a sum are rounded one after the other everywhere,
//! so that all machines make the same bits.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod portable;

pub use portable::Portable;

/// How many there are.
pub const COUNT: usize = 8;

/// An array of what a function makes of 0, 1 and 2. Those of the standard library are not always inlined, and what is not
/// inlined is not compiled for the machine's own instructions.
#[inline(always)]
pub(crate) fn three<T>(of: impl Fn(usize) -> T) -> [T; 3] {
    [of(0), of(1), of(2)]
}

/// The same of 0 to 3.
#[inline(always)]
pub(crate) fn four<T>(of: impl Fn(usize) -> T) -> [T; 4] {
    [of(0), of(1), of(2), of(3)]
}

/// Operations on eight floats (`F`), whole numbers (`I`) or truths (`M`) at a time.
pub trait Lanes: Copy + Send + Sync {
    /// Eight floats.
    type F: Copy;
    /// Eight signed whole numbers.
    type I: Copy;
    /// Eight truths.
    type M: Copy;

    /// Runs work whose inlined operations then are this machine's instructions.
    fn run<R>(self, work: impl FnOnce() -> R) -> R;

    /// The same float in all lanes.
    fn splat(self, value: f32) -> Self::F;
    /// Floats of an array.
    fn floats(self, values: [f32; COUNT]) -> Self::F;
    /// Floats as an array.
    fn array(self, a: Self::F) -> [f32; COUNT];
    /// a + b
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    /// a - b
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    /// a · b
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    /// a / b
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// The smaller one; of numbers only.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// The larger one; of numbers only.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    /// Whether a < b.
    fn less(self, a: Self::F, b: Self::F) -> Self::M;
    /// Whether a ≥ b.
    fn at_least(self, a: Self::F, b: Self::F) -> Self::M;
    /// a where it is true, else b.
    fn select(self, is: Self::M, a: Self::F, b: Self::F) -> Self::F;
    /// Whether both are.
    fn both(self, a: Self::M, b: Self::M) -> Self::M;
    /// Which lanes are true, the first in the lowest bit.
    fn bits(self, a: Self::M) -> u32;

    /// The same whole number in all lanes.
    fn whole(self, value: i32) -> Self::I;
    /// Towards 0.
    fn truncated(self, a: Self::F) -> Self::I;
    /// As floats.
    fn float(self, a: Self::I) -> Self::F;
    /// a + b
    fn add_whole(self, a: Self::I, b: Self::I) -> Self::I;
    /// a · b, the lowest bits.
    fn mul_whole(self, a: Self::I, b: Self::I) -> Self::I;
    /// Eight bits of each, from a bit on, as floats.
    fn byte<const FROM: i32>(self, a: Self::I) -> Self::F;
    /// Sixteen bits of each, from a bit on, as floats.
    fn half<const FROM: i32>(self, a: Self::I) -> Self::F;
    /// The floats with these bits.
    fn of_bits(self, a: Self::I) -> Self::F;
    /// 2 to a power of -126 to 127.
    fn power(self, a: Self::I) -> Self::F;
    /// The square root, rounded as all operations are.
    fn sqrt(self, a: Self::F) -> Self::F;
    /// A float of at least 2⁻¹²⁶ as a number from 1 to 2 and the power of 2 that it is times of.
    fn parts(self, a: Self::F) -> (Self::F, Self::F);
    /// Of each of the four bytes the larger one.
    fn max_bytes(self, a: Self::I, b: Self::I) -> Self::I;
    /// The largest of the four bytes of each.
    fn highest_byte(self, a: Self::I) -> Self::F;
    /// All bits the other way round.
    fn inverted(self, a: Self::I) -> Self::I;

    /// The words at these places; past the end, or before the start, the last one. Zeros of no words.
    fn gather(self, words: &[u32], at: Self::I) -> Self::I;
    /// The rows at these places, column by column; zeros past the end.
    fn gather_rows(self, rows: &[[f32; 4]], at: Self::I) -> [Self::F; 4];

    /// a · b + c, with both roundings.
    #[inline(always)]
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        self.add(self.mul(a, b), c)
    }

    /// From a to b.
    #[inline(always)]
    fn mix(self, a: Self::F, b: Self::F, share: Self::F) -> Self::F {
        self.mul_add(self.sub(b, a), share, a)
    }

    /// Between two floats.
    #[inline(always)]
    fn clamp(self, a: Self::F, low: Self::F, high: Self::F) -> Self::F {
        self.min(self.max(a, low), high)
    }

    /// The logarithm to the base of 2, of floats of at least 2⁻¹²⁶, to 3e-7.
    #[inline(always)]
    fn log2(self, a: Self::F) -> Self::F {
        let (part, power) = self.parts(a);
        // Around 1: the series of the logarithm of (1 + s) / (1 - s).
        let is_high = self.less(self.splat(std::f32::consts::SQRT_2), part);
        let part = self.select(is_high, self.mul(part, self.splat(0.5)), part);
        let power = self.select(is_high, self.add(power, self.splat(1.0)), power);
        let one = self.splat(1.0);
        let s = self.div(self.sub(part, one), self.add(part, one));
        let square = self.mul(s, s);
        let mut sum = self.splat(1.0 / 9.0);
        sum = self.mul_add(sum, square, self.splat(1.0 / 7.0));
        sum = self.mul_add(sum, square, self.splat(1.0 / 5.0));
        sum = self.mul_add(sum, square, self.splat(1.0 / 3.0));
        sum = self.mul_add(sum, square, one);
        let of_part = self.mul(s, self.splat(2.0 * std::f32::consts::LOG2_E));
        self.mul_add(sum, of_part, power)
    }

    /// The size of a float.
    #[inline(always)]
    fn size(self, a: Self::F) -> Self::F {
        self.max(a, self.sub(self.splat(0.0), a))
    }

    /// 2 to the power of minus a, for a of 0 or more, to 2e-7 of it; no less than 2⁻¹²⁶.
    #[inline(always)]
    fn halved(self, a: Self::F) -> Self::F {
        let a = self.min(a, self.splat(126.0));
        let nearest = self.truncated(self.add(a, self.splat(0.5)));
        let rest = self.mul(
            self.sub(self.float(nearest), a),
            self.splat(std::f32::consts::LN_2),
        );
        // The series of the exponential of -0.35 to 0.35.
        let mut sum = self.splat(1.0 / 720.0);
        sum = self.mul_add(sum, rest, self.splat(1.0 / 120.0));
        sum = self.mul_add(sum, rest, self.splat(1.0 / 24.0));
        sum = self.mul_add(sum, rest, self.splat(1.0 / 6.0));
        sum = self.mul_add(sum, rest, self.splat(0.5));
        sum = self.mul_add(sum, rest, self.splat(1.0));
        sum = self.mul_add(sum, rest, self.splat(1.0));
        self.mul(sum, self.power(self.mul_whole(nearest, self.whole(-1))))
    }
}

/// Work that is done with any lanes.
pub trait Work {
    /// What comes of it.
    type Output;
    /// Does it.
    fn with<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// Does work with the widest lanes of this machine.
pub fn with_lanes<W: Work>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(lanes) = avx2::Avx2::find() {
        return work.with(lanes);
    }
    work.with(Portable)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What every operation makes, as bits.
    struct All;

    impl Work for All {
        type Output = Vec<u32>;
        fn with<L: Lanes>(self, l: L) -> Vec<u32> {
            let words = [7_u32, 0xfedc_ba98, 3];
            let rows = [[1.0_f32, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0]];
            let a = l.floats([0.0, -0.25, 1.5, 126.5, 3e5, 1e-30, -7.75, 2.0]);
            let b = l.floats([1.0, 3.0, -2.5, 0.1, 0.3, 1e-30, 11.0, 2.0]);
            let whole = l.truncated(a);
            let size = l.max(a, l.sub(l.splat(0.0), a));
            let mut all = vec![
                l.array(l.add(a, b)),
                l.array(l.mul(a, b)),
                l.array(l.div(a, b)),
                l.array(l.mix(a, b, l.splat(0.3))),
                l.array(l.clamp(a, l.splat(-1.0), l.splat(2.0))),
                l.array(l.select(l.both(l.less(a, b), l.at_least(b, b)), a, b)),
                l.array(l.halved(size)),
                l.array(l.float(l.add_whole(l.mul_whole(whole, whole), whole))),
            ];
            // Places before the start and past the end as well.
            let word = l.gather(&words, whole);
            all.push(l.array(l.byte::<0>(word)));
            all.push(l.array(l.byte::<16>(word)));
            all.push(l.array(l.byte::<24>(word)));
            all.push(l.array(l.half::<0>(word)));
            all.push(l.array(l.half::<16>(word)));
            all.push(l.array(l.of_bits(word)));
            all.push(l.array(l.highest_byte(word)));
            all.push(l.array(l.highest_byte(l.max_bytes(l.inverted(word), whole))));
            let positive = l.max(size, l.splat(1e-30));
            all.push(l.array(l.sqrt(positive)));
            all.push(l.array(l.log2(positive)));
            all.push(l.array(l.parts(positive).0));
            all.push(l.array(l.float(l.gather(&[], whole))));
            all.extend(four(|i| l.array(l.gather_rows(&rows, whole)[i])));
            let bits = l.bits(l.less(a, b));
            let all = all.into_iter().flatten().map(f32::to_bits);
            all.chain([bits]).collect()
        }
    }

    #[test]
    fn all_machines_make_the_same_bits() {
        let portable = All.with(Portable);
        assert!(with_lanes(All) == portable);
        // The last word stands for all beyond: 3, its lowest byte, of places 126, 300000 and -7.
        let bytes: Vec<f32> = portable[64..72]
            .iter()
            .map(|bits| f32::from_bits(*bits))
            .collect();
        assert_eq!(bytes, [7.0, 7.0, 152.0, 3.0, 3.0, 7.0, 3.0, 3.0]);
    }

    #[test]
    fn logarithms_are_right_to_3e_7() {
        for i in 1..10_000_u16 {
            let a = f32::from(i) * 0.000_37;
            let [found, ..] = Portable.log2(Portable.splat(a));
            let truth = f64::from(a).log2();
            let error = (f64::from(found) - truth).abs() / truth.abs().max(1.0);
            assert!(error < 3e-7, "{a}: {found} for {truth}");
        }
        assert_eq!(Portable.log2(Portable.splat(1.0))[0], 0.0);
    }

    #[test]
    fn powers_of_a_half_are_right_to_2e_7() {
        for i in 0..10_000_u16 {
            let a = f32::from(i) * 0.0125;
            let [found, ..] = Portable.halved(Portable.splat(a));
            let truth = (-f64::from(a)).exp2();
            assert!(
                (f64::from(found) / truth - 1.0).abs() < 2e-7,
                "{a}: {found}"
            );
        }
        assert_eq!(Portable.halved(Portable.splat(0.0))[0], 1.0);
        assert!(Portable.halved(Portable.splat(1e30))[0] < 2e-38);
    }
}
