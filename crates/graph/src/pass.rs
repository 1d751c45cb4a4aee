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
    /// Draws triangles.
    Draw {
        /// Vertex entry point.
        vertex: &'static str,
        /// Fragment entry point.
        fragment: &'static str,
        /// What is drawn.
        mesh: Mesh,
        /// The output ports drawn into, in the order of `@location`.
        targets: Vec<Target>,
        /// Values of `override` constants.
        constants: Vec<(String, f64)>,
    },
    /// Copies a whole texture from an input port to an output port of equal description.
    Copy {
        /// Input port.
        from: &'static str,
        /// Output port.
        to: &'static str,
    },
    /// Fills the texture at an output port with one value.
    Clear {
        /// Output port.
        port: &'static str,
        /// Red, green, blue, alpha.
        value: [f64; 4],
    },
}

/// What a draw pass draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mesh {
    /// One triangle that covers the picture; the vertex shader makes it from the vertex index.
    FullScreen,
    /// The buffer at an input port: positions, three f32 in world space each, three to a triangle, wound
    /// anticlockwise as seen from outside.
    Input {
        /// Input port.
        port: &'static str,
        /// Number of vertices.
        vertices: u32,
        /// Only the faces turned away are drawn, so that a camera inside still sees the box.
        back_faces_only: bool,
    },
}

/// One colour target of a draw pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Output port.
    pub port: &'static str,
    /// What it holds before.
    pub load: Load,
}

/// What a target holds before a pass draws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// One value everywhere.
    Clear([f64; 4]),
    /// What it held.
    Keep,
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
