//! What is in a pool: which brick has which place, from frame to frame.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;
use volgraph_formats::bricks::BrickStore;
use volgraph_graph::{Extent, State, StateProgress, TileTag, View};
use volgraph_optics::TransferFunction;
use volgraph_report::{Finding, Findings};

use super::sight::Sight;
use super::target::{Aim, Seen, Target, index};
use crate::encoding::{Encoder, Encoding, Scalars};
use crate::source::bricks::Effort;

/// A brick of a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Brick {
    pub level: usize,
    pub at: [u32; 3],
}

impl Brick {
    fn parent(self) -> Self {
        Self {
            level: self.level + 1,
            at: self.at.map(|n| n / 2),
        }
    }
}

/// So long reading may take in a frame that is to come at once, and where frames take long.
const SHORTEST_READ: Duration = Duration::from_millis(60);
const LONGEST_READ: Duration = Duration::from_secs(1);

/// But so many bricks are read in any case.
const LEAST_AT_ONCE: u64 = 32;

/// What of a brick of a page table is not its level.
const UNSEEN: u8 = 128;
const ALL_UNSEEN: u8 = 64;

/// How long a brick has taken to be read, in nanoseconds; shared by all that read one volume.
pub(super) type Pace = Arc<AtomicU64>;

/// What is asked for.
pub(super) struct Request<'a> {
    pub store: &'a BrickStore,
    pub effort: Effort,
    pub is_progressive: bool,
    pub slots: [u32; 3],
    pub encoding: Encoding,
    pub view: Option<View>,
    /// Of which scalars something is seen; of all where it is not known.
    pub spans: Option<Vec<(f64, f64)>>,
    pub transfer: Option<&'a TransferFunction>,
}

/// What is in a pool and in its page table.
#[derive(Debug)]
pub(super) struct Layout {
    token: u64,
    /// A texel for each brick of the finest level: place along x, y, z; level and what is seen.
    pub pages: Vec<[u8; 4]>,
    /// The bricks of the pool, and their texels.
    pub bricks: Vec<Brick>,
    pub tiles: Arc<Vec<(Extent, TileTag)>>,
    pub pace: Pace,
    progress: StateProgress,
    is_recorded: AtomicBool,
}

impl Layout {
    /// Once it is drawn from, the next one may follow.
    pub fn note_recorded(&self) {
        self.is_recorded.store(true, Ordering::Relaxed);
    }

    fn is_whole(&self) -> bool {
        self.progress.ready == self.progress.wanted
    }
}

/// The pools of a volume, by the name of the node that keeps one.
#[derive(Debug, Default)]
pub(crate) struct Streams(BTreeMap<String, Stream>);

impl Streams {
    /// The pool of a node.
    pub(super) fn of(&mut self, node: &str) -> &mut Stream {
        self.0.entry(node.to_owned()).or_default()
    }
}

/// What is seen, and what that was found for.
#[derive(Debug)]
struct Scene {
    key: String,
    seen: Seen,
    sight: Option<Sight>,
}

/// A pool.
#[derive(Debug)]
pub(super) struct Stream {
    scene: Option<Scene>,
    /// What the target is for, and what it is.
    aim: String,
    target: Target,
    slots: [u32; 3],
    places: HashMap<Brick, usize>,
    /// Of each place: what it holds, and when that was last wanted.
    held: Vec<(Option<Brick>, u64)>,
    layout: Option<Arc<Layout>>,
    pace: Pace,
    turn: u64,
    /// How many bricks were there when the pool was drawn from last.
    shown: u64,
    /// When the last layout was made.
    last: Instant,
}

impl Default for Stream {
    fn default() -> Self {
        Self {
            scene: None,
            aim: String::new(),
            target: Target::default(),
            slots: [0; 3],
            places: HashMap::new(),
            held: Vec::new(),
            layout: None,
            pace: Pace::default(),
            turn: 0,
            shown: 0,
            last: Instant::now(),
        }
    }
}

/// No two layouts have the same.
static TOKENS: AtomicU64 = AtomicU64::new(1);

impl Stream {
    /// What the pool has for a request, and how far that is. As long as the last layout was not drawn from it stays.
    pub fn layout(&mut self, request: &Request<'_>) -> (Arc<Layout>, State) {
        self.look(request);
        let is_news = self.aim_at(request);
        if is_news {
            self.shown = 0;
        }
        let stays = self.layout.as_ref().filter(|layout| {
            !is_news && (layout.is_whole() || !layout.is_recorded.load(Ordering::Relaxed))
        });
        let layout = match stays {
            Some(layout) => Arc::clone(layout),
            None => self.next(request),
        };
        let StateProgress { ready, wanted } = layout.progress;
        let ready = if layout.is_recorded.load(Ordering::Relaxed) {
            self.shown = ready;
            ready
        } else {
            self.shown.min(wanted.saturating_sub(1))
        };
        let progress = StateProgress { ready, wanted };
        let state = State {
            token: layout.token,
            progress,
            about: self.about(),
            warnings: self.warnings(request),
        };
        (layout, state)
    }

    /// Which bricks the picture is made of.
    fn about(&self) -> String {
        let levels = || self.target.leaves.iter().map(|leaf| leaf.level);
        format!(
            "{} bricks of levels {} to {}, estimated error {:.1e}",
            self.target.leaves.len(),
            levels().min().unwrap_or(0),
            levels().max().unwrap_or(0),
            self.target.error
        )
    }

    /// A picture that is less than what was asked for says so.
    fn warnings(&self, request: &Request<'_>) -> Findings {
        if !self.target.is_cut {
            return Findings::new();
        }
        let message = format!(
            "{} bricks are all that its pool holds: the picture's estimated error is {:.1e}, more than the tolerance of {:.1e}",
            self.held.len(),
            self.target.error,
            request.effort.tolerance
        );
        Findings::from(
            Finding::warning("pool-full", message)
                .help("give the source `bricks` a larger `pool_mib`, or a larger `tolerance`"),
        )
    }

    /// Finds what is seen, where that has changed.
    fn look(&mut self, request: &Request<'_>) {
        let transfer = request.transfer.map(TransferFunction::digest);
        let key = format!("{:?} {transfer:?} {:?}", request.spans, request.encoding);
        if self.scene.as_ref().is_some_and(|scene| scene.key == key) {
            return;
        }
        let Encoding { range, .. } = request.encoding;
        // Rounding of what shaders compute of scalars is far below that.
        let slack = 1e-6 * (range.1 - range.0).abs();
        let stored = |scalar: f64| f64::from(request.encoding.stored(scalar));
        let sees = |min: f64, max: f64| match &request.spans {
            None => true,
            Some(spans) => {
                let (low, high) = (stored(min) - slack, stored(max) + slack);
                spans.iter().any(|(from, to)| high > *from && low < *to)
            }
        };
        let scalars = Scalars {
            ty: request.store.scalar_type(),
            range: request.store.statistics().range(),
        };
        let voxel = request.store.levels()[0].grid.min_spacing();
        self.scene = Some(Scene {
            seen: Seen::new(request.store, sees),
            sight: request
                .transfer
                .map(|transfer| Sight::new(transfer, scalars, voxel)),
            key,
        });
        self.aim.clear();
        self.layout = None;
    }

    /// Finds the bricks that are wanted, where that has changed; whether it has.
    fn aim_at(&mut self, request: &Request<'_>) -> bool {
        if self.slots != request.slots {
            self.slots = request.slots;
            let count = self.slots.map(|n| n as usize).iter().product();
            self.held = vec![(None, 0); count];
            self.places.clear();
            self.aim.clear();
            self.layout = None;
        }
        let aim = format!(
            "{:?} {:?} {}",
            request.view, request.effort, request.is_progressive
        );
        let Some(scene) = self.scene.as_ref().filter(|_| self.aim != aim) else {
            return false;
        };
        let target = Aim {
            store: request.store,
            effort: request.effort,
            room: self.held.len(),
            view: request.view,
            seen: &scene.seen,
            sight: scene.sight.as_ref(),
        }
        .target();
        self.aim = aim;
        let is_news = self.layout.is_none() || target.leaves != self.target.leaves;
        self.target = target;
        is_news
    }

    /// The next layout: more of what is wanted, or all of it.
    fn next(&mut self, request: &Request<'_>) -> Arc<Layout> {
        self.turn += 1;
        let wanted = if request.is_progressive {
            &self.target.all
        } else {
            &self.target.leaves
        };
        let mut missing = Vec::new();
        for brick in wanted {
            match self.places.get(brick) {
                Some(place) => self.held[*place].1 = self.turn,
                None => missing.push(*brick),
            }
        }
        let ready = wanted.len() - missing.len();
        if request.is_progressive {
            // Where frames take long, as long as half of one: fewer of them are drawn for nothing.
            let frame = self.last.elapsed().min(LONGEST_READ * 2) / 2;
            let time = u64::try_from(frame.max(SHORTEST_READ).as_nanos()).unwrap_or(u64::MAX);
            let count = match self.pace.load(Ordering::Relaxed) {
                // What it takes is not known yet.
                0 => LEAST_AT_ONCE,
                each => (time / each).max(LEAST_AT_ONCE),
            };
            missing.truncate(usize::try_from(count).unwrap_or(usize::MAX));
        }
        self.last = Instant::now();
        let wanted = wanted.len();
        let ready = ready + missing.len();
        // Places that are free first, then those that were not wanted for longest.
        let mut free: Vec<usize> = (0..self.held.len())
            .filter(|at| self.held[*at].1 < self.turn || self.held[*at].0.is_none())
            .collect();
        free.sort_by_key(|at| (self.held[*at].0.is_some(), self.held[*at].1, *at));
        for (brick, place) in missing.into_iter().zip(free) {
            if let Some(before) = self.held[place].0.replace(brick) {
                self.places.remove(&before);
            }
            self.held[place].1 = self.turn;
            self.places.insert(brick, place);
        }
        let layout = Arc::new(self.drawn(request, ready as u64, wanted as u64));
        self.layout = Some(Arc::clone(&layout));
        layout
    }

    fn drawn(&self, request: &Request<'_>, ready: u64, wanted: u64) -> Layout {
        let store = request.store;
        let whole = store.edge() + 2;
        let key = u64::from_le_bytes(store.digest()[..8].try_into().unwrap_or_default());
        let mut bricks = Vec::new();
        let mut tiles = Vec::new();
        for (place, (brick, turn)) in self.held.iter().enumerate() {
            // What is not wanted now need not be there.
            let Some(brick) = brick.filter(|_| *turn == self.turn) else {
                continue;
            };
            let origin = self.slot(place).map(|n| u32::from(n) * whole);
            let number = index(store.levels()[brick.level].bricks, brick.at) as u64;
            bricks.push(brick);
            tiles.push((origin, [key, (brick.level as u64) << 56 | number]));
        }
        Layout {
            token: TOKENS.fetch_add(1, Ordering::Relaxed),
            pages: self.pages(store),
            bricks,
            tiles: Arc::new(tiles),
            pace: Arc::clone(&self.pace),
            progress: StateProgress { ready, wanted },
            is_recorded: AtomicBool::new(false),
        }
    }

    /// Bricks of the pool before a place along x, y and z.
    fn slot(&self, place: usize) -> [u8; 3] {
        let [x, y, _] = self.slots.map(|n| n.max(1) as usize);
        [place % x, place / x % y, place / (x * y)].map(|n| u8::try_from(n).unwrap_or(u8::MAX))
    }

    fn pages(&self, store: &BrickStore) -> Vec<[u8; 4]> {
        let dims = store.levels()[0].bricks;
        let mut pages = vec![[0; 4]; dims.map(|n| n as usize).iter().product()];
        let own = self.scene.as_ref().map_or(&[][..], |scene| &scene.seen.own);
        for leaf in &self.target.leaves {
            let mut holder = *leaf;
            while !self.places.contains_key(&holder) && holder.level + 1 < store.levels().len() {
                holder = holder.parent();
            }
            let [x, y, z] = self.slot(self.places.get(&holder).copied().unwrap_or(0));
            let along = |axis: usize| {
                let first = leaf.at[axis] << leaf.level;
                first..(first + (1 << leaf.level)).min(dims[axis])
            };
            let rows = || along(2).flat_map(|k| along(1).map(move |j| (j, k)));
            let is_seen = |at: [u32; 3]| own.get(index(dims, at)).copied().unwrap_or(true);
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
