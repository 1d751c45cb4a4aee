//! Bent rays against closed forms: Snell's law, Fresnel's equations, media with known paths, and no seam beside them.
//!
//! The background is a gradient from 0 to 1 over the picture's height, so that a pixel's colour is the place that its ray
//! has met: `place.y / 2 + 1 / 2`.

use std::f64::consts::PI;

use glam::DVec3;
use volgraph::{Picture, View};
use volgraph_picture::SaveOptions;
use volgraph_tests::{STAGES, Stage, adapters, graph, render};

use crate::glass::{Beyond, Shape, Solid};

/// A background whose colour is the place that it is met at.
const PLACES: &str =
    r#"{ "pattern": "gradient", "bottom": [0.0, 0.0, 0.0, 1.0], "top": [1.0, 1.0, 1.0, 1.0] }"#;
const CLEAR: &str = "(domain: data, color: (1, 1, 1), extinction: [(0, 0), (1, 0)])";
const GLASS: &str = r#"{ "technique": "refraction_surface" }"#;

/// The largest difference between the red of a picture and what a ray should show, and how many pixels were compared.
/// Left out are pixels where `truth` says nothing, and those of which it makes something else a thousandth of a pixel
/// beside: there f32 may take the other side of an edge.
fn worst(
    (picture, view): &(Picture, View),
    tolerance: f64,
    truth: impl Fn((DVec3, DVec3)) -> Option<f64>,
) -> (f64, usize) {
    let (mut worst, mut compared) = (0.0_f64, 0);
    for y in 0..picture.height {
        for x in 0..picture.width {
            let at = |dx: f64, dy: f64| truth(ray_at(view, f64::from(x) + dx, f64::from(y) + dy));
            let Some(expected) = at(0.5, 0.5) else {
                continue;
            };
            let is_steady = [(0.501, 0.5), (0.499, 0.5), (0.5, 0.501), (0.5, 0.499)]
                .into_iter()
                .all(|(dx, dy)| at(dx, dy).is_some_and(|near| (near - expected).abs() < tolerance));
            if is_steady {
                let seen = f64::from(picture.color[(y * picture.width + x) as usize][0]);
                worst = worst.max((seen - expected).abs());
                compared += 1;
            }
        }
    }
    (worst, compared)
}

/// The ray through a place of the picture in pixels.
fn ray_at(view: &View, x: f64, y: f64) -> (DVec3, DVec3) {
    let lens = view.lens();
    let plane = [
        (x / f64::from(view.size[0]) * 2.0 - 1.0) * lens.half_extent[0],
        (1.0 - y / f64::from(view.size[1]) * 2.0) * lens.half_extent[1],
    ];
    let camera = &view.camera;
    let aside = camera.right * plane[0] + camera.up * plane[1];
    if lens.is_orthographic {
        (camera.eye + aside, camera.forward)
    } else {
        (camera.eye, (camera.forward + aside).normalize())
    }
}

/// A volume of `dims` voxels, a camera, slots and params.
fn stage(
    dims: [u32; 3],
    value: impl Fn(u32, u32, u32) -> f32,
    camera: &str,
    slots: &str,
    params: &str,
    colors: &str,
) -> Stage {
    let path = format!(
        r#"path: "v_{}x{}x{}_float32.raw""#,
        dims[0], dims[1], dims[2]
    );
    Stage::new()
        .with_floats("v", dims, value)
        .with("transfer.ron", colors)
        .with("graph.ron", graph(&path, camera, PLACES, slots, params))
}

/// The box of a volume whose voxels are units.
fn box_of(dims: [u32; 3]) -> (DVec3, DVec3) {
    (
        DVec3::splat(-0.5),
        DVec3::from_array(dims.map(f64::from)) - 0.5,
    )
}

const SLAB: [u32; 3] = [33, 33, 17];
const SLAB_LOW: f64 = 3.7;
const SLAB_HIGH: f64 = 12.3;
const SLAB_PARAMS: &str = r#"{ "isovalue": 4.3, "isovalue_unit": "data", "solid": "below", "refractive_index": 1.5,
    "transmission_color": [1.0, 1.0, 1.0], "step": 0.7 }"#;

fn slab(camera: &str) -> Stage {
    let value = |_, _, z: u32| (f64::from(z) - 8.0).abs() as f32;
    stage(SLAB, value, camera, GLASS, SLAB_PARAMS, CLEAR)
}

#[test]
fn a_slab_of_glass_shifts_what_is_behind_by_snells_law() {
    let cameras = [
        "orbit(azimuth: 90, elevation: 40, projection: orthographic)",
        "orbit(azimuth: 80, elevation: 50, fov_y: 20)",
    ];
    for camera in cameras {
        let stage = slab(camera);
        for backend in adapters() {
            for form in STAGES {
                let drawn = render(
                    &stage,
                    &[&format!("image.stage={form}")],
                    &backend,
                    [48, 48],
                );
                let beyond = Beyond::new(&drawn.1, box_of(SLAB), 2.0);
                let truth = |(origin, direction): (DVec3, DVec3)| {
                    let down = -direction.z;
                    let (sine, refracted_sine) =
                        ((1.0 - down * down).sqrt(), (1.0 - down * down).sqrt() / 1.5);
                    let (angle, refracted) = (sine.asin(), refracted_sine.asin());
                    let thickness = SLAB_HIGH - SLAB_LOW;
                    // Parallel to what came in, d sin(a - b) / cos b aside of it.
                    let shift = thickness * (angle - refracted).sin() / refracted.cos();
                    let aside =
                        (direction.with_z(0.0) / sine * down - DVec3::Z * -sine).normalize();
                    let out = origin - aside * shift;
                    let enters = origin + direction * ((origin.z - SLAB_HIGH) / down);
                    let leaves = out + direction * ((origin.z - SLAB_LOW) / down);
                    let is_inside = |p: DVec3| p.x.min(p.y) > 0.0 && p.x.max(p.y) < 32.0;
                    if !is_inside(enters) || !is_inside(leaves) {
                        return None;
                    }
                    let share = crate::glass::reflectance(1.0, 1.5, down);
                    let mirrored = direction.with_z(down);
                    let inner = (leaves - enters).normalize();
                    // Fresnel's shares are equal on the way in and out.
                    Some(
                        share * beyond.color(enters, mirrored)
                            + (1.0 - share) * share * beyond.color(leaves, inner.with_z(-inner.z))
                            + (1.0 - share) * (1.0 - share) * beyond.color(out, direction),
                    )
                };
                // The field is linear, so hits and normals are exact: what is left is f32.
                let (error, compared) = worst(&drawn, 1e-2, truth);
                assert!(error < 2e-5, "{backend} {form} {camera}: {error}");
                assert!(compared > 300, "{camera}: {compared}");
                // The check itself must see a colour that is a thousandth off.
                let (off, _) = worst(&drawn, 1e-2, |ray| truth(ray).map(|color| color + 1e-3));
                assert!(off > 2e-5);
            }
        }
    }
}

#[test]
fn in_glass_rays_beyond_the_critical_angle_stay_inside() {
    // The whole box is solid, and the eye in it: four of its faces, or six, mirror again and again.
    let dims = [16, 20, 12];
    let params = r#"{ "isovalue": 0.5, "isovalue_unit": "data", "refractive_index": 1.5, "max_interfaces": 9,
        "transmission_color": [0.8, 1.0, 1.0], "step": 2.0 }"#;
    let camera = "look_at(eye: (5.0, 7.3, 4.1), target: (16.0, 11.0, 6.6), fov_y: 100)";
    let stage = stage(dims, |_, _, _| 1.0, camera, GLASS, params, CLEAR);
    let (low, high) = box_of(dims);
    let solid = Solid {
        shapes: Shape::block(low, high),
        index: 1.5,
        // Eight tenths after half of the smallest side.
        extinction: -(0.8_f64.ln()) / 6.0,
        max_interfaces: 9,
    };
    for backend in adapters() {
        for form in STAGES {
            let drawn = render(
                &stage,
                &[&format!("image.stage={form}")],
                &backend,
                [48, 48],
            );
            let beyond = Beyond::new(&drawn.1, (low, high), 2.0);
            let (error, compared) = worst(&drawn, 1e-2, |ray| Some(solid.color(ray, &beyond)));
            // Planes: hits and normals are exact, and the rounding of f32 grows with up to nine reflections.
            assert!(error < 2e-5, "{backend} {form}: {error}");
            assert!(compared > 1000, "{compared}");
            let mirrored = (0..48 * 48)
                .filter(|i| {
                    let ray = ray_at(&drawn.1, f64::from(i % 48) + 0.5, f64::from(i / 48) + 0.5);
                    solid.way(ray).interfaces > 1
                })
                .count();
            assert!(mirrored > 300, "{mirrored} rays are mirrored");
        }
    }
}

const BALL: [u32; 3] = [48; 3];
const BALL_CENTRE: f64 = 23.5;
const BALL_RADIUS: f64 = 17.0;
const BALL_PARAMS: &str = r#"{ "isovalue": 289.0, "isovalue_unit": "data", "solid": "below", "refractive_index": 1.4,
    "transmission_color": [0.7, 1.0, 1.0], "transmission_length": 0.5, "step": 0.5 }"#;

/// The square of the distance from the middle: differences give its gradient exactly, and the trilinear field is too
/// high by a quarter per axis at most, so that the ball is smaller by 0.75 / (2 · 17) = 0.022 voxels at most.
fn ball_value(x: u32, y: u32, z: u32) -> f32 {
    let p = DVec3::new(f64::from(x), f64::from(y), f64::from(z)) - BALL_CENTRE;
    p.length_squared() as f32
}

fn ball(more: Vec<Shape>) -> Solid {
    let mut shapes = more;
    shapes.push(Shape::Ball(DVec3::splat(BALL_CENTRE), BALL_RADIUS));
    Solid {
        shapes,
        index: 1.4,
        extinction: -(0.7_f64.ln()) / 12.0,
        max_interfaces: 12,
    }
}

#[test]
fn a_ball_of_glass_turns_rays_by_twice_the_difference_of_the_angles() {
    let solid = ball(Vec::new());
    // The tracer itself: a ray that passes the middle at b is turned by 2 (asin(b/R) - asin(b/(n R))).
    for b in [0.0, 3.0, 9.0, 15.0] {
        let ray = (DVec3::new(-80.0, BALL_CENTRE + b, BALL_CENTRE), DVec3::X);
        let (_, out) = solid.way(ray).ray;
        let turn = 2.0 * ((b / BALL_RADIUS).asin() - (b / BALL_RADIUS / 1.4).asin());
        assert!((out.y.atan2(out.x) + turn).abs() < 1e-12);
    }
    for camera in [
        "orbit(azimuth: 33, elevation: 21, fov_y: 30)",
        "orbit(azimuth: 33, elevation: 21, projection: orthographic)",
    ] {
        let stage = stage(BALL, ball_value, camera, GLASS, BALL_PARAMS, CLEAR);
        for backend in adapters() {
            for form in STAGES {
                let drawn = render(
                    &stage,
                    &[&format!("image.stage={form}")],
                    &backend,
                    [48, 48],
                );
                let beyond = Beyond::new(&drawn.1, box_of(BALL), 2.0);
                let (error, compared) = worst(&drawn, 1e-4, |ray| {
                    // Where rays meet the ball flatter than at 0.9 R, its error grows beyond all bounds; where the
                    // place changes by more than a tenth of the height in a pixel, so does what it makes of it.
                    (solid.way(ray).least_cosine > 0.44).then(|| solid.color(ray, &beyond))
                });
                // At 0.9 R the normal turns by 0.022 / (R cos 64°) = 0.003, and the ray by as much; the plane, seven
                // tenths of the picture high, is 4 R away: 0.003 · 68 / 60 of the height.
                assert!(error < 4e-3, "{backend} {form} {camera}: {error}");
                assert!(compared > 900, "{compared}");
            }
        }
    }
}

#[test]
fn glass_that_is_cut_is_refracted_at_the_cut() {
    let clip = r#"// Which part of the ray is visible: that below a plane across x + z.
#import "lib/volume.wgsl"

const CLIP_NORMAL = vec3f(0.8, 0.0, 0.6);

fn clip_height(ray: Ray, distance: f32) -> f32 {
    return dot(ray_world(ray, distance) - volume.centre, CLIP_NORMAL) - 4.0;
}

fn clip_next(ray: Ray) -> vec2f {
    let length = ray.far - ray.near;
    let height = clip_height(ray, 0.0);
    let rise = dot(ray.direction, CLIP_NORMAL);
    let cut = -height / select(rise, 1.0e-20, rise == 0.0);
    if rise > 0.0 {
        return vec2f(0.0, clamp(cut, 0.0, length));
    }
    return vec2f(clamp(cut, 0.0, length), length);
}

fn clip_normal(ray: Ray, distance: f32) -> vec3f {
    return CLIP_NORMAL * select(1.0, -1.0, dot(ray.direction, CLIP_NORMAL) > 0.0);
}
"#;
    let normal = DVec3::new(0.8, 0.0, 0.6);
    let solid = ball(vec![Shape::Half(
        DVec3::splat(BALL_CENTRE) + 4.0 * normal,
        normal,
    )]);
    // From the side of the cut, and from the other: rays come in through it, go out through it, or are mirrored in it.
    for camera in [
        "orbit(azimuth: 10, elevation: 50, fov_y: 30)",
        "orbit(azimuth: 190, elevation: -20, projection: orthographic)",
    ] {
        let slots = r#"{ "technique": "refraction_surface", "clip": "mine" }"#;
        let stage = stage(BALL, ball_value, camera, slots, BALL_PARAMS, CLEAR)
            .with("slot/clip/mine.wgsl", clip);
        for backend in adapters() {
            for form in STAGES {
                let drawn = render(
                    &stage,
                    &[&format!("image.stage={form}")],
                    &backend,
                    [48, 48],
                );
                let beyond = Beyond::new(&drawn.1, box_of(BALL), 2.0);
                let (error, compared) = worst(&drawn, 1e-4, |ray| {
                    (solid.way(ray).least_cosine > 0.44).then(|| solid.color(ray, &beyond))
                });
                // As the ball's; a ray that is mirrored in the cut has met the ball twice.
                assert!(error < 8e-3, "{backend} {form} {camera}: {error}");
                assert!(compared > 900, "{compared}");
            }
        }
    }
}

#[test]
fn glass_before_white_is_white() {
    // Whatever is mirrored and bent, and how often: shares add up to 1.
    let stage = Stage::new().with(
        "graph.ron",
        r#"(
    sources: { "volume": analytic(field: "gyroid", dims: (24, 24, 24), periods: 1.0) },
    camera: orbit(azimuth: 30, elevation: 20),
    nodes: {
        "white": (kind: "background", params: { "color": [1.0, 1.0, 1.0, 1.0] }),
        "box": (kind: "proxy_box", in: { "volume": "volume" }),
        "image": (kind: "raycast", in: { "volume": "volume", "rays": "box", "behind": "white" },
                  slots: { "technique": "refraction_surface" },
                  params: { "transmission_color": [1.0, 1.0, 1.0], "step": 1.0 }),
    },
    outputs: { "color": "image.color" },
)"#,
    );
    for backend in adapters() {
        let (picture, _) = render(&stage, &[], &backend, [48, 48]);
        let worst = picture
            .color
            .iter()
            .flatten()
            .map(|value| (value - 1.0).abs())
            .fold(0.0, f32::max);
        assert!(worst < 1e-5, "{backend}: {worst}");
    }
}

/// Exit place, y, of a ray through layers of index n(u), u = z / depth, from the top face to the bottom one: n sin a is
/// kept, and the way aside is the integral of tan a.
fn through_layers(
    (origin, direction): (DVec3, DVec3),
    depth: f64,
    index: impl Fn(f64) -> f64,
) -> (DVec3, DVec3) {
    let down = -direction.z;
    let enters = origin + direction * ((origin.z - depth) / down);
    let kept = index(1.0) * (1.0 - down * down).sqrt();
    let steps = 4000;
    let aside: f64 = (0..steps)
        .map(|i| {
            let n = index((f64::from(i) + 0.5) / f64::from(steps));
            kept / (n * n - kept * kept).sqrt() * depth / f64::from(steps)
        })
        .sum();
    let flat = direction.with_z(0.0).normalize();
    (enters + flat * aside - DVec3::Z * depth, direction)
}

fn layers(backend: &str, form: &str, step: f64) -> (f64, usize) {
    // Centre to centre the field is linear: u = z / 24. The outermost voxels, whose gradients are one-sided, bend nothing.
    let index = |u: f64| {
        let inner = (24.0 * u - 2.0) / 20.0;
        1.0 + 0.5 * (PI * inner.clamp(0.0, 1.0)).sin().powi(2)
    };
    let points: String = (0..=1024)
        .map(|i| f64::from(i) / 1024.0)
        .map(|u| format!("({u:?}, {:?}),", index(u)))
        .collect();
    let colors = format!(
        "(domain: data, color: (1, 1, 1), extinction: [(0, 0), (1, 0)], refraction: [{points}])"
    );
    let stage = Stage::new()
        .with_floats("v", [49, 49, 25], |_, _, z| z as f32 / 24.0)
        .with("transfer.ron", colors)
        .with(
            "graph.ron",
            graph(
                r#"path: "v_49x49x25_float32.raw", node_centred: true"#,
                "orbit(azimuth: 90, elevation: 45, projection: orthographic)",
                PLACES,
                // In f32: stored gradients are half floats.
                r#"{ "technique": "refraction", "gradient": "central" }"#,
                &format!(r#"{{ "step": {step:?} }}"#),
            ),
        );
    let drawn = render(&stage, &[&format!("image.stage={form}")], backend, [24, 24]);
    let sides = (DVec3::ZERO, DVec3::new(48.0, 48.0, 24.0));
    let beyond = Beyond::new(&drawn.1, sides, 2.0);
    worst(&drawn, 1e-1, |ray| {
        let (leaves, direction) = through_layers(ray, 24.0, index);
        let enters = ray.0 + ray.1 * ((ray.0.z - 24.0) / -ray.1.z);
        let is_inside = |p: DVec3| p.x.min(p.y) > 1.0 && p.x.max(p.y) < 47.0;
        (is_inside(enters) && is_inside(leaves)).then(|| beyond.color(leaves, direction))
    })
}

#[test]
fn through_layers_the_sine_times_the_index_is_kept_and_the_error_is_of_order_two() {
    for backend in adapters() {
        let steps = [2.0, 1.0, 0.5, 0.25];
        let errors = steps.map(|step| layers(&backend, "compute", step));
        assert!(errors[0].1 > 60, "{errors:?}");
        // The scheme's error falls with the square of the step.
        let logs: Vec<(f64, f64)> = steps
            .iter()
            .zip(errors)
            .map(|(step, (error, _))| (step.ln(), error.ln()))
            .collect();
        let mean = |f: fn(&(f64, f64)) -> f64| logs.iter().map(f).sum::<f64>() / 4.0;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let slope = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>()
            / logs.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>();
        assert!(slope > 1.8, "{backend}: order {slope}, {errors:?}");
        assert!(errors[3].0 < 1e-3, "{backend}: {errors:?}");
        let fragment = layers(&backend, "fragment", 0.25).0;
        assert!((fragment - errors[3].0).abs() < 1e-5);
    }
}

#[test]
fn in_a_parabolic_medium_rays_are_ellipses() {
    // n² = n0² - a² r²: with ds = n dσ, r'' = -a² r, so r(σ) = r0 cos aσ + n d / a sin aσ.
    let (n0, a) = (1.8, 0.05);
    let points: String = (0..=512)
        .map(|i| f64::from(i) * 896.0 / 512.0)
        .map(|square| format!("({square:?}, {:?}),", (n0 * n0 - a * a * square).sqrt()))
        .collect();
    let colors = format!(
        "(domain: data, color: (1, 1, 1), extinction: [(0, 0), (896, 0)], refraction: [{points}])"
    );
    // Corners of the box are at r² = 3 · 17² = 867, where n is still 1.04.
    let value = |x: u32, y: u32, z: u32| {
        (DVec3::new(f64::from(x), f64::from(y), f64::from(z)) - 17.0).length_squared() as f32
    };
    // The outermost voxels, whose gradients are one-sided, are cut off; the cut bends nothing.
    let clip = r#"// Which part of the ray is visible: a box in the middle.
#import "lib/volume.wgsl"

fn clip_next(ray: Ray) -> vec2f {
    let place = ray_world(ray, 0.0) - volume.centre;
    let slope = select(ray.direction, vec3f(1.0e-20), abs(ray.direction) < vec3f(1.0e-20));
    let first = min((-15.0 - place) / slope, (15.0 - place) / slope);
    let last = max((-15.0 - place) / slope, (15.0 - place) / slope);
    let start = max(max(max(first.x, first.y), first.z), 0.0);
    return vec2f(start, max(min(min(last.x, last.y), last.z), start));
}

fn clip_normal(ray: Ray, distance: f32) -> vec3f {
    return -ray.direction;
}
"#;
    for camera in [
        "orbit(azimuth: 33, elevation: 21, fov_y: 30)",
        "orbit(azimuth: 110, elevation: -35, projection: orthographic)",
    ] {
        let stage = Stage::new()
            .with("slot/clip/inner.wgsl", clip)
            .with_floats("v", [35, 35, 35], value)
            .with("transfer.ron", &colors)
            .with(
                "graph.ron",
                graph(
                    r#"path: "v_35x35x35_float32.raw", node_centred: true"#,
                    camera,
                    PLACES,
                    r#"{ "technique": "refraction", "clip": "inner" }"#,
                    r#"{ "step": 0.5 }"#,
                ),
            );
        let (low, high) = (DVec3::splat(2.0), DVec3::splat(32.0));
        for backend in adapters() {
            let drawn = render(&stage, &[], &backend, [32, 32]);
            let whole = (DVec3::ZERO, DVec3::splat(34.0));
            let beyond = Beyond::new(&drawn.1, whole, 2.0);
            let truth = |ray: (DVec3, DVec3)| {
                let Some((near, _)) = volgraph_tests::box_interval(ray, low, high) else {
                    return Some(beyond.color(ray.0, ray.1));
                };
                let r = ray.0 + ray.1 * near - 17.0;
                let v = ray.1 * (n0 * n0 - a * a * r.length_squared()).sqrt();
                let at = |sigma: f64| {
                    let (sine, cosine) = (a * sigma).sin_cos();
                    (r * cosine + v * (sine / a), v * cosine - r * (sine * a))
                };
                // The first way out of the box: in steps that no corner is shorter than, then halved.
                let is_out = |sigma: f64| at(sigma).0.abs().max_element() > 15.0;
                let mut high = 1e-3;
                while !is_out(high) {
                    high += 1e-2;
                }
                let mut low = (high - 1e-2).max(0.0);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if is_out(middle) {
                        high = middle;
                    } else {
                        low = middle;
                    }
                }
                let (place, momentum) = at(high);
                Some(beyond.color(place + 17.0, momentum.normalize()))
            };
            let (error, compared) = worst(&drawn, 1e-4, truth);
            // The trilinear square is too high by 0.75 at most, n too low by a² 0.75 / (2 n) < 1e-3: as much of the
            // direction, and of the height on a plane that is about as far as it is high.
            assert!(error < 1e-3, "{backend} {camera}: {error}");
            assert!(compared > 300, "{compared}");
        }
    }
}

#[test]
fn without_an_index_the_picture_is_that_of_straight_rays() {
    for (classify, light) in [("post", "phong"), ("preintegrated_2d", "unlit")] {
        let colors = "(domain: data, points: [(at: 0, color: (1, 0.2, 0), opacity: 0.0), (at: 30, color: (0, 0.5, 1), opacity: 0.2)]";
        let slots =
            format!(r#"{{ "technique": "dvr", "classify": "{classify}", "light": "{light}" }}"#);
        let value = |x: u32, y: u32, z: u32| ((x * 3 + y * 5 + z * 7) % 31) as f32;
        let camera = "orbit(azimuth: 33, elevation: 21, fov_y: 40)";
        let plain = stage([12; 3], value, camera, &slots, "{}", &format!("{colors})"));
        // Glass of one index everywhere bends nothing either.
        for index in ["", ", refraction: [(0, 1.5), (30, 1.5)]"] {
            let bent = stage(
                [12; 3],
                value,
                camera,
                &slots,
                "{}",
                &format!("{colors}{index})"),
            );
            for backend in adapters() {
                for form in STAGES {
                    let form = format!("image.stage={form}");
                    let straight = render(&plain, &[&form], &backend, [40, 40]).0;
                    let sets = [form.as_str(), "image.slots.technique=refraction"];
                    let refracted = render(&bent, &sets, &backend, [40, 40]).0;
                    let difference = |a: &[f32], b: &[f32]| {
                        a.iter()
                            .zip(b)
                            .map(|(a, b)| (a - b).abs())
                            .fold(0.0, f32::max)
                    };
                    let color = difference(
                        straight.color.as_flattened(),
                        refracted.color.as_flattened(),
                    );
                    let opacity = difference(
                        straight.opacity.as_ref().unwrap(),
                        refracted.opacity.as_ref().unwrap(),
                    );
                    assert!(
                        color <= 1e-5 && opacity <= 1e-5,
                        "{backend} {form} {color} {opacity}"
                    );
                }
            }
        }
    }
}

/// A technique that bends a ray in every segment, into the direction that it has.
const BENT_IN_PLACE: &str = r#"// What does a segment add to the pixel? Nothing, along rays that are bent into their own direction.
#import "lib/beyond.wgsl"

struct TechniqueState {
    segments: u32,
}

fn technique_begin(ray: Ray) -> TechniqueState {
    return TechniqueState(0u);
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    volume_bend_ray(ray, segment.start + segment.length, (*ray).direction);
    return false;
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    if ray.bends == 0u {
        return ray_nothing();
    }
    return RayResult(beyond_color(ray_world(ray, 0.0), ray.direction), RAY_NO_DEPTH);
}
"#;

/// The largest difference of two pictures, but for pixels where the second changes by more than `steep` to a neighbour.
fn seam(seen: &Picture, alone: &Picture, steep: f32) -> (f32, usize) {
    let width = seen.width as usize;
    let difference = |a: &[f32; 4], b: &[f32; 4]| {
        a.iter()
            .zip(b)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f32::max)
    };
    let (mut worst, mut compared) = (0.0_f32, 0);
    for i in width + 1..alone.color.len() - width - 1 {
        let is_even = [i - width, i - 1, i + 1, i + width]
            .into_iter()
            .all(|j| difference(&alone.color[i], &alone.color[j]) <= steep);
        if is_even {
            worst = worst.max(difference(&seen.color[i], &alone.color[i]));
            compared += 1;
        }
    }
    (worst, compared)
}

fn spots() -> Picture {
    let color = (0..64_u32)
        .map(|i| [i * 37 % 64, i * 11 % 64, i * 29 % 64, 63].map(|value| value as f32 / 63.0))
        .collect();
    Picture::from_color(8, 8, color).unwrap()
}

#[test]
fn bent_rays_see_the_background_without_a_seam() {
    // Patterns with parameters that are not the defaults: rays get them from the background.
    let patterns = [
        (
            r#"{ "pattern": "uniform", "color": [0.2, 0.3, 0.4, 0.5] }"#,
            1.0,
        ),
        (PLACES, 1.0),
        (
            r#"{ "pattern": "checker", "squares": 5.0, "color": [0.7, 0.1, 0.2, 1.0], "other_color": [0.0, 0.1, 0.2, 0.3] }"#,
            1e-3,
        ),
        (r#"{ "pattern": "image" }"#, 1.0),
    ];
    for camera in [
        "orbit(azimuth: 33, elevation: 21, fov_y: 50)",
        "orbit(azimuth: 33, elevation: 21, projection: orthographic)",
        // The eye in the volume.
        "look_at(eye: (3.2, 2.1, 4.4), target: (0.0, 1.0, 0.0), fov_y: 70)",
    ] {
        for (background, steep) in patterns {
            let is_image = background.contains("image");
            let mut text = graph(
                r#"path: "v_8x8x8_float32.raw""#,
                camera,
                background,
                r#"{ "technique": "in_place" }"#,
                "{}",
            )
            .replace(
                r#""color": "image.color""#,
                r#""color": "image.color", "alone": "background.color""#,
            );
            if is_image {
                text = text
                    .replace(
                        r#""colors": transfer"#,
                        r#""picture": image(path: "picture.png"), "colors": transfer"#,
                    )
                    .replace(
                        r#"(kind: "background","#,
                        r#"(kind: "background", in: { "image": "picture" },"#,
                    );
            }
            let stage = Stage::new()
                .with_floats("v", [8, 8, 8], |x, y, z| (x + y + z) as f32)
                .with("transfer.ron", CLEAR)
                .with("slot/technique/in_place.wgsl", BENT_IN_PLACE)
                .with("graph.ron", text);
            let _ = spots()
                .save(&stage.path().join("picture.png"), SaveOptions::default())
                .unwrap();
            for backend in adapters() {
                for form in STAGES {
                    let set = format!("image.stage={form}");
                    let mut session = stage
                        .open("graph.ron", &[&set], &backend, [60, 48])
                        .unwrap();
                    let (picture, _) = session.render().unwrap();
                    let alone = session.read("alone").unwrap();
                    // Places in f32, of which the image makes at most its contrast times its pixels: 8 over the height.
                    let (worst, compared) = seam(&picture, &alone, steep);
                    assert!(
                        worst < 1e-4,
                        "{backend} {form} {camera} {background}: {worst}"
                    );
                    assert!(compared > 500, "{compared}");
                }
            }
        }
    }
}

#[test]
fn bent_rays_see_the_picture_of_another_raycast_behind() {
    // Where the rays are bent into their own direction, what is seen is that picture itself, at the same pixel.
    let text = graph(
        r#"path: "v_8x8x8_float32.raw""#,
        "orbit(azimuth: 33, elevation: 21, fov_y: 50)",
        PLACES,
        r#"{ "light": "phong" }"#,
        "{}",
    )
    .replace(
        r#"outputs: { "color": "image.color""#,
        r#"outputs: { "color": "front.color", "alone": "image.color""#,
    )
    .replace(
        r#""image": (kind"#,
        r#""front": (kind: "raycast", in: { "volume": "volume", "rays": "box", "behind": "image" },
                   slots: { "technique": "in_place" }),
        "image": (kind"#,
    );
    let stage = Stage::new()
        .with_floats("v", [8, 8, 8], |x, y, z| (x + y + z) as f32)
        .with(
            "transfer.ron",
            "(domain: data, color: [(0, (1, 0, 0)), (21, (0, 1, 1))], opacity: [(0, 0), (21, 0.9)])",
        )
        .with("slot/technique/in_place.wgsl", BENT_IN_PLACE)
        .with("graph.ron", text);
    for backend in adapters() {
        let mut session = stage.open("graph.ron", &[], &backend, [48, 48]).unwrap();
        let (picture, _) = session.render().unwrap();
        let alone = session.read("alone").unwrap();
        // Linear between pixels: as much of a neighbour as places are rounded.
        let (worst, compared) = seam(&picture, &alone, 1.0);
        assert!(worst < 2e-5, "{backend}: {worst}");
        assert!(compared > 2000);
    }
}

#[test]
fn only_techniques_that_bend_rays_bind_what_they_need() {
    let text = graph(
        r#"path: "v_8x8x8_float32.raw""#,
        "orbit(azimuth: 33, elevation: 21)",
        r#"{ "pattern": "image" }"#,
        "{}",
        "{}",
    )
    .replace(
        r#""colors": transfer"#,
        r#""picture": image(path: "picture.png"), "colors": transfer"#,
    )
    .replace(
        r#"(kind: "background","#,
        r#"(kind: "background", in: { "image": "picture" },"#,
    );
    let stage = Stage::new()
        .with_floats("v", [8, 8, 8], |x, _, _| x as f32)
        .with("transfer.ron", CLEAR)
        .with("graph.ron", text);
    let _ = spots()
        .save(&stage.path().join("picture.png"), SaveOptions::default())
        .unwrap();
    let bound = |technique: &str| {
        let set = format!("image.slots.technique={technique}");
        let plan = crate::plans::plan(&stage, &[&set]);
        let nodes = plan.nodes();
        let image = nodes.iter().find(|node| node.name == "image").unwrap();
        let bindings: Vec<String> = image.entries["raycast_compute"]
            .iter()
            .map(|binding| binding.name.clone())
            .collect();
        let has = |name: &str| bindings.iter().any(|binding| binding == name);
        (
            has("image_texture"),
            has("refraction_table"),
            nodes
                .iter()
                .any(|node| node.name.contains("refraction_table")),
            // One texture for both.
            nodes
                .iter()
                .filter(|node| node.name.contains("image_texture"))
                .count(),
        )
    };
    assert_eq!(bound("dvr"), (false, false, false, 1));
    assert_eq!(bound("isosurface"), (false, false, false, 1));
    assert_eq!(bound("refraction"), (true, true, true, 1));
    assert_eq!(bound("refraction_surface"), (true, false, false, 1));
}
