//! What stays of pictures while the camera moves: voxels and tables as the software raycaster wants them.

use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};

use volgraph_optics::TransferFunction;
use volgraph_reference::{Background, Rays};
use volgraph_report::Finding;
use volgraph_software::{Classify, DistanceMap, RangeMap, Tables, VoxelGrid};
use volgraph_volume::{BrickRanges, Volume};

use super::drawing::{MatterDrawing, Shows, SoftwareDrawing, units};

/// Made things that the last pictures needed, by what they were made of. Forgetting one costs time alone.
#[derive(Debug, Default)]
pub struct SoftwareMemory(Mutex<Remembered>);

/// Most of each kind.
const MOST: usize = 4;

/// Voxels along the edge of a brick.
const EDGE: u32 = 4;

/// Of larger volumes, so that maps of bricks stay small.
const LARGE_EDGE: u32 = 8;

/// Voxels from which on a volume is large.
const LARGE: u64 = 1 << 25;

#[derive(Debug, Default)]
struct Remembered {
    voxels: Vec<(Weak<Volume>, Arc<Voxels>)>,
    looks: Vec<(LookKey, Arc<Tables>, Option<Arc<DistanceMap>>)>,
    behind: Vec<Behind>,
}

/// What is behind the pixels of pictures of a size and an angle of view.
#[derive(Debug)]
struct Behind {
    background: Background,
    half_extent: [u64; 2],
    size: [u32; 2],
    pixels: Arc<Vec<[f32; 4]>>,
}

#[derive(Debug)]
struct Voxels {
    grid: Arc<VoxelGrid>,
    edge: u32,
    /// For emission and absorption.
    bricks: OnceLock<BrickRanges>,
    /// For all else.
    ranges: OnceLock<Arc<RangeMap>>,
}

#[derive(Debug)]
struct LookKey {
    volume: Weak<Volume>,
    transfer: Weak<TransferFunction>,
    numbers: (Classify, u32, u64, bool),
}

/// All that a picture needs.
pub(super) struct Prepared {
    pub voxels: Arc<VoxelGrid>,
    /// Of emission and absorption.
    pub looks: Option<(Arc<Tables>, Option<Arc<DistanceMap>>)>,
    pub ranges: Option<Arc<RangeMap>>,
    pub behind: Arc<Vec<[f32; 4]>>,
}

/// Puts what was used last in front, and forgets what was not used for long.
fn remember<T>(all: &mut Vec<T>, one: T) {
    all.insert(0, one);
    all.truncate(MOST);
}

impl SoftwareMemory {
    /// Lets go of all of it.
    pub(super) fn forget(&self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Remembered::default();
    }

    pub(super) fn prepare(&self, drawing: &SoftwareDrawing) -> Result<Prepared, Finding> {
        let mut memory = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        memory
            .voxels
            .retain(|(volume, _)| volume.strong_count() > 0);
        memory
            .looks
            .retain(|(key, ..)| key.volume.strong_count() > 0 && key.transfer.strong_count() > 0);
        let voxels = memory.voxels(&drawing.volume)?;
        let (looks, ranges) = match &drawing.shows {
            Shows::Matter(matter) => (Some(memory.look(drawing, matter, &voxels)?), None),
            _ if !drawing.leaps => (None, None),
            _ => {
                let ranges = || Arc::new(RangeMap::new(&drawing.volume, &voxels.grid));
                (None, Some(Arc::clone(voxels.ranges.get_or_init(ranges))))
            }
        };
        Ok(Prepared {
            voxels: Arc::clone(&voxels.grid),
            looks,
            ranges,
            behind: memory.behind(&drawing.background, &drawing.rays),
        })
    }
}

impl Remembered {
    fn voxels(&mut self, volume: &Arc<Volume>) -> Result<Arc<Voxels>, Finding> {
        let of = Arc::downgrade(volume);
        if let Some(at) = self.voxels.iter().position(|(it, _)| it.ptr_eq(&of)) {
            self.voxels[..=at].rotate_right(1);
            return Ok(Arc::clone(&self.voxels[0].1));
        }
        let grid = VoxelGrid::new(volume)
            .map_err(|error| Finding::error("volume-size", error.to_string()))?;
        let is_large = volume.grid().voxel_count() >= LARGE;
        let edge = if is_large { LARGE_EDGE } else { EDGE };
        let voxels = Arc::new(Voxels {
            grid: Arc::new(grid),
            edge,
            bricks: OnceLock::new(),
            ranges: OnceLock::new(),
        });
        remember(&mut self.voxels, (of, Arc::clone(&voxels)));
        Ok(voxels)
    }

    fn look(
        &mut self,
        drawing: &SoftwareDrawing,
        matter: &MatterDrawing,
        voxels: &Voxels,
    ) -> Result<(Arc<Tables>, Option<Arc<DistanceMap>>), Finding> {
        let key = LookKey {
            volume: Arc::downgrade(&drawing.volume),
            transfer: Arc::downgrade(&matter.transfer),
            numbers: (
                matter.classify,
                matter.table_size,
                drawing.step.to_bits(),
                drawing.leaps,
            ),
        };
        let is_same = |(it, ..): &(LookKey, _, _)| {
            it.volume.ptr_eq(&key.volume)
                && it.transfer.ptr_eq(&key.transfer)
                && it.numbers == key.numbers
        };
        if let Some(at) = self.looks.iter().position(is_same) {
            self.looks[..=at].rotate_right(1);
            let (_, tables, empty) = &self.looks[0];
            return Ok((Arc::clone(tables), empty.clone()));
        }
        let tables = Tables::new(
            &matter.transfer,
            units(&drawing.volume, &matter.transfer),
            voxels.grid.offset,
            matter.classify,
            matter.table_size,
            drawing.step_world(),
        );
        let tables = Arc::new(tables.map_err(|error| Finding::error("table", error.to_string()))?);
        let empty = drawing.leaps.then(|| {
            let (volume, edge) = (&drawing.volume, voxels.edge);
            let bricks = voxels
                .bricks
                .get_or_init(|| volume.brick_ranges(edge, [1; 2]));
            Arc::new(DistanceMap::new(bricks, edge, &tables))
        });
        remember(&mut self.looks, (key, Arc::clone(&tables), empty.clone()));
        Ok((tables, empty))
    }

    /// What is behind each pixel; it does not move with the camera.
    fn behind(&mut self, background: &Background, rays: &Rays) -> Arc<Vec<[f32; 4]>> {
        if *background == Background::Nothing {
            return Arc::default();
        }
        let lens = rays.half_extent.map(f64::to_bits);
        let is_same = |it: &Behind| {
            it.background == *background && it.half_extent == lens && it.size == rays.size
        };
        if let Some(at) = self.behind.iter().position(is_same) {
            self.behind[..=at].rotate_right(1);
            return Arc::clone(&self.behind[0].pixels);
        }
        let [width, height] = rays.size;
        let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        #[expect(clippy::cast_possible_truncation, reason = "pictures hold f32")]
        let pixels = rows.map(|(x, y)| background.at(rays, x, y).map(|value| value as f32));
        let pixels = Arc::new(pixels.collect::<Vec<_>>());
        let made = Behind {
            background: background.clone(),
            half_extent: lens,
            size: rays.size,
            pixels: Arc::clone(&pixels),
        };
        remember(&mut self.behind, made);
        pixels
    }
}
