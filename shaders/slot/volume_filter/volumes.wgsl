// The texel at a point of the volume that was selected last: by the device's own filter.
#import slot "volumes"

fn volume_filter(position: vec3f) -> f32 {
    return volumes_filter(volumes_place(position));
}
