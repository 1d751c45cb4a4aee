//! Hazards of live code: each is planted into a session that works. The session says what happened, draws the picture of
//! before, bit for bit, with the pipelines and memory of before, and takes the next good edit.

use std::collections::BTreeSet;

use volgraph::{Change, Drawn, FrameReport, Outcome, Picture, Refused, Session};
use volgraph_tests::{Stage, adapters, gpu_alone, graph};
use wgpu_types::{BufferDescriptor, BufferUsages};

/// The body of a technique whose colour is `color`, an expression over the segment's `x`, after the statements `before`.
fn technique(before: &str, color: &str) -> String {
    format!(
        r#"// A technique under edit.
#import "lib/ray.wgsl"
#import "lib/volume_texture.wgsl"

struct TechniqueState {{ sum: f32, }}

fn technique_begin(ray: Ray) -> TechniqueState {{
    return TechniqueState(0.0);
}}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {{
    var x = segment.back.scalar * segment.length;
    {before}
    (*state).sum += x;
    return false;
}}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {{
    let x = state.sum;
    return RayResult(vec4f({color}), RAY_NO_DEPTH);
}}
"#
    )
}

const GOOD: (&str, &str) = ("", "x, 0.0, 0.0, 1.0");
const BETTER: (&str, &str) = ("", "0.0, x, 0.5 * x, 1.0");
const FILE: &str = "slot/technique/live.wgsl";

fn stage(stage_of_raycast: &str) -> Stage {
    let slots = r#"{ "technique": "live" }"#;
    let params = format!(r#"{{ "stage": "{stage_of_raycast}" }}"#);
    let text = graph(
        r#"path: "v_8x8x8_float32.raw""#,
        "orbit(azimuth: 10, elevation: 10)",
        "{}",
        slots,
        &params,
    );
    Stage::new()
        .with_floats("v", [8, 8, 8], |x, y, z| 0.01 * (x * y + z) as f32)
        .with("transfer.ron", "(points: [(at: 0, color: (0, 0, 1), opacity: 0), (at: 1, color: (1, 0, 0), opacity: 0.5)])")
        .with("graph.ron", text)
        .with(FILE, technique(GOOD.0, GOOD.1))
}

fn everything() -> Change {
    Change::Files(BTreeSet::new())
}

fn drawn(session: &mut Session) -> Drawn {
    match session.apply(&everything()) {
        Ok(Outcome::Drawn(drawn)) => *drawn,
        Ok(Outcome::Unchanged) => panic!("the edit makes a difference"),
        Err(refused) => panic!("{}", refused.findings),
    }
}

fn refused(session: &mut Session) -> Refused {
    match session.apply(&everything()) {
        Ok(_) => panic!("the edit must be refused"),
        Err(refused) => refused,
    }
}

/// What must be the same after a refused change.
fn state(session: &mut Session) -> (Picture, usize, usize, usize, u64) {
    let (picture, report) = session.render().unwrap();
    let FrameReport {
        memory, pipelines, ..
    } = report;
    (
        picture,
        pipelines,
        memory.textures,
        memory.buffers,
        memory.bytes,
    )
}

/// Plants an edit by `plant`, which must be refused with this code at this line of the technique (0: none in
/// particular), and takes the next good edit.
fn survives(plant: impl Fn(&Stage), mend: impl Fn(&Stage), code: &str, line: u32, raycast: &str) {
    for backend in adapters() {
        let stage = stage(raycast);
        let mut session = stage.open("graph.ron", &[], &backend, [32, 32]).unwrap();
        let before = state(&mut session);
        plant(&stage);
        let first = refused(&mut session);
        let text = first.findings.to_string();
        let found = first.findings.sorted()[0];
        assert_eq!(found.code, code, "{backend}: {text}");
        if line > 0 {
            let place = found.place.as_ref().unwrap();
            assert!(place.file.ends_with(FILE), "{backend}: {text}");
            assert_eq!(place.line, line, "{backend}: {text}");
        }
        assert!(!first.is_repeat);
        let after = state(&mut session);
        assert!(after == before, "{backend}: the state before stands");
        assert!(refused(&mut session).is_repeat, "told once");
        mend(&stage);
        let new = drawn(&mut session);
        let fresh = stage.open("graph.ron", &[], &backend, [32, 32]);
        let fresh = fresh.unwrap().render().unwrap().0;
        assert!(new.picture.color == fresh.color, "{backend}");
        assert!(new.picture.color != before.0.color, "{backend}");
    }
}

fn technique_survives(before: &str, color: &str, code: &str, line: u32) {
    for raycast in ["fragment", "compute"] {
        survives(
            |stage| stage.write(FILE, technique(before, color)),
            |stage| stage.write(FILE, technique(BETTER.0, BETTER.1)),
            code,
            line,
            raycast,
        );
    }
}

#[test]
fn an_endless_loop() {
    technique_survives(
        "while x > -1.0 { x = abs(x * 1.0001); }",
        GOOD.1,
        "endless-loop",
        13,
    );
}

#[test]
fn a_loop_of_a_thousand_million_steps() {
    technique_survives(
        "for (var i = 0; i < 1000000000; i += 1) { x += sin(x); }",
        GOOD.1,
        "endless-loop",
        13,
    );
}

/// A software driver runs eight rays at once and ends the loops of all of them when one has taken too many turns: rays
/// beside the volume, which only wait, are cut in the loop that all are in. In a picture this small they share a group.
#[test]
fn rays_that_wait_beside_an_endless_loop_do_not_blame_the_walk() {
    let before = "while x > -1.0 { x = abs(x * 1.0001); }";
    for backend in adapters() {
        for raycast in ["fragment", "compute"] {
            for size in [[8, 8], [16, 16], [24, 8]] {
                let stage = stage(raycast).with(FILE, technique(before, GOOD.1));
                let mut session = stage.open("graph.ron", &[], &backend, size).unwrap();
                let findings = session.render().unwrap_err();
                for found in findings.sorted() {
                    let place = found.place.as_ref().unwrap();
                    assert!(
                        place.file.ends_with(FILE),
                        "{backend} {raycast}: {findings}"
                    );
                }
            }
        }
    }
}

/// 200 · 400 turns in each segment: more than llvmpipe lets a shader take, which must not go unnoticed.
#[test]
fn nested_loops_that_a_driver_cuts_are_told_or_finished() {
    let before = "var t = 0.0; for (var i = 0; i < 200; i += 1) { for (var j = 0; j < 400; j += 1) { t += 1.0; } } x = t;";
    for backend in adapters() {
        let stage = stage("fragment").with(FILE, technique(before, "x, 0.0, 0.0, 1.0"));
        let mut session = stage.open("graph.ron", &[], &backend, [8, 8]).unwrap();
        match session.render() {
            Err(findings) => assert_eq!(findings.sorted()[0].code, "endless-loop"),
            Ok((picture, _)) => {
                for color in picture.color {
                    assert_eq!(color[0] % 80_000.0, 0.0, "{backend}: every turn was taken");
                }
            }
        }
    }
}

#[test]
fn a_division_by_zero() {
    technique_survives("", "1.0 / (x - x), 0.0, 0.0, 1.0", "not-finite", 0);
}

#[test]
fn colours_that_are_not_numbers() {
    technique_survives("", "sqrt(-1.0 - x), 0.0, 0.0, 1.0", "not-finite", 0);
}

#[test]
fn a_load_from_outside_of_a_texture() {
    technique_survives(
        "x += textureLoad(volume_texture, vec3i(8, 0, 0), 0).x;",
        GOOD.1,
        "out-of-range-load",
        13,
    );
}

#[test]
fn a_pipeline_that_the_driver_refuses() {
    let node = "node/raycast.wgsl";
    let raycast =
        std::fs::read_to_string(volgraph_tests::root().join("shaders").join(node)).unwrap();
    let huge = raycast.replace("@workgroup_size(8, 8, 1)", "@workgroup_size(4096, 8, 1)");
    assert_ne!(raycast, huge);
    survives(
        |stage| stage.write(node, &huge),
        |stage| {
            stage.write(node, &raycast);
            stage.write(FILE, technique(BETTER.0, BETTER.1));
        },
        "device",
        0,
        "compute",
    );
}

#[test]
fn a_lost_device() {
    for backend in adapters() {
        let stage = stage("fragment");
        let mut session = stage.open_alone("graph.ron", &backend, [32, 32]).unwrap();
        let before = state(&mut session);
        session.lose_device();
        let after = state(&mut session);
        assert!(after == before, "{backend}: drawn again on a new device");
        let reason = session.take_device_remade();
        assert!(reason.is_some(), "{backend}");

        session.lose_device();
        stage.write(FILE, technique(BETTER.0, BETTER.1));
        let new = drawn(&mut session);
        assert!(new.report.device_remade.is_some(), "{backend}");
        let fresh = stage.open("graph.ron", &[], &backend, [32, 32]);
        let fresh = fresh.unwrap().render().unwrap().0;
        assert!(new.picture.color == fresh.color, "{backend}");

        session.lose_device();
        stage.write(FILE, technique("x = ;", GOOD.1));
        let refused = refused(&mut session);
        assert!(refused.device_remade.is_some(), "{backend}");
        assert_eq!(refused.findings.sorted()[0].code, "wgsl-syntax");
        let (picture, _) = session.render().unwrap();
        assert!(picture.color == new.picture.color, "{backend}");
    }
}

/// Nobody else asks a device that draws nothing any more: the loss must be known when `destroy` returns.
#[test]
fn a_device_lost_at_work_is_known_at_once() {
    for backend in adapters() {
        let gpu = gpu_alone(&backend);
        let shared = gpu.shared();
        let buffer = shared.device.create_buffer(&BufferDescriptor {
            label: None,
            size: 128 << 20,
            usage: BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut work = shared.device.create_command_encoder(&Default::default());
        for _ in 0..16 {
            work.clear_buffer(&buffer, 0, None);
        }
        shared.queue.submit([work.finish()]);
        gpu.destroy();
        assert!(gpu.lost().is_some(), "{backend}");
    }
}
