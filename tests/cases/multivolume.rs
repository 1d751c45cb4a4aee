//! Several volumes in one walk, against closed forms: media of even density composited interval by interval.

use glam::{DAffine3, DMat3, DVec3};
use volgraph_tests::{STAGES, Stage, adapters, box_interval, ray, render};

use volgraph_tests::slabs::slabs;

/// Where something changes along a ray between two distances.
type Changes = dyn Fn((DVec3, DVec3), f64, f64) -> Vec<f64>;

/// A box of even density, or one whose colour and extinction follow its place.
struct Medium {
    /// World from the box's own space, in which it spans `low` to `high`.
    placed: DAffine3,
    low: DVec3,
    high: DVec3,
    /// Where it changes along a ray between two distances, beside its box's faces.
    changes: Box<Changes>,
    /// Colour and extinction at a point of its own space.
    at: Box<dyn Fn(DVec3) -> ([f64; 3], f64)>,
}

impl Medium {
    fn even(placed: DAffine3, dims: [u32; 3], color: [f64; 3], extinction: f64) -> Self {
        Self {
            placed,
            low: DVec3::splat(-0.5),
            high: DVec3::from_array(dims.map(f64::from)) - 0.5,
            changes: Box::new(|_, _, _| Vec::new()),
            at: Box::new(move |_| (color, extinction)),
        }
    }

    /// A ray in its own space; distances stay those of the world.
    fn own(&self, (origin, direction): (DVec3, DVec3)) -> (DVec3, DVec3) {
        let own = self.placed.inverse();
        (
            own.transform_point3(origin),
            own.transform_vector3(direction),
        )
    }
}

/// What a ray meets: between two changes of any medium, `parts` even slabs of what they are in its middle.
fn truth(media: &[Medium], ray: (DVec3, DVec3), parts: u32) -> [f64; 4] {
    let spans: Vec<_> = media
        .iter()
        .map(|medium| box_interval(medium.own(ray), medium.low, medium.high))
        .collect();
    let mut cuts: Vec<f64> = Vec::new();
    for (medium, span) in media.iter().zip(&spans) {
        if let Some((near, far)) = *span {
            cuts.extend([near, far]);
            cuts.extend((medium.changes)(medium.own(ray), near, far));
        }
    }
    cuts.sort_by(f64::total_cmp);
    let pieces = cuts.windows(2).flat_map(|pair| {
        let length = (pair[1] - pair[0]) / f64::from(parts);
        (0..parts).map(move |part| (pair[0] + (f64::from(part) + 0.5) * length, length))
    });
    slabs(pieces.map(|(middle, length)| {
        let (mut color, mut depth) = ([0.0; 3], 0.0);
        for (medium, span) in media.iter().zip(&spans) {
            if span.is_none_or(|(near, far)| !(near..far).contains(&middle)) {
                continue;
            }
            let (origin, direction) = medium.own(ray);
            let (own, extinction) = (medium.at)(origin + direction * middle);
            depth += extinction * length;
            for (sum, channel) in color.iter_mut().zip(own) {
                *sum += channel * extinction * length;
            }
        }
        (
            color.map(|sum| if depth > 0.0 { sum / depth } else { 0.0 }),
            depth,
        )
    }))
}

/// A graph with volumes and transfer functions of these RON texts.
fn graph(volumes: &[String], camera: &str, slots: &str, params: &str) -> String {
    let tail = |at: usize| match at {
        0 => String::new(),
        _ => format!("_{}", at + 1),
    };
    let (mut sources, mut boxes, mut inputs) = (String::new(), String::new(), String::new());
    for (at, volume) in volumes.iter().enumerate() {
        let tail = tail(at);
        sources += &format!("\"v{at}\": {volume}, \"t{at}\": transfer(path: \"t{at}.ron\"), ");
        boxes += &format!("\"volume{tail}\": \"v{at}\", ");
        inputs += &format!("\"volume{tail}\": \"v{at}\", \"transfer{tail}\": \"t{at}\", ");
    }
    format!(
        r#"(
    sources: {{ {sources} }},
    camera: {camera},
    nodes: {{
        "box": (kind: "proxy_box", in: {{ {boxes} }}),
        "image": (kind: "multivolume_raycast", in: {{ {inputs} "rays": "box" }}, slots: {slots}, params: {params}),
    }},
    outputs: {{ "color": "image.color" }},
)"#
    )
}

fn transform(affine: &DAffine3) -> String {
    let rows = affine.matrix3.transpose();
    let row = |axis: DVec3, at: f64| format!("{:?}, {:?}, {:?}, {at:?}", axis.x, axis.y, axis.z);
    let at = affine.translation;
    format!(
        "transform: [{}, {}, {}]",
        row(rows.x_axis, at.x),
        row(rows.y_axis, at.y),
        row(rows.z_axis, at.z)
    )
}

const CAMERAS: [&str; 3] = [
    "orbit(azimuth: 33, elevation: 21, fov_y: 40)",
    "orbit(azimuth: -70, elevation: 60, projection: orthographic)",
    // Inside of them.
    "look_at(eye: (3.2, 2.1, 4.4), target: (0.0, 1.0, 0.0), fov_y: 70)",
];

/// The largest error of any channel over all pixels, on every backend and stage; and what a medium a hundredth denser
/// would make of it.
fn check(stage: &Stage, camera: &str, media: &[Medium], parts: u32, bound: f64) {
    let largest = |picture: &volgraph::Picture, view: &volgraph::View, media: &[Medium]| {
        let mut worst = 0.0_f64;
        for y in 0..picture.height {
            for x in 0..picture.width {
                let expected = truth(media, ray(view, x, y), parts);
                let drawn = picture.color[(y * picture.width + x) as usize];
                for (drawn, expected) in drawn.iter().zip(expected) {
                    worst = worst.max((f64::from(*drawn) - expected).abs());
                }
            }
        }
        worst
    };
    for backend in adapters() {
        for form in STAGES {
            let set = format!("image.stage={form}");
            let (picture, view) = render(stage, &[&set], &backend, [48, 40]);
            let error = largest(&picture, &view, media);
            assert!(error <= bound, "{backend} {form} {camera}: {error}");
            let shown = picture.color.iter().filter(|color| color[3] > 0.01).count();
            assert!(shown > 100, "{camera} shows nothing");
            // The check itself must see that one of them is not there.
            assert!(largest(&picture, &view, &media[1..]) > 10.0 * bound);
        }
    }
}

fn turned(degrees: f64, scale: DVec3, at: DVec3) -> DAffine3 {
    let turn = DMat3::from_rotation_z(degrees.to_radians()) * DMat3::from_rotation_x(0.4);
    DAffine3::from_mat3_translation(turn * DMat3::from_diagonal(scale), at)
}

#[test]
fn two_to_four_overlapping_boxes_are_their_closed_form() {
    let placements = [
        DAffine3::IDENTITY,
        turned(30.0, DVec3::new(0.7, 1.3, 0.5), DVec3::new(2.0, 1.0, 3.0)),
        turned(
            -50.0,
            DVec3::new(1.0, -0.8, 0.9),
            DVec3::new(5.0, 6.0, -1.0),
        ),
        turned(10.0, DVec3::splat(2.0), DVec3::new(-4.0, 3.0, 2.0)),
    ];
    let dims = [[8, 8, 8], [6, 5, 9], [7, 7, 7], [4, 3, 5]];
    let colors = [
        [1.0, 0.1, 0.0],
        [0.0, 0.9, 0.2],
        [0.1, 0.2, 1.0],
        [0.8, 0.8, 0.1],
    ];
    let extinctions = [0.15, 0.3, 0.06, 0.7];
    for count in 2..=4 {
        for (camera, classify) in CAMERAS.iter().zip(["preintegrated_2d", "post", "gauss2"]) {
            let mut stage = Stage::new();
            let mut volumes = Vec::new();
            for at in 0..count {
                let [nx, ny, nz] = dims[at];
                stage = stage
                    .with_floats(&format!("v{at}"), dims[at], |_, _, _| 0.5)
                    .with(
                        &format!("t{at}.ron"),
                        format!(
                            "(domain: data, reference_length: (world: 1), color: {:?}, extinction: [(0.0, {1:?}), (1.0, {1:?})])",
                            (colors[at][0], colors[at][1], colors[at][2]),
                            extinctions[at]
                        ),
                    );
                volumes.push(format!(
                    "volume(path: \"v{at}_{nx}x{ny}x{nz}_float32.raw\", {})",
                    transform(&placements[at])
                ));
            }
            let slots = format!("{{ \"classify\": \"{classify}\" }}");
            let params = r#"{ "step": 0.8, "early_termination": 0.0 }"#;
            let stage = stage.with("graph.ron", graph(&volumes, camera, &slots, params));
            let media: Vec<Medium> = (0..count)
                .map(|at| Medium::even(placements[at], dims[at], colors[at], extinctions[at]))
                .collect();
            check(&stage, camera, &media, 1, 2e-5);
        }
    }
}

#[test]
fn two_overlapping_spheres_are_their_closed_form() {
    // Each is as dense as a point is deep inside; both in volumes of the unit cube, the second turned and moved.
    let placements = [
        DAffine3::IDENTITY,
        turned(40.0, DVec3::new(0.8, 0.8, 0.8), DVec3::new(0.35, 0.2, 0.1)),
    ];
    let radius = 0.4;
    let dense = [3.0, 9.0];
    let colors = [[1.0, 0.2, 0.1], [0.1, 0.4, 1.0]];
    let mut stage = Stage::new();
    let mut volumes = Vec::new();
    for at in 0..2 {
        stage = stage.with(
            &format!("t{at}.ron"),
            format!(
                "(domain: data, reference_length: (world: 1), color: {:?}, extinction: [(0.0, 0.0), (0.5, 0.0), (1.0, {:?})])",
                (colors[at][0], colors[at][1], colors[at][2]),
                dense[at]
            ),
        );
        // 0.5 at the radius, and 1 per world unit: the field's own cube is two units wide.
        volumes.push(format!(
            "analytic(field: \"sphere\", dims: (224, 224, 224), radius: {:?}, falloff: 2.0, {})",
            2.0 * radius,
            transform(&placements[at])
        ));
    }
    let media = |at: usize| {
        let (color, dense) = (colors[at], dense[at]);
        Medium {
            placed: placements[at],
            low: DVec3::splat(-0.5),
            high: DVec3::splat(0.5),
            changes: Box::new(move |(origin, direction), near, far| {
                // Where the ray meets the sphere; distances count in world units, the direction is no unit here.
                let (a, b) = (direction.length_squared(), origin.dot(direction));
                let root = b * b - a * (origin.length_squared() - radius * radius);
                let hits = [-1.0, 1.0].map(|sign| (-b + sign * root.max(0.0).sqrt()) / a);
                hits.into_iter()
                    .filter(|hit| (near..far).contains(hit))
                    .collect()
            }),
            at: Box::new(move |point| (color, 2.0 * dense * (radius - point.length()).max(0.0))),
        }
    };
    for camera in &CAMERAS[..2] {
        let params = r#"{ "step": 0.5, "early_termination": 0.0 }"#;
        stage.write("graph.ron", graph(&volumes, camera, "{}", params));
        check(&stage, camera, &[media(0), media(1)], 400, 1e-4);
    }
}

/// The label of a voxel.
fn label(x: u32, y: u32, z: u32) -> u32 {
    (x / 2 + y + 3 * z / 2) % 4
}

#[test]
fn labels_over_a_scan_are_exact_voxel_by_voxel() {
    // The scan: denser to the right, exactly linear from centre to centre.
    let scan_dims = [9, 7, 8];
    let label_dims = [6, 5, 4];
    let placed = turned(20.0, DVec3::new(1.3, 1.1, 1.6), DVec3::new(1.0, 0.5, 0.5));
    let table = [
        ([0.0, 0.0, 0.0], 0.0),
        ([1.0, 0.0, 0.0], 0.4),
        ([0.0, 1.0, 0.0], 1.5),
        ([0.2, 0.3, 1.0], 0.1),
    ];
    let points = |of: &dyn Fn(usize) -> String| {
        // Flat around each whole number, so that a label is one thing.
        let points = (0..4).flat_map(|at| {
            [at as f64 - 0.4, at as f64 + 0.4].map(|place| format!("({place:?}, {})", of(at)))
        });
        points.collect::<Vec<_>>().join(", ")
    };
    let labels = format!(
        "(domain: data, reference_length: (world: 1), color: [{}], extinction: [{}])",
        points(&|at| format!("{:?}", (table[at].0[0], table[at].0[1], table[at].0[2]))),
        points(&|at| format!("{:?}", table[at].1)),
    );
    let stage = Stage::new()
        .with_floats("scan", scan_dims, |x, _, _| x as f32 / 8.0)
        .with_floats("labels", label_dims, |x, y, z| label(x, y, z) as f32)
        .with("t0.ron", "(domain: data, reference_length: (world: 1), color: (0.8, 0.7, 0.6), extinction: [(0.0, 0.0), (1.0, 0.4)])")
        .with("t1.ron", labels);
    let volumes = [
        "volume(path: \"scan_9x7x8_float32.raw\", node_centred: true)".to_owned(),
        format!(
            "volume(path: \"labels_6x5x4_float32.raw\", {})",
            transform(&placed)
        ),
    ];
    let scan = || Medium {
        placed: DAffine3::IDENTITY,
        low: DVec3::ZERO,
        high: DVec3::from_array(scan_dims.map(f64::from)) - 1.0,
        changes: Box::new(|_, _, _| Vec::new()),
        at: Box::new(|point| ([0.8, 0.7, 0.6], 0.4 * point.x / 8.0)),
    };
    let labelled = || Medium {
        placed,
        low: DVec3::splat(-0.5),
        high: DVec3::from_array(label_dims.map(f64::from)) - 0.5,
        changes: Box::new(|(origin, direction), near, far| {
            let faces = (0..3).flat_map(|axis| {
                (0..8).map(move |face| (f64::from(face) - 0.5 - origin[axis]) / direction[axis])
            });
            faces.filter(|at| (near..far).contains(at)).collect()
        }),
        at: Box::new(move |point| {
            let [x, y, z] = (point + 0.5).floor().max(DVec3::ZERO).as_uvec3().to_array();
            table[label(x, y, z) as usize]
        }),
    };
    for camera in CAMERAS {
        for classify in ["preintegrated_2d", "post"] {
            let slots = format!("{{ \"classify\": \"{classify}\" }}");
            let params =
                r#"{ "step": 0.125, "early_termination": 0.0, "interpolation_2": "nearest" }"#;
            stage.write("graph.ron", graph(&volumes, camera, &slots, params));
            check(&stage, camera, &[scan(), labelled()], 64, 1e-4);
        }
    }
}

#[test]
fn what_does_not_go_together_is_refused() {
    let volume =
        |at: usize| format!("analytic(field: \"sphere\", dims: (8, 8, 8), radius: 0.{at})");
    let stage = Stage::new().with(
        "t0.ron",
        "(points: [(at: 0.5, color: (1, 1, 1), opacity: 0.1)])",
    );
    stage.write(
        "t1.ron",
        "(points: [(at: 0.5, color: (1, 1, 1), opacity: 0.1)])",
    );
    let both = graph(&[volume(3), volume(4)], CAMERAS[0], "{}", "{}");
    let code = |text: String| {
        stage.write("graph.ron", text);
        let opened = stage.open("graph.ron", &[], &adapters()[0], [8, 8]);
        let findings = match opened {
            Err(findings) => findings,
            Ok(mut session) => session.render().err().unwrap(),
        };
        findings.into_iter().next().unwrap().code.to_string()
    };
    let one_box = both.replacen("\"volume_2\": \"v1\", ", "", 1);
    assert_ne!(one_box, both);
    assert_eq!(code(one_box), "not-covered");
    let alone = both.replace("\"transfer_2\": \"t1\", ", "");
    assert_eq!(code(alone), "missing-input");
    let cubic = graph(
        &[volume(3), volume(4)],
        CAMERAS[0],
        r#"{ "reconstruct": "tricubic" }"#,
        r#"{ "interpolation": "nearest" }"#,
    );
    assert_eq!(code(cubic), "bad-param");
}
