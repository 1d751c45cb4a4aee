//! What shaders are told of a view: the members of the uniforms `lens` and `camera`.

use glam::DVec3;
use volgraph_shader::UniformValue;

use crate::camera::{Camera, View};
use crate::kind::Uniform;

#[expect(clippy::cast_possible_truncation, reason = "shaders compute in f32")]
pub(super) fn lens_members(view: &View) -> Uniform {
    let lens = view.lens();
    let [size, corner, extent] =
        [lens.size, lens.corner, lens.extent].map(|pixels| pixels.map(f64::from));
    // From clip coordinates of the whole picture to those of the window; one and zeros where it is the whole.
    let scale = [size[0] / extent[0], size[1] / extent[1]];
    let shift = [
        (size[0] - 2.0 * corner[0]) / extent[0] - 1.0,
        1.0 - (size[1] - 2.0 * corner[1]) / extent[1],
    ];
    vec![
        ("size", UniformValue::Vec2(lens.size.map(|n| n as f32))),
        ("corner", UniformValue::Vec2(lens.corner.map(|n| n as f32))),
        ("extent", UniformValue::Vec2(lens.extent.map(|n| n as f32))),
        ("clip_scale", UniformValue::Vec2(scale.map(|n| n as f32))),
        ("clip_shift", UniformValue::Vec2(shift.map(|n| n as f32))),
        (
            "half_extent",
            UniformValue::Vec2(lens.half_extent.map(|n| n as f32)),
        ),
        (
            "is_orthographic",
            UniformValue::U32(u32::from(lens.is_orthographic)),
        ),
    ]
}

/// From so many radii away rays start before the volumes, and not at the eye: f32 has no digits left for both.
const FAR_RADII: f64 = 64.0;

pub(super) fn camera_members(camera: &Camera, origin: DVec3, radius: f64) -> Uniform {
    let vec3 = |v: DVec3| UniformValue::Vec3(v.as_vec3().to_array());
    let eye = camera.eye - origin;
    let depth = -eye.dot(camera.forward);
    // In front of everything by a radius.
    let skipped = if depth > FAR_RADII * radius {
        depth - 2.0 * radius
    } else {
        0.0
    };
    #[expect(clippy::cast_possible_truncation, reason = "shaders compute in f32")]
    let skipped_f32 = skipped as f32;
    vec![
        ("eye", vec3(eye)),
        ("anchor", vec3(eye + skipped * camera.forward)),
        ("skipped", UniformValue::F32(skipped_f32)),
        ("right", vec3(camera.right)),
        ("up", vec3(camera.up)),
        ("forward", vec3(camera.forward)),
    ]
}
