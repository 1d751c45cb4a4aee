//! Decoded chunks that may be wanted again soon, with a bound on their bytes.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use volgraph_volume::{VolumeError, Voxels};

/// A field and a chunk of it.
type Key = (u32, [u32; 3]);

/// The chunks that were used last. Two threads that want a missing one at once both read it: none waits for another.
pub(super) struct ChunkCache {
    most: usize,
    kept: Mutex<Kept>,
}

#[derive(Default)]
struct Kept {
    /// Chunks, and when they were used last.
    chunks: HashMap<Key, (Arc<Voxels>, u64)>,
    bytes: usize,
    now: u64,
}

impl ChunkCache {
    pub fn new(most: usize) -> Arc<Self> {
        Arc::new(Self {
            most,
            kept: Mutex::default(),
        })
    }

    /// Whether a chunk of this size leaves place for others.
    pub fn takes(&self, bytes: usize) -> bool {
        bytes <= self.most / 8
    }

    /// A chunk, read where it is not there.
    pub fn get(
        &self,
        key: Key,
        read: impl FnOnce() -> Result<Voxels, VolumeError>,
    ) -> Result<Arc<Voxels>, VolumeError> {
        {
            let mut kept = self.kept();
            kept.now += 1;
            let now = kept.now;
            if let Some((chunk, used)) = kept.chunks.get_mut(&key) {
                *used = now;
                return Ok(Arc::clone(chunk));
            }
        }
        let chunk = Arc::new(read()?);
        let bytes = chunk.as_bytes().len();
        let mut kept = self.kept();
        let now = kept.now;
        if let Some((old, _)) = kept.chunks.insert(key, (Arc::clone(&chunk), now)) {
            kept.bytes -= old.as_bytes().len();
        }
        kept.bytes += bytes;
        if kept.bytes > self.most {
            kept.shrink(self.most / 4 * 3);
        }
        Ok(chunk)
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        // Nothing panics while it is locked, and a map is whole either way.
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Kept {
    /// Lets go of those that were used longest ago; in one go, so that it is rare.
    fn shrink(&mut self, to: usize) {
        let mut by_age: Vec<(u64, Key)> = self
            .chunks
            .iter()
            .map(|(key, (_, used))| (*used, *key))
            .collect();
        by_age.sort_unstable();
        for (_, key) in by_age {
            if self.bytes <= to {
                break;
            }
            if let Some((chunk, _)) = self.chunks.remove(&key) {
                self.bytes -= chunk.as_bytes().len();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_are_read_once_until_others_need_their_place() {
        let cache = ChunkCache::new(800);
        assert!(cache.takes(100) && !cache.takes(101));
        let mut reads = 0;
        let mut get = |x: u32| {
            let read = || {
                reads += 1;
                Ok(Voxels::U8(vec![0; 100]))
            };
            assert_eq!(cache.get((0, [x, 0, 0]), read).unwrap().len(), 100);
            reads
        };
        assert_eq!([get(0), get(1), get(0), get(1)], [1, 2, 2, 2]);
        for x in 2..9 {
            get(x);
        }
        // Nine passed the bound: 0, 1 and 2 went.
        assert_eq!([get(8), get(3), get(0)], [9, 9, 10]);
        assert!(cache.kept().bytes <= 800);
    }
}
