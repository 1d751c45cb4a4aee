// The unit of isovalues.
#import "lib/volume.wgsl"

struct Params {
    /// The unit of isovalues: `normalised`, 0 to 1 over the range of the stored type (of floats: of the data), or `data`.
    /// @default normalised @choices normalised data
    isovalue_unit: u32,
}

// A scalar, as shaders count them, from an isovalue that the user gave.
fn isovalue_scalar(given: f32) -> f32 {
    return select(volume_from_normalised(given), given - volume.value_reference, params.isovalue_unit == 1u);
}
