//! The files of a scene, made in memory: a graph's text, a transfer function and volumes.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

/// A volume file, and the source that reads it.
#[derive(Clone)]
pub struct VolumeText {
    file: String,
    bytes: Arc<Vec<u8>>,
    placement: String,
}

impl VolumeText {
    /// A raw volume of f32, each voxel from its index.
    #[must_use]
    pub fn floats(name: &str, dims: [u32; 3], value: impl Fn([f64; 3]) -> f64) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "the file holds f32")]
        let bytes = |index: [f64; 3]| (value(index) as f32).to_le_bytes();
        Self::raw(name, dims, "float32", bytes)
    }

    /// A raw volume of bytes.
    #[must_use]
    pub fn bytes(name: &str, dims: [u32; 3], value: impl Fn([f64; 3]) -> u8) -> Self {
        Self::raw(name, dims, "uint8", |index| [value(index)])
    }

    /// A raw volume of u32.
    #[must_use]
    pub fn words(name: &str, dims: [u32; 3], value: impl Fn([f64; 3]) -> u32) -> Self {
        Self::raw(name, dims, "uint32", |index| value(index).to_le_bytes())
    }

    fn raw<const N: usize>(
        name: &str,
        dims: [u32; 3],
        scalar_type: &str,
        value: impl Fn([f64; 3]) -> [u8; N],
    ) -> Self {
        let [nx, ny, nz] = dims;
        let mut bytes = Vec::new();
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    bytes.extend(value([x, y, z].map(f64::from)));
                }
            }
        }
        Self {
            file: format!("{name}_{nx}x{ny}x{nz}_{scalar_type}.raw"),
            bytes: Arc::new(bytes),
            placement: String::new(),
        }
    }

    /// With other distances between its voxels.
    #[must_use]
    pub fn spaced(mut self, [x, y, z]: [f64; 3]) -> Self {
        self.placement = format!(", spacing: ({x:?}, {y:?}, {z:?})");
        self
    }

    /// With a box from voxel centre to voxel centre: no outer half voxels where the field is clamped.
    #[must_use]
    pub fn node_centred(mut self) -> Self {
        self.placement.push_str(", node_centred: true");
        self
    }

    fn source(&self) -> String {
        format!("volume(path: \"{}\"{})", self.file, self.placement)
    }
}

/// A scene with one raycast.
#[derive(Clone)]
pub struct SceneText {
    name: String,
    volumes: Vec<(&'static str, VolumeText)>,
    transfer: String,
    camera: String,
    background: Option<String>,
    settings: BTreeMap<String, String>,
    /// Other inputs, sources and files: (input, source, its text, file, its text).
    segments: Option<String>,
    has_normals: bool,
}

impl SceneText {
    /// A scene of a volume, a transfer function and a camera, as graphs write them. `name` is that of its own files.
    #[must_use]
    pub fn new(name: &str, volume: VolumeText, transfer: &str, camera: &str) -> Self {
        Self {
            name: name.to_owned(),
            volumes: vec![("volume", volume)],
            transfer: transfer.to_owned(),
            camera: camera.to_owned(),
            background: None,
            settings: BTreeMap::new(),
            segments: None,
            has_normals: false,
        }
    }

    /// With a background of these parameters.
    #[must_use]
    pub fn before(mut self, params: &str) -> Self {
        self.background = Some(params.to_owned());
        self
    }

    /// With labels, and what they mean.
    #[must_use]
    pub fn labelled(mut self, labels: VolumeText, segments: &str) -> Self {
        self.volumes.push(("labels", labels));
        self.segments = Some(segments.to_owned());
        self
    }

    /// With the output `normal`.
    #[must_use]
    pub fn with_normals(mut self) -> Self {
        self.has_normals = true;
        self
    }

    /// With `slots.SLOT` or parameters of the raycast set to values, as RON or as bare words.
    #[must_use]
    pub fn with<K: AsRef<str>, V: AsRef<str>>(mut self, sets: &[(K, V)]) -> Self {
        for (key, value) in sets {
            let value = value.as_ref().to_owned();
            self.settings.insert(key.as_ref().to_owned(), value);
        }
        self
    }

    /// The graph's text.
    #[must_use]
    pub fn graph(&self) -> String {
        let mut sources = String::new();
        let mut inputs = String::new();
        // Writing to a String does not fail.
        for (name, volume) in &self.volumes {
            let _ = writeln!(sources, "        \"{name}\": {},", volume.source());
            let _ = write!(inputs, "\"{name}\": \"{name}\", ");
        }
        let transfer = format!("{}.ron", self.name);
        let _ = writeln!(
            sources,
            "        \"colors\": transfer(path: \"{transfer}\"),"
        );
        inputs.push_str("\"transfer\": \"colors\", ");
        if self.segments.is_some() {
            let file = format!("{}_segments.ron", self.name);
            let _ = writeln!(sources, "        \"meaning\": segments(path: \"{file}\"),");
            inputs.push_str("\"segments\": \"meaning\", ");
        }
        let mut nodes = String::new();
        if let Some(params) = &self.background {
            let _ = writeln!(
                nodes,
                "        \"background\": (kind: \"background\", params: {params}),"
            );
            inputs.push_str("\"behind\": \"background\", ");
        }
        let (mut slots, mut params) = (String::new(), String::new());
        for (key, value) in &self.settings {
            match key.strip_prefix("slots.") {
                Some(slot) => {
                    let _ = write!(slots, "\"{slot}\": \"{value}\", ");
                }
                None => {
                    let _ = write!(params, "\"{key}\": {}, ", value_text(value));
                }
            }
        }
        let normal = if self.has_normals {
            ", \"normal\": \"image.normal\""
        } else {
            ""
        };
        format!(
            "(
    sources: {{
{sources}    }},
    camera: {},
    nodes: {{
{nodes}        \"box\": (kind: \"proxy_box\", in: {{ \"volume\": \"volume\" }}),
        \"image\": (kind: \"raycast\",
                  in: {{ {inputs}\"rays\": \"box\" }},
                  slots: {{ {slots}}},
                  params: {{ {params}}}),
    }},
    outputs: {{ \"color\": \"image.color\"{normal} }},
)
",
            self.camera
        )
    }

    /// The files beside the graph: names and contents.
    #[must_use]
    pub fn files(&self) -> Vec<(String, Vec<u8>)> {
        let mut files: Vec<(String, Vec<u8>)> = self
            .volumes
            .iter()
            .map(|(_, volume)| (volume.file.clone(), volume.bytes.to_vec()))
            .collect();
        files.push((format!("{}.ron", self.name), self.transfer.clone().into()));
        if let Some(segments) = &self.segments {
            files.push((
                format!("{}_segments.ron", self.name),
                segments.clone().into(),
            ));
        }
        files
    }
}

/// Words become texts; numbers and lists stay as they are.
fn value_text(value: &str) -> String {
    let is_word = value.starts_with(|first: char| first.is_ascii_alphabetic())
        && value != "true"
        && value != "false";
    if is_word {
        format!("\"{value}\"")
    } else {
        value.to_owned()
    }
}
