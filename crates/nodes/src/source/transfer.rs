//! `transfer(path: "transfer/engine.ron")`: a transfer function from a file.

use std::any::Any;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use volgraph_graph::{Digest, Folders, PortType, Source, SourceKind};
use volgraph_optics::TransferFunction;
use volgraph_report::Findings;
use volgraph_shader::{ParamSpec, ParamValue};

use super::{Given, path_param};

/// The source kind `transfer`.
pub struct TransferKind;

/// A loaded transfer function.
#[derive(Debug)]
pub struct TransferSource {
    /// The transfer function.
    pub transfer: Arc<TransferFunction>,
    path: PathBuf,
}

impl SourceKind for TransferKind {
    fn name(&self) -> &'static str {
        "transfer"
    }

    fn doc(&self) -> &'static str {
        "A transfer function from a RON file: colour and opacity over the scalar."
    }

    fn ty(&self) -> PortType {
        PortType::Transfer
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
        let transfer = match folders.embedded_bytes(&path) {
            Some(bytes) => TransferFunction::parse(&path, &String::from_utf8_lossy(bytes))?,
            None => TransferFunction::load(&path)
                .map_err(|findings| given.with_twin(findings, "path", &path, folders))?,
        };
        Ok(Arc::new(TransferSource {
            transfer: Arc::new(transfer),
            path,
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
        format!(
            "{} {:?} {lo}..{hi}",
            self.path.display(),
            self.transfer.domain()
        )
    }

    fn files(&self) -> Vec<PathBuf> {
        vec![self.path.clone()]
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}
