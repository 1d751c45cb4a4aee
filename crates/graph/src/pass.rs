//! What a node wants done in one frame, as data. One crate (`gpu`) turns it into wgpu calls.

use std::fmt;
use std::sync::Arc;

use volgraph_report::Finding;

/// One thing to do. Bindings are not listed: the runner reads from the linked shader which bindings the entry
/// point uses and finds each by its name (port, uniform or sampler).
#[derive(Clone, Debug)]
pub enum Pass {
    /// Fills the whole resource at an output port from the CPU.
    Upload {
        /// Output port.
        port: &'static str,
        /// The texels, x fastest, without row padding.
        bytes: UploadBytes,
    },
    /// Runs a compute entry point.
    Compute {
        /// Its name.
        entry: &'static str,
        /// Number of workgroups along x, y, z.
        workgroups: [u32; 3],
        /// Values of `override` constants.
        constants: Vec<(String, f64)>,
    },
    /// Draws triangles. The fragment shader writes storage textures: a GL driver may refuse to draw into f32
    /// textures that it stores to without trouble.
    Draw {
        /// Vertex entry point.
        vertex: &'static str,
        /// Fragment entry point.
        fragment: &'static str,
        /// What is drawn.
        mesh: Mesh,
        /// Values of `override` constants.
        constants: Vec<(String, f64)>,
    },
}

/// The triangles at an input port: positions, three f32 in world space each, three to a triangle, wound
/// anticlockwise as seen from outside. Only the faces turned away are drawn, so that a camera inside still sees them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mesh {
    /// Input port.
    pub port: &'static str,
    /// Number of vertices.
    pub vertices: u32,
}

type MakeBytes = dyn Fn() -> Result<Vec<u8>, Finding> + Send + Sync;

/// Bytes made when they are needed, and not before.
#[derive(Clone)]
pub struct UploadBytes(Arc<MakeBytes>);

impl UploadBytes {
    /// Wraps the function that makes them.
    #[must_use]
    pub fn new(make: impl Fn() -> Result<Vec<u8>, Finding> + Send + Sync + 'static) -> Self {
        Self(Arc::new(make))
    }

    /// Makes them.
    ///
    /// # Errors
    /// What the maker found wrong.
    pub fn make(&self) -> Result<Vec<u8>, Finding> {
        (self.0)()
    }
}

impl fmt::Debug for UploadBytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("UploadBytes")
    }
}
