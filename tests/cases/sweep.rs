//! Each technique under each clip, in each projection and stage, over cubes and over voxels of 1 : 2 : 5: what must hold
//! of every picture, whoever wrote the technique.
//!
//! No value is infinite or not a number; pixels beside the box show the background, bit for bit; something is seen;
//! fragment and compute agree; and the mirrored scene gives the mirrored picture. Techniques and clips are those that lie
//! in `shaders/slot`, so that a new one is swept as soon as it is there.

use glam::DVec3;
use volgraph::{Picture, Session};
use volgraph_graph::read::camera_text;
use volgraph_tests::repository::choices;
use volgraph_tests::{STAGES, Stage, adapters, box_interval, ray};

const SIZE: [u32; 2] = [64, 64];
const DIMS: [u32; 3] = [14, 11, 9];
const SPACINGS: [DVec3; 2] = [DVec3::ONE, DVec3::new(1.0, 2.0, 5.0)];

/// Scalars 0 to 1, with no symmetry; highest inside, so that most techniques see something from everywhere.
fn field(at: DVec3) -> f64 {
    let blob = |centre: DVec3, width: f64| (-at.distance_squared(centre) / width).exp();
    let sum = blob(DVec3::new(0.35, 0.4, 0.5), 0.06)
        + 0.8 * blob(DVec3::new(0.7, 0.6, 0.35), 0.03)
        + 0.15 * at.x
        + 0.05 * at.z;
    sum.min(1.0)
}

/// Above one half in two thirds of the box, with a surface that is aslant. Its grid is fine, for two crossings within one
/// of its voxels may be lost, and by rounding in one of two mirrored pictures alone.
fn clip_field(at: DVec3) -> f64 {
    (0.5 + 1.2 * (at.x * 0.8 + at.y * 0.5 - at.z * 0.3 - 0.3)).clamp(0.0, 1.0)
}

/// Shares of the box of a voxel's centre, mirrored in x or not.
fn share(dims: [u32; 3], [x, y, z]: [u32; 3], is_mirrored: bool) -> DVec3 {
    let x = if is_mirrored { dims[0] - 1 - x } else { x };
    (DVec3::new(f64::from(x), f64::from(y), f64::from(z)) + 0.5)
        / DVec3::from_array(dims.map(f64::from))
}

/// The parameters that the clips of `shaders/slot/clip` need to cut something here; `sign` is -1 in the mirror.
fn clip_params(clip: &str, is_mirrored: bool) -> String {
    let sign = if is_mirrored { -1.0 } else { 1.0 };
    let box_x = if is_mirrored {
        (0.25, 1.0)
    } else {
        (0.0, 0.75)
    };
    match clip {
        "planes" => format!(
            r#""planes": 2, "plane_1": [{sign:?}, 0.4, 0.2, -0.1], "plane_2": [0.0, -1.0, 0.5, -0.6]"#
        ),
        "box" => format!(
            r#""clip_low": [{:?}, 0.1, 0.0], "clip_high": [{:?}, 0.9, 0.8]"#,
            box_x.0, box_x.1
        ),
        "sphere" => format!(
            r#""clip_centre": [{:?}, 0.1, -0.2], "clip_radius": 1.1"#,
            0.2 * sign
        ),
        "volume" => r#""clip_volume_place": "box""#.to_owned(),
        _ => String::new(),
    }
}

fn scene(technique: &str, clip: &str, spacing: DVec3, is_mirrored: bool) -> Stage {
    let clip_volume = if clip == "volume" {
        r#""clip_volume": "c", "#
    } else {
        ""
    };
    let DVec3 { x, y, z } = spacing;
    let text = format!(
        r#"(
    sources: {{ "v": volume(path: "v_14x11x9_float32.raw", spacing: ({x:?}, {y:?}, {z:?})),
                "c": volume(path: "c_21x27x24_float32.raw"),
                "t": transfer(path: "t.ron") }},
    nodes: {{
        "background": (kind: "background", params: {{ "pattern": "gradient", "bottom": [0.1, 0.2, 0.3, 1.0] }}),
        "box": (kind: "proxy_box", in: {{ "volume": "v" }}),
        "image": (kind: "raycast",
                  in: {{ "volume": "v", "transfer": "t", {clip_volume}"rays": "box", "behind": "background" }},
                  slots: {{ "technique": "{technique}", "clip": "{clip}", "light": "phong" }},
                  params: {{ {} }}),
    }},
    outputs: {{ "color": "image.color", "alone": "background.color" }},
)"#,
        clip_params(clip, is_mirrored)
    );
    let dims = DIMS;
    Stage::new()
        .with_floats("v", dims, |x, y, z| field(share(dims, [x, y, z], is_mirrored)) as f32)
        .with_floats("c", [21, 27, 24], |x, y, z| {
            clip_field(share([21, 27, 24], [x, y, z], is_mirrored)) as f32
        })
        .with(
            "t.ron",
            "(points: [(at: 0.1, color: (0.9, 0.4, 0.1), opacity: 0), (at: 0.4, color: (0.2, 0.6, 0.9), opacity: 0.2),
                       (at: 0.9, color: (1, 0.9, 0.7), opacity: 0.8)])",
        )
        .with("graph.ron", text)
}

/// The cameras: perspective, orthographic, inside of the box; with the eye's x mirrored or not.
fn cameras(spacing: DVec3, is_mirrored: bool) -> [String; 3] {
    let size = spacing * DVec3::from_array(DIMS.map(f64::from));
    let middle = 0.5 * (size - spacing);
    let look = |from: DVec3, rest: &str| {
        let mut from = from * size;
        if is_mirrored {
            from.x = -from.x;
        }
        let (eye, to) = (middle + from, middle);
        format!(
            "look_at(eye: ({:?}, {:?}, {:?}), target: ({:?}, {:?}, {:?}), {rest})",
            eye.x, eye.y, eye.z, to.x, to.y, to.z
        )
    };
    let height = 1.2 * size.max_element();
    [
        look(DVec3::new(1.1, -2.3, 0.9), "fov_y: 40"),
        look(
            DVec3::new(-1.3, -1.6, 0.7),
            &format!("projection: orthographic, height: {height:?}"),
        ),
        look(DVec3::new(0.31, -0.27, 0.22), "fov_y: 70"),
    ]
}

/// What holds of one picture by itself.
fn check_alone(what: &str, picture: &Picture, session: &Session, spacing: DVec3) -> bool {
    let alone = session.read("alone").unwrap();
    let (low, high) = (
        -0.5 * spacing,
        spacing * (DVec3::from_array(DIMS.map(f64::from)) - 0.5),
    );
    let mut is_seen = false;
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let at = (y * SIZE[0] + x) as usize;
            let color = picture.color[at];
            assert!(
                color.iter().all(|value| value.is_finite()),
                "{what}: {color:?} at {x}, {y}"
            );
            // A rounding wider, so that pixels on the outline may be either.
            let margin = 1e-4 * (high - low);
            if box_interval(ray(session.view(), x, y), low - margin, high + margin).is_none() {
                assert_eq!(color, alone.color[at], "{what}: beside the box at {x}, {y}");
            } else {
                is_seen |= color != alone.color[at];
            }
        }
    }
    is_seen
}

/// The pixels whose colours differ by more than `bound`; `flip` looks at the second picture in the mirror.
fn differing(a: &Picture, b: &Picture, flip: bool, bound: f32) -> (usize, f32) {
    let (mut count, mut worst) = (0, 0.0_f32);
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let other = if flip { SIZE[0] - 1 - x } else { x };
            let [a, b] = [a.pixel(x, y).unwrap(), b.pixel(other, y).unwrap()];
            let error = a
                .iter()
                .zip(b)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f32::max);
            worst = worst.max(error);
            count += usize::from(error > bound);
        }
    }
    (count, worst)
}

/// The pictures of all cameras.
fn pictures(
    stage: &Stage,
    backend: &str,
    form: &str,
    spacing: DVec3,
    is_mirrored: bool,
    what: &str,
) -> Vec<Picture> {
    let set = format!("image.stage={form}");
    let mut session = stage
        .open("graph.ron", &[&set], backend, SIZE)
        .unwrap_or_else(|findings| panic!("{what}: {findings}"));
    let cameras = cameras(spacing, is_mirrored);
    let mut seen = 0;
    let pictures = cameras
        .iter()
        .map(|camera| {
            session.set_camera(&camera_text("camera".as_ref(), camera).unwrap());
            let (picture, report) = session
                .render()
                .unwrap_or_else(|findings| panic!("{what}: {findings}"));
            assert!(report.hazards.is_empty(), "{what}: {:?}", report.hazards);
            seen += u32::from(check_alone(
                &format!("{what} {camera}"),
                &picture,
                &session,
                spacing,
            ));
            picture
        })
        .collect();
    assert!(seen >= 2, "{what}: nothing is seen");
    pictures
}

fn sweep(clip: &str) {
    let backends = adapters();
    for technique in choices("technique") {
        // Each spacing on another backend, where there are several.
        for (spacing, backend) in SPACINGS.into_iter().zip(backends.iter().cycle()) {
            let what = format!("{technique}, clip {clip}, spacing {spacing}");
            let stage = scene(&technique, clip, spacing, false);
            let [fragment, compute] = STAGES.map(|form| {
                pictures(
                    &stage,
                    backend,
                    form,
                    spacing,
                    false,
                    &format!("{what}, {form}"),
                )
            });
            for (camera, (a, b)) in fragment.iter().zip(&compute).enumerate() {
                let (count, worst) = differing(a, b, false, 1e-4);
                assert!(
                    count == 0,
                    "{what}, camera {camera}: the stages differ in {count} pixels, by {worst}"
                );
            }
            let mirror = scene(&technique, clip, spacing, true);
            let mirrored = pictures(
                &mirror,
                backend,
                "compute",
                spacing,
                true,
                &format!("{what}, mirrored"),
            );
            for (camera, (a, b)) in compute.iter().zip(&mirrored).enumerate() {
                // Rounding moves edges: a ray that grazes a surface, or a cut, may meet it on one side only.
                let (count, worst) = differing(a, b, true, 2e-3);
                assert!(
                    count <= 12,
                    "{what}, camera {camera}: {count} pixels of the mirrored picture differ, by {worst}"
                );
            }
        }
    }
}

#[test]
fn techniques_without_a_clip() {
    sweep("none");
}

#[test]
fn techniques_under_planes() {
    sweep("planes");
}

#[test]
fn techniques_in_a_box() {
    sweep("box");
}

#[test]
fn techniques_in_a_sphere() {
    sweep("sphere");
}

#[test]
fn techniques_in_a_clip_volume() {
    sweep("volume");
}

#[test]
fn every_clip_is_swept() {
    assert_eq!(
        choices("clip"),
        ["box", "none", "planes", "sphere", "volume"]
    );
}
