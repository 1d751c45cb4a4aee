//! Materials over the scalar, and light that changes along a segment: against quadrature in float64 and fine steps.

use std::path::Path;

use glam::DVec3;
use naga::valid::Capabilities;
use volgraph::{
    Limits, NoProgress, Overrides, ParamOverride, Picture, Scene, ShaderFolders, View, registry,
};
use volgraph_measure::compare_without_flip;
use volgraph_optics::{Material, TransferFunction};
use volgraph_tests::slabs::{middles, slabs};
use volgraph_tests::{STAGES, Stage, adapters, graph, ray, render};

fn max_error(a: &Picture, b: &Picture) -> f64 {
    compare_without_flip(a, b).unwrap().max.error
}

/// A volume of bumps, with the material in the transfer function or without.
fn bumps(material: &str) -> Stage {
    Stage::new()
        .with_floats("v", [12, 11, 10], |x, y, z| {
            let [x, y, z] = [x, y, z].map(|i| f64::from(i) * 0.7);
            (0.5 + 0.25 * x.sin() * y.cos() + 0.2 * (z + 0.5 * x).sin()) as f32
        })
        .with(
            "transfer.ron",
            format!(
                "(domain: data(from: 0, to: 1), color: [(0, (1, 0, 0)), (0.6, (0, 1, 0.5))],
                opacity: [(0.3, 0), (0.5, 0.5), (0.6, 0), (0.8, 0.3)]{material})"
            ),
        )
        .with(
            "graph.ron",
            graph(
                r#"path: "v_12x11x10_float32.raw""#,
                "orbit(azimuth: 33, elevation: 21, fov_y: 40)",
                "{}",
                r#"{ "classify": "preintegrated_2d" }"#,
                r#"{ "step": 0.7, "ambient": 0.2, "diffuse": 0.6, "specular": 0.4, "shininess": 20 }"#,
            ),
        )
}

#[test]
fn constant_fractions_are_the_uniform_material() {
    let silent = bumps("");
    let stated = bumps(
        ", material: [(at: 0.1, ambient: 0.2, diffuse: 0.6, specular: 0.4, shininess: 20), (at: 0.7, ambient: 0.2)]",
    );
    let other = bumps(", material: [(at: 0.1, specular: 0.41)]");
    for (backend, form) in adapters().iter().zip(STAGES) {
        for light in ["phong", "phong_ends"] {
            let picture = |stage: &Stage, material: &str| {
                let sets = [
                    format!("image.stage={form}"),
                    format!("image.slots.light={light}"),
                    format!("image.slots.material={material}"),
                ];
                render(
                    stage,
                    &sets.each_ref().map(String::as_str),
                    backend,
                    [40, 40],
                )
                .0
            };
            let uniform = picture(&silent, "uniform");
            for material in ["transfer", "preintegrated"] {
                for stage in [&silent, &stated] {
                    let error = max_error(&uniform, &picture(stage, material));
                    println!("{backend} {light} {material}: {error:.1e}");
                    assert!(error <= 1e-5, "{backend} {light} {material}: {error}");
                }
                let error = max_error(&uniform, &picture(&other, material));
                assert!(
                    error > 1e-5,
                    "{backend} {light} {material}: a hundredth is not seen"
                );
            }
        }
    }
}

/// A layer that is matt, one that shines and one that glows, between a ramp of colours.
const LAYERS: &str = "(domain: data(from: 0, to: 1),
    color: [(0, (1, 0.2, 0)), (0.5, (0.2, 1, 0.4)), (1, (0, 0.3, 1))],
    extinction: [(0.05, 0), (0.2, 0.5), (0.35, 0.02), (0.55, 0.6), (0.7, 0), (0.85, 0.4), (0.95, 0.1)],
    material: [(at: 0.2, ambient: 0, diffuse: 0.9, specular: 0), (at: 0.4, diffuse: 0.1),
               (at: 0.55, ambient: 0.1, specular: 0.9), (at: 0.7, specular: 0.1, diffuse: 0.3),
               (at: 0.85, ambient: 1, specular: 0.4)])";

const LIGHT: DVec3 = DVec3::new(0.6, 0.64, 0.48);

/// The rendering integral along the whole of a linear field from `front` to `back`, 8 voxels long.
fn linear_truth(transfer: &TransferFunction, (front, back): (f64, f64), direction: DVec3) -> DVec3 {
    const SLABS: u32 = 40_000;
    let default = Material {
        ambient: 0.3,
        diffuse: 0.7,
        specular: 0.25,
        shininess: 12.0,
    };
    let normal = DVec3::new(-direction.x.signum(), 0.0, 0.0);
    let light = DVec3::new(LIGHT.x * normal.x, LIGHT.y, LIGHT.z);
    let diffuse = normal.dot(light);
    let highlight = normal
        .dot((light - direction).normalize())
        .powf(default.shininess);
    let length = 8.0 / f64::from(SLABS);
    let [r, g, b, _] = slabs(middles(SLABS).map(|share| {
        let s = front + share * (back - front);
        let made = transfer.material(s, default);
        let own = DVec3::from_array(transfer.color(s));
        let shown = own * (made.ambient + made.diffuse * diffuse) + made.specular * highlight;
        (shown.to_array(), transfer.extinction(s) * length)
    }));
    DVec3::new(r, g, b)
}

#[test]
fn a_material_that_changes_within_a_step_is_exact_for_a_linear_field() {
    // Looking along the field's axis, segments are whole ones and scalars linear in them: what is left is the bound of
    // the tables.
    const BOUND: f64 = 1e-5;
    let transfer = TransferFunction::parse(Path::new("layers.ron"), LAYERS).unwrap();
    for (backend, form) in adapters().iter().zip(STAGES) {
        for (eye, ends) in [(-20.0, (0.0, 1.0)), (28.0, (1.0, 0.0))] {
            let light_x = if eye < 0.0 { -LIGHT.x } else { LIGHT.x };
            let camera = format!(
                "look_at(eye: ({eye:?}, 3, 3.5), target: (4, 3, 3.5), up: (0, 0, 1), projection: orthographic, height: 4)"
            );
            let params = format!(
                r#"{{ "early_termination": 0.0, "ambient": 0.3, "diffuse": 0.7, "specular": 0.25, "shininess": 12,
                    "light_1": [{light_x:?}, {}, {}, 0] }}"#,
                LIGHT.y, LIGHT.z
            );
            let slots = r#"{ "classify": "preintegrated_2d" }"#;
            let stage = Stage::new()
                .with_floats("v", [9, 7, 8], |x, _, _| x as f32 / 8.0)
                .with("transfer.ron", LAYERS)
                .with(
                    "graph.ron",
                    graph(
                        r#"path: "v_9x7x8_float32.raw", node_centred: true"#,
                        &camera,
                        "{}",
                        slots,
                        &params,
                    ),
                );
            let error = |material: &str, light: &str, step: &str| {
                let sets = [
                    format!("image.stage={form}"),
                    format!("image.slots.material={material}"),
                    format!("image.slots.light={light}"),
                    format!("image.step={step}"),
                ];
                let sets = sets.each_ref().map(String::as_str);
                let (picture, view) = render(&stage, &sets, backend, [8, 8]);
                let direction = ray(&view, 4, 4).1;
                let truth = linear_truth(&transfer, ends, direction);
                let pixel = picture.color[4 * 8 + 4];
                (0..3)
                    .map(|i| (f64::from(pixel[i]) - truth[i]).abs())
                    .fold(0.0, f64::max)
            };
            for step in ["1", "4"] {
                for light in ["phong", "phong_ends"] {
                    let error = error("preintegrated", light, step);
                    println!("{backend} from {eye}, {light}, step {step}: {error:.1e}");
                    assert!(
                        error <= BOUND,
                        "{backend} from {eye}, {light}, step {step}: {error}"
                    );
                }
            }
            // The test sees a material of the segment's middle, and one that is the same everywhere.
            assert!(error("transfer", "phong", "4") > 10.0 * BOUND);
            assert!(error("uniform", "phong", "1") > 10.0 * BOUND);
        }
    }
}

/// Distance from the middle of a cube of 32 voxels: gradients turn along every ray. An
/// opaque shell of a third of a voxel.
fn shell() -> Stage {
    Stage::new()
        .with_floats("v", [33, 33, 33], |x, y, z| {
            let [x, y, z] = [x, y, z].map(|i| f64::from(i) - 16.0);
            (x * x + y * y + z * z).sqrt() as f32
        })
        .with(
            "transfer.ron",
            "(domain: data(from: 0, to: 28), color: (1, 0.8, 0.5),
             extinction: [(11.85, 0), (12, 100), (12.15, 0)])",
        )
        .with(
            "graph.ron",
            graph(
                r#"path: "v_33x33x33_float32.raw", node_centred: true"#,
                "look_at(eye: (60, -40, 40), target: (16, 16, 16), fov_y: 16)",
                "{}",
                r#"{ "classify": "preintegrated_2d", "light": "phong", "gradient": "central" }"#,
                r#"{ "early_termination": 0.0, "ambient": 0.1, "diffuse": 0.9, "specular": 0.3, "shininess": 8,
                     "preintegration_size": 2048, "light_1": [0.3, -0.8, 0.5, 0] }"#,
            ),
        )
}

/// Root mean square of the light's error, over the pixels whose ray passes the middle at less than 0.8 of the shell's
/// radius: rays along the shell meet it in one step or do not. The light is the colour shown to the colour that the
/// shell has of its own, so that how exactly the shell is met, which is classification's, does not count.
fn light_error(
    (picture, view): &(Picture, View),
    bare: &Picture,
    truth: &Picture,
    true_bare: &Picture,
) -> f64 {
    let mut squares = Vec::new();
    for (at, pixel) in (0..).zip(&picture.color) {
        let (eye, direction) = ray(view, at % view.size[0], at / view.size[0]);
        let to_middle = DVec3::splat(16.0) - eye;
        let passed = (to_middle - direction * to_middle.dot(direction)).length();
        if passed > 0.8 * 12.0 {
            continue;
        }
        let [own, true_own] = [bare, true_bare].map(|bare| f64::from(bare.color[at as usize][0]));
        let light = f64::from(pixel[0]) / own;
        let true_light = f64::from(truth.color[at as usize][0]) / true_own;
        squares.push((light - true_light).powi(2));
    }
    assert!(
        squares.len() > 100,
        "the shell is seen in {} pixels",
        squares.len()
    );
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// Slope of the errors over the steps 4, 2, 1, both in powers of two (least squares).
fn order(errors: [f64; 3]) -> f64 {
    0.5 * (errors[0] / errors[2]).log2()
}

#[test]
fn light_at_both_ends_leaves_no_rings() {
    // The light of the centre is wrong by as much as it changes from the centre to the shell: order 1. Linear between
    // the ends it is wrong by its second derivative, and by how far the field is from linear: order 2, less where a
    // segment crosses faces of voxels, at which the trilinear field has a kink.
    let stage = shell();
    let mut truth: Option<[Picture; 2]> = None;
    for (backend, form) in adapters().iter().zip(STAGES) {
        let picture = |light: &str, step: f64| {
            let step = format!("image.step={step}");
            let form = format!("image.stage={form}");
            let light = format!("image.slots.light={light}");
            render(&stage, &[&form, &light, &step], backend, [24, 24])
        };
        // All of the colour needs no light: how bright the shell itself is.
        let bare = |step: f64| {
            let step = format!("image.step={step}");
            let form = format!("image.stage={form}");
            let sets = [
                "image.ambient=1",
                "image.diffuse=0",
                "image.specular=0",
                &form,
                &step,
            ];
            render(&stage, &sets, backend, [24, 24]).0
        };
        let fine = 1.0 / 16.0;
        let [truth, true_bare] =
            truth.get_or_insert_with(|| [picture("phong_ends", fine).0, bare(fine)]);
        let steps = [4.0, 2.0, 1.0];
        let bares = steps.map(bare);
        let errors = |light: &str| {
            let pictures = steps.map(|step| picture(light, step));
            std::array::from_fn(|i| light_error(&pictures[i], &bares[i], truth, true_bare))
        };
        let [centre, ends]: [[f64; 3]; 2] = ["phong", "phong_ends"].map(errors);
        println!("{backend}: phong {centre:?}, phong_ends {ends:?}");
        assert!(
            ends[0] < centre[0] / 3.0 && ends[1] < centre[1] / 5.0,
            "{centre:?} {ends:?}"
        );
        assert!(order(ends) > order(centre).max(1.4), "{centre:?} {ends:?}");
        // Another method comes to the same light.
        if form == STAGES[0] {
            let agreed = light_error(&picture("phong", fine), true_bare, truth, true_bare);
            assert!(agreed < 1e-3, "{backend}: {agreed}");
        }
    }
}

#[test]
fn the_light_that_is_kept_is_the_one_at_the_front_end() {
    // Layers with nothing between them, so that lit segments follow both lit and empty ones; matter up to the box, so
    // that rays begin lit; a sharpness that changes from segment to segment.
    let material = ", material: [(at: 0.3, shininess: 4), (at: 0.7, shininess: 40)]";
    let light = volgraph_tests::root().join("shaders/slot/light/phong_ends.wgsl");
    let light = std::fs::read_to_string(light).unwrap();
    let anew = light.replace("if !is_here || distance == 0.0", "if true");
    let stale = light.replace("if !is_here || distance == 0.0", "if kept.at < 0.0");
    assert!(anew != light && stale != light);
    let stage = bumps(material)
        .with("slot/light/anew.wgsl", anew)
        .with("slot/light/stale.wgsl", stale);
    for (backend, form) in adapters().iter().zip(STAGES) {
        for material in ["uniform", "preintegrated"] {
            let picture = |light: &str| {
                let sets = [
                    format!("image.stage={form}"),
                    format!("image.slots.light={light}"),
                    format!("image.slots.material={material}"),
                    "image.light_1=[3, -4, 6, 1]".to_owned(),
                ];
                let sets = sets.each_ref().map(String::as_str);
                render(&stage, &sets, backend, [40, 40]).0
            };
            let truth = picture("anew");
            let error = max_error(&picture("phong_ends"), &truth);
            println!("{backend} {material}: kept light is off by {error:.1e}");
            // Distances along the ray are rounded in another order.
            assert!(error < 1e-5, "{backend} {material}: {error}");
            let stale = max_error(&picture("stale"), &truth);
            assert!(stale > 1e-3, "{backend} {material}: {stale} of stale light");
        }
    }
}

/// Names of the nodes of the plan of a lit graph with these slots.
fn planned(slots: &str) -> Vec<String> {
    let stage = bumps("");
    // Parameters of lights and materials would be unknown where there are none.
    let camera = "orbit(azimuth: 33, elevation: 21)";
    let classify = r#"{ "classify": "preintegrated_2d" }"#;
    stage.write(
        "graph.ron",
        graph(
            r#"path: "v_12x11x10_float32.raw""#,
            camera,
            "{}",
            classify,
            "{}",
        ),
    );
    let overrides = Overrides {
        params: slots
            .split(' ')
            .map(|set| ParamOverride::parse(&format!("image.slots.{set}")).unwrap())
            .collect(),
        ..Overrides::default()
    };
    let path = stage.path().join("graph.ron");
    let scene = Scene::load(
        &path,
        &overrides,
        &ShaderFolders::default(),
        registry(),
        &NoProgress,
    )
    .unwrap();
    let shaders = scene.shader_library(Capabilities::default());
    let plan = scene
        .plan(&shaders, &Limits::default(), [64, 64], false)
        .unwrap();
    plan.nodes().iter().map(|node| node.name.clone()).collect()
}

#[test]
fn tables_of_materials_and_moments_are_made_for_the_shaders_that_read_them() {
    const TABLES: [&str; 4] = [
        "image.material_table",
        "image.material_preintegration",
        "image.material_moments",
        "image.emission_moments",
    ];
    for (slots, expected) in [
        ("light=unlit material=preintegrated", [false; 4]),
        ("light=phong material=uniform", [false; 4]),
        ("light=phong material=transfer", [true, false, false, false]),
        (
            "light=phong material=preintegrated",
            [false, true, false, false],
        ),
        (
            "light=phong_ends material=uniform",
            [false, false, false, true],
        ),
        (
            "light=phong_ends material=transfer",
            [true, false, false, true],
        ),
        (
            "light=phong_ends material=preintegrated",
            [false, true, true, false],
        ),
    ] {
        let nodes = planned(slots);
        let found = TABLES.map(|table| nodes.iter().any(|name| name == table));
        assert_eq!(found, expected, "{slots}: {nodes:?}");
    }
}
