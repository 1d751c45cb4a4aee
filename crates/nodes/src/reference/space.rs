//! Where users' positions count from, and the clips that they make.

use glam::DVec3;
use volgraph_reference::{Clip, Field, Shape};
use volgraph_report::Finding;
use volgraph_volume::Grid;

use super::covered::{choice_of, refusal};
use super::looks::scalar;
use super::values::Values;
use crate::placement;

/// Planes there are.
const MAX_PLANES: usize = 8;

/// As `lib/space.wgsl` has it.
pub(super) struct Space {
    centre: DVec3,
    unit: f64,
}

impl Space {
    pub(super) fn new(values: &Values<'_>) -> Result<Self, Finding> {
        let grid = placement::volume(&values.node, "volume")?.grid();
        if values.text("space") == "world" {
            return Ok(Self {
                centre: DVec3::ZERO,
                unit: 1.0,
            });
        }
        let (low, high) = grid.box_index();
        Ok(Self {
            centre: grid.world_from_index.transform_point3(0.5 * (low + high)),
            unit: half_side(grid),
        })
    }

    pub(super) fn point(&self, given: DVec3) -> DVec3 {
        self.centre + self.unit * given
    }
}

/// Half of the smallest side of a volume's box, in world units.
pub(super) fn half_side(grid: &Grid) -> f64 {
    let (low, high) = grid.box_index();
    0.5 * (grid.spacing() * (high - low)).min_element()
}

/// What a node clips away. The method `naive` is a way to do it wrong: its truth is the accurate cut.
pub(super) fn clip(values: &Values<'_>) -> Result<Option<Clip>, Finding> {
    let node = &values.node;
    let shape = match choice_of(node, "clip") {
        "none" | "" => return Ok(None),
        "planes" => planes(values)?,
        "box" => box_planes(values)?,
        "sphere" => {
            let space = Space::new(values)?;
            Shape::Sphere {
                centre: space.point(DVec3::from_array(values.vector("clip_centre"))),
                radius: space.unit * values.float("clip_radius"),
            }
        }
        "volume" => clip_volume(values)?,
        other => {
            return Err(refusal(node, &format!("the clip `{other}`")));
        }
    };
    Ok(Some(Clip {
        shape,
        keeps_outside: values.text("clip_keep") == "outside",
    }))
}

fn planes(values: &Values<'_>) -> Result<Shape, Finding> {
    let space = Space::new(values)?;
    let count = values.uint("planes").min(MAX_PLANES);
    let planes = (1..=count).filter_map(|number| {
        let [x, y, z, along] = values.vector(&format!("plane_{number}"));
        let normal = DVec3::new(x, y, z).try_normalize()?;
        Some((normal, normal.dot(space.point(along * normal))))
    });
    Ok(Shape::Planes(planes.collect()))
}

/// The six faces of a box along the volume's own axes.
fn box_planes(values: &Values<'_>) -> Result<Shape, Finding> {
    let grid = placement::volume(&values.node, "volume")?.grid();
    let (low, high) = grid.box_index();
    let corner = |name: &str| low + DVec3::from_array(values.vector(name)) * (high - low);
    let (a, b) = (corner("clip_low"), corner("clip_high"));
    let index_from_world = grid.world_from_index.inverse();
    let mut planes = Vec::new();
    for axis in 0..3 {
        // The index along the axis is `normal · position + offset`.
        let normal = index_from_world.matrix3.row(axis);
        let offset = index_from_world.translation[axis];
        planes.push((normal, a[axis].min(b[axis]) - offset));
        planes.push((-normal, offset - a[axis].max(b[axis])));
    }
    Ok(Shape::Planes(planes))
}

fn clip_volume(values: &Values<'_>) -> Result<Shape, Finding> {
    let node = &values.node;
    let other = placement::volume(node, "clip_volume")?;
    let mut field = Field::new(other);
    if values.text("clip_volume_place") == "box" {
        let grid = placement::volume(node, "volume")?.grid();
        field = field.placed(placement::over_box(grid, other.grid()));
    }
    let unit = values.text("clip_isovalue_unit");
    let level = scalar(node, "clip_volume", values.float("clip_isovalue"), unit)?;
    let field = Box::new(field);
    Ok(Shape::Volume { field, level })
}
