//! Which bricks of a volume may be seen, and how far from each the next one of the other kind is.

use rayon::prelude::*;
use volgraph_volume::BrickRanges;

use crate::tables::Tables;

/// How far each brick is from the next of the other kind, in bricks along the axis where that is most (Zuiderveld et al.
/// 1992): above 0 of bricks of which nothing is seen, below 0 of others.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceMap {
    /// Voxels along the edge of a brick.
    pub edge: u32,
    pub(crate) dims: [u32; 3],
    /// The bits of signed numbers.
    pub(crate) away: Vec<u32>,
}

/// Farther is as good.
const FARTHEST: i32 = 1 << 20;

impl DistanceMap {
    /// Of the ranges of bricks of so many voxels, taken with a margin of one voxel.
    #[must_use]
    pub fn new(bricks: &BrickRanges, edge: u32, tables: &Tables) -> Self {
        let seen: Vec<bool> = bricks
            .ranges
            .par_iter()
            .map(|range| tables.is_seen(*range))
            .collect();
        let (to_seen, to_clear) = rayon::join(
            || distances(bricks.dims, |at| seen[at]),
            || distances(bricks.dims, |at| !seen[at]),
        );
        let away = (0..seen.len()).map(|at| {
            let away = if seen[at] { -to_clear[at] } else { to_seen[at] };
            away.cast_unsigned()
        });
        Self {
            edge,
            dims: bricks.dims,
            away: away.collect(),
        }
    }
}

impl DistanceMap {
    /// The share of bricks of which something may be seen.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a share")]
    pub fn seen_share(&self) -> f64 {
        let seen = self.away.iter().filter(|away| away.cast_signed() <= 0);
        seen.count() as f64 / self.away.len().max(1) as f64
    }
}

/// Chebyshev distances to the next brick of a kind, exact, axis by axis.
fn distances(dims: [u32; 3], is_one: impl Fn(usize) -> bool) -> Vec<i32> {
    let [nx, ny, nz] = dims.map(|n| n as usize);
    let mut away: Vec<i32> = (0..nx * ny * nz)
        .map(|at| if is_one(at) { 0 } else { FARTHEST })
        .collect();
    for row in away.chunks_exact_mut(nx) {
        for x in 1..nx {
            row[x] = row[x].min(row[x - 1] + 1);
        }
        for x in (1..nx).rev() {
            row[x - 1] = row[x - 1].min(row[x] + 1);
        }
    }
    let by_axis = |away: &mut Vec<i32>, stride: usize, count: usize| {
        // The least over all others along the axis of the larger one of their distance and of how far they are.
        let lines: Vec<usize> = (0..away.len())
            .filter(|at| (at / stride).is_multiple_of(count))
            .collect();
        let mut line = vec![0; count];
        for start in lines {
            for (i, value) in line.iter_mut().enumerate() {
                *value = away[start + i * stride];
            }
            if line.iter().all(|away| *away >= FARTHEST) {
                continue;
            }
            for i in 0..count {
                let mut best = line[i];
                let mut step = 1;
                // No farther than what is found already.
                while i32::try_from(step).is_ok_and(|step| step < best)
                    && (step <= i || i + step < count)
                {
                    let far = i32::try_from(step).unwrap_or(FARTHEST);
                    if step <= i {
                        best = best.min(line[i - step].max(far));
                    }
                    if i + step < count {
                        best = best.min(line[i + step].max(far));
                    }
                    step += 1;
                }
                away[start + i * stride] = best;
            }
        }
    };
    by_axis(&mut away, nx, ny);
    by_axis(&mut away, nx * ny, nz);
    away
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_a_search_over_all_bricks() {
        let dims = [7_u32, 5, 6];
        let places: Vec<[u32; 3]> = (0..dims[2])
            .flat_map(|z| (0..dims[1]).flat_map(move |y| (0..dims[0]).map(move |x| [x, y, z])))
            .collect();
        for salt in 0..8_usize {
            let is_one = |at: usize| (at * 7919 + salt * 104_729) % 97 < 3 * salt;
            let found = distances(dims, is_one);
            for (at, place) in places.iter().enumerate() {
                let ones = places
                    .iter()
                    .enumerate()
                    .filter(|(other, _)| is_one(*other));
                let away = ones.map(|(_, other)| (0..3).map(|i| place[i].abs_diff(other[i])).max());
                let nearest = away.flatten().min();
                let truth = nearest.map_or(FARTHEST, |away| i32::try_from(away).unwrap());
                assert_eq!(found[at], truth, "{place:?} of {salt}");
            }
        }
    }
}
