//! Hard shadows of isosurfaces against geometry: where a light must arrive, where it must not, and no pixel between.

use glam::DVec3;
use volgraph::{Picture, View};
use volgraph_tests::{STAGES, Stage, adapters, box_interval, graph, ray, render};

/// White, and nothing but what lights give.
pub const WHITE: &str = r#""surface_color": [1, 1, 1], "ambient": 0, "diffuse": 1, "specular": 0"#;

/// A stage with an isosurface at 0 of the volume at `volume`.
pub fn surface(stage: Stage, volume: &str, camera: &str, slots: &str, params: &str) -> Stage {
    let slots = format!(r#"{{ "technique": "isosurface", "light": "phong", {slots} }}"#);
    let params = format!(r#"{{ {WHITE}, "isovalue": 0, "isovalue_unit": "data", {params} }}"#);
    stage
        .with(
            "transfer.ron",
            "(points: [(at: 0.5, color: (1, 1, 1), opacity: 0.1)])",
        )
        .with("graph.ron", graph(volume, camera, "{}", &slots, &params))
}

/// The red of all pixels with their rays.
pub fn pixels(drawn: &(Picture, View)) -> impl Iterator<Item = ((DVec3, DVec3), f64)> {
    let (picture, view) = drawn;
    (0..picture.height * picture.width).map(move |index| {
        let value = f64::from(picture.color[index as usize][0]);
        (
            ray(view, index % picture.width, index / picture.width),
            value,
        )
    })
}

struct Ball {
    centre: DVec3,
    radius: f64,
}

impl Ball {
    /// The distance to where a ray enters, and how near to the centre it comes.
    fn hit(&self, (origin, direction): (DVec3, DVec3)) -> (Option<f64>, f64) {
        let along = (self.centre - origin).dot(direction);
        let beside = (origin + along * direction - self.centre).length();
        let half = self.radius * self.radius - beside * beside;
        (
            (half > 0.0 && along > 0.0).then(|| along - half.sqrt()),
            beside,
        )
    }
}

const LARGE: Ball = Ball {
    centre: DVec3::new(21.3, 22.1, 15.2),
    radius: 12.0,
};
const SMALL: Ball = Ball {
    centre: DVec3::new(21.8, 19.7, 35.4),
    radius: 6.0,
};
const ABOVE: DVec3 = DVec3::new(0.25, -0.15, 1.0);
const LOOK: &str =
    "look_at(eye: (44, -30, 52), target: (21.5, 21.5, 20), projection: orthographic, height: 42)";

fn balls(slots: &str, params: &str) -> Stage {
    let stage = Stage::new().with_floats("v", [44, 44, 46], |x, y, z| {
        let at = DVec3::new(x.into(), y.into(), z.into());
        let inside = |ball: &Ball| ball.radius - at.distance(ball.centre);
        #[expect(clippy::cast_possible_truncation, reason = "the file holds f32")]
        let value = inside(&LARGE).max(inside(&SMALL)) as f32;
        value
    });
    let params = format!(
        r#""light_1": [{}, {}, {}, 0], {params}"#,
        ABOVE.x, ABOVE.y, ABOVE.z
    );
    surface(
        stage,
        r#"path: "v_44x44x46_float32.raw""#,
        LOOK,
        slots,
        &params,
    )
}

/// Pixels that are lit though no light can arrive, dark though it must, and those that are lit and dark as they have to
/// be. Left out are those nearer to an edge of shadow or outline than theory lets the surface be off.
fn ball_shadows(drawn: &(Picture, View), has_small: bool, step: f64) -> [usize; 4] {
    let light = ABOVE.normalize();
    let mut counts = [0; 4];
    for (ray, value) in pixels(drawn) {
        let (large, beside_large) = LARGE.hit(ray);
        let (small, beside_small) = if has_small {
            SMALL.hit(ray)
        } else {
            (None, f64::INFINITY)
        };
        let is_outline = |ball: &Ball, beside: f64| (beside - ball.radius).abs() < 0.3;
        if is_outline(&LARGE, beside_large) || is_outline(&SMALL, beside_small) {
            continue;
        }
        let (Some(distance), ball, other) = (match (large, small) {
            (Some(a), Some(b)) if b < a => (small, &SMALL, &LARGE),
            (Some(_), _) => (large, &LARGE, &SMALL),
            _ => (small, &SMALL, &LARGE),
        }) else {
            continue;
        };
        let point = ray.0 + distance * ray.1;
        let normal = (point - ball.centre) / ball.radius;
        // Trilinear interpolation with spacing 1 of a distance, whose second derivatives are 1/R across it, is off by at
        // most 1/(4R), and its slopes by 1/(√2 R). A walk in steps of s, linear in each, is off by at most s²/(8R), and does
        // not see balls that are entered by less. Both are more along a ray that is slanted to the surface; the normal
        // turns by as much, over R.
        let off = |ball: &Ball, step: f64| (0.25 + step * step / 8.0) / ball.radius;
        let facing = normal.dot(light);
        let off_start = off(ball, step) / normal.dot(ray.1).abs();
        if facing.abs() < (0.5_f64.sqrt() + off_start) / ball.radius {
            continue;
        }
        let margin = off(other, 1.0) + off_start;
        let (_, beside) = other.hit((point, light));
        let is_before =
            (has_small || std::ptr::eq(other, &LARGE)) && (other.centre - point).dot(light) > 0.0;
        let is_lit = if facing < 0.0 || is_before && beside < other.radius - margin {
            false
        } else if !is_before || beside > other.radius + margin {
            true
        } else {
            continue;
        };
        let kind = match (is_lit, value > 0.0) {
            (false, true) => 0,
            (true, false) => 1,
            (true, true) => 2,
            (false, false) => 3,
        };
        counts[kind] += 1;
    }
    counts
}

#[test]
fn a_ball_casts_its_shadow_on_a_ball() {
    let stage = balls(r#""shadow": "surface""#, r#""step": 1"#);
    for backend in adapters() {
        for form in STAGES {
            let set = format!("image.stage={form}");
            let drawn = render(&stage, &[&set], &backend, [96, 96]);
            let [lit, dark, right_lit, right_dark] = ball_shadows(&drawn, true, 1.0);
            assert_eq!((lit, dark), (0, 0), "{backend} {form}: lit, dark");
            assert!(
                right_lit > 1500 && right_dark > 400,
                "{right_lit} {right_dark}"
            );
        }
        // The eye's coarse steps leave their points beside the surface; their shadows start on it all the same.
        let drawn = render(&stage, &["image.step=3"], &backend, [96, 96]);
        let [lit, dark, right_lit, right_dark] = ball_shadows(&drawn, true, 3.0);
        assert_eq!((lit, dark), (0, 0), "{backend}, coarse: lit, dark");
        assert!(
            right_lit > 1000 && right_dark > 250,
            "{right_lit} {right_dark}"
        );
        // The check sees that there is no shadow.
        let drawn = render(&stage, &["image.slots.shadow=none"], &backend, [96, 96]);
        assert!(ball_shadows(&drawn, true, 1.0)[0] > 200, "{backend}");
    }
}

/// A slot `clip` of which visible is what is below a level of world z.
pub fn clip_below(level: f64) -> String {
    format!(
        "// Which part of the ray is visible: what is below a level.
#import \"lib/volume.wgsl\"
fn clip_next(ray: Ray) -> vec2f {{
    let length = ray.far - ray.near;
    let level = ({level:?} + 0.5) / volume.dims.z;
    let crossing = (level - ray.entry.z) / select(ray.slope.z, 1.0e-20, ray.slope.z == 0.0);
    if ray.entry.z < level {{
        return vec2f(0.0, select(length, min(crossing, length), ray.slope.z > 0.0));
    }}
    return select(vec2f(0.0), vec2f(crossing, length), ray.slope.z < 0.0 && crossing < length);
}}
fn clip_normal(ray: Ray, distance: f32) -> vec3f {{
    return vec3f(0.0, 0.0, 1.0);
}}
"
    )
}

#[test]
fn what_is_clipped_away_casts_no_shadow_and_a_cut_does() {
    // Visible is what is below world z = 28.2, beside which the small ball lies; and what is below 33, which cuts it.
    let slots = r#""shadow": "surface", "clip": "mine""#;
    let stage = balls(slots, r#""step": 1"#);
    for backend in adapters() {
        stage.write("slot/clip/mine.wgsl", clip_below(28.2));
        let drawn = render(&stage, &[], &backend, [64, 64]);
        let [lit, dark, right_lit, _] = ball_shadows(&drawn, false, 1.0);
        assert_eq!((lit, dark), (0, 0), "{backend}: the small ball is away");
        assert!(right_lit > 700, "{right_lit}");
        // Half of the small ball is as wide as all of it; its face is lit, and its shadow is there but for what the
        // upper half alone would shade: nothing, as the light is steeper than its equator's edge is wide.
        stage.write("slot/clip/mine.wgsl", clip_below(SMALL.centre.z));
        let drawn = render(&stage, &[], &backend, [64, 64]);
        let light = ABOVE.normalize();
        let (mut face, mut shaded) = (0, 0);
        for (ray, value) in pixels(&drawn) {
            let along = (SMALL.centre.z - ray.0.z) / ray.1.z;
            let point = ray.0 + along * ray.1;
            if point.distance(SMALL.centre) < SMALL.radius - 0.1 {
                assert!(
                    (value - light.z).abs() < 1e-3,
                    "{backend}: the face is lit by {value}"
                );
                face += 1;
            }
            let (Some(distance), beside) = LARGE.hit(ray) else {
                continue;
            };
            let point = ray.0 + distance * ray.1;
            let (_, under) = SMALL.hit((point, light));
            let (_, seen) = SMALL.hit(ray);
            if beside < 11.5 && seen > 6.3 && under < 5.5 && (point - LARGE.centre).dot(light) > 1.0
            {
                assert!(
                    value == 0.0,
                    "{backend}: {value} in the shadow of the lower half"
                );
                shaded += 1;
            }
        }
        assert!(face > 30 && shaded > 30, "{face} {shaded}");
    }
}

/// The large ball's upper part is cut away, and the lower half of the small one: below a face, above a face.
#[test]
fn a_face_casts_its_shadow_on_a_face() {
    let (low, high) = (20.0, SMALL.centre.z);
    let clip = format!(
        "// Which part of the ray is visible: what is not between two levels.
#import \"lib/volume.wgsl\"
fn clip_next(ray: Ray) -> vec2f {{
    let length = ray.far - ray.near;
    let levels = (vec2f({low:?}, {high:?}) + 0.5) / volume.dims.z;
    let to = (levels - ray.entry.z) / select(ray.slope.z, 1.0e-20, ray.slope.z == 0.0);
    let first = select(levels, levels.yx, ray.slope.z < 0.0);
    let near = min(to.x, to.y);
    let far = max(to.x, to.y);
    if (first.x - ray.entry.z) * sign(ray.slope.z) > 0.0 {{
        return vec2f(0.0, min(near, length));
    }}
    return select(vec2f(0.0), vec2f(max(far, 0.0), length), far < length);
}}
fn clip_normal(ray: Ray, distance: f32) -> vec3f {{
    return vec3f(0.0, 0.0, -sign(ray.slope.z));
}}
"
    );
    let slots = r#""shadow": "surface", "clip": "mine""#;
    let stage = balls(slots, r#""step": 1"#).with("slot/clip/mine.wgsl", clip);
    let light = ABOVE.normalize();
    // The circle of the large ball's face.
    let wide = (LARGE.radius * LARGE.radius - (low - LARGE.centre.z).powi(2)).sqrt();
    for backend in adapters() {
        let drawn = render(&stage, &[], &backend, [64, 64]);
        let (mut lit, mut dark) = (0, 0);
        for (ray, value) in pixels(&drawn) {
            let point = ray.0 + (low - ray.0.z) / ray.1.z * ray.1;
            let is_face = (point - LARGE.centre).truncate().length() < wide - 0.2;
            let (_, hides) = SMALL.hit(ray);
            if !is_face || hides < SMALL.radius + 0.3 {
                continue;
            }
            // The way to the light goes through the upper half, or beside the whole ball.
            let through = point + (high - point.z) / light.z * light;
            let (_, beside) = SMALL.hit((point, light));
            if through.distance(SMALL.centre) < SMALL.radius - 0.3 {
                dark += 1;
                assert!(value == 0.0, "{backend}: {value} at {point}");
            } else if beside > SMALL.radius + 0.3 {
                lit += 1;
                assert!(
                    (value - light.z).abs() < 1e-3,
                    "{backend}: {value} at {point}"
                );
            }
        }
        assert!(lit > 100 && dark > 20, "{lit} {dark}");
    }
}

/// Planes are trilinear exactly: at the least angle no point may be in the shadow of its own surface.
#[test]
fn a_plane_lit_at_a_grazing_angle_has_no_dark_point() {
    let orientations = [
        DVec3::Z,
        DVec3::new(0.3, -0.2, 0.93),
        DVec3::new(1.0, 2.0, 2.0),
        DVec3::new(-0.6, 0.48, 0.64),
    ];
    for (turn, normal) in orientations.into_iter().enumerate() {
        let normal = normal.normalize();
        let centre = DVec3::splat(15.63);
        let stage = Stage::new().with_floats("v", [32, 32, 32], |x, y, z| {
            let at = DVec3::new(x.into(), y.into(), z.into());
            #[expect(clippy::cast_possible_truncation, reason = "the file holds f32")]
            let value = normal.dot(centre - at) as f32;
            value
        });
        let across = normal.any_orthonormal_vector();
        let eye = centre + 60.0 * (normal + 0.4 * across);
        let camera = format!(
            "look_at(eye: ({}, {}, {}), target: (15.6, 15.6, 15.6), up: ({}, {}, {}), projection: orthographic, height: 40)",
            eye.x, eye.y, eye.z, across.x, across.y, across.z
        );
        let volume = r#"path: "v_32x32x32_float32.raw", node_centred: true"#;
        // In the shader: stored gradients are halves, and their rounding alone turns a normal by more than the angle.
        let slots = r#""shadow": "surface", "gradient": "central""#;
        let stage = surface(stage, volume, &camera, slots, r#""step": 1"#);
        for backend in adapters() {
            for degrees in [0.5_f64, 0.1] {
                let azimuth = 0.7 + 1.3 * f64::from(u32::try_from(turn).unwrap());
                let along =
                    azimuth.cos() * across + azimuth.sin() * normal.cross(across).normalize();
                let light =
                    degrees.to_radians().sin() * normal + degrees.to_radians().cos() * along;
                let set = format!("image.light_1=[{}, {}, {}, 0]", light.x, light.y, light.z);
                let drawn = render(&stage, &[&set], &backend, [40, 40]);
                let mut seen = 0;
                for (ray, value) in pixels(&drawn) {
                    let Some((near, far)) = box_interval(ray, DVec3::ZERO, DVec3::splat(31.0))
                    else {
                        continue;
                    };
                    let distance = normal.dot(centre - ray.0) / normal.dot(ray.1);
                    let point = ray.0 + distance * ray.1;
                    // Where the box clamps, differences are no longer the plane's.
                    let is_inner = (point - 15.5).abs().max_element() < 14.0;
                    if near < distance && distance < far && is_inner {
                        seen += 1;
                        assert!(
                            value > 0.0,
                            "{backend} {degrees}° {normal}: dark at {point}"
                        );
                    }
                }
                assert!(seen > 250, "{seen}");
            }
        }
    }
}

/// A floor at z = 8 and a wall of a voxel's thickness on it, at x = 24.
fn wall(peak: f64, params: &str) -> Stage {
    let stage = Stage::new().with_floats("v", [40, 24, 24], |x, _, z| {
        #[expect(clippy::cast_possible_truncation, reason = "the file holds f32")]
        let value = (8.0 - f64::from(z)).max(peak - (f64::from(x) - 24.0).abs()) as f32;
        value
    });
    // Rays keep their x.
    let camera = "look_at(eye: (19.5, -20, 60), target: (19.5, 12, 8), up: (0, 1, 0), projection: orthographic, height: 40)";
    surface(
        stage,
        r#"path: "v_40x24x24_float32.raw""#,
        camera,
        r#""shadow": "surface""#,
        &format!(r#""light_1": [1, 0, 0.36, 0], {params}"#),
    )
}

#[test]
fn a_thin_wall_casts_its_shadow() {
    // Walls of 1 and 0.4 voxels are longer than a step of 0.25 along the light's ray. A step of 4 loses the wall but for
    // the first one, which is taken in parts: from the surface 1/4, 1/2, 1, 2 and 4, of which one is in the wall.
    let cases = [
        (0.5, 0.25, 1.0..22.9),
        (0.2, 0.25, 1.0..22.9),
        (0.5, 4.0, 22.0..22.9),
    ];
    for (peak, step, shaded) in cases {
        let stage = wall(peak, &format!(r#""shadow_step": {step:?}"#));
        for backend in adapters() {
            let drawn = render(&stage, &[], &backend, [96, 32]);
            let (mut dark, mut lit) = (0, 0);
            for (ray, value) in pixels(&drawn) {
                let point = ray.0 + (8.0 - ray.0.z) / ray.1.z * ray.1;
                if !(1.0..22.0).contains(&point.y) {
                    continue;
                }
                if shaded.contains(&point.x) {
                    dark += 1;
                    assert!(value == 0.0, "{backend} {peak} {step}: {value} at {point}");
                }
                if (25.5..38.0).contains(&point.x) {
                    lit += 1;
                    assert!(value > 0.2, "{backend} {peak} {step}: {value} at {point}");
                }
            }
            assert!(dark > 10 && lit > 100, "{dark} {lit}");
        }
    }
}
