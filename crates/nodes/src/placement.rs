//! The uniform of a volume: where it is, how its texels become scalars.

use std::ops::Range;

use glam::{DAffine3, DMat3, DMat4, DVec3};
use volgraph_graph::{NodeContext, Uniform};
use volgraph_report::Finding;
use volgraph_shader::UniformValue;
use volgraph_volume::{Grid, Volume};

use crate::encoding::{Encoding, Scalars};
use crate::source::bricks::BricksSource;
use crate::source::volume::VolumeSource;

/// What is known of a volume wherever its voxels are, in memory or in bricks that are read when they are needed.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    grid: Grid,
    scalars: Scalars,
    /// Voxels along the edge of its bricks, where it is in bricks.
    pub brick_edge: Option<u32>,
}

impl Placed {
    /// Its voxels' places; of bricks, those of the finest level.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }
}

impl From<Placed> for Scalars {
    fn from(placed: Placed) -> Self {
        placed.scalars
    }
}

impl From<&Placed> for Scalars {
    fn from(placed: &Placed) -> Self {
        placed.scalars
    }
}

/// What is known of the volume at a node's input port, whole or in bricks.
///
/// # Errors
/// `missing-input` where there is none.
pub fn placed(node: &NodeContext<'_>, port: &str) -> Result<Placed, Finding> {
    if let Some(source) = node.source::<BricksSource>(port) {
        return Ok(Placed {
            grid: source.store.levels()[0].grid,
            scalars: source.scalars(),
            brick_edge: Some(source.store.edge()),
        });
    }
    let volume = volume(node, port)?;
    Ok(Placed {
        grid: *volume.grid(),
        scalars: volume.into(),
        brick_edge: None,
    })
}

/// The volume at a node's input port, whole in memory.
///
/// # Errors
/// `missing-input` where there is none; `in-bricks` where it is in bricks.
pub fn volume<'g>(node: &NodeContext<'g>, port: &str) -> Result<&'g Volume, Finding> {
    node.source::<VolumeSource>(port)
        .map(|source| source.volume.as_ref())
        .ok_or_else(|| match node.source::<BricksSource>(port) {
            Some(_) => node
                .error(
                    "in-bricks",
                    format!("its input `{port}` is a volume in bricks, and it reads volumes that are whole in memory"),
                )
                .help("draw it with a `raycast` whose gradients are `central`, without labels, or read one of its coarser levels whole: `volume(path: \"NAME.pyramid.zarr\")`"),
            None => node.error(
                "missing-input",
                format!("its input `{port}` is not a volume"),
            ),
        })
}

/// The numbers of the voxels in some layers along z.
#[must_use]
pub fn voxels_of(volume: &Volume, layers: Range<u32>) -> Range<usize> {
    let [nx, ny, _] = volume.grid().dims.map(|n| n as usize);
    layers.start as usize * nx * ny..layers.end as usize * nx * ny
}

/// How the volume at `volume` is stored by the writer of `volume_texture`.
///
/// # Errors
/// `missing-input` where there is no volume.
pub fn encoding(node: &NodeContext<'_>) -> Result<Encoding, Finding> {
    encoding_at(node, "volume")
}

/// How the volume at the port `<port>` is stored by the writer of `<port>_texture`.
pub(crate) fn encoding_at(node: &NodeContext<'_>, port: &str) -> Result<Encoding, Finding> {
    // Before the demand phase there is no writer yet; it will get this node's own storage parameter.
    let writer = node.writer(&format!("{port}_texture"));
    let pool = || node.writer("brick_pool").filter(|_| port == "volume");
    let storage = writer.or_else(pool).map_or_else(
        || node.text(&format!("{port}_storage")),
        |writer| writer.text("volume_storage"),
    );
    let encoding = Encoding::choose(placed(node, port)?, storage);
    let span = encoding.range.1 - encoding.range.0;
    // Shaders compute in f32, where such values are infinite or 0.
    if span > 1e30 || (span > 0.0 && span < 1e-30) {
        return Err(node
            .error(
                "value-range",
                format!(
                    "the values of its `{port}` span {span:e}, which shaders cannot compute with"
                ),
            )
            .help("convert the volume to values that span between 1e-30 and 1e30"));
    }
    Ok(encoding)
}

/// The slots that decide how texels are read, for programs that import `lib/volume.wgsl`: (slot, choice).
#[must_use]
pub fn texel_slots(node: &NodeContext<'_>) -> [(String, String); 3] {
    let (slot, filter) = filter_slot_at(node, "volume");
    // Pages are looked up for each sample; the way to filter goes with that.
    let (volumes, filter, texel) = match (is_in_bricks(node), filter.as_str()) {
        (true, "loads") => ("paged_loads", "hardware", "load"),
        (true, _) => ("paged", "hardware", "load"),
        (false, filter) if node.limits().shared_samplers => ("one", filter, "nearest"),
        (false, filter) => ("one", filter, "load"),
    };
    [
        (slot, filter.to_owned()),
        ("volume_texel".to_owned(), texel.to_owned()),
        ("volumes".to_owned(), volumes.to_owned()),
    ]
}

/// Whether a node draws a volume in bricks, which a raycast alone can.
#[must_use]
pub fn is_in_bricks(node: &NodeContext<'_>) -> bool {
    node.kind_name() == "raycast" && node.source::<BricksSource>("volume").is_some()
}

/// The slot `<port>_filter`, which decides how texels of the volume at a port are filtered.
#[must_use]
pub fn filter_slot_at(node: &NodeContext<'_>, port: &str) -> (String, String) {
    let choice =
        encoding_at(node, port).map_or("hardware", |encoding| encoding.filter(node.limits()));
    (format!("{port}_filter"), choice.to_owned())
}

/// The members of the uniform `volume` (see `lib/volume.wgsl`), for a node with the inputs `volume` and
/// `volume_texture`.
///
/// # Errors
/// `missing-input` where there is no volume.
pub fn uniform(node: &NodeContext<'_>) -> Result<Uniform, Finding> {
    uniform_at(node, "volume")
}

/// The same members of the volume at the port `<port>`, whose texture is at `<port>_texture`.
///
/// # Errors
/// `missing-input` where there is no volume.
pub fn uniform_at(node: &NodeContext<'_>, port: &str) -> Result<Uniform, Finding> {
    let placed = placed(node, port)?;
    let grid = placed.grid();
    let encoding = encoding_at(node, port)?;
    // Shaders count world positions from the scene's origin.
    let texture_from_world = texture_from_world(grid) * DAffine3::from_translation(node.origin());
    let (low, high) = grid.box_index();
    let dims = dims(grid);
    let centre = grid.world_from_index.transform_point3(0.5 * (low + high));
    let sides = grid.spacing() * (high - low);
    let radius = grid
        .corners_world()
        .iter()
        .map(|corner| corner.distance(centre))
        .fold(0.0, f64::max);
    // Gradients are covectors: they map by the inverse transpose.
    let world_from_index_gradient: DMat3 = grid.world_from_index.matrix3.inverse().transpose();
    let span = encoding.range.1 - encoding.range.0;
    let normalised = normalised_range(placed);
    Ok(vec![
        (
            "texture_from_world",
            UniformValue::Mat4(columns(DMat4::from(texture_from_world))),
        ),
        (
            "world_from_index_gradient",
            UniformValue::Mat3(world_from_index_gradient.as_mat3().to_cols_array_2d()),
        ),
        ("dims", vec3(dims)),
        ("box_low", vec3((low + 0.5) / dims)),
        ("box_high", vec3((high + 0.5) / dims)),
        ("centre", vec3(centre - node.origin())),
        ("world_origin", vec3(-node.origin())),
        ("half_side", f32_value(0.5 * sides.min_element())),
        ("radius", f32_value(radius)),
        ("voxel", f32_value(grid.min_spacing())),
        ("value_scale", f32_value(encoding.scale)),
        ("value_offset", f32_value(encoding.offset)),
        ("value_reference", f32_value(encoding.reference)),
        (
            "value_low",
            f32_value(encoding.range.0 - encoding.reference),
        ),
        (
            "value_range",
            f32_value(if span > 0.0 { span } else { 1.0 }),
        ),
        (
            "normalised_low",
            f32_value(normalised.0 - encoding.reference),
        ),
        ("normalised_span", f32_value(normalised.1 - normalised.0)),
    ])
}

/// What 0 and 1 of a normalised scalar stand for: the stored type's range, for floats the data's.
#[must_use]
pub fn normalised_range(scalars: impl Into<Scalars>) -> (f64, f64) {
    let scalars = scalars.into();
    match scalars.ty.range() {
        Some(range) => range,
        None => data_range(scalars),
    }
}

/// The smallest and largest value that the volume has; one apart where there is one alone, or what tells two numbers
/// as large apart.
#[must_use]
pub fn data_range(scalars: impl Into<Scalars>) -> (f64, f64) {
    let (low, high) = scalars.into().range.unwrap_or((0.0, 1.0));
    if high > low {
        (low, high)
    } else {
        (low, low + (1e-9 * low.abs()).max(1.0))
    }
}

/// Texture coordinates (0..1 over whole voxels) from world positions.
pub(crate) fn texture_from_world(grid: &Grid) -> DAffine3 {
    let texture_from_index =
        DAffine3::from_scale(1.0 / dims(grid)) * DAffine3::from_translation(DVec3::splat(0.5));
    texture_from_index * grid.world_from_index.inverse()
}

/// Index coordinates of another grid, laid over a grid's box axis by axis, from world positions.
pub(crate) fn over_box(grid: &Grid, other: &Grid) -> DAffine3 {
    let (box_low, box_high) = grid.box_index();
    let (low, high) = other.box_index();
    DAffine3::from_translation(low)
        * DAffine3::from_scale((high - low) / (box_high - box_low))
        * DAffine3::from_translation(-box_low)
        * grid.world_from_index.inverse()
}

fn dims(grid: &Grid) -> DVec3 {
    DVec3::from_array(grid.dims.map(f64::from))
}

pub(crate) fn columns(matrix: DMat4) -> [[f32; 4]; 4] {
    matrix.as_mat4().to_cols_array_2d()
}

pub(crate) fn vec3(v: DVec3) -> UniformValue {
    UniformValue::Vec3(v.as_vec3().to_array())
}

#[expect(clippy::cast_possible_truncation, reason = "shaders compute in f32")]
pub(crate) fn f32_value(value: f64) -> UniformValue {
    UniformValue::F32(value as f32)
}
