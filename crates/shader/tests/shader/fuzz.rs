//! Whatever the text: no panic, and every place lies in the author's file.

use naga::valid::Capabilities;
use proptest::prelude::*;
use volgraph_report::Place;
use volgraph_shader::{Linked, check};

use crate::Files;

/// What means something to the linker or to naga.
const PIECES: [&str; 44] = [
    "#import \"b.wgsl\"\n",
    "\n",
    " ",
    "//",
    "///",
    "/*",
    "*/",
    "enable f16;",
    "requires x;",
    "diagnostic(off, derivative_uniformity);",
    "struct Params {",
    "struct Params { /// @default 1\n a: f32, }",
    "struct Params { b: vec3<f32> /// x\n, }",
    "struct",
    "Params",
    "params",
    "params.a",
    "}",
    "{",
    "(",
    ")",
    "<",
    ">",
    ":",
    ";",
    ",",
    "@",
    "@group(0) @binding(0) ",
    "/// @default 1\n",
    "@range 0 1",
    "a: f32,",
    "b: vec3<f32>",
    "fn f() {",
    "fn g() -> f32 { return params.a; }",
    "let x = 1;",
    "if x {",
    "var<private> v: f32;",
    "var t: texture_2d<f32>;",
    "const c = 1;",
    "const d = c;",
    "ä\u{2028}",
    "\u{feff}",
    "\r\n",
    "return;",
];

/// What the linker refuses.
const BAD_PIECES: [&str; 6] = [
    "#import \"a.wgsl\"\n",
    "#import slot \"x\"\n",
    "\n#import",
    "#",
    "\"",
    "\n#import \"",
];

fn text() -> impl Strategy<Value = String> {
    let piece = prop_oneof![
        60 => proptest::sample::select(PIECES.to_vec()).prop_map(str::to_owned),
        1 => proptest::sample::select(BAD_PIECES.to_vec()).prop_map(str::to_owned),
        2 => any::<char>().prop_map(String::from),
    ];
    proptest::collection::vec(piece, 0..16).prop_map(|pieces| pieces.concat())
}

fn assert_in_file(linked: &Linked, place: &Place) {
    let text = linked.file_text(&place.file).expect("a linked file");
    let lines: Vec<&str> = text.split('\n').collect();
    let line = lines
        .get(place.line as usize - 1)
        .expect("a line of the file");
    // One more is the end of the line.
    assert!(place.column as usize <= line.chars().count() + 1, "{place}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_links_or_is_told(a in text(), b in text()) {
        let files = Files::new(&[("shaders/a.wgsl", &a), ("shaders/b.wgsl", &b)]);
        if let Ok(linked) = files.link() {
            for offset in 0..=linked.text.len() + 3 {
                assert_in_file(&linked, &linked.place(offset, 3));
            }
            let annotated = linked.annotated();
            prop_assert!(annotated.len() >= linked.text.len());
            if let Err(findings) = check(linked.clone(), Capabilities::default()) {
                prop_assert!(findings.has_errors());
                prop_assert!(findings.sorted().iter().all(|finding| finding.code != "wgsl-internal"), "{findings}");
                for finding in &findings {
                    let place = finding.place.as_ref().expect("a place");
                    if place.line > 0 {
                        assert_in_file(&linked, place);
                    }
                }
            }
        }
    }

    #[test]
    fn any_doc_comment_is_read_or_told(doc in "[ @a-z0-9./-]{0,40}", tag in "@(default|range|unit|choices|color)", words in "[ a-z0-9.-]{0,12}") {
        let text = format!("struct Params {{\n/// {doc} {tag} {words}\np: u32,\n/// @default 1 {tag} {words}\nq: vec3f,\n}}\n");
        if let Err(findings) = Files::one(&text).check() {
            prop_assert!(findings.sorted().iter().all(|finding| finding.code == "params-doc"), "{findings}");
        }
    }
}
