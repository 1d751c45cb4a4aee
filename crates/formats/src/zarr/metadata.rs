//! What a folder of a Zarr hierarchy says: a group with attributes, or an array, of version 2 or 3.
//!
//! The JSON is read by the crate `zarrs_metadata`; here it becomes plain values that were checked one by one.

use std::path::{Component, Path, PathBuf};

use serde_json::{Map, Value};
use volgraph_volume::{Trouble, VolumeError};
use zarrs_metadata::v2::{ArrayMetadataV2, ArrayMetadataV2Order, DataTypeMetadataV2};
use zarrs_metadata::v3::{ArrayMetadataV3, GroupMetadataV3};

use super::codecs::Codecs;
use super::element::{Stored, fill_bytes, type_of_v2, type_of_v3, unknown_type};
use super::store::Store;

/// Most bytes of a metadata file.
pub(super) const LONGEST: u64 = 16 << 20;

/// Most axes of an array.
const MOST_AXES: usize = 16;

/// What a folder is.
#[derive(Debug)]
pub(super) enum Node {
    Group { attributes: Map<String, Value> },
    Array(Box<Meta>),
}

/// An array's metadata.
#[derive(Debug)]
pub(super) struct Meta {
    pub version: u8,
    pub shape: Vec<u64>,
    pub chunk: Vec<u64>,
    pub element: Stored,
    /// The fill value in the machine's byte order.
    pub fill: Vec<u8>,
    pub codecs: Codecs,
    pub keys: Keys,
    /// Names of the axes, where they are said.
    pub names: Option<Vec<Option<String>>>,
    pub attributes: Map<String, Value>,
    /// The file that says it.
    pub file: PathBuf,
}

/// How a chunk's indices become the name of its file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Keys {
    /// `c/0/1` instead of `0/1`.
    prefix: bool,
    separator: char,
}

impl Keys {
    pub fn name(self, index: &[u64]) -> String {
        let numbers: Vec<String> = index.iter().map(u64::to_string).collect();
        let joined = numbers.join(&self.separator.to_string());
        match (self.prefix, joined.is_empty()) {
            (true, true) => "c".to_owned(),
            (true, false) => format!("c{}{joined}", self.separator),
            (false, true) => "0".to_owned(),
            (false, false) => joined,
        }
    }
}

pub(super) fn bad(what: impl Into<String>) -> VolumeError {
    VolumeError::BadValue(Trouble::new(
        what,
        "correct the metadata, or write the array again",
    ))
}

/// The folder that a path inside of the hierarchy names; it may not lead out of it.
pub(super) fn inside(root: &Path, path: &str) -> Result<PathBuf, VolumeError> {
    let normal = |part: Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
    if Path::new(path).components().all(normal) && !path.contains('\0') {
        return Ok(root.join(path));
    }
    Err(bad(format!("the path {path:?} leads out of the folder")))
}

/// What a folder is; `None` where it has no Zarr metadata.
pub(super) fn node(store: &Store, folder: &Path) -> Result<Option<Node>, VolumeError> {
    let file = folder.join("zarr.json");
    if let Some(value) = json(store, &file)? {
        return of_v3(value, &file)
            .map(Some)
            .map_err(|error| error.in_file(&file));
    }
    let attributes = |default: Map<String, Value>| -> Result<Map<String, Value>, VolumeError> {
        Ok(match json(store, &folder.join(".zattrs"))? {
            Some(Value::Object(attributes)) => attributes,
            _ => default,
        })
    };
    let file = folder.join(".zarray");
    if let Some(value) = json(store, &file)? {
        let meta = of_v2(value, &file).and_then(|meta| {
            let attributes = attributes(meta.attributes.clone())?;
            Ok(Meta { attributes, ..meta })
        });
        let meta = meta.map_err(|error| error.in_file(&file))?;
        return Ok(Some(Node::Array(Box::new(meta))));
    }
    if [".zgroup", ".zattrs"]
        .iter()
        .any(|name| store.has(&folder.join(name)))
    {
        return Ok(Some(Node::Group {
            attributes: attributes(Map::new())?,
        }));
    }
    Ok(None)
}

/// A file's JSON; `None` where there is no such file.
fn json(store: &Store, file: &Path) -> Result<Option<Value>, VolumeError> {
    if !store.has(file) {
        return Ok(None);
    }
    let Some(open) = store.open(file, LONGEST)? else {
        return Ok(None);
    };
    if open.len() > LONGEST {
        let cause = format!("metadata of more than {LONGEST} bytes");
        let remedy = "check the file, its permissions and the disk";
        return Err(VolumeError::Unreadable(Trouble::new(cause, remedy)).in_file(file));
    }
    let bytes = open.read_all().map_err(|error| error.in_file(file))?;
    serde_json::from_slice(&bytes).map(Some).map_err(|error| {
        VolumeError::HeaderSyntax(Trouble::new(
            format!("is no valid JSON: {error}"),
            "correct the file, or write the array again",
        ))
        .on_line(u32::try_from(error.line()).unwrap_or(0))
        .in_file(file)
    })
}

fn syntax(error: &serde_json::Error) -> VolumeError {
    VolumeError::HeaderSyntax(Trouble::new(
        format!("is no Zarr metadata: {error}"),
        "correct the file, or write the array again",
    ))
}

fn of_v3(value: Value, file: &Path) -> Result<Node, VolumeError> {
    if value.get("node_type").and_then(Value::as_str) == Some("group") {
        let group: GroupMetadataV3 =
            serde_json::from_value(value).map_err(|error| syntax(&error))?;
        return Ok(Node::Group {
            attributes: group.attributes,
        });
    }
    let array: ArrayMetadataV3 = serde_json::from_value(value).map_err(|error| syntax(&error))?;
    let rank = checked_rank(&array.shape)?;
    if !array.storage_transformers.is_empty() {
        return Err(VolumeError::Unsupported(Trouble::new(
            "storage transformers are not read",
            "save the array without them",
        )));
    }
    let element = type_of_v3(array.data_type.name())?;
    let grid = &array.chunk_grid;
    let chunk = grid
        .configuration()
        .filter(|_| grid.name() == "regular")
        .and_then(|config| config.get("chunk_shape"))
        .and_then(Value::as_array)
        .and_then(|list| list.iter().map(Value::as_u64).collect::<Option<Vec<u64>>>());
    let chunk = chunk.ok_or_else(|| {
        VolumeError::Unsupported(Trouble::new(
            format!("the chunk grid {:?} is not read", grid.name()),
            "save the array with chunks of one shape",
        ))
    })?;
    let encoding = &array.chunk_key_encoding;
    let separator = encoding
        .configuration()
        .and_then(|config| config.get("separator"));
    let separator = separator.and_then(Value::as_str);
    let keys = match (encoding.name(), separator) {
        ("default", None | Some("/")) => Keys {
            prefix: true,
            separator: '/',
        },
        ("default", Some(".")) => Keys {
            prefix: true,
            separator: '.',
        },
        ("v2", None | Some(".")) => Keys {
            prefix: false,
            separator: '.',
        },
        ("v2", Some("/")) => Keys {
            prefix: false,
            separator: '/',
        },
        (name, _) => return Err(bad(format!("the chunk key encoding {name:?} is unknown"))),
    };
    let fill = serde_json::to_value(&array.fill_value).unwrap_or_default();
    let meta = Meta {
        version: 3,
        chunk: checked_chunk(chunk, rank)?,
        fill: fill_bytes(&fill, element)?,
        element,
        codecs: Codecs::of_v3(&array.codecs, rank)?,
        keys,
        names: array.dimension_names.filter(|names| names.len() == rank),
        attributes: array.attributes,
        shape: array.shape,
        file: file.to_path_buf(),
    };
    if let Some(shard) = &meta.codecs.shard
        && meta
            .chunk
            .iter()
            .zip(&shard.chunk)
            .any(|(outer, inner)| outer % inner != 0)
    {
        return Err(bad(format!(
            "shards of {:?} do not hold whole chunks of {:?}",
            meta.chunk, shard.chunk
        )));
    }
    Ok(Node::Array(Box::new(meta)))
}

fn of_v2(value: Value, file: &Path) -> Result<Meta, VolumeError> {
    let array: ArrayMetadataV2 = serde_json::from_value(value).map_err(|error| syntax(&error))?;
    let rank = checked_rank(&array.shape)?;
    let DataTypeMetadataV2::Simple(dtype) = &array.dtype else {
        return Err(unknown_type("a structure"));
    };
    let (element, big_endian) = type_of_v2(dtype)?;
    if let Some(filter) = array.filters.iter().flatten().next() {
        return Err(VolumeError::Unsupported(Trouble::new(
            format!("the filter {:?} is not read here", filter.id()),
            "save the array without filters",
        )));
    }
    let fill = serde_json::to_value(&array.fill_value).unwrap_or_default();
    let column_major = array.order == ArrayMetadataV2Order::F;
    let compressor = array
        .compressor
        .as_ref()
        .map(zarrs_metadata::v2::MetadataV2::id);
    let chunk = array.chunks.iter().map(|n| n.get()).collect();
    Ok(Meta {
        version: 2,
        chunk: checked_chunk(chunk, rank)?,
        fill: fill_bytes(&fill, element)?,
        element,
        codecs: Codecs::of_v2(rank, column_major, big_endian, compressor)?,
        keys: Keys {
            prefix: false,
            separator: match array.dimension_separator {
                zarrs_metadata::ChunkKeySeparator::Slash => '/',
                zarrs_metadata::ChunkKeySeparator::Dot => '.',
            },
        },
        names: None,
        attributes: array.attributes,
        shape: array.shape,
        file: file.to_path_buf(),
    })
}

fn checked_rank(shape: &[u64]) -> Result<usize, VolumeError> {
    if !(1..=MOST_AXES).contains(&shape.len()) {
        return Err(VolumeError::Unsupported(Trouble::new(
            format!(
                "an array of {} axes; 1 to {MOST_AXES} are read",
                shape.len()
            ),
            "save the array with fewer axes",
        )));
    }
    Ok(shape.len())
}

fn checked_chunk(chunk: Vec<u64>, rank: usize) -> Result<Vec<u64>, VolumeError> {
    if chunk.len() != rank || chunk.contains(&0) {
        return Err(bad(format!("chunks of {chunk:?} for {rank} axes")));
    }
    Ok(chunk)
}
