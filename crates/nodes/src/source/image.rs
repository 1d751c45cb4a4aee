//! `image(path: "backdrop.png")`: a picture from a PNG or EXR file.

use std::any::Any;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use volgraph_graph::{Digest, Folders, PortType, Source, SourceKind};
use volgraph_picture::Picture;
use volgraph_report::{Finding, Findings, Place};
use volgraph_shader::{ParamSpec, ParamValue};

use super::{Given, path_param};

/// The source kind `image`.
pub struct ImageKind;

/// A loaded picture.
#[derive(Debug)]
pub struct ImageSource {
    /// The picture, linear and premultiplied.
    pub picture: Arc<Picture>,
    path: PathBuf,
    digest: Digest,
}

impl SourceKind for ImageKind {
    fn name(&self) -> &'static str {
        "image"
    }

    fn doc(&self) -> &'static str {
        "A picture from a PNG or EXR file."
    }

    fn ty(&self) -> PortType {
        PortType::Image
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![path_param()]
    }

    fn load(
        &self,
        params: &BTreeMap<String, ParamValue>,
        folders: &Folders,
        _progress: volgraph_graph::Progress<'_>,
    ) -> Result<Arc<dyn Source>, Findings> {
        let given = Given(params);
        let path = given.path("path", folders)?;
        let picture = match folders.embedded_bytes(&path) {
            Some(bytes) => Picture::from_bytes(&path, bytes),
            None => Picture::load(&path),
        };
        let picture = picture.map_err(|error| {
            let finding = Finding::error("image", error.to_string()).at(Place::whole_file(&path));
            given.with_twin(finding.into(), "path", &path, folders)
        })?;
        let mut hasher = volgraph_graph::fingerprint::Hasher::new();
        hasher.part(&picture.width.to_le_bytes());
        hasher.part(bytemuck::cast_slice(&picture.color));
        Ok(Arc::new(ImageSource {
            digest: hasher.finish(),
            picture: Arc::new(picture),
            path,
        }))
    }
}

impl Source for ImageSource {
    fn ty(&self) -> PortType {
        PortType::Image
    }

    fn digest(&self) -> Digest {
        self.digest
    }

    fn summary(&self) -> String {
        format!(
            "{} {}x{}",
            self.path.display(),
            self.picture.width,
            self.picture.height
        )
    }

    fn files(&self) -> Vec<PathBuf> {
        vec![self.path.clone()]
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}
