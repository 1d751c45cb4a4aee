//! Segmented volumes: where labels are cut, what they mean, and the order of the error.

use glam::DVec3;
use volgraph::{Picture, View};
use volgraph_tests::slabs::{middles, slabs};
use volgraph_tests::{STAGES, Stage, adapters, box_interval, ray, render};

pub(super) const CAMERAS: [&str; 2] = [
    "orbit(azimuth: 33, elevation: 21, fov_y: 40)",
    "orbit(azimuth: 33, elevation: 21, projection: orthographic)",
];

/// A graph of a volume with labels; `more` are further fields of the node `image`'s `params`.
pub(super) fn graph(spacing: &str, camera: &str, slots: &str, more: &str) -> String {
    format!(
        r#"(
    sources: {{
        "volume": volume(path: "v_8x8x8_float32.raw", spacing: {spacing}),
        "labels": volume(path: "l_8x8x8_float32.raw", spacing: {spacing}),
        "colors": transfer(path: "own.ron"),
        "meaning": segments(path: "segments.ron"),
    }},
    camera: {camera},
    nodes: {{
        "box": (kind: "proxy_box", in: {{ "volume": "volume" }}),
        "image": (kind: "raycast",
                  in: {{ "volume": "volume", "transfer": "colors", "labels": "labels", "segments": "meaning", "rays": "box" }},
                  slots: {{ "labels": "volume", {slots} }}, params: {{ "early_termination": 0.0, {more} }}),
    }},
    outputs: {{ "color": "image.color", "label": "image.label" }},
)"#
    )
}

pub(super) fn transfer(color: &str, extinction: f64) -> String {
    format!(
        "(domain: data(from: 0, to: 1), reference_length: (world: 1), color: {color}, extinction: [(0.0, {extinction:?})])"
    )
}

/// The volume is 0.5 everywhere; labels are a function of the voxel.
pub(super) fn stage(labels: impl Fn(u32, u32, u32) -> u32, segments: &str) -> Stage {
    Stage::new()
        .with_floats("v", [8, 8, 8], |_, _, _| 0.5)
        .with_floats("l", [8, 8, 8], |x, y, z| labels(x, y, z) as f32)
        .with("own.ron", transfer("(1, 0, 0)", 0.11))
        .with("blue.ron", transfer("(0, 0, 1)", 0.23))
        .with("green.ron", transfer("(0, 1, 0)", 0.05))
        .with("segments.ron", segments)
}

/// The largest error of any channel over all pixels, and how many rays meet the box.
fn worst(
    (picture, view): &(Picture, View),
    (low, high): (DVec3, DVec3),
    truth: impl Fn(DVec3, DVec3) -> [f64; 4],
) -> (f64, usize) {
    let opacity = picture.opacity.as_ref().unwrap();
    let (mut worst, mut met) = (0.0_f64, 0);
    for y in 0..picture.height {
        for x in 0..picture.width {
            let ray = ray(view, x, y);
            let expected = match box_interval(ray, low, high) {
                Some((near, far)) => {
                    met += 1;
                    truth(ray.0 + ray.1 * near, ray.0 + ray.1 * far)
                }
                None => [0.0; 4],
            };
            let at = (y * picture.width + x) as usize;
            let [r, g, b, _] = picture.color[at];
            for (seen, expected) in [r, g, b, opacity[at]].into_iter().zip(expected) {
                worst = worst.max((f64::from(seen) - expected).abs());
            }
        }
    }
    (worst, met)
}

/// What two absorbers show that a ray goes through one after the other: (colour, extinction, length) of each.
fn behind_each_other(stretches: &[([f64; 3], f64, f64)]) -> [f64; 4] {
    let mut seen = [0.0; 4];
    let mut light = 1.0;
    for (color, extinction, length) in stretches {
        let left = (-extinction * length).exp();
        for (seen, color) in seen.iter_mut().zip(color) {
            *seen += light * (1.0 - left) * color;
        }
        light *= left;
    }
    seen[3] = 1.0 - light;
    seen
}

const RED: ([f64; 3], f64) = ([1.0, 0.0, 0.0], 0.11);
const BLUE: ([f64; 3], f64) = ([0.0, 0.0, 1.0], 0.23);

/// Through a plane at which red ends and blue begins; `side` is the distance to it, positive on blue's side.
fn two_materials(from: DVec3, to: DVec3, side: impl Fn(DVec3) -> f64) -> [f64; 4] {
    let (a, b, length) = (side(from), side(to), from.distance(to));
    let material = |side: f64| if side > 0.0 { BLUE } else { RED };
    let part = if (a > 0.0) == (b > 0.0) {
        1.0
    } else {
        a / (a - b)
    };
    let (first, second) = (material(a), material(b));
    behind_each_other(&[
        (first.0, first.1, length * part),
        (second.0, second.1, length * (1.0 - part)),
    ])
}

pub(super) const BLUE_IS_1: &str =
    r#"(segments: [(label: 1, name: "blue", transfer: "blue.ron")])"#;

#[test]
fn two_materials_meet_between_voxels_whatever_the_step() {
    // The boundary is the plane half-way between the voxels 3 and 4: there is no error of the method, and what is left
    // are roundings of f32: of a boundary (1e-4 voxels at grazing rays) and of some hundred factors.
    for (spacing, step) in [
        ([1.0, 1.0, 1.0], "0.3"),
        ([1.0, 2.0, 5.0], "1"),
        ([1.0, 2.0, 5.0], "16"),
        ([1.0; 3], "4"),
    ] {
        let [x, y, z] = spacing;
        for (at, camera) in CAMERAS.into_iter().enumerate() {
            for classify in ["post", "preintegrated_2d"] {
                let stage = stage(|x, _, _| u32::from(x > 3), BLUE_IS_1).with(
                    "graph.ron",
                    graph(
                        &format!("({x:?}, {y:?}, {z:?})"),
                        camera,
                        &format!(r#""classify": "{classify}""#),
                        &format!(r#""step": {step}, "preintegration_size": 64"#),
                    ),
                );
                let span = (
                    -0.5 * DVec3::from_array(spacing),
                    7.5 * DVec3::from_array(spacing),
                );
                for backend in adapters() {
                    let form = STAGES[at];
                    let set = format!("image.stage={form}");
                    let drawn = render(&stage, &[&set], &backend, [48, 40]);
                    let truth = |from, to| two_materials(from, to, |p: DVec3| p.x - 3.5 * x);
                    let (error, met) = worst(&drawn, span, truth);
                    assert!(
                        error <= 1e-4 && met > 100,
                        "{backend} {form} {classify} {step}: {error}, {met}"
                    );
                    // A boundary that is a twentieth of a voxel off is seen.
                    let off = |from, to| two_materials(from, to, |p: DVec3| p.x - 3.55 * x);
                    assert!(worst(&drawn, span, off).0 > 2e-4);
                }
            }
        }
    }
}

/// A label's own transfer function counts where the node's own shows nothing at all.
#[test]
fn what_a_label_alone_absorbs_is_seen_however_the_walk_skips() {
    let stage = stage(|x, _, _| u32::from(x > 3), BLUE_IS_1)
        .with("own.ron", transfer("(1, 0, 0)", 0.0))
        .with(
            "graph.ron",
            graph("(1.0, 1.0, 1.0)", CAMERAS[0], "", r#""step": 0.5"#),
        );
    let span = (DVec3::splat(-0.5), DVec3::splat(7.5));
    let truth = |from: DVec3, to: DVec3| {
        let [a, b] = [from.x - 3.5, to.x - 3.5];
        let share = if (a > 0.0) == (b > 0.0) {
            f64::from(u8::from(a > 0.0))
        } else {
            a.max(b) / (a - b).abs()
        };
        behind_each_other(&[(BLUE.0, BLUE.1, from.distance(to) * share)])
    };
    for backend in adapters() {
        for traverse in ["uniform", "skip", "adaptive"] {
            let set = format!("image.slots.traverse={traverse}");
            let (error, met) = worst(&render(&stage, &[&set], &backend, [48, 40]), span, truth);
            assert!(
                error <= 1e-4 && met > 100,
                "{backend} {traverse}: {error}, {met}"
            );
        }
    }
}

#[test]
fn an_oblique_boundary_is_where_memberships_are_equal() {
    // Labels of the half-space x + y > 7: on the lattice memberships are equal on that plane, inside of the grid's
    // faces. In f64: the root of the trilinear membership along the ray, by fine steps and bisection.
    let stage = stage(|x, y, _| u32::from(x + y > 7), BLUE_IS_1).with(
        "graph.ron",
        graph("(1, 1, 1)", CAMERAS[0], "", r#""step": 1.3"#),
    );
    let label = |p: DVec3| {
        let p = p.clamp(DVec3::ZERO, DVec3::splat(7.0));
        let (low, part) = (p.floor(), p.fract());
        let is_in = |dx: f64, dy: f64| f64::from(u8::from(low.x + dx + low.y + dy > 7.0));
        let row = |dy| is_in(0.0, dy) * (1.0 - part.x) + is_in(1.0, dy) * part.x;
        row(0.0) * (1.0 - part.y) + row(1.0) * part.y - 0.5
    };
    let truth = |from: DVec3, to: DVec3| {
        let length = from.distance(to);
        let at = |t: f64| from.lerp(to, t);
        let steps = 4000;
        let mut stretches = vec![];
        let mut last = (0.0, label(at(1e-9)) > 0.0);
        for i in 1..=steps {
            let t = f64::from(i) / f64::from(steps);
            if (label(at(t.min(1.0 - 1e-9))) > 0.0) == last.1 && i < steps {
                continue;
            }
            let (mut a, mut b) = (f64::from(i - 1) / f64::from(steps), t);
            if i < steps {
                for _ in 0..40 {
                    let middle = 0.5 * (a + b);
                    if (label(at(middle)) > 0.0) == last.1 {
                        a = middle;
                    } else {
                        b = middle;
                    }
                }
            } else {
                b = 1.0;
            }
            let (color, extinction) = if last.1 { BLUE } else { RED };
            stretches.push((color, extinction, (b - last.0) * length));
            last = (b, !last.1);
        }
        behind_each_other(&stretches)
    };
    for backend in adapters() {
        let span = (DVec3::splat(-0.5), DVec3::splat(7.5));
        let drawn = render(&stage, &[], &backend, [40, 40]);
        let (error, met) = worst(&drawn, span, truth);
        assert!(error <= 2e-4 && met > 100, "{backend}: {error}");
    }
}

#[test]
fn blocky_labels_meet_at_the_faces_of_voxels() {
    // A stair in x and y: the label along the ray from the voxel that each place is in, at 20,000 places.
    let is_blue = |x: u32, y: u32| x + y > 7;
    let stage = stage(|x, y, _| u32::from(is_blue(x, y)), BLUE_IS_1).with(
        "graph.ron",
        graph("(1, 1, 1)", CAMERAS[0], "", r#""label_boundary": "blocky""#),
    );
    let truth = |from: DVec3, to: DVec3| {
        let (count, length) = (20_000, from.distance(to));
        let stretches: Vec<_> = (0..count)
            .map(|i| {
                let p = from
                    .lerp(to, (f64::from(i) + 0.5) / f64::from(count))
                    .round();
                let (x, y) = (p.x.clamp(0.0, 7.0) as u32, p.y.clamp(0.0, 7.0) as u32);
                let (color, extinction) = if is_blue(x, y) { BLUE } else { RED };
                (color, extinction, length / f64::from(count))
            })
            .collect();
        behind_each_other(&stretches)
    };
    for backend in adapters() {
        let span = (DVec3::splat(-0.5), DVec3::splat(7.5));
        let drawn = render(&stage, &[], &backend, [32, 32]);
        let (error, _) = worst(&drawn, span, truth);
        // The places are 7e-4 apart, and each of up to 9 faces may be off by as much; probes by 1e-3.
        assert!(error <= 1.5e-3, "{backend}: {error}");
    }
}

#[test]
fn a_label_that_is_not_drawn_is_cut_away() {
    let segments = "(segments: [(label: 1, visible: false)])";
    let stage = stage(|x, _, _| u32::from(x > 3), segments).with(
        "graph.ron",
        graph("(1, 1, 1)", CAMERAS[0], "", r#""step": 3"#),
    );
    let truth = |from: DVec3, to: DVec3| {
        let (a, b) = (3.5 - from.x, 3.5 - to.x);
        let part = match (a > 0.0, b > 0.0) {
            (true, true) => 1.0,
            (false, false) => 0.0,
            (true, false) => a / (a - b),
            (false, true) => b / (b - a),
        };
        behind_each_other(&[(RED.0, RED.1, part * from.distance(to))])
    };
    for backend in adapters() {
        let span = (DVec3::splat(-0.5), DVec3::splat(7.5));
        let drawn = render(&stage, &[], &backend, [48, 40]);
        let (error, _) = worst(&drawn, span, truth);
        assert!(error <= 1e-4, "{backend}: {error}");
    }
}

#[test]
fn labels_have_parameters_of_their_own_and_the_layer_tells_them() {
    // Isosurfaces that begin at the very face of the box or of the labels: solid everywhere, so the colour is that of
    // the first label that is met, and so is the layer.
    let segments = r#"(
        segments: [
            (label: 1, params: { "surface_color": (0.1, 0.7, 0.2) }),
            (label: 2, params: { "isovalue": 0.9 }),
        ],
        others: (params: { "surface_color": (0.3, 0.2, 0.9) }),
    )"#;
    let labels = |x: u32, _: u32, z: u32| {
        if z < 3 {
            1
        } else if x < 4 {
            2
        } else {
            200
        }
    };
    let stage = stage(labels, segments).with(
        "graph.ron",
        graph(
            "(1, 1, 1)",
            CAMERAS[0],
            r#""technique": "isosurface""#,
            r#""isovalue": 0.25, "isovalue_unit": "data""#,
        )
        .replace(r#""early_termination": 0.0, "#, ""),
    );
    let colors = [(1, [0.1, 0.7, 0.2]), (200, [0.3, 0.2, 0.9]), (0, [0.0; 3])];
    for backend in adapters() {
        for form in STAGES {
            let set = format!("image.stage={form}");
            let mut session = stage
                .open("graph.ron", &[&set], &backend, [48, 40])
                .unwrap();
            let (picture, _) = session.render().unwrap();
            let layer = session.read("label").unwrap();
            let view = *session.view();
            let (mut counts, mut wrong) = ([0, 0, 0], 0);
            for y in 0..40 {
                for x in 0..48 {
                    let ray = ray(&view, x, y);
                    let (low, high) = (DVec3::splat(-0.5), DVec3::splat(7.5));
                    let first = box_interval(ray, low, high).and_then(|(near, far)| {
                        // Where memberships are equal, at 2000 places; label 2 is not solid.
                        let label = |p: DVec3| {
                            if p.z < 2.5 {
                                1
                            } else if p.x < 3.5 {
                                2
                            } else {
                                200
                            }
                        };
                        let place = |i: u32| {
                            ray.0 + ray.1 * (near + (far - near) * (f64::from(i) + 0.5) / 2000.0)
                        };
                        (0..2000).map(|i| label(place(i))).find(|label| *label != 2)
                    });
                    let first = first.unwrap_or(0);
                    let at = (y * 48 + x) as usize;
                    let index = colors
                        .iter()
                        .position(|(label, _)| *label == first)
                        .unwrap();
                    counts[index] += 1;
                    let color = colors[index].1;
                    let is_color =
                        (0..3).all(|i| (f64::from(picture.color[at][i]) - color[i]).abs() < 1e-5);
                    let is_label = layer.color[at][0] == first as f32;
                    wrong += usize::from(!is_color) + usize::from(!is_label);
                }
            }
            // Where three labels meet, none has half: the boundary bends away from the planes there.
            assert!(counts.iter().all(|count| *count > 30), "{counts:?}");
            assert!(wrong <= 24, "{backend} {form}: {wrong} wrong of {counts:?}");
        }
    }
}

#[test]
fn two_hundred_and_fifty_five_labels_each_absorb_as_they_say() {
    // Columns of 2x2x8... each voxel column (x, y) and half in z has a label: 128; and as many again by parity: one
    // voxel each along z. Each label has an extinction of its own, all of the same colour.
    let label = |x: u32, y: u32, z: u32| 1 + (x + 8 * y + 64 * (z / 2)) % 255;
    let extinction = |label: u32| 0.02 + 0.001 * f64::from(label);
    let entries: Vec<String> = (1..=255)
        .map(|label| format!(r#"(label: {label}, transfer: "t{label}.ron")"#))
        .collect();
    let mut stage = stage(label, &format!("(segments: [{}])", entries.join(", "))).with(
        "graph.ron",
        graph("(1, 1, 1)", "look_at(eye: (3.0, 4.0, -20), target: (3.0, 4.0, 0), projection: orthographic, height: 1.0)", "", r#""step": 0.7, "label_boundary": "blocky", "table_size": 1024"#),
    );
    for label in 1..=255 {
        stage = stage.with(
            &format!("t{label}.ron"),
            transfer("(1, 1, 1)", extinction(label)),
        );
    }
    for backend in adapters() {
        // So many pre-integrated tables do not fit.
        let sets = ["image.slots.classify=post"];
        let (picture, view) = render(&stage, &sets, &backend, [16, 16]);
        let opacity = picture.opacity.unwrap();
        let mut worst = 0.0_f64;
        for y in 0..16 {
            for x in 0..16 {
                let at = ray(&view, x, y).0;
                let (i, j) = (at.x.round() as u32, at.y.round() as u32);
                let depth: f64 = (0..8).map(|z| extinction(label(i, j, z))).sum();
                let seen = f64::from(opacity[(y * 16 + x) as usize]);
                worst = worst.max((seen - (1.0 - (-depth).exp())).abs());
            }
        }
        assert!(worst < 1e-4, "{backend}: {worst}");
    }
}

#[test]
fn with_smooth_fields_the_error_falls_with_the_square_of_the_step() {
    // Scalars rise along x; red's colour is constant and its extinction linear in the scalar, blue's the other way
    // round. Segments are whole from the boundary on, so that the midpoint rule keeps its order 2 across it.
    let colors = "(domain: data(from: 0, to: 1), reference_length: (world: 1), color: [(0, (0, 0, 0)), (1, (0, 0, 1))], extinction: [(0.0, 0.3)])";
    let own = "(domain: data(from: 0, to: 1), reference_length: (world: 1), color: (1, 0, 0), extinction: [(0.0, 0.0), (1.0, 0.5)])";
    let stage = stage(|x, _, _| u32::from(x > 3), BLUE_IS_1)
        .with_floats("v", [8, 8, 8], |x, _, _| x as f32 / 7.0)
        .with("blue.ron", colors)
        .with("own.ron", own)
        .with("graph.ron", graph("(1, 1, 1)", CAMERAS[0], "", ""));
    let truth = |from: DVec3, to: DVec3| {
        // Even places on both sides of the boundary, which lies between two of them.
        let part = ((3.5 - from.x) / (to.x - from.x)).clamp(0.0, 1.0);
        slabs([(0.0, part), (part, 1.0 - part)].into_iter().flat_map(
            |(start, share): (f64, f64)| {
                middles(2000).map(move |t| {
                    let x = from.lerp(to, start + share * t).x;
                    let scalar = x.clamp(0.0, 7.0) / 7.0;
                    let (color, extinction) = if x > 3.5 {
                        ([0.0, 0.0, scalar], 0.3)
                    } else {
                        ([1.0, 0.0, 0.0], 0.5 * scalar)
                    };
                    (color, extinction * from.distance(to) * share / 2000.0)
                })
            },
        ))
    };
    for backend in adapters() {
        let error = |step: &str| {
            let sets = [format!("image.step={step}")];
            let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
            let span = (DVec3::splat(-0.5), DVec3::splat(7.5));
            worst(&render(&stage, &sets, &backend, [24, 24]), span, truth).0
        };
        // At a voxel and more the steps are as long as the stretches: the order shows below that.
        let errors = [error("0.5"), error("0.25"), error("0.125")];
        let orders = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
        assert!(
            orders.iter().sum::<f64>() > 3.6,
            "{backend}: errors {errors:?}, orders {orders:?}"
        );
    }
}

/// Tables are made for one lookup: a label that asks for another would read depths as transmittances.
#[test]
fn labels_share_the_lookup_that_their_tables_are_made_for() {
    let backend = &adapters()[0];
    for (node, label, is_fit) in [
        ("bilinear", "nearest", false),
        ("nearest", "bilinear", false),
        ("nearest", "nearest", true),
    ] {
        let segments = format!(r#"(segments: [(label: 1, params: {{ "lookup": "{label}" }})])"#);
        let stage = stage(|x, _, _| u32::from(x > 3), &segments).with(
            "graph.ron",
            graph(
                "(1, 1, 1)",
                CAMERAS[0],
                r#""classify": "preintegrated_2d""#,
                &format!(r#""lookup": "{node}""#),
            ),
        );
        let session = stage.open("graph.ron", &[], backend, [8, 8]);
        let drawn = session.and_then(|mut session| session.render().map(|_| ()));
        match drawn {
            Ok(()) => assert!(is_fit, "{node}, {label}"),
            Err(findings) => {
                let findings = findings.to_string();
                assert!(
                    !is_fit && findings.contains("labels have another"),
                    "{node}, {label}: {findings}"
                );
            }
        }
    }
}
