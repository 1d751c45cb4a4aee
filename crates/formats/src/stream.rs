//! From the pieces of data that a header describes to typed voxels.
//!
//! A [`Job`] says how many elements of which type lie in which [`Piece`]s (one per data file). Before reading, what
//! is wanted is held against the limit, and a plain piece against its file's length. Then each piece is read: lines
//! and bytes skipped, the stream decoded, and the vector grown as the stream delivers, at most doubling, so that a
//! header's word alone allocates nothing. One byte more than expected is an error, one less too; behind the elements
//! of a time step a stream is not read on. Last, the byte order is turned where it is not the machine's.

use std::io::{self, ErrorKind, Read};
use std::path::PathBuf;

use bzip2::bufread::MultiBzDecoder;
use flate2::bufread::{MultiGzDecoder, ZlibDecoder};

use volgraph_volume::{Element, ScalarType, Trouble, VolumeError, Voxels, for_scalar_type};

use crate::load::Limits;
use crate::piece::{Encoding, Piece, read_block};
pub(crate) use crate::stored::{FileRun, Stored};
use crate::text_data;

/// Bytes read between two reports of progress, and the first step of a growing vector.
const STEP: usize = 1 << 22;

/// Everything to be read for one volume.
pub(crate) struct Job<'a> {
    pub pieces: Vec<Piece<'a>>,
    pub scalar_type: ScalarType,
    pub big_endian: bool,
    /// Elements in all pieces together; a multiple of their number.
    pub count: u64,
    /// What the elements are, for messages: `30×30×30 int16`.
    pub what: String,
}

impl Job<'_> {
    /// The files that hold the voxels.
    pub fn files(&self) -> Vec<PathBuf> {
        let files = self.pieces.iter().map(|piece| piece.input.path.clone());
        files.collect()
    }

    /// The elements of a run: from which one on, and how many.
    pub fn read(&self, run: (u64, u64), limits: &Limits) -> Result<Voxels, VolumeError> {
        let too_large = |cause: String, remedy: &str| {
            let error = VolumeError::TooLarge(Trouble::new(cause, remedy));
            match self.pieces.first() {
                Some(piece) => error.in_file(&piece.input.path),
                None => error,
            }
        };
        let bytes = u128::from(run.1) * self.scalar_type.size() as u128;
        if bytes > u128::from(limits.max_bytes) || usize::try_from(bytes).is_err() {
            return Err(too_large(
                format!(
                    "{} are {bytes} bytes, more than the limit of {} bytes",
                    self.what, limits.max_bytes
                ),
                "correct the dimensions, or raise the limit (max_bytes) if they are right",
            ));
        }
        for_scalar_type!(self.scalar_type, T => self.read_typed::<T>(run, limits).map(T::wrap))
    }

    /// Where the plain bytes of the only piece begin in its file, which has all of them; `None` where they are packed,
    /// or in several pieces, or in memory alone.
    pub fn plain_start(&self, limits: &Limits) -> Result<Option<u64>, VolumeError> {
        let [piece] = self.pieces.as_slice() else {
            return Ok(None);
        };
        if piece.encoding != Encoding::Raw || piece.encoded_len.is_some() || piece.input.is_memory()
        {
            return Ok(None);
        }
        let located = || {
            let (_, at) = piece.open()?;
            let rest = piece.input.len.saturating_sub(at);
            for_scalar_type!(self.scalar_type, T => {
                let sink = Sink::<T> {
                    job: self,
                    piece,
                    limits,
                    skip: 0,
                    want: 0,
                    whole: usize::try_from(self.count).unwrap_or(usize::MAX),
                    total: 0,
                    values: &mut Vec::new(),
                };
                sink.locate(at, rest)
            })
        };
        let start = located().map_err(|error: VolumeError| error.in_file(&piece.input.path))?;
        Ok(Some(start))
    }

    fn read_typed<T: Element>(
        &self,
        (from, count): (u64, u64),
        limits: &Limits,
    ) -> Result<Vec<T>, VolumeError> {
        let each = self.count / self.pieces.len().max(1) as u64;
        let mut values: Vec<T> = Vec::new();
        for (start, piece) in (0..).map(|i| i * each).zip(&self.pieces) {
            // The part of the run that lies in this piece.
            let begin = from.clamp(start, start + each) - start;
            let end = (from + count).clamp(start, start + each) - start;
            if begin == end && each > 0 {
                continue;
            }
            let mut sink = Sink {
                job: self,
                piece,
                limits,
                skip: begin as usize,
                want: (end - begin) as usize,
                whole: each as usize,
                total: count,
                values: &mut values,
            };
            sink.read()
                .map_err(|error| error.in_file(&piece.input.path))?;
        }
        if self.big_endian != cfg!(target_endian = "big")
            && self.pieces.iter().all(Piece::is_binary)
        {
            values.iter_mut().for_each(|value| *value = value.swapped());
        }
        Ok(values)
    }
}

/// Reads what is wanted of one piece to the end of the values.
struct Sink<'s, 'a, T> {
    job: &'s Job<'a>,
    piece: &'s Piece<'a>,
    limits: &'s Limits,
    /// Elements before those that are wanted.
    skip: usize,
    want: usize,
    /// Elements in the whole piece.
    whole: usize,
    /// Elements wanted of all pieces.
    total: u64,
    values: &'s mut Vec<T>,
}

impl<T: Element> Sink<'_, '_, T> {
    /// Bytes of the whole piece.
    fn whole_bytes(&self) -> u64 {
        (self.whole as u64).saturating_mul(size_of::<T>() as u64)
    }

    fn skip_len(&self) -> u64 {
        (self.skip as u64).saturating_mul(size_of::<T>() as u64)
    }

    fn read(&mut self) -> Result<(), VolumeError> {
        let (reader, at) = self.piece.open()?;
        let rest = self.piece.input.len.saturating_sub(at);
        let stream = match self.piece.encoded_len {
            Some(len) if len > rest => {
                return Err(VolumeError::DataTooShort(Trouble::new(
                    format!(
                        "the header promises {len} bytes of compressed data, the file has {rest}"
                    ),
                    "the file is cut off: fetch it again",
                )));
            }
            Some(len) => Box::new(reader.take(len)),
            None => reader,
        };
        match self.piece.encoding {
            Encoding::Raw => self.read_raw(at, rest),
            Encoding::Gzip => self.read_stream(MultiGzDecoder::new(stream)),
            Encoding::Zlib => self.read_stream(ZlibDecoder::new(stream)),
            Encoding::Bzip2 => self.read_stream(MultiBzDecoder::new(stream)),
            Encoding::Hex => self.read_stream(text_data::HexReader::new(stream)),
            Encoding::Text => {
                // Each number is a digit and a blank at least.
                if (self.whole as u64).saturating_mul(2) > rest.saturating_add(1) {
                    return Err(self.too_short(format_args!("{rest} bytes of text")));
                }
                let mut stream = stream;
                self.skip_bytes(&mut stream, self.piece.byte_skip.max(0) as u64)?;
                let start = self.values.len();
                let got = text_data::read_numbers(stream, self.whole, self.values)
                    .map_err(|trouble| self.text_error(trouble))?;
                if got < self.whole {
                    return Err(self.too_short(format_args!("{got} numbers")));
                }
                self.values.truncate(start + self.skip + self.want);
                self.values.drain(start..start + self.skip);
                self.report();
                Ok(())
            }
        }
    }

    /// Plain bytes: the length of the file tells everything before anything is allocated.
    fn read_raw(&mut self, at: u64, rest: u64) -> Result<(), VolumeError> {
        let from = self.locate(at, rest)?;
        let mut reader = self.piece.input.open(from + self.skip_len())?;
        self.fill(&mut reader, self.want)
    }

    /// Where the piece's plain bytes begin in its file, which has all of them.
    fn locate(&self, at: u64, rest: u64) -> Result<u64, VolumeError> {
        let want = self.whole_bytes();
        let skip = self.piece.byte_skip;
        let (from, have) = if skip >= 0 {
            let skip = skip as u64;
            (at.saturating_add(skip), rest.checked_sub(skip))
        } else {
            let behind = skip.unsigned_abs() - 1;
            let have = rest.checked_sub(behind).filter(|&have| have >= want);
            (
                at + have.unwrap_or(0).saturating_sub(want),
                have.map(|_| want),
            )
        };
        let have = have.ok_or_else(|| {
            self.too_short(format_args!(
                "{rest} bytes, of which a byte skip of {skip} leaves too few"
            ))
        })?;
        if have < want {
            return Err(self.too_short(format_args!("{have} bytes")));
        }
        if have > want && !self.only_a_line_end(from + want, have - want)? {
            return Err(self.too_long(format_args!("{have} bytes")));
        }
        Ok(from)
    }

    fn only_a_line_end(&self, at: u64, len: u64) -> Result<bool, VolumeError> {
        if !self.piece.line_end || len > 2 {
            return Ok(false);
        }
        let mut behind = Vec::new();
        let mut reader = self.piece.input.open(at)?;
        let read = reader.read_to_end(&mut behind);
        read.map_err(|error| self.piece.input.unreadable(&error))?;
        Ok(behind == b"\n" || behind == b"\r\n")
    }

    fn read_stream(&mut self, mut stream: impl Read) -> Result<(), VolumeError> {
        if self.piece.byte_skip < 0 {
            return self.read_tail(stream);
        }
        let skip = (self.piece.byte_skip as u64).saturating_add(self.skip_len());
        self.skip_bytes(&mut stream, skip)?;
        self.fill(&mut stream, STEP / size_of::<T>())?;
        // What is behind a part of the stream is not looked at: decoding it is all the work there is.
        if self.skip + self.want == self.whole && self.read_some(&mut stream, &mut [0])? != 0 {
            return Err(self.too_long(format_args!("more than {} bytes", self.whole_bytes())));
        }
        Ok(())
    }

    /// The last bytes of a stream whose length is known only at its end. What is kept stays below twice the
    /// wanted bytes; what passes is bounded by the limit.
    fn read_tail(&mut self, mut stream: impl Read) -> Result<(), VolumeError> {
        let behind = self.piece.byte_skip.unsigned_abs() - 1;
        let keep = usize::try_from(self.whole_bytes().saturating_add(behind)).unwrap_or(usize::MAX);
        let mut tail: Vec<u8> = Vec::new();
        let mut passed = 0_u64;
        let mut block = vec![0; STEP.min(1 << 16)];
        loop {
            let got = self.read_some(&mut stream, &mut block)?;
            if got == 0 {
                break;
            }
            passed += got as u64;
            if passed > self.limits.max_bytes {
                return Err(VolumeError::TooLarge(Trouble::new(
                    format!(
                        "the decoded stream passes the limit of {} bytes",
                        self.limits.max_bytes
                    ),
                    "raise the limit (max_bytes) if the file is right",
                )));
            }
            if tail.len() >= keep.saturating_mul(2).max(STEP) {
                tail.drain(..tail.len() - keep);
            }
            tail.extend_from_slice(&block[..got]);
        }
        if tail.len() < keep {
            return Err(self.too_short(format_args!("{} bytes", tail.len())));
        }
        let from = tail.len() - keep;
        let mut rest = &tail[from + self.skip * size_of::<T>()..];
        self.fill(&mut rest, self.want)
    }

    /// Appends the wanted elements; `first` is how many may be allocated before the stream has shown any.
    fn fill(&mut self, reader: &mut impl Read, first: usize) -> Result<(), VolumeError> {
        let start = self.values.len();
        let end = start + self.want;
        while self.values.len() < end {
            let old = self.values.len();
            let step = (end - old).min(first.max(old - start).max(1));
            if self.values.try_reserve_exact(step).is_err() {
                return Err(VolumeError::TooLarge(Trouble::new(
                    format!("memory does not hold {}", self.job.what),
                    "free memory, or use a smaller volume",
                )));
            }
            self.values.resize(old + step, T::zeroed());
            let mut done = old * size_of::<T>();
            let until = (old + step) * size_of::<T>();
            while done < until {
                let block_end = until.min(done + STEP);
                let bytes: &mut [u8] = bytemuck::cast_slice_mut(self.values);
                let got = read_block(reader, &mut bytes[done..block_end]);
                let got = got.map_err(|error| self.stream_error(&error))?;
                done += got;
                if done < block_end {
                    let have = done - start * size_of::<T>();
                    return Err(self.too_short(format_args!("{have} bytes")));
                }
                self.limits.report(done as u64, self.total_bytes());
            }
        }
        Ok(())
    }

    fn total_bytes(&self) -> u64 {
        self.total * size_of::<T>() as u64
    }

    fn report(&self) {
        let done = (self.values.len() * size_of::<T>()) as u64;
        self.limits.report(done, self.total_bytes());
    }

    fn skip_bytes(&self, stream: &mut impl Read, count: u64) -> Result<(), VolumeError> {
        let skipped = io::copy(&mut stream.take(count), &mut io::sink())
            .map_err(|error| self.stream_error(&error))?;
        if skipped < count {
            return Err(self.too_short(format_args!("{skipped} bytes, fewer than the byte skip")));
        }
        Ok(())
    }

    fn read_some(&self, stream: &mut impl Read, block: &mut [u8]) -> Result<usize, VolumeError> {
        loop {
            match stream.read(block) {
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                other => return other.map_err(|error| self.stream_error(&error)),
            }
        }
    }

    fn too_short(&self, have: std::fmt::Arguments<'_>) -> VolumeError {
        VolumeError::DataTooShort(Trouble::new(
            format!("holds {have}; {} need {}", self.job.what, self.needs()),
            "the file is cut off, or dimensions, type or skip are wrong",
        ))
    }

    fn too_long(&self, have: std::fmt::Arguments<'_>) -> VolumeError {
        VolumeError::DataTooLong(Trouble::new(
            format!("holds {have}; {} need {}", self.job.what, self.needs()),
            "dimensions, type or skip are wrong, or the file holds more than one volume (for data at the end of \
             a file say `byte skip: -1` in NRRD, `HeaderSize = -1` in MetaImage)",
        ))
    }

    fn needs(&self) -> String {
        let files = self.job.pieces.len();
        let in_each = if files > 1 { " in each file" } else { "" };
        if self.piece.is_binary() {
            format!("{} bytes{in_each}", self.whole_bytes())
        } else {
            format!("{} numbers{in_each}", self.whole)
        }
    }

    fn text_error(&self, error: text_data::TextError) -> VolumeError {
        match error {
            text_data::TextError::Io(error) => self.stream_error(&error),
            text_data::TextError::TooMany => {
                self.too_long(format_args!("more than {} numbers", self.whole))
            }
            text_data::TextError::BadNumber(token) => VolumeError::DataCorrupt(Trouble::new(
                format!("{token:?} is no {}", self.job.scalar_type),
                "write the voxels as numbers that fit the type, or correct the type",
            )),
        }
    }

    fn stream_error(&self, error: &io::Error) -> VolumeError {
        match error.kind() {
            ErrorKind::UnexpectedEof => self.too_short(format_args!("a stream that is cut off")),
            ErrorKind::InvalidData | ErrorKind::InvalidInput => {
                VolumeError::DataCorrupt(Trouble::new(
                    format!(
                        "the {:?} stream cannot be decoded: {error}",
                        self.piece.encoding
                    ),
                    "fetch the file again, or correct the encoding that the header states",
                ))
            }
            _ => self.piece.input.unreadable(error),
        }
    }
}
