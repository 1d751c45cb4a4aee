//! What a volume is at one place.

use glam::DVec3;
use serde::Serialize;
use volgraph_graph::NodeContext;
use volgraph_nodes::{placement, segmentation};
use volgraph_report::Finding;
use volgraph_volume::Volume;

/// What a volume is at a world position.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Probe {
    /// The world position.
    pub world: [f64; 3],
    /// The same in index coordinates: 0 at the middle of the first voxel.
    pub index: [f64; 3],
    /// Whether it is in the volume's box. What follows is only known there.
    pub is_inside: bool,
    /// The voxel that it is in.
    pub voxel: Option<[u32; 3]>,
    /// The trilinear scalar, in the file's units, whatever the raycast's `reconstruct` is.
    pub value: Option<f64>,
    /// Its world gradient: the file's units per world unit.
    pub gradient: Option<[f64; 3]>,
    /// The label there, where the raycast tells labels apart.
    pub label: Option<u8>,
    /// What people call that label, where its segments say.
    pub label_name: Option<String>,
}

impl Probe {
    /// The volume of a raycast at a world position.
    pub(super) fn of(node: &NodeContext<'_>, world: DVec3) -> Result<Self, Finding> {
        let volume = placement::volume(node, "volume")?;
        let probe = Self::in_volume(volume, world);
        if !probe.is_inside {
            return Ok(probe);
        }
        let label = segmentation::label_at(node, world)?;
        let segments = segmentation::segments(node);
        let segment = label.and_then(|label| segments?.segment(label));
        let name = segment.map(|segment| segment.name.clone());
        Ok(Self {
            label,
            label_name: name.filter(|name| !name.is_empty()),
            ..probe
        })
    }

    /// A volume without labels at a world position.
    #[must_use]
    pub fn in_volume(volume: &Volume, world: DVec3) -> Self {
        let grid = volume.grid();
        let index_from_world = grid.world_from_index.inverse();
        let index = index_from_world.transform_point3(world);
        let (low, high) = grid.box_index();
        // A place on the box's face is in it, however it was rounded.
        let room = DVec3::splat(1e-6);
        let is_inside = index.cmpge(low - room).all() && index.cmple(high + room).all();
        let last = DVec3::from_array(grid.dims.map(|n| f64::from(n) - 1.0));
        let voxel = (index + 0.5).floor().clamp(DVec3::ZERO, last);
        let gradient = index_from_world.matrix3.transpose() * gradient(volume, index, last);
        Self {
            world: world.to_array(),
            index: index.to_array(),
            is_inside,
            voxel: is_inside.then(|| voxel.as_uvec3().to_array()),
            value: is_inside.then(|| volume.trilinear(index)),
            gradient: is_inside.then(|| gradient.to_array()),
            label: None,
            label_name: None,
        }
    }
}

/// The gradient of the trilinear field by index coordinates. Along an axis the field is linear within a cell: its slope
/// is the difference of the cell's two faces. Beside the samples it is even.
fn gradient(volume: &Volume, index: DVec3, last: DVec3) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|axis| {
        if !(0.0..=last[axis]).contains(&index[axis]) || last[axis] < 1.0 {
            return 0.0;
        }
        let face = index[axis].floor().min(last[axis] - 1.0);
        let at = |face: f64| {
            let mut place = index;
            place[axis] = face;
            volume.trilinear(place)
        };
        at(face + 1.0) - at(face)
    }))
}
