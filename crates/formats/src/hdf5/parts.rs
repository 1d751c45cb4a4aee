//! What there is in a file to be read: all arrays below the root, and the one that is meant.

use std::collections::HashSet;

use hdf5_reader::error::Error;
use hdf5_reader::reference::resolve_object_reference;
use hdf5_reader::{Dataset, Hdf5File};
use volgraph_volume::{Trouble, VolumeError};

use super::attributes::Attributes;
use super::element;
use super::{place, told};
use crate::choice::{Candidate, choose, cut};

/// Deepest level of groups that are looked into, and most objects that are looked at.
const DEEPEST: usize = 16;
const MOST_OBJECTS: usize = 1 << 14;

/// Longest name of an object that is worth a look.
const LONGEST_NAME: usize = 1 << 10;

/// An array, or why it is none.
pub(super) struct Part {
    /// From the root on, without the first slash.
    pub path: String,
    dataset: Result<Dataset, Error>,
}

/// The arrays of a file, in the order of their paths.
pub(super) struct Parts(Vec<Part>);

impl Parts {
    /// Finds all arrays; and the one at the path `name`, whichever links lead there.
    pub fn of(file: &Hdf5File, name: Option<&str>) -> Result<Self, VolumeError> {
        let root = file.root_group().map_err(|error| told(&error))?;
        let mut seen = HashSet::from([root.address()]);
        let name = name.map(|name| name.trim_matches('/'));
        let named = name.and_then(|name| Some((name, file.dataset(name).ok()?)));
        let mut parts = Vec::new();
        let mut groups = vec![(root, String::new(), 0)];
        let mut looked = 0;
        while let Some((group, path, depth)) = groups.pop() {
            let names = match group.member_names() {
                Ok(names) => names,
                // What cannot be listed does not spoil its neighbours.
                Err(error) if depth == 0 => return Err(told(&error)),
                Err(_) => continue,
            };
            let below = |name: &str| {
                if path.is_empty() {
                    name.to_owned()
                } else {
                    format!("{path}/{name}")
                }
            };
            let (inner, arrays) = names;
            for name in arrays.iter().filter(|name| name.len() < LONGEST_NAME) {
                looked += 1;
                if looked > MOST_OBJECTS {
                    break;
                }
                let dataset = group.dataset(name);
                // Links may lead to an array twice.
                if !dataset
                    .as_ref()
                    .is_ok_and(|one| !seen.insert(one.address()))
                {
                    let path = below(name);
                    parts.push(Part { path, dataset });
                }
            }
            for name in inner.iter().filter(|name| name.len() < LONGEST_NAME) {
                looked += 1;
                if looked > MOST_OBJECTS || depth >= DEEPEST {
                    break;
                }
                // A group may be its own grandchild.
                if let Ok(inner) = group.group(name)
                    && seen.insert(inner.address())
                {
                    groups.push((inner, below(name), depth + 1));
                }
            }
        }
        if let Some((path, dataset)) = named {
            parts.retain(|part| part.path != path);
            parts.push(Part {
                path: path.to_owned(),
                dataset: Ok(dataset),
            });
        }
        parts.sort_by(|a, b| alphanumeric_sort::compare_str(&a.path, &b.path));
        Ok(Self(parts))
    }

    /// The part that is named, or the one that is meant where nothing is: the only array of three axes or more, or
    /// where there is none the only one at all. Coordinates and the tables of ITK are never meant.
    pub fn find(&self, name: Option<&str>) -> Result<&Part, VolumeError> {
        let images: HashSet<&str> = self
            .0
            .iter()
            .filter(|part| place::is_itk(part))
            .filter_map(|part| Some(part.path.rsplit_once('/')?.0))
            .collect();
        let of_image = |part: &Part| {
            let group = part.path.rsplit_once('/').map(|(group, _)| group);
            group.is_some_and(|group| images.contains(group)) && !place::is_itk(part)
        };
        let parts = self.0.iter().filter(|part| !of_image(part));
        let parts: Vec<(&Part, bool)> = parts
            .filter_map(|part| match &part.dataset {
                Ok(dataset) => is_array(dataset).then_some((part, dataset.ndim() >= 3)),
                // Who names it is told why it is not read.
                Err(_) => Some((part, false)),
            })
            .collect();
        if parts.is_empty() {
            return Err(VolumeError::MissingField(Trouble::new(
                "this HDF5 file has no array of numbers",
                "look into it with `h5dump -n`, and write the volume as an array",
            )));
        }
        let candidates: Vec<Candidate<'_>> = parts
            .iter()
            .map(|&(part, main)| Candidate {
                path: &part.path,
                main,
            })
            .collect();
        let chosen = choose(&candidates, name, "arrays in this HDF5 file")?;
        Ok(parts[chosen].0)
    }

    pub fn dataset<'p>(&self, part: &'p Part) -> Result<&'p Dataset, VolumeError> {
        part.dataset.as_ref().map_err(told)
    }

    /// The array at a path.
    pub fn at(&self, path: &str) -> Option<&Dataset> {
        let part = self.0.iter().find(|part| part.path == path)?;
        part.dataset.as_ref().ok()
    }

    /// The scale of each axis of an array, where it has one: HDF5's dimension scales, which NetCDF-4 makes of its
    /// dimensions.
    pub fn scales(&self, dataset: &Dataset, attributes: &Attributes) -> Vec<Option<Scale>> {
        let mut scales: Vec<Option<Scale>> = (0..dataset.ndim()).map(|_| None).collect();
        let Some(list) = attributes.get("DIMENSION_LIST") else {
            return scales;
        };
        let width = dataset.vlen_reference_size();
        // A length, an address and an index; the first is 4 bytes, and so is the last.
        let Ok(address_size) = u8::try_from(width.saturating_sub(8)) else {
            return scales;
        };
        for (scale, reference) in scales.iter_mut().zip(list.raw_data.chunks_exact(width)) {
            let target = dataset.resolve_vlen_reference_bytes(reference, address_size.into());
            let address = target.and_then(|bytes| resolve_object_reference(&bytes, address_size));
            let part = address.ok().and_then(|address| {
                let at = |part: &&Part| {
                    let dataset = part.dataset.as_ref();
                    dataset.is_ok_and(|dataset| dataset.address() == address)
                };
                self.0.iter().find(at)
            });
            *scale = part.and_then(Scale::of);
        }
        scales
    }
}

impl Part {
    pub fn name(&self) -> &str {
        self.path.rsplit('/').next().unwrap_or_default()
    }
}

/// Whether voxels may be meant: numbers along axes, and no scale of other arrays.
fn is_array(dataset: &Dataset) -> bool {
    let is_scale = || {
        let attributes = Attributes::of(dataset.attributes());
        attributes.text("CLASS").as_deref() == Some("DIMENSION_SCALE")
    };
    dataset.ndim() > 0
        && !dataset.shape().contains(&0)
        && element::scalar(dataset.dtype()).is_some()
        && !is_scale()
}

/// What an axis is called and counted in.
pub(super) struct Scale {
    pub name: String,
    /// The values along the axis; `None` for a dimension that has none, or others than numbers.
    pub values: Option<Vec<f64>>,
    pub unit: Option<String>,
}

/// Most values of a scale.
const MOST_VALUES: u64 = 1 << 20;

impl Scale {
    fn of(part: &Part) -> Option<Self> {
        let dataset = part.dataset.as_ref().ok()?;
        let attributes = Attributes::of(dataset.attributes());
        // What NetCDF-4 writes for dimensions without coordinates.
        let named = attributes.text("NAME").unwrap_or_default();
        let bare = named.starts_with("This is a netCDF dimension but not a netCDF variable");
        let few = dataset
            .num_elements()
            .is_ok_and(|count| count <= MOST_VALUES);
        let values = (!bare && few && dataset.ndim() == 1)
            .then(|| dataset.read_array::<element::Number>().ok())
            .flatten();
        Some(Self {
            name: cut(part.name()),
            values: values.map(|values| values.iter().map(|number| number.0).collect()),
            unit: attributes.text("units"),
        })
    }
}
