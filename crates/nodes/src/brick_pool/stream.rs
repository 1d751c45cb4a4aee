//! What is in a pool: which brick has which place, from frame to frame.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use volgraph_formats::bricks::BrickStore;
use volgraph_graph::{State, StateProgress, View};
use volgraph_optics::TransferFunction;
use volgraph_report::{Finding, Findings};

use super::layout::{Layout, Pace};
use super::sight::Sight;
use super::target::{Aim, Seen, Target};
use crate::encoding::{Encoding, Scalars};
use crate::source::bricks::Effort;

/// A brick of a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Brick {
    pub level: usize,
    pub at: [u32; 3],
}

impl Brick {
    pub fn parent(self) -> Self {
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
    /// Whether scalars in a brick are made of voxels farther away than its range tells of.
    pub reaches_far: bool,
    pub transfer: Option<&'a TransferFunction>,
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

impl Stream {
    /// What the pool has for a request, and how far that is. As long as the last layout was not drawn from it stays.
    pub fn layout(&mut self, request: &Request<'_>) -> (Arc<Layout>, State) {
        self.look(request);
        let is_news = self.aim_at(request);
        let last = self.layout.as_ref().filter(|_| !is_news);
        self.shown = match last {
            Some(last) if last.is_recorded() => last.progress.ready,
            Some(_) => self.shown,
            None => 0,
        };
        let waits = |last: &&Arc<Layout>| request.is_progressive && !last.is_recorded();
        let layout = match last.filter(|last| last.is_whole() || waits(last)) {
            Some(last) => Arc::clone(last),
            None => self.next(request, is_news),
        };
        let StateProgress { ready, wanted } = layout.progress;
        let ready = if layout.is_recorded() {
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
        let Request {
            spans,
            encoding,
            reaches_far,
            ..
        } = request;
        let key = format!("{spans:?} {transfer:?} {encoding:?} {reaches_far}");
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
            seen: Seen::new(request.store, sees, request.reaches_far),
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
    fn next(&mut self, request: &Request<'_>, is_news: bool) -> Arc<Layout> {
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
            // Where frames take long, as long as half of one: fewer of them are drawn for nothing. The first comes at once.
            let frame = if is_news {
                Duration::ZERO
            } else {
                self.last.elapsed().min(LONGEST_READ * 2) / 2
            };
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
        let progress = StateProgress {
            ready: ready as u64,
            wanted: wanted as u64,
        };
        let layout = Arc::new(self.drawn(request.store, progress));
        self.layout = Some(Arc::clone(&layout));
        layout
    }
}

impl Stream {
    /// What the places hold now.
    fn drawn(&self, store: &BrickStore, progress: StateProgress) -> Layout {
        let holds = |(place, (brick, turn)): (usize, &(Option<Brick>, u64))| {
            // What is not wanted now need not be there.
            brick
                .filter(|_| *turn == self.turn)
                .map(|brick| (place, brick))
        };
        Layout::new(
            store,
            self.slots,
            self.held.iter().enumerate().filter_map(holds),
            &self.target.leaves,
            self.scene.as_ref().map_or(&[], |scene| &scene.seen.own),
            progress,
            &self.pace,
        )
    }
}
