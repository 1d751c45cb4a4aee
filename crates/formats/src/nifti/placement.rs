//! Where the voxels lie: the choice among a header's three maps, as nibabel makes it.
//!
//! The affine map (sform) where its code is set, else the quaternion (qform), else nibabel's map of an image without
//! either: voxel sizes, x to the left, the origin in the middle of the grid. NIfTI's world is RAS; x and y are turned
//! around to LPS.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use volgraph_volume::{Grid, Trouble, VolumeError};

use super::header::Header;
use crate::axes::complete_basis;

pub(super) fn grid(header: &mut Header, dims: [u32; 3]) -> Result<Grid, VolumeError> {
    let mut ras = if header.sform > 0 {
        let columns = [0, 1, 2, 3].map(|axis| DVec3::from_array(header.srow.map(|row| row[axis])));
        DAffine3 {
            matrix3: DMat3::from_cols(columns[0], columns[1], columns[2]),
            translation: columns[3],
        }
    } else if header.qform > 0 {
        by_quaternion(header)?
    } else {
        by_sizes(header, dims)
    };
    let [x, y, z] = [ras.matrix3.x_axis, ras.matrix3.y_axis, ras.matrix3.z_axis];
    if dims[2] == 1 && z == DVec3::ZERO && x.cross(y) != DVec3::ZERO {
        ras.matrix3 = complete_basis(&[x, y]);
        let warning =
            "the map of the single slice has no third direction; taken perpendicular to the slice";
        header.warnings.push(warning.to_owned());
    }
    let lps = DMat3::from_diagonal(DVec3::new(-1.0, -1.0, 1.0));
    // Adding 0 makes -0 to 0, which nobody wants to read.
    let matrix3 = lps * ras.matrix3;
    Ok(Grid {
        dims,
        world_from_index: DAffine3 {
            matrix3: DMat3::from_cols(
                matrix3.x_axis + DVec3::ZERO,
                matrix3.y_axis + DVec3::ZERO,
                matrix3.z_axis + DVec3::ZERO,
            ),
            translation: lps * ras.translation + DVec3::ZERO,
        },
        node_centred: false,
    })
}

fn sizes(header: &Header) -> DVec3 {
    DVec3::new(header.pixdim[1], header.pixdim[2], header.pixdim[3])
}

/// The quaternion is stored without its first number, which is that of a unit quaternion.
fn by_quaternion(header: &Header) -> Result<DAffine3, VolumeError> {
    let [x, y, z] = header.quatern;
    let square = 1.0 - (x * x + y * y + z * z);
    let w = if square.abs() < header.quatern_margin {
        0.0
    } else {
        square.sqrt()
    };
    if square < 0.0 && w != 0.0 {
        return Err(VolumeError::Grid(Trouble::new(
            format!("the quaternion {x} {y} {z} of qform is longer than 1"),
            "correct quatern_b, quatern_c and quatern_d, or set qform_code to 0",
        )));
    }
    // With w rounded to 0 the length is not quite 1.
    let turn = DMat3::from_quat(
        DQuat::from_xyzw(x, y, z, w) * (1.0 / (x * x + y * y + z * z + w * w).sqrt()),
    );
    let mut sizes = sizes(header);
    sizes.z *= header.pixdim[0];
    Ok(DAffine3 {
        matrix3: turn * DMat3::from_diagonal(sizes),
        translation: DVec3::from_array(header.qoffset),
    })
}

fn by_sizes(header: &Header, dims: [u32; 3]) -> DAffine3 {
    let mut sizes = sizes(header) * DVec3::new(-1.0, 1.0, 1.0);
    // Sizes of axes that are not there mean nothing.
    for axis in 0..3 {
        if i64::try_from(axis).is_ok_and(|axis| axis >= header.dim[0]) {
            sizes[axis] = 1.0;
        }
    }
    let middle = DVec3::from_array(dims.map(|size| f64::from(size) - 1.0)) / 2.0;
    DAffine3 {
        matrix3: DMat3::from_diagonal(sizes),
        translation: -middle * sizes,
    }
}
