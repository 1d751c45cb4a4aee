//! Clip shapes against closed forms: what is left of a constant volume absorbs by its length, at any step.
//!
//! How the pictures depend on the step, and how cut faces are lit, is in `clip_pictures`.

use glam::DVec3;
use volgraph_tests::{STAGES, Stage, adapters, box_interval, graph, ray, render};

pub(crate) const PERSPECTIVE: &str = "orbit(azimuth: 33, elevation: 21, fov_y: 40)";
const ORTHOGRAPHIC: &str = "orbit(azimuth: 33, elevation: 21, projection: orthographic)";
const ALONG_Y: &str = "orbit(azimuth: 0, elevation: 0, projection: orthographic)";
const INSIDE: &str = "look_at(eye: (3.2, 2.1, 4.4), target: (0.0, 1.0, 0.0), fov_y: 70)";

/// A volume of 8 x 6 x 4 voxels.
struct Block {
    source: &'static str,
    low: DVec3,
    high: DVec3,
}

const CUBIC: Block = Block {
    source: r#"path: "v_8x6x4_float32.raw""#,
    low: DVec3::new(-0.5, -0.5, -0.5),
    high: DVec3::new(7.5, 5.5, 3.5),
};

const STRETCHED: Block = Block {
    source: r#"path: "v_8x6x4_float32.raw", spacing: (1, 2, 5)"#,
    low: DVec3::new(-0.5, -1.0, -2.5),
    high: DVec3::new(7.5, 11.0, 17.5),
};

impl Block {
    fn centre(&self) -> DVec3 {
        0.5 * (self.low + self.high)
    }

    /// The unit of `space: box`.
    fn half_side(&self) -> f64 {
        0.5 * (self.high - self.low).min_element()
    }
}

/// A ray: origin, unit direction.
type Line = (DVec3, DVec3);

/// The part of an interval of a ray on the inner side of a plane `n · p >= d`.
fn above((near, far): (f64, f64), line: Line, normal: DVec3, distance: f64) -> (f64, f64) {
    let height = normal.dot(line.0) - distance;
    let slope = normal.dot(line.1);
    let at = -height / slope;
    if slope.abs() < 1e-12 {
        (near, if height < 0.0 { near } else { far })
    } else if slope > 0.0 {
        (near.max(at), far)
    } else {
        (near, far.min(at))
    }
}

/// The length of what is left, given the interval in the box.
type Truth = Box<dyn Fn(Line, (f64, f64)) -> f64>;

fn length(interval: (f64, f64)) -> f64 {
    (interval.1 - interval.0).max(0.0)
}

/// Planes in the units of `space: box`: the parameters, and the truth.
fn planes(block: &Block, given: &[[f64; 4]], is_inside: bool) -> (String, Truth) {
    let listed: String = (1..)
        .zip(given)
        .map(|(number, plane)| format!(r#", "plane_{number}": {plane:?}"#))
        .collect();
    let keep = if is_inside { "inside" } else { "outside" };
    let params = format!(
        r#", "planes": {}{listed}, "clip_keep": "{keep}""#,
        given.len()
    );
    let world: Vec<(DVec3, f64)> = given
        .iter()
        .map(|[x, y, z, distance]| {
            let normal = DVec3::new(*x, *y, *z).normalize_or_zero();
            (
                normal,
                normal.dot(block.centre() + normal * *distance * block.half_side()),
            )
        })
        .collect();
    let truth = move |line: Line, whole: (f64, f64)| {
        let inside = world.iter().fold(whole, |interval, (normal, distance)| {
            above(interval, line, *normal, *distance)
        });
        if is_inside {
            length(inside)
        } else {
            length(whole) - length(inside)
        }
    };
    (params, Box::new(truth))
}

fn boxed(block: &Block, low: DVec3, high: DVec3, is_inside: bool) -> (String, Truth) {
    let keep = if is_inside { "inside" } else { "outside" };
    let params = format!(
        r#", "clip_low": {:?}, "clip_high": {:?}, "clip_keep": "{keep}""#,
        low.to_array(),
        high.to_array()
    );
    let size = block.high - block.low;
    // Corners may be given in any order.
    let a = block.low + low.min(high) * size;
    let b = block.low + low.max(high) * size;
    let truth = move |line: Line, whole: (f64, f64)| {
        let inside = box_interval(line, a, b).map_or(0.0, |(near, far)| {
            length((near.max(whole.0), far.min(whole.1)))
        });
        if is_inside {
            inside
        } else {
            length(whole) - inside
        }
    };
    (params, Box::new(truth))
}

fn sphere(block: &Block, centre: DVec3, radius: f64, is_inside: bool) -> (String, Truth) {
    let keep = if is_inside { "inside" } else { "outside" };
    let params = format!(
        r#", "clip_centre": {:?}, "clip_radius": {radius}, "clip_keep": "{keep}""#,
        centre.to_array()
    );
    let centre = block.centre() + centre * block.half_side();
    let radius = radius * block.half_side();
    let truth = move |line: Line, whole: (f64, f64)| {
        let middle = (centre - line.0).dot(line.1);
        let nearest = (line.0 + line.1 * middle - centre).length_squared();
        let half = (radius * radius - nearest).max(0.0).sqrt();
        let inside = length((whole.0.max(middle - half), whole.1.min(middle + half)));
        if is_inside {
            inside
        } else {
            length(whole) - inside
        }
    };
    (params, Box::new(truth))
}

/// A scene of a constant block; `clip` is the source of the clip volume.
fn scene(block: &Block, camera: &str, slots: &str, params: &str, clip: &str) -> Stage {
    let mut text = graph(block.source, camera, "{}", slots, params);
    if !clip.is_empty() {
        text = text
            .replace(
                "sources: {",
                &format!(r#"sources: {{ "clip": volume({clip}),"#),
            )
            .replace(
                r#"in: { "volume": "volume", "transfer""#,
                r#"in: { "clip_volume": "clip", "volume": "volume", "transfer""#,
            );
    }
    Stage::new()
        .with_floats("v", [8, 6, 4], |_, _, _| 0.5)
        .with(
            "transfer.ron",
            "(points: [(at: 0.5, color: (1, 1, 1), opacity: 0.1)])",
        )
        .with("graph.ron", text)
}

/// The largest error of the opacity, and the number of pixels where something is clipped and something is left.
fn worst(stage: &Stage, block: &Block, backend: &str, form: &str, truth: &Truth) -> (f64, usize) {
    let set = format!("image.stage={form}");
    let (picture, view) = render(stage, &[&set], backend, [40, 32]);
    let extinction = -(0.9_f64.ln());
    let opacity = picture.opacity.unwrap();
    let (mut worst, mut cut) = (0.0_f64, 0);
    for (at, seen) in (0..).zip(&opacity) {
        let line = ray(&view, at % 40, at / 40);
        let whole = box_interval(line, block.low, block.high).unwrap_or((0.0, 0.0));
        let left = truth(line, whole);
        cut += usize::from(left > 0.01 && left < length(whole) - 0.01);
        let expected = 1.0 - (-extinction * left).exp();
        worst = worst.max((f64::from(*seen) - expected).abs());
    }
    (worst, cut)
}

/// What f32 leaves: parts shorter than 1e-4 voxels are no parts (1e-5 of opacity each), and each of up to 80 segments
/// rounds the transmittance (3e-8 each).
const BOUND: f64 = 3e-5;

struct Case<'c> {
    name: &'c str,
    block: &'c Block,
    camera: &'c str,
    clip: &'c str,
    slots: &'c str,
    step: f64,
    shape: (String, Truth),
}

fn check(case: &Case<'_>, stage: impl Fn(Stage) -> Stage, clip: &str, least: usize) {
    let slots = format!(r#"{{ "clip": "{}"{} }}"#, case.clip, case.slots);
    let params = format!(
        r#"{{ "step": {}, "early_termination": 0.0{} }}"#,
        case.step, case.shape.0
    );
    let stage = stage(scene(case.block, case.camera, &slots, &params, clip));
    for backend in adapters() {
        for form in STAGES {
            let (error, cut) = worst(&stage, case.block, &backend, form, &case.shape.1);
            let name = case.name;
            assert!(error <= BOUND, "{name} {backend} {form}: {error}");
            assert!(
                cut >= least,
                "{name} {backend} {form}: {cut} pixels are cut"
            );
        }
    }
}

const TABLE: &str = r#", "classify": "preintegrated_2d""#;

#[test]
fn planes_leave_what_lies_on_the_inner_side_of_all() {
    let octahedron: Vec<[f64; 4]> = (0..8)
        .map(|at| {
            let sign = |bit: u32| if at >> bit & 1 == 0 { 1.0 } else { -1.0 };
            [sign(0), sign(1), sign(2), -0.8]
        })
        .collect();
    let corner = [
        [1.0, 0.0, 0.0, 0.1],
        [0.0, -2.0, 0.0, -0.2],
        [0.0, 0.0, 1.0, -0.3],
    ];
    // Through three corners of the stretched block, whose half sides are 4, 6 and 10: in units of 4.
    let diagonal = DVec3::new(1.0 / 4.0, 1.0 / 6.0, 1.0 / 10.0);
    let through_corners = [[
        diagonal.x,
        diagonal.y,
        diagonal.z,
        -0.25 / diagonal.length(),
    ]];
    let cases = [
        (
            "one",
            &CUBIC,
            PERSPECTIVE,
            "",
            0.3,
            planes(&CUBIC, &[[0.3, -0.5, 0.7, 0.1]], true),
        ),
        (
            "corner",
            &CUBIC,
            PERSPECTIVE,
            TABLE,
            1.0,
            planes(&CUBIC, &corner, false),
        ),
        (
            "corners",
            &STRETCHED,
            PERSPECTIVE,
            "",
            4.0,
            planes(&STRETCHED, &through_corners, true),
        ),
        (
            "eight",
            &CUBIC,
            ORTHOGRAPHIC,
            TABLE,
            16.0,
            planes(&CUBIC, &octahedron, true),
        ),
        (
            "eight out",
            &STRETCHED,
            PERSPECTIVE,
            TABLE,
            1.0,
            planes(&STRETCHED, &octahedron, false),
        ),
        (
            "inside",
            &CUBIC,
            INSIDE,
            "",
            1.0,
            planes(&CUBIC, &corner, true),
        ),
        // Rays in the plane's own direction.
        (
            "parallel",
            &CUBIC,
            ALONG_Y,
            "",
            1.0,
            planes(
                &CUBIC,
                &[[1.0, 0.0, 0.0, 0.113], [0.0, 1.0, 0.2, 0.0]],
                true,
            ),
        ),
        // Which of its sides is inner, a plane without a normal does not say: it cuts nothing.
        (
            "zero",
            &CUBIC,
            PERSPECTIVE,
            "",
            1.0,
            planes(&CUBIC, &[[0.0, 0.0, 0.0, 0.3], [0.0, 0.0, 1.0, 0.0]], true),
        ),
    ];
    for (name, block, camera, slots, step, shape) in cases {
        check(
            &Case {
                name,
                block,
                camera,
                clip: "planes",
                slots,
                step,
                shape,
            },
            |stage| stage,
            "",
            60,
        );
    }
    // Nothing is left, and nothing is cut away.
    for (keep, name) in [(true, "none"), (false, "all")] {
        let shape = planes(&CUBIC, &[[1.0, 0.0, 0.0, 5.0]], keep);
        let case = Case {
            name,
            block: &CUBIC,
            camera: PERSPECTIVE,
            clip: "planes",
            slots: "",
            step: 1.0,
            shape,
        };
        check(&case, |stage| stage, "", 0);
    }
}

#[test]
fn boxes_and_spheres_leave_their_inside_or_their_outside() {
    let (low, high) = (DVec3::new(0.2, 0.9, 0.0), DVec3::new(0.7, 0.3, 0.6));
    let centre = DVec3::new(0.5, -0.25, 0.125);
    let cases = [
        (
            "inside",
            &CUBIC,
            PERSPECTIVE,
            "box",
            TABLE,
            0.3,
            boxed(&CUBIC, low, high, true),
        ),
        (
            "outside",
            &STRETCHED,
            PERSPECTIVE,
            "box",
            "",
            4.0,
            boxed(&STRETCHED, low, high, false),
        ),
        (
            "orthographic",
            &STRETCHED,
            ALONG_Y,
            "box",
            TABLE,
            16.0,
            boxed(&STRETCHED, low, high, false),
        ),
        (
            "eye inside",
            &CUBIC,
            INSIDE,
            "box",
            "",
            1.0,
            boxed(&CUBIC, low, high, false),
        ),
        (
            "inside",
            &CUBIC,
            PERSPECTIVE,
            "sphere",
            TABLE,
            16.0,
            sphere(&CUBIC, centre, 0.9, true),
        ),
        (
            "outside",
            &STRETCHED,
            ORTHOGRAPHIC,
            "sphere",
            "",
            0.3,
            sphere(&STRETCHED, centre, 1.3, false),
        ),
        (
            "outside",
            &CUBIC,
            PERSPECTIVE,
            "sphere",
            TABLE,
            4.0,
            sphere(&CUBIC, centre, 0.9, false),
        ),
        (
            "eye inside",
            &CUBIC,
            INSIDE,
            "sphere",
            "",
            1.0,
            sphere(&CUBIC, centre, 0.9, true),
        ),
    ];
    for (name, block, camera, clip, slots, step, shape) in cases {
        check(
            &Case {
                name,
                block,
                camera,
                clip,
                slots,
                step,
                shape,
            },
            |stage| stage,
            "",
            60,
        );
    }
}

/// A ramp along a direction, as a clip volume of its own size and placement: (source, stage, parameters, truth).
fn ramp(direction: DVec3, level: f64, is_inside: bool) -> (String, Truth) {
    let keep = if is_inside { "inside" } else { "outside" };
    let params = format!(
        r#", "clip_isovalue": {level}, "clip_isovalue_unit": "data", "clip_keep": "{keep}""#
    );
    let truth = move |line: Line, whole: (f64, f64)| {
        let inside = length(above(whole, line, direction, level));
        if is_inside {
            inside
        } else {
            length(whole) - inside
        }
    };
    (params, Box::new(truth))
}

#[test]
fn a_clip_volume_cuts_at_its_isosurface_whatever_its_size_and_placement() {
    // Larger than the block: the field is linear everywhere in it, and a cut is where the ramp says.
    let direction = DVec3::new(0.5, 0.25, -0.125);
    let large = |stage: Stage| {
        stage.with_floats("c", [6, 9, 4], move |x, y, z| {
            let world = DVec3::new(
                f64::from(x) * 4.0 - 4.0,
                f64::from(y) * 3.0 - 4.0,
                f64::from(z) * 11.0 - 7.0,
            );
            direction.dot(world) as f32
        })
    };
    let large_source = r#"path: "c_6x9x4_float32.raw", spacing: (4, 3, 11), origin: (-4, -4, -7)"#;
    // Smaller than the block: around it, it goes on with its nearest value, here along x alone.
    let small = |stage: Stage| stage.with_floats("c", [5, 1, 2], |x, _, _| x as f32 * 0.25 + 2.0);
    let small_source =
        r#"path: "c_5x1x2_float32.raw", spacing: (0.25, 0.5, 0.25), origin: (2, 3, 1)"#;
    let cases = [
        (
            "large",
            &CUBIC,
            PERSPECTIVE,
            true,
            TABLE,
            0.3,
            ramp(direction, 1.1, true),
        ),
        (
            "large",
            &STRETCHED,
            PERSPECTIVE,
            true,
            "",
            4.0,
            ramp(direction, 1.1, false),
        ),
        (
            "large",
            &STRETCHED,
            ORTHOGRAPHIC,
            true,
            TABLE,
            16.0,
            ramp(direction, 1.1, true),
        ),
        (
            "large",
            &CUBIC,
            INSIDE,
            true,
            "",
            1.0,
            ramp(direction, 1.1, false),
        ),
        (
            "small",
            &CUBIC,
            PERSPECTIVE,
            false,
            "",
            1.0,
            ramp(DVec3::X, 2.6, true),
        ),
        (
            "small",
            &STRETCHED,
            PERSPECTIVE,
            false,
            TABLE,
            4.0,
            ramp(DVec3::X, 2.6, false),
        ),
    ];
    for (name, block, camera, is_large, slots, step, shape) in cases {
        let case = Case {
            name,
            block,
            camera,
            clip: "volume",
            slots,
            step,
            shape,
        };
        if is_large {
            check(&case, large, large_source, 20);
        } else {
            check(&case, small, small_source, 20);
        }
    }
}

#[test]
fn a_clip_volume_laid_over_the_box_has_no_place_of_its_own() {
    // Half of its length is half of the box's.
    let (params, _) = ramp(DVec3::X, 1.5, true);
    let shape = planes(&STRETCHED, &[[1.0, 0.0, 0.0, 0.0]], true);
    let case = Case {
        name: "laid over",
        block: &STRETCHED,
        camera: PERSPECTIVE,
        clip: "volume",
        slots: TABLE,
        step: 1.0,
        shape: (format!(r#"{params}, "clip_volume_place": "box""#), shape.1),
    };
    let clip = |stage: Stage| stage.with_floats("c", [4, 3, 2], |x, _, _| x as f32);
    check(
        &case,
        clip,
        r#"path: "c_4x3x2_float32.raw", origin: (300, 0, 0)"#,
        60,
    );
}

#[test]
fn a_clip_volume_changes_neither_the_camera_nor_what_it_does_not_cut() {
    let clip = r#"path: "c_2x2x2_float32.raw", origin: (300, 0, 0)"#;
    let params = r#"{ "step": 0.7, "clip_isovalue": 0.5, "clip_isovalue_unit": "data" }"#;
    let with = |slots: &str, clip: &str| {
        scene(&CUBIC, PERSPECTIVE, slots, params, clip).with_floats("c", [2; 3], |_, _, _| 1.0)
    };
    let cut = with(r#"{ "clip": "volume" }"#, clip);
    let plain = Stage::new()
        .with_floats("v", [8, 6, 4], |_, _, _| 0.5)
        .with(
            "transfer.ron",
            "(points: [(at: 0.5, color: (1, 1, 1), opacity: 0.1)])",
        )
        .with(
            "graph.ron",
            graph(CUBIC.source, PERSPECTIVE, "{}", "{}", r#"{ "step": 0.7 }"#),
        );
    for backend in adapters() {
        let (cut, cut_view) = render(&cut, &[], &backend, [40, 32]);
        let (plain, plain_view) = render(&plain, &[], &backend, [40, 32]);
        assert_eq!(cut_view, plain_view, "the camera fits what rays start from");
        let worst = volgraph_measure::compare_without_flip(&cut, &plain)
            .unwrap()
            .max;
        // A part that goes on is 1e-4 voxels shorter than whole steps.
        assert!(worst.error < 1e-5, "{backend}: {worst:?}");
    }
}

#[test]
fn a_clip_volume_that_is_missing_or_asked_for_too_often_is_refused() {
    let refused = |slots: &str, params: &str, clip: &str| {
        let stage =
            scene(&CUBIC, PERSPECTIVE, slots, params, clip).with_floats("c", [2; 3], |_, _, _| 1.0);
        let findings = stage
            .open("graph.ron", &[], &adapters()[0], [8, 8])
            .err()
            .unwrap();
        findings
            .into_iter()
            .map(|finding| (finding.code, finding.message))
            .collect::<Vec<_>>()
    };
    let slots = r#"{ "clip": "volume" }"#;
    let missing = refused(slots, "{}", "");
    assert!(
        missing
            .iter()
            .any(|(code, message)| *code == "missing-input" && message.contains("`clip_volume`")),
        "{missing:?}"
    );
    let tiny = r#"path: "c_2x2x2_float32.raw", spacing: (1, 1, 0.001)"#;
    let often = refused(slots, r#"{ "clip_step": 0.1 }"#, tiny);
    assert!(
        often.iter().any(|(code, _)| *code == "too-many-segments"),
        "{often:?}"
    );
}
