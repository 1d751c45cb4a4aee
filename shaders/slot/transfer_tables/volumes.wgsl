// Which tables of transfer functions are read: those of the volume that was selected last.
#import slot "volumes"

fn transfer_entry(place: f32) -> vec4f {
    return volumes_entry(vec2f(place, 0.5));
}

fn transfer_entries(place: vec2f) -> vec4f {
    return volumes_entries(place, transfer.preintegration_last);
}

fn transfer_half_entries(place: vec2f) -> vec4f {
    return volumes_half_entries(place, transfer.half_last);
}

fn transfer_integral(column: i32, row: i32) -> vec4f {
    return volumes_integral(vec2i(column, row));
}

// Volumes are selected, not rows.
fn transfer_select(row: u32) {
}
