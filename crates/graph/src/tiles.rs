//! What is written in tiles: a texture that is too small for all that a node could put there, and that changes in part
//! from frame to frame.
//!
//! A node says which tiles its texture is to have ([`Tiles`]); who runs it knows which ones are there, and writes the
//! others. So the texture's memory goes on from frame to frame and from plan to plan, whatever fingerprints say.

use std::fmt;
use std::sync::Arc;

use serde::Serialize;
use volgraph_report::{Finding, Findings};

use crate::Extent;

/// What a tile holds, among all that any tile may hold: equal tags, equal texels.
pub type TileTag = [u64; 2];

/// Fills the texels of some tiles, given by their places in [`Tiles::tiles`], one after the other, x fastest.
type ReadTiles = dyn Fn(&[usize], &mut [u8]) -> Result<(), Finding> + Send + Sync;

/// The tiles that a texture is to have. What is in no tile may hold anything.
#[derive(Clone)]
pub struct Tiles {
    /// Width, height and depth of each in texels.
    pub extent: Extent,
    /// Where each starts, and what it holds.
    pub tiles: Arc<Vec<(Extent, TileTag)>>,
    read: Arc<ReadTiles>,
}

impl Tiles {
    /// No more bytes are read at a time, unless one tile is larger.
    pub const BATCH_BYTES: usize = 8 << 20;

    /// Wraps the function that reads the texels of some tiles, given by their places in the list.
    #[must_use]
    pub fn new(
        extent: Extent,
        tiles: Arc<Vec<(Extent, TileTag)>>,
        read: impl Fn(&[usize], &mut [u8]) -> Result<(), Finding> + Send + Sync + 'static,
    ) -> Self {
        Self {
            extent,
            tiles,
            read: Arc::new(read),
        }
    }

    /// Fills the texels of some tiles.
    ///
    /// # Errors
    /// Why they could not be read.
    pub fn read(&self, at: &[usize], texels: &mut [u8]) -> Result<(), Finding> {
        (self.read)(at, texels)
    }
}

impl fmt::Debug for Tiles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Tiles({} of {:?})", self.tiles.len(), self.extent)
    }
}

/// How far a node is whose result is made from frame to frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Progress {
    /// How much is there.
    pub ready: u64,
    /// How much there will be.
    pub wanted: u64,
}

impl Progress {
    /// Whether all is there.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.ready >= self.wanted
    }
}

/// What a node's result depends on beside its parameters and inputs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Changes whenever the result does.
    pub token: u64,
    /// How far the result is.
    pub progress: Progress,
    /// What the result is, in a few words for people.
    pub about: String,
    /// What people should know of it.
    pub warnings: Findings,
}
