//! Bad input of every kind: one clear report that names file, place, cause and remedy, exit code 1, and nothing panics,
//! hangs or allocates by a header's word.

mod graphs;
mod shaders;
mod volumes;

use crate::{Run, Scratch, TRANSFER, graph};

/// What a case expects of standard error: a code, and where.
struct Bad {
    what: &'static str,
    /// File name and content, beside `t.ron`.
    files: Vec<(&'static str, Vec<u8>)>,
    /// The arguments after `volgraph`.
    args: Vec<&'static str>,
    code: &'static str,
    /// File, or file:line.
    place: &'static str,
}

const PLAN: [&str; 2] = ["plan", "g.ron"];

fn bad(
    what: &'static str,
    files: Vec<(&'static str, Vec<u8>)>,
    args: &[&'static str],
    code: &'static str,
    place: &'static str,
) -> Bad {
    Bad {
        what,
        files,
        args: args.to_vec(),
        code,
        place,
    }
}

#[test]
fn each_bad_input_gets_one_clear_report_and_exit_code_1() {
    let cases: Vec<Bad> = volumes::volumes()
        .into_iter()
        .chain(graphs::graphs())
        .chain(shaders::shaders())
        .collect();
    assert!(cases.len() >= 30);
    let wrong: Vec<String> = cases
        .iter()
        .filter_map(|case| verdict(case).err())
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

fn verdict(case: &Bad) -> Result<(), String> {
    let scratch = Scratch::new();
    scratch.write("t.ron", TRANSFER);
    for (name, content) in &case.files {
        scratch.write(name, content);
    }
    let Run {
        code,
        stdout,
        stderr,
    } = scratch.run(&case.args);
    // Each finding starts `error[code]`, and has its place on that line (a whole file) or as `--> file:line:column`.
    let is_told = stderr.contains(&format!("error[{}", case.code)) && stderr.contains(case.place);
    let has_remedy = stderr.contains("help: ") || !needs_help(case.code);
    if code == Some(1) && stdout.is_empty() && is_told && has_remedy {
        return Ok(());
    }
    Err(format!(
        "{}: expected {} at {} (and a remedy), found exit {code:?}\n{stderr}{stdout}",
        case.what, case.code, case.place
    ))
}

/// A compiler's message is its own remedy; everything else says what to do.
fn needs_help(code: &str) -> bool {
    ![
        "wgsl-",
        "ron-syntax",
        "duplicate",
        "bad-param",
        "wrong-type",
        "type-mismatch",
        "out-of-range",
    ]
    .iter()
    .any(|start| code.starts_with(start))
}

#[test]
fn volumes_one_voxel_thick_are_no_trouble() {
    for (dims, len) in [
        ("1x4x4", 16),
        ("4x1x4", 16),
        ("4x4x1", 16),
        ("1x1x4", 4),
        ("1x1x1", 1),
    ] {
        let scratch = Scratch::new();
        scratch.write("t.ron", TRANSFER);
        let name = format!("v_{dims}_uint8.raw");
        scratch.write(&name, vec![100; len]);
        scratch.write("g.ron", graph(&format!("volume(path: \"{name}\")")));
        for light in ["image.slots.light=unlit", "image.slots.light=phong"] {
            let run = scratch.run(&["plan", "g.ron", "--set", light]);
            assert_eq!(run.code, Some(0), "{dims}: {run:?}");
        }
        assert_eq!(scratch.run(&["info", &name]).code, Some(0), "{dims}");
    }
}

#[test]
fn wrong_usage_has_exit_code_2() {
    let scratch = Scratch::new();
    for args in [
        &[][..],
        &["rendre"],
        &["plan"],
        &["plan", "g.ron", "--size", "0x5"],
        &["plan", "g.ron", "--size", "512"],
        &["plan", "g.ron", "--set", "step=1"],
        &["plan", "g.ron", "--camera", "orbit(azimuth: fast)"],
        &["plan", "g.ron", "--json", "--dot"],
        &["render", "g.ron"],
        &["check"],
        &["check", "g.ron", "--format", "xml"],
        &["info", "v.raw", "--type", "uint7"],
        &["info", "v.raw", "--dims", "1x2"],
        &["compare", "a.png"],
        &["compare", "a.png", "b.png", "--max-rmse", "nan"],
    ] {
        let run = scratch.run(args);
        assert_eq!(run.code, Some(2), "{args:?}: {run:?}");
        assert!(
            !run.stderr.is_empty() && run.stdout.is_empty(),
            "{args:?}: {run:?}"
        );
    }
}

/// What a graph of many tiny parts costs is bounded: it is refused before its parts are looked at.
#[test]
fn a_graph_made_to_cost_time_ends() {
    let scratch = Scratch::new();
    let many: String = (0..12_000)
        .map(|i| format!("\"n{i}\":(kind:\"x\"),\n"))
        .collect();
    scratch.write(
        "g.ron",
        format!("(nodes:{{{many}}},outputs:{{\"c\":\"n0\"}})"),
    );
    let run = scratch.run(&PLAN);
    assert!(
        run.code == Some(1) && run.stderr.contains("too-large"),
        "{run:?}"
    );
    let edges: String = (0..18_000).map(|i| format!("\"e{i}\":\"b\",")).collect();
    scratch.write(
        "g.ron",
        format!("(nodes:{{\"b\":(kind:\"background\",in:{{{edges}}})}},outputs:{{\"c\":\"b\"}})"),
    );
    let run = scratch.run(&PLAN);
    assert!(
        run.code == Some(1) && run.stderr.contains("… and 17900 more findings"),
        "{}",
        run.stderr
    );
    scratch.write("g.ron", "(".repeat(200_000));
    let run = scratch.run(&PLAN);
    assert!(
        run.code == Some(1) && run.stderr.contains("ron-syntax"),
        "{run:?}"
    );
}
