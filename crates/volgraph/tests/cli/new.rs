//! From nothing to a tested shader, with the program alone: `new`, `graphs`, `test`, embedded graphs, and the guide.

use std::path::Path;

use volgraph::Picture;

use crate::{Run, SPHERE, Scratch, TRANSFER, graph, root};

const SMALL: [&str; 2] = ["--size", "48x48"];

impl Run {
    fn ok(self) -> Self {
        assert_eq!(self.code, Some(0), "{self:?}");
        self
    }

    /// The findings' codes, with exit code 1.
    fn refused(&self, codes: &[&str]) {
        let told: Vec<&str> = self
            .stderr
            .split("error[")
            .skip(1)
            .filter_map(|rest| rest.split(']').next())
            .collect();
        assert_eq!((self.code, told.as_slice()), (Some(1), codes), "{self:?}");
    }
}

impl Scratch {
    /// All files below the folder, sorted.
    fn files(&self) -> Vec<String> {
        fn search(folder: &Path, root: &Path, files: &mut Vec<String>) {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    search(&path, root, files);
                } else {
                    files.push(path.strip_prefix(root).unwrap().display().to_string());
                }
            }
        }
        let mut files = Vec::new();
        search(self.path(), self.path(), &mut files);
        files.sort();
        files
    }

    fn edit(&self, name: &str, find: &str, with: &str) {
        let text = std::fs::read_to_string(self.path().join(name)).unwrap();
        assert_eq!(text.matches(find).count(), 1, "{find} in {text}");
        self.write(name, text.replace(find, with));
    }

    fn render(&self, graph: &str, picture: &str) -> Run {
        self.run(&[&["render", graph, "-o", picture], &SMALL[..]].concat())
    }

    fn picture(&self, name: &str) -> Picture {
        Picture::load(&self.path().join(name)).unwrap()
    }
}

fn metadata(picture: &Picture, key: &str) -> String {
    let entry = picture.metadata.iter().find(|(name, _)| name == key);
    entry.unwrap_or_else(|| panic!("{key}")).1.clone()
}

#[test]
fn a_new_technique_checks_renders_and_passes_its_test() {
    let scratch = Scratch::new();
    let run = scratch.run(&["new", "technique", "haze"]).ok();
    let files = [
        "haze.ron",
        "slot/technique/haze.wgsl",
        "tests/haze.ron",
        "transfer/haze.ron",
    ];
    assert_eq!(scratch.files(), files);
    for part in [
        "wrote haze.ron",
        "volgraph render haze.ron",
        "volgraph watch haze.ron",
        "volgraph test tests/haze.ron",
    ] {
        assert!(run.stdout.contains(part), "{part}: {}", run.stdout);
    }
    let check = scratch.run(&["check", "."]).ok();
    assert_eq!(
        (check.stdout.trim(), check.stderr.as_str()),
        ("4 files checked", "")
    );
    scratch.render("haze.ron", "a.exr").ok();
    let picture = scratch.picture("a.exr");
    let brightest = picture
        .color
        .iter()
        .map(|color| color[0])
        .fold(0.0, f32::max);
    assert!(brightest > 0.1, "the picture is dark: {brightest}");
    let test = scratch.run(&["test", "."]).ok();
    assert!(
        test.stdout.ends_with("1 case, 4 expectations\n"),
        "{}",
        test.stdout
    );
    let json = scratch
        .run(&["test", "tests/haze.ron", "--json"])
        .ok()
        .json();
    let outcomes = json.as_array().unwrap();
    assert_eq!(outcomes.len(), 4);
    for outcome in outcomes {
        assert_eq!(outcome["passed"], true, "{outcome}");
        assert!(
            outcome["measured"].is_f64() && outcome["bound"].is_f64(),
            "{outcome}"
        );
    }
}

#[test]
fn every_slot_has_a_template_that_passes_its_test() {
    let scratch = Scratch::new();
    let slots = ["classify", "light", "traverse", "reconstruct", "gradient"];
    for slot in slots {
        let name = format!("my_{slot}");
        scratch
            .run(&["new", slot, &name, "--folder", &format!("deep/{slot}")])
            .ok();
        let check = scratch.run(&["check", &format!("deep/{slot}")]).ok();
        assert_eq!(check.stderr, "", "{slot}");
    }
    let test = scratch.run(&["test", "deep"]).ok();
    assert!(
        test.stdout.ends_with("5 cases, 20 expectations\n"),
        "{}",
        test.stdout
    );
}

#[test]
fn new_refuses_names_and_never_overwrites() {
    let scratch = Scratch::new();
    for (name, code) in [
        ("Haze", "bad-name"),
        ("../haze", "bad-name"),
        ("fn", "bad-name"),
        ("dvr", "name-taken"),
        ("quickstart", "name-taken"),
    ] {
        scratch.run(&["new", "technique", name]).refused(&[code]);
    }
    let run = scratch.run(&["new", "behind", "haze"]);
    assert!(
        run.code == Some(2) && run.stderr.contains("technique, classify, light"),
        "{run:?}"
    );
    assert_eq!(scratch.files(), [""; 0]);
    scratch.write("haze.ron", "mine");
    scratch.write("tests/haze.ron", "mine too");
    scratch
        .run(&["new", "technique", "haze"])
        .refused(&["file-exists", "file-exists"]);
    assert_eq!(
        scratch.files(),
        ["haze.ron", "tests/haze.ron"],
        "nothing is half-written"
    );
    assert_eq!(
        std::fs::read(scratch.path().join("haze.ron")).unwrap(),
        b"mine"
    );
}

/// A fault planted into the technique of `new`, and what its test says of it.
#[test]
fn planted_faults_fail_the_test() {
    let sum = "(*state).light += 0.5 * (front + back) * segment.length;";
    let faults = [
        // 0 / 0 where a ray only touches the box and has no segment.
        (
            "let light = state.light * params.tint * params.brightness;",
            "let light = state.light * params.tint * params.brightness / max(ray.far - ray.near, 0.0);",
            [false, false, false, false],
        ),
        (
            sum,
            "if segment.start + segment.length < ((*ray).far - (*ray).near) * 0.999999 { (*state).light += 0.5 * (front + back) * segment.length; }",
            [true, true, false, true],
        ),
        // A sum that is not weighted grows as the step shrinks.
        (
            sum,
            "(*state).light += 0.01 * (front + back);",
            [true, true, false, true],
        ),
        (
            "state.light * params.tint * params.brightness",
            "state.light * params.tint",
            [true, true, true, false],
        ),
        // An empty picture.
        (
            "(vec4f(light, 0.0)",
            "(vec4f(0.0 * light, 0.0)",
            [true, true, false, false],
        ),
    ];
    for (find, with, expected) in faults {
        let scratch = Scratch::new();
        scratch.run(&["new", "technique", "haze"]).ok();
        scratch.edit("slot/technique/haze.wgsl", find, with);
        let run = scratch.run(&["test", "tests", "--json"]);
        let passed: Vec<bool> = run
            .json()
            .as_array()
            .unwrap()
            .iter()
            .map(|outcome| outcome["passed"].as_bool().unwrap())
            .collect();
        assert_eq!(
            (run.code, passed.as_slice()),
            (Some(1), &expected[..]),
            "{with}\n{}",
            run.stdout
        );
        let text = scratch.run(&["test", "tests"]);
        assert_eq!(text.code, Some(1));
        let failed = expected.iter().filter(|passed| !**passed).count();
        assert_eq!(
            text.stdout.matches("FAILED").count(),
            failed,
            "{}",
            text.stdout
        );
        assert!(
            text.stdout.contains(&format!("{failed} failed")),
            "{}",
            text.stdout
        );
    }
}

#[test]
fn stages_that_disagree_and_pictures_that_are_not_equal_are_found() {
    let scratch = Scratch::new();
    scratch.write("t.ron", TRANSFER);
    scratch.write("g.ron", graph(SPHERE));
    // A raycast of one's own whose compute shader looks half a pixel aside.
    let raycast = std::fs::read_to_string(root().join("shaders/node/raycast.wgsl")).unwrap();
    let aside = raycast.replace("vec2f(pixel) + 0.5", "vec2f(pixel) + 1.0");
    assert_ne!(raycast, aside);
    scratch.write("mine/node/raycast.wgsl", aside);
    scratch.write(
        "c.ron",
        r#"(test: 1, graph: "g.ron", size: (32, 32), expect: [
            stages_agree(max: 1e-4),
            equals(set: ["image.step=1"], max: 1e-6),
            equals(set: ["image.step=4"], max: 1e-6),
            equals(graph: "embedded:/graphs/hydrogen.ron", max: 1e-6),
            differs(graph: "embedded:/graphs/hydrogen.ron", rmse: 0.01),
            differs(set: ["image.step=0.99"], rmse: 0.1),
            halving(param: "image.step", rmse: 1),
            halving(param: "image.step", from: 0.02, times: 2, rmse: 1),
        ])"#,
    );
    let passed = |args: &[&str]| -> Vec<bool> {
        let run = scratch.run(&[&["test", "c.ron", "--json"], args].concat());
        assert_eq!(run.code, Some(1), "{run:?}");
        let json = run.json();
        let outcomes = json.as_array().unwrap();
        // What cannot be measured says why, at the case's own place.
        assert_eq!(outcomes[6]["findings"][0]["code"], "no-start");
        assert_eq!(outcomes[7]["findings"][0]["code"], "bad-param");
        assert_eq!(outcomes[7]["findings"][0]["file"], "c.ron");
        outcomes
            .iter()
            .map(|outcome| outcome["passed"].as_bool().unwrap())
            .collect()
    };
    assert_eq!(
        passed(&[]),
        [true, true, false, false, true, false, false, false]
    );
    assert_eq!(
        passed(&["--shaders", "mine"]),
        [false, true, false, false, true, false, false, false]
    );
}

#[test]
fn cases_that_are_wrong_are_told_and_no_case_is_no_success() {
    let scratch = Scratch::new();
    scratch.write("t.ron", TRANSFER);
    scratch.write("g.ron", graph(SPHERE));
    scratch.run(&["test", "."]).refused(&["no-case"]);
    scratch.run(&["test", "no"]).refused(&["io"]);
    scratch.write(
        "a/bad.ron",
        "(test: 1, graph: \"../g.ron\", expect: [finite, finit])",
    );
    scratch.write(
        "a/lost.ron",
        "(test: 1, graph: \"g.ron\", expect: [finite])",
    );
    scratch.write(
        "a/name.ron",
        "(test: 1, graph: \"../g.ron\", expect: [differs(set: [\"imag.step=1\"], rmse: 1)])",
    );
    scratch.write(
        "good.ron",
        "(test: 1, graph: \"g.ron\", size: (16, 16), expect: [finite])",
    );
    let codes = ["unknown-expectation", "missing-graph", "unknown-node"];
    let check = scratch.run(&["check", "."]);
    check.refused(&codes);
    assert!(
        check.stdout.contains("6 files checked, 3 errors"),
        "{}",
        check.stdout
    );
    assert!(check.stderr.contains("a/bad.ron:1:47"), "{}", check.stderr);
    let test = scratch.run(&["test", "."]);
    test.refused(&codes);
    assert!(
        test.stdout.contains("ok      good.ron: finite"),
        "the others run: {}",
        test.stdout
    );
    assert!(
        test.stdout
            .contains("4 cases, 1 expectation, 3 cases cannot be run"),
        "{}",
        test.stdout
    );
    // A file that is named must be a case.
    scratch.run(&["test", "g.ron"]).refused(&[
        "missing-field",
        "unknown-field",
        "unknown-field",
        "unknown-field",
    ]);
    // A shader that does not compile fails what needs it, with its finding.
    scratch.run(&["new", "technique", "haze"]).ok();
    scratch.edit("slot/technique/haze.wgsl", "let light =", "let ligth =");
    let run = scratch.run(&["test", "tests/haze.ron"]);
    assert_eq!(
        (
            run.code,
            run.stdout.matches("could not be measured").count()
        ),
        (Some(1), 4),
        "{run:?}"
    );
    assert!(
        run.stderr.contains("slot/technique/haze.wgsl"),
        "{}",
        run.stderr
    );
}

#[test]
fn ready_graphs_are_drawn_by_name_without_a_file() {
    let scratch = Scratch::new();
    for (name, place) in [
        ("graphs/quickstart.ron", "graphs/quickstart.ron"),
        ("quickstart", "quickstart"),
        ("embedded:/graphs/image_background.ron", ""),
    ] {
        let run = scratch.render(name, "a.png").ok();
        let told = format!("note: there is no file {place} here");
        assert_eq!(
            run.stderr.contains(&told),
            !place.is_empty(),
            "{}",
            run.stderr
        );
    }
    let path = metadata(&scratch.picture("a.png"), "graph.path");
    assert_eq!(path, "embedded:/graphs/image_background.ron");
    // Findings name the embedded file and show its lines; the other commands take the names as well.
    let run = scratch.run(&["plan", "engine"]);
    run.refused(&["data-missing"]);
    for part in [
        "embedded:/graphs/engine.ron:5:",
        "\"engine\": volume(path: ",
        "file engine_256x256x128_uint8.raw.gz",
    ] {
        assert!(run.stderr.contains(part), "{part}: {}", run.stderr);
    }
    let check = scratch
        .run(&[
            "check",
            "quickstart",
            "embedded:/graphs/transfer/molecule.ron",
        ])
        .ok();
    assert!(check.stdout.contains("2 files checked"), "{check:?}");
    scratch
        .run(&[
            "bench",
            "quickstart",
            "--size",
            "16x16",
            "--frames",
            "1",
            "--warm-up",
            "0",
        ])
        .ok();
    let lost = scratch.run(&["render", "quikstart", "-o", "b.png"]);
    lost.refused(&["io"]);
    assert!(
        lost.stderr.contains("did you mean `quickstart`?"),
        "{}",
        lost.stderr
    );
    // Volumes come from the folders of data.
    let mut voxels = vec![0_u8; 103 * 94 * 161];
    voxels[500_000..800_000].fill(200);
    scratch.write("data/tooth_103x94x161_uint8.raw", voxels);
    let overridden = [
        "render",
        "tooth",
        "-o",
        "c.png",
        "--data",
        "data",
        "--set",
        "tooth.path=tooth_103x94x161_uint8.raw",
    ];
    scratch.run(&[&overridden[..], &SMALL[..]].concat()).ok();
}

#[test]
fn files_on_disk_win_and_never_fall_back_to_embedded_ones() {
    let scratch = Scratch::new();
    let small = graph(SPHERE).replace("t.ron", "transfer/molecule.ron");
    scratch.write("graphs/quickstart.ron", &small);
    // The transfer function is not there, and volgraph's own is not read in its place.
    let run = scratch.render("quickstart", "a.png");
    run.refused(&["io"]);
    for part in [
        "graphs/transfer/molecule.ron",
        "`path: \"embedded:/graphs/transfer/molecule.ron\"`",
    ] {
        assert!(run.stderr.contains(part), "{part}: {}", run.stderr);
    }
    scratch.write("graphs/transfer/molecule.ron", TRANSFER);
    scratch.render("quickstart", "a.exr").ok();
    let path = |picture: &str| metadata(&scratch.picture(picture), "graph.path");
    assert_eq!(path("a.exr"), "graphs/quickstart.ron");
    // Nearer ones first.
    scratch.write(
        "quickstart.ron",
        small.replace(
            "transfer/molecule.ron",
            "embedded:/graphs/transfer/molecule.ron",
        ),
    );
    scratch.render("quickstart", "b.exr").ok();
    assert_eq!(path("b.exr"), "quickstart.ron");
    let colors = |picture: &str| scratch.picture(picture).color;
    assert_ne!(
        colors("a.exr"),
        colors("b.exr"),
        "volgraph's own transfer function was named"
    );
    scratch.write(
        "quickstart.ron",
        small.replace(
            "transfer/molecule.ron",
            "embedded:/graphs/transfer/molecul.ron",
        ),
    );
    let run = scratch.render("quickstart", "c.exr");
    run.refused(&["io"]);
    assert!(
        run.stderr
            .contains("carries no file `embedded:/graphs/transfer/molecul.ron`"),
        "{}",
        run.stderr
    );
    // A file of the name that cannot be read is an error, and not another graph.
    scratch.write("hydrogen.ron", "no graph");
    scratch.render("hydrogen", "c.exr").refused(&["ron-syntax"]);
}

#[test]
fn ready_graphs_are_listed_shown_and_written() {
    let scratch = Scratch::new();
    let list = scratch.run(&["graphs"]).ok().stdout;
    for part in [
        "quickstart ",
        "A molar: enamel as a white cap",
        "[needs tooth_103x94x161_uint8.raw.gz]",
        "[needs no file]",
    ] {
        assert!(list.contains(part), "{part}: {list}");
    }
    let on_disk = std::fs::read_dir(root().join("graphs")).unwrap();
    let count = on_disk
        .filter(|entry| entry.as_ref().unwrap().path().is_file())
        .count();
    assert_eq!(list.lines().count(), count);
    let json = scratch.run(&["graphs", "--json"]).ok().json();
    assert_eq!(json.as_array().unwrap().len(), count);
    let shown = scratch.run(&["graphs", "quickstart"]).ok().stdout;
    assert_eq!(
        shown,
        std::fs::read_to_string(root().join("graphs/quickstart.ron")).unwrap()
    );
    scratch
        .run(&["graphs", "quickstat"])
        .refused(&["unknown-graph"]);
    scratch.run(&["graphs", "image_background", "--write"]).ok();
    let files = [
        "image_background.ron",
        "images/backdrop.png",
        "transfer/image_background.ron",
    ];
    assert_eq!(scratch.files(), files);
    for file in files {
        let original = std::fs::read(root().join("graphs").join(file)).unwrap();
        assert_eq!(
            std::fs::read(scratch.path().join(file)).unwrap(),
            original,
            "{file}"
        );
    }
    assert_eq!(
        scratch.render("image_background", "a.png").ok().stderr,
        "",
        "the copy is drawn"
    );
    scratch.write("transfer/image_background.ron", "mine");
    let run = scratch.run(&["graphs", "image_background", "--write"]);
    run.refused(&["file-exists"; 3]);
    assert!(run.stderr.contains("--force"), "{}", run.stderr);
    scratch
        .run(&["graphs", "image_background", "--write", "--force"])
        .ok();
    scratch.run(&["check", "."]).ok();
}

/// The guide's files are written as it says, and do what it says.
#[test]
fn the_guide_holds() {
    let guide = std::fs::read_to_string(root().join("docs/technique.md")).unwrap();
    let scratch = Scratch::new();
    let (mut rendered, mut told) = (Vec::new(), None);
    let mut lines = guide.lines();
    let mut before = "";
    while let Some(line) = lines.next() {
        if let Some(language) = line.strip_prefix("```") {
            let block: String = lines
                .by_ref()
                .take_while(|line| *line != "```")
                .map(|line| format!("{line}\n"))
                .collect();
            let name = before
                .strip_prefix('`')
                .and_then(|rest| rest.strip_suffix("`:"));
            match name {
                Some(name) => {
                    scratch.write(name, &block);
                }
                None if language == "text" => told = Some(block),
                None => assert_eq!(language, "sh", "a block without a name: {block}"),
            }
            before = "";
            let is_shader_or_graph = language == "wgsl" || language == "ron";
            if is_shader_or_graph && scratch.path().join("radiograph.ron").is_file() {
                let name = format!("{}.exr", rendered.len());
                scratch.render("radiograph.ron", &name).ok();
                rendered.push(scratch.picture(&name).color);
            }
        } else if !line.is_empty() {
            before = line;
        }
    }
    assert_eq!(rendered.len(), 3, "twenty lines, the parameters, the test");
    // The defaults of the parameters are the numbers that were there before.
    assert_eq!(rendered[0], rendered[1]);
    let test = scratch.run(&["test", "tests"]).ok();
    assert!(
        test.stdout.ends_with("1 case, 4 expectations\n"),
        "{}",
        test.stdout
    );
    let bright = scratch.run(
        &[
            &[
                "render",
                "radiograph.ron",
                "-o",
                "d.exr",
                "--set",
                "image.density=8",
            ],
            &SMALL[..],
        ]
        .concat(),
    );
    bright.ok();
    assert_ne!(scratch.picture("d.exr").color, rendered[1]);
    let listed = scratch
        .run(&["nodes", "raycast", "--shaders", "."])
        .ok()
        .stdout;
    assert!(
        listed.contains("param density = 4.0, 0 to 1000"),
        "{listed}"
    );
    // The error that it shows.
    scratch.run(&["check", "."]).ok();
    scratch.edit(
        "slot/technique/radiograph.wgsl",
        "params.density ",
        "params.densty ",
    );
    let run = scratch.run(&["check", "."]);
    assert!(
        run.stderr.contains(told.unwrap().trim_end()),
        "{}",
        run.stderr
    );
}
