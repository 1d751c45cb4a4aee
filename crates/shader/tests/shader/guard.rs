//! Guarded modules: loops, reports, and what is left alone.

use naga::back::wgsl::{WriterFlags, write_string};
use naga::valid::{Capabilities, ModuleInfo};
use volgraph_shader::{GuardRequest, Guarded, Module, guard};

use crate::Files;

const MAX_STEPS: u32 = 1000;

pub fn guard_in(module: &Module, entries: &[&str]) -> Guarded {
    let request = GuardRequest {
        max_steps: MAX_STEPS,
        entries,
    };
    guard(module, request, Capabilities::default())
}

/// Guards `main` of one file.
fn guarded(text: &str) -> Guarded {
    guard_in(
        &Files::one(text).check().expect("a sound shader"),
        &["main"],
    )
}

/// A compute entry point with this body, the declarations before it.
pub fn compute(declarations: &str, body: &str) -> Guarded {
    guarded(&format!(
        "{declarations}\n@compute @workgroup_size(8)\nfn main(@builtin(global_invocation_id) id: vec3u) {{ {body} }}\n"
    ))
}

fn wgsl_of(module: &naga::Module, info: &ModuleInfo) -> String {
    let text = write_string(module, info, WriterFlags::empty()).expect("WGSL");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The guarded module as WGSL, all white space one blank; `_e12` is `_`, so that texts compare.
pub fn wgsl(guarded: &Guarded) -> String {
    assert_eq!(guarded.unguarded, None);
    let written = wgsl_of(&guarded.module, &guarded.info);
    let mut parts = written.split("_e");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let rest = part.trim_start_matches(|c: char| c.is_ascii_digit());
        text.push_str(if rest == part { "_e" } else { "_" });
        text.push_str(rest);
    }
    text
}

#[track_caller]
pub fn assert_has(guarded: &Guarded, part: &str) {
    let text = wgsl(guarded);
    assert!(text.contains(part), "`{part}` is not in:\n{text}");
}

fn is_same(guarded: &Guarded, module: &Module) -> bool {
    wgsl_of(&guarded.module, &guarded.info) == wgsl_of(&module.naga, &module.info)
}

pub const SPEND: &str = "let _ = guard_steps; if (_ == 0u) { break; } guard_steps = (_ - 1u);";

const BLAME: &str = "if (_ != 0u) { let _ = guard_steps; let _ = (_ - _); let _ = guard_loop_steps; \
                     if (_ > (_ * 2u)) { guard_loop_steps = _; guard_ended_loop =";

const REPORT: &str = "{ let _ = guard_loop_steps; if (_ > 500u) { atomicStore((&guard_counters[0]), 1u); } \
                      atomicMax((&guard_counters[_]), _); }";

#[test]
fn a_shader_without_hazards_stays_as_it_is() {
    let files = Files::one(
        "fn unused() { loop { break; } }\n@compute @workgroup_size(1)\nfn main() {}\n\
         @compute @workgroup_size(1)\nfn other() { unused(); }\n",
    );
    let module = files.check().unwrap();
    let guarded = guard_in(&module, &["main"]);
    assert!(is_same(&guarded, &module));
    assert_eq!(guarded.binding, None);
    assert_eq!(guarded.buffer_bytes(), 0);
    assert_eq!(guarded.unguarded, None);
    assert!(guarded.sites.is_empty() && guarded.entries_with_sites.is_empty());
    // The check sees a difference where there is one.
    assert!(!is_same(&guard_in(&module, &["other"]), &module));
}

#[test]
fn a_loop_spends_steps_and_is_blamed_where_the_author_did_not_leave_it() {
    let guarded = compute("", "var n = id.x; while n > 0u { n = n / 2u; }");
    assert_has(&guarded, "var<private> guard_steps: u32 = 1000u;");
    assert_has(
        &guarded,
        "@group(0) @binding(0) var<storage, read_write> guard_counters: array<atomic<u32>, 2>;",
    );
    assert_has(
        &guarded,
        &format!(
            "let _ = guard_steps; guard_entered = (_ + 1u); loop {{ {SPEND} let _ = n; \
             if (_ > 0u) {{ }} else {{ guard_entered = 0u; break; }}"
        ),
    );
    assert_has(
        &guarded,
        &format!("let _ = guard_entered; {BLAME} 1u; }} }}"),
    );
    assert_has(
        &guarded,
        "let _ = atomicLoad((&guard_counters[0])); if (_ != 0u) { guard_steps = 0u; \
         guard_loop_steps = 1073741824u; }",
    );
    assert_has(
        &guarded,
        &format!("let _ = guard_ended_loop; if (_ != 0u) {REPORT} return;"),
    );
    assert_eq!(guarded.binding, Some((0, 0)));
    assert_eq!(guarded.buffer_bytes(), 8);
    assert_eq!(guarded.entries_with_sites, ["main"]);
}

#[test]
fn only_a_break_that_leaves_the_loop_ends_it() {
    let guarded = compute(
        "",
        "var n = id.x;\n loop { switch n { case 1u: { break; } default: { n++; continue; } }\n \
         loop { if n == 2u { break; } }\n { if n == 3u { break; } } }",
    );
    let text = wgsl(&guarded);
    assert!(text.contains("case 1u: { break; }"), "{text}");
    assert!(
        text.contains("if (_ == 2u) { guard_entered_1 = 0u; break; }"),
        "{text}"
    );
    assert!(
        text.contains("if (_ == 3u) { guard_entered = 0u; break; }"),
        "{text}"
    );
    assert_eq!(text.matches(" = 0u; break;").count(), 2, "{text}");
    assert_eq!(text.matches(SPEND).count(), 2, "{text}");
    assert_eq!(text.matches(BLAME).count(), 2, "{text}");
}

#[test]
fn a_loop_within_a_switch_is_left_by_its_own_break() {
    let guarded = compute(
        "",
        "switch id.x { case 1u: { loop { break; } break; } default: { } }",
    );
    assert_has(&guarded, "guard_entered = 0u; break;");
    assert_eq!(wgsl(&guarded).matches("guard_entered = 0u").count(), 1);
}

#[test]
fn break_if_leaves_a_loop() {
    let guarded = compute(
        "",
        "var n = id.x; loop { if n == 5u { continue; } continuing { n++; break if n > 9u; } }",
    );
    assert_has(
        &guarded,
        "let _ = (_ > 9u); let _ = guard_entered; guard_entered = select(_, 0u, _); break if _;",
    );
    assert_has(&guarded, "if (_ == 5u) { continue; }");
}

#[test]
fn each_return_and_discard_reports() {
    let guarded = guarded(
        "fn helper(n: f32) { if n < 4.0 { discard; } }\n\
         @fragment\nfn main(@builtin(position) at: vec4f) -> @location(0) vec4f {\n\
         helper(at.y);\n\
         for (var i = 0; i < 9; i++) { if at.x < f32(i) { return vec4f(1.0); } }\n\
         if at.x < 50.0 { discard; }\n\
         if at.x < 60.0 { return vec4f(0.5); } else { return vec4f(0.0); }\n}\n",
    );
    let text = wgsl(&guarded);
    let report = REPORT;
    // Two discards, three returns, and the end behind the last two, which is not reached.
    assert_eq!(text.matches(report).count(), 6, "{text}");
    assert_eq!(text.matches(&format!("{report} discard;")).count(), 2);
    assert_eq!(text.matches(&format!("{report} return ")).count(), 3);
}

#[test]
fn a_switch_at_the_end_of_an_entry_point_is_followed_by_the_report() {
    let guarded = compute(
        "",
        "loop { break; } switch id.x { case 1u: { break; } default: { } }",
    );
    let text = wgsl(&guarded);
    // naga returns at the end of the default case alone.
    assert_eq!(text.matches("atomicMax").count(), 2, "{text}");
}

#[test]
fn a_helper_of_two_entry_points_reports_in_both() {
    let files = Files::one(
        "fn helper(n: u32) -> u32 { var i = 0u; loop { i++; if i > n { break; } } return i; }\n\
         @vertex\nfn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {\n\
         var x = 0u; while x < i { x++; } return vec4f(f32(helper(x))); }\n\
         @fragment\nfn pixel() -> @location(0) vec4f { return vec4f(f32(helper(3u))); }\n\
         @compute @workgroup_size(1)\nfn main() { _ = helper(5u); apart(); }\n\
         fn apart() { loop { break; } }\n",
    );
    let module = files.check().unwrap();
    let both = guard_in(&module, &["pixel", "main"]);
    assert_eq!(both.sites.len(), 2);
    assert_eq!(both.entries_with_sites, ["pixel", "main"]);
    assert_eq!(wgsl(&both).matches("atomicMax").count(), 2);

    // What draws: the loops of the vertex entry point end, and do not report.
    let draw = guard_in(&module, &["corner", "pixel"]);
    assert_eq!(draw.sites.len(), 1);
    assert_eq!(draw.entries_with_sites, ["pixel"]);
    let text = wgsl(&draw);
    let vertex = &text[text.find("fn corner").unwrap()..text.find("fn pixel").unwrap()];
    assert!(vertex.contains(SPEND) && !vertex.contains("guard_entered"));
    assert!(!vertex.contains("guard_counters"));

    // What a pass does not run is not touched.
    let main = &text[text.find("fn main").unwrap()..];
    assert!(!main.contains("guard_"), "{main}");
    assert!(text.contains("fn apart() { loop { break; } return; }"));

    let vertex = guard_in(&module, &["corner"]);
    assert!(vertex.sites.is_empty());
    assert_eq!((vertex.binding, vertex.buffer_bytes()), (None, 0));
    assert_eq!(wgsl(&vertex).matches(SPEND).count(), 2);
}

#[test]
fn a_loop_that_carries_a_barrier_is_left_by_all_of_a_workgroup_together() {
    let guarded = compute(
        "var<workgroup> shared_value: u32;\nfn meet() { workgroupBarrier(); }\n",
        "for (var i = 0u; i < 8u; i++) { meet(); for (var j = 0u; j < id.x; j++) { } }\n\
         loop { if workgroupUniformLoad(&shared_value) == 0u { break; } }",
    );
    let text = wgsl(&guarded);
    assert_eq!(guarded.unguarded, None);
    assert_eq!(guarded.sites.len(), 3);
    let uniform = SPEND.replace("guard_steps", "guard_uniform_steps");
    assert_eq!(text.matches(&uniform).count(), 2, "{text}");
    assert_eq!(text.matches(SPEND).count(), 1, "{text}");
    // What one invocation reads of the counters may not part it from the others.
    assert_has(
        &guarded,
        "let _ = atomicLoad((&guard_counters[0])); atomicOr((&guard_stop), _); workgroupBarrier(); \
         let _ = atomicLoad((&guard_stop)); if (_ != 0u) { guard_steps = 0u; guard_uniform_steps = 0u;",
    );
    let apart = compute(
        "",
        "workgroupBarrier(); loop { break; } workgroupBarrier();",
    );
    assert!(!wgsl(&apart).contains("guard_uniform_steps"));
}

#[test]
fn names_and_bindings_are_new_ones() {
    let guarded = compute(
        "struct guard_steps { a: u32 }\nconst guard_counters = 3u;\nfn guard_ended_loop() {}\n\
         override guard_loop_steps = 1u;\nvar<private> guard_loop_steps_: u32;\n\
         @group(0) @binding(998) var<uniform> last: guard_steps;\n@group(1) @binding(999) var<uniform> other: u32;",
        "loop { break; }",
    );
    let names: Vec<&str> = guarded
        .module
        .global_variables
        .iter()
        .filter_map(|(_, variable)| variable.name.as_deref())
        .filter(|name| name.starts_with("guard_"))
        .collect();
    assert_eq!(
        names,
        [
            "guard_loop_steps_",
            "guard_counters_",
            "guard_steps_",
            "guard_loop_steps__",
            "guard_ended_loop_"
        ]
    );
    assert_eq!(guarded.binding, Some((0, 999)));
    let guarded = compute(
        "@group(0) @binding(0) var<uniform> a: u32;\n@group(0) @binding(999) var<uniform> b: u32;",
        "loop { break; }",
    );
    assert_eq!(guarded.binding, Some((0, 1)));
}

#[test]
fn budgets_are_brought_into_their_range() {
    let module = Files::one("@compute @workgroup_size(1) fn main() { loop { break; } }").check();
    let module = module.unwrap();
    for (asked, given) in [(0, 1), (7, 7), (u32::MAX, (1 << 30) - 1)] {
        let request = GuardRequest {
            max_steps: asked,
            entries: &["main"],
        };
        let guarded = guard(&module, request, Capabilities::default());
        assert_eq!(guarded.max_steps, given);
        assert_has(
            &guarded,
            &format!("var<private> guard_steps: u32 = {given}u;"),
        );
    }
}

#[test]
fn long_chains_of_branches_do_not_run_out_of_stack() {
    let mut body = "loop { break; } if id.x == 0u { }".to_owned();
    for number in 0..5000 {
        body += &format!(" else if id.x == {number}u {{ }}");
    }
    assert_eq!(compute("", &body).sites.len(), 1);
}
