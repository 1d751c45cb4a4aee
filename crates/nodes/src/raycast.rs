//! `raycast`: one walk per pixel through the volume's box; slots say what a segment means.

use std::collections::{BTreeMap, BTreeSet};

use volgraph_graph::{
    Demand, Inherited, InputPort, Mesh, NodeContext, NodeKind, OutputPort, ParamRow, Pass,
    PortType, ProgramSpec, Requirement, ResourceDesc, Size, SlotSpec, Uniform,
};
use volgraph_optics::{Domain, TransferFunction};
use volgraph_report::Finding;
use volgraph_shader::{ParamSpec, ParamValue, UniformValue};
use volgraph_volume::Grid;
use wgpu_types::TextureFormat;

use crate::background::Background;
use crate::lit_preintegration::{self, LitPreintegration};
use crate::placement::{self, f32_value};
use crate::source::segments::SegmentsSource;
use crate::{
    clip_volume, light_volume, material_table, preintegration, proxy_box, segmentation,
    transfer_table, volume_texture,
};

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
        name: "image",
        ty: PortType::Image,
        requirement: Requirement::Optional,
        doc: "The image of the pattern that bent rays see; where it is open, that of the background behind.",
    },
    InputPort {
        name: "image_texture",
        ty: PortType::ImageTexture,
        requirement: Requirement::Demanded(Demand {
            kind: "image_texture",
            inputs: &[("image", "image")],
            params: &[],
            slots: &[],
        }),
        doc: "That image on the device.",
    },
    InputPort {
        name: "clip_volume",
        ty: PortType::Volume,
        requirement: Requirement::Optional,
        doc: "Another volume, of any size and placement, whose isosurface cuts: for the clip `volume`.",
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
        name: "clip_volume_texture",
        ty: PortType::VolumeTexture,
        requirement: Requirement::Demanded(Demand {
            kind: "volume_texture",
            inputs: &[("volume", "clip_volume")],
            params: &[("volume_storage", "clip_volume_storage")],
            slots: &[],
        }),
        doc: "The clip volume on the device.",
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
        name: "refraction_table",
        ty: PortType::Table1d,
        requirement: Requirement::Demanded(Demand {
            kind: "refraction_table",
            inputs: &[("transfer", "transfer")],
            params: &[("table_size", "table_size")],
            slots: &[],
        }),
        doc: "The transfer function's refractive index as a table.",
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
    InputPort {
        name: "environment",
        ty: PortType::Image,
        requirement: Requirement::Optional,
        doc: "The image of what surfaces mirror.",
    },
    InputPort {
        name: "environment_texture",
        ty: PortType::ImageTexture,
        requirement: Requirement::Demanded(Demand {
            kind: "image_texture",
            inputs: &[("image", "environment")],
            params: &[],
            slots: &[],
        }),
        doc: "The image of what surfaces mirror, on the device.",
    },
    InputPort {
        name: "light_volume",
        ty: PortType::LightGrid,
        requirement: Requirement::DemandedAlike("light_volume"),
        doc: "How much of each light reaches the points of a grid.",
    },
    InputPort {
        name: "material_table",
        ty: PortType::Table1d,
        requirement: Requirement::Demanded(Demand {
            kind: "material_table",
            inputs: &[("transfer", "transfer")],
            params: material_table::DEMANDED_PARAMS,
            slots: &[],
        }),
        doc: "The transfer function's material as a table.",
    },
    lit_preintegration::port(
        "material_preintegration_table",
        LitPreintegration::Material,
        "The transfer function's material integrated over segments.",
    ),
    lit_preintegration::port(
        "material_moments_table",
        LitPreintegration::MaterialMoments,
        "Where in a segment its material is seen.",
    ),
    lit_preintegration::port(
        "emission_moments_table",
        LitPreintegration::EmissionMoments,
        "Where in a segment its emission is seen.",
    ),
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
        name: "tone",
        default: "window",
        doc: "What does a projected scalar look like?",
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

/// Rays that a technique bends see the pattern of the background behind, with its parameters and its image.
const BEYOND: Inherited = Inherited {
    slot: "pattern",
    port: "behind",
    inputs: &["image"],
};

/// How rays that a technique bends look up what is behind: the pattern of a background in all directions, of another
/// node its picture. Only techniques that bend rays import these slots.
fn beyond_slots(node: &NodeContext<'_>) -> Vec<(String, String)> {
    let slot = |name: &str, choice: &str| (name.to_owned(), choice.to_owned());
    match node.writer("behind") {
        // The pattern is for whoever checks the shaders of `beyond` alone.
        None => vec![slot("beyond", "none"), slot("pattern", "uniform")],
        Some(writer) if writer.kind_name() == Background.name() => vec![
            slot("beyond", "pattern"),
            slot("pattern", writer.text("pattern")),
        ],
        Some(_) => vec![slot("beyond", "picture")],
    }
}

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
            clip_volume::storage_param(),
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
        &[
            "volume",
            "clip_placement",
            "transfer",
            "transfers",
            "lit_tables",
            "segmentation",
            "tile",
            "light_grid",
        ]
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
        let layers = LAYERS.map(|layer| {
            let choice = if node.is_wanted(layer) {
                "written"
            } else {
                "none"
            };
            (format!("{layer}_layer"), choice.to_owned())
        });
        let mut fixed_slots = BTreeMap::from(layers);
        fixed_slots.extend(walk_slots(node));
        fixed_slots.insert("behind".to_owned(), behind.to_owned());
        fixed_slots.extend(beyond_slots(node));
        Some(ProgramSpec {
            root: "node/raycast.wgsl",
            fixed_slots,
            entries,
            inherited: vec![BEYOND],
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
            "clip_placement" => placement::uniform_at(node, "clip_volume"),
            "transfer" => {
                let transfer = transfer_table::transfer(node, "transfer")?;
                transfer_uniform(node, &transfer, ["transfer_table", "preintegration_table"])
            }
            "transfers" => segmentation::transfers_uniform(node),
            "segmentation" => segmentation::uniform(node),
            "light_grid" => {
                light_volume::uniform(node, &node.writer("light_volume").unwrap_or(*node))
            }
            "lit_tables" => lit_preintegration::uniform(node),
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
        check_walk(node)?;
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
        ("refraction_table", "table_size"),
        ("preintegration_table", "preintegration_size"),
        ("material_table", "table_size"),
        ("material_preintegration_table", "preintegration_size"),
        ("material_moments_table", "preintegration_size"),
        ("emission_moments_table", "preintegration_size"),
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
pub(crate) const MAX_SEGMENTS: f64 = 65_535.0;

/// The choices of slots that every walk through the volume needs, that of a light as well.
pub(crate) fn walk_slots(node: &NodeContext<'_>) -> BTreeMap<String, String> {
    let tables = if segmentation::has_labels(node) {
        "many"
    } else {
        "one"
    };
    BTreeMap::from([
        placement::filter_slot(node),
        placement::filter_slot_at(node, "clip_volume"),
        (segmentation::TABLES_SLOT.to_owned(), tables.to_owned()),
    ])
}

/// Whether such a walk comes to its end, and solves the field that it reads.
pub(crate) fn check_walk(node: &NodeContext<'_>) -> Result<(), Finding> {
    check_segments(node)?;
    check_refinement(node)?;
    clip_volume::check_steps(node)
}

/// The longest ray must not have more segments than are walked (`RAYCAST_MAX_SEGMENTS` in `node/raycast.wgsl`).
fn check_segments(node: &NodeContext<'_>) -> Result<(), Finding> {
    let grid = placement::volume(node, "volume")?.grid();
    for param in ["step", "shadow_step"] {
        // Labels may have steps of their own.
        let rows = Raycast.param_rows(node).into_iter();
        let steps = rows.filter_map(|row| match row.get(param)?.value {
            ParamValue::Float(step) => Some(step),
            #[expect(clippy::cast_precision_loss, reason = "steps are small")]
            ParamValue::Int(step) => Some(step as f64),
            _ => None,
        });
        let step = steps.fold(node.float(param), f64::min) * grid.min_spacing();
        let segments = (longest_ray(grid) / step).ceil();
        if step > 0.0 && segments > MAX_SEGMENTS {
            return Err(node
                .error(
                    "too-many-segments",
                    format!("its longest ray has {segments} segments, of {MAX_SEGMENTS} at most"),
                )
                .help(format!(
                    "choose a longer `{param}`, or resample the volume to voxels closer to cubes"
                )));
        }
    }
    Ok(())
}

/// Roots and extremes of cubics are those of the trilinear field, and of no other (`lib/crossing.wgsl`,
/// `lib/extremum.wgsl`).
fn check_refinement(node: &NodeContext<'_>) -> Result<(), Finding> {
    let reconstruct = node.slot("reconstruct");
    for (param, exact, other) in [
        ("refinement", "cubic", "bisection"),
        ("extremum", "field", "samples"),
    ] {
        if node.text(param) == exact && reconstruct != "trilinear" {
            let message = format!(
                "its `{param}` `{exact}` solves the trilinear field, but its slot `reconstruct` is `{reconstruct}`"
            );
            let help = format!("set `{param}` to `{other}`, or `reconstruct` to `trilinear`");
            return Err(node.error("bad-param", message).help(help));
        }
    }
    Ok(())
}
/// Beyond all scalars, in f32.
const NO_SCALAR: f64 = 3.0e38;
/// The longest way through a volume's box, in world units.
pub(crate) fn longest_ray(grid: &Grid) -> f64 {
    let corners = grid.corners_world();
    let pairs = corners
        .iter()
        .flat_map(|from| corners.iter().map(move |to| from.distance(*to)));
    pairs.fold(0.0, f64::max)
}

/// The members of the uniform `transfer` (see `lib/transfer_row.wgsl`), for tables at these ports.
pub(crate) fn transfer_uniform(
    node: &NodeContext<'_>,
    transfer: &TransferFunction,
    [table, preintegration_table]: [&str; 2],
) -> Result<Uniform, Finding> {
    let volume = placement::volume(node, "volume")?;
    let scalar = |at: f64| {
        let (from, to) = placement::normalised_range(volume);
        match transfer.domain() {
            Domain::Normalised => from + at * (to - from),
            Domain::Data => at,
        }
    };
    let voxel = volume.grid().min_spacing();
    let last = |port: &str, param: &str| {
        node.writer(port)
            .map_or(1.0, |writer| f64::from(writer.uint(param).max(2) - 1))
    };
    let entries = last(table, "table_size");
    let refraction = last("refraction_table", "table_size");
    let preintegration = last(preintegration_table, "preintegration_size");
    let preintegration_step = node
        .writer(preintegration_table)
        .map_or(1.0, |writer| writer.float("step"));
    let (low, span) = table_range(node, transfer)?;
    // Shaders count scalars from the encoding's reference.
    let reference = placement::encoding(node)?.reference;
    // Of a transfer function that bends nothing, no scalar is between the two.
    let (first_bent, last_bent) = transfer
        .refraction_span()
        .map_or((NO_SCALAR, -NO_SCALAR), |(first, last)| {
            (scalar(first) - reference, scalar(last) - reference)
        });
    let references_per_world = transfer.reference_length().extinction_per_world(voxel);
    Ok(vec![
        // The first and the last entry stand in the middle of their texels.
        ("entry_scale", f32_value(entries / (span * (entries + 1.0)))),
        (
            "entry_bias",
            f32_value((0.5 - low * entries / span) / (entries + 1.0)),
        ),
        ("low", f32_value(low)),
        ("refraction_per_scalar", f32_value(refraction / span)),
        ("refraction_last", f32_value(refraction)),
        ("refraction_from", f32_value(first_bent)),
        ("refraction_to", f32_value(last_bent)),
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

/// The scalar that tables of the transfer function start at, as shaders count scalars, and how many they span.
pub(crate) fn table_range(
    node: &NodeContext<'_>,
    transfer: &TransferFunction,
) -> Result<(f64, f64), Finding> {
    let (mut low, mut high) = transfer.range();
    if transfer.domain() == Domain::Normalised {
        let (from, to) = placement::normalised_range(placement::volume(node, "volume")?);
        (low, high) = (from + low * (to - from), from + high * (to - from));
    }
    // Shaders count scalars from the encoding's reference.
    let reference = placement::encoding(node)?.reference;
    Ok((low - reference, high - low))
}
