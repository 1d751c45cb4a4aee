//! The merged `struct Params` and the doc comments of its members.

use volgraph_report::Place;
use volgraph_shader::{
    MemberType, ParamSpec, ParamType, ParamValue, ScalarType, StructLayout, UniformWriter,
};

use crate::{Files, assert_at, codes, only};

fn merged() -> Files {
    Files::new(&[
        (
            "shaders/a.wgsl",
            "#import \"b.wgsl\"\nstruct Params {\n    /// Length of a segment. @default 1.0 @range 0.01 16.0 @unit voxel\n    step: f32,\n    /// Whether rays end early.\n    /// @default 1 @choices off on\n    early: u32\n}\n\n@compute @workgroup_size(1)\nfn main() {\n    _ = params.step + params.weight.x;\n}\n",
        ),
        (
            "shaders/b.wgsl",
            "struct Params {\n    /// Weights. @default 0.5 1 2 @color\n    weight: vec3<f32>, // a, b\n}\nfn b() -> f32 { return params.weight.x; }\n",
        ),
    ])
}

#[test]
fn the_params_of_all_files_are_one_struct() {
    let files = merged();
    let module = files.check().unwrap();
    let names: Vec<_> = module
        .params()
        .iter()
        .map(|param| param.name.as_str())
        .collect();
    assert_eq!(names, ["weight", "step", "early"]);
    let weight = &module.params()[0];
    assert_eq!(weight.ty, ParamType::Vector(3));
    assert_eq!(weight.default, ParamValue::Vector(vec![0.5, 1.0, 2.0]));
    assert!(weight.is_color);
    assert_eq!(weight.place, Some(files.place("shaders/b.wgsl", "weight")));
    let step = &module.params()[1];
    assert_eq!(step.doc, "Length of a segment.");
    assert_eq!(
        (&step.default, step.range, step.unit.as_deref()),
        (&ParamValue::Float(1.0), Some((0.01, 16.0)), Some("voxel"))
    );
    let early = &module.params()[2];
    assert_eq!(early.choices(), ["off", "on"]);
    assert_eq!(early.default, ParamValue::Text("on".into()));
    // weight 0..12, step 12..16, early 16..20, rounded up to the alignment of vec3f.
    let layout = module.struct_layout("Params").unwrap();
    let offsets: Vec<_> = layout.members.iter().map(|member| member.offset).collect();
    assert_eq!((offsets, layout.size), (vec![0, 12, 16], 32));
    assert_eq!(
        layout.members[0].place,
        files.place("shaders/b.wgsl", "weight")
    );
    let mut writer = UniformWriter::new(&layout);
    for param in module.params() {
        writer.set_param(param, &param.default).unwrap();
    }
    let bytes = writer.finish().unwrap();
    assert_eq!(bytes[12..16], 1.0_f32.to_le_bytes());
    assert_eq!(bytes[16..20], 1_u32.to_le_bytes());
}

#[test]
fn the_binding_of_params_is_used_where_params_are() {
    let module = merged().check().unwrap();
    let bindings = module.used_bindings("main");
    assert_eq!(
        (
            bindings[0].name.as_str(),
            bindings[0].group,
            bindings[0].binding
        ),
        ("params", 3, 0)
    );
    assert_eq!(
        bindings[0].place,
        merged().place("shaders/b.wgsl", "Params")
    );
}

#[test]
fn a_member_of_two_files_clashes() {
    let mut files = merged();
    files.0[1].1 = files.0[1].1.replace("weight: vec3<f32>", "step: f32");
    let finding = only(files.link());
    assert_at(
        &finding,
        "params-clash",
        &files,
        "shaders/a.wgsl",
        "step: f32",
    );
    assert_eq!(finding.related[0].0, files.place("shaders/b.wgsl", "step"));
}

#[test]
fn errors_inside_merged_members_are_at_the_authors_places() {
    let mut files = merged();
    files.0[1].1 = files.0[1].1.replace("vec3<f32>", "vec3<nope>");
    assert_at(
        &only(files.check()),
        "wgsl-type",
        &files,
        "shaders/b.wgsl",
        "nope",
    );
    let mut files = merged();
    files.0[0].1 = files.0[0].1.replace("early: u32", "early u32");
    assert_at(
        &only(files.check()),
        "wgsl-syntax",
        &files,
        "shaders/a.wgsl",
        "u32",
    );
    let mut files = merged();
    files.0[0].1 = files.0[0].1.replace("early: u32", "early: array<f32, 3>");
    let findings = files.check().unwrap_err();
    let codes: Vec<_> = findings
        .sorted()
        .iter()
        .map(|finding| finding.code)
        .collect();
    assert!(
        codes.contains(&"params-doc") && codes.contains(&"wgsl-validation"),
        "{findings}"
    );
}

#[test]
fn names_of_the_linker_are_taken() {
    let mut files = merged();
    files.0[1].1 += "@group(3) @binding(0) var<uniform> params: Params;\n";
    let finding = only(files.check());
    assert_at(
        &finding,
        "name-clash",
        &files,
        "shaders/b.wgsl",
        "params: Params",
    );
    assert_eq!(
        finding.related[0].0,
        files.place("shaders/b.wgsl", "Params")
    );
    let mut files = merged();
    files.0[1].1 += "@group(3) @binding(0) var<uniform> other: vec4f;\n";
    let finding = only(files.check());
    assert_at(&finding, "binding-clash", &files, "shaders/b.wgsl", "other");
    assert_eq!(
        finding.related[0].0,
        files.place("shaders/b.wgsl", "Params")
    );
}

#[test]
fn an_empty_params_is_nagas_matter() {
    let files = Files::one("struct Params {}\n");
    assert_eq!(
        only(files.check()).place,
        Some(files.place("shaders/a.wgsl", "Params"))
    );
}

/// The params of one member with this doc comment, or the place of the one thing wrong with it.
fn member(doc: &str, ty: &str) -> Result<ParamSpec, (String, Place)> {
    let files = Files::one(&format!(
        "struct Params {{\n    /// {doc}\n    p: {ty},\n}}\n"
    ));
    match files.check() {
        Ok(module) => Ok(module.params()[0].clone()),
        Err(findings) => {
            let finding = only::<()>(Err(findings));
            assert_eq!(finding.code, "params-doc", "{finding}");
            Err((finding.message.clone(), finding.place.expect("a place")))
        }
    }
}

#[test]
fn good_tags() {
    let spec = member("@default -3 @range -5 5", "i32").unwrap();
    assert_eq!(
        (spec.ty, spec.default, spec.doc.as_str()),
        (ParamType::Int, ParamValue::Int(-3), "")
    );
    let spec = member(
        "Mode. @choices none linear bisection @default bisection",
        "i32",
    )
    .unwrap();
    assert_eq!(spec.default, ParamValue::Text("bisection".into()));
    let spec = member("@default 1 2 @range 0 2", "vec2u").unwrap();
    assert_eq!(
        (spec.ty, spec.default),
        (ParamType::UintVector(2), ParamValue::Vector(vec![1.0, 2.0]))
    );
    let spec = member("Mail a@b.c, see 3.1. @default 1e-3", "f32").unwrap();
    assert_eq!(
        (spec.doc.as_str(), spec.default),
        ("Mail a@b.c, see 3.1.", ParamValue::Float(1e-3))
    );
}

#[test]
fn bad_tags_are_told_at_their_places() {
    // The doc comment starts at column 5, its text at column 9.
    for (doc, ty, column, says) in [
        ("Meaning.", "f32", 5, "no `@default`"),
        ("@defualt 1", "f32", 9, "unknown tag `@defualt`"),
        ("@default one", "f32", 18, "no number"),
        ("@default nan", "f32", 18, "no number"),
        ("@default 1 2", "f32", 18, "takes a number"),
        ("@default", "f32", 9, "takes a number"),
        ("@default 1 2", "vec3f", 18, "takes 3 numbers"),
        ("@default 1.5", "u32", 18, "not a whole number"),
        ("@default -1", "u32", 18, "below"),
        ("@default 5 @range 0 2", "f32", 18, "above"),
        ("@default 1 @range 2", "f32", 20, "two numbers"),
        ("@default 1 @range 2 0", "f32", 20, "larger number first"),
        ("@default 1 @range x 2", "f32", 27, "no number"),
        ("@default 1 @unit", "f32", 20, "one word"),
        ("@default 1 @choices a b", "f32", 20, "for u32"),
        ("@default 1 @choices a a", "u32", 31, "given twice"),
        ("@default 2 @choices a b", "u32", 18, "no choice"),
        ("@default 1 @choices", "u32", 20, "names"),
        ("@default 1 @color", "f32", 20, "only vec3f"),
        ("@default 1 @default 2", "f32", 20, "given twice"),
    ] {
        let (message, place) = member(doc, ty).expect_err(doc);
        assert!(message.contains(says), "{doc}: {message}");
        let line = if says.contains("no `@default`") { 3 } else { 2 };
        assert_eq!(
            (place.line, place.column),
            (line, column),
            "{doc}: {message}"
        );
    }
}

#[test]
fn several_members_show_all_their_faults() {
    let files = Files::one("struct Params {\n    a: f32,\n    /// @default 1 @x\n    b: f32,\n}\n");
    assert_eq!(codes(files.check()), ["params-doc", "params-doc"]);
    // naga 30 would give `b`'s comment to `a`.
    let files = Files::one("struct Params {\n    /// A. @default 1\n    a: f32,\n    b: f32,\n}\n");
    assert_at(
        &only(files.check()),
        "params-doc",
        &files,
        "shaders/a.wgsl",
        "b: f32",
    );
}

#[test]
fn values_are_checked_and_coerced() {
    let float = ParamSpec::float("f", 1.0, "").range(0.0, 2.0).unit("voxel");
    assert_eq!(float.check(&ParamValue::Int(2)), Ok(ParamValue::Float(2.0)));
    assert_eq!(
        float.check(&ParamValue::Float(2.5)).unwrap_err(),
        "`2.5` is above what is allowed: 0 to 2 voxel"
    );
    assert!(float.check(&ParamValue::Float(f64::NAN)).is_err());
    assert!(
        float
            .check(&ParamValue::Bool(true))
            .unwrap_err()
            .contains("expected a number, found `true`")
    );
    assert!(
        ParamSpec::float("f", 1.0, "")
            .check(&ParamValue::Float(1e300))
            .is_err()
    );
    let int = ParamSpec::int("i", 1, "");
    assert!(int.check(&ParamValue::Float(1.0)).is_err());
    assert!(int.check(&ParamValue::Int(1 << 40)).is_err());
    assert!(
        ParamSpec::uint("u", 1, "")
            .check(&ParamValue::Int(-1))
            .is_err()
    );
    let choice = ParamSpec::choice("c", &["off", "on"], "on", "");
    assert_eq!(
        choice.check(&ParamValue::Int(0)),
        Ok(ParamValue::Text("off".into()))
    );
    assert!(
        choice
            .check(&ParamValue::Text("onn".into()))
            .unwrap_err()
            .contains("did you mean `on`?")
    );
    assert!(choice.check(&ParamValue::Int(2)).is_err());
    let vector = ParamSpec::vector("v", &[1.0, 2.0], "").range(0.0, 3.0);
    assert!(vector.check(&ParamValue::Vector(vec![1.0])).is_err());
    assert!(vector.check(&ParamValue::Vector(vec![1.0, 4.0])).is_err());
    assert!(
        ParamSpec::bool("b", true, "")
            .check(&ParamValue::Int(1))
            .is_err()
    );
}

#[test]
fn the_command_line_reads_what_values_show() {
    for spec in [
        ParamSpec::float("f", 0.1, ""),
        ParamSpec::int("i", -7, ""),
        ParamSpec::bool("b", true, ""),
        ParamSpec::choice("c", &["off", "on"], "on", ""),
        ParamSpec::vector("v", &[0.25, 1.0, -3.0], ""),
        ParamSpec::text("t", "any, text", ""),
    ] {
        assert_eq!(
            spec.parse_cli(&spec.default.to_string()),
            Ok(spec.default.clone())
        );
    }
    let vector = ParamSpec::vector("v", &[0.0, 0.0], "");
    assert_eq!(
        vector.parse_cli("1, 2.5"),
        Ok(ParamValue::Vector(vec![1.0, 2.5]))
    );
    assert!(
        vector
            .parse_cli("1;2")
            .unwrap_err()
            .contains("expected 2 numbers")
    );
    assert!(ParamSpec::int("i", 1, "").parse_cli("1.5").is_err());
    assert!(ParamSpec::float("f", 1.0, "").parse_cli("inf").is_err());
}

#[test]
fn param_values_are_written_in_their_members_types() {
    let member = |name: &str, offset, ty| volgraph_shader::Member {
        name: name.to_owned(),
        offset,
        size: 4,
        ty,
        place: Place::whole_file("x"),
    };
    let layout = StructLayout {
        name: "Params".into(),
        size: 16,
        members: vec![
            member("i", 0, MemberType::Scalar(ScalarType::I32)),
            member("v", 8, MemberType::Vector(ScalarType::U32, 2)),
        ],
    };
    let mut writer = UniformWriter::new(&layout);
    let int = ParamSpec::int("i", 1, "");
    writer.set_param(&int, &ParamValue::Int(-2)).unwrap();
    assert!(writer.set_param(&int, &ParamValue::Float(0.5)).is_err());
    assert!(
        writer
            .set_param(&ParamSpec::int("j", 1, ""), &ParamValue::Int(1))
            .is_err()
    );
    let vector = ParamSpec::new(
        "v",
        ParamType::UintVector(2),
        ParamValue::Vector(vec![1.0, 1.0]),
        "",
    );
    writer
        .set_param(&vector, &ParamValue::Vector(vec![3.0, 4_294_967_295.0]))
        .unwrap();
    let bytes = writer.finish().unwrap();
    assert_eq!(bytes[0..4], (-2_i32).to_le_bytes());
    assert_eq!(bytes[12..16], u32::MAX.to_le_bytes());
}
