//! Integrals of the transfer function over one scalar (Knittel, "Using pre-integrated transfer functions in an
//! interactive software system for volume rendering", 2002): a mean between two scalars is the difference of two
//! entries by that of the scalars.

use super::cells::Cells;
use crate::post::PostTable;
use crate::{OpticsError, TransferFunction};

/// Integrals of extinction and of colour times extinction, from the start of the range.
///
/// Exact over the knots of the transfer function, in float64; an entry is the sum of two floats, right to 1e-13 of the
/// whole range's integral.
#[derive(Clone, Debug, PartialEq)]
pub struct IntegralTable {
    /// Columns, `n`: one for scalars below the range, `n - 2` cells, the last of which starts at the range's end and
    /// goes on without one. The range is `n - 2` cells long.
    pub columns: u32,
    /// Three rows of `n`. Column `i` is the cell from place `i - 1` on, places being counted in cells from the range's
    /// start. First and second row: the integral up to there, over places, of linear RGB times extinction per reference
    /// length, and of that extinction, and what its rounding to floats has left over. Third row: what one cell adds.
    pub entries: Vec<[f32; 4]>,
}

impl IntegralTable {
    /// Cells over the range, of a table of so many columns.
    #[must_use]
    pub fn cells(columns: u32) -> u32 {
        columns.saturating_sub(2).max(1)
    }
}

impl TransferFunction {
    /// The integrals in so many columns, [`PostTable::MIN_SIZE`] to [`PostTable::MAX_SIZE`].
    ///
    /// # Errors
    /// [`OpticsError::TableSize`].
    pub fn integral_table(&self, columns: u32) -> Result<IntegralTable, OpticsError> {
        PostTable::check_size(columns, "integral")?;
        let count = IntegralTable::cells(columns);
        let cells = Cells::integrate(self, count + 1, 0.0, 0.0);
        let (lo, hi) = self.range();
        let beyond = |s: f64| {
            let extinction = self.extinction(s);
            let [r, g, b] = self.color(s).map(|c| c * extinction);
            [r, g, b, extinction]
        };
        // A step at the very start shows its first value below.
        let below = beyond(lo - 1e-9 * (hi - lo));
        let inside = (0..count as usize).map(|cell| cells.integral(cell));
        let changes: Vec<[f64; 4]> = std::iter::once(below)
            .chain(inside)
            .chain([beyond(hi)])
            .collect();
        let size = columns as usize;
        let mut entries = vec![[0.0; 4]; 3 * size];
        let mut sum = below.map(|value| -value);
        for (column, change) in changes.iter().enumerate() {
            entries[column] = sum.map(|value| value as f32);
            for channel in 0..4 {
                let float = entries[column][channel];
                entries[size + column][channel] = (sum[channel] - f64::from(float)) as f32;
                sum[channel] += change[channel];
            }
            entries[2 * size + column] = change.map(|value| value as f32);
        }
        Ok(IntegralTable { columns, entries })
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// The mean between two places, as shaders read it, in float64.
    fn mean(table: &IntegralTable, from: f64, to: f64) -> [f64; 4] {
        let size = table.columns as usize;
        let at = |place: f64, channel: usize| {
            let cell = place.floor().clamp(-1.0, f64::from(table.columns - 2));
            let column = (cell + 1.0) as usize;
            let entry = |row: usize| f64::from(table.entries[row * size + column][channel]);
            entry(0) + entry(1) + (place - cell) * entry(2)
        };
        std::array::from_fn(|channel| (at(to, channel) - at(from, channel)) / (to - from))
    }

    #[test]
    fn means_between_entries_are_those_of_fine_sums() {
        // A step, and a peak of a tenth of an entry. Opacity 1 has a pole that sums of midpoints do not get right.
        let text = "(points: [(at: 0, color: (1, 0, 0), opacity: 0.1), (at: 0.3, color: (0, 1, 0.5), opacity: 0.1),
            (at: 0.3, color: (0, 0, 1), opacity: 0.9), (at: 0.5, color: (1, 1, 1), opacity: 0),
            (at: 0.6, color: (0.2, 0.1, 0.7), opacity: 0), (at: 0.6001, color: (1, 0.3, 0), opacity: 0.99),
            (at: 0.6002, color: (1, 1, 1), opacity: 0), (at: 1, color: (0, 0, 0), opacity: 0.5)])";
        let transfer = TransferFunction::parse(Path::new("t.ron"), text).unwrap();
        let table = transfer.integral_table(1026).unwrap();
        for (from, to) in [
            (0.0, 1024.0),
            (300.0, 320.0),
            (610.0, 620.0),
            (1023.0, 1024.0),
            (614.0, 615.0),
        ] {
            let found = mean(&table, from, to);
            let n = 400_000;
            let mut sum = [0.0; 4];
            for i in 0..n {
                let place = from + (f64::from(i) + 0.5) / f64::from(n) * (to - from);
                let s = place / 1024.0;
                let extinction = transfer.extinction(s);
                for (channel, c) in transfer.color(s).into_iter().chain([1.0]).enumerate() {
                    sum[channel] += c * extinction / f64::from(n);
                }
            }
            // Midpoints lose a sample's worth at a step: 400,000 samples, up to 16 times the mean.
            for channel in 0..4 {
                let error = (found[channel] - sum[channel]).abs();
                assert!(
                    error < 4e-5 * sum[3].max(1e-3),
                    "{from} to {to}: {found:?} {sum:?}"
                );
            }
        }
    }

    #[test]
    fn beyond_the_range_the_ends_hold_and_close_scalars_do_not_cancel() {
        let text = "(domain: data, points: [(at: 0.2, color: (1, 1, 1), opacity: 0.5), (at: 0.2, color: (1, 1, 1), opacity: 1),
            (at: 0.8, color: (0.5, 1, 0), opacity: 0.25)])";
        let transfer = TransferFunction::parse(Path::new("t.ron"), text).unwrap();
        let table = transfer.integral_table(8192).unwrap();
        let (lo, hi) = transfer.range();
        let place = |s: f64| (s - lo) / (hi - lo) * 8190.0;
        let below = mean(&table, place(lo) - 3000.0, place(lo) - 10.0)[3];
        assert!(
            (below - transfer.extinction(lo - 1.0)).abs() < 1e-6,
            "{below}"
        );
        let above = mean(&table, 8195.0, 9000.5)[3];
        assert!(
            (above - transfer.extinction(hi + 1.0)).abs() < 1e-6,
            "{above}"
        );
        // One float alone would be off by 2.4e-4 of the mean here.
        let near = mean(&table, 8100.0, 8101.0)[3];
        let truth = transfer.extinction(lo + 8100.5 / 8190.0 * (hi - lo));
        assert!((near - truth).abs() < 1e-7 * truth, "{near} {truth}");
    }

    #[test]
    fn sizes_that_are_none_are_refused() {
        let transfer = TransferFunction::parse(
            Path::new("t.ron"),
            "(points: [(at: 0, color: (0, 0, 0), opacity: 0)])",
        )
        .unwrap();
        assert!(transfer.integral_table(100).is_err());
        assert!(transfer.integral_table(8193).is_err());
    }
}
