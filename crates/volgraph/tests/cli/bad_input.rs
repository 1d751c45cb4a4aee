//! Bad input of every kind: one clear report that names file, place, cause and remedy, exit code 1, and nothing panics,
//! hangs or allocates by a header's word.

use crate::{Run, SPHERE, Scratch, TRANSFER, graph};

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

/// A volume file with this content, and the graph that draws it.
fn volume(
    what: &'static str,
    name: &'static str,
    content: impl Into<Vec<u8>>,
    code: &'static str,
    place: &'static str,
) -> Bad {
    let text = graph(&format!("volume(path: \"{name}\")"));
    bad(
        what,
        vec![(name, content.into()), ("g.ron", text.into_bytes())],
        &PLAN,
        code,
        place,
    )
}

/// The graph with one part replaced.
fn replaced(
    what: &'static str,
    find: &str,
    with: &str,
    code: &'static str,
    place: &'static str,
) -> Bad {
    let text = graph(SPHERE);
    assert!(text.contains(find), "{what}");
    bad(
        what,
        vec![("g.ron", text.replacen(find, with, 1).into_bytes())],
        &PLAN,
        code,
        place,
    )
}

/// The right graph, and a transfer function that is not.
fn transfer(what: &'static str, text: &str, code: &'static str, place: &'static str) -> Bad {
    bad(
        what,
        vec![
            ("g.ron", graph(SPHERE).into_bytes()),
            ("t.ron", text.into()),
        ],
        &PLAN,
        code,
        place,
    )
}

/// The right graph with shaders of one's own.
fn shader(
    what: &'static str,
    files: &[(&'static str, &str)],
    code: &'static str,
    place: &'static str,
) -> Bad {
    let mut all = vec![("g.ron", graph(SPHERE).into_bytes())];
    all.extend(
        files
            .iter()
            .map(|(name, text)| (*name, text.as_bytes().to_vec())),
    );
    bad(what, all, &["plan", "g.ron", "--shaders", "s"], code, place)
}

fn nrrd(header: &str, data: &[u8]) -> Vec<u8> {
    let mut bytes = format!("NRRD0004\n{header}\n\n").into_bytes();
    bytes.extend_from_slice(data);
    bytes
}

const EIGHT: [u8; 8] = [0, 1, 2, 3, 4, 5, 6, 7];

fn volumes() -> Vec<Bad> {
    let header = "type: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw";
    let gzip = header.replace("raw", "gzip");
    let edited = |find: &str, with: &str| nrrd(&header.replace(find, with), &EIGHT);
    let mhd = "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n";
    vec![
        volume(
            "truncated raw",
            "v_4x4x4_uint8.raw",
            [0; 63],
            "volume-data-too-short",
            "v_4x4x4_uint8.raw",
        ),
        volume(
            "overlong raw",
            "v_4x4x4_uint8.raw",
            [0; 65],
            "volume-data-too-long",
            "v_4x4x4_uint8.raw",
        ),
        volume(
            "10^12 voxels by name",
            "v_10000x10000x10000_uint8.raw",
            [0; 8],
            "volume-too-large",
            "v_10000x",
        ),
        volume(
            "10^12 voxels by header",
            "v.nrrd",
            edited("2 2 2", "10000 10000 10000"),
            "volume-too-large",
            "v.nrrd",
        ),
        volume(
            "zero size by name",
            "v_0x4x4_uint8.raw",
            [0; 8],
            "volume-",
            "v_0x4x4_uint8.raw",
        ),
        volume(
            "zero size by header",
            "v.nrrd",
            edited("2 2 2", "0 2 2"),
            "volume-",
            "v.nrrd:4",
        ),
        volume(
            "no such type",
            "v.nrrd",
            edited("uint8", "string"),
            "volume-unknown-type",
            "v.nrrd:2",
        ),
        volume(
            "spacing not a number",
            "v.nrrd",
            edited("encoding", "spacings: nan 1 1\nencoding"),
            "volume-",
            "v.nrrd",
        ),
        volume(
            "infinite spacing",
            "v.nrrd",
            edited("encoding", "spacings: inf 1 1\nencoding"),
            "volume-",
            "v.nrrd",
        ),
        volume(
            "truncated nrrd",
            "v.nrrd",
            nrrd(header, &EIGHT[..7]),
            "volume-data-too-short",
            "v.nrrd",
        ),
        volume(
            "no gzip",
            "v.nrrd",
            nrrd(&gzip, &[7; 64]),
            "volume-data-corrupt",
            "v.nrrd",
        ),
        volume(
            "a picture named nrrd",
            "v.nrrd",
            *b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR",
            "volume-wrong-content",
            "v.nrrd",
        ),
        volume(
            "a gzip cut off",
            "v_2x2x2_uint8.raw.gz",
            [0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3, 0x63],
            "volume-data-",
            "v_2x2x2_uint8.raw.gz",
        ),
        volume(
            "a name that does not tell",
            "engine.raw",
            EIGHT,
            "volume-raw-name",
            "engine.raw",
        ),
        volume(
            "no data file",
            "v.mhd",
            format!("{mhd}ElementDataFile = no.raw\n"),
            "volume-data-file",
            "no.raw",
        ),
        volume(
            "no type in MetaImage",
            "v.mha",
            mhd.replace("MET_UCHAR", "MET_ODD") + "ElementDataFile = LOCAL\n",
            "volume-unknown-type",
            "v.mha:4",
        ),
        volume("an empty file", "v.nrrd", [], "volume-", "v.nrrd"),
        bad(
            "no such volume",
            vec![(
                "g.ron",
                graph("volume(path: \"no_2x2x2_uint8.raw\")").into_bytes(),
            )],
            &PLAN,
            "data-missing",
            "no_2x2x2_uint8.raw",
        ),
        bad(
            "a folder as a volume",
            vec![("g.ron", graph("volume(path: \".\")").into_bytes())],
            &PLAN,
            "volume-unreadable",
            "g.ron:3",
        ),
        bad(
            "over the device's limit",
            vec![
                ("v_4096x1x1_uint8.raw", vec![0; 4096]),
                (
                    "g.ron",
                    graph("volume(path: \"v_4096x1x1_uint8.raw\")").into_bytes(),
                ),
            ],
            &PLAN,
            "over-limit",
            "g.ron:8",
        ),
    ]
}

fn graphs() -> Vec<Bad> {
    let cycle = "\"a\": (kind: \"raycast\", in: { \"volume\": \"v\", \"rays\": \"box\", \"transfer\": \"t\", \"behind\": \"image\" }),
        \"image\": (kind: \"raycast\", in: { \"behind\": \"a\", ";
    let huge = ["plan", "g.ron", "--size", "100000x100000"];
    let right = || vec![("g.ron", graph(SPHERE).into_bytes())];
    vec![
        replaced(
            "a cycle",
            "\"image\": (kind: \"raycast\", in: { ",
            cycle,
            "cycle",
            "g.ron:8",
        ),
        replaced(
            "unknown kind",
            "\"raycast\"",
            "\"raycats\"",
            "unknown-kind",
            "g.ron:8",
        ),
        replaced(
            "unknown port",
            "\"rays\": \"box\"",
            "\"rays\": \"box\", \"front\": \"box\"",
            "unknown-port",
            "g.ron:8",
        ),
        replaced(
            "unknown output port",
            "image.color",
            "image.colour",
            "unknown-port",
            "g.ron:10",
        ),
        replaced(
            "unknown field",
            "outputs",
            "ouputs: {}, outputs",
            "unknown-field",
            "g.ron:10",
        ),
        replaced(
            "unknown parameter",
            "\"box\" })",
            "\"box\" }, params: { \"stpe\": 1 })",
            "unknown-param",
            "g.ron:8",
        ),
        replaced(
            "a parameter out of range",
            "\"box\" })",
            "\"box\" }, params: { \"step\": -1 })",
            "bad-param",
            "g.ron:8",
        ),
        replaced(
            "unknown slot",
            "\"box\" })",
            "\"box\" }, slots: { \"lights\": \"phong\" })",
            "unknown-slot",
            "g.ron:8",
        ),
        replaced(
            "unknown choice",
            "\"box\" })",
            "\"box\" }, slots: { \"light\": \"phnog\" })",
            "unknown-choice",
            "g.ron:8",
        ),
        replaced(
            "unknown source kind",
            "analytic",
            "analytical",
            "unknown-source-kind",
            "g.ron:3",
        ),
        replaced(
            "unknown analytic field",
            "sphere",
            "cube",
            "volume-field",
            "g.ron:3",
        ),
        replaced(
            "unknown camera",
            "    nodes",
            "    camera: fly(fov_y: 30),\n    nodes",
            "unknown-camera",
            "g.ron:6",
        ),
        replaced(
            "missing input",
            ", \"rays\": \"box\"",
            "",
            "missing-input",
            "g.ron:8",
        ),
        replaced(
            "no transfer function",
            "\"transfer\": \"t\", ",
            "",
            "missing-input",
            "g.ron:8",
        ),
        replaced(
            "two outputs of one name",
            "\"image.color\"",
            "\"image.color\", \"color\": \"image.depth\"",
            "duplicate",
            "g.ron:10",
        ),
        replaced(
            "two nodes of one name",
            "\"box\": (",
            "\"image\": (kind: \"proxy_box\"),\n\"box\": (",
            "duplicate",
            "g.ron:9",
        ),
        replaced(
            "an edge of another type",
            "\"rays\": \"box\"",
            "\"rays\": \"v\"",
            "type-mismatch",
            "g.ron:8",
        ),
        replaced(
            "a value of another type",
            "(8, 8, 8)",
            "\"eight\"",
            "bad-param",
            "g.ron:3",
        ),
        replaced(
            "a volume of zero size",
            "(8, 8, 8)",
            "(8, 0, 8)",
            "bad-param",
            "g.ron:3",
        ),
        replaced(
            "a volume of 10^12 voxels",
            "(8, 8, 8)",
            "(10000, 10000, 10000)",
            "volume-too-large",
            "g.ron:3",
        ),
        replaced(
            "no outputs",
            "outputs: { \"color\": \"image.color\" },",
            "",
            "no-output",
            "g.ron:1",
        ),
        replaced(
            "a source as an output",
            "image.color",
            "v",
            "type-mismatch",
            "g.ron:10",
        ),
        replaced("no RON", "nodes: {", "nodes: <", "ron-syntax", "g.ron:6"),
        bad(
            "no text",
            vec![("g.ron", vec![0xff, 0xfe, 0, 1])],
            &PLAN,
            "io",
            "g.ron",
        ),
        bad("no file", vec![], &["plan", "no.ron"], "io", "no.ron"),
        bad(
            "a folder",
            vec![("f/x", vec![])],
            &["plan", "f"],
            "not-a-graph",
            "f",
        ),
        bad(
            "unknown --set target",
            right(),
            &["plan", "g.ron", "--set", "imgae.step=1"],
            "unknown-node",
            "--set imgae.step=1",
        ),
        bad(
            "unknown --set parameter",
            right(),
            &["plan", "g.ron", "--set", "image.stpe=1"],
            "unknown-param",
            "--set image.stpe=1",
        ),
        bad(
            "bad --set value",
            right(),
            &["plan", "g.ron", "--set", "image.step=fast"],
            "bad-param",
            "--set image.step=fast",
        ),
        bad(
            "unknown --volume source",
            right(),
            &["plan", "g.ron", "--volume", "w=x.nrrd"],
            "unknown-node",
            "--volume w=x.nrrd",
        ),
        bad(
            "a picture over the limits",
            right(),
            &huge,
            "over-limit",
            "g.ron:8",
        ),
        bad(
            "no picture format",
            right(),
            &["render", "g.ron", "-o", "out.jpg"],
            "picture-extension",
            "out.jpg",
        ),
        bad(
            "no transfer file",
            vec![(
                "g.ron",
                graph(SPHERE).replace("t.ron", "no.ron").into_bytes(),
            )],
            &PLAN,
            "io",
            "no.ron",
        ),
        transfer(
            "opacity over 1",
            "(\n  color: (1, 1, 1),\n  opacity: [(0, 0), (1, 2)],\n)",
            "out-of-range",
            "t.ron:3",
        ),
        transfer(
            "unknown colour map",
            "(color: map(name: \"virids\"), opacity: [(0, 1)])",
            "unknown-color-map",
            "t.ron:1",
        ),
    ]
}

fn shaders() -> Vec<Bad> {
    let light = "s/slot/light/unlit.wgsl";
    let function =
        "fn light_segment(classified: Classified, position: vec3f, ray: Ray) -> vec3f {\n";
    let with = |body: &str| format!("#import \"lib/classified.wgsl\"\n{function}{body}\n}}\n");
    vec![
        shader(
            "syntax",
            &[(light, &with("    return classified.color)"))],
            "wgsl-syntax",
            "s/slot/light/unlit.wgsl:3",
        ),
        shader(
            "type",
            &[(light, &with("    return classified.colour;"))],
            "wgsl-type",
            "s/slot/light/unlit.wgsl:3",
        ),
        shader(
            "return type",
            &[(light, &with("    return position.x;"))],
            "wgsl-validation",
            "s/slot/light/unlit.wgsl:3",
        ),
        shader(
            "a binding that is taken",
            &[(
                light,
                &format!(
                    "@group(1) @binding(1) var mine: texture_2d<f32>;\n{}",
                    with("    return textureLoad(mine, vec2i(0), 0).xyz;")
                ),
            )],
            "binding-clash",
            "s/slot/light/unlit.wgsl:1",
        ),
        shader(
            "a binding that nothing fills",
            &[(
                light,
                &format!(
                    "@group(3) @binding(5) var mine: texture_2d<f32>;\n{}",
                    with("    return textureLoad(mine, vec2i(0), 0).xyz;")
                ),
            )],
            "unknown-binding",
            "s/slot/light/unlit.wgsl:1",
        ),
        shader(
            "missing import",
            &[(light, "#import \"lib/no.wgsl\"\n")],
            "missing-import",
            "s/slot/light/unlit.wgsl:1",
        ),
        shader(
            "cyclic import",
            &[
                (light, "#import \"a.wgsl\"\n"),
                ("s/a.wgsl", "// A.\n#import \"b.wgsl\"\n"),
                ("s/b.wgsl", "#import \"a.wgsl\"\n"),
            ],
            "import-cycle",
            "s/b.wgsl:1",
        ),
        shader(
            "not text",
            &[(light, "\0\u{1}\u{2}")],
            "wgsl-syntax",
            "s/slot/light/unlit.wgsl:1",
        ),
    ]
}

#[test]
fn each_bad_input_gets_one_clear_report_and_exit_code_1() {
    let cases: Vec<Bad> = volumes()
        .into_iter()
        .chain(graphs())
        .chain(shaders())
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
