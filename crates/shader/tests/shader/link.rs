//! Imports, slots, directives, and what is wrong with them.

use std::path::Path;
use std::sync::Arc;

use include_dir::{Dir, include_dir};
use volgraph_shader::{DiskFiles, LinkRequest, MemoryFiles, ShaderRoots, link};

use crate::{Files, assert_at, codes, only};

static EMBEDDED: Dir<'static> = include_dir!("$CARGO_MANIFEST_DIR/tests/embedded");

#[test]
fn each_file_is_included_once_and_imports_come_first() {
    let files = Files::new(&[
        (
            "shaders/a.wgsl",
            "// a\n#import \"lib/b.wgsl\"\n#import \"lib/../lib/c.wgsl\"\nconst a = 1;\n",
        ),
        ("shaders/lib/b.wgsl", "#import \"c.wgsl\"\nconst b = c;"),
        ("shaders/lib/c.wgsl", "const c = 1;\n"),
    ]);
    let linked = files.link().unwrap();
    let declarations: Vec<_> = linked
        .text
        .lines()
        .filter(|line| line.starts_with("const"))
        .collect();
    assert_eq!(
        declarations,
        ["const c = 1;", "const b = c;", "const a = 1;"]
    );
    let paths: Vec<_> = linked
        .files
        .iter()
        .map(|file| file.path.to_str().unwrap())
        .collect();
    assert_eq!(
        paths,
        ["shaders/lib/c.wgsl", "shaders/lib/b.wgsl", "shaders/a.wgsl"]
    );
    assert!(!linked.text.contains("#import"));
    for (path, needle) in [
        ("shaders/lib/c.wgsl", "c = 1"),
        ("shaders/lib/b.wgsl", "b = c"),
        ("shaders/a.wgsl", "a = 1"),
    ] {
        let at = linked.text.find(needle).unwrap();
        assert_eq!(linked.place(at, needle.len()), files.place(path, needle));
    }
    assert_eq!(
        linked.file_text(Path::new("shaders/lib/c.wgsl")),
        Some("const c = 1;\n")
    );
    assert_eq!(linked, files.link().unwrap());
}

#[test]
fn the_importers_folder_is_tried_before_the_roots() {
    let files = Files::new(&[
        ("shaders/a.wgsl", "#import \"user/b.wgsl\""),
        (
            "shaders/user/b.wgsl",
            "#import \"c.wgsl\"\n#import \"d.wgsl\"",
        ),
        ("shaders/user/c.wgsl", "const near = 1;"),
        ("shaders/c.wgsl", "const far = 1;"),
        ("shaders/d.wgsl", "const root = 1;"),
    ]);
    let text = files.link().unwrap().text;
    assert!(
        text.contains("near") && text.contains("root") && !text.contains("far"),
        "{text}"
    );
}

#[test]
fn the_digest_follows_the_text() {
    let digest = |text| Files::one(text).link().unwrap().digest;
    assert_eq!(digest("const a = 1;\n"), digest("const a = 1;\n"));
    assert_ne!(digest("const a = 1;\n"), digest("const a = 2;\n"));
}

#[test]
fn a_cycle_shows_its_chain() {
    let files = Files::new(&[
        ("shaders/a.wgsl", "#import \"b.wgsl\"\n"),
        ("shaders/b.wgsl", "// why\n  #import \"c.wgsl\"\n"),
        ("shaders/c.wgsl", "\n\n#import \"./b.wgsl\"\n"),
    ]);
    let finding = only(files.link());
    assert_at(
        &finding,
        "import-cycle",
        &files,
        "shaders/c.wgsl",
        "#import",
    );
    assert!(
        finding
            .message
            .contains("`shaders/b.wgsl` → `shaders/c.wgsl` → `shaders/b.wgsl`"),
        "{finding}"
    );
    assert_eq!(finding.related.len(), 1);
    assert_eq!(
        finding.related[0].0,
        files.place("shaders/b.wgsl", "#import \"c.wgsl\"")
    );
    let finding = only(Files::one("#import \"a.wgsl\"").link());
    assert_eq!(finding.code, "import-cycle");
}

#[test]
fn a_long_chain_of_imports_is_refused() {
    let chain = (0..200).fold(MemoryFiles::new(), |memory, at| {
        memory.with(
            format!("shaders/{at}.wgsl"),
            format!("#import \"{}.wgsl\"\n", at + 1),
        )
    });
    let roots = ShaderRoots::new(Arc::new(chain)).root("shaders");
    let finding = only(link(&roots, &LinkRequest::new("0.wgsl")));
    assert_eq!(finding.code, "import-depth");
}

#[test]
fn a_missing_import_tells_where_it_was_looked_for() {
    let files = Files::new(&[
        (
            "shaders/node/a.wgsl",
            "const a = 1;\n#import \"lib/rya.wgsl\"\n#import \"x.wgsl\"\n",
        ),
        ("shaders/lib/ray.wgsl", ""),
    ]);
    let findings = link(&files.roots(), &LinkRequest::new("node/a.wgsl")).unwrap_err();
    let findings = findings.sorted();
    assert_eq!(findings.len(), 2);
    assert_at(
        findings[0],
        "missing-import",
        &files,
        "shaders/node/a.wgsl",
        "#import \"lib",
    );
    assert!(
        findings[0]
            .message
            .contains("`shaders/node/lib/rya.wgsl`, `shaders/lib/rya.wgsl`")
    );
    assert_eq!(
        findings[0].help.as_deref(),
        Some("did you mean `lib/ray.wgsl`?")
    );
    assert_at(
        findings[1],
        "missing-import",
        &files,
        "shaders/node/a.wgsl",
        "#import \"x",
    );
}

#[test]
fn a_missing_root_is_told() {
    let files = Files::new(&[("shaders/node/raycast.wgsl", "")]);
    let finding = only(link(&files.roots(), &LinkRequest::new("node/raycats.wgsl")));
    assert_eq!(finding.code, "missing-shader");
    assert_eq!(
        finding.help.as_deref(),
        Some("did you mean `node/raycast.wgsl`?")
    );
}

#[test]
fn bad_import_lines_are_told_all() {
    let files = Files::one("#include \"b\"\n#import b.wgsl\nconst a = 1; #import \"b.wgsl\"\n");
    assert_eq!(codes(files.link()), ["import-syntax"; 3]);
    let finding = only(Files::one("\n  #import slot clip\n").link());
    let place = finding.place.unwrap();
    assert_eq!((place.line, place.column, place.length), (2, 3, 17));
}

#[test]
fn directives_stand_on_top_once() {
    let files = Files::new(&[
        (
            "shaders/a.wgsl",
            "#import \"b.wgsl\"\nenable  f16;\nconst a: f16 = 1.0h;\n",
        ),
        (
            "shaders/b.wgsl",
            "// b\nenable f16;\ndiagnostic(off, derivative_uniformity);\nconst b: f16 = 1.0h;\n",
        ),
    ]);
    let linked = files.link().unwrap();
    assert!(
        linked
            .text
            .starts_with("enable f16;\ndiagnostic(off, derivative_uniformity);\n"),
        "{}",
        linked.text
    );
    assert_eq!(linked.text.matches("f16;").count(), 1);
    assert_eq!(linked.place(0, 6), files.place("shaders/b.wgsl", "enable"));
    volgraph_shader::check(linked, naga::valid::Capabilities::all()).unwrap();
}

fn with_slot() -> Files {
    Files::new(&[
        (
            "shaders/a.wgsl",
            "const first = 1;\n#import slot \"clip\"\n#import slot \"clip\"\n",
        ),
        ("shaders/slot/clip/none.wgsl", "const none = 1;\n"),
        (
            "shaders/slot/clip/planes.wgsl",
            "#import \"lib.wgsl\"\nconst planes = 1;\n",
        ),
        ("shaders/slot/clip/lib.wgsl", "const lib = 1;\n"),
        ("graphs/mine.wgsl", "const mine = 1;\n"),
    ])
}

#[test]
fn a_slot_takes_a_choice_or_a_path() {
    let files = with_slot();
    let request = LinkRequest::new("a.wgsl").base("graphs");
    let linked = link(&files.roots(), &request.clone().slot("clip", "planes")).unwrap();
    assert!(
        linked.text.contains("planes")
            && linked.text.contains("lib")
            && !linked.text.contains("none")
    );
    assert_eq!(
        linked.slots_used["clip"],
        Path::new("shaders/slot/clip/planes.wgsl")
    );
    assert_eq!(linked.slots_asked["clip"].len(), 2);
    assert_eq!(
        linked.slots_asked["clip"][0],
        files.place("shaders/a.wgsl", "#import slot \"clip\"")
    );
    let linked = link(&files.roots(), &request.slot("clip", "mine.wgsl")).unwrap();
    assert_eq!(linked.slots_used["clip"], Path::new("graphs/mine.wgsl"));
    assert_eq!(files.roots().choices("clip"), ["lib", "none", "planes"]);
}

#[test]
fn a_slot_without_a_right_choice_is_told_at_its_import() {
    let files = with_slot();
    let finding = link(&files.roots(), &LinkRequest::new("a.wgsl")).unwrap_err();
    assert_at(
        finding.sorted()[0],
        "slot-unset",
        &files,
        "shaders/a.wgsl",
        "#import slot",
    );
    assert!(
        finding.sorted()[0]
            .help
            .as_ref()
            .unwrap()
            .contains("`none`, `planes`")
    );
    for (choice, near) in [
        ("plans", "did you mean `planes`?"),
        ("xyz", "`none`, `planes`"),
        ("../a", "`none`"),
        ("gone.wgsl", ""),
    ] {
        let findings = link(
            &files.roots(),
            &LinkRequest::new("a.wgsl").slot("clip", choice),
        )
        .unwrap_err();
        let finding = findings.sorted()[0];
        assert_at(
            finding,
            "unknown-choice",
            &files,
            "shaders/a.wgsl",
            "#import slot",
        );
        assert!(
            finding.help.clone().unwrap_or_default().contains(near),
            "{finding}"
        );
    }
}

#[test]
fn the_embedded_set_comes_last() {
    let files = Files::new(&[(
        "shaders/a.wgsl",
        "#import \"lib/twice.wgsl\"\n#import slot \"clip\"\nconst a = 1;\n",
    )]);
    let roots = files.roots().embedded(&EMBEDDED);
    let request = LinkRequest::new("a.wgsl").slot("clip", "none");
    let linked = link(&roots, &request).unwrap();
    let paths: Vec<_> = linked
        .files
        .iter()
        .map(|file| file.path.to_str().unwrap())
        .collect();
    assert_eq!(
        paths,
        [
            "embedded:/lib/base.wgsl",
            "embedded:/lib/twice.wgsl",
            "embedded:/slot/clip/none.wgsl",
            "shaders/a.wgsl"
        ]
    );
    assert_eq!(roots.choices("clip"), ["none"]);
    assert_eq!(
        roots.list("lib"),
        [Path::new("lib/base.wgsl"), Path::new("lib/twice.wgsl")]
    );
    let files = Files::new(&[
        ("shaders/a.wgsl", "#import \"lib/twice.wgsl\"\n"),
        ("shaders/lib/twice.wgsl", "const own = 1;"),
    ]);
    let linked = link(
        &files.roots().embedded(&EMBEDDED),
        &LinkRequest::new("a.wgsl"),
    )
    .unwrap();
    assert!(linked.text.contains("own") && !linked.text.contains("embedded_twice"));
}

#[test]
fn files_on_disk_link_and_what_is_no_text_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("a.wgsl"), "#import \"b.wgsl\"\n").unwrap();
    std::fs::write(path("b.wgsl"), "const b = 1;").unwrap();
    let roots = ShaderRoots::on_disk().root(folder.path());
    let linked = link(&roots, &LinkRequest::new("a.wgsl")).unwrap();
    assert_eq!(
        linked.files[0].resolved,
        path("b.wgsl").canonicalize().unwrap()
    );
    std::fs::write(path("b.wgsl"), [0xff, 0xfe]).unwrap();
    assert_eq!(
        only(link(&roots, &LinkRequest::new("a.wgsl"))).code,
        "shader-read"
    );
    let memory = MemoryFiles::over(Arc::new(DiskFiles)).with(path("b.wgsl"), "const b = 2;");
    let roots = ShaderRoots::new(Arc::new(memory)).root(folder.path());
    assert!(
        link(&roots, &LinkRequest::new("a.wgsl"))
            .unwrap()
            .text
            .contains("b = 2")
    );
}

#[test]
fn too_much_text_is_refused() {
    let finding = only(Files::one(&"// much\n".repeat(140_000)).link());
    assert_eq!(finding.code, "too-large");
}

#[test]
fn the_annotated_text_names_the_files() {
    let files = Files::new(&[
        (
            "shaders/a.wgsl",
            "#import \"b.wgsl\"\n\nstruct Params {\n    /// @default 1\n    a: f32,\n}\nconst a = 1;\n",
        ),
        ("shaders/b.wgsl", "const b = 1;"),
    ]);
    let linked = files.link().unwrap();
    let annotated = linked.annotated();
    for comment in [
        "// from shaders/b.wgsl:1\nconst b = 1;",
        "// from shaders/a.wgsl:4\n/// @default 1",
        "// from shaders/a.wgsl:7\n\nconst a = 1;",
    ] {
        assert!(annotated.contains(comment), "{annotated}");
    }
    let without: String = annotated
        .lines()
        .filter(|line| !line.starts_with("// from "))
        .map(|line| format!("{line}\n"))
        .collect();
    assert_eq!(without, linked.text);
}

#[test]
fn comments_hold_no_imports_and_odd_line_ends_work() {
    let files = Files::new(&[
        (
            "shaders/a.wgsl",
            "\u{feff}// x\r\n/* \r\n#import \"none.wgsl\"\r\n/* */ */\r\n#import \"b.wgsl\"\r\nconst a = b;\r\n",
        ),
        ("shaders/b.wgsl", "const b = 1; // no newline at the end"),
    ]);
    let module = files.check().unwrap();
    assert_eq!(module.linked.files.len(), 2);
}
