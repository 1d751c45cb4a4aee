//! What a pre-integrated table is made of, in a row, for whoever composites it elsewhere (`node/preintegration.wgsl`).

use super::cells::Cells;
use super::check;
use super::piece::Piece;
use crate::post::node;
use crate::{OpticsError, TransferFunction};

/// The pieces of all cells between the entries of a 2D pre-integrated table.
///
/// A piece is followed by its halves, theirs included, where it has any: whoever finds it too deep goes on to the next
/// in the row, who does not goes to [`next`](PreintegrationPiece::next).
#[derive(Clone, Debug, PartialEq)]
pub struct PreintegrationPieces {
    /// Of each entry: its colour, the optical depth of a segment that has its scalar all along, and the number of the
    /// first piece behind it, towards higher scalars (of the last entry: how many pieces there are).
    pub entries: Vec<([f32; 4], u32)>,
    /// The pieces.
    pub pieces: Vec<PreintegrationPiece>,
}

/// A part of a cell; see [`PreintegrationPieces`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreintegrationPiece {
    /// Its optical depth where its cell is the whole segment.
    pub depth: f32,
    /// The share of the segment up to which its cell is good enough as one.
    pub longest: f32,
    /// The number of the piece behind it and its halves.
    pub next: u32,
    /// Its colour over the share `x` of its depth: `mean + slope (x - ½) + curve (x² - x + ⅙)`.
    pub mean: [f32; 3],
    /// See [`mean`](Self::mean).
    pub slope: [f32; 3],
    /// See [`mean`](Self::mean).
    pub curve: [f32; 3],
}

impl TransferFunction {
    /// What [`preintegrated_table`](TransferFunction::preintegrated_table) is made of, in float32.
    ///
    /// # Errors
    /// [`OpticsError::TableSize`], [`OpticsError::SegmentLength`].
    pub fn preintegration_pieces(
        &self,
        n: u32,
        segment_length: f64,
    ) -> Result<PreintegrationPieces, OpticsError> {
        check(n, segment_length)?;
        let cells = Cells::integrate(self, n, segment_length, 0.0);
        let mut flat = PreintegrationPieces {
            entries: Vec::with_capacity(n as usize),
            pieces: Vec::new(),
        };
        for i in 0..n {
            let s = node(self.range(), n, i);
            let [r, g, b] = self.color(s);
            let entry = [r, g, b, self.extinction(s) * segment_length].map(|value| value as f32);
            flat.entries.push((entry, flat.next()));
            if i + 1 < n {
                for piece in cells.pieces(i as usize) {
                    flat.push(piece, segment_length);
                }
            }
        }
        Ok(flat)
    }
}

impl PreintegrationPieces {
    fn next(&self) -> u32 {
        u32::try_from(self.pieces.len()).unwrap_or(u32::MAX)
    }

    fn push(&mut self, piece: &Piece<3>, segment_length: f64) {
        let at = self.pieces.len();
        let values = |values: [f64; 3]| values.map(|value| value as f32);
        self.pieces.push(PreintegrationPiece {
            depth: (piece.extinction * piece.share * segment_length) as f32,
            longest: (piece.longest / segment_length).min(f64::from(f32::MAX)) as f32,
            next: 0,
            mean: values(piece.mean),
            slope: values(piece.slope),
            curve: values(piece.curve),
        });
        match &piece.halves {
            Some(halves) => halves
                .iter()
                .for_each(|half| self.push(half, segment_length)),
            None => self.pieces[at].longest = f32::MAX,
        }
        self.pieces[at].next = self.next();
    }
}
