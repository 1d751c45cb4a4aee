//! Where the grid lies: what ITK writes, the coordinates of NetCDF, or the size of a voxel in micrometres.

use glam::{DAffine3, DMat3, DVec3};
use volgraph_volume::{Grid, Trouble, VolumeError};

use super::attributes::Attributes;
use super::element::Number;
use super::meaning::Meaning;
use super::parts::{Part, Parts, Scale};
use crate::axes::complete_basis;

/// How far a coordinate may be off an even step, as a part of it.
const EVEN: f64 = 1e-3;

/// Attributes that many files have, each with its own order of axes.
const UNCLEAR: [&str; 6] = [
    "spacing",
    "origin",
    "resolution",
    "offset",
    "voxel_size",
    "pixel_size",
];

/// A grid and the unit of its lengths.
pub(super) struct Placed {
    pub grid: Grid,
    pub unit: Option<String>,
}

/// Whether a part is the array of an image of ITK.
pub(super) fn is_itk(part: &Part) -> bool {
    part.path.starts_with("ITKImage/") && part.name() == "VoxelData"
}

/// The tables beside the array: spacing and origin of x first, and a direction for each axis in the rows.
pub(super) struct Itk {
    spacing: Vec<f64>,
    origin: Vec<f64>,
    directions: Vec<f64>,
}

impl Itk {
    /// `None` where the path is no image of ITK.
    pub fn of(parts: &Parts, path: &str) -> Result<Option<Self>, VolumeError> {
        let Some(group) = path
            .strip_suffix("/VoxelData")
            .filter(|_| path.starts_with("ITKImage/"))
        else {
            return Ok(None);
        };
        let table = |name: &str| {
            let dataset = parts.at(&format!("{group}/{name}"));
            let values = dataset
                .filter(|dataset| dataset.num_elements().is_ok_and(|count| count <= 64))
                .and_then(|dataset| dataset.read_array::<Number>().ok());
            let values = values.map(|values| values.iter().map(|number| number.0).collect());
            values.ok_or_else(|| {
                VolumeError::MissingField(Trouble::new(
                    format!("the image of ITK has no valid `{name}`"),
                    "write the image again with ITK, or copy its array to another file with h5py",
                ))
            })
        };
        let itk = Self {
            spacing: table("Spacing")?,
            origin: table("Origin")?,
            directions: table("Directions")?,
        };
        let n = itk.rank();
        if itk.origin.len() != n || itk.directions.len() != n * n {
            return Err(VolumeError::BadValue(Trouble::new(
                format!(
                    "an image of ITK of {n} axes with {} numbers of an origin and {} of directions",
                    itk.origin.len(),
                    itk.directions.len()
                ),
                "write the image again with ITK",
            )));
        }
        Ok(Some(itk))
    }

    pub fn rank(&self) -> usize {
        self.spacing.len()
    }

    pub fn placed(&self, meaning: &Meaning, dims: [u32; 3]) -> Result<Placed, VolumeError> {
        let n = self.rank();
        let (mut columns, mut origin) = (Vec::new(), DVec3::ZERO);
        for i in 0..meaning.space.len() {
            let row = &self.directions[i * n..(i + 1) * n];
            let mut column = DVec3::ZERO;
            for (component, value) in column.as_mut().iter_mut().zip(row) {
                *component = value * self.spacing[i];
            }
            columns.push(column);
            origin[i] = self.origin[i];
        }
        Ok(Placed {
            grid: grid(&columns, origin, dims)?,
            unit: None,
        })
    }
}

fn grid(columns: &[DVec3], origin: DVec3, dims: [u32; 3]) -> Result<Grid, VolumeError> {
    let usable = |column: &DVec3| column.length() > 0.0 && column.is_finite();
    if !columns.iter().all(usable) || !origin.is_finite() {
        return Err(VolumeError::Grid(Trouble::new(
            "the spacing has a zero, or the placement is not finite",
            "give the volume a `spacing` and an `origin`",
        )));
    }
    let matrix3 = if columns.is_empty() {
        DMat3::IDENTITY
    } else {
        complete_basis(columns)
    };
    let grid = Grid {
        dims,
        world_from_index: DAffine3 {
            matrix3,
            translation: origin,
        },
        node_centred: false,
    };
    grid.check()?;
    Ok(grid)
}

/// Along x, y and z: the coordinates of the axes' scales, or `element_size_um` (which counts in the order of the axes,
/// as the HDF5 plugin of Fiji and PlantSeg write it), or cubes of length 1.
pub(super) fn placed(
    meaning: &Meaning,
    dims: [u32; 3],
    attributes: &Attributes,
    scales: &[Option<Scale>],
    warnings: &mut Vec<String>,
) -> Result<Placed, VolumeError> {
    let mut spacing = DVec3::ONE;
    let mut origin = DVec3::ZERO;
    let mut units = Vec::new();
    let mut known = false;
    for (i, &axis) in meaning.space.iter().enumerate() {
        let Some(scale) = &scales[axis] else { continue };
        let Some(steps) = scale.values.as_deref().and_then(Steps::of) else {
            continue;
        };
        known = true;
        (spacing[i], origin[i]) = (steps.step, steps.first);
        if !steps.even {
            warnings.push(format!(
                "the coordinates {:?} are not evenly spaced: slices are drawn as if they were, from the first to \
                 the last",
                scale.name
            ));
        }
        units.push(scale.unit.clone().unwrap_or_default());
    }
    let mut unit = None;
    let size = attributes.numbers("element_size_um");
    if let Some(size) = size.filter(|size| !known && size.len() == meaning.space.len()) {
        // Their order is that of the axes of space in the file.
        let mut axes = meaning.space.clone();
        axes.sort_unstable();
        for (i, axis) in meaning.space.iter().enumerate() {
            if let Some(at) = axes.iter().position(|other| other == axis) {
                spacing[i] = size[at];
            }
        }
        known = true;
        unit = Some("µm".to_owned());
    }
    if units.windows(2).all(|pair| pair[0] == pair[1]) {
        unit = unit.or(units.pop().filter(|unit| !unit.is_empty() && unit != "1"));
    } else {
        warnings.push(format!(
            "the axes of space have several units: {}",
            units.join(", ")
        ));
    }
    if !known {
        let unclear = UNCLEAR
            .iter()
            .filter(|name| attributes.get(name).is_some_and(|one| one.shape.len() == 1));
        let unclear: Vec<&str> = unclear.copied().collect();
        if !unclear.is_empty() {
            warnings.push(format!(
                "voxels are taken as cubes of length 1: the attributes {} are not read, for files differ in the \
                 order of their axes; give `spacing` and `origin`",
                unclear.join(", ")
            ));
        }
    }
    let columns: Vec<DVec3> = (0..meaning.space.len())
        .map(|i| DVec3::AXES[i] * spacing[i])
        .collect();
    Ok(Placed {
        grid: grid(&columns, origin, dims)?,
        unit,
    })
}

/// Coordinates along an axis.
struct Steps {
    first: f64,
    step: f64,
    even: bool,
}

impl Steps {
    /// `None` where they say nothing: none, not finite, not going anywhere.
    fn of(values: &[f64]) -> Option<Self> {
        let (&first, &last) = (values.first()?, values.last()?);
        if values.len() == 1 {
            return first.is_finite().then_some(Self {
                first,
                step: 1.0,
                even: true,
            });
        }
        let step = (last - first) / (values.len() - 1) as f64;
        if !values.iter().all(|value| value.is_finite()) || step == 0.0 || !step.is_finite() {
            return None;
        }
        let off = |(i, value): (usize, &f64)| (value - first - i as f64 * step).abs();
        let most = values.iter().enumerate().map(off).fold(0.0, f64::max);
        Some(Self {
            first,
            step,
            even: most <= EVEN * step.abs(),
        })
    }
}

/// The time of each step and its unit, where there is a scale with as many values as steps.
pub(super) fn times(scale: Option<&Scale>, steps: u32) -> (Vec<f64>, Option<String>) {
    let Some(scale) = scale else {
        return (Vec::new(), None);
    };
    let values = scale.values.clone().unwrap_or_default();
    if values.len() != steps as usize {
        return (Vec::new(), None);
    }
    (values, scale.unit.clone())
}
