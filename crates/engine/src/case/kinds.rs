//! What may be expected of a picture, as data.

use std::path::PathBuf;

use volgraph_report::Place;

use super::{GraphName, Set};

/// What may be expected. Figures are of linear premultiplied RGBA: `rmse` the root of the mean squared error over all
/// components, `max` the largest error of one.
#[derive(Clone, Debug, PartialEq)]
pub enum ExpectationKind {
    /// Colour and opacity are finite and depth is a number, in every pixel.
    Finite,
    /// Something is drawn: this share of the pixels at least, 0 to 1, is not of the colour that most have in common.
    Seen {
        /// Least share of pixels.
        at_least: f64,
    },
    /// A pixel has these values.
    Pixel {
        /// Column and row, from the top left; the middle of the picture where `None`.
        at: Option<[u32; 2]>,
        /// What it has.
        values: Values,
        /// Largest error of any of them.
        max: f64,
    },
    /// All pixels of an area have these values; where none are given, those of its first pixel.
    Uniform {
        /// The area; the whole picture where `None`.
        within: Option<Area>,
        /// What they have.
        values: Values,
        /// Largest error of any of them.
        max: f64,
    },
    /// The graph's raycasts give the same picture in a fragment and in a compute shader.
    StagesAgree {
        /// Largest error allowed.
        max: f64,
    },
    /// All adapters of this machine give the same picture; not run where there is one alone.
    AdaptersAgree {
        /// Largest error allowed.
        max: f64,
    },
    /// The scene in a mirror, seen by a camera in the mirror, gives the picture in a mirror.
    Mirrored {
        /// The world axis across the mirror, which goes through the middle of the volume.
        axis: Axis,
        /// Largest error allowed.
        max: f64,
        /// Share of the pixels that may be worse: rounding moves edges. 0 to 1.
        except: f64,
    },
    /// A camera that is rolled by quarters gives the picture turned by as many.
    Rolled {
        /// How many, 1 to 3.
        quarters: u32,
        /// Largest error allowed.
        max: f64,
        /// Share of the pixels that may be worse: rounding moves edges. 0 to 1.
        except: f64,
    },
    /// The volume, rounded to 256 values, looks the same however the numbers are stored: as u8, u16 and f32.
    StoredAlike {
        /// Largest error allowed.
        max: f64,
    },
    /// The picture converges as a parameter is halved.
    Halving {
        /// Node and parameter.
        param: Param,
        /// The value that is halved; the case's or the graph's own where `None`.
        from: Option<f64>,
        /// How often, 1 to 8.
        times: u32,
        /// Largest error allowed between the last two pictures.
        rmse: f64,
        /// Least order of convergence p allowed, the error falling as step to the p: from a line fitted through the
        /// logarithms of the errors that [`Convergence`](volgraph_measure::Convergence) fits; not looked at where fewer
        /// than two are.
        order: Option<f64>,
    },
    /// The picture converges so fast as a parameter is halved.
    Order {
        /// Node and parameter.
        param: Param,
        /// The value that is halved; the case's or the graph's own where `None`.
        from: Option<f64>,
        /// How often, 2 to 8.
        halvings: u32,
        /// What errors are taken against.
        against: OrderAgainst,
        /// Least order of convergence.
        at_least: f64,
    },
    /// Another graph, or other settings, give the same picture.
    Equals {
        /// The other picture.
        other: Other,
        /// Largest error allowed.
        max: f64,
    },
    /// Another graph, or other settings, give another picture.
    Differs {
        /// The other picture.
        other: Other,
        /// Least error asked for.
        rmse: f64,
    },
    /// The picture is near that of the float64 reference.
    Reference {
        /// Largest root mean square error.
        rmse: Option<f64>,
        /// Largest error.
        max: Option<f64>,
    },
    /// A frame takes at most so many times as long as one with other settings, run in turn; only with `--timing`.
    NotSlower {
        /// What it is held against.
        than: Other,
        /// Largest ratio of the two, the median of all pairs.
        ratio: f64,
        /// Pairs of frames.
        frames: u32,
    },
    /// The picture is one that was stored.
    Picture {
        /// The stored picture.
        file: PathBuf,
        /// How near it must be.
        bound: PictureBound,
    },
}

/// What a pixel may have to be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Values {
    /// Linear premultiplied red, green, blue and alpha, over the background.
    pub color: Option<[f64; 4]>,
    /// The opacity of what was drawn, without the background.
    pub opacity: Option<f64>,
    /// World distance from the eye (from its plane, where the camera is orthographic) to what is seen.
    pub depth: Option<f64>,
}

impl Values {
    /// Whether nothing is given.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// A rectangle of pixels, both corners within.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Left column and top row.
    pub first: [u32; 2],
    /// Right column and bottom row.
    pub last: [u32; 2],
}

/// An axis of the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it all")]
pub enum Axis {
    X,
    Y,
    Z,
}

/// What the errors of an order of convergence are taken against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrderAgainst {
    /// The next picture, of the value halved once more: it needs no truth, and sees only that pictures converge, not to
    /// what.
    Successive,
    /// The float64 reference.
    Reference,
}

/// How near a stored picture must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PictureBound {
    /// Mean ꟻLIP.
    Flip(f64),
    /// Root mean square error.
    Rmse(f64),
    /// The largest error.
    Max(f64),
}

/// A node's parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// The node.
    pub node: String,
    /// The parameter.
    pub name: String,
    /// Where it is named.
    pub place: Place,
}

/// A picture to hold against the case's: at least one of the two is given.
#[derive(Clone, Debug, PartialEq)]
pub struct Other {
    /// Another graph; the case's own where `None`.
    pub graph: Option<GraphName>,
    /// Settings after the case's own; those of the case do not hold for another graph.
    pub set: Vec<Set>,
}
