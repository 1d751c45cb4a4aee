//! `volgraph new`: a shader for a slot, with a graph that draws it and a test, as a place to start from.
//!
//! The way of the data: the name is checked, for it becomes the name of files and the prefix of WGSL names; the
//! templates, which are embedded and are a working set of files themselves, get the name; all are written, or none
//! ([`write`](super::write)).

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use include_dir::{Dir, include_dir};
use naga::keywords::wgsl::RESERVED;
use volgraph::{EMBEDDED_SHADERS, Finding, Findings, ready_graphs};

use super::write;
use crate::args::{NewArgs, NewSlot};
use crate::output;

static TEMPLATES: Dir<'static> = include_dir!("$CARGO_MANIFEST_DIR/templates");

/// What stands for the name in the templates.
const NAME: &str = "new_name";

/// Longer names make no file name on some systems, with what is added to them.
const MAX_NAME: usize = 64;

/// What differs between slots in the graph and the test, which are written for a technique.
struct Slot {
    name: &'static str,
    /// Slots and parameters of the graph's raycast.
    slots: &'static str,
    params: &'static str,
    /// A setting that must change the picture, and by how much at least; a traversal or reconstruction changes little.
    differs: &'static str,
}

const TECHNIQUE: Slot = Slot {
    name: "technique",
    slots: r#"{ "technique": "new_name" }"#,
    params: r#"{ "step": 1.0, "brightness": 1.0 }"#,
    differs: r#"set: ["image.brightness=0"], rmse: 0.01"#,
};

impl NewSlot {
    fn slot(self) -> Slot {
        match self {
            Self::Technique => TECHNIQUE,
            Self::Classify => Slot {
                name: "classify",
                slots: r#"{ "classify": "new_name" }"#,
                params: r#"{ "step": 1.0, "density": 1.0 }"#,
                differs: r#"set: ["image.density=0"], rmse: 0.01"#,
            },
            Self::Light => Slot {
                name: "light",
                slots: r#"{ "light": "new_name" }"#,
                params: r#"{ "step": 1.0, "rim": 0.8 }"#,
                differs: r#"set: ["image.rim=0"], rmse: 0.005"#,
            },
            Self::Traverse => Slot {
                name: "traverse",
                slots: r#"{ "traverse": "new_name" }"#,
                params: r#"{ "step": 1.0, "growth": 1.0 }"#,
                differs: r#"set: ["image.growth=10"], rmse: 0.0002"#,
            },
            Self::Reconstruct => Slot {
                name: "reconstruct",
                slots: r#"{ "reconstruct": "new_name" }"#,
                params: r#"{ "step": 1.0, "sharpness": 0.5 }"#,
                differs: r#"set: ["image.sharpness=1"], rmse: 0.0001"#,
            },
            Self::Gradient => Slot {
                name: "gradient",
                slots: r#"{ "gradient": "new_name", "light": "phong" }"#,
                params: r#"{ "step": 1.0, "width": 1.0 }"#,
                differs: r#"set: ["image.width=16"], rmse: 0.0004"#,
            },
        }
    }
}

pub fn run(args: &NewArgs) -> anyhow::Result<ExitCode> {
    let slot = args.slot.slot();
    let name = args.name.as_str();
    check_name(name, slot.name)?;
    let files = files(&slot, name);
    let files: Vec<(PathBuf, &[u8])> = files
        .iter()
        .map(|(path, text)| (path.clone(), text.as_bytes()))
        .collect();
    let written = write::files(&args.folder, &files, write::Existing::Kept)?;
    for path in &written {
        output::print(&format!("wrote {}", path.display()));
    }
    if let [shader, graph, _, test] = written.as_slice() {
        let (shader, graph, test) = (quoted(shader), quoted(graph), quoted(test));
        output::print(&format!(
            "\nGo on with\n  volgraph render {graph} -o {name}.png\n  volgraph watch {graph} -o {name}.png\n  \
             volgraph test {test}\nand edit {shader}; volgraph's docs/technique.md is the guide."
        ));
    }
    Ok(ExitCode::SUCCESS)
}

/// A path as a shell takes it.
fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |c: char| c.is_alphanumeric() || "/._-:\\".contains(c);
    if text.chars().all(is_plain) {
        text
    } else {
        format!("'{}'", text.replace('\'', r"'\''"))
    }
}

/// The files by their paths: shader, graph, transfer function, test.
fn files(slot: &Slot, name: &str) -> Vec<(PathBuf, String)> {
    let of_slot = |text: &str| {
        text.replace(TECHNIQUE.slots, slot.slots)
            .replace(TECHNIQUE.params, slot.params)
            .replace(TECHNIQUE.differs, slot.differs)
            .replace("slot/technique/", &format!("slot/{}/", slot.name))
    };
    let shader = format!("slot/{}/{NAME}.wgsl", slot.name);
    [
        shader.as_str(),
        "new_name.ron",
        "transfer/new_name.ron",
        "tests/new_name.ron",
    ]
    .into_iter()
    .filter_map(|path| {
        let text = TEMPLATES.get_file(path)?.contents_utf8()?;
        let text = if path == shader {
            text.to_owned()
        } else {
            of_slot(text)
        };
        Some((path.replace(NAME, name).into(), text.replace(NAME, name)))
    })
    .collect()
}

/// A name that file systems and WGSL take, and that hides nothing of volgraph's own.
fn check_name(name: &str, slot: &str) -> Result<(), Findings> {
    let refuse = |code, message: String, help: &str| {
        Err(Findings::from(Finding::error(code, message).help(help)))
    };
    let is_plain = name.starts_with(|c: char| c.is_ascii_lowercase())
        && name
            .chars()
            .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
        && name.len() <= MAX_NAME
        && !name.contains("__");
    if !is_plain {
        return refuse(
            "bad-name",
            format!("`{}` cannot be the name of a shader", name.escape_debug()),
            "a name starts with a small letter and has small letters, digits and single `_`, at most 64: it becomes \
             the name of files, and functions carry it as their prefix",
        );
    }
    if RESERVED.contains(&name) || is_device(name) {
        return refuse(
            "bad-name",
            format!("`{name}` is reserved, by WGSL or as the name of a device"),
            "use another name",
        );
    }
    let choice = format!("slot/{slot}/{name}.wgsl");
    if EMBEDDED_SHADERS.get_file(&choice).is_some() {
        return refuse(
            "name-taken",
            format!(
                "`{name}` is volgraph's own choice for the slot `{slot}`, and {choice} would hide it"
            ),
            "use another name",
        );
    }
    if ready_graphs().iter().any(|graph| graph.name == name) {
        return refuse(
            "name-taken",
            format!("`{name}` is one of volgraph's ready graphs, and {name}.ron would hide it"),
            "use another name",
        );
    }
    Ok(())
}

/// Names that Windows keeps for devices, whatever their extension.
fn is_device(name: &str) -> bool {
    let numbered = |prefix| {
        name.strip_prefix(prefix).is_some_and(|rest: &str| {
            rest.len() == 1 && rest.starts_with(|c: char| c.is_ascii_digit())
        })
    };
    ["con", "prn", "aux", "nul"].contains(&name) || numbered("com") || numbered("lpt")
}

#[cfg(test)]
mod tests {
    use clap::ValueEnum;

    use super::*;

    fn code(name: &str) -> Option<&'static str> {
        check_name(name, "technique")
            .err()
            .map(|findings| findings.sorted()[0].code)
    }

    #[test]
    fn names_are_plain_and_free() {
        for name in ["glow", "glow_2", "x", "trilinear"] {
            assert_eq!(code(name), None, "{name}");
        }
        let long = "a".repeat(MAX_NAME + 1);
        for name in [
            "", "Glow", "2d", "_a", "a b", "a-b", "a.b", "a/b", "../a", "a__b", "ä", "a\0", &long,
            "fn", "struct", "con", "com1",
        ] {
            assert_eq!(code(name), Some("bad-name"), "{name:?}");
        }
        for name in ["dvr", "quickstart"] {
            assert_eq!(code(name), Some("name-taken"), "{name}");
        }
        assert!(check_name("trilinear", "reconstruct").is_err());
    }

    #[test]
    fn templates_get_the_name_and_the_slot_everywhere() {
        for slot in NewSlot::value_variants() {
            let slot = slot.slot();
            let files = files(&slot, "haze");
            let [(shader, wgsl), (graph_path, graph), _, (_, test)] = files.as_slice() else {
                panic!("{}: a template is missing", slot.name);
            };
            assert_eq!(shader, Path::new(&format!("slot/{}/haze.wgsl", slot.name)));
            assert_eq!(graph_path, Path::new("haze.ron"));
            for (path, text) in &files {
                assert!(!text.contains(NAME), "{}", path.display());
            }
            for part in [slot.slots, slot.params] {
                let part = part.replace(NAME, "haze");
                assert_eq!(graph.matches(&part).count(), 1, "{part} in {graph}");
            }
            assert!(
                graph.contains(&format!("slot/{}/haze.wgsl", slot.name)),
                "{graph}"
            );
            assert_eq!(test.matches(slot.differs).count(), 1, "{test}");
            assert!(wgsl.contains("@default"), "{wgsl}");
        }
    }
}
