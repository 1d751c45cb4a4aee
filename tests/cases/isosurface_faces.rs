//! Faces of solids where the volume's box cuts them, the eye inside of a solid, and fields that cubics are not for.

use glam::DVec3;
use volgraph_tests::trilinear::Trilinear;
use volgraph_tests::{STAGES, adapters, box_interval, ray, render};

use crate::isosurface_colors::{CLEAR, RAMP, RAMP_CAMERAS, SIZE, SPHERES, distance, stage};

#[test]
fn a_solid_that_fills_the_box_shows_its_faces() {
    let camera = "orbit(azimuth: 33, elevation: 21, fov_y: 40)";
    let slots = r#"{ "technique": "isosurface", "light": "phong" }"#;
    let params = r#"{ "isovalue": 0.5, "isovalue_unit": "data", "surface_color": [1, 1, 1], "ambient": 0.0, "diffuse": 1.0,
                      "specular": 0.0, "light_1": [0.48, -0.6, 0.64, 0.0] }"#;
    let light = DVec3::new(0.48, -0.6, 0.64);
    let stage = stage(
        ([8, 8, 8], |_, _, _| 0.75),
        "",
        CLEAR,
        camera,
        [slots, params],
    );
    let bounds = (DVec3::splat(-0.5), DVec3::splat(7.5));
    for backend in adapters() {
        for form in STAGES {
            for refinement in ["linear", "cubic"] {
                let sets = [
                    format!("image.stage={form}"),
                    format!("image.refinement={refinement}"),
                ];
                let sets = sets.each_ref().map(String::as_str);
                let mut session = stage.open("graph.ron", &sets, &backend, SIZE).unwrap();
                let (picture, _) = session.render().unwrap();
                let normals = session.read("normal").unwrap().color;
                let view = *session.view();
                let mut met = 0;
                for (at, (normal, seen)) in normals
                    .iter()
                    .zip(picture.depth.as_ref().unwrap())
                    .enumerate()
                {
                    let ray = ray(&view, at as u32 % SIZE[0], at as u32 / SIZE[0]);
                    let Some((near, _)) = box_interval(ray, bounds.0, bounds.1) else {
                        assert_eq!(*seen, f32::INFINITY);
                        continue;
                    };
                    assert!(
                        (f64::from(*seen) - near).abs() <= 1e-5,
                        "{backend} {form} {seen} {near}"
                    );
                    // The face nearest to the entry; not at edges, where two are.
                    let from_middle = ray.0 + ray.1 * near - 3.5;
                    let mut sides = from_middle.abs().to_array();
                    let axis = (0..3)
                        .max_by(|&a, &b| sides[a].total_cmp(&sides[b]))
                        .unwrap();
                    sides.sort_by(f64::total_cmp);
                    if sides[1] < 4.0 - 1e-3 {
                        met += 1;
                        let mut face = [0.0; 3];
                        face[axis] = from_middle[axis].signum() as f32;
                        // Lambert's cosine: the face is lit by its own normal.
                        let lit = light[axis] * from_middle[axis].signum();
                        let seen = f64::from(picture.color[at][1]);
                        assert!((seen - lit.max(0.0)).abs() < 1e-5, "{seen}, not {lit}");
                        assert!(
                            (0..3).all(|i| (normal[i] - face[i]).abs() < 1e-6),
                            "{normal:?} {face:?}"
                        );
                    }
                }
                assert!(met > 200);
            }
            // Open, the hollow inside of the box has no surface; and none from inside of the solid.
            let form = format!("image.stage={form}");
            for set in ["image.cut_faces=open", "image.solid=below"] {
                let (picture, _) = render(&stage, &[&form, set], &backend, SIZE);
                assert!(
                    picture
                        .opacity
                        .unwrap()
                        .iter()
                        .all(|opacity| *opacity == 0.0),
                    "{backend} {form} {set}"
                );
            }
        }
    }
}

#[test]
fn an_eye_inside_of_the_solid_sees_its_surface_from_inside() {
    let camera = "look_at(eye: (9.3, 11.1, 10.2), target: (20, 14, 12), fov_y: 80)";
    let params =
        r#"{ "isovalue": 7.0, "isovalue_unit": "data", "solid": "below", "refinement": "cubic" }"#;
    let stage = stage(
        (SPHERES, distance),
        "",
        CLEAR,
        camera,
        [r#"{ "technique": "isosurface" }"#, params],
    );
    let field = Trilinear::new(SPHERES, distance);
    for backend in adapters() {
        for form in STAGES {
            let set = format!("image.stage={form}");
            let (picture, view) = render(&stage, &[&set], &backend, SIZE);
            for (at, seen) in picture.depth.unwrap().iter().enumerate() {
                let ray = ray(&view, at as u32 % SIZE[0], at as u32 / SIZE[0]);
                let interval = box_interval(ray, DVec3::splat(-0.5), DVec3::splat(21.5)).unwrap();
                let (truth, _) = field.crossings(ray, interval, 7.0)[0];
                assert!(
                    (f64::from(*seen) - truth).abs() <= 1e-4,
                    "{backend} {form}: {seen}, not {truth}"
                );
            }
        }
    }
}

#[test]
fn cubics_of_another_field_than_the_trilinear_are_refused() {
    let slots = r#"{ "technique": "isosurface", "reconstruct": "tricubic" }"#;
    let params = r#"{ "refinement": "cubic" }"#;
    let stage = stage(RAMP, "", CLEAR, RAMP_CAMERAS[0], [slots, params]);
    let refused = stage
        .open("graph.ron", &[], &adapters()[0], SIZE)
        .err()
        .unwrap();
    let text = refused.to_string();
    assert!(
        text.contains("`reconstruct` is `tricubic`") && text.contains("bisection"),
        "{text}"
    );
    assert!(
        stage
            .open(
                "graph.ron",
                &["image.slots.reconstruct=trilinear"],
                &adapters()[0],
                SIZE
            )
            .is_ok()
    );
}
