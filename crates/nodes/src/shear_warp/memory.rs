//! What stays of pictures while the camera moves: voxels in the order of each main axis, their runs, and the table.

use std::sync::{Arc, Mutex, PoisonError, Weak};

use volgraph_optics::TransferFunction;
use volgraph_reference::{Background, Rays};
use volgraph_report::Finding;
use volgraph_software::shear_warp::{
    Correction, Hidden, Lookup, Runs, Shear, SlabClassify, SlabTable, Slices,
};
use volgraph_volume::Volume;

use super::drawing::ShearDrawing;

/// Made things that the last pictures needed, by what they were made of. Forgetting one costs time alone.
#[derive(Debug, Default)]
pub struct ShearMemory(Mutex<Remembered>);

/// Most of each kind: a volume has three main axes.
const MOST: usize = 3;

#[derive(Debug, Default)]
struct Remembered {
    slices: Vec<(Weak<Volume>, Arc<Slices>)>,
    runs: Vec<(Weak<Volume>, usize, Hidden, Arc<Runs>)>,
    tables: Vec<(TableKey, Arc<SlabTable>)>,
    behind: Vec<(Background, Lens, Pixels)>,
}

/// What a background's pixels depend on: half extent and size.
type Lens = ([u64; 2], [u32; 2]);

/// Colours in rows from the top.
type Pixels = Arc<Vec<[f32; 4]>>;

#[derive(Debug)]
struct TableKey {
    volume: Weak<Volume>,
    transfer: Weak<TransferFunction>,
    choices: (SlabClassify, Lookup, Correction, u32),
    lengths: [u64; 2],
}

/// All that a picture needs.
pub(super) struct Prepared {
    pub slices: Arc<Slices>,
    pub runs: Option<Arc<Runs>>,
    pub table: Arc<SlabTable>,
    pub behind: Arc<Vec<[f32; 4]>>,
}

/// Of those that were used last, which come first, that which fits; else one that is made.
fn remembered<T>(
    all: &mut Vec<T>,
    fits: impl Fn(&T) -> bool,
    make: impl FnOnce() -> Result<T, Finding>,
) -> Result<&T, Finding> {
    if let Some(at) = all.iter().position(fits) {
        all[..=at].rotate_right(1);
    } else {
        // Room first: what is forgotten and what is new need not be there at once.
        all.truncate(MOST - 1);
        all.insert(0, make()?);
    }
    Ok(&all[0])
}

impl ShearMemory {
    /// Lets go of all of it.
    pub(super) fn forget(&self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Remembered::default();
    }

    pub(super) fn prepare(&self, drawing: &ShearDrawing) -> Result<Prepared, Finding> {
        let mut memory = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        memory.slices.retain(|(it, _)| it.strong_count() > 0);
        memory.runs.retain(|(it, ..)| it.strong_count() > 0);
        memory
            .tables
            .retain(|(key, _)| key.volume.strong_count() > 0 && key.transfer.strong_count() > 0);
        let axis = Shear::main_axis(drawing.volume.grid(), &drawing.rays);
        let slices = memory.slices(&drawing.volume, axis)?;
        let runs = match drawing.has_runs {
            true => Some(memory.runs(drawing, &slices)?),
            false => None,
        };
        Ok(Prepared {
            runs,
            table: memory.table(drawing, &slices)?,
            slices,
            behind: memory.behind(&drawing.background, &drawing.rays)?,
        })
    }
}

impl Remembered {
    fn slices(&mut self, volume: &Arc<Volume>, axis: usize) -> Result<Arc<Slices>, Finding> {
        let of = Arc::downgrade(volume);
        let fits =
            |(it, slices): &(Weak<Volume>, Arc<Slices>)| it.ptr_eq(&of) && slices.axis == axis;
        let make = || Ok((of.clone(), Arc::new(Slices::new(volume, axis))));
        let (_, slices) = remembered(&mut self.slices, fits, make)?;
        Ok(Arc::clone(slices))
    }

    /// Those of the scalars that absorb: other colours and opacities leave them as they are.
    fn runs(&mut self, drawing: &ShearDrawing, slices: &Slices) -> Result<Arc<Runs>, Finding> {
        let of = Arc::downgrade(&drawing.volume);
        let hidden = Hidden::new(
            &drawing.transfer,
            drawing.units(),
            drawing.classify,
            drawing.table_size,
        );
        let fits = |(it, axis, other, _): &(Weak<Volume>, usize, Hidden, _)| {
            it.ptr_eq(&of) && *axis == slices.axis && *other == hidden
        };
        let make = || {
            let runs = Arc::new(Runs::new(slices, &hidden));
            Ok((of.clone(), slices.axis, hidden.clone(), runs))
        };
        let (.., runs) = remembered(&mut self.runs, fits, make)?;
        Ok(Arc::clone(runs))
    }

    fn table(
        &mut self,
        drawing: &ShearDrawing,
        slices: &Slices,
    ) -> Result<Arc<SlabTable>, Finding> {
        let lengths = drawing.slab_world(slices.axis);
        let choices = (
            drawing.classify,
            drawing.lookup,
            drawing.correction,
            drawing.table_size,
        );
        let key = TableKey {
            volume: Arc::downgrade(&drawing.volume),
            transfer: Arc::downgrade(&drawing.transfer),
            choices,
            lengths: lengths.map(f64::to_bits),
        };
        let fits = |(it, _): &(TableKey, Arc<SlabTable>)| {
            it.volume.ptr_eq(&key.volume)
                && it.transfer.ptr_eq(&key.transfer)
                && (it.choices, it.lengths) == (key.choices, key.lengths)
        };
        if let Some(at) = self.tables.iter().position(fits) {
            self.tables[..=at].rotate_right(1);
        } else {
            let table = SlabTable::new(
                &drawing.transfer,
                drawing.units(),
                slices.offset,
                drawing.classify,
                drawing.lookup,
                drawing.correction,
                drawing.table_size,
                lengths,
            );
            let table = table.map_err(|error| Finding::error("table", error.to_string()))?;
            self.tables.truncate(MOST - 1);
            self.tables.insert(0, (key, Arc::new(table)));
        }
        Ok(Arc::clone(&self.tables[0].1))
    }

    /// What is behind each pixel; it does not move with the camera.
    fn behind(
        &mut self,
        background: &Background,
        rays: &Rays,
    ) -> Result<Arc<Vec<[f32; 4]>>, Finding> {
        if *background == Background::Nothing {
            return Ok(Arc::default());
        }
        let lens = (rays.half_extent.map(f64::to_bits), rays.size);
        let fits = |(it, other, _): &(Background, Lens, _)| it == background && *other == lens;
        let make = || {
            let [width, height] = rays.size;
            let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            #[expect(clippy::cast_possible_truncation, reason = "pictures hold f32")]
            let pixels = rows.map(|(x, y)| background.at(rays, x, y).map(|value| value as f32));
            let pixels = Arc::new(pixels.collect::<Vec<_>>());
            Ok((background.clone(), lens, pixels))
        };
        let (.., pixels) = remembered(&mut self.behind, fits, make)?;
        Ok(Arc::clone(pixels))
    }
}
