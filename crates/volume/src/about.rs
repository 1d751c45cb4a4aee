//! What a file says of its volume beside grid and voxels.

use std::collections::BTreeMap;
use std::fmt;

/// What a file says of its volume: plain facts for people and for the choice of a transfer function. None of them
/// changes where a voxel lies or what is stored in it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct About {
    /// The format's name and version, such as `NIfTI-1` or `OME-Zarr 0.5`; empty for a volume that was computed.
    pub format: String,
    /// The unit of spacing and origin, such as `mm` or `µm`, where the file says one.
    pub length_unit: Option<String>,
    /// What the values mean.
    pub values: Values,
    /// The values' unit, such as `HU` or `kg/m³`, where the file says one.
    pub value_unit: Option<String>,
    /// Which of several values per voxel was taken; `None` where there is one.
    pub picked: Option<Picked>,
    /// Which of several time steps was taken; `None` where there is one.
    pub step: Option<Step>,
    /// Other facts by name, in the order of the file: modality, series, descriptions.
    pub facts: Vec<(String, String)>,
}

/// What the values of a volume mean.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Values {
    /// The file does not say.
    #[default]
    Unknown,
    /// X-ray attenuation in Hounsfield units: air -1000, water 0.
    Hounsfield,
    /// Labels of segments, with their names where the file has them.
    Labels(BTreeMap<i64, String>),
    /// A quantity by its name, such as `density`.
    Named(String),
}

/// Which of a voxel's values become its scalar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Component {
    /// One of them, from 0.
    Index(u32),
    /// The Euclidean length of all of them, as a float.
    Magnitude,
    /// Red, green, blue and perhaps alpha are drawn as they are ([`Volume::colors`](crate::Volume::colors)); the
    /// scalar is their luma (Rec. 709 weights on the stored values), or alpha where there is one.
    Color,
}

impl fmt::Display for Component {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Index(index) => write!(f, "{index}"),
            Self::Magnitude => f.write_str("magnitude"),
            Self::Color => f.write_str("color"),
        }
    }
}

impl std::str::FromStr for Component {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "magnitude" => Ok(Self::Magnitude),
            "color" => Ok(Self::Color),
            _ => text.parse().map(Self::Index).map_err(|_| {
                format!("{text:?} is none of `magnitude`, `color` and the numbers from 0")
            }),
        }
    }
}

/// One choice among several values per voxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Picked {
    /// What was taken.
    pub component: Component,
    /// Values per voxel.
    pub count: u64,
}

/// One of several time steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// From 0.
    pub index: u32,
    /// How many there are.
    pub count: u32,
    /// Its time, where the file says it.
    pub time: Option<f64>,
    /// The unit of time, where the file says it.
    pub unit: Option<String>,
}
