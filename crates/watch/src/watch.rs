//! What is watched: subjects, the map to them, and the platform that tells.
//!
//! [`FileWatch::watch`] replaces the subjects, walks to all of them and has their folders watched; waiting is
//! in `wait`. Subjects that events may not reach are polled.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::inbox::Inbox;
use crate::platform::{Again, Platform};
use crate::route::Map;
use crate::subject::Subject;
use crate::{Backend, Seen, WatchOptions};

/// How often folders that change while they are being registered are walked before waiting settles it.
const MOST_WALKS: usize = 8;

/// Tells when watched files have content other than what was used of them.
///
/// Has one thread, the platform's, which ends when this is dropped.
///
/// ```no_run
/// # use std::collections::{BTreeMap, BTreeSet};
/// # use volgraph_watch::{FileWatch, Seen, WatchOptions};
/// # fn load() -> Vec<u8> { Vec::new() }
/// let mut watch = FileWatch::new(WatchOptions::default());
/// loop {
///     let bytes = load();
///     let files = BTreeMap::from([("ray.wgsl".into(), Seen::bytes(&bytes))]);
///     watch.watch(files, BTreeSet::new());
///     watch.wait(None)?;
/// }
/// # #[expect(unreachable_code, reason = "the loop is the example")]
/// # Ok::<(), volgraph_watch::WatchError>(())
/// ```
pub struct FileWatch {
    pub(crate) options: WatchOptions,
    pub(crate) inbox: Arc<Inbox>,
    pub(crate) platform: Platform,
    pub(crate) subjects: Vec<Subject>,
    pub(crate) map: Arc<Map>,
    /// The subjects to poll, by index.
    pub(crate) polled: BTreeSet<usize>,
    pub(crate) next_poll: Option<Instant>,
    pub(crate) next_recheck: Option<Instant>,
    pub(crate) burst: Option<Burst>,
    /// The first sign of what may be told next, and of what was told last.
    pub(crate) signs_since: Option<Instant>,
    pub(crate) told_since: Option<Instant>,
}

/// Events that have not settled yet, and what they ask for.
#[derive(Debug)]
pub(crate) struct Burst {
    pub(crate) first: Instant,
    pub(crate) last: Instant,
    /// The subjects to examine, by index.
    pub(crate) suspects: BTreeMap<usize, Suspect>,
    /// Walk to every subject again.
    pub(crate) walk: bool,
    /// Entries on the way that are not what they were.
    pub(crate) replaced: BTreeSet<PathBuf>,
    /// Events were lost.
    pub(crate) lost: bool,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Suspect {
    /// A look that stands is believed.
    pub(crate) trusting: bool,
    pub(crate) last_event: Instant,
}

impl Burst {
    pub(crate) fn new(now: Instant) -> Self {
        Self {
            first: now,
            last: now,
            suspects: BTreeMap::new(),
            walk: false,
            replaced: BTreeSet::new(),
            lost: false,
        }
    }

    /// Which folders are to be watched anew for it.
    pub(crate) fn again(&mut self) -> Again {
        if self.lost {
            Again::Everything
        } else {
            Again::Below(std::mem::take(&mut self.replaced))
        }
    }

    /// Puts all of so many subjects under suspicion, though no event has named them.
    pub(crate) fn suspect_all(&mut self, len: usize) {
        let now = Instant::now();
        for index in 0..len {
            self.suspect(index, true, now);
        }
    }

    pub(crate) fn suspect(&mut self, index: usize, trusting: bool, last_event: Instant) {
        let suspect = self.suspects.entry(index).or_insert(Suspect {
            trusting,
            last_event,
        });
        suspect.trusting &= trusting;
        suspect.last_event = suspect.last_event.max(last_event);
    }
}

impl FileWatch {
    /// Watches nothing yet. Polls where the platform's watcher cannot be made; see [`FileWatch::backend`].
    pub fn new(options: WatchOptions) -> Self {
        let inbox = Arc::new(Inbox::default());
        let platform = if options.poll.is_some() {
            Platform::without_events("as asked for")
        } else {
            Platform::new(&inbox)
        };
        Self::on(options, inbox, platform)
    }

    pub(crate) fn on(options: WatchOptions, inbox: Arc<Inbox>, platform: Platform) -> Self {
        Self {
            options,
            inbox,
            platform,
            subjects: Vec::new(),
            map: Arc::default(),
            polled: BTreeSet::new(),
            next_poll: None,
            next_recheck: None,
            burst: None,
            signs_since: None,
            told_since: None,
        }
    }

    /// How changes come to be known, and what is polled for which reason.
    pub fn backend(&self) -> Backend {
        Backend {
            events: self.platform.events().map_err(str::to_owned),
            polled: self.platform.polled().clone(),
            interval: self.interval(),
        }
    }

    pub(crate) fn interval(&self) -> Duration {
        let interval = self.options.poll.unwrap_or(WatchOptions::POLL);
        // Looking without a pause would keep a core busy.
        interval.max(Duration::from_millis(1))
    }

    /// What to watch from now on, in place of what was watched before: files with what was used of each, and
    /// folders of which every direct entry counts. The empty path is the current folder, as the parent of a bare name.
    ///
    /// Files are compared once without an event, so that no change between reading a file and this call is
    /// lost. Give what the last reading found, [`Seen::Absent`] for what could not be read; otherwise the same
    /// difference is told again and again. A file that was looked for at several places is `Absent` at all but
    /// one of them: name these too.
    ///
    /// A folder's entries count from this call on. What the caller itself writes into such a folder counts too.
    pub fn watch(&mut self, files: BTreeMap<PathBuf, Seen>, folders: BTreeSet<PathBuf>) {
        self.collect();
        let named: BTreeSet<PathBuf> = self
            .subjects
            .iter()
            .filter(|subject| subject.is_named())
            .map(|subject| subject.path.clone())
            .collect();
        let again = self.burst.as_mut().map_or(Again::Nothing, Burst::again);
        let lost = self.burst.as_ref().is_some_and(|burst| burst.lost);
        let files = files.into_iter().map(|(path, seen)| {
            let named = lost || named.contains(&path);
            Subject::file(path, seen, named)
        });
        self.subjects = files
            .chain(folders.into_iter().map(Subject::folder))
            .collect();
        self.register(again);
        let now = Instant::now();
        let mut burst = Burst::new(now);
        for index in 0..self.subjects.len() {
            burst.suspect(index, false, now);
        }
        self.burst = Some(burst);
        self.next_recheck = self
            .options
            .recheck
            .and_then(|pause| now.checked_add(pause));
    }

    /// Walks to every subject and has the folders on the way watched. True when some are watched anew, and what
    /// lies in them may have changed unseen.
    pub(crate) fn register(&mut self, mut again: Again) -> bool {
        let mut added = false;
        // A walk counts once every folder that it met was watched, and every entry let through, before it began.
        for _ in 0..MOST_WALKS {
            let map = Map::of(&self.subjects);
            let is_known = map == *self.map;
            self.map = Arc::new(map);
            self.inbox.filter(Arc::clone(&self.map));
            let more = self.platform.follow(&self.map, &again);
            if is_known && !more {
                break;
            }
            added |= more;
            again = Again::Nothing;
        }
        self.choose_polled();
        added
    }

    fn choose_polled(&mut self) {
        self.polled = if self.platform.events().is_err() {
            (0..self.subjects.len()).collect()
        } else {
            let folders = self.platform.polled().keys();
            let subjects = folders.filter_map(|folder| self.map.folders.get(folder));
            subjects.flatten().copied().collect()
        };
        self.next_poll = if self.polled.is_empty() {
            None
        } else {
            let next = Instant::now().checked_add(self.interval());
            self.next_poll.or(next)
        };
    }
}

impl fmt::Debug for FileWatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FileWatch")
            .field("options", &self.options)
            .field("subjects", &self.subjects)
            .finish_non_exhaustive()
    }
}
