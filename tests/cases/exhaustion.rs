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
