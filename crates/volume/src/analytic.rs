//! Volumes of known functions: exact values and gradients everywhere, for tests and pictures of accuracy.
//!
//! An [`AnalyticField`] is a function of a point `p` of the cube `[-1, 1]³`, computed in float64. [`sample`]
//! makes a [`Volume`] of it: voxel centres at `-1 + (2 i + 1) / n` along each axis, or with [`sample_nodes`] samples
//! from face to face at `-1 + 2 i / (n - 1)`. In the world the cube is
//! `[-0.5, 0.5]³`, so `world = p / 2`, and a gradient in world space is twice the one given here.
//! [`AnalyticField::by_name`] takes names and parameters as graph files have them; [`FieldInfo`] documents them.

mod hydrogen;
mod molecule;
mod shapes;

use glam::{DVec3, UVec3};
use rayon::prelude::*;
use volgraph_report::{did_you_mean, list_names};

use crate::error::Trouble;
use crate::for_scalar_type;
use crate::{Element, Grid, ScalarType, Volume, VolumeError, Voxels};

pub use hydrogen::Hydrogen;
pub use molecule::C60;
pub use shapes::{Constant, Gyroid, MarschnerLobb, Ramp, Sphere, Torus, Trilinear};

/// A scalar function of the cube `[-1, 1]³` with its exact gradient.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "each struct documents its field")]
pub enum AnalyticField {
    MarschnerLobb(MarschnerLobb),
    C60(C60),
    Hydrogen(Hydrogen),
    Sphere(Sphere),
    Torus(Torus),
    Gyroid(Gyroid),
    Ramp(Ramp),
    Trilinear(Trilinear),
    Constant(Constant),
}

/// One parameter of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterInfo {
    /// Its name.
    pub name: &'static str,
    /// Its value where none is given.
    pub default: f64,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// What it means.
    pub doc: &'static str,
}

/// A field and its parameters.
#[derive(Clone, Copy, Debug)]
pub struct FieldInfo {
    /// Its name.
    pub name: &'static str,
    /// What it is.
    pub doc: &'static str,
    /// Its parameters.
    pub parameters: &'static [ParameterInfo],
}

const fn parameter(
    name: &'static str,
    default: f64,
    min: f64,
    max: f64,
    doc: &'static str,
) -> ParameterInfo {
    ParameterInfo {
        name,
        default,
        min,
        max,
        doc,
    }
}

const fn corner(name: &'static str, default: f64, doc: &'static str) -> ParameterInfo {
    parameter(name, default, -1e30, 1e30, doc)
}

const FALLOFF: ParameterInfo = parameter(
    "falloff",
    2.5,
    1e-3,
    1e3,
    "distance over which the value falls by 1",
);

/// All fields.
pub const FIELDS: [FieldInfo; 9] = [
    FieldInfo {
        name: "marschner_lobb",
        doc: "rings of nearly constant frequency: the test signal of Marschner and Lobb 1994",
        parameters: &[
            parameter("frequency", 6.0, 0.0, 100.0, "f_M, rings per unit length"),
            parameter("alpha", 0.25, 0.0, 100.0, "strength of the rings"),
        ],
    },
    FieldInfo {
        name: "c60",
        doc: "sixty Gaussians on the corners of a truncated icosahedron",
        parameters: &[
            parameter(
                "radius",
                0.72,
                0.01,
                10.0,
                "distance of the atoms from the centre",
            ),
            parameter(
                "sigma",
                0.09,
                1e-3,
                10.0,
                "standard deviation of each Gaussian",
            ),
        ],
    },
    FieldInfo {
        name: "hydrogen",
        doc: "probability density of an electron in a real orbital of hydrogen, its maximum scaled to 1",
        parameters: &[
            parameter("n", 4.0, 1.0, 10.0, "principal quantum number"),
            parameter("l", 2.0, 0.0, 9.0, "azimuthal quantum number, below n"),
            parameter(
                "m",
                0.0,
                -9.0,
                9.0,
                "magnetic quantum number, -l to l; below 0 the sine orbital",
            ),
            parameter(
                "extent",
                0.0,
                0.0,
                1e4,
                "half the edge of the cube in Bohr radii; 0 for 2 n² + n",
            ),
        ],
    },
    FieldInfo {
        name: "sphere",
        doc: "linear falloff from the centre; 0.5 on a sphere",
        parameters: &[
            parameter("radius", 0.7, 0.0, 10.0, "radius of the sphere"),
            FALLOFF,
        ],
    },
    FieldInfo {
        name: "torus",
        doc: "linear falloff from a ring about z; 0.5 on a torus",
        parameters: &[
            parameter("major", 0.55, 0.0, 10.0, "radius of the ring"),
            parameter("minor", 0.25, 0.0, 10.0, "radius of the tube"),
            FALLOFF,
        ],
    },
    FieldInfo {
        name: "gyroid",
        doc: "the gyroid's level function; 0.5 on the surface",
        parameters: &[parameter(
            "periods",
            2.0,
            0.0,
            100.0,
            "periods along an edge of the cube",
        )],
    },
    FieldInfo {
        name: "ramp",
        doc: "linear along a direction, 0 to 1 from corner to corner of the cube",
        parameters: &[
            parameter("x", 1.0, -1e6, 1e6, "direction, x"),
            parameter("y", 0.0, -1e6, 1e6, "direction, y"),
            parameter("z", 0.0, -1e6, 1e6, "direction, z"),
        ],
    },
    FieldInfo {
        name: "trilinear",
        doc: "trilinear between values at the corners of the cube: one cell of a grid, without kinks",
        parameters: &[
            corner("c000", 0.10, "value at the corner -x -y -z"),
            corner("c100", 0.70, "value at +x -y -z"),
            corner("c010", 0.45, "value at -x +y -z"),
            corner("c110", 0.20, "value at +x +y -z"),
            corner("c001", 0.80, "value at -x -y +z"),
            corner("c101", 0.35, "value at +x -y +z"),
            corner("c011", 0.25, "value at -x +y +z"),
            corner("c111", 0.95, "value at +x +y +z"),
        ],
    },
    FieldInfo {
        name: "constant",
        doc: "the same everywhere",
        parameters: &[parameter("value", 0.5, -1e30, 1e30, "the value")],
    },
];

impl AnalyticField {
    /// Names of all fields.
    pub fn names() -> impl Iterator<Item = &'static str> {
        FIELDS.iter().map(|field| field.name)
    }

    /// What a field is and which parameters it takes.
    #[must_use]
    pub fn info(name: &str) -> Option<&'static FieldInfo> {
        FIELDS.iter().find(|field| field.name == name)
    }

    /// The field of a name, with some of its parameters and the defaults for the rest.
    ///
    /// # Errors
    /// [`VolumeError::Field`] where there is no such field or parameter, a parameter is given twice, is not
    /// finite or out of range, or the parameters do not fit each other.
    pub fn by_name(name: &str, params: &[(String, f64)]) -> Result<Self, VolumeError> {
        let refuse =
            |cause: String, remedy: String| VolumeError::Field(Trouble::new(cause, remedy));
        let info = Self::info(name).ok_or_else(|| {
            let remedy = did_you_mean(name, Self::names()).unwrap_or_default();
            refuse(format!("there is no analytic field `{name}`"), remedy)
        })?;
        for (i, (given, value)) in params.iter().enumerate() {
            let names = || info.parameters.iter().map(|parameter| parameter.name);
            let Some(known) = info.parameters.iter().find(|known| known.name == given) else {
                let remedy = did_you_mean(given, names()).unwrap_or_else(|| list_names(names()));
                return Err(refuse(
                    format!("`{name}` has no parameter `{given}`"),
                    remedy,
                ));
            };
            // A NaN is in no range.
            if !(known.min..=known.max).contains(value) {
                return Err(refuse(
                    format!("`{given}` of `{name}` is {value}"),
                    format!("give a number from {} to {}", known.min, known.max),
                ));
            }
            if params[..i].iter().any(|(earlier, _)| earlier == given) {
                return Err(refuse(
                    format!("`{given}` of `{name}` is given twice"),
                    "keep one of the two".into(),
                ));
            }
        }
        let values: Vec<f64> = info
            .parameters
            .iter()
            .map(|known| {
                let given = params.iter().find(|(given, _)| given == known.name);
                given.map_or(known.default, |(_, value)| *value)
            })
            .collect();
        Self::with_values(name, &values).map_err(|(cause, remedy)| refuse(cause, remedy.into()))
    }

    /// The field with all its parameters in the order of its [`FieldInfo`].
    fn with_values(name: &str, values: &[f64]) -> Result<Self, (String, &'static str)> {
        Ok(match (name, values) {
            ("marschner_lobb", &[frequency, alpha]) => {
                Self::MarschnerLobb(MarschnerLobb { frequency, alpha })
            }
            ("c60", &[radius, sigma]) => Self::C60(C60::new(radius, sigma)),
            ("hydrogen", &[n, l, m, extent]) => Self::Hydrogen(Hydrogen::new(n, l, m, extent)?),
            ("sphere", &[radius, falloff]) => Self::Sphere(Sphere { radius, falloff }),
            ("torus", &[major, minor, falloff]) => Self::Torus(Torus {
                major,
                minor,
                falloff,
            }),
            ("gyroid", &[periods]) => Self::Gyroid(Gyroid { periods }),
            ("ramp", &[x, y, z]) => Self::Ramp(Ramp::along(DVec3::new(x, y, z)).ok_or((
                "the ramp has no direction".into(),
                "give a direction other than 0",
            ))?),
            ("trilinear", &[a, b, c, d, e, f, g, h]) => Self::Trilinear(Trilinear {
                corners: [a, b, c, d, e, f, g, h],
            }),
            (_, values) => Self::Constant(Constant {
                value: values.first().copied().unwrap_or(0.5),
            }),
        })
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::MarschnerLobb(_) => "marschner_lobb",
            Self::C60(_) => "c60",
            Self::Hydrogen(_) => "hydrogen",
            Self::Sphere(_) => "sphere",
            Self::Torus(_) => "torus",
            Self::Gyroid(_) => "gyroid",
            Self::Ramp(_) => "ramp",
            Self::Trilinear(_) => "trilinear",
            Self::Constant(_) => "constant",
        }
    }

    /// The value at a point of the cube `[-1, 1]³`; the formulas hold outside too.
    #[must_use]
    pub fn value(&self, p: DVec3) -> f64 {
        match self {
            Self::MarschnerLobb(field) => field.value(p),
            Self::C60(field) => field.value(p),
            Self::Hydrogen(field) => field.value(p),
            Self::Sphere(field) => field.value(p),
            Self::Torus(field) => field.value(p),
            Self::Gyroid(field) => field.value(p),
            Self::Ramp(field) => field.value(p),
            Self::Trilinear(field) => field.value(p),
            Self::Constant(field) => field.value,
        }
    }

    /// The gradient per unit of the cube `[-1, 1]³`; 0 at the points where there is none (the centre of the
    /// sphere, the ring and axis of the torus, the nucleus of an s orbital).
    #[must_use]
    pub fn gradient(&self, p: DVec3) -> DVec3 {
        match self {
            Self::MarschnerLobb(field) => field.gradient(p),
            Self::C60(field) => field.gradient(p),
            Self::Hydrogen(field) => field.gradient(p),
            Self::Sphere(field) => field.gradient(p),
            Self::Torus(field) => field.gradient(p),
            Self::Gyroid(field) => field.gradient(p),
            Self::Ramp(field) => field.gradient,
            Self::Trilinear(field) => field.gradient(p),
            Self::Constant(_) => DVec3::ZERO,
        }
    }
}

/// The grid of a sampled field: the cube is `[-0.5, 0.5]³` in the world, with spacing `1 / n` along each axis.
#[must_use]
pub fn grid(dims: [u32; 3]) -> Grid {
    let spacing = UVec3::from_array(dims).as_dvec3().recip();
    Grid::axis_aligned(dims, spacing, spacing / 2.0 - 0.5)
}

/// The centre of a voxel of [`grid`] in the cube `[-1, 1]³`: `-1 + (2 i + 1) / n`.
#[must_use]
pub fn voxel_centre(dims: [u32; 3], index: [u32; 3]) -> DVec3 {
    let index = UVec3::from_array(index).as_dvec3();
    (2.0 * index + 1.0) / UVec3::from_array(dims).as_dvec3() - 1.0
}

/// The grid of a field that is sampled from face to face of the cube: node-centred, with spacing `1 / (n - 1)`; an axis
/// with a single sample has it in the middle.
#[must_use]
pub fn node_grid(dims: [u32; 3]) -> Grid {
    let cells = UVec3::from_array(dims).saturating_sub(UVec3::ONE);
    let spacing = cells.max(UVec3::ONE).as_dvec3().recip();
    let origin = DVec3::select(cells.cmpeq(UVec3::ZERO), DVec3::ZERO, DVec3::splat(-0.5));
    let mut grid = Grid::axis_aligned(dims, spacing, origin);
    grid.node_centred = true;
    grid
}

/// A volume of a field at the samples of [`node_grid`], the values as of [`sample`].
///
/// # Errors
/// As [`sample`].
pub fn sample_nodes(
    field: &AnalyticField,
    dims: [u32; 3],
    ty: ScalarType,
) -> Result<Volume, VolumeError> {
    sample_on(field, node_grid(dims), ty)
}

/// A volume of a field at voxel centres. Float voxels are the value itself (float32 rounded); integers are
/// `round(value * MAX)` of the value clamped to 0..1 (unsigned) or -1..1 (signed).
///
/// # Errors
/// [`VolumeError::Grid`] where a dimension is 0, [`VolumeError::TooLarge`] where the voxels pass
/// [`crate::DEFAULT_MAX_BYTES`] or memory.
pub fn sample(
    field: &AnalyticField,
    dims: [u32; 3],
    ty: ScalarType,
) -> Result<Volume, VolumeError> {
    sample_on(field, grid(dims), ty)
}

fn sample_on(field: &AnalyticField, grid: Grid, ty: ScalarType) -> Result<Volume, VolumeError> {
    grid.check()?;
    let limit = crate::DEFAULT_MAX_BYTES;
    let count = grid.voxel_count();
    let bytes = count.saturating_mul(ty.size() as u64);
    let too_large = || {
        VolumeError::TooLarge(Trouble::new(
            format!(
                "{count} voxels of {ty} are {bytes} bytes, more than the limit of {limit} or than memory"
            ),
            "ask for fewer voxels",
        ))
    };
    if bytes > limit {
        return Err(too_large());
    }
    let voxels = for_scalar_type!(ty, T => {
        fill::<T>(field, &grid, count as usize).ok_or_else(too_large)?
    });
    Volume::new(field.name(), grid, voxels)
}

fn fill<T: Element>(field: &AnalyticField, grid: &Grid, count: usize) -> Option<Voxels> {
    let mut voxels: Vec<T> = Vec::new();
    voxels.try_reserve_exact(count).ok()?;
    voxels.resize(count, T::zeroed());
    let [nx, ny, _] = grid.dims;
    voxels
        .par_chunks_mut(nx as usize)
        .enumerate()
        .for_each(|(row, voxels)| {
            let (y, z) = (row as u64 % u64::from(ny), row as u64 / u64::from(ny));
            for (x, voxel) in (0_u32..).zip(voxels) {
                let index = [x, y as u32, z as u32];
                let centre = if grid.node_centred {
                    // The cube [-1, 1]³ is [-0.5, 0.5]³ in the world.
                    2.0 * (grid.origin() + grid.spacing() * UVec3::from_array(index).as_dvec3())
                } else {
                    voxel_centre(grid.dims, index)
                };
                *voxel = T::from_field(field.value(centre));
            }
        });
    Some(T::wrap(voxels))
}
