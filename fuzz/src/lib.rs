//! What each fuzz target does with its bytes; the files in `fuzz_targets` only hand them over.
//!
//! The way of the data: libFuzzer makes bytes from the seeds in `seeds/TARGET` and the words in
//! `dictionaries/TARGET.dict`; a function here feeds them to one parser and, where that is content, uses what it
//! gave in the way the rest of volgraph does. A target fails by a panic, by what the address sanitiser sees, by one
//! input that takes seconds, or by an allocation of hundreds of MiB: inputs have some KiB, so nothing they say can be
//! worth so much. `cargo xtask fuzz` runs all targets with those limits.

use std::fmt::Debug;
use std::path::Path;
use std::sync::{Arc, LazyLock};

use include_dir::{Dir, include_dir};
use indexmap::IndexMap;
use naga::valid::Capabilities;
use volgraph_formats::{LoadOptions, from_bytes, metaimage as meta, nrrd as near, parse_raw_name};
use volgraph_graph::demand::ShaderLibrary;
use volgraph_graph::{
    Folders, GraphDesc, Limits, Plan, PlanRequest, Registry, Source, View, read, resolve, sources,
};
use volgraph_optics::TransferFunction;
use volgraph_report::{Findings, excerpt};
use volgraph_shader::{
    GuardRequest, LinkRequest, MemoryFiles, Module, ShaderRoots, check, guard, link,
};
use volgraph_volume::Component;

static SHADERS: Dir<'static> = include_dir!("$CARGO_MANIFEST_DIR/../shaders");

/// A file's name up to the first line feed, its bytes behind it: the name is parsed, and where it parses the bytes
/// are read as its voxels. A name that parses means the same when it is written plainly.
pub fn raw_name(data: &[u8]) {
    let end = data
        .iter()
        .position(|byte| *byte == b'\n')
        .unwrap_or(data.len());
    let Ok(name) = std::str::from_utf8(&data[..end]) else {
        return;
    };
    let Ok(raw) = parse_raw_name(name) else {
        return;
    };
    let [x, y, z] = raw.dims;
    let plain = parse_raw_name(&format!("{}_{x}x{y}x{z}_{}.raw", raw.name, raw.scalar_type))
        .expect("a plain name");
    assert_eq!((raw.dims, raw.scalar_type), (plain.dims, plain.scalar_type));
    volume(name, data.get(end + 1..).unwrap_or_default(), None);
}

/// An NRRD file; the first byte chooses the component.
pub fn nrrd(data: &[u8]) {
    let Some((first, bytes)) = data.split_first() else {
        return;
    };
    let _ = near::parse_header(bytes);
    volume("fuzzed.nrrd", bytes, component(*first));
}

/// A MetaImage file; the first byte chooses the component.
pub fn metaimage(data: &[u8]) {
    let Some((first, bytes)) = data.split_first() else {
        return;
    };
    let _ = meta::parse_header(bytes);
    volume("fuzzed.mha", bytes, component(*first));
}

/// The text of a graph file, as far as names go: read, its names looked up without sources, its camera fitted.
pub fn graph(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    let Some(desc) = told(read::graph(file(), text), text) else {
        return;
    };
    told(resolve::resolve(&desc, &IndexMap::new(), &REGISTRY), text);
    if let Some(camera) = &desc.camera {
        let cube = [-1.0, 1.0].map(|side| [side; 3].into());
        for size in [[300, 600], [600, 300]] {
            let camera = camera.fit(&cube, f64::from(size[0]) / f64::from(size[1]));
            let view = View {
                camera,
                size,
                window: None,
            };
            let _ = (view.lens(), view.pixel_bounds(&cube));
        }
    }
}

/// The text of a graph file, through all phases to a printed plan. The sources `molecule` and `colors` are the
/// quickstart's, whatever the text says of them; others cannot be loaded.
pub fn plan(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    let Some(plan) = planned(text) else { return };
    let _ = (plan.to_text(), plan.to_json(), plan.to_dot());
    let view = plan.view();
    let _ = plan.fingerprints(&view);
    for id in &plan.order {
        let _ = plan.record(*id, &view, plan.variants(*id).first().copied());
    }
}

fn planned(text: &str) -> Option<Plan> {
    let desc = read::graph(file(), text).ok()?;
    let request = PlanRequest {
        desc: &desc,
        sources: &SOURCES,
        registry: &REGISTRY,
        shaders: &LIBRARY,
        limits: &Limits::default(),
        size: [64, 48],
        extra_outputs: &[("depth", "color", "depth")],
    };
    told(Plan::build(request), text)
}

/// The text of a transfer function; what is read can be tabulated, and reads back equal from what is written.
pub fn transfer(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    let Some(transfer) = told(TransferFunction::parse(file(), text), text) else {
        return;
    };
    let written = transfer.to_ron();
    let again = TransferFunction::parse(file(), &written).expect("what is written reads back");
    assert_eq!(again, transfer);
    assert_eq!(again.to_ron(), written);
    let post = transfer.post_table(1024).expect("a table of a usual size");
    let pairs = transfer
        .preintegrated_table(64, 0.5)
        .expect("a table of a usual size");
    let indices = transfer
        .refraction_table(1024)
        .expect("a table of a usual size");
    assert!(indices.iter().all(|index| (1.0..=4.0).contains(index)));
    for entry in post.entries.iter().chain(&pairs.entries) {
        assert!(
            entry.iter().all(|value| value.is_finite() && *value >= 0.0),
            "{entry:?}"
        );
    }
}

/// Shader files in one text: a line `//// PATH` begins each but the first, which is `root.wgsl`. They are linked
/// over volgraph's own, and where that goes well checked.
pub fn shader(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    if let Some(module) = checked(text) {
        let _ = format!("{:?}", module.info);
        let names: Vec<String> = module
            .entry_points()
            .iter()
            .map(|entry| entry.name.clone())
            .collect();
        let entries: Vec<&str> = names.iter().map(String::as_str).collect();
        let request = GuardRequest {
            max_steps: 1000,
            entries: &entries,
        };
        let guarded = guard(&module, request, Capabilities::default());
        // A module that naga takes is guarded, whatever is in it: only numbers of bindings can run out.
        if let Some(reason) = &guarded.unguarded {
            assert!(reason.contains("binding numbers"), "{reason}");
        }
    }
}

fn checked(text: &str) -> Option<Module> {
    let mut pieces = text.split("//// ");
    let mut files = MemoryFiles::new().with("root.wgsl", pieces.next().unwrap_or_default());
    for piece in pieces.take(8) {
        let (path, body) = piece.split_once('\n').unwrap_or((piece, ""));
        files = files.with(path, body);
    }
    let roots = ShaderRoots::new(Arc::new(files))
        .root("")
        .embedded(&SHADERS);
    let mut request = LinkRequest::new("root.wgsl").slot("own", "own.wgsl");
    for (slot, choice) in REGISTRY.default_slots() {
        request = request.slot(slot, choice);
    }
    let linked = told(link(&roots, &request), text)?;
    told(check(linked, Capabilities::default()), text)
}

/// Lets panics of naga pass that volgraph catches on a thread of its own and tells as a finding; to be called once,
/// before the first input.
pub fn forgive_naga() {
    let abort = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        if std::thread::current().name() != Some("volgraph-shader-check") {
            abort(info);
        }
    }));
}

static REGISTRY: LazyLock<Registry> = LazyLock::new(volgraph_nodes::registry);

static LIBRARY: LazyLock<ShaderLibrary> = LazyLock::new(|| {
    let roots = ShaderRoots::new(Arc::new(MemoryFiles::new())).embedded(&SHADERS);
    ShaderLibrary::new(roots, Capabilities::default(), None)
});

static SOURCES: LazyLock<IndexMap<String, Arc<dyn Source>>> = LazyLock::new(|| {
    let text = r#"(sources: {
        "molecule": analytic(field: "c60", dims: (8, 8, 8), type: "uint8"),
        "colors": transfer(path: "transfer/molecule.ron"),
    }, outputs: { "color": "image.color" })"#;
    let desc: GraphDesc = read::graph(file(), text).expect("the sources' own text");
    let graphs = Folders::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../graphs"), &[]);
    let (loaded, findings) = sources::load(&desc, &REGISTRY, &graphs, &|_, _, _| ());
    assert!(findings.is_empty(), "{findings}");
    loaded
});

fn file() -> &'static Path {
    Path::new("fuzzed.ron")
}

/// Every finding can be printed with its excerpt.
fn told<T>(result: Result<T, impl Into<Findings> + Debug>, text: &str) -> Option<T> {
    result
        .map_err(|findings| {
            let findings = findings.into();
            assert!(!findings.is_empty());
            let text = excerpt::render(&findings, |_| Some(text.to_owned()), false);
            // A test that fails shows why.
            #[cfg(test)]
            eprintln!("{text}");
            text
        })
        .ok()
}

fn component(byte: u8) -> Option<u32> {
    (byte & 3).checked_sub(1).map(u32::from)
}

/// Whatever is read is whole; whatever is refused says why and what to do.
fn volume(name: &str, bytes: &[u8], component: Option<u32>) {
    let options = LoadOptions {
        component: component.map(Component::Index),
        ..LoadOptions::default()
    };
    match from_bytes(name, bytes, &options) {
        Ok(volume) => {
            assert_eq!(volume.voxels().len() as u64, volume.grid().voxel_count());
            assert!(volume.grid().check().is_ok());
            let (low, high) = volume.grid().box_index();
            let _ = (
                volume.trilinear(low),
                volume.trilinear(high),
                volume.digest(),
                volume.histogram(16),
            );
            let _ = volume.statistics().percentile(50.0);
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            assert!(!error.trouble().remedy.is_empty());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Target = fn(&[u8]);

    /// The seeds of a target by name.
    fn seeds(target: &str) -> Vec<(String, Vec<u8>)> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("seeds")
            .join(target);
        let files = std::fs::read_dir(folder).expect("a folder of seeds");
        files
            .map(|file| {
                let file = file.expect("a seed");
                let bytes = std::fs::read(file.path()).expect("a seed that can be read");
                (file.file_name().to_string_lossy().into_owned(), bytes)
            })
            .collect()
    }

    #[test]
    fn every_seed_passes() {
        let targets: [(&str, Target); 7] = [
            ("raw_name", raw_name),
            ("nrrd", nrrd),
            ("metaimage", metaimage),
            ("graph", graph),
            ("plan", plan),
            ("transfer", transfer),
            ("shader", shader),
        ];
        for (name, target) in targets {
            for (_, bytes) in seeds(name) {
                target(&bytes);
            }
        }
    }

    /// A seed that is refused at the door teaches a fuzzer little.
    #[test]
    fn most_seeds_are_good_input() {
        let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("text");
        for (name, bytes) in seeds("plan") {
            assert!(planned(&text(&bytes)).is_some(), "plan/{name}");
        }
        for (name, bytes) in seeds("transfer") {
            assert!(
                TransferFunction::parse(file(), &text(&bytes)).is_ok(),
                "transfer/{name}"
            );
        }
        for (name, bytes) in seeds("shader") {
            assert_eq!(
                checked(&text(&bytes)).is_some(),
                name != "cycle",
                "shader/{name}"
            );
        }
        for (name, bytes) in seeds("nrrd").into_iter().chain(seeds("metaimage")) {
            let options = LoadOptions {
                component: component(bytes[0]).map(Component::Index),
                ..LoadOptions::default()
            };
            let is_detached = ["list", "series"].contains(&name.as_str());
            let volume = from_bytes("seed", &bytes[1..], &options);
            assert_eq!(volume.is_err(), is_detached, "{name}: {volume:?}");
        }
    }
}
