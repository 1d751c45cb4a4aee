//! What bent rays see behind the volume: the background without a seam, and only where a technique bends rays.

use volgraph::Picture;
use volgraph_picture::SaveOptions;
use volgraph_tests::{STAGES, Stage, adapters, graph};

use crate::refraction::{CLEAR, PLACES};

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
