// Imported by its neighbour.
fn base_one() -> f32 {
    return 1.0;
}
