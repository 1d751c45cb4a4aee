//! What is uploaded: bytes that are made when they are needed, and not before.
//!
//! Small things are made whole. A volume's texels would take as much memory as the volume again, or twice that: they are
//! made in pieces of some layers, each of which is on its way to the device before the next but one is made.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use volgraph_report::Finding;

/// Fills some layers of a texture (slices along z), x fastest, without row padding.
pub type FillLayers = Box<dyn FnMut(Range<u32>, &mut [u8]) -> Result<(), Finding>>;

type MakeBytes = dyn Fn() -> Result<Vec<u8>, Finding> + Send + Sync;
type BeginLayers = dyn Fn() -> Result<FillLayers, Finding> + Send + Sync;

/// Bytes made when they are needed, and not before.
#[derive(Clone)]
pub struct UploadBytes(Make);

#[derive(Clone)]
enum Make {
    Whole(Arc<MakeBytes>),
    Layers(Arc<BeginLayers>),
}

impl UploadBytes {
    /// No piece is larger, unless one layer is.
    pub const PIECE_BYTES: u64 = 8 << 20;

    /// Wraps the function that makes all of them at once.
    #[must_use]
    pub fn new(make: impl Fn() -> Result<Vec<u8>, Finding> + Send + Sync + 'static) -> Self {
        Self(Make::Whole(Arc::new(make)))
    }

    /// Wraps the function that begins an upload; what it returns is asked for layer after layer, from the first to the
    /// last, in pieces of at most [`Self::PIECE_BYTES`] or one layer, and dropped after the last.
    #[must_use]
    pub fn by_layers(
        begin: impl Fn() -> Result<FillLayers, Finding> + Send + Sync + 'static,
    ) -> Self {
        Self(Make::Layers(Arc::new(begin)))
    }

    /// Begins to make the bytes of a resource of so many layers with so many bytes each. A buffer is one layer.
    ///
    /// # Errors
    /// What the maker found wrong, and `internal` where it has made another number of bytes.
    pub fn pieces(&self, layers: u32, layer_bytes: u64) -> Result<Pieces, Finding> {
        let layer = usize::try_from(layer_bytes).unwrap_or(usize::MAX);
        let (source, at_once) = match &self.0 {
            Make::Whole(make) => {
                let bytes = make()?;
                let want = u64::from(layers).saturating_mul(layer_bytes);
                if bytes.len() as u64 != want {
                    let message = format!("{} bytes are uploaded into {want}", bytes.len());
                    return Err(Finding::error("internal", message));
                }
                (Made::Whole(bytes), layers_at_once(layer_bytes))
            }
            Make::Layers(begin) => (
                Made::Layers(begin()?, Vec::new()),
                layers_at_once(layer_bytes),
            ),
        };
        Ok(Pieces {
            source,
            layer,
            at_once,
            next: 0,
            layers,
        })
    }
}

fn layers_at_once(layer_bytes: u64) -> u32 {
    let layers = UploadBytes::PIECE_BYTES / layer_bytes.max(1);
    u32::try_from(layers).unwrap_or(u32::MAX).max(1)
}

impl fmt::Debug for UploadBytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("UploadBytes")
    }
}

/// The bytes of one upload, piece after piece.
pub struct Pieces {
    source: Made,
    /// Bytes of a layer.
    layer: usize,
    at_once: u32,
    next: u32,
    layers: u32,
}

enum Made {
    Whole(Vec<u8>),
    /// With the memory of the piece, which each piece uses again.
    Layers(FillLayers, Vec<u8>),
}

/// Some layers of what is uploaded.
#[derive(Debug, PartialEq, Eq)]
pub struct Piece<'a> {
    /// Which.
    pub layers: Range<u32>,
    /// Their bytes.
    pub bytes: &'a [u8],
}

impl Pieces {
    /// The next piece; `None` after the last.
    ///
    /// # Errors
    /// What the maker found wrong.
    pub fn next_piece(&mut self) -> Result<Option<Piece<'_>>, Finding> {
        let layers = self.next..self.layers.min(self.next.saturating_add(self.at_once));
        if layers.is_empty() {
            return Ok(None);
        }
        self.next = layers.end;
        let (start, end) = (
            layers.start as usize * self.layer,
            layers.end as usize * self.layer,
        );
        let bytes = match &mut self.source {
            Made::Whole(bytes) => bytes.get(start..end).unwrap_or_default(),
            Made::Layers(fill, piece) => {
                piece.resize(end - start, 0);
                fill(layers.clone(), piece)?;
                piece
            }
        };
        Ok(Some(Piece { layers, bytes }))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    fn all(bytes: &UploadBytes, layers: u32, layer_bytes: u64) -> Result<Vec<u8>, Finding> {
        let mut pieces = bytes.pieces(layers, layer_bytes)?;
        let mut all = Vec::new();
        while let Some(piece) = pieces.next_piece()? {
            assert_eq!(
                piece.bytes.len() as u64,
                piece.layers.len() as u64 * layer_bytes
            );
            all.extend_from_slice(piece.bytes);
        }
        Ok(all)
    }

    #[test]
    fn layers_are_asked_for_once_in_order_and_in_bounded_pieces() {
        // Layers of three eighths of a piece; ones that are larger than a piece; all in one piece; one of nothing.
        for (layers, layer_bytes, in_pieces) in [
            (5, UploadBytes::PIECE_BYTES * 3 / 8, vec![2, 2, 1]),
            (2, UploadBytes::PIECE_BYTES + 1, vec![1, 1]),
            (40, 3, vec![40]),
            (1, 0, vec![1]),
        ] {
            let asked = Arc::new(Mutex::new(Vec::new()));
            let noted = Arc::clone(&asked);
            let bytes = UploadBytes::by_layers(move || {
                let noted = Arc::clone(&noted);
                Ok(Box::new(move |layers, bytes| {
                    noted.lock().unwrap().push((layers.clone(), bytes.len()));
                    let layer = bytes.len() / layers.len();
                    for (at, byte) in bytes.iter_mut().enumerate() {
                        *byte = (layers.start as usize + at / layer) as u8;
                    }
                    Ok(())
                }))
            });
            let made = all(&bytes, layers, layer_bytes).unwrap();
            let truth = (0..layers).flat_map(|z| vec![z as u8; layer_bytes as usize]);
            assert!(made.into_iter().eq(truth), "{layers} of {layer_bytes}");
            let asked = asked.lock().unwrap();
            let counts: Vec<usize> = asked.iter().map(|(layers, _)| layers.len()).collect();
            assert_eq!(counts, in_pieces);
            for (layers, bytes) in asked.iter() {
                let bound = UploadBytes::PIECE_BYTES.max(layer_bytes);
                assert!(*bytes as u64 <= bound, "{layers:?}: {bytes}");
            }
        }
    }

    #[test]
    fn what_is_made_whole_has_to_fit_and_what_is_wrong_is_told() {
        let whole = UploadBytes::new(|| Ok((0..12).collect()));
        assert!(all(&whole, 3, 4).unwrap().into_iter().eq(0..12));
        assert_eq!(all(&whole, 4, 4).unwrap_err().code, "internal");
        let wrong = || Finding::error("bad", "it is bad");
        let failing = UploadBytes::new(move || Err(wrong()));
        assert_eq!(all(&failing, 3, 4).unwrap_err().code, "bad");
        let failing = UploadBytes::by_layers(move || Ok(Box::new(move |_, _| Err(wrong()))));
        assert_eq!(all(&failing, 3, 4).unwrap_err().code, "bad");
    }
}
