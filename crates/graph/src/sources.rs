//! Loads what a graph draws: its volumes, transfer functions and images, each through its source kind.

use std::collections::BTreeMap;
use std::sync::Arc;

use indexmap::IndexMap;
use volgraph_report::{Finding, Findings, did_you_mean};

use crate::desc::{GraphDesc, SourceDesc};
use crate::registry::Registry;
use crate::source::{Folders, Progress, Source};

/// The loaded sources by name, those that could not be loaded left out, and everything wrong with them. `progress`
/// gets the source's name before the bytes.
pub fn load(
    desc: &GraphDesc,
    registry: &Registry,
    folders: &Folders,
    progress: &(dyn Fn(&str, u64, u64) + Sync),
) -> (IndexMap<String, Arc<dyn Source>>, Findings) {
    reload(desc, registry, folders, &|_, _| None, progress)
}

/// The loaded source for what a graph asks for under a name, where there is one.
pub type Loaded<'a> = dyn Fn(&str, &SourceDesc) -> Option<Arc<dyn Source>> + 'a;

/// As [`load`], except that the sources which `loaded` gives are taken as they are.
pub fn reload(
    desc: &GraphDesc,
    registry: &Registry,
    folders: &Folders,
    loaded: &Loaded<'_>,
    progress: &(dyn Fn(&str, u64, u64) + Sync),
) -> (IndexMap<String, Arc<dyn Source>>, Findings) {
    let mut findings = Findings::new();
    let mut sources = IndexMap::new();
    for (name, source) in &desc.sources {
        if let Some(there) = loaded(name, source) {
            sources.insert(name.clone(), there);
            continue;
        }
        let report = |done, total| progress(name, done, total);
        if let Some(source) = findings.take_all(load_one(source, registry, folders, &report)) {
            sources.insert(name.clone(), source);
        }
    }
    (sources, findings)
}

/// Loads one source.
///
/// # Errors
/// `unknown-source-kind`, `unknown-param`, `bad-param`, and what its kind found in its files.
pub fn load_one(
    desc: &SourceDesc,
    registry: &Registry,
    folders: &Folders,
    progress: Progress<'_>,
) -> Result<Arc<dyn Source>, Findings> {
    let Some(kind) = registry.source(&desc.kind) else {
        return Err(Finding::error(
            "unknown-source-kind",
            format!("unknown kind of source `{}`", desc.kind),
        )
        .at(desc.place.clone())
        .help_opt(did_you_mean(
            &desc.kind,
            registry.sources().map(|kind| kind.name()),
        ))
        .into());
    };
    let specs = kind.params();
    let mut findings = Findings::new();
    let mut params = BTreeMap::new();
    for (name, given) in &desc.params {
        let Some(spec) = specs.iter().find(|spec| spec.name == *name) else {
            findings.push(
                Finding::error(
                    "unknown-param",
                    format!("a source of kind `{}` has no field `{name}`", kind.name()),
                )
                .at(given.name_place.clone())
                .help_opt(did_you_mean(
                    name,
                    specs.iter().map(|spec| spec.name.as_str()),
                )),
            );
            continue;
        };
        match spec.check(&given.value) {
            Ok(value) => {
                params.insert(name.clone(), value);
            }
            Err(reason) => findings.push(
                Finding::error("bad-param", format!("field `{name}`: {reason}"))
                    .at(given.place.clone()),
            ),
        }
    }
    let params = findings.into_result(params)?;
    kind.load(&params, folders, progress)
        .map_err(|findings| findings.into_iter().map(|f| placed(f, desc)).collect())
}

/// A finding without a place stands where the graph names the source; one in another file tells who asked for that.
fn placed(finding: Finding, desc: &SourceDesc) -> Finding {
    match &finding.place {
        None => finding.at(desc.place.clone()),
        Some(place) if place.file != desc.place.file => {
            finding.related(desc.place.clone(), "for this source")
        }
        Some(_) => finding,
    }
}
