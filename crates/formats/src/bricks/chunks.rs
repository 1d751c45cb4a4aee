//! A level into the chunks or shards of a Zarr array, box by box.

use volgraph_volume::{Grid, ScalarType, VolumeError, Voxels, for_voxels};

use crate::write::Compression;
use crate::write::target::TempFolder;
use crate::write::zarr::{Array, cut, pack, pretty};

/// An array that is being written.
pub(super) struct Target<'a> {
    folder: &'a TempFolder,
    number: usize,
    array: Array,
}

impl<'a> Target<'a> {
    /// Writes the array's metadata. `edge` is that of its chunks, `shard` how many chunks are in a shard along each axis.
    pub fn new(
        folder: &'a TempFolder,
        number: usize,
        grid: Grid,
        scalar_type: ScalarType,
        edge: u32,
        shard: Option<u32>,
        compression: Compression,
    ) -> Result<Self, VolumeError> {
        // No chunk is larger than its array.
        let chunk = grid.dims.map(|n| n.min(edge));
        let array = Array {
            grid,
            scalar_type,
            chunk,
            shard: shard.map(|n| chunk.map(|edge| edge * n)),
            compression,
            colors: false,
        };
        folder.put(&format!("{number}/zarr.json"), &pretty(&array.metadata()))?;
        Ok(Self {
            folder,
            number,
            array,
        })
    }

    /// Writes the chunks, or whole shards, of a box that begins with one of them.
    pub fn put(
        &self,
        voxels: &Voxels,
        origin: [u32; 3],
        size: [u32; 3],
    ) -> Result<(), VolumeError> {
        let unit = self.array.shard.unwrap_or(self.array.chunk);
        let counts = [0, 1, 2].map(|i| size[i].div_ceil(unit[i]));
        each(counts, |index| {
            let low = [0, 1, 2].map(|i| index[i] * unit[i]);
            let bytes = match self.array.shard {
                None => self.chunk(voxels, size, low)?,
                Some(shard) => self.shard(voxels, size, low, shard)?,
            };
            let [x, y, z] = [0, 1, 2].map(|i| origin[i] / unit[i] + index[i]);
            let name = format!("{}/c/{z}/{y}/{x}", self.number);
            self.folder.put(&name, &bytes)
        })
    }

    #[expect(
        clippy::redundant_closure_for_method_calls,
        reason = "the method is another one for each type"
    )]
    fn chunk(
        &self,
        voxels: &Voxels,
        size: [u32; 3],
        low: [u32; 3],
    ) -> Result<Vec<u8>, VolumeError> {
        let [size, low, chunk] =
            [size, low, self.array.chunk].map(|three| three.map(|n| n as usize));
        let (bytes, _) = for_voxels!(voxels, values => {
            cut(values, size, low, chunk, |value| value.to_le_bytes())
        });
        pack(&bytes, self.array.compression)
    }

    /// Chunks one after the other, then where each begins and how long it is (all ones where there is none), then the
    /// CRC-32C of that. Source: <https://zarr-specs.readthedocs.io/en/latest/v3/codecs/sharding-indexed/>.
    fn shard(
        &self,
        voxels: &Voxels,
        size: [u32; 3],
        low: [u32; 3],
        shard: [u32; 3],
    ) -> Result<Vec<u8>, VolumeError> {
        let counts = [0, 1, 2].map(|i| shard[i] / self.array.chunk[i]);
        let (mut bytes, mut index) = (Vec::new(), Vec::new());
        each(counts, |at| {
            let at = [0, 1, 2].map(|i| low[i] + at[i] * self.array.chunk[i]);
            let mut entry = [u64::MAX; 2];
            if (0..3).all(|i| at[i] < size[i]) {
                let packed = self.chunk(voxels, size, at)?;
                entry = [bytes.len() as u64, packed.len() as u64];
                bytes.extend(packed);
            }
            entry
                .iter()
                .for_each(|number| index.extend(number.to_le_bytes()));
            Ok(())
        })?;
        bytes.extend(&index);
        bytes.extend(crc32c::crc32c(&index).to_le_bytes());
        Ok(bytes)
    }
}

/// Every index below the counts, x fastest.
pub(super) fn each(
    counts: [u32; 3],
    mut call: impl FnMut([u32; 3]) -> Result<(), VolumeError>,
) -> Result<(), VolumeError> {
    for z in 0..counts[2] {
        for y in 0..counts[1] {
            for x in 0..counts[0] {
                call([x, y, z])?;
            }
        }
    }
    Ok(())
}
