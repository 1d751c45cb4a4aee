// The choice that clips nothing.
fn clip_is_visible(position: vec3f) -> bool {
    return true;
}
