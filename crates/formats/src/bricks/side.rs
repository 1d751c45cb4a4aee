//! `bricks.bin` in the folder of a pyramid: what is known of every brick and of the volume, and what it was built of.
//!
//! Sixteen bytes of magic; version and length of the header (two u32); the header in JSON (source, dimensions, type,
//! edge of the bricks, where levels lie); four float64 (min, max, mean, standard deviation), four u64 (finite, not a
//! number, plus and minus infinite), 4096 u64 (bins); then of every brick, level by level and x fastest, four float32
//! (min, max, rms and largest error); CRC-32C of all that. Numbers are little-endian. The header's dimensions say how
//! long the file must be, and it is held against that before anything else is made of it.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use volgraph_volume::{Histogram, ScalarType, Trouble, VolumeError, brick_dims};

use super::source::Tie;
use super::{BrickInfo, BrickStatistics};

pub(super) const FILE: &str = "bricks.bin";
const MAGIC: &[u8; 16] = b"volgraph-bricks\0";
const VERSION: u32 = 1;
/// Bins of the histogram.
pub(super) const BINS: usize = 4096;
/// Bytes of magic, version and length of the header.
const HEAD: usize = 24;

/// Everything in the side file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Side {
    /// The source's path from the folder that holds the pyramid's.
    pub source: String,
    pub tie: Tie,
    pub dims: [u32; 3],
    pub scalar_type: ScalarType,
    pub edge: u32,
    /// The finest level that lies in the folder; those before it are the source's own.
    pub first: u32,
    pub statistics: BrickStatistics,
    /// Of each level.
    pub bricks: Vec<Vec<Packed>>,
}

/// What is known of a brick, rounded to float32 so that it stays true.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Packed(pub [f32; 4]);

impl Packed {
    pub fn new(min: f64, max: f64, rms: f64, largest: f64) -> Self {
        Self([down(min), -down(-max), -down(-rms), -down(-largest)])
    }

    pub fn info(self) -> BrickInfo {
        let [min, max, rms_error, max_error] = self.0.map(f64::from);
        BrickInfo {
            min,
            max,
            rms_error,
            max_error,
        }
    }

    fn is_sound(self) -> bool {
        let [min, max, rms, largest] = self.0;
        min <= max && rms >= 0.0 && largest >= 0.0
    }
}

/// The largest float32 that is not larger.
#[expect(
    clippy::cast_possible_truncation,
    reason = "it is what the function is for"
)]
fn down(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) > value {
        near.next_down()
    } else {
        near
    }
}

/// Bricks of each level.
pub(super) fn counts(dims: [u32; 3], edge: u32) -> Vec<u64> {
    let count = |dims: [u32; 3]| {
        let bricks = brick_dims(dims, edge).map(u64::from);
        bricks
            .iter()
            .fold(1, |product: u64, &n| product.saturating_mul(n))
    };
    let mut dims = dims;
    let mut counts = vec![count(dims)];
    while dims.iter().any(|&n| n > edge) {
        dims = dims.map(|n| n.div_ceil(2));
        counts.push(count(dims));
    }
    counts
}

/// Refuses an edge that bricks cannot have.
pub(super) fn check_edge(edge: u32) -> Result<(), VolumeError> {
    if edge.is_power_of_two() && (4..=256).contains(&edge) {
        return Ok(());
    }
    Err(VolumeError::Option(Trouble::new(
        format!("bricks of {edge} voxels along each edge"),
        "give a power of two from 4 to 256",
    )))
}

impl Side {
    pub fn to_bytes(&self) -> Vec<u8> {
        let header = json!({
            "source": self.source,
            "len": self.tie.len,
            "modified": self.tie.modified,
            "digest": self.tie.digest,
            "dims": self.dims,
            "type": self.scalar_type.name(),
            "edge": self.edge,
            "first": self.first,
        })
        .to_string();
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((header.len() as u32).to_le_bytes());
        bytes.extend(header.as_bytes());
        let all = &self.statistics;
        for value in [all.min, all.max, all.mean, all.standard_deviation] {
            bytes.extend(value.to_le_bytes());
        }
        let counts = [
            all.finite_count,
            all.nan_count,
            all.positive_infinity_count,
            all.negative_infinity_count,
        ];
        for count in counts.iter().chain(&all.histogram.counts) {
            bytes.extend(count.to_le_bytes());
        }
        for packed in self.bricks.iter().flatten() {
            packed
                .0
                .iter()
                .for_each(|value| bytes.extend(value.to_le_bytes()));
        }
        bytes.extend(crc32c::crc32c(&bytes).to_le_bytes());
        bytes
    }

    /// The side file of a pyramid.
    pub fn read(folder: &Path) -> Result<Self, VolumeError> {
        let file = folder.join(FILE);
        let bytes = fs::read(&file).map_err(|error| {
            VolumeError::DataFile(Trouble::new(
                format!("cannot be read: {error}"),
                "build the pyramid again",
            ))
            .in_file(&file)
        })?;
        Self::of_bytes(&bytes).map_err(|error| error.in_file(&file))
    }

    pub fn of_bytes(bytes: &[u8]) -> Result<Self, VolumeError> {
        let broken =
            |cause: &str| VolumeError::DataCorrupt(Trouble::new(cause, "build the pyramid again"));
        let (Some(MAGIC), Some(head)) = (bytes.first_chunk::<16>(), bytes.get(16..HEAD)) else {
            return Err(broken("is no table of bricks"));
        };
        let number = |bytes: &[u8]| bytes.try_into().map_or(0, u32::from_le_bytes);
        let version = number(&head[..4]);
        if version != VERSION {
            return Err(VolumeError::Unsupported(Trouble::new(
                format!("a table of bricks of version {version}, and {VERSION} is read here"),
                "build the pyramid again",
            )));
        }
        let Some((body, checksum)) = bytes.split_last_chunk::<4>() else {
            return Err(broken("is cut off"));
        };
        if crc32c::crc32c(body) != u32::from_le_bytes(*checksum) {
            return Err(broken(
                "its checksum is another: it is cut off or was changed",
            ));
        }
        let length = number(&head[4..]) as usize;
        let rest = body.get(HEAD..).unwrap_or_default();
        let Some((header, rest)) = rest.split_at_checked(length) else {
            return Err(broken("its header is longer than the file"));
        };
        let header: Value = serde_json::from_slice(header)
            .map_err(|error| broken(&format!("its header is no JSON: {error}")))?;
        let mut side =
            Self::of_header(&header).ok_or_else(|| broken("its header lacks something"))?;
        side.take_numbers(rest).ok_or_else(|| {
            broken("its numbers make no sense, or are not as many as the dimensions say")
        })?;
        Ok(side)
    }

    fn of_header(header: &Value) -> Option<Self> {
        let text = |key: &str| header.get(key)?.as_str().map(str::to_owned);
        let number = |value: &Value| u32::try_from(value.as_u64()?).ok();
        let dims = header.get("dims")?.as_array()?.iter().map(number);
        let dims = <[u32; 3]>::try_from(dims.collect::<Option<Vec<u32>>>()?).ok()?;
        let edge = number(header.get("edge")?)?;
        check_edge(edge).ok()?;
        let scalar_type = text("type")?;
        Some(Self {
            source: text("source")?,
            tie: Tie {
                len: header.get("len")?.as_u64()?,
                modified: header.get("modified")?.as_u64()?,
                digest: text("digest")?,
            },
            dims: Some(dims).filter(|dims| !dims.contains(&0))?,
            scalar_type: ScalarType::ALL
                .into_iter()
                .find(|ty| ty.name() == scalar_type)?,
            edge,
            first: number(header.get("first")?)?,
            statistics: BrickStatistics::default(),
            bricks: Vec::new(),
        })
    }

    /// The numbers behind the header, which must be just as many as it says.
    fn take_numbers(&mut self, rest: &[u8]) -> Option<()> {
        let (eights, tables) = rest.split_at_checked((8 + BINS) * 8)?;
        let counts = counts(self.dims, self.edge);
        let total = counts
            .iter()
            .try_fold(0_u64, |sum, &count| sum.checked_add(count))?;
        if total.checked_mul(16)? != tables.len() as u64 || self.first as usize > counts.len() {
            return None;
        }
        let (eights, _) = eights.as_chunks::<8>();
        let (reals, whole) = eights.split_at(4);
        let whole: Vec<u64> = whole
            .iter()
            .map(|bytes| u64::from_le_bytes(*bytes))
            .collect();
        let (few, bins) = whole.split_at(4);
        let [min, max, mean, standard_deviation] =
            [0, 1, 2, 3].map(|i| f64::from_le_bytes(reals[i]));
        let known = few[0] > 0;
        if known && !(min <= mean && mean <= max && min.is_finite() && max.is_finite()) {
            return None;
        }
        self.statistics = BrickStatistics {
            min,
            max,
            mean,
            standard_deviation,
            finite_count: few[0],
            nan_count: few[1],
            positive_infinity_count: few[2],
            negative_infinity_count: few[3],
            histogram: Histogram {
                lo: if known { min } else { 0.0 },
                hi: if known { max } else { 0.0 },
                counts: bins.to_vec(),
            },
        };
        let (fours, _) = tables.as_chunks::<4>();
        let (bricks, _) = fours.as_chunks::<4>();
        let mut bricks = bricks
            .iter()
            .map(|four| Packed(four.map(f32::from_le_bytes)));
        for count in counts {
            let level: Vec<Packed> = bricks.by_ref().take(count as usize).collect();
            if !level.iter().all(|brick| brick.is_sound()) {
                return None;
            }
            self.bricks.push(level);
        }
        Some(())
    }
}
