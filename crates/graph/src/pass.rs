//! What a node wants done in one frame, as data. One crate (`gpu`) turns it into wgpu calls.

use crate::tiles::Tiles;
use crate::upload::UploadBytes;

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
    /// Sees to it that the texture at an output port, one of [`crate::NodeKind::tiled`], has these tiles.
    Tiles {
        /// Output port.
        port: &'static str,
        /// What it is to have.
        tiles: Tiles,
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
    /// Runs a compute entry point with as many workgroups as an earlier pass, of this node or of another, has found out.
    ComputeIndirect {
        /// Its name.
        entry: &'static str,
        /// Output port, or where there is none of that name an input port: a buffer that starts with the number of
        /// workgroups along x, y, z. Bindings of the entry point may read the same buffer, and not write it.
        workgroups: &'static str,
        /// Values of `override` constants.
        constants: Vec<(String, f64)>,
    },
    /// Draws triangles. The fragment shader writes storage textures, or what it returns goes to the targets.
    Draw {
        /// Vertex entry point.
        vertex: &'static str,
        /// Fragment entry point.
        fragment: &'static str,
        /// What is drawn.
        geometry: Geometry,
        /// Where the values go that the fragment shader returns at `@location(0)` and on. All are of one size, which is
        /// what is drawn to. None for a shader that writes storage textures alone: a GL driver may refuse to draw into
        /// f32 textures that it stores to without trouble. Without targets and depth the size is the view's.
        targets: Vec<Target>,
        /// The depth that fragments are compared with.
        depth: Option<Depth>,
        /// Values of `override` constants.
        constants: Vec<(String, f64)>,
    },
}

/// The triangles of a draw pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Geometry {
    /// Those at an input port.
    Mesh(Mesh),
    /// Those that the vertex shader makes of `@builtin(vertex_index)` and `@builtin(instance_index)`; both sides are
    /// drawn. Instances reach each pixel in their order.
    Made {
        /// Vertices of an instance, three to a triangle.
        vertices: u32,
        /// How many instances.
        instances: u32,
    },
}

/// An output port that is drawn into, one of [`crate::NodeKind::targets`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Target {
    /// Output port: a 2D texture.
    pub port: &'static str,
    /// What happens to what is there.
    pub blend: Blend,
    /// Whether it starts from zeros; otherwise from what an earlier pass of the node left.
    pub is_cleared: bool,
}

/// How a fragment and what is there become one. Colours are premultiplied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Blend {
    /// The fragment takes its place.
    Replace,
    /// The fragment lies behind it: front to back. The format has to be one that the device blends.
    Under,
    /// The fragment lies before it: back to front. The format has to be one that the device blends.
    Over,
}

/// An output port of depths, one of [`crate::NodeKind::targets`]: a 2D texture of `Depth32Float`. Fragments are drawn
/// where they are nearer than what is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Depth {
    /// Output port.
    pub port: &'static str,
    /// Whether it starts from 1, the farthest depth.
    pub is_cleared: bool,
    /// Whether drawn fragments leave their depth.
    pub is_written: bool,
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
