//! Uniforms read once: who reads what, and what stays.

use naga::back::wgsl::{WriterFlags, write_string};
use naga::valid::Capabilities;
use volgraph_shader::{Module, hoist_uniforms};

use crate::Files;

const SHADER: &str = "
struct Small { matrix: mat3x3f, bias: vec3f }
struct Large { rows: array<vec4f, 4> }
@group(0) @binding(0) var<uniform> small: Small;
@group(0) @binding(1) var<uniform> large: Large;
@group(0) @binding(2) var<storage, read_write> result: array<vec3f>;
@group(0) @binding(3) var<uniform> gain: f32;
fn value(x: vec3f) -> vec3f { return small.matrix * x + small.bias + large.rows[1].xyz; }
@compute @workgroup_size(1)
fn first() {
    for (var i = 0u; i < 4u; i++) { result[i] = value(result[i]); }
}
@compute @workgroup_size(1)
fn second() { result[0] = gain * result[1]; }
";

fn hoisted() -> (Module, String) {
    let module = Files::one(SHADER).check().expect("a sound shader");
    let hoisted = hoist_uniforms(&module, Capabilities::default()).expect("a sound module");
    let text = write_string(&hoisted.naga, &hoisted.info, WriterFlags::empty()).expect("WGSL");
    (hoisted, text)
}

/// The text from a function's head to its end.
fn function<'t>(text: &'t str, name: &str) -> &'t str {
    let start = text.find(&format!("fn {name}(")).expect("it is there");
    let end = text[start..].find("\n}").expect("it ends");
    &text[start..start + end]
}

#[test]
fn functions_read_copies() {
    let (_, text) = hoisted();
    assert!(text.contains("var<private> small_copy: Small;"), "{text}");
    let value = function(&text, "value");
    assert!(
        value.contains("small_copy.") && !value.contains("small."),
        "{value}"
    );
}

#[test]
fn an_entry_point_copies_what_it_uses_and_nothing_else() {
    let (_, text) = hoisted();
    let [first, second] = ["first", "second"].map(|name| function(&text, name));
    assert!(
        first.contains("small_copy = ") && !first.contains("gain"),
        "{first}"
    );
    assert!(
        second.contains("gain_copy = ") && !second.contains("small"),
        "{second}"
    );
}

/// Layouts are made of what entry points use.
#[test]
fn bindings_are_used_as_before() {
    let module = Files::one(SHADER).check().expect("a sound shader");
    let (hoisted, _) = hoisted();
    for entry in ["first", "second"] {
        let names = |module: &Module| -> Vec<String> {
            let bindings = module.used_bindings(entry);
            bindings
                .iter()
                .map(|binding| binding.name.clone())
                .collect()
        };
        assert_eq!(names(&module), names(&hoisted));
    }
}

#[test]
fn arrays_stay_where_they_are() {
    let (_, text) = hoisted();
    assert!(!text.contains("large_copy"), "{text}");
    assert!(function(&text, "value").contains("large.rows"), "{text}");
}
