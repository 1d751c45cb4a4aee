//! Errors planted into copies of volgraph's own shaders and graphs: `check` must name the author's own file, line and
//! column. The place is where the needle stands in the planted text.

use volgraph::Place;

use crate::{Scratch, copy};

struct Planted {
    what: &'static str,
    file: &'static str,
    /// This text, which stands in the file, is replaced; an empty one stands at the end.
    find: &'static str,
    with: &'static str,
    code: &'static str,
    /// Where the finding must be.
    needle: &'static str,
}

const PLANTED: [Planted; 13] = [
    Planted {
        what: "syntax",
        file: "shaders/slot/technique/dvr.wgsl",
        find: "let before = (*state).transmittance;",
        with: "let before = ) (*state).transmittance;",
        code: "wgsl-syntax",
        needle: ") (*state).transmittance;",
    },
    Planted {
        what: "type",
        file: "shaders/slot/classify/post.wgsl",
        find: "",
        with: "\nfn classify_wrong() {\n    var count: i32 = vec3f(1.0);\n}\n",
        code: "wgsl-type",
        needle: "count: i32",
    },
    Planted {
        what: "unknown name",
        file: "shaders/slot/light/phong.wgsl",
        find: "let to_eye = -ray.direction;",
        with: "let to_eye = -rya.direction;",
        code: "wgsl-type",
        needle: "rya.direction",
    },
    Planted {
        what: "name clash",
        file: "shaders/lib/volume.wgsl",
        find: "",
        with: "\nfn ray_through() {}\n",
        code: "name-clash",
        needle: "ray_through() {}",
    },
    Planted {
        what: "binding clash",
        file: "shaders/slot/gradient/stored.wgsl",
        find: "@group(1) @binding(4) var gradient_volume",
        with: "@group(1) @binding(1) var gradient_volume",
        code: "binding-clash",
        needle: "gradient_volume: texture_3d",
    },
    Planted {
        what: "missing import",
        file: "shaders/slot/light/phong.wgsl",
        find: "#import \"lib/volume.wgsl\"",
        with: "#import \"lib/volumes.wgsl\"",
        code: "missing-import",
        needle: "#import \"lib/volumes.wgsl\"",
    },
    Planted {
        what: "cyclic import",
        file: "shaders/lib/frame.wgsl",
        find: "struct Lens {",
        with: "#import \"lib/ray.wgsl\"\nstruct Lens {",
        code: "import-cycle",
        needle: "#import \"lib/ray.wgsl\"",
    },
    Planted {
        what: "unknown slot",
        file: "shaders/slot/technique/dvr.wgsl",
        find: "#import slot \"light\"",
        with: "#import slot \"lihgt\"",
        code: "slot-unset",
        needle: "#import slot \"lihgt\"",
    },
    Planted {
        what: "unknown choice",
        file: "graphs/quickstart.ron",
        find: "\"light\": \"phong\"",
        with: "\"light\": \"phnog\"",
        code: "unknown-choice",
        needle: "\"phnog\"",
    },
    Planted {
        what: "missing slot function",
        file: "shaders/slot/reconstruct/nearest.wgsl",
        find: "fn reconstruct_scalar(",
        with: "fn reconstruct_scaler(",
        code: "slot-function",
        needle: "// The scalar at a point",
    },
    Planted {
        what: "bad parameter doc",
        file: "shaders/slot/traverse/uniform.wgsl",
        find: "@default 1.0",
        with: "@default one",
        code: "params-doc",
        needle: "one @range",
    },
    Planted {
        what: "unknown uniform member",
        file: "shaders/lib/volume.wgsl",
        find: "struct Volume {",
        with: "struct Volume {\n    temperature: f32,",
        code: "uniform",
        needle: "volume: Volume;",
    },
    Planted {
        what: "validation",
        file: "shaders/slot/technique/dvr.wgsl",
        find: "",
        with: "\nfn technique_wrong(x: f32) -> bool {\n    return x * 2.0;\n}\n",
        code: "wgsl-validation",
        needle: "x * 2.0;",
    },
];

#[test]
fn each_planted_error_is_found_where_its_author_put_it() {
    let mut wrong = Vec::new();
    for planted in &PLANTED {
        let scratch = Scratch::new();
        copy("shaders", scratch.path());
        let quickstart =
            std::fs::read_to_string(crate::root().join("graphs/quickstart.ron")).unwrap();
        scratch.write("graphs/quickstart.ron", quickstart);
        copy("graphs/transfer", scratch.path());
        let text = std::fs::read_to_string(scratch.path().join(planted.file)).unwrap();
        assert!(
            text.contains(planted.find),
            "{}: {} has changed",
            planted.what,
            planted.file
        );
        let text = if planted.find.is_empty() {
            text + planted.with
        } else {
            text.replacen(planted.find, planted.with, 1)
        };
        scratch.write(planted.file, &text);
        let run = scratch.run(&[
            "check",
            "shaders",
            "graphs",
            "--shaders",
            "shaders",
            "--format",
            "json",
        ]);
        let start = text.find(planted.needle).unwrap();
        let place = Place::in_text(planted.file.as_ref(), &text, start, 1);
        let found = run.json();
        let is_it = |finding: &serde_json::Value| {
            finding["code"] == planted.code
                && finding["file"] == planted.file
                && finding["line"] == place.line
                && finding["column"] == place.column
        };
        if run.code != Some(1) || !found.as_array().unwrap().iter().any(is_it) {
            let listed: Vec<String> = found
                .as_array()
                .unwrap()
                .iter()
                .map(|f| {
                    format!(
                        "{} {}:{}:{} {}",
                        f["code"], f["file"], f["line"], f["column"], f["message"]
                    )
                })
                .collect();
            wrong.push(format!(
                "{}: exit {:?}, expected {} at {place}, found\n  {}",
                planted.what,
                run.code,
                planted.code,
                listed.join("\n  ")
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn without_a_planted_error_the_same_copy_passes() {
    let scratch = Scratch::new();
    copy("shaders", scratch.path());
    let run = scratch.run(&["check", "shaders", "--format", "json"]);
    assert_eq!((run.code, run.stdout.trim()), (Some(0), "[]"), "{run:?}");
}

#[test]
fn a_library_that_nobody_imports_is_checked_alone() {
    let scratch = Scratch::new();
    scratch.write(
        "shaders/lib/alone.wgsl",
        "// Nobody needs it.\nfn alone() -> f32 {\n    return nothing;\n}\n",
    );
    let run = scratch.run(&["check", "shaders"]);
    assert_eq!(run.code, Some(1));
    assert!(
        run.stderr.contains("shaders/lib/alone.wgsl:3:12"),
        "{}",
        run.stderr
    );
    assert!(run.stderr.contains("wgsl-type"), "{}", run.stderr);
    assert_eq!(run.stdout.trim(), "1 file checked, 1 error");
}

#[test]
fn a_choice_of_ones_own_is_checked_in_its_slot() {
    let scratch = Scratch::new();
    let good = "// The scalar at a point: one.\nfn reconstruct_scalar(position: vec3f) -> f32 {\n    return 1.0;\n}\n";
    scratch.write("mine/slot/reconstruct/one.wgsl", good);
    assert_eq!(scratch.run(&["check", "mine"]).code, Some(0));
    scratch.write(
        "mine/slot/reconstruct/one.wgsl",
        good.replace("(position: vec3f)", "(position: vec2f)"),
    );
    let run = scratch.run(&["check", "mine", "--format", "json"]);
    assert_eq!(run.code, Some(1), "it fits no caller: {run:?}");
    assert!(
        run.stdout.contains("in the slot `reconstruct`"),
        "{}",
        run.stdout
    );
}

#[test]
fn all_findings_of_all_files_come_at_once_and_in_order() {
    let scratch = Scratch::new();
    scratch.write("b.ron", "(nodes: {}, output: {})");
    scratch.write(
        "a.ron",
        "(points: [(at: 0, color: (1, 1, 1), opacity: 2), (at: 1, colr: 3)])",
    );
    scratch.write("c.wgsl", "fn c() { let x = ; }");
    scratch.write("d.ron", "(nothing: 1)");
    let run = scratch.run(&["check", ".", "a.ron", "--format", "json"]);
    let found = run.json();
    let codes: Vec<_> = found
        .as_array()
        .unwrap()
        .iter()
        .map(|f| (f["file"].as_str().unwrap(), f["code"].as_str().unwrap()))
        .collect();
    assert_eq!(run.code, Some(1));
    let files: Vec<_> = codes
        .iter()
        .map(|(file, _)| file.trim_start_matches("./"))
        .collect();
    let mut sorted = files.clone();
    sorted.sort_unstable();
    assert_eq!(files, sorted);
    for file in ["a.ron", "b.ron", "c.wgsl", "d.ron"] {
        assert!(files.contains(&file), "{file}: {codes:?}");
    }
    let run = scratch.run(&["check", ".", "--format", "github"]);
    assert!(
        run.stdout
            .lines()
            .any(|line| line.starts_with("::error file=") && line.contains(",line=1,col=")),
        "{run:?}"
    );
}

#[test]
fn a_graph_whose_data_is_elsewhere_is_checked_all_the_same() {
    let scratch = Scratch::new();
    scratch.write("t.ron", crate::TRANSFER);
    let graph = crate::graph("volume(path: \"far_9x9x9_uint8.raw\")");
    scratch.write("g.ron", &graph);
    let run = scratch.run(&["check", "g.ron"]);
    assert_eq!(run.code, Some(0), "{run:?}");
    assert!(
        run.stderr.contains("data-missing") && run.stderr.contains("g.ron:3:"),
        "{}",
        run.stderr
    );
    assert_eq!(run.stdout.trim(), "1 file checked, 1 warning");
    scratch.write(
        "g.ron",
        graph.replace(
            "\"rays\": \"box\" }",
            "\"rays\": \"box\" }, params: { \"stpe\": 1 }",
        ),
    );
    let run = scratch.run(&["check", "g.ron"]);
    assert_eq!(run.code, Some(1));
    assert!(
        run.stderr.contains("unknown-param") && run.stderr.contains("data-missing"),
        "{}",
        run.stderr
    );
}

#[test]
fn the_repositorys_own_shaders_and_graphs_pass() {
    let scratch = Scratch::new();
    let (shaders, graphs) = (root_path("shaders"), root_path("graphs"));
    let run = scratch.run(&["check", &shaders, &graphs]);
    assert_eq!(run.code, Some(0), "{run:?}");
}

fn root_path(name: &str) -> String {
    crate::root().join(name).display().to_string()
}
