//! `raycast`: one walk per pixel through the volume's box; slots say what a segment means.

use std::collections::{BTreeMap, BTreeSet};

use volgraph_graph::{
    Demand, InputPort, Mesh, NodeContext, NodeKind, OutputPort, ParamRow, Pass, PortType,
    ProgramSpec, Requirement, ResourceDesc, Size, SlotSpec, Uniform,
};
use volgraph_optics::{Domain, TransferFunction};
use volgraph_report::Finding;
use volgraph_shader::{ParamSpec, ParamValue, UniformValue};
use wgpu_types::TextureFormat;

use crate::placement::{self, f32_value};
use crate::source::segments::SegmentsSource;
use crate::{preintegration, proxy_box, segmentation, transfer_table, volume_texture};

/// The node kind `raycast`.
pub struct Raycast;

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
        name: "transfer",
        ty: PortType::Transfer,
        requirement: Requirement::Optional,
        doc: "The transfer function, for techniques that classify.",
    },
    InputPort {
        name: "labels",
        ty: PortType::Volume,
        requirement: Requirement::Optional,
        doc: "What the volume is made of, a whole number of 0 to 255 per voxel; outside of it is label 0.",
    },
    InputPort {
        name: "segments",
        ty: PortType::Segments,
        requirement: Requirement::Optional,
        doc: "What the labels mean; they are all drawn alike where it is open.",
    },
    InputPort {
        name: "behind",
        ty: PortType::Color,
        requirement: Requirement::Optional,
        doc: "What lies behind the volume; nothing where it is open.",
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
    InputPort {
        name: "gradient_volume",
        ty: PortType::GradientTexture,
        requirement: Requirement::Demanded(Demand {
            kind: "gradient",
            inputs: &[("volume", "volume")],
            params: &[("volume_storage", "volume_storage")],
            slots: &[
                ("gradient_method", "gradient_method"),
                ("gradient_storage", "gradient_storage"),
            ],
        }),
        doc: "Gradients of the volume.",
    },
    InputPort {
        name: "transfer_table",
        ty: PortType::Table1d,
        requirement: Requirement::Demanded(Demand {
            kind: "transfer_table",
            inputs: &[("transfer", "transfer")],
            params: &[("table_size", "table_size")],
            slots: &[],
        }),
        doc: "The transfer function as a table.",
    },
    InputPort {
        name: "preintegration_table",
        ty: PortType::Table2d,
        requirement: Requirement::Demanded(Demand {
            kind: "preintegration",
            inputs: &[("transfer", "transfer"), ("volume", "volume")],
            params: &[
                ("step", "step"),
                ("preintegration_size", "preintegration_size"),
            ],
            slots: &[],
        }),
        doc: "The transfer function integrated over segments.",
    },
    InputPort {
        name: "label_texture",
        ty: PortType::LabelTexture,
        requirement: Requirement::Demanded(Demand {
            kind: "label_texture",
            inputs: &[("labels", "labels")],
            params: &[],
            slots: &[],
        }),
        doc: "The labels on the device.",
    },
    InputPort {
        name: "transfer_tables",
        ty: PortType::Table1d,
        requirement: Requirement::Demanded(Demand {
            kind: "transfer_table",
            inputs: &[("transfer", "transfer"), ("segments", "segments")],
            params: &[("table_size", "table_size")],
            slots: &[],
        }),
        doc: "The transfer functions of all labels as rows of a table.",
    },
    InputPort {
        name: "preintegration_tables",
        ty: PortType::Table2d,
        requirement: Requirement::Demanded(Demand {
            kind: "preintegration",
            inputs: &[
                ("transfer", "transfer"),
                ("segments", "segments"),
                ("volume", "volume"),
            ],
            params: &[
                ("step", "step"),
                ("preintegration_size", "preintegration_size"),
            ],
            slots: &[],
        }),
        doc: "The transfer functions of all labels integrated over segments.",
    },
];

const OUTPUTS: &[OutputPort] = &[
    OutputPort {
        name: "color",
        ty: PortType::Color,
        doc: "Linear premultiplied colour, over what lies behind.",
    },
    OutputPort {
        name: "depth",
        ty: PortType::Scalar2d,
        doc: "World distance from the eye to what the ray shows.",
    },
    OutputPort {
        name: "opacity",
        ty: PortType::Scalar2d,
        doc: "Opacity of what the ray met in the volume.",
    },
    OutputPort {
        name: "position",
        ty: PortType::Vector2d,
        doc: "World position of what the ray shows, counted from the middle of all volumes; the fourth is 1 where there is one.",
    },
    OutputPort {
        name: "normal",
        ty: PortType::Vector2d,
        doc: "World normal of what the ray shows, towards the eye; the fourth is 1 where there is one.",
    },
    OutputPort {
        name: "samples",
        ty: PortType::Scalar2d,
        doc: "Samples of the volume that the walk along the ray took.",
    },
    OutputPort {
        name: "label",
        ty: PortType::Scalar2d,
        doc: "Label of what the ray shows.",
    },
];

/// The outputs beside the colour; each is written by a slot of its own, `<name>_layer`.
const LAYERS: [&str; 6] = ["depth", "opacity", "position", "normal", "samples", "label"];

const SLOTS: &[SlotSpec] = &[
    SlotSpec {
        name: "technique",
        default: "dvr",
        doc: "What does a segment add to the pixel?",
    },
    SlotSpec {
        name: "reconstruct",
        default: "trilinear",
        doc: "What is the scalar at a point?",
    },
    SlotSpec {
        name: "gradient",
        default: "stored",
        doc: "What is the gradient at a point?",
    },
    SlotSpec {
        name: "gradient_method",
        default: "central",
        doc: "How are stored gradients made?",
    },
    SlotSpec {
        name: "gradient_storage",
        default: "rgba16f",
        doc: "How are gradients stored?",
    },
    SlotSpec {
        name: "classify",
        default: "post",
        doc: "What are colour and opacity of a segment?",
    },
    SlotSpec {
        name: "traverse",
        default: "uniform",
        doc: "Where does the next segment end?",
    },
    SlotSpec {
        name: "light",
        default: "unlit",
        doc: "How is a point lit?",
    },
    SlotSpec {
        name: "material",
        default: "uniform",
        doc: "What does a point make of light?",
    },
    SlotSpec {
        name: "shadow",
        default: "none",
        doc: "How much of a light reaches a point?",
    },
    SlotSpec {
        name: "environment",
        default: "none",
        doc: "What does a surface mirror?",
    },
    SlotSpec {
        name: "clip",
        default: "none",
        doc: "Which part of the volume is visible?",
    },
    SlotSpec {
        name: "labels",
        default: "none",
        doc: "What is the volume made of?",
    },
];

/// What the depth holds where the ray shows nothing (`RAY_NO_DEPTH` in `lib/ray.wgsl`).
pub const NO_DEPTH: f32 = 3.0e38;

impl NodeKind for Raycast {
    fn name(&self) -> &'static str {
        "raycast"
    }

    fn doc(&self) -> &'static str {
        "Casts a ray through each pixel's part of a volume and adds its segments up."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        let [label_boundary, label_placement] = segmentation::params();
        vec![
            ParamSpec::choice(
                "stage",
                &["auto", "fragment", "compute"],
                "auto",
                "Whether rays run in a fragment or a compute shader; auto measures both once and takes the faster.",
            ),
            volume_texture::storage_param(),
            transfer_table::size_param(),
            preintegration::size_param(),
            label_boundary,
            label_placement,
        ]
    }

    fn slots(&self) -> &[SlotSpec] {
        SLOTS
    }

    fn uniforms(&self) -> &[&'static str] {
        &["volume", "transfer", "tile", "segmentation", "transfers"]
    }

    fn program(&self, node: &NodeContext<'_>) -> Option<ProgramSpec> {
        let mut entries = vec!["raycast_begin"];
        if node.text("stage") != "compute" {
            entries.extend(["raycast_vertex", "raycast_fragment"]);
        }
        if node.text("stage") != "fragment" {
            entries.push("raycast_compute");
        }
        let behind = if node.is_connected("behind") {
            "texture"
        } else {
            "none"
        };
        let tables = if segmentation::has_labels(node) {
            "many"
        } else {
            "one"
        };
        let layers = LAYERS.map(|layer| {
            let choice = if node.is_wanted(layer) {
                "written"
            } else {
                "none"
            };
            (format!("{layer}_layer"), choice.to_owned())
        });
        let mut fixed_slots = BTreeMap::from(layers);
        fixed_slots.extend([
            ("behind".to_owned(), behind.to_owned()),
            (segmentation::TABLES_SLOT.to_owned(), tables.to_owned()),
            placement::filter_slot(node),
        ]);
        Some(ProgramSpec {
            root: "node/raycast.wgsl",
            fixed_slots,
            entries,
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

    fn written(&self, wanted: &BTreeSet<&str>) -> Vec<&'static str> {
        // Every entry point writes the colour.
        OUTPUTS
            .iter()
            .map(|port| port.name)
            .filter(|name| wanted.contains(name) || (*name == "color" && !wanted.is_empty()))
            .collect()
    }

    fn output(&self, port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let format = match port {
            "color" | "position" | "normal" => TextureFormat::Rgba32Float,
            _ => TextureFormat::R32Float,
        };
        check_table_sizes(node)?;
        check_tables_of_labels(node)?;
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::ViewRelative(1.0),
            format,
        })
    }

    fn uniform(&self, name: &str, node: &NodeContext<'_>) -> Result<Uniform, Finding> {
        match name {
            "volume" => placement::uniform(node),
            "transfer" => {
                let transfer = transfer_table::transfer(node, "transfer")?;
                transfer_uniform(node, &transfer, ["transfer_table", "preintegration_table"])
            }
            "transfers" => segmentation::transfers_uniform(node),
            "segmentation" => segmentation::uniform(node),
            _ => Ok(vec![(
                "first",
                UniformValue::UVec2(tile(node)?.map_or([0; 2], |tile| [tile[0], tile[1]])),
            )]),
        }
    }

    fn param_rows<'g>(&self, node: &NodeContext<'g>) -> Vec<&'g ParamRow> {
        segmentation::segments(node)
            .map(SegmentsSource::param_rows)
            .unwrap_or_default()
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        check_segments(node)?;
        if node.is_connected("behind")
            && node.input_resource("behind") != node.output_resource("color")
        {
            return Err(node
                .error(
                    "size-mismatch",
                    "its input `behind` has another size or format than its output",
                )
                .help("make it as large as the picture, in rgba32float"));
        }
        let compute = |entry, [width, height]: [u32; 2]| Pass::Compute {
            entry,
            workgroups: [width.div_ceil(8), height.div_ceil(8), 1],
            constants: Vec::new(),
        };
        let view = node.view().map_or([0; 2], |view| view.size);
        let mut passes = vec![compute("raycast_begin", view)];
        match (node.variant(), tile(node)?) {
            (_, None) => {}
            (Some("compute"), Some([_, _, width, height])) => {
                passes.push(compute("raycast_compute", [width, height]));
            }
            _ => passes.push(Pass::Draw {
                vertex: "raycast_vertex",
                fragment: "raycast_fragment",
                mesh: Mesh {
                    port: "rays",
                    vertices: proxy_box::VERTICES,
                },
                constants: Vec::new(),
            }),
        }
        Ok(passes)
    }
}

/// The pixels that the volume's box may cover: `[x, y, width, height]`; `None` where it is out of view.
fn tile(node: &NodeContext<'_>) -> Result<Option<[u32; 4]>, Finding> {
    let corners = placement::volume(node, "volume")?.grid().corners_world();
    Ok(node.view().and_then(|view| view.pixel_bounds(&corners)))
}

/// The table nodes may be the user's own, with sizes of their own.
fn check_table_sizes(node: &NodeContext<'_>) -> Result<(), Finding> {
    for (port, param) in [
        ("transfer_table", "table_size"),
        ("preintegration_table", "preintegration_size"),
        ("transfer_tables", "table_size"),
        ("preintegration_tables", "preintegration_size"),
    ] {
        if let Some(writer) = node.writer(port)
            && writer.uint(param) < 2
        {
            return Err(node.error(
                "bad-param",
                format!("its input `{port}` comes from a node without `{param}`"),
            ));
        }
    }
    Ok(())
}

/// A table of one transfer function cannot serve labels that have others.
fn check_tables_of_labels(node: &NodeContext<'_>) -> Result<(), Finding> {
    let has_others =
        segmentation::segments(node).is_some_and(|segments| !segments.transfers.is_empty());
    let is_of_one = |port: &&InputPort| match port.requirement {
        Requirement::Demanded(demand) => {
            let is_made_of = |mine: &str| demand.inputs.iter().any(|(_, it)| *it == mine);
            is_made_of("transfer") && !is_made_of("segments") && node.uses_binding(port.name)
        }
        _ => false,
    };
    match INPUTS.iter().find(is_of_one).filter(|_| has_others) {
        None => Ok(()),
        Some(port) => Err(node
            .error(
                "labels-unsupported",
                format!(
                    "labels have transfer functions of their own, but its shader reads `{}`, which is made of one",
                    port.name
                ),
            )
            .help("choose the slot `classify` \"post\" or \"preintegrated_2d\"")),
    }
}

/// Most segments of a ray: software drivers end loops after 65,535 turns, and a GPU would be busy for seconds.
const MAX_SEGMENTS: f64 = 65_535.0;

/// The longest ray must not have more segments than are walked (`RAYCAST_MAX_SEGMENTS` in `node/raycast.wgsl`).
fn check_segments(node: &NodeContext<'_>) -> Result<(), Finding> {
    let grid = placement::volume(node, "volume")?.grid();
    let corners = grid.corners_world();
    let pairs = corners
        .iter()
        .flat_map(|from| corners.iter().map(move |to| from.distance(*to)));
    let longest = pairs.fold(0.0, f64::max);
    // Labels may have steps of their own.
    let rows = Raycast.param_rows(node).into_iter();
    let steps = rows.filter_map(|row| match row.get("step")?.value {
        ParamValue::Float(step) => Some(step),
        #[expect(clippy::cast_precision_loss, reason = "steps are small")]
        ParamValue::Int(step) => Some(step as f64),
        _ => None,
    });
    let step = steps.fold(node.float("step"), f64::min) * grid.min_spacing();
    let segments = (longest / step).ceil();
    if step > 0.0 && segments > MAX_SEGMENTS {
        return Err(node
            .error(
                "too-many-segments",
                format!("its longest ray has {segments} segments, of {MAX_SEGMENTS} at most"),
            )
            .help("choose a longer `step`, or resample the volume to voxels closer to cubes"));
    }
    Ok(())
}

/// The members of the uniform `transfer` (see `lib/transfer_row.wgsl`), for tables at these ports.
pub(crate) fn transfer_uniform(
    node: &NodeContext<'_>,
    transfer: &TransferFunction,
    [table, preintegration_table]: [&str; 2],
) -> Result<Uniform, Finding> {
    let volume = placement::volume(node, "volume")?;
    let (mut low, mut high) = transfer.range();
    if transfer.domain() == Domain::Normalised {
        let (from, to) = placement::normalised_range(volume);
        (low, high) = (from + low * (to - from), from + high * (to - from));
    }
    let voxel = volume.grid().min_spacing();
    let last = |port: &str, param: &str| {
        node.writer(port)
            .map_or(1.0, |writer| f64::from(writer.uint(param).max(2) - 1))
    };
    let entries = last(table, "table_size");
    let preintegration = last(preintegration_table, "preintegration_size");
    let preintegration_step = node
        .writer(preintegration_table)
        .map_or(1.0, |writer| writer.float("step"));
    // Shaders count scalars from the encoding's reference.
    let reference = placement::encoding(node)?.reference;
    let (low, span) = (low - reference, high - low);
    let references_per_world = transfer.reference_length().extinction_per_world(voxel);
    Ok(vec![
        // The first and the last entry stand in the middle of their texels.
        ("entry_scale", f32_value(entries / (span * (entries + 1.0)))),
        (
            "entry_bias",
            f32_value((0.5 - low * entries / span) / (entries + 1.0)),
        ),
        ("low", f32_value(low)),
        (
            "preintegration_per_scalar",
            f32_value(preintegration / span),
        ),
        ("preintegration_last", f32_value(preintegration)),
        (
            "halvings_per_world",
            f32_value(references_per_world * std::f64::consts::LOG2_E),
        ),
        (
            "preintegration_length",
            f32_value(preintegration_step * voxel),
        ),
    ])
}
