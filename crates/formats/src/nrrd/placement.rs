//! Which axes of an NRRD file are spatial, and where its grid lies in LPS.
//!
//! `space directions` and `space origin` win; else `spacings`; else `axis mins` and `axis maxs`; else 1. A
//! spacing that is not known (NaN) is taken from `thicknesses` with a warning, and refused without one.

use glam::{DAffine3, DMat3, DVec3};

use volgraph_volume::{Grid, Trouble, VolumeError};

use super::Header;
use crate::axes::complete_basis;
use crate::fields::Field;

/// Kinds of axes whose samples lie side by side in space.
const SPATIAL_KINDS: [&str; 4] = ["domain", "space", "???", "none"];

/// Indices of the spatial axes: those with a direction, else those whose kind says so, else all.
pub(super) fn spatial_axes(header: &Header) -> Result<Vec<usize>, VolumeError> {
    let axes = header.sizes.len();
    let kinds = header
        .fields
        .get("kinds")
        .map(|field| words(field, axes))
        .transpose()?;
    let directions = header.fields.get("space directions");
    let spatial = match (
        directions.map(|field| vectors(field, axes)).transpose()?,
        kinds,
    ) {
        (Some(directions), _) => filter(axes, |axis| directions[axis].is_some()),
        (None, Some(kinds)) => filter(axes, |axis| {
            SPATIAL_KINDS
                .iter()
                .any(|kind| kinds[axis].eq_ignore_ascii_case(kind))
        }),
        (None, None) => filter(axes, |_| true),
    };
    // Axes of one sample at the end say nothing, and dropping them loses nothing.
    let mut kept = spatial;
    while kept.len() > 3 && kept.last().is_some_and(|&axis| header.sizes[axis] == 1) {
        kept.pop();
    }
    Ok(kept)
}

/// The axis of time steps, by its kind.
pub(super) fn time_axis(header: &Header, spatial: &[usize]) -> Option<usize> {
    let kinds = header.fields.get("kinds")?.value.split_whitespace();
    let mut times = kinds
        .enumerate()
        .filter(|(axis, kind)| kind.eq_ignore_ascii_case("time") && !spatial.contains(axis));
    times.next().map(|(axis, _)| axis)
}

fn filter(axes: usize, keep: impl Fn(usize) -> bool) -> Vec<usize> {
    (0..axes).filter(|&axis| keep(axis)).collect()
}

fn words(field: &Field, count: usize) -> Result<Vec<&str>, VolumeError> {
    let words: Vec<&str> = field.value.split_whitespace().collect();
    if words.len() == count {
        return Ok(words);
    }
    Err(field.bad(
        format!("that is {} words for {count} axes", words.len()),
        "write one word per axis",
    ))
}

fn vectors(field: &Field, count: usize) -> Result<Vec<Option<Vec<f64>>>, VolumeError> {
    let vectors = field.vectors()?;
    if vectors.len() == count {
        return Ok(vectors);
    }
    Err(field.bad(
        format!("that is {} vectors for {count} axes", vectors.len()),
        "write one vector or `none` per axis",
    ))
}

/// The space of the file: how many dimensions, and what makes LPS of it.
struct Space {
    dimension: usize,
    lps_from_file: DMat3,
}

fn space(header: &Header, warnings: &mut Vec<String>) -> Result<Option<Space>, VolumeError> {
    let flip = |x: f64, y: f64| DMat3::from_diagonal(DVec3::new(x, y, 1.0));
    let three = |lps_from_file| {
        Some(Space {
            dimension: 3,
            lps_from_file,
        })
    };
    if let Some(field) = header.fields.get("space") {
        return match field.value.to_ascii_lowercase().as_str() {
            "left-posterior-superior" | "lps" => Ok(three(DMat3::IDENTITY)),
            "right-anterior-superior" | "ras" => Ok(three(flip(-1.0, -1.0))),
            "left-anterior-superior" | "las" => Ok(three(flip(1.0, -1.0))),
            // No patient in these: the axes are taken as they are.
            "scanner-xyz" | "3d-right-handed" | "3d-left-handed" => Ok(three(DMat3::IDENTITY)),
            name => Err(VolumeError::Unsupported(Trouble::new(
                format!("the space {name:?} is not read"),
                "use left-posterior-superior, right-anterior-superior, left-anterior-superior, scanner-xyz, \
                 3D-right-handed or 3D-left-handed",
            ))
            .on_line(field.line)),
        };
    }
    if let Some(field) = header.fields.get("space dimension") {
        let dimension: usize = field.number()?;
        if !(1..=3).contains(&dimension) {
            return Err(field.bad("a space here has 1 to 3 dimensions", "drop the others"));
        }
        return Ok(Some(Space {
            dimension,
            lps_from_file: DMat3::IDENTITY,
        }));
    }
    if let Some(field) = header.fields.get("space directions") {
        warnings.push(format!(
            "line {}: `space directions` without `space`: taken as left-posterior-superior",
            field.line
        ));
        let vectors = field.vectors()?;
        let dimension = vectors.iter().flatten().next().map_or(3, Vec::len);
        if dimension > 3 {
            return Err(field.bad("a space here has 1 to 3 dimensions", "drop the others"));
        }
        return Ok(Some(Space {
            dimension,
            lps_from_file: DMat3::IDENTITY,
        }));
    }
    Ok(None)
}

impl Space {
    fn vector(&self, field: &Field, numbers: &[f64]) -> Result<DVec3, VolumeError> {
        if numbers.len() != self.dimension {
            return Err(field.bad(
                format!(
                    "a vector has {} numbers, the space {}",
                    numbers.len(),
                    self.dimension
                ),
                "give each vector as many numbers as the space has dimensions",
            ));
        }
        let mut vector = [0.0; 3];
        vector[..numbers.len()].copy_from_slice(numbers);
        Ok(self.lps_from_file * DVec3::from_array(vector))
    }
}

/// The grid in LPS. What is not finite or singular is refused with the field's line.
pub(super) fn grid(
    header: &Header,
    spatial: &[usize],
    dims: [u32; 3],
    warnings: &mut Vec<String>,
) -> Result<Grid, VolumeError> {
    let axes = header.sizes.len();
    let node_centred = centring(header, spatial, warnings)?;
    let space = space(header, warnings)?;
    let directions = header.fields.get("space directions");
    let (columns, origin, line) = match (space, directions) {
        (Some(space), Some(field)) => {
            let vectors = vectors(field, axes)?;
            let columns: Result<Vec<DVec3>, VolumeError> = spatial
                .iter()
                .filter_map(|&axis| vectors[axis].as_deref())
                .map(|numbers| space.vector(field, numbers))
                .collect();
            (columns?, space_origin(header, &space)?, field.line)
        }
        (space, _) => {
            let scalar = scalar_placement(header, spatial, node_centred, warnings)?;
            // An origin in space without directions still places the first voxel.
            let origin = match space.filter(|_| header.fields.get("space origin").is_some()) {
                Some(space) => space_origin(header, &space)?,
                None => scalar.1,
            };
            let line = ["spacings", "axis mins"]
                .iter()
                .find_map(|key| header.fields.get(key));
            (scalar.0, origin, line.map_or(0, |field| field.line))
        }
    };
    let grid = Grid {
        dims,
        world_from_index: DAffine3 {
            matrix3: complete_basis(&columns),
            translation: origin,
        },
        node_centred,
    };
    grid.check().map_err(|error| error.on_line(line))?;
    Ok(grid)
}

fn space_origin(header: &Header, space: &Space) -> Result<DVec3, VolumeError> {
    let Some(field) = header.fields.get("space origin") else {
        return Ok(DVec3::ZERO);
    };
    match field.vectors()?.as_slice() {
        [Some(numbers)] => space.vector(field, numbers),
        _ => Err(field.bad("that is not one vector", "write (x,y,z)")),
    }
}

/// Columns along the world axes and the origin, from the per-axis fields.
fn scalar_placement(
    header: &Header,
    spatial: &[usize],
    node_centred: bool,
    warnings: &mut Vec<String>,
) -> Result<(Vec<DVec3>, DVec3), VolumeError> {
    let axes = header.sizes.len();
    let per_axis = |key: &str| -> Result<Option<(&Field, Vec<f64>)>, VolumeError> {
        let field = header.fields.get(key);
        field
            .map(|field| Ok((field, field.numbers(axes)?)))
            .transpose()
    };
    let spacings = per_axis("spacings")?;
    let thicknesses = per_axis("thicknesses")?;
    let mins = per_axis("axis mins")?;
    let maxs = per_axis("axis maxs")?;
    let known = |numbers: &Option<(&Field, Vec<f64>)>, axis: usize| {
        numbers
            .as_ref()
            .map(|(_, numbers)| numbers[axis])
            .filter(|number| !number.is_nan())
    };
    let units = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut columns = Vec::new();
    let mut origin = DVec3::ZERO;
    for (&axis, unit) in spatial.iter().zip(units) {
        let intervals = header.sizes[axis] as f64 - f64::from(u8::from(node_centred));
        let (min, max) = (known(&mins, axis), known(&maxs, axis));
        let spacing = match (known(&spacings, axis), min, max) {
            (Some(spacing), ..) => spacing,
            (None, Some(min), Some(max)) if intervals > 0.0 => (max - min) / intervals,
            _ => match (&spacings, known(&thicknesses, axis)) {
                (Some((field, _)), Some(thickness)) => {
                    warnings.push(format!(
                        "line {}: the spacing of axis {} is not known; its thickness {thickness} is taken",
                        field.line,
                        axis + 1
                    ));
                    thickness
                }
                (Some((field, _)), None) => {
                    return Err(field.bad(
                        format!("the spacing of axis {} is not a number", axis + 1),
                        "give each spatial axis a spacing, or mark the axis as not spatial in `kinds`",
                    ));
                }
                (None, _) => 1.0,
            },
        };
        // The minimum of an axis is a sample's place on nodes, and the face of a cell otherwise.
        if let Some(min) = min {
            origin += unit * (min + if node_centred { 0.0 } else { spacing / 2.0 });
        }
        columns.push(unit * spacing);
    }
    Ok((columns, origin))
}

/// Node-centred only where every spatial axis says `node`.
fn centring(
    header: &Header,
    spatial: &[usize],
    warnings: &mut Vec<String>,
) -> Result<bool, VolumeError> {
    let Some(field) = header.fields.get("centerings") else {
        return Ok(false);
    };
    let words = words(field, header.sizes.len())?;
    let nodes = spatial
        .iter()
        .filter(|&&axis| words[axis].eq_ignore_ascii_case("node"))
        .count();
    if nodes > 0 && nodes < spatial.len() {
        warnings.push(format!(
            "line {}: some axes are node-centred and some are not; all are taken as cell-centred",
            field.line
        ));
    }
    Ok(nodes == spatial.len())
}
