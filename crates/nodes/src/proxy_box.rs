//! `proxy_box`: the box of a volume as triangles, which a raycast draws to start its rays; of several volumes, a box along
//! the world's axes around all of them.

use glam::DVec3;
use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc,
    UploadBytes,
};
use volgraph_report::Finding;
use volgraph_volume::Grid;

use crate::placement::placed;

/// The node kind `proxy_box`.
pub struct ProxyBox;

/// Two triangles for each of six faces.
pub const VERTICES: u32 = 36;

/// The ports of volumes, in their order.
pub(crate) const VOLUMES: [&str; 4] = ["volume", "volume_2", "volume_3", "volume_4"];

const INPUTS: &[InputPort] = &[
    InputPort {
        name: "volume",
        ty: PortType::Volume,
        requirement: Requirement::Required,
        doc: "The volume whose box is drawn.",
    },
    more("volume_2"),
    more("volume_3"),
    more("volume_4"),
];

const fn more(name: &'static str) -> InputPort {
    InputPort {
        name,
        ty: PortType::Volume,
        requirement: Requirement::Optional,
        doc: "Another volume that the box encloses.",
    }
}

pub(crate) const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "rays",
    ty: PortType::Mesh,
    doc: "Triangles in world space from the scene's origin, anticlockwise as seen from outside.",
}];

impl NodeKind for ProxyBox {
    fn name(&self) -> &'static str {
        "proxy_box"
    }

    fn doc(&self) -> &'static str {
        "Makes the bounding box of a volume, or of up to four, as the geometry that starts rays."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn output(&self, _port: &str, _node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        Ok(resource())
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let grid = enclosing(node)?;
        let (low, high) = grid.box_index();
        passes(node, &grid, low, high)
    }
}

/// A grid whose box is that of a node's volume; of several volumes, a single voxel along the world's axes around all.
///
/// # Errors
/// `missing-input` where there is none.
pub(crate) fn enclosing(node: &NodeContext<'_>) -> Result<Grid, Finding> {
    let connected = VOLUMES.iter().filter(|port| node.is_connected(port));
    let grids: Vec<Grid> = connected
        .map(|port| placed(node, port).map(|volume| *volume.grid()))
        .collect::<Result<_, _>>()?;
    if grids.len() < 2 {
        return Ok(*placed(node, "volume")?.grid());
    }
    let corners = || grids.iter().flat_map(Grid::corners_world);
    let low = corners().fold(DVec3::INFINITY, DVec3::min);
    let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
    Ok(Grid::axis_aligned([1; 3], high - low, 0.5 * (low + high)))
}

/// What holds the triangles of a box.
pub(crate) fn resource() -> ResourceDesc {
    ResourceDesc::Buffer {
        bytes: u64::from(VERTICES) * 12,
    }
}

/// Uploads the triangles of a box between two points in index coordinates of a grid.
pub(crate) fn passes(
    node: &NodeContext<'_>,
    grid: &Grid,
    low: DVec3,
    high: DVec3,
) -> Result<Vec<Pass>, Finding> {
    let origin = node.origin();
    let vertices: Vec<[f32; 3]> = triangles(grid, low, high)
        .into_iter()
        .map(|v| (v - origin).as_vec3().to_array())
        .collect();
    let bytes = UploadBytes::new(move || Ok(bytemuck::cast_slice(&vertices).to_vec()));
    Ok(vec![Pass::Upload {
        port: "rays",
        bytes,
    }])
}

/// The corners of a box's triangles in world space.
fn triangles(grid: &Grid, low: DVec3, high: DVec3) -> Vec<DVec3> {
    let centre = grid.world_from_index.transform_point3(0.5 * (low + high));
    let mut corners = Vec::with_capacity(VERTICES as usize);
    for axis in 0..3 {
        for side in [low, high] {
            let corner = |u: bool, v: bool| {
                let mut index = low;
                index[axis] = side[axis];
                let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
                index[next] = if u { high[next] } else { low[next] };
                index[last] = if v { high[last] } else { low[last] };
                grid.world_from_index.transform_point3(index)
            };
            let quad = [
                corner(false, false),
                corner(true, false),
                corner(true, true),
                corner(false, true),
            ];
            let normal = (quad[1] - quad[0]).cross(quad[3] - quad[0]);
            let outward = (quad[0] + quad[2]) * 0.5 - centre;
            // A mirrored or oblique placement turns faces over; the normal tells.
            let order = if normal.dot(outward) >= 0.0 {
                [0, 1, 2, 0, 2, 3]
            } else {
                [0, 2, 1, 0, 3, 2]
            };
            corners.extend(order.map(|at| quad[at]));
        }
    }
    corners
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DMat3};

    use super::*;

    #[test]
    fn faces_look_outward_for_mirrored_and_oblique_grids_too() {
        let placements = [
            DMat3::IDENTITY,
            DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 2.0)),
            DMat3::from_cols(
                DVec3::new(0.0, 2.0, 0.1),
                DVec3::new(1.0, 0.2, 0.0),
                DVec3::new(0.3, 0.0, -1.0),
            ),
        ];
        for matrix in placements {
            let mut grid = Grid::axis_aligned([3, 4, 5], DVec3::ONE, DVec3::ZERO);
            grid.world_from_index =
                DAffine3::from_mat3_translation(matrix, DVec3::new(5.0, -7.0, 1.0));
            let (low, high) = grid.box_index();
            let centre = grid.world_from_index.transform_point3(0.5 * (low + high));
            let mut volume = 0.0;
            for triangle in triangles(&grid, low, high).chunks_exact(3) {
                let normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
                assert!(normal.dot(triangle[0] - centre) > 0.0);
                volume += (triangle[0] - centre).dot(normal) / 6.0;
            }
            let expected = matrix.determinant().abs() * 3.0 * 4.0 * 5.0;
            assert!((volume - expected).abs() < 1e-9, "{volume} {expected}");
        }
    }
}
