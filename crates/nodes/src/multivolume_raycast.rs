//! `multivolume_raycast`: two to four volumes in one walk per pixel, each with a placement and a transfer function.
//!
//! The shader selects one volume at a time: what reads `volume` and `transfer` in the libraries and slots of `raycast`
//! then reads the selected one's. So classification, gradients and light are those of `raycast`; what walks through a
//! volume of its own (clips, shadows, skipping) is not to be had here.

use std::collections::{BTreeMap, BTreeSet};

use volgraph_graph::{
    Demand, Geometry, InputPort, Mesh, NodeContext, NodeKind, OutputPort, ParamRow, Pass, PortType,
    ProgramSpec, Requirement, ResourceDesc, Size, SlotSpec, Uniform,
};
use volgraph_report::Finding;
use volgraph_shader::{ParamSpec, UniformValue};
use wgpu_types::TextureFormat;

use crate::proxy_box::{self, VOLUMES, enclosing};
use crate::raycast::{
    MAX_SEGMENTS, TablePorts, check_lookup, longest_ray, tile_members, tile_of, transfer_uniform,
};
use crate::transfer_table::transfer;
use crate::{brick_proxy, light_volume, placement, preintegration, transfer_table, volume_texture};

/// The node kind `multivolume_raycast`.
pub struct MultivolumeRaycast;

/// How each volume's scalars hold between voxels.
const INTERPOLATION: [&str; 4] = [
    "interpolation",
    "interpolation_2",
    "interpolation_3",
    "interpolation_4",
];

const TRANSFERS: [&str; 4] = ["transfer", "transfer_2", "transfer_3", "transfer_4"];

macro_rules! tables {
    ($volume:literal $tail:literal) => {
        TablePorts {
            volume: $volume,
            transfer: concat!("transfer", $tail, "_table"),
            preintegration: concat!("preintegration", $tail, "_table"),
            half: concat!("preintegration_half", $tail, "_table"),
            integral: concat!("integral", $tail, "_table"),
        }
    };
}

const TABLES: [TablePorts; 4] = [
    TablePorts::ONE,
    tables!("volume_2" "_2"),
    tables!("volume_3" "_3"),
    tables!("volume_4" "_4"),
];

const fn table(name: &'static str, ty: PortType, demand: Demand) -> InputPort {
    InputPort {
        name,
        ty,
        requirement: Requirement::Demanded(demand),
        doc: "A table of its transfer function.",
    }
}

macro_rules! inputs {
    ($($requirement:ident $volume:literal $transfer:literal $storage:literal $tail:literal,)*) => {
        &[
            InputPort {
                name: "rays",
                ty: PortType::Mesh,
                requirement: Requirement::Required,
                doc: "The proxy geometry that starts the rays: a box around all volumes.",
            },
            InputPort {
                name: "behind",
                ty: PortType::Color,
                requirement: Requirement::Optional,
                doc: "What lies behind the volumes; nothing where it is open.",
            },
            $(
                InputPort {
                    name: $volume,
                    ty: PortType::Volume,
                    requirement: Requirement::$requirement,
                    doc: "A volume.",
                },
                InputPort {
                    name: $transfer,
                    ty: PortType::Transfer,
                    requirement: Requirement::$requirement,
                    doc: "Its transfer function.",
                },
                InputPort {
                    name: concat!($volume, "_texture"),
                    ty: PortType::VolumeTexture,
                    requirement: Requirement::Demanded(Demand {
                        kind: "volume_texture",
                        inputs: &[("volume", $volume)],
                        params: &[("volume_storage", $storage)],
                        slots: &[],
                    }),
                    doc: "The volume on the device.",
                },
                table(concat!("transfer", $tail, "_table"), PortType::Table1d, Demand {
                    kind: "transfer_table",
                    inputs: &[("transfer", $transfer)],
                    params: &[("table_size", "table_size")],
                    slots: &[],
                }),
                table(concat!("preintegration", $tail, "_table"), PortType::Table2d, Demand {
                    kind: "preintegration",
                    inputs: &[("transfer", $transfer), ("volume", $volume)],
                    params: preintegration::DEMANDED_PARAMS,
                    slots: &[],
                }),
                table(concat!("preintegration_half", $tail, "_table"), PortType::Table2d, Demand {
                    kind: "preintegration_half",
                    inputs: &[("transfer", $transfer), ("volume", $volume)],
                    params: preintegration::DEMANDED_PARAMS_OF_HALVES,
                    slots: &[],
                }),
                table(concat!("integral", $tail, "_table"), PortType::Table1d, Demand {
                    kind: "integral_table",
                    inputs: &[("transfer", $transfer)],
                    params: &[("table_size", "table_size")],
                    slots: &[],
                }),
            )*
        ]
    };
}

const INPUTS: &[InputPort] = inputs![
    Required "volume" "transfer" "volume_storage" "",
    Required "volume_2" "transfer_2" "volume_2_storage" "_2",
    Optional "volume_3" "transfer_3" "volume_3_storage" "_3",
    Optional "volume_4" "transfer_4" "volume_4_storage" "_4",
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
        doc: "World distance from the eye to where half of the light is gone.",
    },
    OutputPort {
        name: "opacity",
        ty: PortType::Scalar2d,
        doc: "Opacity of what the ray met in the volumes.",
    },
    OutputPort {
        name: "samples",
        ty: PortType::Scalar2d,
        doc: "Samples of all volumes that the walk along the ray took.",
    },
];

const LAYERS: [&str; 3] = ["depth", "opacity", "samples"];

const SLOTS: &[SlotSpec] = &[
    SlotSpec {
        name: "reconstruct",
        default: "trilinear",
        doc: "What is the scalar at a point?",
    },
    SlotSpec {
        name: "gradient",
        default: "central",
        doc: "What is the gradient at a point?",
    },
    SlotSpec {
        name: "classify",
        default: "preintegrated_2d",
        doc: "What are colour and opacity of a segment?",
    },
    SlotSpec {
        name: "light",
        default: "unlit",
        doc: "How is a point lit?",
    },
];

/// The number of volumes that are connected; those before the last must be.
fn count(node: &NodeContext<'_>) -> usize {
    let volumes = VOLUMES.iter();
    volumes.take_while(|port| node.is_connected(port)).count()
}

impl NodeKind for MultivolumeRaycast {
    fn name(&self) -> &'static str {
        "multivolume_raycast"
    }

    fn doc(&self) -> &'static str {
        "Casts a ray through two to four volumes at once, each with its transfer function."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        let storage = |name: &str| ParamSpec {
            name: name.to_owned(),
            ..volume_texture::storage_param()
        };
        let interpolation = |name: &str| {
            ParamSpec::choice(
                name,
                &["field", "nearest"],
                "field",
                "How scalars hold between voxels: as the slot `reconstruct` says, or of the nearest voxel, for labels.",
            )
        };
        let mut params = vec![
            ParamSpec::choice(
                "stage",
                &["auto", "fragment", "compute"],
                "auto",
                "Whether rays run in a fragment or a compute shader; auto measures both once and takes the faster.",
            ),
            transfer_table::size_param(),
            preintegration::size_param(),
            preintegration::built_on_param(),
        ];
        params.extend(VOLUMES.map(|volume| storage(&format!("{volume}_storage"))));
        params.extend(INTERPOLATION.map(interpolation));
        params
    }

    fn slots(&self) -> &[SlotSpec] {
        SLOTS
    }

    fn uniforms(&self) -> &[&'static str] {
        &["volumes", "volume_transfers", "tile"]
    }

    fn program(&self, node: &NodeContext<'_>) -> Option<ProgramSpec> {
        let mut entries = vec!["multivolume_begin"];
        if node.text("stage") != "compute" {
            entries.extend(["multivolume_vertex", "multivolume_fragment"]);
        }
        if node.text("stage") != "fragment" {
            entries.push("multivolume_compute");
        }
        let volumes = match count(node) {
            4 => "four",
            3 => "three",
            _ => "two",
        };
        let needs_loads = VOLUMES
            .iter()
            .any(|port| placement::filter_slot_at(node, port).1 == "loads");
        let filter = if needs_loads { "loads" } else { "hardware" };
        let table_filter = if node.limits().float32_filterable {
            "hardware"
        } else {
            "loads"
        };
        let behind = if node.is_connected("behind") {
            "texture"
        } else {
            "none"
        };
        let mut fixed_slots: BTreeMap<String, String> = [
            ("volumes", volumes),
            ("volume_filter", filter),
            ("volume_texel", "load"),
            ("transfer_tables", volumes),
            ("table_filter", table_filter),
            ("transfer_reach", "beyond"),
            ("steps", "computed"),
            ("behind", behind),
            // What walks of their own would need, which there are none of.
            ("clip", "none"),
            ("parts", "one"),
            ("clip_volume_filter", "hardware"),
            ("gradient_method", "central"),
            ("gradient_storage", "rgba16f"),
            ("labels", "none"),
            ("shadow", "none"),
            ("shadow_leap", "none"),
            ("environment", "none"),
            ("material", "uniform"),
        ]
        .map(|(slot, choice)| (slot.to_owned(), choice.to_owned()))
        .into();
        fixed_slots.extend([light_volume::places_slot(node)]);
        fixed_slots.extend(LAYERS.map(|layer| {
            let choice = if node.is_wanted(layer) {
                "written"
            } else {
                "none"
            };
            (format!("{layer}_layer"), choice.to_owned())
        }));
        Some(ProgramSpec {
            root: "node/multivolume_raycast.wgsl",
            fixed_slots,
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

    fn written(&self, wanted: &BTreeSet<&str>) -> Vec<&'static str> {
        // Every entry point writes the colour.
        OUTPUTS
            .iter()
            .map(|port| port.name)
            .filter(|name| wanted.contains(name) || (*name == "color" && !wanted.is_empty()))
            .collect()
    }

    fn output(&self, port: &str, _node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::ViewRelative(1.0),
            format: match port {
                "color" => TextureFormat::Rgba32Float,
                _ => TextureFormat::R32Float,
            },
        })
    }

    fn uniform(&self, name: &str, node: &NodeContext<'_>) -> Result<Uniform, Finding> {
        if name == "tile" {
            let grid = enclosing(node)?;
            let (low, high) = grid.box_index();
            return Ok(tile_members(node, &grid, [low, high], tile_of(node, &grid)));
        }
        let owned = |members: Uniform| {
            let members = members.into_iter();
            UniformValue::Struct(
                members
                    .map(|(name, value)| (name.to_owned(), value))
                    .collect(),
            )
        };
        let mut rows = Vec::with_capacity(VOLUMES.len());
        for at in 0..count(node) {
            let row = if name == "volumes" {
                let is_nearest = node.text(INTERPOLATION[at]) == "nearest";
                vec![
                    (
                        "placement".to_owned(),
                        owned(placement::uniform_at(node, VOLUMES[at])?),
                    ),
                    (
                        "is_nearest".to_owned(),
                        UniformValue::U32(u32::from(is_nearest)),
                    ),
                ]
            } else {
                let function = transfer(node, TRANSFERS[at])?;
                vec![(
                    "transfer".to_owned(),
                    owned(transfer_uniform(node, &function, &TABLES[at])?),
                )]
            };
            rows.push(UniformValue::Struct(row));
        }
        // Rows of no volume are never read.
        if let Some(first) = rows.first().cloned() {
            rows.resize(VOLUMES.len(), first);
        }
        Ok(vec![("rows", UniformValue::Array(rows))])
    }

    fn param_rows<'g>(&self, _node: &NodeContext<'g>) -> Vec<&'g ParamRow> {
        Vec::new()
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        check(node)?;
        let compute = |entry, [width, height]: [u32; 2]| Pass::Compute {
            entry,
            workgroups: [width.div_ceil(8), height.div_ceil(8), 1],
            constants: Vec::new(),
        };
        let view = node.view().map_or([0; 2], |view| view.size);
        let mut passes = vec![compute("multivolume_begin", view)];
        match (node.variant(), tile_of(node, &enclosing(node)?)) {
            (_, None) => {}
            (Some("compute"), Some([_, _, width, height])) => {
                passes.push(compute("multivolume_compute", [width, height]));
            }
            _ => passes.push(Pass::Draw {
                vertex: "multivolume_vertex",
                fragment: "multivolume_fragment",
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

/// Whether what is connected goes together, and the walk comes to its end.
fn check(node: &NodeContext<'_>) -> Result<(), Finding> {
    let count = count(node);
    for (at, (volume, function)) in VOLUMES.iter().zip(TRANSFERS).enumerate() {
        let (has_volume, has_function) = (node.is_connected(volume), node.is_connected(function));
        if has_volume != has_function || (has_volume && at >= count) {
            let message = format!("its inputs `{volume}` and `{function}` do not go together");
            return Err(node.error("missing-input", message).help(
                "connect a volume and its transfer function, and `volume_3` before `volume_4`",
            ));
        }
    }
    check_lookup(node)?;
    brick_proxy::check_whole(node)?;
    check_rays(node)?;
    let reconstruct = node.slot("reconstruct");
    let has_nearest = INTERPOLATION[..count]
        .iter()
        .any(|param| node.text(param) == "nearest");
    if has_nearest && !["trilinear", "nearest"].contains(&reconstruct) {
        let message = format!(
            "a volume's scalars hold for whole voxels, and its slot `reconstruct` is `{reconstruct}`"
        );
        return Err(node
            .error("bad-param", message)
            .help("choose `trilinear` for `reconstruct`"));
    }
    if node.is_connected("behind") && node.input_resource("behind") != node.output_resource("color")
    {
        return Err(node
            .error(
                "size-mismatch",
                "its input `behind` has another size or format than its output",
            )
            .help("make it as large as the picture, in rgba32float"));
    }
    let mut segments = 0.0;
    let mut finest = f64::INFINITY;
    for at in 0..count {
        let grid = placement::volume(node, VOLUMES[at])?.grid();
        finest = finest.min(grid.min_spacing());
        if node.text(INTERPOLATION[at]) == "nearest" {
            segments += grid.dims.iter().map(|n| f64::from(*n)).sum::<f64>();
        }
    }
    let longest = longest_ray(&enclosing(node)?);
    segments += (longest / (node.float("step") * finest)).ceil();
    if segments > MAX_SEGMENTS {
        return Err(node
            .error(
                "too-many-segments",
                format!("its longest ray has {segments} segments, of {MAX_SEGMENTS} at most"),
            )
            .help("choose a longer `step`, or resample the finest volume"));
    }
    Ok(())
}

/// Whether the proxy geometry is a box around all volumes.
fn check_rays(node: &NodeContext<'_>) -> Result<(), Finding> {
    let Some(writer) = node.writer("rays") else {
        return Ok(());
    };
    let all = VOLUMES.iter().all(|port| {
        let (own, its) = (node.shared_source(port), writer.shared_source(port));
        match (own, its) {
            (Some(own), Some(its)) => std::sync::Arc::ptr_eq(&own, &its),
            (own, its) => own.is_none() && its.is_none(),
        }
    });
    if all {
        return Ok(());
    }
    let message = format!(
        "its rays start from `{}`, which does not have the same volumes as it",
        writer.name()
    );
    Err(node
        .error("not-covered", message)
        .help("connect `volume`, `volume_2` and so on of both alike"))
}
