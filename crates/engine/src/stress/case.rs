//! A breaking point as plain values.

use volgraph_graph::View;

use super::scene_text::SceneText;

/// A breaking point: what is swept, how it is drawn, and what should be seen.
pub struct Case {
    /// Its name, of small letters and hyphens.
    pub name: &'static str,
    /// What breaks there and why, in a sentence.
    pub breaks: &'static str,
    /// What the numbers of its points are, with their unit.
    pub swept: &'static str,
    /// Width and height of the pictures.
    pub size: [u32; 2],
    /// What is looked at.
    pub quantity: Quantity,
    /// Where the truth comes from.
    pub truth: Truth,
    /// The sweep.
    pub points: Vec<Point>,
    /// The methods.
    pub methods: Vec<Method>,
}

/// One scene of a sweep.
pub struct Point {
    /// The swept number.
    pub at: f64,
    /// The same in words.
    pub label: String,
    /// The scene, before a method changes it.
    pub scene: SceneText,
}

impl Point {
    /// A point whose number says all.
    #[must_use]
    pub fn new(at: f64, scene: SceneText) -> Self {
        Self::named(at, format!("{at}"), scene)
    }

    /// A point with words of its own.
    #[must_use]
    pub fn named(at: f64, label: impl Into<String>, scene: SceneText) -> Self {
        Self {
            at,
            label: label.into(),
            scene,
        }
    }
}

/// A way to draw.
pub struct Method {
    /// Its name.
    pub name: String,
    /// What it sets: `slots.SLOT` or a parameter of the raycast, and the value as RON.
    pub sets: Vec<(String, String)>,
    /// What is expected of it.
    pub expect: Expect,
    /// Errors above it fail.
    pub bound: Bound,
}

impl Method {
    /// A method that must hold at every point.
    #[must_use]
    pub fn holds(name: &str, sets: &[(&str, &str)], bound: Bound) -> Self {
        Self::new(name, sets, Expect::Holds, bound)
    }

    /// A method that is known to fail at one point or more.
    #[must_use]
    pub fn fails(name: &str, sets: &[(&str, &str)], bound: Bound) -> Self {
        Self::new(name, sets, Expect::Fails, bound)
    }

    /// A method that is measured and not judged.
    #[must_use]
    pub fn reported(name: &str, sets: &[(&str, &str)], bound: Bound) -> Self {
        Self::new(name, sets, Expect::Reported, bound)
    }

    /// Of any expectation.
    #[must_use]
    pub fn new(name: &str, sets: &[(&str, &str)], expect: Expect, bound: Bound) -> Self {
        let owned = |(key, value): &(&str, &str)| ((*key).to_owned(), (*value).to_owned());
        Self {
            name: name.to_owned(),
            sets: sets.iter().map(owned).collect(),
            expect,
            bound,
        }
    }
}

/// What is expected of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Expect {
    /// It stays below its bound at every point.
    Holds,
    /// It fails at one point or more.
    Fails,
    /// Nothing: it is measured.
    Reported,
}

/// The largest error that theory leaves, of the swept number.
#[derive(Clone, Copy)]
pub struct Bound {
    /// The bound, in the unit of the quantity; infinite where nothing is claimed.
    pub of: fn(f64) -> f64,
    /// Why it is that.
    pub why: &'static str,
}

/// What of a picture is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Linear premultiplied colour, with the opacity of what the ray met as the fourth.
    Color,
    /// Distance from the eye in voxels of the smallest spacing.
    Depth,
    /// Unit normals, towards the eye.
    Normal,
}

impl Quantity {
    /// The unit of errors.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Color => "of 1",
            Self::Depth => "voxels",
            Self::Normal => "of a unit vector",
        }
    }
}

/// A closed form: what the pixel (x, y) of a view shows at a swept number; `None` where it says nothing.
pub type Form = fn(view: &View, pixel: [u32; 2], at: f64) -> Option<[f64; 4]>;

/// Where the truth of a point comes from.
pub enum Truth {
    /// The float64 reference of the point's scene.
    Reference,
    /// The depth of the first place along each ray where the trilinear field reaches a level from below, in float64. Rays of which a hundred-thousandth of the data's range makes something else are not judged: no picture
    /// in f32 could be.
    FirstCrossing {
        /// The level, as a share of the data's range.
        share: f64,
    },
    /// A closed form.
    Form(Form),
    /// The picture of the point's scene with these settings.
    Picture(Vec<(String, String)>),
}
