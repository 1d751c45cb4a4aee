//! Waiting: from events and polls to differences of content.
//!
//! What has happened gathers in a burst. When the burst has settled, the way is walked again where it has
//! changed, and the suspects are examined. What differs is told once nothing is missing, or has been for the time
//! of grace; something complete waits for something missing no longer than that.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::platform::Again;
use crate::subject::Subject;
use crate::watch::Burst;
use crate::{FileWatch, WatchError};

/// Looking at everything takes at most this part of the time, however many files there are.
const LOOKING_PART: u32 = 20;

impl FileWatch {
    /// Waits until some content differs from what was used, and tells the paths that differ, as they were given;
    /// for a folder, its entries. `None` when `timeout` passes first. Zero looks at what has settled by now.
    ///
    /// What was told is not told again until it changes once more.
    ///
    /// # Errors
    ///
    /// [`WatchError::NothingWatched`] when there is nothing to wait for and no timeout.
    pub fn wait(
        &mut self,
        timeout: Option<Duration>,
    ) -> Result<Option<BTreeSet<PathBuf>>, WatchError> {
        if self.subjects.is_empty() && timeout.is_none() {
            return Err(WatchError::NothingWatched);
        }
        let deadline = timeout.and_then(|timeout| Instant::now().checked_add(timeout));
        loop {
            self.collect();
            self.look_around();
            if self.has_settled() {
                self.examine();
            }
            let now = Instant::now();
            if let Some(paths) = self.answer(now) {
                return Ok(Some(paths));
            }
            if deadline.is_some_and(|deadline| deadline <= now) {
                return Ok(None);
            }
            self.inbox.wait(self.next_moment(deadline));
        }
    }

    /// Adds the events that have come to the burst.
    pub(crate) fn collect(&mut self) {
        let mail = self.inbox.empty();
        let Some((first, last)) = mail.span else {
            return;
        };
        let burst = self.burst.get_or_insert_with(|| Burst::new(first));
        burst.last = burst.last.max(last);
        burst.lost |= mail.lost;
        for (entry, note) in mail.entries {
            if let Some(role) = self.map.entries.get(&entry) {
                for &index in &role.ends {
                    if note.content {
                        self.subjects[index].name();
                    }
                    burst.suspect(index, false, note.last);
                }
                burst.walk |= note.replaced || role.on_the_way;
                if role.on_the_way {
                    burst.replaced.insert(entry.clone());
                }
            }
            if note.inside {
                for &index in self.map.listed.get(&entry).into_iter().flatten() {
                    burst.suspect(index, false, note.last);
                }
            }
        }
    }

    /// Polls, and rechecks, when it is time.
    fn look_around(&mut self) {
        let now = Instant::now();
        if self.next_poll.is_some_and(|next| next <= now) {
            for index in self.polled.clone() {
                self.look_at(index);
            }
            self.next_poll = after_look(now, self.interval());
        }
        let now = Instant::now();
        if self.next_recheck.is_some_and(|next| next <= now) {
            if self.platform.events().is_ok() {
                if self.register(Again::Nothing) {
                    let burst = self.burst.get_or_insert_with(|| Burst::new(now));
                    burst.suspect_all(self.subjects.len());
                }
                for index in 0..self.subjects.len() {
                    self.look_at(index);
                }
            }
            let pause = self.options.recheck;
            self.next_recheck = pause.and_then(|pause| after_look(now, pause));
        }
    }

    /// Looks at a subject without reading; what looks different goes the way of an event.
    fn look_at(&mut self, index: usize) {
        let subject = &mut self.subjects[index];
        let stirred = subject.stirred();
        if stirred || subject.must_read() {
            let now = Instant::now();
            let burst = self.burst.get_or_insert_with(|| Burst::new(now));
            if stirred {
                burst.last = now;
                burst.walk = true;
            }
            burst.suspect(index, false, now);
        }
    }

    /// Whether the burst is over, or lasts too long to wait for its end.
    fn has_settled(&mut self) -> bool {
        let now = Instant::now();
        let Some(due) = self.settled_at() else {
            return false;
        };
        if now < due {
            return false;
        }
        let Some(burst) = &mut self.burst else {
            return false;
        };
        // What is polled has no events to tell that it is still being written.
        let latest = burst.first.checked_add(self.options.longest_settle);
        let is_late = latest.is_some_and(|latest| latest <= now);
        let mut still = true;
        for (index, suspect) in &mut burst.suspects {
            if !is_late && self.polled.contains(index) && self.subjects[*index].stirred() {
                suspect.last_event = now;
                still = false;
            }
        }
        if !still {
            burst.last = now;
        }
        still
    }

    /// When the burst is settled if nothing more happens.
    fn settled_at(&self) -> Option<Instant> {
        let burst = self.burst.as_ref()?;
        let quiet = burst.last.checked_add(self.options.settle);
        let longest = burst.first.checked_add(self.options.longest_settle);
        earliest([quiet, longest])
    }

    /// Compares what the burst has put under suspicion.
    fn examine(&mut self) {
        let Some(mut burst) = self.burst.take() else {
            return;
        };
        self.signs_since.get_or_insert(burst.first);
        if burst.walk || burst.lost {
            let is_moved = burst.lost || !burst.replaced.is_empty();
            let added = self.register(burst.again());
            if added || is_moved {
                burst.suspect_all(self.subjects.len());
            }
        }
        if burst.lost {
            for subject in &mut self.subjects {
                subject.name();
            }
        }
        for (index, suspect) in burst.suspects {
            self.subjects[index].examine(suspect.trusting, suspect.last_event);
        }
    }

    /// What is to be told now.
    fn answer(&mut self, now: Instant) -> Option<BTreeSet<PathBuf>> {
        if self.burst.is_some() {
            return None;
        }
        let grace = self.options.grace;
        for subject in &mut self.subjects {
            subject.give_up_missing(now, grace);
        }
        let found = || {
            let found = self.subjects.iter();
            found.filter_map(|subject| subject.found.as_ref())
        };
        if found().next().is_none() {
            self.signs_since = None;
        }
        let since = found().filter_map(|found| found.complete_since).min()?;
        let waits = found().any(|found| !found.differences.missing.is_empty());
        if waits && since.checked_add(grace).is_none_or(|until| now < until) {
            return None;
        }
        self.told_since = self.signs_since.take();
        Some(self.subjects.iter_mut().flat_map(Subject::tell).collect())
    }

    /// When the first sign came of what [`FileWatch::wait`] told last; `None` before it has told anything.
    pub fn told_since(&self) -> Option<Instant> {
        self.told_since
    }

    /// When to look again if no event comes.
    fn next_moment(&self, deadline: Option<Instant>) -> Option<Instant> {
        let grace = self.options.grace;
        let found = self.subjects.iter().filter_map(|subject| {
            let found = subject.found.as_ref()?;
            earliest([
                found.missing_until(grace),
                found
                    .complete_since
                    .and_then(|since| since.checked_add(grace)),
            ])
        });
        // While there is a burst, nothing is told, and so nothing else is waited for.
        let told = if self.burst.is_some() {
            self.settled_at()
        } else {
            found.min()
        };
        earliest([deadline, told, self.next_poll, self.next_recheck])
    }
}

/// When to look again after a look that began then.
fn after_look(began: Instant, pause: Duration) -> Option<Instant> {
    let took = began.elapsed();
    let pause = pause
        .max(took.saturating_mul(LOOKING_PART))
        .max(Duration::from_millis(1));
    Instant::now().checked_add(pause)
}

fn earliest<const N: usize>(moments: [Option<Instant>; N]) -> Option<Instant> {
    moments.into_iter().flatten().min()
}
