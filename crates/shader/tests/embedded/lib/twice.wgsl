// A library in the embedded set.
#import "base.wgsl"
fn embedded_twice(x: f32) -> f32 {
    return base_one() * 2.0 * x;
}
