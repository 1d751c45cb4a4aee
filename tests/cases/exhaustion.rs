//! What a machine has not enough of: device memory for a texture, stack for a shader that nests deep.

use std::collections::BTreeSet;

use volgraph::{Change, Outcome, Session, SessionOptions};
use volgraph_tests::kinds::{Trap, registry};
use volgraph_tests::{Stage, adapters, gpu_alone, options};

const SIZE: [u32; 2] = [16, 16];

fn graph(value: f32, side: u32) -> String {
    format!(
        r#"(
    sources: {{}},
    nodes: {{
        "ballast": (kind: "ballast", params: {{ "side": {side} }}),
        "flat": (kind: "flat", in: {{ "texture": "ballast" }}, params: {{ "value": {value:?} }}),
    }},
    outputs: {{ "color": "flat.color" }},
)"#
    )
}

fn everything() -> Change {
    Change::Files(BTreeSet::new())
}

/// The first pixel's red.
fn red(session: &mut Session) -> f32 {
    session.render().unwrap().0.color[0][0]
}

#[test]
fn more_memory_than_there_is() {
    for backend in adapters() {
        let stage = Stage::new().with("graph.ron", graph(0.25, 4));
        let options = SessionOptions {
            max_resource_bytes: Some(1 << 40),
            ..options(&[], &backend, SIZE)
        };
        let gpu = gpu_alone(&backend);
        let mut session = stage
            .open_with("graph.ron", &options, registry(&Trap::default()), gpu)
            .unwrap();
        assert_eq!(red(&mut session), 0.25);
        let memory = session.render().unwrap().1.memory;
        let objects = session.live_objects();
        // 128 GiB.
        stage.write("graph.ron", graph(0.5, 2048));
        let refused = session.apply(&everything()).unwrap_err();
        let text = refused.findings.to_string();
        assert_eq!(
            refused.findings.sorted()[0].code,
            "out-of-memory",
            "{backend}: {text}"
        );
        assert!(
            refused.device_remade.is_none(),
            "{backend}: the device stays"
        );
        assert_eq!(red(&mut session), 0.25, "{backend}: as before");
        assert_eq!(
            session.render().unwrap().1.memory.bytes,
            memory.bytes,
            "{backend}"
        );
        assert_eq!(session.live_objects(), objects, "{backend}");
        stage.write("graph.ron", graph(0.75, 4));
        assert!(
            matches!(session.apply(&everything()), Ok(Outcome::Drawn(_))),
            "{backend}"
        );
        assert_eq!(red(&mut session), 0.75, "{backend}");
    }
}

/// Compilers recurse over what nests: a deep shader is drawn, or refused with a finding, and the session goes on.
#[test]
fn a_chain_of_a_thousand_else_ifs() {
    let technique = |levels: u32| {
        let chain: String = (1..levels)
            .map(|level| format!(" else if k == {level}u {{ y = {level}.0; }}"))
            .collect();
        format!(
            r#"// Nests deep.
#import "lib/ray.wgsl"

struct TechniqueState {{ sum: f32, }}

fn technique_begin(ray: Ray) -> TechniqueState {{
    return TechniqueState(0.0);
}}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {{
    var y = 0.5;
    let k = u32(segment.front.scalar);
    if k == 0u {{ y = 1.0; }}{chain}
    (*state).sum += 0.01 * y;
    return false;
}}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {{
    return RayResult(vec4f(state.sum), RAY_NO_DEPTH);
}}
"#
        )
    };
    let text = volgraph_tests::graph(
        r#"path: "v_4x4x4_float32.raw""#,
        "orbit()",
        "{}",
        r#"{ "technique": "deep" }"#,
        r#"{ "stage": "fragment" }"#,
    );
    for backend in adapters() {
        let file = "slot/technique/deep.wgsl";
        let stage = Stage::new()
            .with_floats("v", [4, 4, 4], |x, y, z| (x + y + z) as f32)
            .with(
                "transfer.ron",
                "(color: (1, 1, 1), opacity: [(0, 0), (1, 1)])",
            )
            .with("graph.ron", text.as_str())
            .with(file, technique(2));
        let mut session = stage.open("graph.ron", &[], &backend, SIZE).unwrap();
        session.render().unwrap();
        stage.write(file, technique(1000));
        if let Err(refused) = session.apply(&everything()) {
            let text = refused.findings.to_string();
            assert!(text.contains("device"), "{backend}: {text}");
        }
        stage.write(file, technique(3));
        let drawn = session.apply(&everything());
        assert!(matches!(drawn, Ok(Outcome::Drawn(_))), "{backend}");
    }
}
