//! Budgets: what is chosen keeps the error, comes nearest where nothing does, holds what is set by name, and is chosen once.

use std::path::Path;

use volgraph::{Change, Outcome, Scene, Session, SessionOptions, Truth, TruthOptions};
use volgraph_graph::{Budget, CameraDesc, read};
use volgraph_tests::repository::choices;
use volgraph_tests::{Stage, adapters, options, root};

use crate::quadratures::declared;

const SIZE: [u32; 2] = [64, 64];

fn graph(quality: &str) -> String {
    format!(
        r#"(
    sources: {{
        "volume": analytic(field: "gyroid", dims: (24, 24, 24)),
        "colors": transfer(path: "transfer.ron"),
    }},
    camera: orbit(azimuth: 30, elevation: 20),
    {quality}
    nodes: {{
        "box":   (kind: "proxy_box", in: {{ "volume": "volume" }}),
        "image": (kind: "raycast", in: {{ "volume": "volume", "transfer": "colors", "rays": "box" }}),
    }},
    outputs: {{ "color": "image.color" }},
)"#
    )
}

const SMOOTH: &str = "(domain: normalised, color: [(0, (1, 0.2, 0)), (1, (0, 0.5, 1))], extinction: [(0, 0), (1, 0.3)])";

/// A peak that a step of a voxel passes by.
const PEAK: &str = "(domain: normalised, color: (1, 0.7, 0.3), opacity: [(0, 0), (0.595, 0), (0.6, 0.9), (0.605, 0), (1, 0)])";

fn stage(quality: &str, transfer: &str) -> Stage {
    Stage::new()
        .with("graph.ron", graph(quality))
        .with("transfer.ron", transfer)
}

fn session(stage: &Stage, sets: &[&str], backend: &str) -> Session {
    let options = SessionOptions {
        cache: Some(stage.path().join("cache")),
        ..options(sets, backend, SIZE)
    };
    Session::open(stage.path().join("graph.ron"), &options)
        .unwrap_or_else(|findings| panic!("{backend}: {findings}"))
}

/// The root mean square error of the session's picture against the whole truth.
fn rmse(session: &mut Session) -> f64 {
    let (picture, _) = session.render().unwrap();
    let truth = TruthOptions {
        tolerance: 1e-6,
        cache: None,
    };
    let silent = volgraph_reference::Silent;
    let truth = Truth::of(session.plan(), session.view(), &truth, &silent).unwrap();
    truth.compare(&picture).unwrap().rmse
}

fn camera(text: &str) -> CameraDesc {
    read::camera_text(Path::new("camera"), text).unwrap()
}

fn classify(session: &Session) -> String {
    session.chosen().unwrap().method.text("classify")
}

#[test]
fn an_error_budget_is_kept_from_all_sides_by_a_method_that_fits_the_transfer_function() {
    for backend in adapters() {
        for (transfer, rmse_budget) in [(SMOOTH, 0.002), (PEAK, 0.004)] {
            let stage = stage(&format!("quality: budget(rmse: {rmse_budget}),"), transfer);
            let mut session = session(&stage, &[], &backend);
            let chosen = session.chosen().unwrap().clone();
            assert!(chosen.is_met, "{backend}: {chosen}");
            assert!(chosen.predicted_rmse <= rmse_budget, "{chosen}");
            for view in [
                "orbit(azimuth: 30, elevation: 20)",
                "orbit(azimuth: 100, elevation: -30)",
                "orbit(azimuth: 250, elevation: 70)",
            ] {
                session.set_camera(&camera(view));
                let rmse = rmse(&mut session);
                assert!(rmse <= rmse_budget, "{backend}, {view}: {rmse:e}, {chosen}");
            }
            // Where nothing is narrow, longer steps than the graph's own are enough; samples pass peaks by.
            let is_sampled = ["post", "gauss2", "simpson"].contains(&&*classify(&session));
            if transfer == PEAK {
                assert!(!is_sampled, "{backend}: {chosen}");
            } else {
                let step: f64 = chosen.method.text("step").parse().unwrap();
                assert!(step > 1.0, "{backend}: {chosen}");
            }
        }
    }
}

/// What is chosen for an error that nothing keeps, with the step held: the most accurate way to classify.
fn most_accurate(stage: &Stage, step: &str, backend: &str) -> String {
    let step = format!("image.step={step}");
    let session = session(stage, &[&step, "image.early_termination=0"], backend);
    assert!(!session.chosen().unwrap().is_met);
    classify(&session)
}

#[test]
fn narrow_peaks_of_several_colours_get_a_table_of_segments() {
    // Samples miss peaks that are narrower than a step, and the integral from scalar to scalar loses which colour comes
    // first. What is left is known by the scalars of both ends.
    let peaks = "(domain: normalised, color: [(0.4, (1, 0, 0)), (0.6, (0, 0.2, 1))],
        opacity: [(0.395, 0), (0.4, 0.9), (0.405, 0), (0.595, 0), (0.6, 0.9), (0.605, 0)])";
    let stage = stage("quality: budget(rmse: 0.000001),", peaks);
    for backend in adapters() {
        let chosen = most_accurate(&stage, "2", &backend);
        let tables = ["preintegrated_2d", "preintegrated_3d", "second_order"];
        assert!(tables.contains(&&*chosen), "{backend}: {chosen}");
    }
}

#[test]
fn smooth_matter_gets_the_highest_order() {
    // One cell of a volume, whose scalar is a cubic along every ray, and a transfer function that is linear: at a quarter
    // of the cell errors of order 4 are far below those of order 2.
    let transfer = "(domain: data, color: [(0, (1, 0.1, 0)), (1, (0.1, 0.8, 1))], extinction: [(0, 0), (1, 6)])";
    let corners = [0.15, 0.7, 0.55, 0.25, 0.85, 0.4, 0.3, 0.95];
    let analytic = r#"analytic(field: "gyroid", dims: (24, 24, 24))"#;
    let cell = r#"volume(path: "v_2x2x2_float32.raw", node_centred: true)"#;
    let text = graph("quality: budget(rmse: 0.000001),").replace(analytic, cell);
    let stage = Stage::new()
        .with_floats("v", [2, 2, 2], |x, y, z| {
            corners[(x + 2 * y + 4 * z) as usize]
        })
        .with("transfer.ron", transfer)
        .with("graph.ron", text);
    let highest = choices("classify")
        .iter()
        .map(|it| declared(it))
        .fold(0.0, f64::max);
    for backend in adapters() {
        let chosen = most_accurate(&stage, "0.25", &backend);
        assert_eq!(declared(&chosen), highest, "{backend}: {chosen}");
    }
}

#[test]
fn what_is_set_by_name_is_held() {
    let backend = &adapters()[0];
    let stage = stage("quality: budget(rmse: 0.01),", SMOOTH);
    let session_with = |sets: &[&str]| session(&stage, sets, backend);
    let held = session_with(&["image.step=0.7", "image.slots.classify=simpson"]);
    let chosen = held.chosen().unwrap();
    assert_eq!(chosen.method.text("step"), "", "{chosen}");
    assert_eq!(chosen.method.text("classify"), "", "{chosen}");
    let everything = [
        "image.step=0.7",
        "image.slots.classify=simpson",
        "image.volume_storage=r16float",
    ];
    assert_eq!(session_with(&everything).chosen(), None);
    // A picture as it is written asks for nothing.
    let as_written = SessionOptions {
        is_as_written: true,
        ..options(&[], backend, SIZE)
    };
    let plain = Session::open(stage.path().join("graph.ron"), &as_written).unwrap();
    assert_eq!(plain.chosen(), None);
}

#[test]
fn budgets_that_nothing_keeps_get_what_is_nearest() {
    let backend = &adapters()[0];
    let stage = stage("quality: budget(rmse: 0.000001),", PEAK);
    let chosen = session(&stage, &[], backend).chosen().unwrap().clone();
    assert!(!chosen.is_met && chosen.predicted_rmse < 0.01, "{chosen}");
    stage.write("graph.ron", graph("quality: budget(time_ms: 0.001),"));
    let chosen = session(&stage, &[], backend).chosen().unwrap().clone();
    assert!(!chosen.is_met, "{chosen}");
    // No end of time buys accuracy.
    stage.write("graph.ron", graph("quality: budget(time_ms: 1000000),"));
    let chosen = session(&stage, &[], backend).chosen().unwrap().clone();
    assert!(chosen.is_met && chosen.predicted_rmse < 1e-3, "{chosen}");
}

#[test]
fn the_picture_itself_is_asked_before_a_promise() {
    // Thin shells seen from this side have twice the error of the small views, and no step of these tables mends it.
    let graph = std::fs::read_to_string(root().join("graphs/gyroid.ron")).unwrap();
    let transfer = std::fs::read_to_string(root().join("graphs/transfer/gyroid.ron")).unwrap();
    let graph = graph
        .replace("azimuth: 35, elevation: 25", "azimuth: 220, elevation: 50")
        .replace(
            "    nodes:",
            "    quality: budget(rmse: 0.002),\n    nodes:",
        );
    let stage = Stage::new()
        .with("transfer/gyroid.ron", transfer)
        .with("graph.ron", graph);
    let sets = ["image.slots.classify=second_order"];
    let options = options(&sets, &adapters()[0], [128, 128]);
    let mut session = Session::open(stage.path().join("graph.ron"), &options).unwrap();
    let chosen = session.chosen().unwrap().clone();
    let rmse = rmse(&mut session);
    assert_eq!(chosen.is_met, rmse <= 0.002, "{rmse:e}, {chosen}");
    assert!(chosen.predicted_rmse > 0.95 * rmse, "{rmse:e}, {chosen}");
}

#[test]
fn a_choice_is_made_once_and_stays_while_people_edit() {
    let backend = &adapters()[0];
    let stage = stage("quality: budget(rmse: 0.002),", SMOOTH);
    let mut session = session(&stage, &[], backend);
    let first = session.chosen().unwrap().clone();
    assert!(!first.is_kept);
    let mut other = self::session(&stage, &[], backend);
    let again = other.chosen().unwrap().clone();
    assert!(again.is_kept);
    assert_eq!(again.method, first.method);

    // What is set by name later holds, and is told: the picture is no longer the one that was predicted.
    let step = volgraph::ParamOverride::parse("image.step=0.25").unwrap();
    let set = other.apply(&Change::Set(vec![step]));
    assert!(matches!(set, Ok(Outcome::Drawn(_))));
    let overruled = other.chosen().unwrap();
    assert_eq!(overruled.overruled, ["step"], "{overruled}");
    assert!(
        !overruled.to_string().contains("predicted rmse"),
        "{overruled}"
    );

    let edited = |session: &mut Session, file: &str, text: String| {
        stage.write(file, text);
        let path = stage.path().join(file);
        match session.apply(&Change::Files([path].into())) {
            Ok(Outcome::Drawn(_)) => session.chosen().cloned(),
            other => panic!("{other:?}"),
        }
    };
    // Another transfer function may ask for another method, but not while it is edited.
    let stays = edited(&mut session, "transfer.ron", PEAK.to_owned());
    assert_eq!(stays.unwrap().method, first.method);
    let looser = edited(
        &mut session,
        "graph.ron",
        graph("quality: budget(rmse: 0.02),"),
    );
    assert_eq!(looser.unwrap().budget, Budget::Rmse(0.02));
    let none = edited(&mut session, "graph.ron", graph(""));
    assert_eq!(none, None);
    // Without a budget the picture is that of the graph as it stands.
    let plain = Scene::load(
        &stage.path().join("graph.ron"),
        &Default::default(),
        &Default::default(),
        volgraph::registry(),
        &volgraph::NoProgress,
    )
    .unwrap();
    assert_eq!(session.scene().overrides.params, plain.overrides.params);
}

#[test]
fn an_edit_that_the_chosen_renderer_does_not_draw_gets_another() {
    // The software raycaster has no depth, and draws no lights.
    for backend in adapters() {
        let stage = stage("quality: budget(rmse: 0.01),", SMOOTH);
        drop(session(&stage, &[], &backend));
        // As it is kept where the software raycaster is the fastest, which changes from machine to machine.
        for kept in std::fs::read_dir(stage.path().join("cache/quality")).unwrap() {
            let kept = kept.unwrap().path();
            let method = r#"{"method":[{"name":"renderer","is_slot":false,"value":{"text":"software"}}],
                "rmse":0.001,"ms":1.0,"is_met":true,"is_reference":true,"tried":1}"#;
            std::fs::write(kept, method).unwrap();
        }
        let mut session = session(&stage, &[], &backend);
        assert!(session.chosen().unwrap().method.is_software(), "{backend}");
        let text = graph("quality: budget(rmse: 0.01),");
        let edits = [
            text.replace(
                r#"{ "color": "image.color" }"#,
                r#"{ "color": "image.color", "depth": "image.depth" }"#,
            ),
            text.replace(
                r#""rays": "box" }"#,
                r#""rays": "box" }, slots: { "light": "phong" }"#,
            ),
            text,
        ];
        for edited in edits {
            stage.write("graph.ron", &edited);
            let path = stage.path().join("graph.ron");
            match session.apply(&Change::Files([path].into())) {
                Ok(Outcome::Drawn(_)) => {}
                other => panic!("{backend}: {other:?} of {edited}"),
            }
            let own = graph("quality: budget(rmse: 0.01),");
            let chosen = session.chosen().unwrap();
            assert!(edited == own || !chosen.method.is_software(), "{chosen}");
        }
    }
}

#[test]
fn no_step_is_tried_that_is_too_short_for_the_longest_ray() {
    // A cube's diagonal, of more than 7000 of the smallest voxels: a step of a sixteenth were too many segments for a walk.
    let text = graph("quality: budget(rmse: 0.000001),").replace("(24, 24, 24)", "(2, 2, 4096)");
    let stage = stage("", PEAK).with("graph.ron", text);
    let options = SessionOptions {
        cache: Some(stage.path().join("cache")),
        ..options(&[], &adapters()[0], [8, 8])
    };
    let session = Session::open(stage.path().join("graph.ron"), &options);
    let session = session.unwrap_or_else(|findings| panic!("{findings}"));
    let chosen = session.chosen().unwrap();
    assert!(!chosen.is_met, "{chosen}");
}
