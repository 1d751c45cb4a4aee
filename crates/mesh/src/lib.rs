//! Triangle meshes, and volumes of signed distance made of them.
//!
//! The way of the data: [`Mesh::read`] takes a PLY, OBJ or STL file (plain or gzip), tells the format by its content
//! and makes plain positions and triangles of it, with polygons as fans and every index checked. [`Mesh::report`]
//! welds equal positions and counts what is wrong: open edges, edges of three faces, faces turned around.
//! [`distance_field`] chooses by that report how inside and outside are told apart, builds a tree of boxes over the
//! triangles, and asks it for the nearest point of each voxel of a [`Grid`](volgraph_volume::Grid).
//!
//! **Distances** are Euclidean, exact to the rounding of the stored float32, in the mesh's own unit, and negative
//! inside. **The world frame** is LPS, z up; a mesh is taken as it stands unless [`Up::Y`] turns it.
//!
//! Every refusal is a [`MeshError`] that names the file, the line where there is one, the cause and the remedy.

mod error;
mod field;
mod mesh;
mod pseudonormal;
mod read;
mod report;
mod signed;
mod topology;
mod tree;
mod triangle;
mod winding;

pub use error::MeshError;
pub use field::{FieldOptions, Progress, Resolution, distance_field};
pub use mesh::{Mesh, Up};
pub use read::ReadOptions;
pub use report::MeshReport;
pub use signed::{Sign, SignMethod, SignedDistance};
