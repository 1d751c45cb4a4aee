// The isosurface of techniques that draw one.
#import "lib/volume.wgsl"

struct Params {
    /// The scalar on the isosurface. @default 0.5
    isovalue: f32,
    /// The unit of isovalues: `normalised`, 0 to 1 over the range of the stored type (of floats: of the data), or `data`.
    /// @default normalised @choices normalised data
    isovalue_unit: u32,
    /// Which side of the isovalue is solid. @default above @choices above below
    solid: u32,
}

// A scalar, as shaders count them, from an isovalue that the user gave.
fn isovalue_scalar(given: f32) -> f32 {
    return select(volume_from_normalised(given), given - volume.value_reference, params.isovalue_unit == 1u);
}

// The scalar on the isosurface.
fn isovalue_level() -> f32 {
    return isovalue_scalar(params.isovalue);
}

// Whether a scalar is that of the solid which the isosurface bounds.
fn isovalue_is_solid(scalar: f32) -> bool {
    return (scalar >= isovalue_level()) != (params.solid == 1u);
}
