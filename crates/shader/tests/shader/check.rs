//! What naga says, at the author's places.

use std::collections::BTreeMap;
use std::path::Path;

use naga::valid::Capabilities;
use volgraph_shader::check_file;

use crate::{Files, assert_at, codes, only, start};

const MAIN: &str =
    "#import \"lib/b.wgsl\"\n\n@compute @workgroup_size(1)\nfn main() {\n    _ = b_value();\n}\n";

fn with_library(library: &str) -> Files {
    Files::new(&[("shaders/a.wgsl", MAIN), ("shaders/lib/b.wgsl", library)])
}

#[test]
fn a_sound_shader_passes() {
    with_library("fn b_value() -> f32 { return 1.0; }\n")
        .check()
        .unwrap();
}

#[test]
fn a_syntax_error_in_an_imported_file() {
    let files = with_library("// ä\nfn b_value() -> f32 {\n    let x = 1.0 +;\n    return x;\n}\n");
    let finding = only(files.check());
    assert_at(
        &finding,
        "wgsl-syntax",
        &files,
        "shaders/lib/b.wgsl",
        ";\n    return",
    );
}

#[test]
fn each_file_has_its_own_syntax_error_and_a_missing_brace_is_not_the_next_files() {
    let files = Files::new(&[
        (
            "shaders/a.wgsl",
            "#import \"b.wgsl\"\nfn a() { let = 1; }\n",
        ),
        ("shaders/b.wgsl", "fn b() {\n    let x = 1;\n"),
    ]);
    let findings = files.check().unwrap_err();
    let findings = findings.sorted();
    assert_eq!(findings.len(), 2);
    assert_at(findings[0], "wgsl-syntax", &files, "shaders/a.wgsl", "= 1");
    assert_eq!(findings[1].code, "wgsl-syntax");
    assert_eq!(
        start(findings[1].place.as_ref().unwrap()),
        ("shaders/b.wgsl".into(), 3, 1)
    );
}

#[test]
fn syntax_errors_keep_their_columns_behind_directives_and_imports() {
    let files = Files::new(&[
        (
            "shaders/a.wgsl",
            "diagnostic(off, derivative_uniformity); #import \"b.wgsl\"\n",
        ),
        ("shaders/b.wgsl", ""),
    ]);
    assert_eq!(codes(files.check()), ["import-syntax"]);
    let files = Files::new(&[(
        "shaders/a.wgsl",
        "diagnostic(off, derivative_uniformity); const x 1;\n",
    )]);
    assert_at(
        &only(files.check()),
        "wgsl-syntax",
        &files,
        "shaders/a.wgsl",
        "1;",
    );
    let files = Files::one("diagnostic(off); const x = 1;\n");
    let finding = only(files.check());
    assert_at(&finding, "wgsl-syntax", &files, "shaders/a.wgsl", ");");
}

#[test]
fn a_type_error_in_an_imported_file() {
    let files =
        with_library("fn b_value() -> f32 {\n    let x: i32 = 1.5f;\n    return f32(x);\n}\n");
    let finding = only(files.check());
    assert_at(
        &finding,
        "wgsl-type",
        &files,
        "shaders/lib/b.wgsl",
        "x: i32",
    );
}

#[test]
fn an_unknown_name_has_a_neighbour() {
    let files = with_library(
        "fn b_value() -> f32 { return b_valeu2(); }\nfn b_value2() -> f32 { return 1.0; }\n",
    );
    let finding = only(files.check());
    assert_at(
        &finding,
        "wgsl-type",
        &files,
        "shaders/lib/b.wgsl",
        "b_valeu2",
    );
    assert_eq!(finding.help.as_deref(), Some("did you mean `b_value2`?"));
}

#[test]
fn all_of_nagas_labels_are_mapped() {
    let files = Files::new(&[
        (
            "shaders/a.wgsl",
            "#import \"b.wgsl\"\nfn a() -> f32 { return b(); }\n",
        ),
        ("shaders/b.wgsl", "fn b() -> f32 { return a(); }\n"),
    ]);
    let finding = only(files.check());
    assert_eq!(finding.code, "wgsl-type");
    let mut of: Vec<_> = finding
        .related
        .iter()
        .map(|(place, _)| place.file.display().to_string())
        .collect();
    of.push(finding.place.unwrap().file.display().to_string());
    assert!(of.contains(&"shaders/a.wgsl".to_owned()) && of.contains(&"shaders/b.wgsl".to_owned()));
}

#[test]
fn a_validation_error_in_an_imported_file() {
    let files = with_library(
        "fn b_value() -> f32 {\n    var x = 1.0;\n    if x { return 2.0; }\n    return x;\n}\n",
    );
    let finding = only(files.check());
    assert_at(
        &finding,
        "wgsl-validation",
        &files,
        "shaders/lib/b.wgsl",
        "if x",
    );
    assert!(!finding.message.contains('['), "{finding}");
    assert_eq!(finding.related.len(), 1);
    let files =
        with_library("fn b_value() -> f32 {\n    let x = vec2f();\n    return x + dpdx(x);\n}\n");
    let finding = only(files.check());
    assert_at(
        &finding,
        "wgsl-validation",
        &files,
        "shaders/lib/b.wgsl",
        "x + dpdx",
    );
    assert!(
        finding
            .message
            .ends_with("The `return` expression does not match the declared return type")
    );
}

#[test]
fn an_entry_points_validation_error_has_a_place() {
    let files = Files::one("@vertex\nfn main() -> @location(0) vec4f {\n    return vec4f();\n}\n");
    let finding = only(files.check());
    assert_at(
        &finding,
        "wgsl-validation",
        &files,
        "shaders/a.wgsl",
        "main",
    );
}

#[test]
fn names_that_clash_are_told_all_with_both_places() {
    let files = Files::new(&[
        (
            "shaders/a.wgsl",
            "#import \"b.wgsl\"\nfn value() {}\nconst other = 1;\nconst fine = 1;\n",
        ),
        (
            "shaders/b.wgsl",
            "\nconst  value = 1;\nstruct other { x: f32 }\n",
        ),
    ]);
    let findings = files.check().unwrap_err();
    let findings = findings.sorted();
    assert_eq!(findings.len(), 2);
    assert_at(
        findings[0],
        "name-clash",
        &files,
        "shaders/a.wgsl",
        "value()",
    );
    assert_eq!(
        findings[0].related[0].0,
        files.place("shaders/b.wgsl", "value")
    );
    assert_at(findings[1], "name-clash", &files, "shaders/a.wgsl", "other");
    assert_eq!(
        findings[1].related[0].0,
        files.place("shaders/b.wgsl", "other")
    );
}

#[test]
fn a_local_redefinition_has_both_places() {
    let files = Files::one("fn f() {\n    let x = 1;\n    let  x = 2;\n}\n");
    let finding = only(files.check());
    assert_at(&finding, "name-clash", &files, "shaders/a.wgsl", "x = 2");
    assert_eq!(
        start(&finding.related[0].0),
        start(&files.place("shaders/a.wgsl", "x = 1"))
    );
}

#[test]
fn bindings_that_clash_are_told_even_if_unused() {
    let files = Files::new(&[
        (
            "shaders/a.wgsl",
            "#import \"b.wgsl\"\n@group(0) @binding(1) var<uniform> mine: vec4f;\n@compute @workgroup_size(1)\nfn main() { _ = mine; }\n",
        ),
        (
            "shaders/b.wgsl",
            "@group(0) @binding(1)\nvar theirs: texture_2d<f32>;\n",
        ),
    ]);
    let finding = only(files.check());
    assert_at(&finding, "binding-clash", &files, "shaders/a.wgsl", "mine");
    assert_eq!(
        finding.related[0].0,
        files.place("shaders/b.wgsl", "theirs")
    );
    let both_used = files.0[0]
        .1
        .replace("_ = mine;", "_ = mine; _ = textureDimensions(theirs);");
    let files = Files(vec![("shaders/a.wgsl", both_used), files.0[1].clone()]);
    assert_eq!(codes(files.check()), ["binding-clash"]);
}

#[test]
fn a_missing_capability_is_told() {
    let files =
        Files::one("@group(0) @binding(0) var t: texture_storage_2d<rgba16unorm, write>;\n");
    let linked = files.link().unwrap();
    let finding = only(volgraph_shader::check(linked, Capabilities::empty()));
    assert_at(
        &finding,
        "wgsl-validation",
        &files,
        "shaders/a.wgsl",
        "var t",
    );
}

#[test]
fn libraries_and_choices_are_checked_alone() {
    let files = Files::new(&[
        (
            "shaders/lib/b.wgsl",
            "#import slot \"clip\"\nfn b() -> bool { return clip(); }\n",
        ),
        (
            "shaders/slot/clip/none.wgsl",
            "fn clip() -> bool { return false; }\n",
        ),
        (
            "shaders/slot/clip/bad.wgsl",
            "fn clip() -> bool { return 1; }\n",
        ),
    ]);
    let slots = |choice: &str| BTreeMap::from([("clip".to_owned(), choice.to_owned())]);
    let check = |path: &str, choice| {
        check_file(
            &files.roots(),
            Path::new(path),
            &slots(choice),
            Capabilities::empty(),
        )
    };
    assert!(
        check("lib/b.wgsl", "none")
            .unwrap()
            .entry_points()
            .is_empty()
    );
    check("shaders/lib/b.wgsl", "none").unwrap();
    check("slot/clip/none.wgsl", "none").unwrap();
    let finding = only(check("lib/b.wgsl", "bad"));
    assert_eq!(
        finding.place.unwrap().file,
        Path::new("shaders/slot/clip/bad.wgsl")
    );
}

#[test]
fn deep_nesting_and_long_chains_end() {
    let deep = format!("const a = {}1{};", "(".repeat(100_000), ")".repeat(100_000));
    assert_eq!(codes(Files::one(&deep).check()).len(), 1);
    let chain: String = (0..8_000)
        .rev()
        .fold(String::from("const c0 = 1;"), |text, at| {
            text + &format!("const c{}=c{at};", at + 1)
        });
    // Last first, so that each is reached through all others.
    Files::one(&chain).check().unwrap();
    let structs: String = (0..20).fold(String::from("struct S0 { x: u32 }\n"), |text, at| {
        text + &format!("struct S{} {{ a: S{at}, b: S{at} }}\n", at + 1)
    });
    let module = Files::one(&structs).check().unwrap();
    assert_eq!(module.struct_layout("S19").unwrap().size, 4 << 19);
    let arrays: String = (0..5_000)
        .fold(String::from("alias A0 = array<vec4f, 1>;\n"), |text, at| {
            text + &format!("alias A{} = array<A{at}, 1>;\n", at + 1)
        });
    let arrays = arrays + "struct Deep { a: A5000 }\n";
    let module = Files::one(&arrays).check().unwrap();
    assert_eq!(module.struct_layout("Deep").unwrap().size, 16);
}
