//! `multipass_raycast`: rays that advance some segments in each of many passes (Röttger et al. 2003, appendix).
//!
//! Its passes hand rays on in float textures of two kinds, written in turns, and a list of the rays that are not done.
//! How many passes there are is planned here, from the longest way that a ray of the view can have through the box: no
//! pass is left out that a ray needs, and those at the end run for the rays that are left.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use glam::DVec3;
use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, ProgramSpec, ResourceDesc, Size,
    SlotSpec, Uniform, View,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use volgraph_volume::Grid;
use wgpu_types::TextureFormat;

use crate::composing;
use crate::placement::volume;
use crate::raycast::longest_ray;

/// The node kind `multipass_raycast`.
pub struct MultipassRaycast;

const fn own(name: &'static str, ty: PortType, doc: &'static str) -> OutputPort {
    OutputPort { name, ty, doc }
}

const OUTPUTS: &[OutputPort] = &[
    own(
        "color",
        PortType::Color,
        "Linear premultiplied colour, over what lies behind.",
    ),
    own(
        "light_even",
        PortType::Color,
        "Colour and transmittance that rays have after an even number of passes.",
    ),
    own(
        "light_odd",
        PortType::Color,
        "The same after an odd number of passes.",
    ),
    own(
        "place_even",
        PortType::Scalar2d,
        "Segments that rays have gone after an even number of passes; -1 where they are done.",
    ),
    own(
        "place_odd",
        PortType::Scalar2d,
        "The same after an odd number of passes.",
    ),
    own(
        "rays",
        PortType::Buffer,
        "The pixels whose rays are not done.",
    ),
    own(
        "workgroups",
        PortType::Buffer,
        "How many workgroups a pass over them has.",
    ),
];

/// What is left of the shared inputs and slots without clips: parts of rays would have to be handed on as well.
static INPUTS: LazyLock<Vec<InputPort>> = LazyLock::new(|| {
    let ports = composing::INPUTS.iter().copied();
    ports
        .filter(|port| !port.name.starts_with("clip"))
        .collect()
});

static SLOTS: LazyLock<Vec<SlotSpec>> = LazyLock::new(|| {
    let slots = composing::SLOTS.iter().copied();
    slots.filter(|slot| slot.name != "clip").collect()
});

/// Most passes: with more, a step is far below what shows, or the volume far larger than what fits.
const MAX_PASSES: f64 = 16_384.0;

impl NodeKind for MultipassRaycast {
    fn name(&self) -> &'static str {
        "multipass_raycast"
    }

    fn doc(&self) -> &'static str {
        "Casts rays through a volume, some segments in each of many passes."
    }

    fn inputs(&self) -> &[InputPort] {
        &INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        let mut params = vec![
            ParamSpec::int(
                "passes_per_termination",
                4,
                "After how many passes the list of rays is made anew, without those that are done.",
            )
            .range(1.0, 1024.0),
        ];
        let shared = composing::params().into_iter();
        params.extend(shared.filter(|spec| !spec.name.starts_with("clip")));
        params
    }

    fn slots(&self) -> &[SlotSpec] {
        &SLOTS
    }

    fn uniforms(&self) -> &[&'static str] {
        &["volume", "transfer", "preintegration_3d"]
    }

    fn program(&self, node: &NodeContext<'_>) -> Option<ProgramSpec> {
        let mut fixed_slots = composing::fixed_slots(node);
        fixed_slots.insert("traverse".to_owned(), "uniform".to_owned());
        Some(ProgramSpec {
            root: "node/multipass_raycast.wgsl",
            fixed_slots,
            entries: vec![
                "multipass_reset",
                "multipass_begin",
                "multipass_settle",
                "multipass_advance_even",
                "multipass_advance_odd",
                "multipass_terminate_even",
                "multipass_terminate_odd",
            ],
            inherited: Vec::new(),
        })
    }

    fn passes_follow_camera(&self) -> bool {
        true
    }

    fn written(&self, wanted: &BTreeSet<&str>) -> Vec<&'static str> {
        // Each pass goes on with what others wrote.
        let ports = OUTPUTS.iter().map(|port| port.name);
        ports.filter(|_| !wanted.is_empty()).collect()
    }

    fn output(&self, port: &str, _node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        Ok(match port {
            // `Rays` in the shader: 16 bytes, then two lists of all pixels.
            "rays" => ResourceDesc::ViewBuffer {
                head: 16,
                per_pixel: 8,
            },
            "workgroups" => ResourceDesc::Buffer { bytes: 16 },
            _ => ResourceDesc::Texture {
                dimensions: 2,
                size: Size::ViewRelative(1.0),
                format: if port.starts_with("place") {
                    TextureFormat::R32Float
                } else {
                    TextureFormat::Rgba32Float
                },
            },
        })
    }

    fn uniform(&self, name: &str, node: &NodeContext<'_>) -> Result<Uniform, Finding> {
        composing::uniform(name, node)
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        composing::check(node)?;
        let Some(view) = node.view() else {
            return Ok(Vec::new());
        };
        let grid = volume(node, "volume")?.grid();
        let segments = longest_way(grid, view) / (node.float("step") * grid.min_spacing());
        let planned = (segments / f64::from(node.uint("steps_per_pass").max(1))).ceil() + 1.0;
        if planned > MAX_PASSES {
            return Err(node
                .error(
                    "too-many-passes",
                    format!("its longest ray needs {planned} passes, of {MAX_PASSES} at most"),
                )
                .help("choose a longer `step`, or more `steps_per_pass`"));
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "they are counted above"
        )]
        let planned = planned as u32;
        Ok(passes(
            planned,
            node.uint("passes_per_termination").max(1),
            view.size,
        ))
    }
}

fn passes(planned: u32, per_termination: u32, [width, height]: [u32; 2]) -> Vec<Pass> {
    let compute = |entry, workgroups| Pass::Compute {
        entry,
        workgroups,
        constants: Vec::new(),
    };
    let over_rays = |entry| Pass::ComputeIndirect {
        entry,
        workgroups: "workgroups",
        constants: Vec::new(),
    };
    let settle = || compute("multipass_settle", [1; 3]);
    let mut passes = vec![
        compute("multipass_reset", [1; 3]),
        compute(
            "multipass_begin",
            [width.div_ceil(8), height.div_ceil(8), 1],
        ),
        settle(),
    ];
    for pass in 0..planned {
        let is_even = pass % 2 == 0;
        passes.push(over_rays(if is_even {
            "multipass_advance_even"
        } else {
            "multipass_advance_odd"
        }));
        if (pass + 1) % per_termination == 0 {
            // What an even pass reads, an odd one has written.
            passes.push(over_rays(if is_even {
                "multipass_terminate_odd"
            } else {
                "multipass_terminate_even"
            }));
            passes.push(settle());
        }
    }
    passes
}

/// A bound of the way that a ray of a view has through a volume's box, in world units: the box's diagonal, or less where
/// all rays of the view go through the space between two of its faces steeply enough.
fn longest_way(grid: &Grid, view: &View) -> f64 {
    let (low, high) = grid.box_index();
    let extent = high - low;
    let lens = view.lens();
    let [across, up] = lens.half_extent;
    let widest = if lens.is_orthographic {
        0.0
    } else {
        across.hypot(up).atan()
    };
    let sides = grid.world_from_index.matrix3;
    let columns = [sides.x_axis, sides.y_axis, sides.z_axis];
    let mut longest = longest_ray(grid);
    for axis in 0..3 {
        let normal: DVec3 = columns[(axis + 1) % 3].cross(columns[(axis + 2) % 3]);
        let normal = normal.normalize_or_zero();
        let between = (columns[axis] * extent[axis]).dot(normal).abs();
        let angle = normal.dot(view.camera.forward).abs().min(1.0).acos() + widest;
        if angle.cos() > 0.0 && angle < std::f64::consts::FRAC_PI_2 {
            longest = longest.min(between / angle.cos());
        }
    }
    longest
}
