//! The values of all pieces, put together.
//!
//! A piece that is the whole is read as it is. Others are read one after the other and copied to their places; at
//! points, neighbours share a layer. Vectors grow with what the file delivers, never by its word.

use std::io::Read;

use volgraph_volume::{Element, ScalarType, Trouble, VolumeError, Voxels, for_scalar_type};

use super::blocks;
use super::header::{Coding, Place};
use crate::contents::Data;
use crate::input::Input;
use crate::load::Limits;
use crate::piece::read_block;
use crate::text_data::{TextError, read_numbers};

/// Bytes read between two reports of progress, and the first step of a growing vector.
const STEP: usize = 1 << 22;

/// Pieces of points share layers: so many times may a sample be in the file at most (8 at a corner).
const MOST_SHARED: u64 = 8;

/// The array of a piece.
#[derive(Debug)]
pub(super) struct Span {
    /// The place of its first sample in the whole.
    pub from: [u32; 3],
    pub dims: [u32; 3],
    pub place: Place,
}

impl Span {
    fn count(&self, components: u64) -> u64 {
        let dims = self.dims.iter();
        dims.fold(components, |product, &dim| {
            product.saturating_mul(dim.into())
        })
    }
}

/// The way to the values of one array.
pub(super) struct Pieces<'a> {
    pub input: Input<'a>,
    pub coding: Coding,
    pub spans: Vec<Span>,
    pub scalar_type: ScalarType,
    pub components: u64,
    pub dims: [u32; 3],
    /// Values of the whole, components with them.
    pub count: u64,
    /// For messages: `30×30×30 int16`.
    pub what: String,
}

impl Data for Pieces<'_> {
    fn read(&self, _step: u32, limits: &Limits) -> Result<Voxels, VolumeError> {
        let bytes = u128::from(self.count) * self.scalar_type.size() as u128;
        if bytes > u128::from(limits.max_bytes) || usize::try_from(bytes).is_err() {
            return Err(VolumeError::TooLarge(Trouble::new(
                format!(
                    "{} are {bytes} bytes, more than the limit of {} bytes",
                    self.what, limits.max_bytes
                ),
                "correct the extent, or raise the limit (max_bytes) if it is right",
            )));
        }
        let counts = self.spans.iter().map(|span| span.count(self.components));
        let in_pieces = counts.fold(0, u64::saturating_add);
        if in_pieces < self.count || in_pieces / MOST_SHARED > self.count {
            return Err(VolumeError::BadValue(Trouble::new(
                format!(
                    "{} pieces have {in_pieces} values; the whole extent has {}",
                    self.spans.len(),
                    self.count
                ),
                "correct the extents: the pieces must cover the whole one, and share no more than their sides",
            )));
        }
        for_scalar_type!(self.scalar_type, T => self.read_typed::<T>(limits).map(T::wrap))
    }
}

impl Pieces<'_> {
    fn read_typed<T: Element>(&self, limits: &Limits) -> Result<Vec<T>, VolumeError> {
        if let [span] = self.spans.as_slice()
            && span.dims == self.dims
        {
            return self.span(span, 0, limits);
        }
        let mut parts: Vec<Vec<T>> = Vec::new();
        let mut done = 0;
        for span in &self.spans {
            let part = self.span(span, done, limits)?;
            done += part.len() * size_of::<T>();
            parts.push(part);
        }
        // The pieces were there, and they are as many values at least.
        let mut whole = vec![T::zeroed(); self.count as usize];
        let mut covered =
            vec![false; self.dims[1] as usize * self.dims[2] as usize * self.dims[0] as usize];
        let width = self.components as usize;
        let [nx, ny, _] = self.dims.map(|dim| dim as usize);
        for (span, part) in self.spans.iter().zip(&parts) {
            let [x, y, z] = span.from.map(|from| from as usize);
            let [px, py, _] = span.dims.map(|dim| dim as usize);
            for (row, values) in part.chunks_exact(px * width).enumerate() {
                let at = x + nx * (y + row % py + ny * (z + row / py));
                whole[at * width..(at + px) * width].copy_from_slice(values);
                covered[at..at + px].fill(true);
            }
        }
        if covered.contains(&false) {
            return Err(VolumeError::BadValue(Trouble::new(
                "the pieces do not cover the whole extent",
                "correct the extents, or save the image as one piece",
            )));
        }
        Ok(whole)
    }

    /// The values of one piece; `done` bytes were read before.
    fn span<T: Element>(
        &self,
        span: &Span,
        done: usize,
        limits: &Limits,
    ) -> Result<Vec<T>, VolumeError> {
        let count = span.count(self.components);
        let Ok(want) = usize::try_from(count) else {
            return Err(too_large(&self.what));
        };
        if let Place::Text { from, len } = span.place {
            return self.text(from, len, want);
        }
        let need = count.saturating_mul(size_of::<T>() as u64);
        let mut stream = blocks::open(&self.input, &self.coding, &span.place, need)?;
        let mut values = self.grown::<T>(&mut stream, want, done, limits)?;
        if self.coding.big_endian != cfg!(target_endian = "big") {
            values.iter_mut().for_each(|value| *value = value.swapped());
        }
        Ok(values)
    }

    fn text<T: Element>(&self, from: u64, len: u64, want: usize) -> Result<Vec<T>, VolumeError> {
        let short = |have: String| {
            VolumeError::DataTooShort(Trouble::new(
                format!("the array has {have}; its extent needs {want} numbers"),
                "the file is cut off, or the extent is wrong",
            ))
        };
        // Each number is a digit and a blank at least.
        if (want as u64).saturating_mul(2) > len.saturating_add(1) {
            return Err(short(format!("{len} bytes of text")));
        }
        let mut values = Vec::new();
        let read = read_numbers(self.input.open(from)?.take(len), want, &mut values);
        match read {
            Ok(got) if got == want => Ok(values),
            Ok(got) => Err(short(format!("{got} numbers"))),
            Err(TextError::Io(error)) => Err(self.input.unreadable(&error)),
            Err(TextError::TooMany) => Err(VolumeError::DataTooLong(Trouble::new(
                format!("the array has more than the {want} numbers of its extent"),
                "the extent or the number of components is wrong",
            ))),
            Err(TextError::BadNumber(token)) => Err(VolumeError::DataCorrupt(Trouble::new(
                format!("{token:?} is no {}", self.scalar_type),
                "write the values as numbers that fit the type, or correct the type",
            ))),
        }
    }

    /// Values of a stream; the vector at most doubles before the stream has shown more.
    fn grown<T: Element>(
        &self,
        stream: &mut dyn Read,
        want: usize,
        done: usize,
        limits: &Limits,
    ) -> Result<Vec<T>, VolumeError> {
        let mut values: Vec<T> = Vec::new();
        let mut stream = stream;
        while values.len() < want {
            let old = values.len();
            let step = (want - old).min(old.max(STEP / size_of::<T>()));
            values
                .try_reserve_exact(step)
                .map_err(|_| too_large(&self.what))?;
            values.resize(old + step, T::zeroed());
            for block in bytemuck::cast_slice_mut::<T, u8>(&mut values[old..]).chunks_mut(STEP) {
                let got = read_block(&mut stream, block);
                let got = got.map_err(|error| blocks::stream_error(&error, &self.input))?;
                if got < block.len() {
                    return Err(blocks::stream_error(
                        &std::io::ErrorKind::UnexpectedEof.into(),
                        &self.input,
                    ));
                }
            }
            let total = self.count * size_of::<T>() as u64;
            limits.report(
                ((done + values.len() * size_of::<T>()) as u64).min(total),
                total,
            );
        }
        Ok(values)
    }
}

fn too_large(what: &str) -> VolumeError {
    VolumeError::TooLarge(Trouble::new(
        format!("memory does not hold {what}"),
        "free memory, or use a smaller volume",
    ))
}
