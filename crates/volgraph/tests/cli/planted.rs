//! Errors planted into copies of volgraph's own shaders and graphs: `check` must name the author's own file, line and
//! column. The place is where the needle stands in the planted text.

mod table;

use volgraph::Place;

use self::table::{A, B, C, GRAPH, MINE, PLANTED, Planted};
use crate::{Run, Scratch, copy};

/// volgraph's shaders with the author's files behind the technique, and a graph.
fn sound() -> Scratch {
    let scratch = Scratch::new();
    copy("shaders", scratch.path());
    for (name, text) in MINE {
        scratch.write(name, text);
    }
    let technique = "shaders/slot/technique/dvr.wgsl";
    let text = std::fs::read_to_string(scratch.path().join(technique)).unwrap();
    let import = "#import slot \"light\"\n";
    assert!(text.contains(import), "dvr has changed");
    scratch.write(
        technique,
        text.replace(import, &format!("{import}#import \"mine/a.wgsl\"\n")),
    );
    let quickstart = std::fs::read_to_string(crate::root().join(GRAPH)).unwrap();
    scratch.write(GRAPH, quickstart);
    copy("graphs/transfer", scratch.path());
    scratch
}

/// The folders with the author's files and those that mistakes are planted in. Slots of which nothing is planted would be
/// checked again for each mistake; of one mistake they are, and of none.
const TOUCHED: [&str; 9] = [
    "shaders/lib",
    "shaders/mine",
    "shaders/node",
    "shaders/slot/classify",
    "shaders/slot/gradient",
    "shaders/slot/light",
    "shaders/slot/reconstruct",
    "shaders/slot/technique",
    "graphs",
];
const ALL: [&str; 2] = ["shaders", "graphs"];

/// A mistake of a library that most shaders import.
const IN_ALL: &str = "shaders/lib/volume.wgsl";

fn check(scratch: &Scratch, folders: &[&str]) -> Run {
    let options = ["--shaders", "shaders", "--format", "json"];
    scratch.run(&[&["check"], folders, &options].concat())
}

/// Plants a mistake; where it must be found.
fn plant(planted: &Planted, scratch: &Scratch) -> Place {
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
    let start = text.find(planted.needle).unwrap();
    Place::in_text(planted.file.as_ref(), &text, start, 1)
}

/// The planted mistakes are found where they are, and nothing else is.
fn verdict(planted: &Planted) -> Result<(), String> {
    let scratch = sound();
    let all: Vec<&Planted> = std::iter::once(planted).chain(planted.also).collect();
    let places: Vec<Place> = all.iter().map(|each| plant(each, &scratch)).collect();
    let is_in_all = all.iter().any(|planted| planted.file == IN_ALL);
    let folders: &[&str] = if is_in_all { &ALL } else { &TOUCHED };
    let is_looked_at = |planted: &&Planted| folders.iter().any(|it| planted.file.starts_with(it));
    assert!(all.iter().all(is_looked_at), "{}", planted.what);
    let run = check(&scratch, folders);
    let json = run.json();
    let found = json.as_array().unwrap();
    let is_it = |finding: &serde_json::Value, (planted, place): (&&Planted, &Place)| {
        finding["code"] == planted.code
            && finding["file"] == planted.file
            && finding["line"] == place.line
            && finding["column"] == place.column
            && planted.help.is_none_or(|help| finding["help"] == help)
    };
    let are_all = all
        .iter()
        .zip(&places)
        .all(|wanted| found.iter().any(|finding| is_it(finding, wanted)));
    let mut codes: Vec<_> = found.iter().filter_map(|f| f["code"].as_str()).collect();
    let mut expected: Vec<_> = all
        .iter()
        .flat_map(|p| [p.code].into_iter().chain(p.more.iter().copied()))
        .collect();
    codes.sort_unstable();
    expected.sort_unstable();
    if run.code == Some(1) && are_all && codes == expected {
        return Ok(());
    }
    let wanted: Vec<String> = all
        .iter()
        .zip(&places)
        .map(|(planted, place)| format!("{} at {place}, {:?}", planted.code, planted.help))
        .collect();
    let listed: Vec<String> = found
        .iter()
        .map(|f| {
            format!(
                "{} {}:{}:{} {} {}",
                f["code"], f["file"], f["line"], f["column"], f["message"], f["help"]
            )
        })
        .collect();
    Err(format!(
        "{}: exit {:?}, expected\n  {}\nfound\n  {}",
        planted.what,
        run.code,
        wanted.join("\n  "),
        listed.join("\n  ")
    ))
}

#[test]
fn each_planted_error_is_found_where_its_author_put_it() {
    let wrong_of = |some: &[Planted]| -> Vec<String> {
        let verdicts = some.iter().map(verdict);
        verdicts.filter_map(Result::err).collect()
    };
    let wrong: Vec<String> = std::thread::scope(|scope| {
        let parts = PLANTED.chunks(8);
        let threads: Vec<_> = parts
            .map(|part| scope.spawn(move || wrong_of(part)))
            .collect();
        threads
            .into_iter()
            .flat_map(|thread| thread.join().unwrap())
            .collect()
    });
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn without_a_planted_error_the_same_copy_passes() {
    let scratch = sound();
    for folders in [&ALL[..], &TOUCHED] {
        let run = check(&scratch, folders);
        assert_eq!((run.code, run.stdout.trim()), (Some(0), "[]"), "{run:?}");
    }
}

/// A mistake three files deep, as people and programs see it.
#[test]
fn a_finding_tells_how_its_file_came_in() {
    let scratch = sound();
    let c = MINE[2].1.replace("state.depth", "state.dept");
    scratch.write(C, c);
    let run = scratch.run(&["check", "shaders/node", "--shaders", "shaders"]);
    let expected = "\
error[wgsl-type]: invalid field accessor `dept` (invalid accessor)
 --> shaders/mine/c.wgsl:8:28
  |
8 |     let from_entry = state.dept + ray.near;
  |                            ^^^^
  |
  = note: imported by shaders/mine/b.wgsl:3, imported by shaders/mine/a.wgsl:2, \
imported by shaders/slot/technique/dvr.wgsl:9, imported by shaders/node/raycast.wgsl:10
  = help: did you mean `depth`?
";
    assert_eq!(run.stderr, expected);
    let run = scratch.run(&[
        "check",
        "shaders/node",
        "--shaders",
        "shaders",
        "--format",
        "json",
    ]);
    let json = run.json();
    let related: Vec<_> = json[0]["related"]
        .as_array()
        .unwrap()
        .iter()
        .map(|r| {
            (
                r["file"].as_str().unwrap(),
                r["line"].as_u64().unwrap(),
                r["note"].as_str().unwrap(),
            )
        })
        .collect();
    assert_eq!(
        related,
        [
            (B, 3, "imported here"),
            (A, 2, "imported here"),
            ("shaders/slot/technique/dvr.wgsl", 9, "imported here"),
            ("shaders/node/raycast.wgsl", 10, "imported here"),
        ]
    );
    let keys: Vec<_> = json[0]
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect();
    for key in [
        "file", "line", "column", "length", "severity", "code", "message", "help", "related",
    ] {
        assert!(keys.contains(&key), "{key}: {keys:?}");
    }
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
    let json = run.json();
    assert_eq!(
        (
            &json[0]["code"],
            &json[0]["file"],
            &json[0]["line"],
            &json[0]["column"]
        ),
        (
            &"slot-function".into(),
            &"mine/slot/reconstruct/one.wgsl".into(),
            &2.into(),
            &4.into()
        ),
        "{json}"
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
