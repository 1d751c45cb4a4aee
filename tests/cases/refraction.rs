//! Solids of glass against closed forms: Snell's law, Fresnel's equations, total reflection, cuts.
//!
//! The background is a gradient from 0 to 1 over the picture's height, so that a pixel's colour is the place that its ray
//! has met: `place.y / 2 + 1 / 2`.

use glam::DVec3;
use volgraph::{Picture, View};
use volgraph_tests::{STAGES, Stage, adapters, graph, render};

use crate::glass::{Beyond, Shape, Solid};

/// A background whose colour is the place that it is met at.
pub const PLACES: &str =
    r#"{ "pattern": "gradient", "bottom": [0.0, 0.0, 0.0, 1.0], "top": [1.0, 1.0, 1.0, 1.0] }"#;
pub const CLEAR: &str = "(domain: data, color: (1, 1, 1), extinction: [(0, 0), (1, 0)])";
const GLASS: &str = r#"{ "technique": "refraction_surface" }"#;

/// The largest difference between the red of a picture and what a ray should show, and how many pixels were compared.
/// Left out are pixels where `truth` says nothing, and those of which it makes something else a thousandth of a pixel
/// beside: there f32 may take the other side of an edge.
pub fn worst(
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
pub fn stage(
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
