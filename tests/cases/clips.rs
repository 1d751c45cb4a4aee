//! Clip shapes against closed forms: what is left of a constant volume absorbs by its length, at any step.
//!
//! How pictures depend on the step is in `pictures`, how cuts are lit in `faces`.

mod faces;
mod pictures;
mod shapes;
mod volumes;

use glam::DVec3;
use volgraph_tests::{STAGES, Stage, adapters, box_interval, graph, ray, render};

const PERSPECTIVE: &str = "orbit(azimuth: 33, elevation: 21, fov_y: 40)";
const ORTHOGRAPHIC: &str = "orbit(azimuth: 33, elevation: 21, projection: orthographic)";
const ALONG_Y: &str = "orbit(azimuth: 0, elevation: 0, projection: orthographic)";
const INSIDE: &str = "look_at(eye: (6.2, 1.1, 1.4), target: (0.0, 3.0, 0.5), fov_y: 80)";

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
            let name = format!("{} {} {}", case.name, case.camera, case.step);
            assert!(error <= BOUND, "{name} {backend} {form}: {error}");
            assert!(
                cut >= least,
                "{name} {backend} {form}: {cut} pixels are cut"
            );
        }
    }
}

const TABLE: &str = r#", "classify": "preintegrated_2d""#;
