//! All errors of one edit at their places, and none that is only a consequence.

use std::path::Path;
use std::sync::Arc;

use naga::valid::Capabilities;
use volgraph_report::Finding;
use volgraph_shader::{DiskFiles, LinkRequest, MemoryFiles, ShaderRoots, check, link};

use crate::{Files, start};

/// All findings of files, by place.
fn all(files: &Files) -> Vec<Finding> {
    let findings = files.check().expect_err("findings");
    findings.sorted().into_iter().cloned().collect()
}

/// Codes, files, lines and columns of all findings.
fn places(files: &Files) -> Vec<(&'static str, (String, u32, u32))> {
    let place = |finding: &Finding| start(finding.place.as_ref().expect("a place"));
    let found = all(files);
    found
        .iter()
        .map(|finding| (finding.code, place(finding)))
        .collect()
}

/// The findings of one text must have these codes, each at the first place where its needle stands.
fn assert_all(text: &str, expected: &[(&'static str, &str)]) {
    let files = Files::one(text);
    let expected: Vec<_> = expected
        .iter()
        .map(|(code, needle)| (*code, start(&files.place("shaders/a.wgsl", needle))))
        .collect();
    assert_eq!(places(&files), expected, "{text}\n{:?}", all(&files));
}

#[test]
fn each_function_of_each_file_tells_its_first_error() {
    let files = Files::new(&[
        (
            "shaders/a.wgsl",
            "#import \"b.wgsl\"\nfn a() -> f32 { return b() + nope; }\nfn c() -> vec4<f32>{return q;}\n",
        ),
        (
            "shaders/b.wgsl",
            "fn b() -> f32 {\n    let x: i32 = 1.5f;\n    return missing;\n}\nfn d() -> f32 { return 1u; }\n",
        ),
    ]);
    let at = |file: &str, line, column| (file.to_owned(), line, column);
    assert_eq!(
        places(&files),
        [
            ("wgsl-type", at("shaders/a.wgsl", 2, 30)),
            ("wgsl-type", at("shaders/a.wgsl", 3, 28)),
            ("wgsl-type", at("shaders/b.wgsl", 2, 9)),
            ("wgsl-validation", at("shaders/b.wgsl", 5, 24)),
        ]
    );
}

#[test]
fn what_a_broken_declaration_leads_to_is_not_told() {
    assert_all(
        "fn f(a: vec3ff) -> f32 { return 1.0; }\nfn g() -> Strct { return Strct(); }\n\
         struct S { x: nope }\nalias A = S;\nvar<private> s: A;\nfn h() -> f32 { g(); return f(vec3f()) + s.x; }\n\
         fn i(s: S) -> f32 { return h() + other; }\nfn j() -> f32 { return another; }\n",
        &[
            ("wgsl-type", "vec3ff"),
            ("wgsl-type", "Strct"),
            ("wgsl-type", "nope"),
            ("wgsl-type", "another"),
        ],
    );
    assert_all(
        "const A = B + 1;\nconst C = A * 2;\nvar<private> v: array<f32, C>;\nfn f() -> f32 { return v[0]; }\n\
         override O: f32 = nope;\nconst_assert 1 > 2;\nconst_assert 2 > 3;\nconst_assert C > 3;\n",
        &[
            ("wgsl-type", "B + 1"),
            ("wgsl-type", "nope"),
            ("wgsl-type", "1 > 2"),
            ("wgsl-type", "2 > 3"),
        ],
    );
}

#[test]
fn cycles_are_told_once_each() {
    let text = "fn f() { g(); }\nfn g() { f(); }\nfn h() { h(); }\nfn k() { return 1u; }\n";
    assert_all(
        text,
        &[
            ("wgsl-type", "g() { f"),
            ("wgsl-type", "h() { h"),
            ("wgsl-validation", "1u"),
        ],
    );
}

#[test]
fn validation_goes_on_behind_functions_entry_points_and_variables() {
    assert_all(
        "var<uniform> bad: f32;\nfn f() -> f32 { return bad; }\nfn g() -> vec2f { return vec3f(); }\n\
         fn h() -> vec2f { return g() + 1u; }\n\
         @vertex fn main() -> @location(0) vec4f { return vec4f(); }\n\
         @fragment fn other() -> @location(0) vec4f { return vec2f(); }\n",
        &[
            ("wgsl-validation", "var<uniform> bad"),
            ("wgsl-validation", "vec3f()"),
            ("wgsl-validation", "g() + 1u"),
            ("wgsl-validation", "main"),
            ("wgsl-validation", "vec2f()"),
        ],
    );
}

#[test]
fn a_signature_that_is_not_valid_is_told_once() {
    assert_all(
        "struct R { a: array<u32> }\nfn f(r: R) -> f32 { return 1u; }\nfn g(r: R) -> f32 { return f(r); }\n\
         fn h() -> f32 { return 2u; }\n",
        &[("wgsl-validation", "r: R"), ("wgsl-validation", "2u")],
    );
}

#[test]
fn names_that_clash_hide_nothing_else() {
    assert_all(
        "fn f() -> f32 { return 1.0; }\nfn f() -> u32 { return 1u; }\nfn g() -> u32 { return f(); }\n\
         fn h() { let a = 1; let a = 2; }\nfn i() { let b = nope; }\n",
        &[
            ("name-clash", "f() -> u32"),
            ("name-clash", "a = 2"),
            ("wgsl-type", "nope"),
        ],
    );
    assert_all(
        "fn h() { let a = 1; let a = 2; }\nfn i() { let = nope; }\n",
        &[("name-clash", "a = 2"), ("wgsl-syntax", "= nope")],
    );
}

#[test]
fn clashing_bindings_and_faulty_docs_come_along() {
    assert_all(
        "struct Params {\n    /// @default one\n    p: f32,\n}\n@group(0) @binding(0) var<uniform> a: vec4f;\n\
         @group(0) @binding(0) var<uniform> b: vec4f;\nfn f() -> f32 { return nope; }\n\
         @compute @workgroup_size(1)\nfn main() { _ = a + b; }\n",
        &[
            ("params-doc", "one"),
            ("binding-clash", "b: vec4f"),
            ("wgsl-type", "nope"),
        ],
    );
}

#[test]
fn tries_are_bounded() {
    let text: String = (0..30)
        .map(|at| format!("fn f{at}() -> f32 {{ return nope; }}\n"))
        .collect();
    assert_eq!(all(&Files::one(&text)).len(), 20);
}

#[test]
fn errors_without_a_place_are_found() {
    assert_all(
        "fn f() -> f32 {\n    let a = vec3f(1.0);\n    for (var i = 0; i < 3; i++) {\n        let b = a.x;\n        \
         let c = a[5];\n    }\n    return a.x;\n}\nfn g() -> f32 { return nope; }\n",
        &[("wgsl-type", "let c"), ("wgsl-type", "nope")],
    );
}

#[test]
fn a_call_that_does_not_fit_is_blamed_not_what_it_calls() {
    for (body, needle) in [
        ("let x = f(vec2f());", "vec2f()"),
        ("let i = 1u; let x = f(i);", "f(i)"),
        ("let i = 1u + 2u; let x = f(i);", "f(i)"),
        ("let x = f(1.0, 2.0);", "f(1.0"),
        ("f();", "f();"),
    ] {
        let text = format!("fn f(a: f32) -> f32 {{ return a; }}\nfn g() {{ {body} }}\n");
        assert_all(&text, &[("wgsl-validation", needle)]);
        let finding = all(&Files::one(&text)).remove(0);
        assert!(finding.message.contains("`f`"), "{finding}");
        let places: Vec<_> = finding
            .related
            .iter()
            .map(|(place, _)| start(place))
            .collect();
        assert!(
            places.contains(&("shaders/a.wgsl".into(), 1, 4)),
            "{finding}"
        );
    }
    assert_all(
        "fn f() -> f32 {\n    let x = 1u + 2u;\n    return x;\n}\n",
        &[("wgsl-validation", "return x")],
    );
}

#[test]
fn a_finding_tells_how_its_file_came_in() {
    let files = |c: &'static str| {
        Files::new(&[
            (
                "shaders/a.wgsl",
                "// A.\n#import \"b.wgsl\"\n#import \"c.wgsl\"\n",
            ),
            ("shaders/b.wgsl", "#import \"c.wgsl\"\n"),
            ("shaders/c.wgsl", c),
        ])
    };
    let imports = |text| {
        let findings = files(text).check().unwrap_err();
        findings.sorted()[0].import_note()
    };
    let chain = Some("imported by shaders/b.wgsl:1, imported by shaders/a.wgsl:2".to_owned());
    for text in [
        "fn c() -> f32 { return nope; }",
        "fn c() -> f32 { return 1u; }",
        "fn c( { }",
        "#import \"d.wgsl\"\n",
        "#import slot \"none\"\n",
        "#include\n",
        "struct Params {\n/// @default one\np: f32 }\n",
        "struct Params { p: f32, p: f32 }\n",
    ] {
        assert_eq!(imports(text), chain, "{text}");
    }
    assert_eq!(
        all(&Files::one("fn c() -> f32 { return nope; }"))[0].import_note(),
        None
    );
}

/// Each declaration of a real shader is broken in turn: one finding, at the place of the mistake.
#[test]
fn one_mistake_in_a_real_shader_is_one_finding() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shaders");
    let request = [
        ("reconstruct", "trilinear"),
        ("traverse", "uniform"),
        ("leap", "none"),
        ("pixels", "box"),
        ("walk", "pairs"),
        ("steps", "table"),
        ("light_places", "anywhere"),
        ("shadow_leap", "none"),
        ("technique", "dvr"),
        ("classify", "preintegrated_2d"),
        ("gradient", "stored"),
        ("gradient_storage", "rgba8"),
        ("light", "phong"),
        ("material", "uniform"),
        ("shadow", "none"),
        ("environment", "none"),
        ("clip", "none"),
        ("labels", "none"),
        ("parts", "one"),
        ("table_filter", "hardware"),
        ("depth_layer", "written"),
        ("opacity_layer", "none"),
        ("position_layer", "none"),
        ("normal_layer", "none"),
        ("samples_layer", "none"),
        ("label_layer", "none"),
        ("error_layer", "none"),
        ("trace_layer", "none"),
        ("behind", "texture"),
        ("volume_filter", "loads"),
        ("volume_texel", "load"),
        ("heed", "all"),
        ("clip_volume_filter", "loads"),
        ("transfer_tables", "one"),
        ("volumes", "one"),
        ("colors", "transfer"),
        ("transfer_reach", "within"),
        ("beyond", "none"),
        ("pattern", "uniform"),
    ]
    .into_iter()
    .fold(
        LinkRequest::new("node/raycast.wgsl"),
        |request, (slot, choice)| request.slot(slot, choice),
    );
    let roots = |files: MemoryFiles| ShaderRoots::new(Arc::new(files)).root(&root);
    let linked = link(&roots(MemoryFiles::over(Arc::new(DiskFiles))), &request).unwrap();
    let mistakes = [
        ("fn ", "{", " let planted = mistake;"),
        ("fn ", "(", "planted: mistake, "),
        ("struct ", "{", " planted: mistake,"),
        ("const ", " = ", "mistake + "),
    ];
    let mut count = 0;
    for file in &linked.files {
        for (keyword, mark, mistake) in mistakes {
            let declarations = file.text.match_indices(keyword);
            for (at, _) in declarations.filter(|(at, _)| file.text[..*at].ends_with('\n')) {
                let at = at + file.text[at..].find(mark).unwrap() + mark.len();
                let text = [&file.text[..at], mistake, &file.text[at..]].concat();
                let start = at + mistake.find("mistake").unwrap();
                let edited = MemoryFiles::over(Arc::new(DiskFiles)).with(&file.path, text.clone());
                let linked = link(&roots(edited), &request).unwrap();
                let findings = check(linked, Capabilities::default()).unwrap_err();
                let findings = findings.sorted();
                let place = volgraph_report::Place::in_text(&file.path, &text, start, 7);
                assert_eq!(findings.len(), 1, "{}: {findings:?}", file.path.display());
                assert_eq!(findings[0].place.as_ref(), Some(&place));
                count += 1;
            }
        }
    }
    assert!(count > 50, "{count}");
}
