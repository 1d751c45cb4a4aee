//! Shapes with a closed form along a ray.

use glam::DVec3;

use super::{
    ALONG_Y, CUBIC, Case, INSIDE, ORTHOGRAPHIC, PERSPECTIVE, STRETCHED, TABLE, boxed, check,
    planes, sphere,
};

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
            20,
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
            20,
        );
    }
}
