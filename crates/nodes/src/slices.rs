//! `slices`: slabs across the view, drawn one after the other and blended in the framebuffer.
//!
//! How volumes were drawn before fragment shaders had loops, kept beside the raycast for comparison. Its shader makes
//! the polygons; one draw pass blends them from front to back into the output `slices`, whose precision is that of the
//! framebuffer, and a last one lays the result over what is behind.

use std::collections::BTreeSet;

use glam::DVec3;
use volgraph_graph::{
    Blend, Geometry, InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, ProgramSpec,
    ResourceDesc, Size, SlotSpec, Target, Uniform,
};
use volgraph_report::Finding;
use volgraph_shader::{ParamSpec, UniformValue};
use wgpu_types::TextureFormat;

use crate::composing;
use crate::placement::{f32_value, vec3, volume};

/// The node kind `slices`.
pub struct Slices;

/// A fan of four triangles.
const VERTICES: u32 = 12;

const OUTPUTS: &[OutputPort] = &[
    OutputPort {
        name: "color",
        ty: PortType::Color,
        doc: "Linear premultiplied colour, over what lies behind.",
    },
    OutputPort {
        name: "slices",
        ty: PortType::Color,
        doc: "The framebuffer: linear premultiplied colour of the slices alone, in the format that they are blended in.",
    },
];

impl NodeKind for Slices {
    fn name(&self) -> &'static str {
        "slices"
    }

    fn doc(&self) -> &'static str {
        "Draws a volume as slabs across the view, which are blended in the framebuffer."
    }

    fn inputs(&self) -> &[InputPort] {
        &composing::INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        let mut params = vec![
            ParamSpec::choice(
                "format",
                &["rgba8unorm", "rgba16float", "rgba32float"],
                "rgba16float",
                "What slices are blended in; rgba8unorm as on the graphics cards of the papers, which rounds each slice's opacity to 1/255.",
            ),
            ParamSpec::choice(
                "steps_per_pass",
                &["1", "4"],
                "1",
                "How many slabs a fragment adds up before it is blended.",
            ),
        ];
        params.extend(composing::params());
        params
    }

    fn slots(&self) -> &[SlotSpec] {
        &composing::SLOTS
    }

    fn uniforms(&self) -> &[&'static str] {
        &[
            "volume",
            "clip_placement",
            "transfer",
            "preintegration_3d",
            "slabs",
        ]
    }

    fn program(&self, node: &NodeContext<'_>) -> Option<ProgramSpec> {
        let slab = if node.slot("clip") == "none" {
            "whole"
        } else {
            "visible"
        };
        let mut fixed_slots = composing::fixed_slots(node);
        fixed_slots.insert("slab".to_owned(), slab.to_owned());
        Some(ProgramSpec {
            root: "node/slices.wgsl",
            fixed_slots,
            entries: vec!["slices_vertex", fragment(node), "slices_compose"],
            inherited: Vec::new(),
        })
    }

    fn targets(&self) -> &[&'static str] {
        &["slices"]
    }

    fn passes_follow_camera(&self) -> bool {
        true
    }

    fn written(&self, wanted: &BTreeSet<&str>) -> Vec<&'static str> {
        // Each pass goes on with what the other wrote.
        let ports = OUTPUTS.iter().map(|port| port.name);
        ports.filter(|_| !wanted.is_empty()).collect()
    }

    fn output(&self, port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let format = match (port, node.text("format")) {
            ("slices", "rgba8unorm") => TextureFormat::Rgba8Unorm,
            ("slices", "rgba16float") => TextureFormat::Rgba16Float,
            _ => TextureFormat::Rgba32Float,
        };
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::ViewRelative(1.0),
            format,
        })
    }

    fn uniform(&self, name: &str, node: &NodeContext<'_>) -> Result<Uniform, Finding> {
        match name {
            "slabs" => Ok(Stack::of(node)?.uniform(node)),
            _ => composing::uniform(name, node),
        }
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        composing::check(node)?;
        // Not where outputs are described: plans are made without a device as well.
        if node.text("format") == "rgba32float" && !node.limits().float32_blendable {
            return Err(node
                .error(
                    "over-limit",
                    "its `format` is rgba32float, which this device cannot blend (float32-blendable)",
                )
                .help("choose `format` rgba16float"));
        }
        if node.text("clip_method") == "naive" {
            return Err(node
                .error(
                    "not-covered",
                    "its parameter `clip_method` is naive, which draws whole segments along rays, and slices have none",
                )
                .help("set `clip_method` to accurate, or draw it with a raycast"));
        }
        let [width, height] = node.view().map_or([0; 2], |view| view.size);
        let draw = Pass::Draw {
            vertex: "slices_vertex",
            fragment: fragment(node),
            geometry: Geometry::Made {
                vertices: VERTICES,
                instances: Stack::of(node)?.slabs.div_ceil(slabs_at_once(node)),
            },
            targets: vec![Target {
                port: "slices",
                blend: Blend::Under,
                is_cleared: true,
            }],
            depth: None,
            constants: Vec::new(),
        };
        let compose = Pass::Compute {
            entry: "slices_compose",
            workgroups: [width.div_ceil(8), height.div_ceil(8), 1],
            constants: Vec::new(),
        };
        Ok(vec![draw, compose])
    }
}

fn slabs_at_once(node: &NodeContext<'_>) -> u32 {
    if node.text("steps_per_pass") == "4" {
        4
    } else {
        1
    }
}

fn fragment(node: &NodeContext<'_>) -> &'static str {
    match slabs_at_once(node) {
        4 => "slices_fragment_4",
        _ => "slices_fragment",
    }
}

/// The planes across the view that a volume is cut with.
struct Stack {
    /// Halves of the box's sides, turned away from the eye.
    halves: [DVec3; 3],
    /// From the middle of the box to its faces.
    face_distances: DVec3,
    /// Along the view's axis from the middle of the box.
    first: f64,
    last: f64,
    slabs: u32,
    /// A ray's length between planes that are 1 apart, at most.
    steepest: f64,
}

impl Stack {
    fn of(node: &NodeContext<'_>) -> Result<Self, Finding> {
        let grid = volume(node, "volume")?.grid();
        let (low, high) = grid.box_index();
        let half = 0.5 * (high - low);
        let sides = grid.world_from_index.matrix3;
        let mut halves = [
            half.x * sides.x_axis,
            half.y * sides.y_axis,
            half.z * sides.z_axis,
        ];
        let [x, y, z] = halves;
        let content = x.dot(y.cross(z)).abs();
        let distance = |a: DVec3, b: DVec3| content / a.cross(b).length();
        let face_distances = DVec3::new(distance(y, z), distance(z, x), distance(x, y));
        let Some(view) = node.view() else {
            return Err(node.error("internal", "slices are made for a view"));
        };
        let forward = view.camera.forward;
        for half in &mut halves {
            if half.dot(forward) < 0.0 {
                *half = -*half;
            }
        }
        let reach: f64 = halves.iter().map(|half| half.dot(forward)).sum();
        let centre = grid.world_from_index.transform_point3(0.5 * (low + high));
        // Rays start at the eye.
        let first = (-reach).max((view.camera.eye - centre).dot(forward));
        let step = node.float("step") * grid.min_spacing();
        let slabs = if first < reach {
            // What is left by rounding is no slab.
            ((reach - first) / step - 1e-6).ceil().max(1.0)
        } else {
            0.0
        };
        let lens = view.lens();
        let [across, up] = lens.half_extent;
        let steepest = if lens.is_orthographic {
            1.0
        } else {
            (1.0 + across * across + up * up).sqrt()
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the longest ray has 65,535 segments at most"
        )]
        let slabs = slabs as u32;
        Ok(Self {
            halves,
            face_distances,
            first,
            last: reach,
            slabs,
            steepest,
        })
    }

    fn uniform(&self, node: &NodeContext<'_>) -> Uniform {
        let [x, y, z] = self.halves;
        vec![
            ("half_x", vec3(x)),
            ("half_y", vec3(y)),
            ("half_z", vec3(z)),
            ("face_distances", vec3(self.face_distances)),
            ("first", f32_value(self.first)),
            ("last", f32_value(self.last)),
            ("slabs", UniformValue::U32(slabs_at_once(node))),
            ("steepest", f32_value(self.steepest)),
        ]
    }
}
