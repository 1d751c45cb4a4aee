//! Paths of keys: cameras and values at frames, as a RON file says them.
//!
//! ```ron
//! (
//!     path: 1,
//!     frames: 120,
//!     keys: [
//!         (at: 0, camera: orbit(azimuth: 0, elevation: 20), set: { "image.step": 1.0 }),
//!         (at: 119, camera: orbit(azimuth: 180, elevation: 50, zoom: 2), set: { "image.step": 0.25 }),
//!     ],
//! )
//! ```
//!
//! Where all cameras are orbits about one direction, their angles are interpolated as numbers, so that a path can go
//! around more than once; else orientations take the shorter arc. Distances and magnification change by equal factors.

use std::fs;
use std::path::Path;

use volgraph_graph::{CameraDesc, read};
use volgraph_report::ron_text::{Document, Entry, Fields, Value};
use volgraph_report::{Finding, Findings, Place};
use volgraph_shader::ParamValue;

use super::MAX_FRAMES;
use super::values::Track;
use super::way::Way;
use crate::overrides::ParamOverride;

/// Longest text of a path.
const MAX_BYTES: u64 = 4 << 20;

/// Most keys of a path.
const MAX_KEYS: usize = 10_000;

/// The only version of paths.
const VERSION: u32 = 1;

/// What is wanted at one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// The frame, from 0.
    pub at: u32,
    /// The camera; on the way between the keys around where `None`.
    pub camera: Option<CameraDesc>,
    /// What is set, each with its place.
    pub sets: Vec<(ParamOverride, Place)>,
    /// Where the key is written.
    pub place: Place,
}

/// A path from key to key.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyedPath {
    frames: u32,
    frames_per_second: Option<f64>,
    keys: Vec<Key>,
    tracks: Vec<Track>,
}

impl KeyedPath {
    /// A path of so many frames, 1 to [`MAX_FRAMES`]; so many as its keys need where `None`.
    ///
    /// # Errors
    /// `path` for keys that are not in their order, at frames that there are not, of both projections, or that set one
    /// parameter to values of different forms.
    pub fn new(
        frames: Option<u32>,
        frames_per_second: Option<f64>,
        keys: Vec<Key>,
    ) -> Result<Self, Findings> {
        let mut findings = Findings::new();
        let Some(last) = keys.last() else {
            return Err(Finding::error("path", "the path has no keys").into());
        };
        let frames = frames.unwrap_or(last.at.saturating_add(1));
        if !(1..=MAX_FRAMES).contains(&frames) {
            let message = format!("{frames} frames; a path has 1 to {MAX_FRAMES}");
            findings.push(Finding::error("path", message).at(last.place.clone()));
        }
        for key in keys.iter().filter(|key| key.at >= frames) {
            let message = format!("a key at frame {} of {frames}, counted from 0", key.at);
            findings.push(
                Finding::error("path", message)
                    .at(key.place.clone())
                    .help("raise `frames`, or leave it out"),
            );
        }
        for pair in keys.windows(2).filter(|pair| pair[0].at >= pair[1].at) {
            let message = format!(
                "the key at {} comes after that at {}",
                pair[1].at, pair[0].at
            );
            findings.push(
                Finding::error("path", message)
                    .at(pair[1].place.clone())
                    .help("write the keys in the order of their frames, one for each frame")
                    .related(pair[0].place.clone(), "the key before"),
            );
        }
        let cameras = keys
            .iter()
            .filter_map(|key| Some((key, key.camera.as_ref()?)));
        let cameras: Vec<_> = cameras.collect();
        let kind = |camera: &CameraDesc| std::mem::discriminant(&camera.projection);
        for pair in cameras
            .windows(2)
            .filter(|pair| kind(pair[0].1) != kind(pair[1].1))
        {
            findings.push(
                Finding::error(
                    "path",
                    "there is no way from perspective to orthographic projection",
                )
                .at(pair[1].0.place.clone())
                .help("give all cameras of a path the same projection")
                .related(pair[0].0.place.clone(), "the camera before"),
            );
        }
        let tracks = findings.take_all(Track::of(&keys)).unwrap_or_default();
        findings.into_result(Self {
            frames,
            frames_per_second,
            keys,
            tracks,
        })
    }

    /// The frames that it was written for.
    #[must_use]
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// The frames per second that it says.
    #[must_use]
    pub fn frames_per_second(&self) -> Option<f64> {
        self.frames_per_second
    }

    /// The keys in their order.
    #[must_use]
    pub fn keys(&self) -> &[Key] {
        &self.keys
    }

    /// The way of the camera; `graph` is the camera where no key has one.
    pub(super) fn way(&self, graph: &CameraDesc, plan: &volgraph_graph::Plan) -> Way {
        let cameras = self.keys.iter();
        let mut cameras: Vec<(f64, &CameraDesc)> = cameras
            .filter_map(|key| Some((f64::from(key.at), key.camera.as_ref()?)))
            .collect();
        if cameras.is_empty() {
            cameras.push((0.0, graph));
        }
        Way::new(&cameras, plan)
    }

    /// What is set at a time, in frames.
    pub(super) fn sets(&self, time: f64) -> Vec<ParamOverride> {
        self.tracks.iter().map(|track| track.at(time)).collect()
    }

    /// Where each of them is first set.
    pub(super) fn set_places(&self) -> Vec<Place> {
        self.tracks
            .iter()
            .map(|track| track.place().clone())
            .collect()
    }
}

/// Reads a path file.
pub(super) fn read_file(file: &Path) -> Result<KeyedPath, Findings> {
    let refused = |why: String| {
        Finding::error("io", format!("the path cannot be read: {why}"))
            .at(Place::whole_file(file))
            .help("name a RON file with the keys of a camera's path")
    };
    let metadata = fs::metadata(file).map_err(|error| refused(error.to_string()))?;
    // Reading a pipe or a device might never end.
    if !metadata.is_file() {
        return Err(refused("it is no plain file".to_owned()).into());
    }
    if metadata.len() > MAX_BYTES {
        return Err(refused("it is over 4 MiB long".to_owned()).into());
    }
    let text = fs::read_to_string(file).map_err(|error| refused(error.to_string()))?;
    read_text(file, &text)
}

/// The same of a text.
pub(super) fn read_text(file: &Path, text: &str) -> Result<KeyedPath, Findings> {
    let document = Document::parse(file, text)?;
    let mut findings = Findings::new();
    let mut fields = Fields::new(document.fields()?);
    match fields.take("path") {
        Some(version) => {
            if let Some(number) = findings.take(version.u32())
                && number != VERSION
            {
                let message = format!("paths of version {number} are unknown");
                findings.push(version.error("path", message).help("write `path: 1`"));
            }
        }
        None => findings.push(
            Finding::error(
                "missing-field",
                "this is no path: it does not say `path: 1`",
            )
            .at(Place::whole_file(file))
            .help("begin with `(path: 1, keys: […])`"),
        ),
    }
    let frames = fields.read(&mut findings, "frames", |value| {
        let frames = value.u32()?;
        if (1..=MAX_FRAMES).contains(&frames) {
            return Ok(frames);
        }
        let message = format!("{frames} frames; a path has 1 to {MAX_FRAMES}");
        Err(value.error("path", message))
    });
    let rate = fields.read(&mut findings, "fps", |value| {
        let rate = value.f64()?;
        if (0.01..=1000.0).contains(&rate) {
            return Ok(rate);
        }
        Err(value.error("path", format!("{rate} frames a second; give 0.01 to 1000")))
    });
    let mut keys = Vec::new();
    if let Some(value) = fields.take("keys") {
        let items = findings.take(value.items()).unwrap_or_default();
        if items.len() > MAX_KEYS {
            let message = format!("a path of more than {MAX_KEYS} keys is refused");
            findings.push(value.error("too-large", message));
        } else {
            keys.extend(items.iter().filter_map(|item| findings.take_all(key(item))));
        }
        if items.is_empty() && !findings.has_errors() {
            findings.push(value.error("path", "the path has no keys"));
        }
    } else if !findings.has_errors() {
        findings.push(
            document
                .error("missing-field", "the path has no keys")
                .help("add `keys: [(at: 0, camera: orbit(azimuth: 0)), …]`"),
        );
    }
    fields.finish(&mut findings);
    findings.into_result(())?;
    KeyedPath::new(frames, rate, keys)
}

fn key(value: &Value<'_>) -> Result<Key, Findings> {
    let mut findings = Findings::new();
    let mut fields = Fields::new(value.fields()?);
    let at = fields.take("at");
    if at.is_none() {
        let finding = value.error("missing-field", "the key does not say at which frame it is");
        findings.push(finding.help("add `at:` with the frame's number, from 0"));
    }
    let at = at.and_then(|at| findings.take(at.u32()));
    let camera = fields.take("camera");
    let camera = camera.and_then(|camera| findings.take_all(read::camera(&camera)));
    let entries = fields.take("set").map(|set| set.entries());
    let entries = entries.and_then(|entries| findings.take_all(entries));
    let sets = sets(entries.unwrap_or_default(), &mut findings);
    fields.finish(&mut findings);
    findings.into_result(Key {
        at: at.unwrap_or_default(),
        camera,
        sets,
        place: value.place(),
    })
}

fn sets(entries: Vec<Entry<'_>>, findings: &mut Findings) -> Vec<(ParamOverride, Place)> {
    let mut sets = Vec::new();
    for (name, desc) in read::params(entries, findings) {
        match set(&name, desc.value) {
            Ok(set) => sets.push((set, desc.name_place)),
            Err(why) => findings.push(
                Finding::error("bad-name", why)
                    .at(desc.name_place)
                    .help("write the node and its parameter, such as \"image.step\""),
            ),
        }
    }
    sets
}

/// A name and a value as `--set` has them.
pub(super) fn set(name: &str, value: ParamValue) -> Result<ParamOverride, String> {
    let typed = match &value {
        ParamValue::Bool(value) => format!("{name}={value}"),
        ParamValue::Int(value) => format!("{name}={value}"),
        ParamValue::Float(value) => format!("{name}={value:?}"),
        ParamValue::Vector(values) => format!("{name}={values:?}"),
        ParamValue::Text(value) => format!("{name}={value:?}"),
    };
    if name.contains('=') {
        return Err(format!("`{}` cannot be a name", name.escape_debug()));
    }
    let parsed = ParamOverride::parse(&typed)?;
    Ok(ParamOverride { value, ..parsed })
}
