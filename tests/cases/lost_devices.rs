//! Devices that go at any moment, and changes beside a disk that holds mistakes.

use std::collections::BTreeSet;
use std::sync::Arc;

use volgraph::{Change, Drawn, Outcome, ParamOverride, Session};
use volgraph_tests::kinds::{Moment, Trap, registry};
use volgraph_tests::{Stage, adapters, gpu_alone, options};

fn graph(value: f32) -> String {
    format!(
        r#"(
    sources: {{}},
    nodes: {{ "flat": (kind: "flat", params: {{ "value": {value:?} }}) }},
    outputs: {{ "color": "flat.color" }},
)"#
    )
}

fn everything() -> Change {
    Change::Files(BTreeSet::new())
}

fn drawn(session: &mut Session, change: &Change) -> Drawn {
    match session.apply(change) {
        Ok(Outcome::Drawn(drawn)) => *drawn,
        Ok(Outcome::Unchanged) => panic!("{change:?} makes a difference"),
        Err(refused) => panic!("{change:?}: {}", refused.findings),
    }
}

#[test]
fn a_device_that_goes_at_any_moment_is_opened_again() {
    for backend in adapters() {
        for moment in [Moment::Prepare, Moment::Frame, Moment::ReadBack] {
            let what = format!("{backend}, {moment:?}");
            let trap = Trap::default();
            let stage = Stage::new().with("graph.ron", graph(0.25));
            let gpu = gpu_alone(&backend);
            let mut session = stage
                .open_with(
                    "graph.ron",
                    &options(&[], &backend, [4, 4]),
                    registry(&trap),
                    Arc::clone(&gpu),
                )
                .unwrap();
            assert_eq!(session.render().unwrap().0.color[0][0], 0.25, "{what}");
            stage.write("graph.ron", graph(0.5));
            trap.arm(moment, gpu);
            let drawn = drawn(&mut session, &everything());
            assert!(trap.is_idle(), "{what}: it did go");
            assert!(drawn.report.device_remade.is_some(), "{what}");
            assert_eq!(drawn.picture.color[0][0], 0.5, "{what}");
            assert_eq!(session.render().unwrap().0.color[0][0], 0.5, "{what}");
        }
    }
}

#[test]
fn values_camera_and_size_change_while_the_disk_holds_a_mistake() {
    for backend in adapters() {
        let stage = Stage::new().with("graph.ron", graph(0.25));
        let mut session = stage
            .open_with(
                "graph.ron",
                &options(&[], &backend, [4, 4]),
                registry(&Trap::default()),
                gpu_alone(&backend),
            )
            .unwrap();
        session.render().unwrap();
        stage.write("graph.ron", "(nodes: {");
        assert!(session.apply(&everything()).is_err(), "{backend}");
        let set = ParamOverride::parse("flat.value=0.75").unwrap();
        let new = drawn(&mut session, &Change::Set(vec![set]));
        assert_eq!(new.picture.color[0][0], 0.75, "{backend}: a value");
        let new = drawn(&mut session, &Change::Size([6, 5]));
        assert_eq!((new.picture.width, new.picture.height), (6, 5), "{backend}");
        assert_eq!(new.picture.color[0][0], 0.75, "{backend}: kept");
        // The mistake is still one; mended, the value that was set stands over the file's.
        assert!(session.apply(&everything()).is_err(), "{backend}");
        stage.write("graph.ron", format!("// Mended.\n{}", graph(0.5)));
        let new = drawn(&mut session, &everything());
        assert_eq!(new.picture.color[0][0], 0.75, "{backend}: by name");
    }
}
