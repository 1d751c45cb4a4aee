//! Where shaders are looked for.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use include_dir::{Dir, include_dir};
use volgraph_shader::{DiskFiles, ShaderFiles, ShaderRoots};

/// volgraph's own shaders as they were when it was built.
pub static EMBEDDED_SHADERS: Dir<'static> = include_dir!("$CARGO_MANIFEST_DIR/../../shaders");

/// The folders of shaders, in the order in which they are searched.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ShaderFolders {
    /// The user's own, searched first.
    pub own: Vec<PathBuf>,
}

impl ShaderFolders {
    /// The roots to search: the user's own folders, the graph's folder, volgraph's source tree where this build still
    /// lies beside it (so that its shaders are live as well), and last the embedded copy.
    #[must_use]
    pub fn roots(&self, graph_folder: Option<&Path>) -> ShaderRoots {
        self.roots_in(Arc::new(DiskFiles), graph_folder)
    }

    /// The same, with the files from another store.
    #[must_use]
    pub fn roots_in(
        &self,
        files: Arc<dyn ShaderFiles>,
        graph_folder: Option<&Path>,
    ) -> ShaderRoots {
        let mut roots = ShaderRoots::new(files);
        for folder in self.own.iter().map(PathBuf::as_path).chain(graph_folder) {
            roots = roots.root(folder);
        }
        let source_tree = source_tree();
        if source_tree.join("node/raycast.wgsl").is_file() {
            roots = roots.root(source_tree);
        }
        roots.embedded(&EMBEDDED_SHADERS)
    }
}

fn source_tree() -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shaders");
    folder.canonicalize().unwrap_or(folder)
}
