// The texel at a point, trilinear: by the device's own filter.
#import slot "volumes"

fn volume_filter(position: vec3f) -> f32 {
    return volumes_filter(volumes_place(position));
}
