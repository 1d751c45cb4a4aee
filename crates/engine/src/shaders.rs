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
        self.roots_with(files, graph_folder, source_tree().as_deref())
    }

    /// The same with another source tree, or none, as where the program is all there is.
    #[must_use]
    pub fn roots_with(
        &self,
        files: Arc<dyn ShaderFiles>,
        graph_folder: Option<&Path>,
        source_tree: Option<&Path>,
    ) -> ShaderRoots {
        let mut roots = ShaderRoots::new(files);
        let own = self.own.iter().map(PathBuf::as_path);
        for folder in own.chain(graph_folder).chain(source_tree) {
            roots = roots.root(folder);
        }
        roots.embedded(&EMBEDDED_SHADERS)
    }
}

/// The shaders of the tree that this was built from, where that is still there.
fn source_tree() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shaders");
    let folder = folder.canonicalize().ok()?;
    folder.join("node/raycast.wgsl").is_file().then_some(folder)
}

#[cfg(test)]
mod tests {
    use volgraph_graph::demand::ShaderLibrary;
    use volgraph_graph::{Limits, is_embedded};

    use super::*;
    use crate::{NoProgress, Overrides, Scene, ready_graphs, registry};

    #[test]
    fn the_program_alone_plans_every_ready_graph_that_needs_no_file() {
        let folders = ShaderFolders::default();
        let shaders = || {
            let roots = folders.roots_with(Arc::new(DiskFiles), None, None);
            ShaderLibrary::new(roots, naga::valid::Capabilities::default(), None)
        };
        let (mut planned, mut linked) = (0, 0);
        for graph in ready_graphs()
            .iter()
            .filter(|graph| graph.volumes().is_empty())
        {
            let overrides = Overrides::default();
            let scene = Scene::load(&graph.path, &overrides, &folders, registry(), &NoProgress);
            let scene = scene.unwrap_or_else(|findings| panic!("{}: {findings}", graph.name));
            let plan = scene.plan(&shaders(), &Limits::default(), [64, 64], true);
            let plan = plan.unwrap_or_else(|findings| panic!("{}: {findings}", graph.name));
            planned += 1;
            let programs = plan
                .graph
                .nodes
                .iter()
                .filter_map(|node| node.program.as_ref());
            for file in programs.flat_map(|program| &program.module.linked.files) {
                assert!(is_embedded(&file.path), "{}", file.path.display());
                linked += 1;
            }
            let sources = scene.sources.values().flat_map(|source| source.files());
            for file in sources {
                assert!(is_embedded(&file), "{}", file.display());
            }
        }
        assert!(
            planned >= 7 && linked > planned,
            "{planned} graphs, {linked} files"
        );
    }
}
