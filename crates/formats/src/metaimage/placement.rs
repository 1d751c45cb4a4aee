//! Where a MetaImage grid lies: directions, spacing and offset under their several names.

use glam::{DAffine3, DVec3};

use volgraph_volume::VolumeError;

use crate::axes::complete_basis;
use crate::fields::{Field, Fields};

/// World from index and the line to blame. A key that comes in several spellings may stand once.
pub(super) fn world_from_index(
    fields: &Fields,
    axes: usize,
) -> Result<(DAffine3, u32), VolumeError> {
    let one_of = |keys: &[&str]| -> Result<Option<&Field>, VolumeError> {
        let mut found = keys.iter().filter_map(|key| fields.get(key));
        match (found.next(), found.next()) {
            (Some(first), Some(second)) if first.value != second.value => Err(second.bad(
                format!("`{}` on line {} says otherwise", first.key, first.line),
                "keep one of the two",
            )),
            (first, _) => Ok(first),
        }
    };
    let spatial = axes.min(3);
    let vector = |numbers: &[f64]| {
        let mut vector = [0.0; 3];
        vector[..spatial].copy_from_slice(&numbers[..spatial]);
        DVec3::from_array(vector)
    };
    // ITK takes ElementSize, the extent of a voxel, where no ElementSpacing is said.
    let spacing = fields.get("ElementSpacing").or(fields.get("ElementSize"));
    let spacings = spacing.map_or(Ok(vec![1.0; axes]), |field| field.numbers::<f64>(axes))?;
    let rotation = one_of(&["TransformMatrix", "Rotation", "Orientation"])?;
    let matrix = rotation
        .map(|field| field.numbers::<f64>(axes * axes))
        .transpose()?;
    let offset = one_of(&["Offset", "Position", "Origin"])?;
    let origin = offset.map_or(Ok(vec![0.0; axes]), |field| field.numbers::<f64>(axes))?;
    let columns: Vec<DVec3> = (0..spatial)
        .map(|axis| match &matrix {
            Some(matrix) => vector(&matrix[axis * axes..]) * spacings[axis],
            None => DVec3::AXES[axis] * spacings[axis],
        })
        .collect();
    let line = rotation
        .or(spacing)
        .or(offset)
        .map_or(0, |field| field.line);
    let world_from_index = DAffine3 {
        matrix3: complete_basis(&columns),
        translation: vector(&origin),
    };
    Ok((world_from_index, line))
}
