//! `label_texture`: a volume of labels on the device, with the room around each voxel that has its label alone.
//!
//! Two bytes a voxel: its label, and in how many voxels to each side (a cube around it) there is no other label, up to
//! 255. Rays go through such a cube in one stride. It is the chessboard distance to the nearest voxel that has another
//! label among its 26 neighbours, in two sweeps over the volume (Rosenfeld and Pfaltz 1968).

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;
use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Size,
    UploadBytes,
};
use volgraph_report::Finding;
use volgraph_volume::{Volume, Voxels};
use wgpu_types::TextureFormat;

use crate::placement::{self, volume};
use crate::source::volume::VolumeSource;

/// The node kind `label_texture`.
pub struct LabelTexture;

const INPUTS: &[InputPort] = &[InputPort {
    name: "labels",
    ty: PortType::Volume,
    requirement: Requirement::Required,
    doc: "The volume of labels: whole numbers of 0 to 255.",
}];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "texture",
    ty: PortType::LabelTexture,
    doc: "Its labels, and the voxels to each side of one in which there is no other.",
}];

impl NodeKind for LabelTexture {
    fn name(&self) -> &'static str {
        "label_texture"
    }

    fn doc(&self) -> &'static str {
        "Uploads a volume of labels, with the room that each has around it."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let volume = volume(node, "labels")?;
        check(node, volume)?;
        Ok(ResourceDesc::Texture {
            dimensions: 3,
            size: Size::Absolute(volume.grid().dims),
            format: TextureFormat::Rg8Uint,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let volume = node
            .source::<VolumeSource>("labels")
            .map(|source| Arc::clone(&source.volume));
        let bytes = UploadBytes::by_layers(move || {
            let volume = volume.clone();
            let rooms = volume.as_deref().map(|volume| {
                let dims = volume.grid().dims.map(|n| n as usize);
                rooms(&labels(volume), dims)
            });
            Ok(Box::new(move |layers, texels| {
                if let (Some(volume), Some(rooms)) = (&volume, &rooms) {
                    fill(volume, rooms, placement::voxels_of(volume, layers), texels);
                }
                Ok(())
            }))
        });
        Ok(vec![Pass::Upload {
            port: "texture",
            bytes,
        }])
    }
}

/// Whether all voxels are labels.
fn check(node: &NodeContext<'_>, volume: &Volume) -> Result<(), Finding> {
    let voxels = volume.voxels();
    let is_label = |value: f64| (0.0..=255.0).contains(&value) && value.fract() == 0.0;
    let at = match voxels {
        Voxels::U8(_) => None,
        _ => (0..voxels.len())
            .into_par_iter()
            .find_first(|at| !is_label(voxels.get(*at))),
    };
    let Some(at) = at else { return Ok(()) };
    let [nx, ny, _] = volume.grid().dims.map(|n| n as usize);
    let (x, y, z) = (at % nx, at / nx % ny, at / nx / ny);
    let message = format!(
        "the volume of labels `{}` has {} at voxel ({x}, {y}, {z}); labels are whole numbers of 0 to 255",
        volume.name(),
        voxels.get(at)
    );
    let help = "number its segments from 0 to 255, and store them as uint8";
    Err(node.error("bad-labels", message).help(help))
}

/// All labels.
fn labels(volume: &Volume) -> Cow<'_, [u8]> {
    match volume.voxels() {
        Voxels::U8(labels) => Cow::Borrowed(labels),
        voxels => (0..voxels.len())
            .into_par_iter()
            .map(|at| label(voxels, at))
            .collect::<Vec<u8>>()
            .into(),
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "checked to be whole numbers of 0 to 255"
)]
fn label(voxels: &Voxels, at: usize) -> u8 {
    voxels.get(at) as u8
}

/// Fills in label and room of these voxels.
fn fill(volume: &Volume, rooms: &[u8], voxels: Range<usize>, texels: &mut [u8]) {
    for (texel, at) in texels.chunks_exact_mut(2).zip(voxels) {
        texel.copy_from_slice(&[label(volume.voxels(), at), rooms[at]]);
    }
}

/// Of each voxel the voxels to each side, in a cube around it, in which there is no other label. What lies outside of
/// the grid does not count.
fn rooms(labels: &[u8], [nx, ny, nz]: [usize; 3]) -> Vec<u8> {
    let row = |y: usize, z: usize| (z * ny + y) * nx;
    let mut rooms = vec![0; labels.len()];
    rooms
        .par_chunks_mut(nx)
        .enumerate()
        .for_each(|(at, rooms)| {
            let (y, z) = (at % ny, at / ny);
            let starts: Vec<usize> = around(z, nz)
                .into_iter()
                .flat_map(|z| around(y, ny).map(|y| row(y, z)))
                .collect();
            for (x, room) in rooms.iter_mut().enumerate() {
                let label = labels[row(y, z) + x];
                let columns = around(x, nx);
                let is_alone = starts
                    .iter()
                    .all(|start| columns.iter().all(|x| labels[start + x] == label));
                *room = if is_alone { u8::MAX } else { 0 };
            }
        });
    // At the grid's faces a neighbour is taken from inside, which changes nothing.
    let before = |i: usize, _: usize| i.saturating_sub(1);
    let after = |i: usize, n: usize| (i + 1).min(n - 1);
    for z in 0..nz {
        for y in 0..ny {
            let (zb, yb) = (before(z, nz), before(y, ny));
            let rows = [row(yb, zb), row(y, zb), row(after(y, ny), zb), row(yb, z)];
            for x in 0..nx {
                relax(
                    &mut rooms,
                    row(y, z) + x,
                    row(y, z) + before(x, nx),
                    &rows,
                    around(x, nx),
                );
            }
        }
    }
    for z in (0..nz).rev() {
        for y in (0..ny).rev() {
            let (za, ya) = (after(z, nz), after(y, ny));
            let rows = [row(ya, za), row(y, za), row(before(y, ny), za), row(ya, z)];
            for x in (0..nx).rev() {
                relax(
                    &mut rooms,
                    row(y, z) + x,
                    row(y, z) + after(x, nx),
                    &rows,
                    around(x, nx),
                );
            }
        }
    }
    rooms
}

/// A place on an axis and its neighbours, taken from inside at its ends.
fn around(i: usize, n: usize) -> [usize; 3] {
    [i.saturating_sub(1), i, (i + 1).min(n - 1)]
}

/// A voxel has at most one voxel more room than each of its neighbours.
fn relax(rooms: &mut [u8], at: usize, beside: usize, rows: &[usize; 4], columns: [usize; 3]) {
    if rooms[at] == 0 {
        return;
    }
    let mut least = rooms[beside];
    for row in rows {
        for x in columns {
            least = least.min(rooms[row + x]);
        }
    }
    rooms[at] = rooms[at].min(least.saturating_add(1));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_room_around_a_voxel_has_its_label_alone() {
        let dims = [9_usize, 7, 6];
        let mut state = 1_u32;
        for seeds in [0, 1, 3, 20] {
            let mut labels = vec![5_u8; dims.iter().product()];
            for _ in 0..seeds {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let at = state as usize % labels.len();
                labels[at] = 1;
            }
            let rooms = rooms(&labels, dims);
            for at in 0..labels.len() {
                let place =
                    |at: usize| [at % dims[0], at / dims[0] % dims[1], at / dims[0] / dims[1]];
                let distance = |other: usize| {
                    let (a, b) = (place(at), place(other));
                    (0..3).map(|i| a[i].abs_diff(b[i])).max().unwrap_or(0)
                };
                let nearest = (0..labels.len())
                    .filter(|other| labels[*other] != labels[at])
                    .map(distance)
                    .min();
                let expected = nearest.map_or(255, |nearest| nearest - 1);
                assert_eq!(usize::from(rooms[at]), expected, "voxel {at} of {seeds}");
            }
        }
    }
}
