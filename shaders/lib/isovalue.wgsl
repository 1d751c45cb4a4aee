// The isosurface of techniques that draw one.
#import "lib/isovalue_unit.wgsl"

struct Params {
    /// The scalar on the isosurface. @default 0.5
    isovalue: f32,
    /// Which side of the isovalue is solid. @default above @choices above below
    solid: u32,
}

// The scalar on the isosurface.
fn isovalue_level() -> f32 {
    return isovalue_scalar(params.isovalue);
}

// Whether a scalar is that of the solid which the isosurface bounds.
fn isovalue_is_solid(scalar: f32) -> bool {
    return (scalar >= isovalue_level()) != (params.solid == 1u);
}
