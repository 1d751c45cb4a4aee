// The unit of isovalues.
#import "lib/volume.wgsl"

struct Params {
    /// The unit of isovalues: `range`, 0 to 1 over the values that the data has; `normalised`, over the range of the stored
    /// type (of floats: of the data); or `data`. @default range @choices range normalised data
    isovalue_unit: u32,
}

// A scalar, as shaders count them, from an isovalue that the user gave.
fn isovalue_scalar(given: f32) -> f32 {
    return volume_scalar(volume, given, params.isovalue_unit);
}
