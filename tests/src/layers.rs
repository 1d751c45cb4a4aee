//! The layers of a picture by name.

use volgraph::Picture;
use volgraph_picture::LayerValues;

/// A layer of vectors.
///
/// # Panics
/// Where it is not there, or of scalars.
#[must_use]
pub fn vectors<'p>(picture: &'p Picture, name: &str) -> &'p [[f32; 4]] {
    match picture.layer(name) {
        Some(LayerValues::Vector(values)) => values,
        other => panic!("{name}: {other:?}"),
    }
}

/// A layer of scalars.
///
/// # Panics
/// Where it is not there, or of vectors.
#[must_use]
pub fn scalars<'p>(picture: &'p Picture, name: &str) -> &'p [f32] {
    match picture.layer(name) {
        Some(LayerValues::Scalar(values)) => values,
        other => panic!("{name}: {other:?}"),
    }
}
