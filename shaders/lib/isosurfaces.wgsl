// Up to eight isosurfaces: their isovalues, colours and opacities, in any order.
#import "lib/isovalue_unit.wgsl"

struct Params {
    /// How many of the isosurfaces are drawn. @default 3 @range 1 8
    surfaces: u32,
    /// The scalar on the first isosurface. @default 0.25
    isovalue_1: f32,
    /// Its linear colour (not premultiplied) and its opacity. @default 0.10 0.25 0.60 0.25 @range 0 1 @color
    color_1: vec4f,
    /// The scalar on the second isosurface. @default 0.5
    isovalue_2: f32,
    /// Its linear colour (not premultiplied) and its opacity. @default 0.15 0.60 0.35 0.35 @range 0 1 @color
    color_2: vec4f,
    /// The scalar on the third isosurface. @default 0.75
    isovalue_3: f32,
    /// Its linear colour (not premultiplied) and its opacity. @default 0.90 0.45 0.10 0.60 @range 0 1 @color
    color_3: vec4f,
    /// The scalar on the fourth isosurface. @default 0.125
    isovalue_4: f32,
    /// Its linear colour (not premultiplied) and its opacity. @default 0.10 0.10 0.40 0.20 @range 0 1 @color
    color_4: vec4f,
    /// The scalar on the fifth isosurface. @default 0.375
    isovalue_5: f32,
    /// Its linear colour (not premultiplied) and its opacity. @default 0.10 0.50 0.60 0.30 @range 0 1 @color
    color_5: vec4f,
    /// The scalar on the sixth isosurface. @default 0.625
    isovalue_6: f32,
    /// Its linear colour (not premultiplied) and its opacity. @default 0.60 0.65 0.15 0.45 @range 0 1 @color
    color_6: vec4f,
    /// The scalar on the seventh isosurface. @default 0.875
    isovalue_7: f32,
    /// Its linear colour (not premultiplied) and its opacity. @default 0.80 0.15 0.10 0.75 @range 0 1 @color
    color_7: vec4f,
    /// The scalar on the eighth isosurface. @default 0.95
    isovalue_8: f32,
    /// Its linear colour (not premultiplied) and its opacity. @default 0.90 0.85 0.80 0.90 @range 0 1 @color
    color_8: vec4f,
}

struct Isosurface {
    // The scalar on it, as shaders count them.
    level: f32,
    // Linear colour, and its opacity in the fourth.
    color: vec4f,
}

const ISOSURFACES_MAX: u32 = 8u;

// The isosurface of a number below `params.surfaces`.
fn isosurfaces_at(index: u32) -> Isosurface {
    switch index {
        case 0u: { return Isosurface(isovalue_scalar(params.isovalue_1), params.color_1); }
        case 1u: { return Isosurface(isovalue_scalar(params.isovalue_2), params.color_2); }
        case 2u: { return Isosurface(isovalue_scalar(params.isovalue_3), params.color_3); }
        case 3u: { return Isosurface(isovalue_scalar(params.isovalue_4), params.color_4); }
        case 4u: { return Isosurface(isovalue_scalar(params.isovalue_5), params.color_5); }
        case 5u: { return Isosurface(isovalue_scalar(params.isovalue_6), params.color_6); }
        case 6u: { return Isosurface(isovalue_scalar(params.isovalue_7), params.color_7); }
        default: { return Isosurface(isovalue_scalar(params.isovalue_8), params.color_8); }
    }
}
