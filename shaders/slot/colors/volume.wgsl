// Where do a segment's colours come from? From the volume itself, at the segment's centre: its voxels have red, green and
// blue, such as photographs of slices. The transfer function gives the opacity alone. Order 2 in the step.
// @order 2
#import "lib/classified.wgsl"
#import "lib/volume_texture.wgsl"

@group(1) @binding(3) var color_volume: texture_3d<f32>;

fn colors_segment(classified: Classified, ray: Ray, segment: Segment) -> Classified {
    let color = textureSampleLevel(color_volume, linear_sampler, segment_centre(ray, segment), 0.0).xyz;
    return Classified(color * (1.0 - classified.transmittance), classified.transmittance);
}
