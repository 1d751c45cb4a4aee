//! Linked and checked shaders, kept while their text stays the same.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use naga::valid::Capabilities;
use volgraph_report::{Finding, Findings};
use volgraph_shader::{LinkRequest, Module, ShaderRoots, check, link, stated_choice};

use crate::kind::ProgramSpec;

/// Links and checks programs; keeps those whose files have not changed since.
#[derive(Debug)]
pub struct ShaderLibrary {
    roots: ShaderRoots,
    capabilities: Capabilities,
    /// The graph's folder: slot choices that are paths start here.
    base: Option<PathBuf>,
    linked: Arc<Mutex<BTreeMap<[u8; 32], Arc<Module>>>>,
    times: Mutex<ShaderTimes>,
}

/// How long linking and checking took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShaderTimes {
    /// Reading files and linking them.
    pub link: Duration,
    /// Parsing, validation and reflection.
    pub validate: Duration,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl ShaderLibrary {
    /// A library over these roots, for a device with these capabilities.
    #[must_use]
    pub fn new(roots: ShaderRoots, capabilities: Capabilities, base: Option<PathBuf>) -> Self {
        Self {
            roots,
            capabilities,
            base,
            linked: Arc::default(),
            times: Mutex::default(),
        }
    }

    /// A library over other roots that knows the modules of this one.
    #[must_use]
    pub fn with_roots(&self, roots: ShaderRoots) -> Self {
        Self {
            roots,
            capabilities: self.capabilities,
            base: self.base.clone(),
            linked: Arc::clone(&self.linked),
            times: Mutex::default(),
        }
    }

    /// The roots it searches.
    #[must_use]
    pub fn roots(&self) -> &ShaderRoots {
        &self.roots
    }

    /// How long linking and checking took since the last call.
    pub fn take_times(&self) -> ShaderTimes {
        std::mem::take(&mut *locked(&self.times))
    }

    /// Lets go of all modules but those with these digests.
    pub fn keep(&self, used: &BTreeSet<[u8; 32]>) {
        locked(&self.linked).retain(|digest, _| used.contains(digest));
    }

    /// How many modules are kept.
    #[must_use]
    pub fn len(&self) -> usize {
        locked(&self.linked).len()
    }

    /// Whether none is kept.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The choice for another slot that the file which fills `slot` states behind a tag.
    ///
    /// # Errors
    /// As [`volgraph_shader::stated_choice`].
    pub fn stated_choice(
        &self,
        slots: &BTreeMap<String, String>,
        slot: &str,
        tag: &str,
    ) -> Result<Option<String>, Finding> {
        let mut request = LinkRequest::new("");
        request.slots = slots.clone();
        request.base = self.base.clone();
        stated_choice(&self.roots, &request, slot, tag)
    }

    /// Links and checks a program. The text is linked anew each time, so that edits are seen; a text seen before
    /// is not checked again.
    ///
    /// # Errors
    /// Everything the linker and naga found.
    pub fn module(
        &self,
        spec: &ProgramSpec,
        slots: &BTreeMap<String, String>,
    ) -> Result<Arc<Module>, Findings> {
        let mut request = LinkRequest::new(spec.root);
        request.slots = slots.clone();
        request.slots.extend(spec.fixed_slots.clone());
        request.base = self.base.clone();
        let start = Instant::now();
        let linked = link(&self.roots, &request);
        locked(&self.times).link += start.elapsed();
        let linked = linked?;
        let mut cache = locked(&self.linked);
        if let Some(module) = cache.get(&linked.digest) {
            // The same text may come from other files by now; places must name the current ones.
            if module
                .linked
                .files
                .iter()
                .map(|file| &file.path)
                .eq(linked.files.iter().map(|file| &file.path))
            {
                return Ok(Arc::clone(module));
            }
        }
        let digest = linked.digest;
        let start = Instant::now();
        let module = check(linked, self.capabilities);
        locked(&self.times).validate += start.elapsed();
        let module = Arc::new(module?);
        cache.insert(digest, Arc::clone(&module));
        Ok(module)
    }
}
