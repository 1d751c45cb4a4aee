//! What a slab between two slices shows, for its scalars: made for the length that it has along the rays of a view.

use volgraph_optics::{OpticsError, PostTable, TransferFunction};

use crate::lanes::{Lanes, four};
use crate::tables::Units;

/// Colour and opacity of a slab.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlabClassify {
    /// Of the scalar in the middle of the slab: slices as Lacroute and Levoy composite them.
    Post,
    /// Integrals of all scalars from its front to its back (Schulze et al. 2003).
    Preintegrated,
}

/// How the pre-integrated table is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lookup {
    /// The nearest entry.
    Nearest,
    /// Between four.
    Bilinear,
}

/// What is done about slabs that are longer along slanted rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Correction {
    /// The table is made for that length.
    Exact,
    /// Opacity and colour of a table for rays across the slices are corrected, entry by entry (section 2.2).
    Scaled,
    /// Nothing: slanted rays see too little.
    None,
}

/// A transfer function in a table for slabs of one length.
#[derive(Clone, Debug)]
pub struct SlabTable {
    pub(super) classify: SlabClassify,
    pub(super) lookup: Lookup,
    /// Premultiplied colour, and the share of light that goes through; `[front + size · back]`, or `[middle]`.
    entries: Vec<[f32; 4]>,
    /// Of the place of a raw scalar: factor and summand.
    place: (f32, f32),
    size: i32,
}

#[expect(clippy::cast_possible_truncation, reason = "tables hold f32")]
fn single(value: f64) -> f32 {
    value as f32
}

impl SlabTable {
    /// Entries of the table over one scalar.
    pub const POST_SIZE: u32 = PostTable::MAX_SIZE;

    /// For slabs of this world length, and `across` that of rays across the slices; `size` entries a side.
    ///
    /// # Errors
    /// [`OpticsError::TableSize`], [`OpticsError::SegmentLength`].
    #[expect(clippy::too_many_arguments, reason = "one table, many ways to make it")]
    pub fn new(
        transfer: &TransferFunction,
        units: Units,
        offset: f64,
        classify: SlabClassify,
        lookup: Lookup,
        correction: Correction,
        size: u32,
        [world, across]: [f64; 2],
    ) -> Result<Self, OpticsError> {
        let made_for = match correction {
            Correction::Exact => world,
            _ => across,
        };
        let size = match classify {
            SlabClassify::Post => Self::POST_SIZE,
            SlabClassify::Preintegrated => size,
        };
        let raw = Self::uncorrected(transfer, units, classify, size, made_for)?;
        let by = match correction {
            Correction::Scaled => world / across,
            _ => 1.0,
        };
        let entries = raw.iter().map(|[r, g, b, depth]| {
            let depth = f64::from(*depth);
            let opacity = -(-depth * by).exp_m1();
            // Colour grows as opacity does.
            let factor = match -(-depth).exp_m1() {
                before if before > 0.0 => opacity / before,
                _ => by,
            };
            let [r, g, b] = [r, g, b].map(|color| single(f64::from(*color) * factor));
            [r, g, b, single(1.0 - opacity)]
        });
        let [low, high] = values(transfer, units);
        let per_value = f64::from(size - 1) / (high - low);
        Ok(Self {
            classify,
            lookup,
            entries: entries.collect(),
            place: (single(per_value), single((offset - low) * per_value)),
            size: size.cast_signed(),
        })
    }

    /// Colour as it is emitted, and optical depth, of slabs of a length.
    fn uncorrected(
        transfer: &TransferFunction,
        units: Units,
        classify: SlabClassify,
        size: u32,
        world: f64,
    ) -> Result<Vec<[f32; 4]>, OpticsError> {
        let per_world = transfer
            .reference_length()
            .extinction_per_world(units.spacing);
        if classify == SlabClassify::Preintegrated {
            return Ok(transfer
                .preintegrated_table(size, world * per_world)?
                .entries);
        }
        let rows = transfer.post_table(size)?.entries;
        let entries = rows.iter().map(|[r, g, b, extinction]| {
            let depth = f64::from(*extinction) * per_world * world;
            let opacity = -(-depth).exp_m1();
            let [r, g, b] = [r, g, b].map(|color| single(f64::from(*color) * opacity));
            [r, g, b, single(depth)]
        });
        Ok(entries.collect())
    }

    /// Data values that a cell of the table spans.
    pub(super) fn cell(transfer: &TransferFunction, units: Units, size: u32) -> f64 {
        let [low, high] = values(transfer, units);
        (high - low) / f64::from(size - 1)
    }

    /// Premultiplied colour and transmittance of slabs with these scalars, of which `Post` takes the first.
    #[inline(always)]
    pub(super) fn look<L: Lanes>(&self, l: L, front: L::F, back: L::F) -> [L::F; 4] {
        let front = self.place(l, front);
        if self.classify == SlabClassify::Post {
            return l.gather_rows(&self.entries, nearest(l, front));
        }
        let back = self.place(l, back);
        let size = l.whole(self.size);
        if self.lookup == Lookup::Nearest {
            let at = l.add_whole(l.mul_whole(nearest(l, back), size), nearest(l, front));
            return l.gather_rows(&self.entries, at);
        }
        // The last cell starts one before the last entry.
        #[expect(clippy::cast_precision_loss, reason = "some thousand")]
        let last_cell = l.splat((self.size - 2) as f32);
        let x = l.truncated(l.min(front, last_cell));
        let y = l.truncated(l.min(back, last_cell));
        let (u, v) = (l.sub(front, l.float(x)), l.sub(back, l.float(y)));
        let at = l.add_whole(l.mul_whole(y, size), x);
        let [a, b, c, d] = [
            self.load(l, at, 0),
            self.load(l, at, 1),
            self.load(l, at, self.size),
            self.load(l, at, self.size + 1),
        ];
        four(
            #[inline(always)]
            |i| l.mix(l.mix(a[i], b[i], u), l.mix(c[i], d[i], u), v),
        )
    }

    /// Where scalars are among the entries of a side.
    #[inline(always)]
    fn place<L: Lanes>(&self, l: L, scalar: L::F) -> L::F {
        let place = l.mul_add(scalar, l.splat(self.place.0), l.splat(self.place.1));
        #[expect(clippy::cast_precision_loss, reason = "some thousand")]
        let last = (self.size - 1) as f32;
        l.clamp(place, l.splat(0.0), l.splat(last))
    }

    #[inline(always)]
    fn load<L: Lanes>(&self, l: L, at: L::I, more: i32) -> [L::F; 4] {
        l.gather_rows(&self.entries, l.add_whole(at, l.whole(more)))
    }
}

#[inline(always)]
fn nearest<L: Lanes>(l: L, place: L::F) -> L::I {
    l.truncated(l.add(place, l.splat(0.5)))
}

/// The data values at the ends of a transfer function's range.
fn values(transfer: &TransferFunction, units: Units) -> [f64; 2] {
    [transfer.range().0, transfer.range().1].map(|at| units.values.0 + at * units.values.1)
}

/// A slab of which rays pass a share alone: its colour and transmittance (section 2.2 of the paper).
pub(super) fn shortened([r, g, b, open]: [f32; 4], share: f32) -> [f32; 4] {
    let part = open.powf(share);
    let opacity = 1.0 - open;
    let factor = if opacity > 1e-6 {
        (1.0 - part) / opacity
    } else {
        share
    };
    [r * factor, g * factor, b * factor, part]
}
