//! Linked and checked shaders, kept while their text stays the same.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use naga::valid::Capabilities;
use volgraph_report::Findings;
use volgraph_shader::{LinkRequest, Module, ShaderRoots, check, link};

use crate::kind::ProgramSpec;

/// Links and checks programs; keeps those whose files have not changed since.
#[derive(Debug)]
pub struct ShaderLibrary {
    roots: ShaderRoots,
    capabilities: Capabilities,
    /// The graph's folder: slot choices that are paths start here.
    base: Option<PathBuf>,
    linked: Mutex<BTreeMap<[u8; 32], Arc<Module>>>,
}

impl ShaderLibrary {
    /// A library over these roots, for a device with these capabilities.
    #[must_use]
    pub fn new(roots: ShaderRoots, capabilities: Capabilities, base: Option<PathBuf>) -> Self {
        Self {
            roots,
            capabilities,
            base,
            linked: Mutex::default(),
        }
    }

    /// The roots it searches.
    #[must_use]
    pub fn roots(&self) -> &ShaderRoots {
        &self.roots
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
        let linked = link(&self.roots, &request)?;
        let mut cache = self.linked.lock().unwrap_or_else(PoisonError::into_inner);
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
        let module = Arc::new(check(linked, self.capabilities)?);
        cache.insert(digest, Arc::clone(&module));
        Ok(module)
    }
}
