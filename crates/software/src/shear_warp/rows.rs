//! A row of the intermediate image while slabs go by: what it shows so far, and the scalars that the next slab begins with.

/// Links over pixels that are opaque: each one that is done points to a later one.
pub(super) struct Links(Vec<u32>);

impl Links {
    fn new(width: usize) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "pixels of a row")]
        Self((0..=width as u32).collect())
    }

    fn reset(&mut self) {
        for (at, link) in (0_u32..).zip(&mut self.0) {
            *link = at;
        }
    }

    /// The first pixel from one on that is not done; the width where there is none.
    #[inline(always)]
    pub(super) fn open_from(&mut self, pixel: usize) -> usize {
        let mut open = pixel;
        while self.0[open] as usize != open {
            open = self.0[open] as usize;
        }
        // So that the way is short the next time.
        let mut at = pixel;
        while at != open {
            let next = self.0[at] as usize;
            #[expect(clippy::cast_possible_truncation, reason = "pixels of a row")]
            {
                self.0[at] = open as u32;
            }
            at = next;
        }
        open
    }

    /// A pixel is done.
    #[inline(always)]
    pub(super) fn close(&mut self, pixel: usize) {
        #[expect(clippy::cast_possible_truncation, reason = "pixels of a row")]
        {
            self.0[pixel] = pixel as u32 + 1;
        }
    }
}

/// What a core keeps of the row that it is at.
pub(super) struct State {
    /// Premultiplied colour, and the share of light that goes through; eight pixels more than there are.
    pub color: [Vec<f32>; 4],
    pub links: Links,
    /// The slices between which the ray of each pixel is in the box and before the eye.
    pub intervals: Vec<[f64; 2]>,
    /// A row of voxels of a slice as the row of pixels meets it; the first one is that before the first voxel.
    pub line: Vec<f32>,
    /// The buffer slice.
    pub buffer: Vec<f32>,
    /// Pixels of this slab that may be seen, and those of the one before.
    pub parts: Vec<[usize; 2]>,
    pub last_parts: Vec<[usize; 2]>,
}

impl State {
    pub(super) fn new(width: usize, voxels: usize, buffer: usize) -> Self {
        Self {
            color: std::array::from_fn(|_| vec![0.0; width + 8]),
            links: Links::new(width),
            intervals: vec![[0.0; 2]; width],
            line: vec![0.0; voxels + 32],
            buffer: vec![0.0; buffer],
            parts: Vec::new(),
            last_parts: Vec::new(),
        }
    }

    pub(super) fn reset(&mut self) {
        for (channel, value) in self.color.iter_mut().zip([0.0, 0.0, 0.0, 1.0]) {
            channel.fill(value);
        }
        self.links.reset();
        self.parts.clear();
        self.last_parts.clear();
    }
}

/// What of rising intervals is in no interval of others, which rise as well.
pub(super) fn without(all: &[[usize; 2]], others: &[[usize; 2]], mut of: impl FnMut([usize; 2])) {
    let mut next = 0;
    for &[from, to] in all {
        let mut at = from;
        while at < to {
            while next < others.len() && others[next][1] <= at {
                next += 1;
            }
            let Some([start, end]) = others.get(next).copied() else {
                of([at, to]);
                break;
            };
            if start > at {
                of([at, to.min(start)]);
            }
            at = end.max(at);
            if start >= to {
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_without_others_are_those_of_a_search() {
        for salt in 0..4000_usize {
            let mask = |factor: usize| (0..12).map(move |i| (salt * factor + 77) >> i & 1 == 1);
            let intervals = |factor: usize| {
                let mut found: Vec<[usize; 2]> = Vec::new();
                for (i, is_one) in mask(factor).enumerate() {
                    match found.last_mut() {
                        Some(last) if is_one && last[1] == i => last[1] += 1,
                        _ if is_one => found.push([i, i + 1]),
                        _ => {}
                    }
                }
                found
            };
            let mut found = [false; 12];
            without(&intervals(13), &intervals(59), |[from, to]| {
                assert!(from < to);
                found[from..to].fill(true);
            });
            let truth: Vec<bool> = mask(13).zip(mask(59)).map(|(a, b)| a && !b).collect();
            assert_eq!(found.to_vec(), truth, "{salt}");
        }
    }

    #[test]
    fn links_lead_over_all_that_is_done() {
        let mut links = Links::new(10);
        for pixel in [3, 4, 2, 9, 5] {
            links.close(pixel);
        }
        let found: Vec<usize> = (0..=10).map(|at| links.open_from(at)).collect();
        assert_eq!(found, [0, 1, 6, 6, 6, 6, 6, 7, 8, 10, 10]);
    }
}
