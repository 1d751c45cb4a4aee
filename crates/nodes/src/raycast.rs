//! `raycast`: one walk per pixel through the volume's box; slots say what a segment means.

mod heed;
mod ports;
mod slots;
mod tables;
mod walk;

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use volgraph_graph::{
    DerivedSlot, Geometry, Inherited, InputPort, Mesh, NodeContext, NodeKind, OutputPort, ParamRow,
    Pass, ProgramSpec, ResourceDesc, Size, SlotSpec, Uniform,
};
use volgraph_report::Finding;
use volgraph_shader::{ParamSpec, ParamValue, UniformValue};
use volgraph_volume::Grid;
use wgpu_types::TextureFormat;

pub(crate) use self::heed::{is_of_own_transfer, tables_are_own};
use self::ports::{INPUTS, LAYERS, OUTPUTS, TRACE_SIZE};
use self::slots::SLOTS;
pub use self::tables::data_value;
pub(crate) use self::tables::{TablePorts, check_lookup, table_range, transfer_uniform};
use self::tables::{check_table_sizes, check_tables_of_labels};
pub use self::walk::shortest_step;
pub(crate) use self::walk::{MAX_SEGMENTS, check_walk, longest_ray, walk_slots};

use crate::background::Background;
use crate::placement::{f32_value, vec3};
use crate::source::segments::SegmentsSource;
use crate::{
    brick_pool, brick_proxy, brick_ranges, clip_volume, distance_map, light_volume,
    lit_preintegration, placement, preintegration, preintegration_3d, proxy_box, segmentation,
    stride_map, transfer_table, volume_texture,
};

/// The node kind `raycast`.
pub struct Raycast;

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

/// What a technique does not see, which segments it looks into, and how it is walked with, its file says.
const DERIVED: &[DerivedSlot] = &[
    DerivedSlot {
        slot: "emptiness",
        from: "technique",
        tag: "skips",
    },
    DerivedSlot {
        slot: "heed",
        from: "technique",
        tag: "heeds",
    },
    DerivedSlot {
        slot: "walk",
        from: "technique",
        tag: "walks",
    },
];

/// How the walk leaps over what the technique does not see: the choices of its slots `leap` and `look`.
pub(crate) fn leaps(node: &NodeContext<'_>) -> [(String, String); 2] {
    let (leap, look) = match looks_at(node) {
        Some(look) => ("bricks", look),
        // The look is for whoever checks the shaders of `leap` alone.
        None => ("none", "distance_map".to_owned()),
    };
    [
        ("leap".to_owned(), leap.to_owned()),
        ("look".to_owned(), look),
    ]
}

/// What the walk looks at to leap, the choice of the slot `look`; none where it takes every step.
pub(crate) fn looks_at(node: &NodeContext<'_>) -> Option<String> {
    // Leaps count in whole steps: walks of a user's own may end their segments anywhere.
    if placement::is_in_bricks(node) {
        let takes_whole_steps = ["uniform", "skip", "adaptive"].contains(&node.slot("traverse"));
        return takes_whole_steps.then(|| "pages".to_owned());
    }
    let emptiness = node.slot("emptiness");
    let has_labels = !Raycast.param_rows(node).is_empty();
    let reads_params = ["isovalue", "isovalue_transfer", "isosurfaces"].contains(&emptiness);
    if !["skip", "adaptive"].contains(&node.slot("traverse"))
        || emptiness == "none"
        || brick_ranges::margin(node.slot("reconstruct")).is_none()
        // Labels may have isosurfaces of their own.
        || (reads_params && has_labels)
    {
        return None;
    }
    let look = match emptiness {
        "maximum" | "minimum" => emptiness,
        // Labels may have steps of their own, and transfer functions, of which there is one here; the nearest voxel's scalar has no
        // derivatives.
        "transfer"
            if node.slot("traverse") == "adaptive"
                && !has_labels
                && transfer_table::transfers(node).is_ok_and(|them| them.len() == 1)
                && node.slot("reconstruct") != "nearest" =>
        {
            "stride_map"
        }
        "transfer" if distance_map::absorbs_everywhere(node) => return None,
        _ => "distance_map",
    };
    Some(look.to_owned())
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
                "Whether rays run in a fragment or a compute shader; auto takes compute where a scout has found what is seen, and otherwise measures both once and takes the faster.",
            ),
            volume_texture::storage_param(),
            brick_ranges::size_param(),
            stride_map::tolerance_param(),
            clip_volume::storage_param(),
            transfer_table::size_param(),
            preintegration::size_param(),
            preintegration::built_on_param(),
            label_boundary,
            label_placement,
        ]
        .into_iter()
        .chain(preintegration_3d::params())
        .collect()
    }

    fn slots(&self) -> &[SlotSpec] {
        SLOTS
    }

    fn derived_slots(&self) -> &[DerivedSlot] {
        DERIVED
    }

    fn default_of(&self, param: &str, node: &NodeContext<'_>) -> Option<ParamValue> {
        walk::default_of(param, node)
    }

    fn default_slot(&self, slot: &str, node: &NodeContext<'_>) -> Option<&'static str> {
        (slot == "gradient_storage" && walk::gains_beside_gradients(node)).then_some("rgba32f")
    }

    fn uniforms(&self) -> &[&'static str] {
        &[
            "volume",
            "bricks",
            "pages",
            "steepness",
            "clip_placement",
            "transfer",
            "transfers",
            "lit_tables",
            "preintegration_3d",
            "segmentation",
            "tile",
            "light_grid",
            "absorbing_few",
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
        let leaps = leaps(node);
        let walk = walk::walk(node, &leaps[1].1);
        fixed_slots.extend(leaps);
        let mut pixels = "box";
        if walk::goes_by_spans(node, &walk, &fixed_slots) {
            fixed_slots.insert("leap".to_owned(), "spans".to_owned());
            // Spans of the user's own come without blocks, or with those of another scout.
            let is_by_hand = ["spans", "active_blocks"].map(|port| node.is_connected(port));
            if is_by_hand == [false; 2] {
                pixels = "active_blocks";
            }
        }
        fixed_slots.insert("pixels".to_owned(), pixels.to_owned());
        let heed = heed::heed(node, &walk, looks_at(node).is_some());
        fixed_slots.insert("heed".to_owned(), heed);
        if walk::reads_beside_gradients(node, &walk) {
            fixed_slots.insert("volumes".to_owned(), "beside_gradients".to_owned());
        }
        let steps = walk::steps(node, &walk);
        fixed_slots.insert("steps".to_owned(), steps.to_owned());
        fixed_slots.insert("walk".to_owned(), walk);
        fixed_slots.insert("behind".to_owned(), behind.to_owned());
        fixed_slots.extend(beyond_slots(node));
        Some(ProgramSpec {
            root: "node/raycast.wgsl",
            fixed_slots,
            entries,
            inherited: vec![BEYOND],
        })
    }

    fn draws_windows(&self, node: &NodeContext<'_>) -> bool {
        // A bent ray may see any part of the picture behind.
        let is_picture = ("beyond".to_owned(), "picture".to_owned());
        !(node.imports_slot("beyond") && beyond_slots(node).contains(&is_picture))
    }

    fn passes_follow_camera(&self) -> bool {
        true
    }

    fn variants(&self, node: &NodeContext<'_>) -> Vec<&'static str> {
        match node.text("stage") {
            "fragment" => vec!["fragment"],
            "compute" => vec!["compute"],
            // Blocks without a span cost a dispatch nothing, and a draw as much as their walks do at least.
            _ if node.is_connected("active_blocks") => vec!["compute"],
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
            "color" | "position" | "normal" | "trace" => TextureFormat::Rgba32Float,
            _ => TextureFormat::R32Float,
        };
        let [width, height] = TRACE_SIZE;
        let size = match port {
            "trace" => Size::Absolute([width, height, 1]),
            _ => Size::ViewRelative(1.0),
        };
        check_table_sizes(node)?;
        check_tables_of_labels(node)?;
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size,
            format,
        })
    }

    fn uniform(&self, name: &str, node: &NodeContext<'_>) -> Result<Uniform, Finding> {
        match name {
            "volume" => placement::uniform(node),
            "bricks" => brick_ranges::uniform(node),
            "pages" => brick_pool::uniform(node),
            "steepness" => walk::steepness_uniform(node),
            "clip_placement" => placement::uniform_at(node, "clip_volume"),
            "transfer" => {
                let transfer = transfer_table::transfer(node, "transfer")?;
                transfer_uniform(node, &transfer, &TablePorts::ONE)
            }
            "transfers" => segmentation::transfers_uniform(node),
            "segmentation" => segmentation::uniform(node),
            "light_grid" => {
                light_volume::uniform(node, &node.writer("light_volume").unwrap_or(*node))
            }
            "lit_tables" => lit_preintegration::uniform(node),
            "preintegration_3d" => preintegration_3d::uniform(node),
            "absorbing_few" => heed::absorbing_few(node),
            _ => tile_uniform(node),
        }
    }

    fn param_rows<'g>(&self, node: &NodeContext<'g>) -> Vec<&'g ParamRow> {
        segmentation::segments(node)
            .map(SegmentsSource::param_rows)
            .unwrap_or_default()
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        check_walk(node)?;
        walk::check_pairs(node)?;
        brick_proxy::check(node)?;
        brick_pool::check(node)?;
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
            (Some("compute"), _) if node.is_connected("active_blocks") => {
                passes.push(Pass::ComputeIndirect {
                    entry: "raycast_compute",
                    workgroups: "active_blocks",
                    constants: Vec::new(),
                });
            }
            (Some("compute"), Some([_, _, width, height])) => {
                passes.push(compute("raycast_compute", [width, height]));
            }
            _ => passes.push(Pass::Draw {
                vertex: "raycast_vertex",
                fragment: "raycast_fragment",
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

/// The pixels that a node's proxy geometry may cover: `[x, y, width, height]`; `None` where it is out of view.
pub(crate) fn tile(node: &NodeContext<'_>) -> Result<Option<[u32; 4]>, Finding> {
    let placed = placement::placed(node, "volume")?;
    let grid = placed.grid();
    let corners = brick_proxy::covered(node)?.map(|[low, high]| corners_world(grid, low, high));
    Ok(corners.and_then(|corners| node.view()?.pixel_bounds(&corners)))
}

/// The same of the whole box of a grid.
pub(crate) fn tile_of(node: &NodeContext<'_>, grid: &Grid) -> Option<[u32; 4]> {
    node.view()?.pixel_bounds(&grid.corners_world())
}
/// The corners of a part of a grid, which is between two points in index coordinates.
fn corners_world(grid: &Grid, low: DVec3, high: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|corner| {
        let is_high = [corner & 1 != 0, corner & 2 != 0, corner & 4 != 0];
        let index = DVec3::from_array(std::array::from_fn(|axis| {
            if is_high[axis] { high[axis] } else { low[axis] }
        }));
        grid.world_from_index.transform_point3(index)
    })
}

/// The members of the uniform `tile` (see `lib/proxy.wgsl`).
///
/// # Errors
/// `missing-input`.
pub(crate) fn tile_uniform(node: &NodeContext<'_>) -> Result<Uniform, Finding> {
    let placed = placement::placed(node, "volume")?;
    let grid = placed.grid();
    let [low, high] = brick_proxy::covered(node)?.unwrap_or_default();
    let first = tile(node)?;
    Ok(tile_members(node, grid, [low, high], first))
}

/// The same for the part of a grid between two points in index coordinates, whose first pixel is that of `tile`.
pub(crate) fn tile_members(
    node: &NodeContext<'_>,
    grid: &Grid,
    [low, high]: [DVec3; 2],
    tile: Option<[u32; 4]>,
) -> Uniform {
    let middle = grid.world_from_index.transform_point3(0.5 * (low + high));
    let corners = corners_world(grid, low, high).into_iter();
    let radius = corners
        .map(|corner| corner.distance(middle))
        .fold(0.0, f64::max);
    let half_side = 0.5 * (grid.spacing() * (high - low)).min_element();
    let first = tile.map_or([0; 2], |tile| [tile[0], tile[1]]);
    vec![
        ("first", UniformValue::UVec2(first)),
        ("centre", vec3(middle - node.origin())),
        ("half_side", f32_value(half_side)),
        ("radius", f32_value(radius)),
    ]
}
