//! `volgraph nodes`: the kinds, what they read and write, and everything that a graph can set of them.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;

use naga::valid::Capabilities;
use serde_json::{Value, json};
use volgraph::{Finding, Findings, Registry, registry};
use volgraph_graph::{NodeKind, Requirement, SourceKind};
use volgraph_report::did_you_mean;
use volgraph_shader::order::declared_orders;
use volgraph_shader::{DeclaredOrder, LinkedFile, ParamSpec, ShaderRoots, check_file};

use crate::args::NodesArgs;
use crate::output;

pub fn run(args: &NodesArgs) -> anyhow::Result<ExitCode> {
    let registry = registry();
    let shaders = Shaders {
        roots: args.shaders.folders().roots(None),
        defaults: registry.default_slots(),
    };
    let is_asked = |name: &str| args.kind.as_deref().is_none_or(|kind| kind == name);
    let nodes: Vec<Value> = registry
        .nodes()
        .filter(|kind| is_asked(kind.name()))
        .map(|kind| shaders.node(&registry, kind.as_ref()))
        .collect();
    let sources: Vec<Value> = registry
        .sources()
        .filter(|kind| is_asked(kind.name()))
        .map(|kind| source(kind.as_ref()))
        .collect();
    if let (true, true, Some(kind)) = (nodes.is_empty(), sources.is_empty(), &args.kind) {
        let known = registry
            .nodes()
            .map(|kind| kind.name())
            .chain(registry.sources().map(|kind| kind.name()));
        let finding = Finding::error(
            "unknown-kind",
            format!("no kind of node or source is named `{kind}`"),
        )
        .help_opt(did_you_mean(kind, known));
        return Err(Findings::from(finding).into());
    }
    if args.json {
        output::print_json(&json!({ "nodes": nodes, "sources": sources }));
    } else {
        output::print(&text(&nodes, &sources));
    }
    Ok(ExitCode::SUCCESS)
}

/// The shaders that there are, for what they declare.
struct Shaders {
    roots: ShaderRoots,
    defaults: BTreeMap<String, String>,
}

impl Shaders {
    fn node(&self, registry: &Registry, kind: &dyn NodeKind) -> Value {
        let program = registry.default_program(kind.name());
        let inputs = kind.inputs().iter().map(|port| {
            let (requirement, kind) = match port.requirement {
                Requirement::Required => ("required", None),
                Requirement::Optional => ("optional", None),
                Requirement::Demanded(_) | Requirement::DemandedAlike(_) => (
                    "made where a shader uses it",
                    port.requirement.demanded_kind(),
                ),
            };
            json!({
                "name": port.name, "type": port.ty.to_string(), "doc": port.doc,
                "requirement": requirement, "made_by": kind,
            })
        });
        let outputs = kind
            .outputs()
            .iter()
            .map(|port| json!({ "name": port.name, "type": port.ty.to_string(), "doc": port.doc }));
        let own_slots = kind.slots().iter().map(|slot| {
            json!({
                "name": slot.name, "doc": slot.doc, "default": slot.default, "is_fixed": false,
                "choices": self.choices(slot.name),
            })
        });
        let fixed = program.iter().flat_map(|program| &program.fixed_slots).map(|(slot, choice)| {
            json!({
                "name": slot, "doc": "Chosen by the node itself.", "default": choice, "is_fixed": true,
                "choices": self.choices(slot),
            })
        });
        let slots: Vec<Value> = own_slots.chain(fixed).collect();
        let libraries = libraries(&slots);
        json!({
            "kind": kind.name(),
            "doc": kind.doc(),
            "inputs": inputs.collect::<Vec<_>>(),
            "outputs": outputs.collect::<Vec<_>>(),
            "params": kind.params().iter().map(param).collect::<Vec<_>>(),
            "shader": program.map(|program| self.file(Path::new(program.root))),
            "slots": slots,
            "libraries": libraries,
        })
    }

    fn choices(&self, slot: &str) -> Vec<Value> {
        let folder = Path::new("slot").join(slot);
        let choices = self.roots.choices(slot).into_iter().map(|name| {
            let mut value = self.file(&folder.join(format!("{name}.wgsl")));
            value["name"] = json!(name);
            value
        });
        choices.collect()
    }

    /// What a shader file says of itself: its first line and its own parameters; and those of the libraries that it
    /// imports.
    fn file(&self, path: &Path) -> Value {
        match check_file(&self.roots, path, &self.defaults, Capabilities::default()) {
            Ok(module) => {
                let own = module.linked.files.last();
                let doc = own
                    .map(|file| first_sentence(&file.text))
                    .unwrap_or_default();
                let is_own = |spec: &&ParamSpec| {
                    spec.place.as_ref().map(|p| &p.file) == own.map(|file| &file.path)
                };
                let libraries = module
                    .linked
                    .files
                    .iter()
                    .filter(|file| is_library(&file.path));
                let libraries = libraries.filter_map(|file| {
                    let is_its = |spec: &&ParamSpec| {
                        spec.place
                            .as_ref()
                            .is_some_and(|place| place.file == file.path)
                    };
                    let params: Vec<Value> =
                        module.params().iter().filter(is_its).map(param).collect();
                    let doc = first_sentence(&file.text);
                    (!params.is_empty())
                        .then(|| json!({ "path": file.path, "doc": doc, "params": params }))
                });
                json!({
                    "path": own.map(|file| &file.path),
                    "doc": doc,
                    "orders": own.map(orders).unwrap_or_default(),
                    "params": module.params().iter().filter(is_own).map(param).collect::<Vec<_>>(),
                    "libraries": libraries.collect::<Vec<_>>(),
                })
            }
            Err(findings) => json!({
                "path": path,
                "doc": format!("has {} findings; `volgraph check` shows them", findings.len()),
                "params": [],
                "libraries": [],
            }),
        }
    }
}

/// The orders of convergence that a file declares; `check` has found nothing wrong with them.
fn orders(file: &LinkedFile) -> Vec<Value> {
    let orders = declared_orders(&file.path, &file.text).unwrap_or_default();
    let value = |order: &DeclaredOrder| {
        let condition = order.condition.as_ref();
        json!({
            "order": order.order,
            "where": condition.map(|(param, choice)| json!({ "param": param, "choice": choice })),
            "text": order.to_string(),
        })
    };
    orders.iter().map(value).collect()
}

/// Whether a file is no choice of a slot, nor a node's own.
fn is_library(path: &Path) -> bool {
    path.components().any(|part| part.as_os_str() == "lib")
}

/// The libraries with parameters that choices of the slots import, each once, with the choices that do. What a choice
/// reaches by way of other slots counts as theirs.
fn libraries(slots: &[Value]) -> Vec<Value> {
    let mut libraries: BTreeMap<String, Value> = BTreeMap::new();
    for slot in slots {
        for choice in list(&slot["choices"]) {
            for library in list(&choice["libraries"]) {
                let used_by = format!("{} {}", word(&slot["name"]), word(&choice["name"]));
                let entry = libraries
                    .entry(word(&library["path"]).to_owned())
                    .or_insert_with(|| {
                        let mut library = library.clone();
                        library["used_by"] = json!([]);
                        library
                    });
                if let Some(users) = entry["used_by"].as_array_mut() {
                    users.push(json!(used_by));
                }
            }
        }
    }
    libraries.into_values().collect()
}

/// The first sentence of the comment at the start of a shader or graph.
pub(super) fn first_sentence(text: &str) -> String {
    let lines = text
        .lines()
        .map_while(|line| line.trim().strip_prefix("//"));
    let comment = lines
        .map(|line| line.trim_start_matches('/').trim())
        .filter(|line| !line.starts_with('@'))
        .collect::<Vec<_>>()
        .join(" ");
    // The point behind "et al" ends no sentence.
    let end = comment
        .match_indices(". ")
        .find(|(at, _)| !comment[..*at].ends_with("et al"));
    match end {
        Some((at, _)) => comment[..=at].to_owned(),
        None => comment,
    }
}

fn source(kind: &dyn SourceKind) -> Value {
    json!({
        "kind": kind.name(),
        "doc": kind.doc(),
        "type": kind.ty().to_string(),
        "fields": kind.params().iter().map(param).collect::<Vec<_>>(),
    })
}

fn param(spec: &ParamSpec) -> Value {
    json!({
        "name": spec.name, "type": spec.ty.to_string(), "doc": spec.doc, "default": spec.default,
        "range": spec.range, "unit": spec.unit, "choices": spec.choices(), "is_color": spec.is_color,
        "default_text": spec.default.to_string(),
    })
}

/// The same values as [`Value`]s hold, for people.
fn text(nodes: &[Value], sources: &[Value]) -> String {
    let mut out = String::new();
    for node in nodes {
        heading(&mut out, "node", node);
        for port in list(&node["inputs"]) {
            let made_by = port["made_by"]
                .as_str()
                .map(|kind| format!(", by `{kind}`"))
                .unwrap_or_default();
            let requirement = format!("{}{made_by}", word(&port["requirement"]));
            line(
                &mut out,
                2,
                &format!(
                    "in    {}: {} ({requirement})",
                    word(&port["name"]),
                    word(&port["type"])
                ),
                port,
            );
        }
        for port in list(&node["outputs"]) {
            line(
                &mut out,
                2,
                &format!("out   {}: {}", word(&port["name"]), word(&port["type"])),
                port,
            );
        }
        params(&mut out, 2, &node["params"]);
        params(&mut out, 2, &node["shader"]["params"]);
        for slot in list(&node["slots"]) {
            line(
                &mut out,
                2,
                &format!("slot  {} = {}", word(&slot["name"]), word(&slot["default"])),
                slot,
            );
            for choice in list(&slot["choices"]) {
                line(&mut out, 6, word(&choice["name"]), choice);
                for order in list(&choice["orders"]) {
                    let _ = writeln!(out, "        order {}", word(&order["text"]));
                }
                params(&mut out, 8, &choice["params"]);
            }
        }
        for library in list(&node["libraries"]) {
            let users: Vec<&str> = list(&library["used_by"]).iter().map(word).collect();
            let path = word(&library["path"]);
            let name = path.rsplit_once("lib/").map_or(path, |(_, name)| name);
            let head = format!("with lib/{name} ({})", users.join(", "));
            line(&mut out, 2, &head, library);
            params(&mut out, 8, &library["params"]);
        }
    }
    for source in sources {
        heading(&mut out, "source", source);
        params(&mut out, 2, &source["fields"]);
    }
    out
}

fn heading(out: &mut String, what: &str, value: &Value) {
    if !out.is_empty() {
        out.push('\n');
    }
    line(out, 0, &format!("{what} {}", word(&value["kind"])), value);
}

fn params(out: &mut String, indent: usize, params: &Value) {
    for param in list(params) {
        let mut head = format!(
            "param {} = {}",
            word(&param["name"]),
            word(&param["default_text"])
        );
        // Writing to a String does not fail.
        if let Some([low, high]) = param["range"].as_array().map(Vec::as_slice) {
            let _ = write!(head, ", {low} to {high}");
        }
        if let Some(unit) = param["unit"].as_str() {
            let _ = write!(head, " {unit}");
        }
        let choices: Vec<&str> = list(&param["choices"]).iter().map(word).collect();
        if !choices.is_empty() {
            let _ = write!(head, " ({})", choices.join(", "));
        }
        line(out, indent, &head, param);
    }
}

fn line(out: &mut String, indent: usize, head: &str, value: &Value) {
    let _ = writeln!(out, "{:indent$}{head}: {}", "", word(&value["doc"]));
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map(Vec::as_slice).unwrap_or_default()
}

fn word(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}
