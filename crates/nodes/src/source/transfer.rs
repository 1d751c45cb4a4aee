//! `transfer(path: "transfer/engine.ron")`: a transfer function from a file; `transfer(text: "(…)")`: one in the graph itself.

use std::any::Any;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use volgraph_graph::{Digest, Folders, PortType, Source, SourceKind};
use volgraph_optics::TransferFunction;
use volgraph_report::{Finding, Findings};
use volgraph_shader::{ParamSpec, ParamValue};

use super::{Given, path_param};

/// The source kind `transfer`.
pub struct TransferKind;

/// A loaded transfer function.
#[derive(Debug)]
pub struct TransferSource {
    /// The transfer function.
    pub transfer: Arc<TransferFunction>,
    /// Its file; none where it stands in the graph.
    path: Option<PathBuf>,
}

impl SourceKind for TransferKind {
    fn name(&self) -> &'static str {
        "transfer"
    }

    fn doc(&self) -> &'static str {
        "A transfer function from a RON file, or as a text: colour and opacity over the scalar."
    }

    fn ty(&self) -> PortType {
        PortType::Transfer
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![
            path_param(),
            ParamSpec::text("text", "", "What the file would hold, in its place."),
        ]
    }

    fn load(
        &self,
        params: &BTreeMap<String, ParamValue>,
        folders: &Folders,
        _progress: volgraph_graph::Progress<'_>,
    ) -> Result<Arc<dyn Source>, Findings> {
        let given = Given(params);
        let has_path = given.text("path").is_some_and(|path| !path.is_empty());
        if let Some(text) = given.text("text").filter(|text| !text.is_empty()) {
            if has_path {
                let message = "`path` and `text` are both given";
                return Err(Finding::error("exclusive-fields", message)
                    .help("leave one of the two out")
                    .into());
            }
            let transfer = TransferFunction::parse(Path::new("text"), text)?;
            return Ok(Arc::new(TransferSource {
                transfer: Arc::new(transfer),
                path: None,
            }));
        }
        let path = given.path("path", folders)?;
        let transfer = match folders.embedded_bytes(&path) {
            Some(bytes) => TransferFunction::parse(&path, &String::from_utf8_lossy(bytes))?,
            None => TransferFunction::load(&path)
                .map_err(|findings| given.with_twin(findings, "path", &path, folders))?,
        };
        Ok(Arc::new(TransferSource {
            transfer: Arc::new(transfer),
            path: Some(path),
        }))
    }
}

impl Source for TransferSource {
    fn ty(&self) -> PortType {
        PortType::Transfer
    }

    fn digest(&self) -> Digest {
        self.transfer.digest()
    }

    fn summary(&self) -> String {
        let (lo, hi) = self.transfer.range();
        let from = self.path.as_deref().unwrap_or(Path::new("text")).display();
        format!("{from} {:?} {lo}..{hi}", self.transfer.domain())
    }

    fn files(&self) -> Vec<PathBuf> {
        self.path.iter().cloned().collect()
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}
