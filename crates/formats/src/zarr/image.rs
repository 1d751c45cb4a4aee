//! One level of an image, or a plain array: which axes are space, time and components, and where it lies.

use std::path::Path;

use glam::{DAffine3, DVec3};
use volgraph_volume::{Grid, Trouble, Values, VolumeError};

use super::array::{Array, Box as Region};
use super::metadata::{Meta, Node, inside, node};
use super::ome::{self, Axis, Kind};
use super::parts::Part;
use super::store::Store;
use crate::axes::{Axes, complete_basis};
use crate::contents::{Components, Contents};

/// Most time steps whose times are listed.
const MOST_TIMES: u32 = 1 << 16;

/// An array with a meaning for each axis; the axes are in the file's order, slowest first.
pub(super) struct Image {
    pub array: Array,
    /// Place of x, y and z among the axes; fewer where there are fewer.
    pub space: Vec<usize>,
    time: Option<usize>,
    scale: Vec<f64>,
    translation: Vec<f64>,
    axes: Vec<Axis>,
    ome: Option<ome::Image>,
}

impl Image {
    /// A level of a part: level 0 alone where it is a plain array.
    pub fn open(
        store: &Store,
        folder: &Path,
        part: &Part,
        level: u32,
    ) -> Result<Self, VolumeError> {
        let folder = inside(folder, &part.path)?;
        match &part.image {
            Some(attributes) => Self::of_ome(store, &folder, ome::image(attributes)?, level),
            None => {
                if level > 0 {
                    return Err(no_level(level, 1));
                }
                Self::plain(store, &folder, meta(store, &folder, "")?)
            }
        }
    }

    fn of_ome(
        store: &Store,
        folder: &Path,
        image: ome::Image,
        level: u32,
    ) -> Result<Self, VolumeError> {
        let count = image.levels.len();
        let one = image
            .levels
            .get(level as usize)
            .ok_or_else(|| no_level(level, count))?;
        let meta = meta(store, folder, &one.path)?;
        if meta.shape.len() != image.axes.len() {
            let (have, said) = (meta.shape.len(), image.axes.len());
            return Err(VolumeError::BadValue(Trouble::new(
                format!("the array has {have} axes, and `multiscales` names {said}"),
                "correct the attributes, or write the image again",
            ))
            .in_file(&meta.file));
        }
        let array = Array::new(store, &inside(folder, &one.path)?, meta);
        let (space, time) = roles(&image.axes)?;
        Ok(Self {
            array,
            space,
            time,
            scale: one.scale.clone(),
            translation: one.translation.clone(),
            axes: image.axes.clone(),
            ome: Some(image),
        })
    }

    /// An array that nobody explains: its names where they say x, y, z, t, else the last three axes are z, y, x.
    fn plain(store: &Store, folder: &Path, meta: Meta) -> Result<Self, VolumeError> {
        let rank = meta.shape.len();
        let names = meta.names.clone().or_else(|| {
            // What xarray writes into version 2.
            let list = meta.attributes.get("_ARRAY_DIMENSIONS")?.as_array()?;
            let names: Vec<Option<String>> = list
                .iter()
                .map(|name| name.as_str().map(str::to_owned))
                .collect();
            (names.len() == rank).then_some(names)
        });
        let known = names.filter(|names| {
            let kinds = names
                .iter()
                .map(|name| ome::kind(None, name.as_deref().unwrap_or_default()));
            let space = kinds.filter(|kind| *kind == Kind::Space).count();
            (1..=3).contains(&space)
        });
        let axes: Vec<Axis> = (0..rank)
            .map(|i| match &known {
                Some(names) => {
                    let name = names[i].clone().unwrap_or_default();
                    let kind = ome::kind(None, &name);
                    Axis {
                        name,
                        kind,
                        unit: None,
                    }
                }
                None => Axis {
                    name: String::new(),
                    kind: if rank - i <= 3 {
                        Kind::Space
                    } else {
                        Kind::Other
                    },
                    unit: None,
                },
            })
            .collect();
        let (space, time) = roles(&axes)?;
        Ok(Self {
            space,
            time,
            scale: vec![1.0; rank],
            translation: vec![0.0; rank],
            axes,
            ome: None,
            array: Array::new(store, folder, meta),
        })
    }

    /// The axes as the rest of the crate has them: fastest first.
    pub fn axes(&self) -> Result<Axes, VolumeError> {
        let rank = self.array.meta.shape.len();
        let sizes = self.array.meta.shape.iter().rev().copied().collect();
        let space = self.space.iter().map(|&axis| rank - 1 - axis).collect();
        let axes = Axes::new(sizes, space)?;
        match self.time {
            Some(time) => axes.with_time(rank - 1 - time),
            None => Ok(axes),
        }
    }

    /// Placement: the whole of it where volgraph wrote it, scale and translation elsewhere.
    pub fn grid(&self, dims: [u32; 3]) -> Result<Grid, VolumeError> {
        let mut columns = Vec::new();
        let mut origin = DVec3::ZERO;
        for (i, &axis) in self.space.iter().enumerate() {
            columns.push(DVec3::AXES[i] * self.scale[axis]);
            origin[i] = self.translation[axis];
        }
        let mut grid = Grid {
            dims,
            world_from_index: DAffine3 {
                matrix3: glam::DMat3::IDENTITY,
                translation: origin,
            },
            node_centred: false,
        };
        if columns
            .iter()
            .any(|column| !(column.length() > 0.0 && column.is_finite()))
        {
            return Err(VolumeError::Grid(Trouble::new(
                format!("the scale {:?} has a zero, or is not finite", self.scale),
                "give each axis a scale other than 0",
            )));
        }
        grid.world_from_index.matrix3 = complete_basis(&columns);
        if let Some(own) = self.array.meta.attributes.get("volgraph") {
            let numbers = own.get("world_from_index").and_then(|list| list.as_array());
            let numbers: Option<Vec<f64>> =
                numbers.and_then(|list| list.iter().map(serde_json::Value::as_f64).collect());
            if let Some(numbers) = numbers.and_then(|list| <[f64; 12]>::try_from(list).ok()) {
                grid.world_from_index = DAffine3::from_cols_array(&numbers);
            }
            grid.node_centred =
                own.get("node_centred").and_then(serde_json::Value::as_bool) == Some(true);
        }
        grid.check()?;
        Ok(grid)
    }

    /// What the file says.
    pub fn contents(&self, folder: &Path, part: &Part) -> Result<Contents, VolumeError> {
        let meta = &self.array.meta;
        let axes = self.axes()?;
        axes.count()?;
        let grid = self.grid(axes.dims())?;
        let format = match &self.ome {
            Some(image) => format!("OME-Zarr {}", image.version).trim().to_owned(),
            None => format!("Zarr v{}", meta.version),
        };
        let name = part
            .path
            .rsplit('/')
            .find(|name| !matches!(*name, "" | "."));
        let name = match (&self.ome, name) {
            (_, Some(name)) => name.to_owned(),
            (
                Some(ome::Image {
                    name: Some(name), ..
                }),
                None,
            ) => name.clone(),
            _ => crate::input::stem(folder),
        };
        let steps = axes.steps();
        let mut contents = Contents::new(format, name, axes, meta.element.scalar_type, grid);
        let units: Vec<&str> = self
            .space
            .iter()
            .filter_map(|&axis| self.axes[axis].unit.as_deref())
            .collect();
        if let Some(&first) = units.first() {
            if units.len() == self.space.len() && units.iter().all(|unit| *unit == first) {
                contents.about.length_unit = Some(ome::short_unit(first));
            } else {
                contents.warnings.push(format!(
                    "the axes of space have several units: {}",
                    units.join(", ")
                ));
            }
        }
        if let Some(time) = self
            .time
            .filter(|_| self.ome.is_some() && steps <= MOST_TIMES)
        {
            let at = |step: u32| self.translation[time] + f64::from(step) * self.scale[time];
            contents.times = (0..steps).map(at).collect();
            contents.time_unit = self.axes[time].unit.as_deref().map(ome::short_unit);
        }
        if let Some(image) = &self.ome {
            if let Some(labels) = &image.labels {
                contents.about.values = Values::Labels(labels.clone());
            } else if part.is_label {
                contents.about.values = Values::Labels(std::collections::BTreeMap::new());
            }
            if image.colors {
                contents.components = Components::Colors;
            }
            let facts = &mut contents.about.facts;
            if image.levels.len() > 1 {
                facts.push(("levels".to_owned(), image.levels.len().to_string()));
            }
            for (number, (label, color)) in image.channels.iter().enumerate() {
                facts.push((
                    format!("channel {number}"),
                    format!("{label} {color}").trim().to_owned(),
                ));
            }
        }
        contents.data_files = vec![self.array.store.file_of(&meta.file)];
        Ok(contents)
    }

    pub fn steps(&self) -> u64 {
        self.time.map_or(1, |axis| self.array.meta.shape[axis])
    }

    /// The box of a time step.
    pub fn whole(&self, step: u32) -> Region {
        let mut whole = Region {
            origin: vec![0; self.array.meta.shape.len()],
            size: self.array.meta.shape.clone(),
        };
        if let Some(time) = self.time {
            (whole.origin[time], whole.size[time]) = (step.into(), 1);
        }
        whole
    }

    /// The part of a box that has one component; they are counted with the fastest axis first.
    pub fn of_component(&self, region: &Region, component: u64) -> Region {
        let mut one = region.clone();
        let mut rest = component;
        for axis in (0..one.size.len()).rev() {
            if self.space.contains(&axis) || self.time == Some(axis) {
                continue;
            }
            let n = self.array.meta.shape[axis].max(1);
            (one.origin[axis], one.size[axis]) = (rest % n, 1);
            rest /= n;
        }
        one
    }

    pub fn level_count(&self) -> usize {
        self.ome.as_ref().map_or(1, |image| image.levels.len())
    }
}

fn no_level(level: u32, count: usize) -> VolumeError {
    VolumeError::Option(Trouble::new(
        format!("there is no level {level}: there are {count}"),
        if count == 1 {
            "leave the option out".to_owned()
        } else {
            format!("name one of 0 to {}", count - 1)
        },
    ))
}

fn meta(store: &Store, folder: &Path, path: &str) -> Result<Meta, VolumeError> {
    let folder = inside(folder, path)?;
    match node(store, &folder)? {
        Some(Node::Array(meta)) => Ok(*meta),
        _ => Err(VolumeError::DataFile(Trouble::new(
            "is no Zarr array, and the group's metadata says it is one",
            "fetch the whole folder again, or correct the metadata",
        ))
        .in_file(&folder)),
    }
}

/// Which axes are x, y, z (by their names, else in order with the last one x), and which is time.
fn roles(axes: &[Axis]) -> Result<(Vec<usize>, Option<usize>), VolumeError> {
    let mut space: Vec<usize> = (0..axes.len())
        .filter(|&i| axes[i].kind == Kind::Space)
        .collect();
    if space.is_empty() || space.len() > 3 {
        return Err(VolumeError::Unsupported(Trouble::new(
            format!("{} axes of space; a volume has one to three", space.len()),
            "name the axes x, y and z, or give them the type `space`",
        )));
    }
    let named = |name: &str| {
        space
            .iter()
            .copied()
            .find(|&i| axes[i].name.eq_ignore_ascii_case(name))
    };
    let by_name: Vec<usize> = ["x", "y", "z"]
        .iter()
        .filter_map(|name| named(name))
        .collect();
    if by_name.len() == space.len() {
        space = by_name;
    } else {
        space.reverse();
    }
    let mut times = (0..axes.len()).filter(|&i| axes[i].kind == Kind::Time);
    Ok((space, times.next()))
}
