//! What is known of every brick, gathered from all blocks of all levels.

use std::ops::Range;

use volgraph_volume::{Histogram, VolumeError};

use super::BrickStatistics;
use super::build::Build;
use super::field::Field;
use super::levels::first_in;
use super::plan::{block_bytes, longest};
use super::side::{self, BINS, Packed};
use super::source::Source;
use super::survey::{Found, Survey};
use super::tally::Tally;

impl Build<'_> {
    /// What is known of all bricks of all levels.
    pub(super) fn survey(
        &self,
        source: &Source,
        fields: Vec<&Field>,
        tally: &Tally,
    ) -> Result<(BrickStatistics, Vec<Vec<Packed>>), VolumeError> {
        let (levels, edge) = (&source.levels, self.options.edge);
        let survey = Survey {
            fields,
            levels,
            edge,
            range: tally.range(),
            mean: tally.mean(),
        };
        let counts = side::counts(levels[0].grid.dims, edge);
        let table = |&count: &u64| vec![(0.0, 0.0); usize::try_from(count).unwrap_or(usize::MAX)];
        let mut ranges: Vec<Vec<(f64, f64)>> = counts.iter().map(table).collect();
        let mut errors: Vec<Vec<(f64, f64)>> = counts.iter().map(table).collect();
        let mut bins = vec![0_u64; BINS];
        let mut squares = 0.0;
        let size = source.scalar_type.size() as u64;
        let fits = |count: u32| block_bytes(edge, count, size, [u32::MAX; 3]) <= self.plan.each;
        for number in 0..levels.len() {
            let bricks = levels[number].bricks;
            let along = [longest(bricks[0], fits), 2, 2];
            let blocks = [0, 1, 2].map(|i| bricks[i].div_ceil(along[i]));
            self.each(
                blocks,
                |at| {
                    let block: [Range<u32>; 3] = [0, 1, 2].map(|i| {
                        let start = at[i] * along[i];
                        start..start.saturating_add(along[i]).min(bricks[i])
                    });
                    let found = survey.block(number, &block)?;
                    let dims = levels[number].grid.dims;
                    let core = [0, 1, 2].map(|i| {
                        block[i].end.saturating_mul(edge).min(dims[i]) - block[i].start * edge
                    });
                    self.report(core, source.scalar_type);
                    Ok(found)
                },
                |found: Found| {
                    for (brick, min, max) in found.ranges {
                        ranges[number][brick] = (min, max);
                    }
                    bins.iter_mut()
                        .zip(found.bins)
                        .for_each(|(all, bin)| *all += bin);
                    squares += found.squares;
                    for (level, brick, sum, most) in found.errors {
                        let all = &mut errors[level][brick];
                        *all = (all.0 + sum, all.1.max(most));
                    }
                },
            )?;
        }
        let fine = levels[0].grid.dims;
        let packed =
            levels
                .iter()
                .zip(ranges.iter().zip(&errors))
                .map(|(level, (ranges, errors))| {
                    let [nx, ny, _] = level.bricks.map(|n| n as usize);
                    let one = |i: usize| {
                        let (range, error) = (ranges[i], errors[i]);
                        let at = [i % nx, i / nx % ny, i / (nx * ny)];
                        // Fine samples in the brick's box.
                        let samples = [0, 1, 2].map(|axis| {
                            let m = level.grid.dims[axis];
                            let first = |brick: usize| {
                                first_in((brick as u32).saturating_mul(edge).min(m), fine[axis], m)
                            };
                            f64::from(first(at[axis] + 1) - first(at[axis]))
                        });
                        let rms = (error.0 / samples.iter().product::<f64>()).sqrt();
                        // Rounding of the sum must not lift it over the largest one.
                        Packed::new(range.0, range.1, rms.min(error.1), error.1)
                    };
                    (0..ranges.len()).map(one).collect()
                });
        let (lo, hi) = tally.range();
        let known = tally.finite > 0;
        let or_nan = |value: f64| if known { value } else { f64::NAN };
        let statistics = BrickStatistics {
            min: or_nan(lo),
            max: or_nan(hi),
            mean: or_nan(tally.mean()),
            standard_deviation: or_nan((squares / tally.finite.max(1) as f64).sqrt()),
            finite_count: tally.finite,
            nan_count: tally.nan,
            positive_infinity_count: tally.positive,
            negative_infinity_count: tally.negative,
            histogram: Histogram {
                lo,
                hi,
                counts: bins,
            },
        };
        Ok((statistics, packed.collect()))
    }
}
