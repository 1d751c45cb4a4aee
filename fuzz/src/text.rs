//! Graphs, transfer functions and shaders: text that people write.

use std::fmt::Debug;
use std::path::Path;
use std::sync::{Arc, LazyLock};

use include_dir::{Dir, include_dir};
use indexmap::IndexMap;
use naga::valid::Capabilities;
use volgraph_graph::demand::ShaderLibrary;
use volgraph_graph::{
    Folders, GraphDesc, Limits, Plan, PlanRequest, Registry, Source, View, read, resolve, sources,
};
use volgraph_optics::TransferFunction;
use volgraph_report::{Findings, excerpt};
use volgraph_shader::{
    GuardRequest, LinkRequest, MemoryFiles, Module, ShaderRoots, check, guard, link,
};

static SHADERS: Dir<'static> = include_dir!("$CARGO_MANIFEST_DIR/../shaders");

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

pub(crate) fn planned(text: &str) -> Option<Plan> {
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

pub(crate) fn checked(text: &str) -> Option<Module> {
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

pub(crate) fn file() -> &'static Path {
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
