//! Projections and isosurfaces of the software raycaster: what a raycast draws on a device, and what the reference computes.

use std::collections::BTreeMap;

use volgraph::registry;
use volgraph_measure::compare_without_flip;
use volgraph_shader::{ParamSpec, ParamType};
use volgraph_tests::truth::truth;
use volgraph_tests::{Stage, adapters, graph, render};

const SIZE: [u32; 2] = [61, 47];

const CAMERAS: [&str; 3] = [
    "orbit(azimuth: 33, elevation: 21, fov_y: 40)",
    "orbit(azimuth: -50, elevation: 15, projection: orthographic)",
    // Inside of the box.
    "look_at(eye: (10.2, 9.1, 12.4), target: (20.0, 12.0, 9.0), fov_y: 70)",
];

const SOFTWARE: &str = "image.renderer=software";

/// 8-bit voxels of sides of different lengths.
fn stage(camera: &str, technique: &str, light: &str) -> Stage {
    const DIMS: [u32; 3] = [30, 26, 14];
    let places = (0..DIMS[2]).flat_map(|z| {
        (0..DIMS[1]).flat_map(move |y| (0..DIMS[0]).map(move |x| [x, y, z].map(f64::from)))
    });
    let wave = |[x, y, z]: [f64; 3]| {
        let value = (0.45 * x).sin() + (0.5 * y + 0.1 * x).cos() + (0.8 * z - 0.2 * y).sin();
        128.0 + 40.0 * value
    };
    let voxels: Vec<u8> = places.map(|at| wave(at) as u8).collect();
    let slots = format!(r#"{{ "technique": "{technique}", "light": "{light}" }}"#);
    // All that they share, none of it by default.
    let surface = r#""step": 0.7, "isovalue": 150, "isovalue_unit": "data", "surface_color": [0.3, 0.6, 0.9]"#;
    let window = r#""step": 0.7, "window_low": 0.1, "window_high": 0.8, "window_unit": "normalised", "window_color": [1.0, 0.7, 0.4]"#;
    let lights = r#", "lights": 3, "light_1": [0.3, 0.5, 1.0, 0.0], "light_1_color": [0.8, 0.7, 0.6],
        "light_2_color": [0.2, 0.3, 0.4], "light_3": [1.5, 2.0, -1.0, 1.0], "ambient": 0.2, "diffuse": 0.6,
        "specular": 0.4, "shininess": 12.5"#;
    let params = match (technique, light) {
        ("isosurface", "unlit") => format!("{{ {surface} }}"),
        ("isosurface", _) => format!("{{ {surface}{lights} }}"),
        _ => format!("{{ {window} }}"),
    };
    let volume = r#"path: "v_30x26x14_uint8.raw", spacing: (1.0, 0.9, 1.7)"#;
    let text = graph(volume, camera, "{}", &slots, &params);
    Stage::new()
        .with("v_30x26x14_uint8.raw", voxels)
        .with("transfer.ron", "(points: [(at: 0, color: (1, 1, 1), opacity: 0), (at: 1, color: (1, 1, 1), opacity: 1)])")
        .with("graph.ron", text)
}

/// Root mean square differences of the software raycaster's picture from the device's and from the reference's.
fn differences(stage: &Stage, sets: &[&str]) -> [f64; 2] {
    let software = [&[SOFTWARE][..], sets].concat();
    let backend = &adapters()[0];
    let (drawn, _) = render(stage, &software, backend, SIZE);
    let (device, _) = render(stage, sets, backend, SIZE);
    assert!(drawn.color.iter().any(|pixel| pixel[0] > 0.1), "{sets:?}");
    let of_device = compare_without_flip(&device, &drawn).unwrap().rmse;
    // The reference reads the node of the software raycaster itself.
    let (truth, _) = truth(stage, &software, SIZE);
    [of_device, truth.compare(&drawn).unwrap().rmse]
}

#[test]
fn projections_are_those_of_the_device_and_the_reference() {
    for camera in CAMERAS {
        for technique in ["mip", "minip"] {
            let stage = stage(camera, technique, "unlit");
            let [device, truth] = differences(&stage, &["image.extremum=field"]);
            assert!(
                device < 1e-5 && truth < 1e-5,
                "{camera} {technique}: {device:e} {truth:e}"
            );
            let [device, truth] = differences(&stage, &["image.extremum=samples"]);
            // Samples are the same; between them is more.
            assert!(
                device < 1e-5 && truth > 1e-4,
                "{camera} {technique}: {device:e} {truth:e}"
            );
        }
    }
}

#[test]
fn isosurfaces_are_those_of_the_device_and_the_reference() {
    for camera in CAMERAS {
        for (light, sets) in [
            ("unlit", &[][..]),
            ("phong", &[]),
            ("phong", &["image.solid=below", "image.space=world"]),
            ("phong_ends", &["image.cut_faces=open", "image.lights=1"]),
        ] {
            let stage = stage(camera, "isosurface", light);
            let [device, truth] = differences(&stage, sets);
            // The device keeps gradients in half floats: 1e-3 of each component.
            assert!(
                device < 1e-3 && truth < 2e-4,
                "{camera} {light} {sets:?}: {device:e} {truth:e}"
            );
            let linear = [sets, &["image.refinement=linear"]].concat();
            let [device, truth] = differences(&stage, &linear);
            assert!(
                device < 1e-3,
                "{camera} {light} {linear:?}: {device:e} {truth:e}"
            );
        }
    }
}

#[test]
fn shared_parameters_are_those_of_the_shaders() {
    let specs = |kind: &str| -> BTreeMap<String, ParamSpec> {
        let registry = registry();
        let specs = registry.node(kind).unwrap().params();
        let specs = specs.into_iter();
        specs.map(|spec| (spec.name.clone(), spec)).collect()
    };
    let own = specs("software_raycast");
    let of_the_device = |technique: &str, light: &str| -> Vec<ParamSpec> {
        let stage = stage(CAMERAS[0], technique, light);
        let session = stage
            .open("graph.ron", &[], &adapters()[0], [8, 8])
            .unwrap();
        let graph = &session.plan().graph;
        let node = graph.nodes.iter().find(|node| node.name == "image");
        node.unwrap().specs()
    };
    let mut shared = 0;
    for (technique, light) in [("isosurface", "phong"), ("mip", "unlit")] {
        for theirs in of_the_device(technique, light) {
            let Some(own) = own.get(&theirs.name) else {
                continue;
            };
            if let (ParamType::Choice(own), ParamType::Choice(theirs)) = (&own.ty, &theirs.ty) {
                assert!(own.iter().all(|choice| theirs.contains(choice)), "{own:?}");
            } else {
                assert_eq!(own.ty, theirs.ty, "{}", own.name);
            }
            assert_eq!(own.unit, theirs.unit, "{}", own.name);
            assert_eq!(own.is_color, theirs.is_color, "{}", own.name);
            if !["table_size", "step"].contains(&own.name.as_str()) {
                assert_eq!(own.default, theirs.default, "{}", own.name);
                assert_eq!(own.range, theirs.range, "{}", own.name);
            }
            shared += 1;
        }
    }
    assert!(shared > 25, "{shared}");
}

#[test]
fn emission_and_absorption_need_a_transfer_function() {
    let text = r#"(
    sources: { "volume": analytic(field: "c60", dims: (16, 16, 16)) },
    camera: orbit(azimuth: 33, elevation: 21),
    nodes: { "image": (kind: "software_raycast", in: { "volume": "volume" }) },
    outputs: { "color": "image.color" },
)"#;
    let stage = Stage::new().with("graph.ron", text);
    let open = |sets: &[&str]| stage.open("graph.ron", sets, &adapters()[0], [8, 8]);
    let findings = open(&[]).err().unwrap();
    assert!(findings.to_string().contains("`transfer`"), "{findings}");
    assert!(open(&["image.technique=mip"]).is_ok());
}
