//! `fetch_only`: the limit of raycasting on a device, for a technique's time to be told as a ratio to it.
//!
//! The same rays as those of a raycast, from the same proxy geometry, with as many samples at the same places from the
//! same texture by the same sampler: one trilinear fetch a step and one addition. It is no technique of a raycast, for
//! those get segments, parts and slots, which cost something too.

use std::collections::BTreeMap;

use volgraph_graph::{
    Demand, Geometry, InputPort, Mesh, NodeContext, NodeKind, OutputPort, Pass, PortType,
    ProgramSpec, Requirement, ResourceDesc, Size, Uniform,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

use crate::raycast::{MAX_SEGMENTS, longest_ray, tile, tile_uniform};
use crate::{brick_proxy, placement, proxy_box, volume_texture};

/// The node kind `fetch_only`.
pub struct FetchOnly;

const INPUTS: &[InputPort] = &[
    InputPort {
        name: "volume",
        ty: PortType::Volume,
        requirement: Requirement::Required,
        doc: "The volume.",
    },
    InputPort {
        name: "rays",
        ty: PortType::Mesh,
        requirement: Requirement::Required,
        doc: "The proxy geometry that starts the rays.",
    },
    InputPort {
        name: "volume_texture",
        ty: PortType::VolumeTexture,
        requirement: Requirement::Demanded(Demand {
            kind: "volume_texture",
            inputs: &[("volume", "volume")],
            params: &[("volume_storage", "volume_storage")],
            slots: &[],
        }),
        doc: "The volume on the device.",
    },
];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "color",
    ty: PortType::Color,
    doc: "The sum of the samples along each ray, as an opaque grey.",
}];

impl NodeKind for FetchOnly {
    fn name(&self) -> &'static str {
        "fetch_only"
    }

    fn doc(&self) -> &'static str {
        "Adds up the samples of a raycast and does nothing else: the limit that techniques are measured against."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![
            ParamSpec::choice(
                "stage",
                &["auto", "fragment", "compute"],
                "auto",
                "Whether rays run in a fragment or a compute shader; auto measures both once and takes the faster.",
            ),
            volume_texture::storage_param(),
        ]
    }

    fn uniforms(&self) -> &[&'static str] {
        &["volume", "tile"]
    }

    fn program(&self, node: &NodeContext<'_>) -> Option<ProgramSpec> {
        let mut entries = vec!["fetch_only_begin"];
        if node.text("stage") != "compute" {
            entries.extend(["fetch_only_vertex", "fetch_only_fragment"]);
        }
        if node.text("stage") != "fragment" {
            entries.push("fetch_only_compute");
        }
        Some(ProgramSpec {
            root: "node/fetch_only.wgsl",
            fixed_slots: BTreeMap::from(placement::texel_slots(node)),
            entries,
            inherited: Vec::new(),
        })
    }

    fn passes_follow_camera(&self) -> bool {
        true
    }

    fn variants(&self, node: &NodeContext<'_>) -> Vec<&'static str> {
        match node.text("stage") {
            "fragment" => vec!["fragment"],
            "compute" => vec!["compute"],
            _ => vec!["fragment", "compute"],
        }
    }

    fn output(&self, _port: &str, _node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::ViewRelative(1.0),
            format: TextureFormat::Rgba32Float,
        })
    }

    fn uniform(&self, name: &str, node: &NodeContext<'_>) -> Result<Uniform, Finding> {
        match name {
            "volume" => placement::uniform(node),
            _ => tile_uniform(node),
        }
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        check_samples(node)?;
        brick_proxy::check_whole(node)?;
        let compute = |entry, [width, height]: [u32; 2]| Pass::Compute {
            entry,
            workgroups: [width.div_ceil(8), height.div_ceil(8), 1],
            constants: Vec::new(),
        };
        let view = node.view().map_or([0; 2], |view| view.size);
        let mut passes = vec![compute("fetch_only_begin", view)];
        match (node.variant(), tile(node)?) {
            (_, None) => {}
            (Some("compute"), Some([_, _, width, height])) => {
                passes.push(compute("fetch_only_compute", [width, height]));
            }
            _ => passes.push(Pass::Draw {
                vertex: "fetch_only_vertex",
                fragment: "fetch_only_fragment",
                geometry: Geometry::Mesh(Mesh {
                    port: "rays",
                    vertices: proxy_box::VERTICES,
                }),
                targets: Vec::new(),
                depth: None,
                constants: Vec::new(),
            }),
        }
        Ok(passes)
    }
}

/// The longest ray must not have more samples than `samples` can be.
fn check_samples(node: &NodeContext<'_>) -> Result<(), Finding> {
    let grid = placement::volume(node, "volume")?.grid();
    let step = node.float("step") * grid.min_spacing();
    let samples = (longest_ray(grid) / step).ceil();
    if step > 0.0 && samples > MAX_SEGMENTS {
        return Err(node
            .error(
                "too-many-segments",
                format!("its longest ray has {samples} samples, of {MAX_SEGMENTS} at most"),
            )
            .help("choose a longer `step`, or resample the volume to voxels closer to cubes"));
    }
    Ok(())
}
