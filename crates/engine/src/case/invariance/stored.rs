//! The same numbers in another type: 0 to 255 as u8, u16 and f32.
//!
//! A volume of another type is rounded to 256 values over its range first. Transfer functions and isovalues in data units
//! of such a volume do not fit it any more; those over the range of the data do.

use std::sync::Arc;

use volgraph_graph::Source;
use volgraph_nodes::source::volume::VolumeSource;
use volgraph_volume::{ScalarType, Volume, VolumeError, Voxels};

/// The types that are compared, the first with each other.
pub(in crate::case) const TYPES: [ScalarType; 3] =
    [ScalarType::U8, ScalarType::U16, ScalarType::F32];

/// A volume in the type; any other source as it is.
pub(in crate::case) fn source(
    source: &Arc<dyn Source>,
    scalar: ScalarType,
) -> Result<Arc<dyn Source>, VolumeError> {
    let Some(VolumeSource { volume, .. }) = source.as_any().downcast_ref::<VolumeSource>() else {
        return Ok(Arc::clone(source));
    };
    let (low, scale) = if volume.voxels().scalar_type() == ScalarType::U8 {
        (0.0, 1.0)
    } else {
        let statistics = volume.statistics();
        let span = statistics.max - statistics.min;
        let scale = if span > 0.0 { 255.0 / span } else { 1.0 };
        (statistics.min, scale)
    };
    let mut bytes: Vec<u8> = Vec::with_capacity(volume.voxels().len());
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a byte"
    )]
    volume
        .voxels()
        .for_each(|value| bytes.push(((value - low) * scale).round().clamp(0.0, 255.0) as u8));
    let voxels: Voxels = match scalar {
        ScalarType::U16 => bytes.into_iter().map(u16::from).collect::<Vec<_>>().into(),
        ScalarType::F32 => bytes.into_iter().map(f32::from).collect::<Vec<_>>().into(),
        _ => bytes.into(),
    };
    let volume = Volume::new(volume.name(), *volume.grid(), voxels)?;
    Ok(Arc::new(VolumeSource::new(Arc::new(volume))))
}
