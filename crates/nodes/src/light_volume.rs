//! `light_volume`: how much of each light reaches the points of a grid, computed once and looked up by shadows.
//!
//! Its shader walks towards the lights by the same slots, parameters and inputs as the raycast that calls for it: all
//! go over by their names. GL stores into no 3D texture, so that the grid is an atlas: its slices along z side by side in
//! a 2D texture, one channel for each of the four lights. The grid's outer points lie on the faces of the volume's box;
//! a lookup between two points of a slice never reads the next slice.
//!
//! With a light at the eye the shader reads the camera, and the grid is made again for each pose; without one the camera
//! is no part of its fingerprint.

use std::sync::LazyLock;

use glam::{DMat4, DVec3};
use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, ProgramSpec, ResourceDesc, Size,
    SlotSpec, Uniform,
};
use volgraph_report::Finding;
use volgraph_shader::{ParamSpec, ParamValue, UniformValue};
use volgraph_volume::Grid;
use wgpu_types::TextureFormat;

use crate::placement;
use crate::raycast::Raycast;
use crate::segmentation;

/// The node kind `light_volume`.
pub struct LightVolume;

/// Ports of the raycast that have nothing to do with how light gets through the volume.
const WITHOUT: [&str; 7] = [
    "rays",
    "behind",
    "image",
    "image_texture",
    "light_volume",
    "environment",
    "environment_texture",
];

/// The raycast's other ports: whatever its slots read, they read here.
static INPUTS: LazyLock<Vec<InputPort>> = LazyLock::new(|| {
    let ports = Raycast.inputs().iter().copied();
    ports.filter(|port| !WITHOUT.contains(&port.name)).collect()
});

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "light",
    ty: PortType::LightGrid,
    doc: "Share of each of four lights that reaches the points of a grid over the volume's box, slice by slice.",
}];

impl NodeKind for LightVolume {
    fn name(&self) -> &'static str {
        "light_volume"
    }

    fn doc(&self) -> &'static str {
        "Computes how much of each light reaches the points of a grid."
    }

    fn inputs(&self) -> &[InputPort] {
        &INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        let params = Raycast.params().into_iter();
        // Those of the eye's own walk are nothing to light.
        params
            .filter(|spec| !["stage", "step_tolerance"].contains(&spec.name.as_str()))
            .collect()
    }

    fn slots(&self) -> &[SlotSpec] {
        Raycast.slots()
    }

    fn default_of(&self, param: &str, node: &NodeContext<'_>) -> Option<ParamValue> {
        Raycast.default_of(param, node)
    }

    fn uniforms(&self) -> &[&'static str] {
        Raycast.uniforms()
    }

    fn program(&self, node: &NodeContext<'_>) -> Option<ProgramSpec> {
        let eye_light = if may_shine_from_eye(node) {
            "shines"
        } else {
            "none"
        };
        let mut fixed_slots = crate::raycast::walk_slots(node);
        fixed_slots.insert("eye_light".to_owned(), eye_light.to_owned());
        fixed_slots.extend(crate::raycast::leaps(node));
        if leaps(node) {
            // One that does not depend on the eye's steps: where those change, light does not.
            fixed_slots.insert("look".to_owned(), "distance_map".to_owned());
            fixed_slots.insert("shadow_leap".to_owned(), "bricks".to_owned());
        }
        Some(ProgramSpec {
            root: "node/light_volume.wgsl",
            fixed_slots,
            inherited: Vec::new(),
            entries: vec!["light_volume_compute"],
        })
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let atlas = Atlas::of(node, node)?;
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::Absolute(atlas.size()),
            // Filtered everywhere, which single floats are not.
            format: TextureFormat::Rgba16Float,
        })
    }

    fn uniform(&self, name: &str, node: &NodeContext<'_>) -> Result<Uniform, Finding> {
        match name {
            "light_grid" => uniform(node, node),
            _ => Raycast.uniform(name, node),
        }
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        crate::raycast::check_walk(node)?;
        let [width, height, _] = Atlas::of(node, node)?.size();
        Ok(vec![Pass::Compute {
            entry: "light_volume_compute",
            workgroups: [width.div_ceil(8), height.div_ceil(8), 1],
            constants: Vec::new(),
        }])
    }
}

/// Whether rays towards lights leap through the bricks of which the eye sees nothing: where that is by the transfer function
/// alone, and whatever they look up is made of it.
fn leaps(node: &NodeContext<'_>) -> bool {
    let looks = crate::raycast::looks_at(node);
    let is_own = |map: NodeContext<'_>| {
        map.slot("emptiness") == "transfer" && crate::raycast::is_of_own_transfer(node, &map)
    };
    node.slot("emptiness") == "transfer"
        && looks.is_some_and(|look| ["distance_map", "stride_map"].contains(&look.as_str()))
        && node.writer("distance_map").is_none_or(is_own)
        && crate::raycast::tables_are_own(node)
}

/// Whether a light that shines is at the eye. What is not known stands for one.
fn may_shine_from_eye(node: &NodeContext<'_>) -> bool {
    (1..=most_lights(node, 4)).any(|number| is_at_eye(node, number).unwrap_or(true))
}

/// Where lights shine from, the slot `light_places`: all from the eye, as the one does that shines where nothing is said,
/// or from anywhere.
pub(crate) fn places_slot(node: &NodeContext<'_>) -> (String, String) {
    let is_at_eye = |number| is_at_eye(node, number).unwrap_or(true);
    // Labels may have lights of their own.
    let choice = if (1..=most_lights(node, 1)).all(is_at_eye) && !segmentation::has_labels(node) {
        "eye"
    } else {
        "anywhere"
    };
    ("light_places".to_owned(), choice.to_owned())
}

/// How many lights shine; `unsaid` where that is not said.
fn most_lights(node: &NodeContext<'_>, unsaid: i64) -> i64 {
    match said(node, "lights") {
        // Whether it is in its range is not known yet.
        Some(ParamValue::Int(count)) => (*count).clamp(0, 4),
        Some(_) => 4,
        None => unsaid,
    }
}

/// Whether the light of a number is at the eye (all zeros), where it is said where it is.
fn is_at_eye(node: &NodeContext<'_>, number: i64) -> Option<bool> {
    said(node, &format!("light_{number}")).map(|light| match light {
        // What is too small for a shader is zero there.
        ParamValue::Vector(light) => light.iter().all(|value| value.abs() < 1e-15),
        _ => false,
    })
}

/// A parameter of a shader, which is not linked where its slots are chosen.
fn said<'g>(node: &NodeContext<'g>, name: &str) -> Option<&'g ParamValue> {
    node.param(name).or_else(|| node.given(name))
}

/// A grid whose slices lie side by side.
struct Atlas {
    /// Points along each axis.
    dims: [u32; 3],
    /// Slices in a row.
    columns: u32,
}

impl Atlas {
    /// The grid that `writer` makes over the volume of `node`.
    fn of(node: &NodeContext<'_>, writer: &NodeContext<'_>) -> Result<Self, Finding> {
        let grid = placement::volume(node, "volume")?.grid();
        let sides = sides(grid);
        let most = f64::from(writer.uint("light_resolution").max(2));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 2 to a number of 32 bits"
        )]
        let dims = (sides / sides.max_element())
            .to_array()
            .map(|share| (share * most).round().max(2.0) as u32);
        // As near to a square as slices lie.
        let wanted = f64::from(dims[2]) * f64::from(dims[1]) / f64::from(dims[0]);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 1 to the number of slices"
        )]
        let columns = wanted.sqrt().ceil().clamp(1.0, f64::from(dims[2])) as u32;
        Ok(Self { dims, columns })
    }

    fn size(&self) -> [u32; 3] {
        let [width, height, depth] = self.dims;
        [
            width.saturating_mul(self.columns),
            height.saturating_mul(depth.div_ceil(self.columns)),
            1,
        ]
    }
}

/// World lengths of the box's sides.
fn sides(grid: &Grid) -> DVec3 {
    let (low, high) = grid.box_index();
    grid.spacing() * (high - low)
}

/// The members of the uniform `light_grid` (see `lib/light_grid.wgsl`), of the grid that `writer` makes.
///
/// # Errors
/// `missing-input` where there is no volume.
pub(crate) fn uniform(
    node: &NodeContext<'_>,
    writer: &NodeContext<'_>,
) -> Result<Uniform, Finding> {
    let atlas = Atlas::of(node, writer)?;
    let grid = placement::volume(node, "volume")?.grid();
    let (low, high) = grid.box_index();
    // A thousandth of a voxel within the faces: a ray along a face would miss the box by a rounding.
    let (low, high) = (low + 1e-3, high - 1e-3);
    let last = DVec3::from_array(atlas.dims.map(f64::from)) - 1.0;
    let step = (high - low) / last;
    let affine = grid.world_from_index;
    let origin = affine.transform_point3(low) - node.origin();
    let world_from_point = DMat4::from_cols(
        affine.transform_vector3(DVec3::X * step.x).extend(0.0),
        affine.transform_vector3(DVec3::Y * step.y).extend(0.0),
        affine.transform_vector3(DVec3::Z * step.z).extend(0.0),
        origin.extend(1.0),
    );
    Ok(vec![
        ("dims", UniformValue::UVec3(atlas.dims)),
        ("columns", UniformValue::U32(atlas.columns)),
        (
            "world_from_point",
            UniformValue::Mat4(world_from_point.as_mat4().to_cols_array_2d()),
        ),
    ])
}
