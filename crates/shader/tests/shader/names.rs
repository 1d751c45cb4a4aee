//! "Did you mean", for names, members, paths and slots.

use volgraph_shader::{LinkRequest, link};

use crate::Files;

#[test]
fn near_names_are_suggested() {
    let help = |text: &str| {
        let findings = Files::one(text).check().unwrap_err();
        findings.sorted()[0].help.clone()
    };
    let struct_s = "struct Other { dapth: f32 }\nstruct S { color: vec3f, dept: f32 }\n";
    for (text, near) in [
        (
            "fn f(distance: f32) -> f32 { return distnace; }",
            Some("distance"),
        ),
        (
            "fn f() { var<function> total = 1.0; total += totl; }",
            Some("total"),
        ),
        (
            "fn f() -> f32 { let later2 = 1.0; return laterr; let laterx = 1.0; }",
            Some("later2"),
        ),
        ("fn f() -> f32 { return lenght(vec2f()); }", Some("length")),
        ("fn f(a: vec3ff) { }", Some("vec3f")),
        ("fn f() -> bool { return ture; }", Some("true")),
        ("fn f() -> f32 { return x; } fn y() { }", None),
        ("fn f() -> f32 { return quaternion; }", None),
        ("fn f(s: S) -> f32 { return s.depth; }", Some("dept")),
        (
            "fn f(s: ptr<function, S>) -> f32 { return (*s).colr.x; }",
            Some("color"),
        ),
        (
            "fn f() -> vec3f { let s = S(); return s.colour; }",
            Some("color"),
        ),
        ("fn f(v: vec3f) -> vec3f { return v.colr; }", None),
        (
            "struct Params { /// @default 1\n step: f32 } fn f() -> f32 { return params.stpe; }",
            Some("step"),
        ),
    ] {
        let expected = near.map(|near| format!("did you mean `{near}`?"));
        assert_eq!(help(&format!("{struct_s}{text}")), expected, "{text}");
    }
}

#[test]
fn paths_and_slots_nearly_right_are_suggested() {
    let help = |line: &str| {
        let files = Files::new(&[
            ("shaders/a.wgsl", line),
            ("shaders/lib/ray.wgsl", ""),
            ("shaders/lib/volume.wgsl", ""),
        ]);
        let request = LinkRequest::new("a.wgsl").slot("light", "none");
        let findings = link(&files.roots(), &request).unwrap_err();
        findings.sorted()[0].help.clone().unwrap_or_default()
    };
    for (line, near) in [
        ("#import \"lib/rya.wgsl\"", "did you mean `lib/ray.wgsl`?"),
        ("#import \"libs/ray.wgsl\"", "did you mean `lib/ray.wgsl`?"),
        ("#import \"volume.wgsl\"", "did you mean `lib/volume.wgsl`?"),
        (
            "#import \"deep/er/volume.wgsl\"",
            "did you mean `lib/volume.wgsl`?",
        ),
        (
            "#import \"lib/quite_other.wgsl\"",
            "known here: `lib/ray.wgsl`, `lib/volume.wgsl`",
        ),
        ("#import slot \"lihgt\"", "did you mean the slot `light`?"),
        (
            "#import slot \"quite_other\"",
            "set it to a path that ends in `.wgsl`",
        ),
    ] {
        assert_eq!(help(line), near, "{line}");
    }
}
