//! volgraph's own shaders, broken in ways that authors break shaders: `volgraph test` finds each, by the name of the case
//! and of what it expects.

use crate::{Scratch, copy};

/// A break of a shader, and what finds it.
struct Break {
    what: &'static str,
    file: &'static str,
    find: &'static str,
    with: &'static str,
    /// The case, and how the expectation that fails starts.
    case: &'static str,
    expectation: &'static str,
}

const BREAKS: [Break; 14] = [
    Break {
        what: "drops the last segment",
        file: "slot/walk/pairs.wgsl",
        find: "        let back = sample_along(*ray, end);",
        with: "        if end >= length { is_done = true; break; }\n        let back = sample_along(*ray, end);",
        case: "dvr_fog",
        expectation: "uniform(color: (0.4",
    },
    Break {
        what: "hands the first of two segments twice",
        file: "slot/walk/pairs.wgsl",
        find: "segment_step(middle, back, f32(index + 1u) * step, step)",
        with: "segment_step(front, middle, f32(index) * step, step)",
        case: "classify_preintegrated",
        expectation: "order(",
    },
    Break {
        what: "drops the last segment where each is looked at alone",
        file: "slot/walk/segments.wgsl",
        find: "                let back = sample_along(*ray, end);",
        with: "                if end >= length { is_done = true; break; }\n                let back = sample_along(*ray, end);",
        case: "dvr_alike",
        expectation: "equals(",
    },
    Break {
        what: "samples the start of segments",
        file: "slot/classify/post.wgsl",
        find: "segment_centre(ray, segment)",
        with: "segment.front.position",
        case: "classify_post",
        expectation: "order(",
    },
    Break {
        what: "forgets the length in the opacity",
        file: "lib/stretch_of_one.wgsl",
        find: "(length * transfer.halvings_per_world)",
        with: "(volume.voxel * transfer.halvings_per_world)",
        case: "dvr_fog",
        expectation: "pixel(at: centre",
    },
    Break {
        what: "lets positions run away along the ray",
        file: "lib/ray.wgsl",
        find: "return ray.entry + distance * ray.slope;",
        with: "return ray.entry + 1.04 * distance * ray.slope;",
        case: "dvr_along",
        expectation: "pixel(at: centre",
    },
    Break {
        what: "mirrors x",
        file: "lib/volume.wgsl",
        find: "return volume_filter(position) *",
        with: "return volume_filter(vec3f(1.0 - position.x, position.yz)) *",
        case: "dvr_ramp",
        expectation: "pixel(at: (30",
    },
    Break {
        what: "divides by an opacity of zero",
        file: "slot/technique/dvr.wgsl",
        find: "return compositing_result(state.composite);",
        with: "let result = compositing_result(state.composite);\n    return RayResult(result.color / result.color.w * result.color.w, result.depth);",
        case: "dvr_fog",
        expectation: "finite",
    },
    Break {
        what: "does not clip",
        file: "slot/clip/box.wgsl",
        find: "    let slabs = box_slabs(ray);\n    let first = max(",
        with: "    if true { return vec2f(0.0, ray.far - ray.near); }\n    let slabs = box_slabs(ray);\n    let first = max(",
        case: "clip",
        expectation: "differs(",
    },
    Break {
        what: "swaps front and back in the table",
        file: "slot/classify/preintegrated_2d.wgsl",
        find: "return preintegrated_2d_piece(front, back, segment.length);",
        with: "return preintegrated_2d_piece(back, front, segment.length);",
        case: "dvr_along",
        expectation: "pixel(at: centre",
    },
    Break {
        what: "leaves normals as long as gradients are",
        file: "lib/surface.wgsl",
        find: "return given / select(magnitude, -magnitude, dot(given, direction) > 0.0);",
        with: "return given * select(1.0, -1.0, dot(given, direction) > 0.0);",
        case: "isosurface",
        expectation: "pixel(at: centre, color",
    },
    Break {
        what: "looks half a pixel aside in compute shaders",
        file: "node/raycast.wgsl",
        find: "raycast_pixel(vec2f(pixel) + 0.5)",
        with: "raycast_pixel(vec2f(pixel) + 1.0)",
        case: "classify_preintegrated",
        expectation: "stages_agree",
    },
    Break {
        what: "writes blue for red",
        file: "lib/compositing.wgsl",
        find: "return RayResult(vec4f(composite.color, ",
        with: "return RayResult(vec4f(composite.color.zyx, ",
        case: "dvr_ramp",
        expectation: "pixel(at: (12",
    },
    Break {
        what: "never ends rays early",
        file: "lib/compositing.wgsl",
        find: "return composite.transmittance < params.early_termination;",
        with: "return composite.transmittance < min(params.early_termination, 0.0);",
        case: "dvr",
        expectation: "differs(",
    },
];

/// A copy of volgraph's shaders and cases.
fn sound() -> Scratch {
    let scratch = Scratch::new();
    copy("shaders", scratch.path());
    copy("tests/shaders", scratch.path());
    scratch
}

/// The arguments that run what should find a break.
fn args(filter: &str) -> [&str; 6] {
    [
        "test",
        "tests/shaders",
        "--shaders",
        "shaders",
        "--filter",
        filter,
    ]
}

#[test]
fn every_break_is_found_by_name() {
    let scratch = sound();
    let mut passed = std::collections::BTreeSet::new();
    for broken in BREAKS {
        let filter = format!("{}.ron: {}", broken.case, broken.expectation);
        let filter = format!("/{filter}");
        // Unbroken it holds.
        if passed.insert(filter.clone()) {
            let run = scratch.run(&args(&filter));
            assert_eq!(run.code, Some(0), "{}: {run:?}", broken.what);
        }
        let file = format!("shaders/{}", broken.file);
        let sound = std::fs::read_to_string(scratch.path().join(&file)).unwrap();
        assert_eq!(
            sound.matches(broken.find).count(),
            1,
            "{}: {file} has changed",
            broken.what
        );
        scratch.write(&file, sound.replace(broken.find, broken.with));
        let run = scratch.run(&args(&filter));
        scratch.write(&file, sound);
        assert_eq!(run.code, Some(1), "{}: {run:?}", broken.what);
        let named = format!(
            "FAILED  tests/shaders/{}.ron: {}",
            broken.case, broken.expectation
        );
        assert!(run.stdout.contains(&named), "{}: {run:?}", broken.what);
        assert!(
            !run.stdout.contains("could not be measured"),
            "{}: the broken shader does not run: {run:?}",
            broken.what
        );
    }
}
