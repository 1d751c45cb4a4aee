//! Choices as constants: what of a module is left, and what is not touched.

use naga::back::wgsl::{WriterFlags, write_string};
use naga::valid::Capabilities;
use volgraph_shader::{Choices, GuardRequest, Module, check, guard, specialise};

use crate::Files;

const SHADER: &str = "
struct Params {
    /// How. @default cubic @choices none linear cubic
    method: u32,
    /// Which side. @default above @choices above below
    side: i32,
    /// How often. @default 2
    turns: u32,
}
const CUBIC: u32 = 2u;
@group(0) @binding(0) var<storage, read_write> result: array<f32>;
fn is_below() -> bool { return params.side == 1i; }
fn linear() -> f32 { return 1.5; }
fn cubic(x: f32) -> f32 {
    var sum = x;
    for (var i = 0u; i < params.turns; i++) { sum += 4.25; }
    return sum;
}
fn value(x: f32) -> f32 {
    if is_below() { return -x; }
    if params.method == CUBIC {
        return cubic(x);
    } else if params.method == 1u && x > 0.5 {
        return linear() + 7.75;
    }
    return 0.125;
}
@compute @workgroup_size(1)
fn main() { result[0] = value(result[1]); }
";

fn module() -> Module {
    Files::one(SHADER).check().expect("a sound shader")
}

fn special(choices: &[(&str, i64)]) -> Module {
    let choices: Choices = choices
        .iter()
        .map(|(name, choice)| ((*name).to_owned(), *choice))
        .collect();
    specialise(&module(), &choices, Capabilities::default()).expect("a sound module")
}

/// The function `value` as WGSL.
fn value(module: &Module) -> String {
    let text = write_string(&module.naga, &module.info, WriterFlags::empty()).expect("WGSL");
    let start = text.find("fn value(").expect("it is there");
    let end = text[start..].find("\n}").expect("it ends");
    text[start..start + end].to_owned()
}

#[test]
fn only_the_side_that_is_taken_is_left() {
    let cubic = value(&special(&[("method", 2), ("side", 0)]));
    assert!(cubic.contains("cubic("), "{cubic}");
    for gone in ["if ", "params", "is_below", "7.75", "0.125"] {
        assert!(!cubic.contains(gone), "{gone} in {cubic}");
    }
    let none = value(&special(&[("method", 0), ("side", 0)]));
    assert!(none.contains("0.125"), "{none}");
    for gone in ["params", "is_below", "cubic("] {
        assert!(!none.contains(gone), "{gone} in {none}");
    }
    // What does not depend on choices alone is asked for.
    let linear = value(&special(&[("method", 1), ("side", 0)]));
    assert!(
        linear.contains("> 0.5") && linear.contains("7.75"),
        "{linear}"
    );
    assert!(!linear.contains("params"), "{linear}");
    // A function that returns a constant is one, and nothing behind a `return` is left.
    let below = value(&special(&[("side", 1)]));
    assert!(below.contains("return -(x"), "{below}");
    for gone in ["if ", "is_below", "params.method"] {
        assert!(!below.contains(gone), "{gone} in {below}");
    }
}

#[test]
fn numbers_and_unknown_choices_stay_in_the_uniform() {
    // `turns` is a number, whatever is said of it.
    let module = special(&[("turns", 2), ("method", 2)]);
    let text = write_string(&module.naga, &module.info, WriterFlags::empty()).expect("WGSL");
    assert!(
        text.contains("params.turns") && text.contains("params.side"),
        "{text}"
    );
    assert!(!text.contains("params.method"), "{text}");
    let same = special(&[]);
    assert_eq!(value(&same), value(&self::module()));
}

#[test]
fn the_layout_of_the_uniform_and_the_places_stay() {
    let (plain, special) = (module(), special(&[("method", 2), ("side", 0)]));
    assert_eq!(
        plain.struct_layout("Params"),
        special.struct_layout("Params")
    );
    assert_eq!(plain.params(), special.params());
    let request = GuardRequest {
        max_steps: 100,
        entries: &["main"],
    };
    let sites = |module| guard(module, request, Capabilities::default()).sites;
    assert_eq!(sites(&special), sites(&plain));
    // A loop that is ruled out is not watched.
    let without = self::special(&[("method", 0), ("side", 0)]);
    assert!(!value(&without).contains("cubic"));
}

#[test]
fn a_number_with_constant_is_one_and_others_are_not() {
    let text = "
struct Params {
    /// How many. @default 2 @range -4 4 @constant
    count: i32,
    /// How much. @default 2
    much: u32,
    /// Where. @default b @choices a b @uniform
    side: u32,
}
@group(0) @binding(0) var<storage, read_write> result: array<i32>;
@compute @workgroup_size(1)
fn main() {
    if params.count > -3 { result[0] = params.count; }
    if params.much > 1u { result[1] = i32(params.side); }
}
";
    let module = Files::one(text).check().expect("a sound shader");
    assert!(module.params()[0].is_constant && !module.params()[1].is_constant);
    let choices = Choices::from([
        ("count".to_owned(), -2),
        ("much".to_owned(), 0),
        ("side".to_owned(), 0),
    ]);
    let special = specialise(&module, &choices, Capabilities::default()).expect("a sound module");
    let text = write_string(&special.naga, &special.info, WriterFlags::empty()).expect("WGSL");
    assert_eq!(text.matches("if ").count(), 1, "{text}");
    assert!(
        text.contains("result[0] = -2") && text.contains("params.side"),
        "{text}"
    );
    for wrong in [
        "@constant 2",
        "@choices a b c @constant",
        "@uniform",
        "@choices a b c @uniform d",
    ] {
        let text = text_with(wrong);
        let findings = Files::one(&text).check().expect_err("what is wrong");
        assert!(
            findings.to_string().contains("stands alone"),
            "{wrong}: {findings}"
        );
    }
}

fn text_with(tags: &str) -> String {
    format!(
        "struct Params {{
    /// How. @default 1 {tags}
    how: u32,
}}
@compute @workgroup_size(1)
fn main() {{ _ = params.how; }}
"
    )
}

#[test]
fn what_loads_the_whole_struct_still_compiles() {
    let text = "
struct Params {
    /// How. @default b @choices a b
    method: u32,
}
@group(0) @binding(0) var<storage, read_write> result: array<u32>;
@compute @workgroup_size(1)
fn main() {
    let all = params;
    result[0] = all.method;
    loop {
        if params.method == 1u { break; }
        result[1] += 1u;
    }
    switch params.method {
        case 0u: { result[2] = 3u; }
        default: { if params.method == 0u { return; } result[3] = 4u; }
    }
}
";
    let module = Files::one(text).check().expect("a sound shader");
    for choice in [0, 1] {
        let choices = Choices::from([("method".to_owned(), choice)]);
        let special = specialise(&module, &choices, Capabilities::default());
        let special = special.unwrap_or_else(|why| panic!("{choice}: {why}"));
        let text = write_string(&special.naga, &special.info, WriterFlags::empty()).expect("WGSL");
        assert!(!text.contains("if "), "{text}");
    }
}

#[test]
fn volgraphs_own_shaders_can_be_specialised() {
    let mut count = 0;
    for linked in crate::guard_places::own_shaders() {
        let name = format!("{:?}", linked.slots_used);
        let module = check(linked, Capabilities::default()).expect("a sound shader");
        let specs = module.params().iter();
        let specs: Vec<_> = specs.filter(|spec| !spec.choices().is_empty()).collect();
        for is_last in [false, true] {
            let index = |count: usize| if is_last { count - 1 } else { 0 };
            let choices: Choices = specs
                .iter()
                .map(|spec| {
                    let index = index(spec.choices().len());
                    (spec.name.clone(), i64::try_from(index).expect("few"))
                })
                .collect();
            if let Err(why) = specialise(&module, &choices, Capabilities::default()) {
                panic!("{name}: {why}");
            }
            count += usize::from(!choices.is_empty());
        }
    }
    assert!(count > 50, "{count}");
}
