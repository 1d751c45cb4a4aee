//! A picture's own account of how it was made, read back from its metadata ([`crate::metadata`]).
//!
//! [`Recorded::scene`] is the graph as it was, with the shaders and sources of today; [`Recorded::changes`] says which of
//! them are others than then. The camera is placed exactly where it stood.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::Value;
use volgraph_graph::fingerprint::Hasher;
use volgraph_graph::{Camera, View, hex};
use volgraph_report::{Finding, Findings, Place};

use crate::scene::read_text;
use crate::{Overrides, ParamOverride, Picture, Scene, ShaderFolders, SourceProgress, registry};

/// How a picture was made.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// The graph file.
    pub graph: PathBuf,
    /// Its text.
    pub text: String,
    /// What was overridden.
    pub overrides: Overrides,
    /// Camera and size.
    pub view: View,
    /// The user's own folders of shaders.
    pub shaders: ShaderFolders,
    metadata: Vec<(String, String)>,
}

/// Something that is not as it was.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Changed {
    /// `version`, `adapter`, `graph`, `source NAME` or `shader NODE`.
    pub what: String,
    /// As the picture says.
    pub was: String,
    /// As it is; empty where it is no more.
    pub is: String,
}

fn unrecorded(file: &Path, message: String) -> Findings {
    Finding::error("no-metadata", message)
        .at(Place::whole_file(file))
        .help("name a .png or .exr as `volgraph render` has written it; editors and converters drop what it carries")
        .into()
}

impl Recorded {
    /// The account of a picture that was loaded from a file.
    ///
    /// # Errors
    /// `no-metadata` where it has none, or one that cannot be read.
    pub fn of(picture: &Picture, file: &Path) -> Result<Self, Findings> {
        let text = |key: &str| {
            let found = picture.metadata.iter().find(|(it, _)| it == key);
            found
                .map(|(_, value)| value.clone())
                .ok_or_else(|| unrecorded(file, format!("the picture does not say its `{key}`")))
        };
        let broken = |key: &str| unrecorded(file, format!("the picture's `{key}` cannot be read"));
        let json = |key: &str| -> Result<Value, Findings> {
            serde_json::from_str(&text(key)?).map_err(|_| broken(key))
        };
        let camera: Camera =
            serde_json::from_value(json("camera")?).map_err(|_| broken("camera"))?;
        let overrides = overrides(&json("overrides")?).ok_or_else(|| broken("overrides"))?;
        // Pictures of before this was kept have no such folders, as far as is known.
        let own = json("shaders.folders").map_or(Some(Vec::new()), |it| paths(&it));
        let own = own.ok_or_else(|| broken("shaders.folders"))?;
        let size = [picture.width, picture.height];
        Ok(Self {
            graph: PathBuf::from(text("graph.path")?),
            text: text("graph.text")?,
            overrides,
            view: View {
                camera,
                size,
                window: None,
            },
            shaders: ShaderFolders { own },
            metadata: picture.metadata.clone(),
        })
    }

    /// The scene as it was, with sources and shaders as they are. `data` and `shaders` are looked in first.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn scene(
        &self,
        data: &[PathBuf],
        shaders: &ShaderFolders,
        progress: &dyn SourceProgress,
    ) -> Result<Scene, Findings> {
        let joined = |first: &[PathBuf], then: &[PathBuf]| [first, then].concat();
        let overrides = Overrides {
            data: joined(data, &self.overrides.data),
            ..self.overrides.clone()
        };
        let shaders = ShaderFolders {
            own: joined(&shaders.own, &self.shaders.own),
        };
        let text = self.text.clone();
        Scene::of_text(
            &self.graph,
            text,
            &overrides,
            &shaders,
            registry(),
            progress,
        )
    }

    /// What has changed since, by the metadata of the picture as it would be now; of the graph, by its file.
    #[must_use]
    pub fn changes(&self, now: &[(String, String)]) -> Vec<Changed> {
        let value = |of: &[(String, String)], key: &str| {
            let found = of.iter().find(|(it, _)| it == key);
            found.map(|(_, value)| value.clone()).unwrap_or_default()
        };
        let mut changes = Vec::new();
        let mut note = |what: String, was: String, is: String| {
            if was != is {
                changes.push(Changed { what, was, is });
            }
        };
        for key in ["version", "adapter"] {
            note(key.to_owned(), value(&self.metadata, key), value(now, key));
        }
        let digest = |text: &str| {
            let mut hasher = Hasher::new();
            hasher.part(text.as_bytes());
            hex(&hasher.finish())
        };
        let today = read_text(&self.graph).map_or(String::new(), |text| digest(&text));
        note("graph".to_owned(), digest(&self.text), today);
        for (key, what) in [("digest.sources", "source"), ("digest.shaders", "shader")] {
            let map = |of: &[(String, String)]| -> serde_json::Map<String, Value> {
                serde_json::from_str(&value(of, key)).unwrap_or_default()
            };
            let (was, is) = (map(&self.metadata), map(now));
            let mut names: Vec<&String> = was.keys().chain(is.keys()).collect();
            names.sort();
            names.dedup();
            for name in names {
                let of = |map: &serde_json::Map<String, Value>| {
                    let digest = map.get(name).and_then(Value::as_str);
                    digest.unwrap_or_default().to_owned()
                };
                note(format!("{what} {name}"), of(&was), of(&is));
            }
        }
        changes
    }
}

fn paths(value: &Value) -> Option<Vec<PathBuf>> {
    let paths = value.as_array()?.iter();
    paths
        .map(|path| Some(PathBuf::from(path.as_str()?)))
        .collect()
}

fn overrides(value: &Value) -> Option<Overrides> {
    let params = value.get("params")?.as_array()?.iter();
    let params = params.map(|set| ParamOverride::parse(set.get("typed")?.as_str()?).ok());
    let volumes = value.get("volumes")?.as_array()?.iter();
    let volumes = volumes.map(|volume| {
        let [name, path] = volume.as_array()?.as_slice() else {
            return None;
        };
        Some((name.as_str()?.to_owned(), PathBuf::from(path.as_str()?)))
    });
    Some(Overrides {
        params: params.collect::<Option<_>>()?,
        volumes: volumes.collect::<Option<_>>()?,
        // The camera is told exactly elsewhere.
        camera: None,
        data: paths(value.get("data")?)?,
        time: match value.get("time") {
            Some(time) => Some(u32::try_from(time.as_u64()?).ok()?),
            None => None,
        },
        look: None,
    })
}
