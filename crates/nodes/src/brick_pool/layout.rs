//! A pool and its page table as they are drawn from: which brick is where, and what tells so.

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use rayon::prelude::*;
use volgraph_formats::bricks::BrickStore;
use volgraph_graph::{Extent, StateProgress, TileTag};
use volgraph_report::Finding;

use super::stream::Brick;
use super::target::index;
use crate::encoding::Encoder;

/// What of a brick of a page table is not its level.
const UNSEEN: u8 = 128;
const ALL_UNSEEN: u8 = 64;

/// How long a brick has taken to be read, in nanoseconds; shared by all that read one volume.
pub(super) type Pace = Arc<AtomicU64>;

/// What is in a pool and in its page table.
#[derive(Debug)]
pub(super) struct Layout {
    /// No two have the same.
    pub token: u64,
    /// A texel for each brick of the finest level: place along x, y, z; level and what is seen.
    pub pages: Vec<[u8; 4]>,
    /// The bricks of the pool, and their texels.
    pub bricks: Vec<Brick>,
    pub tiles: Arc<Vec<(Extent, TileTag)>>,
    pub pace: Pace,
    pub progress: StateProgress,
    is_recorded: AtomicBool,
}

impl Layout {
    /// Of bricks by their places. Where a leaf is not there, the finest brick above it that is stands for it.
    pub fn new(
        store: &BrickStore,
        slots: [u32; 3],
        held: impl Iterator<Item = (usize, Brick)>,
        leaves: &[Brick],
        seen: &[bool],
        progress: StateProgress,
        pace: &Pace,
    ) -> Self {
        let whole = store.edge() + 2;
        let key = u64::from_le_bytes(store.digest()[..8].try_into().unwrap_or_default());
        let (mut bricks, mut tiles, mut places) = (Vec::new(), Vec::new(), HashMap::new());
        for (place, brick) in held {
            let slot = slot(slots, place);
            let number = index(store.levels()[brick.level].bricks, brick.at) as u64;
            let tag = [key, (brick.level as u64) << 56 | number];
            tiles.push((slot.map(|n| u32::from(n) * whole), tag));
            bricks.push(brick);
            places.insert(brick, slot);
        }
        Self {
            token: TOKENS.fetch_add(1, Ordering::Relaxed),
            pages: pages(store, &places, leaves, seen),
            bricks,
            tiles: Arc::new(tiles),
            pace: Arc::clone(pace),
            progress,
            is_recorded: AtomicBool::new(false),
        }
    }

    /// Once it is drawn from, the next one may follow.
    pub fn note_recorded(&self) {
        self.is_recorded.store(true, Ordering::Relaxed);
    }

    /// Whether it was drawn from.
    pub fn is_recorded(&self) -> bool {
        self.is_recorded.load(Ordering::Relaxed)
    }

    /// Whether all is there that is wanted.
    pub fn is_whole(&self) -> bool {
        self.progress.is_whole()
    }
}

/// No two layouts have the same.
static TOKENS: AtomicU64 = AtomicU64::new(1);

/// Bricks of the pool before a place along x, y and z.
fn slot(slots: [u32; 3], place: usize) -> [u8; 3] {
    let [x, y, _] = slots.map(|n| n.max(1) as usize);
    [place % x, place / x % y, place / (x * y)].map(|n| u8::try_from(n).unwrap_or(u8::MAX))
}

/// The table of pages.
fn pages(
    store: &BrickStore,
    places: &HashMap<Brick, [u8; 3]>,
    leaves: &[Brick],
    seen: &[bool],
) -> Vec<[u8; 4]> {
    let dims = store.levels()[0].bricks;
    let mut pages = vec![[0; 4]; dims.map(|n| n as usize).iter().product()];
    for leaf in leaves {
        let mut holder = *leaf;
        while !places.contains_key(&holder) && holder.level + 1 < store.levels().len() {
            holder = holder.parent();
        }
        let [x, y, z] = places.get(&holder).copied().unwrap_or_default();
        let along = |axis: usize| {
            let first = leaf.at[axis] << leaf.level;
            first..(first + (1 << leaf.level)).min(dims[axis])
        };
        let rows = || along(2).flat_map(|k| along(1).map(move |j| (j, k)));
        let is_seen = |at: [u32; 3]| seen.get(index(dims, at)).copied().unwrap_or(true);
        let is_any_seen = rows().any(|(j, k)| along(0).any(|i| is_seen([i, j, k])));
        // What is drawn from a coarser brick for now is looked at cell by cell.
        let unseen = if is_any_seen || holder != *leaf {
            UNSEEN
        } else {
            UNSEEN | ALL_UNSEEN
        };
        let level = u8::try_from(holder.level).unwrap_or(0);
        for (j, k) in rows() {
            for i in along(0) {
                let flags = if is_seen([i, j, k]) { 0 } else { unseen };
                pages[index(dims, [i, j, k])] = [x, y, z, level | flags];
            }
        }
    }
    pages
}

/// Fills the texels of some bricks, one after the other.
pub(super) fn read(
    store: &BrickStore,
    encoder: &Encoder,
    bricks: &[Brick],
    texels: usize,
    bytes: &mut [u8],
    pace: &Pace,
) -> Result<(), Finding> {
    let start = Instant::now();
    let each = bytes.len() / bricks.len().max(1);
    bytes
        .par_chunks_exact_mut(each.max(1))
        .zip(bricks)
        .try_for_each(|(bytes, brick)| {
            let voxels = store
                .read_brick(brick.level, brick.at)
                .map_err(Finding::from)?;
            encoder.fill(&voxels, 0..texels, bytes);
            Ok::<(), Finding>(())
        })?;
    let took = start.elapsed().as_nanos() / bricks.len().max(1) as u128;
    pace.store(u64::try_from(took).unwrap_or(u64::MAX), Ordering::Relaxed);
    Ok(())
}
