//! Choices on disk.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use volgraph_gpu::Gpu;
use volgraph_graph::demand::ShaderLibrary;
use volgraph_graph::fingerprint::Hasher;
use volgraph_graph::{Budget, Plan, hex};
use volgraph_shader::{ParamValue, check_file};

use super::Chosen;
use crate::methods::{Method, Setting, TruthKind};
use crate::scene::Scene;
use crate::truth::prune;

/// Changes with how choices are made and with what methods cost, so that older ones are made again.
const REVISION: u32 = 7;

/// Most bytes of all choices.
const MAX_KEPT_BYTES: u64 = 4 << 20;

/// Files are at most this long.
const MAX_BYTES: u64 = 64 << 10;

/// Of all that a choice depends on: what each node does in the graph's own view, the choices that there are of what is
/// chosen, what is set by name, the budget, the adapter, what plans may ask of it, how many cores there are, and volgraph
/// itself.
pub(super) fn digest(
    scene: &Scene,
    plan: &Plan,
    shaders: &ShaderLibrary,
    gpu: &Gpu,
    budget: Budget,
) -> String {
    let mut hasher = Hasher::new();
    hasher.part(env!("CARGO_PKG_VERSION").as_bytes());
    hasher.part(&REVISION.to_le_bytes());
    hasher.part(format!("{:?}", plan.limits).as_bytes());
    hasher.part(gpu.adapter().to_string().as_bytes());
    let cores = (std::env::consts::ARCH, rayon::current_num_threads());
    hasher.part(format!("{cores:?}").as_bytes());
    hasher.part(format!("{budget:?} {:?}", scene.overrides.params).as_bytes());
    for fingerprint in plan.fingerprints(&plan.view()).values() {
        hasher.part(fingerprint);
    }
    for choice in shaders.roots().choices("classify") {
        let path = Path::new("slot/classify").join(format!("{choice}.wgsl"));
        hasher.part(choice.as_bytes());
        let slots = scene.registry.default_slots();
        if let Ok(module) = check_file(shaders.roots(), &path, &slots, gpu.capabilities()) {
            hasher.part(&module.linked.digest);
        }
    }
    hex(&hasher.finish())
}

/// What is kept of a choice.
pub(super) struct Kept {
    method: Method,
    predicted_rmse: f64,
    predicted_ms: f64,
    is_met: bool,
    truth: TruthKind,
    tried: usize,
}

impl Kept {
    pub(super) fn chosen(self, budget: Budget, node: String) -> Chosen {
        Chosen {
            budget,
            node,
            method: self.method,
            predicted_rmse: self.predicted_rmse,
            predicted_ms: self.predicted_ms,
            is_met: self.is_met,
            truth: self.truth,
            tried: self.tried,
            is_kept: true,
            overruled: Vec::new(),
        }
    }
}

pub(super) fn write(file: &Path, chosen: &Chosen) -> std::io::Result<()> {
    let settings: Vec<Value> = chosen
        .method
        .settings
        .iter()
        .map(|setting| {
            let value = match &setting.value {
                ParamValue::Float(number) => json!({ "number": number }),
                other => json!({ "text": other.to_string() }),
            };
            json!({ "name": setting.name, "is_slot": setting.is_slot, "value": value })
        })
        .collect();
    let text = json!({
        "method": settings,
        "rmse": chosen.predicted_rmse,
        "ms": chosen.predicted_ms,
        "is_met": chosen.is_met,
        "is_reference": chosen.truth == TruthKind::Reference,
        "tried": chosen.tried,
    });
    let folder = file.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    let mut part = tempfile::NamedTempFile::new_in(folder)?;
    std::io::Write::write_all(&mut part, text.to_string().as_bytes())?;
    part.persist(file)?;
    prune(folder, "json", MAX_KEPT_BYTES)
}

pub(super) fn read(file: &Path) -> Option<Kept> {
    if fs::metadata(file).ok()?.len() > MAX_BYTES {
        return None;
    }
    let text: Value = serde_json::from_str(&fs::read_to_string(file).ok()?).ok()?;
    let setting = |setting: &Value| {
        let value = setting.get("value")?;
        let value = match value.get("number") {
            Some(number) => ParamValue::Float(number.as_f64()?),
            None => ParamValue::Text(value.get("text")?.as_str()?.to_owned()),
        };
        Some(Setting {
            name: setting.get("name")?.as_str()?.to_owned(),
            is_slot: setting.get("is_slot")?.as_bool()?,
            value,
        })
    };
    let settings = text.get("method")?.as_array()?;
    let settings: Option<Vec<Setting>> = settings.iter().map(setting).collect();
    Some(Kept {
        method: Method {
            settings: settings?,
        },
        predicted_rmse: text.get("rmse")?.as_f64()?,
        predicted_ms: text.get("ms")?.as_f64()?,
        is_met: text.get("is_met")?.as_bool()?,
        truth: if text.get("is_reference")?.as_bool()? {
            TruthKind::Reference
        } else {
            TruthKind::Fine
        },
        tried: usize::try_from(text.get("tried")?.as_u64()?).ok()?,
    })
}
