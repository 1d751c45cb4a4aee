//! Tables of a transfer function over raw scalars, as the graphics processor's raycast has them.

use volgraph_optics::{IntegralTable, OpticsError, TransferFunction};

/// Colour and opacity of a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Classify {
    /// The transfer function at the scalar of the segment's centre.
    Post,
    /// Its means over the scalars from end to end, from tables of its integrals (Knittel 2002).
    Integral1d(Attenuation),
}

/// The opacity of an optical depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attenuation {
    /// 1 - exp(-x)
    Exact,
    /// The least of four lines, off by 0.0226 at most.
    FourLines,
}

/// The scalars of a volume that a transfer function is about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// The data value at its position 0, and how much larger that at 1 is.
    pub values: (f64, f64),
    /// The volume's smallest spacing in world units.
    pub spacing: f64,
}

/// A transfer function in tables, for steps of one length.
#[derive(Clone, Debug)]
pub struct Tables {
    pub(crate) classify: Classify,
    /// Of the place of a raw scalar, in cells of the integral's table or else in entries: factor and summand.
    pub(crate) place: (f32, f32),
    /// The place of the last entry.
    pub(crate) last: f32,
    /// Entries of `rows` for each place.
    pub(crate) rows_per_place: f32,
    /// Linear colour and extinction, per reference length, in entries.
    pub(crate) rows: Vec<[f32; 4]>,
    /// What a whole step of that shows: premultiplied colour, and the share of light that goes through.
    pub(crate) whole: Vec<[f32; 4]>,
    /// Three for each column: the integral, what it has been rounded by, and what the column adds.
    pub(crate) integrals: Vec<[f32; 4]>,
    /// Halvings of light per world unit at an extinction of 1.
    pub(crate) halvings_per_world: f32,
    /// Places up to which nothing is seen.
    pub(crate) clear_below: f32,
    /// Of each entry and each column the number before it that absorb.
    entries_before: Vec<u32>,
    columns_before: Vec<u32>,
    low: f64,
    per_value: f64,
}

#[expect(clippy::cast_possible_truncation, reason = "tables hold f32")]
fn single(value: f64) -> f32 {
    value as f32
}

impl Tables {
    /// Tables of so many entries, for raw scalars of a grid with this offset and for steps of this world length.
    ///
    /// # Errors
    /// [`OpticsError::TableSize`].
    pub fn new(
        transfer: &TransferFunction,
        units: Units,
        offset: f64,
        classify: Classify,
        size: u32,
        step_world: f64,
    ) -> Result<Self, OpticsError> {
        let rows = transfer.post_table(size)?.entries;
        let integrals = match classify {
            Classify::Post => Vec::new(),
            Classify::Integral1d(_) => {
                let table = transfer.integral_table(size)?;
                let row = |at: usize, row: usize| table.entries[row * size as usize + at];
                (0..size as usize)
                    .flat_map(|at| [row(at, 0), row(at, 1), row(at, 2)])
                    .collect()
            }
        };
        let per_world = transfer
            .reference_length()
            .extinction_per_world(units.spacing);
        let whole = rows.iter().map(|[r, g, b, extinction]| {
            let depth = f64::from(*extinction) * per_world * step_world;
            let opacity = -(-depth).exp_m1();
            let [r, g, b] = [r, g, b].map(|color| single(f64::from(*color) * opacity));
            [r, g, b, single(1.0 - opacity)]
        });
        let whole = match classify {
            Classify::Post => whole.collect(),
            Classify::Integral1d(_) => Vec::new(),
        };
        let [low, high] =
            [transfer.range().0, transfer.range().1].map(|at| units.values.0 + at * units.values.1);
        let entries = f64::from(size - 1);
        let places = match classify {
            Classify::Post => entries,
            Classify::Integral1d(_) => f64::from(IntegralTable::cells(size)),
        };
        let per_value = places / (high - low);
        let before = |absorbing: &mut dyn Iterator<Item = bool>| {
            let mut count = 0;
            let mut before = vec![0];
            for is_one in absorbing {
                count += u32::from(is_one);
                before.push(count);
            }
            before
        };
        let entries_before = before(&mut rows.iter().map(|row| row[3] > 0.0));
        let columns_before =
            before(&mut integrals.iter().skip(2).step_by(3).map(|row| row[3] > 0.0));
        let mut tables = Self {
            classify,
            place: (single(per_value), single((offset - low) * per_value)),
            last: single(places),
            rows_per_place: single(entries / places),
            rows,
            whole,
            integrals,
            halvings_per_world: single(per_world * std::f64::consts::LOG2_E),
            clear_below: f32::MIN,
            entries_before,
            columns_before,
            low,
            per_value,
        };
        tables.clear_below = tables.first_seen();
        Ok(tables)
    }

    /// The place up to which nothing is seen.
    fn first_seen(&self) -> f32 {
        let first = |before: &[u32]| before.iter().position(|count| *count > 0);
        // Entry `i` counts from place `i - 1` on, and so does column `i`; what the first one shows holds below.
        let place = |before: &[u32], per_place: f64| match first(before) {
            None => f64::INFINITY,
            Some(1) => f64::NEG_INFINITY,
            #[expect(clippy::cast_precision_loss, reason = "some thousand")]
            Some(after) => (after as f64 - 2.0) / per_place - 1e-2,
        };
        let entries = place(&self.entries_before, f64::from(self.rows_per_place));
        single(
            entries
                .min(place(&self.columns_before, 1.0))
                .clamp(-1e30, 1e30),
        )
    }

    /// Whether anything of data values between two is seen.
    pub(crate) fn is_seen(&self, [low, high]: [f64; 2]) -> bool {
        let any = |before: &[u32], from: f64, to: f64| {
            let last = before.len() - 1;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "clamped to a table"
            )]
            let at = |place: f64| (place.max(0.0) as usize).min(last);
            before[at(to)] > before[at(from).min(last.saturating_sub(1))]
        };
        let [from, to] = [low, high].map(|value| (value - self.low) * self.per_value);
        let per_place = f64::from(self.rows_per_place);
        // One more on either side: places are rounded.
        any(
            &self.entries_before,
            from * per_place - 1.0,
            to * per_place + 3.0,
        ) || any(&self.columns_before, from, to + 3.0)
    }
}
