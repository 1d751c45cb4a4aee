//! From nothing to a tested shader, with the program alone.

mod embedded;
mod guide;

use std::path::Path;

use volgraph::Picture;

use crate::{Run, SPHERE, Scratch, TRANSFER, graph, root};

/// A small picture, from the same stage each time.
pub const SMALL: [&str; 4] = ["--size", "48x48", "--set", "image.stage=fragment"];

impl Run {
    pub fn ok(self) -> Self {
        assert_eq!(self.code, Some(0), "{self:?}");
        self
    }

    /// The findings' codes, with exit code 1.
    pub fn refused(&self, codes: &[&str]) {
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
    pub fn files(&self) -> Vec<String> {
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

    pub fn edit(&self, name: &str, find: &str, with: &str) {
        let text = std::fs::read_to_string(self.path().join(name)).unwrap();
        assert_eq!(text.matches(find).count(), 1, "{find} in {text}");
        self.write(name, text.replace(find, with));
    }

    pub fn render(&self, graph: &str, picture: &str) -> Run {
        self.run(&[&["render", graph, "-o", picture], &SMALL[..]].concat())
    }

    pub fn picture(&self, name: &str) -> Picture {
        Picture::load(&self.path().join(name)).unwrap()
    }
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
