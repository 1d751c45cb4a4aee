//! Emission and absorption in float64, slab by slab: the truth where a closed form is none.

/// Slabs one behind the other, the nearest first; each has a colour and an optical depth. Gives the colour, premultiplied,
/// and the opacity.
#[must_use]
pub fn slabs(slabs: impl IntoIterator<Item = ([f64; 3], f64)>) -> [f64; 4] {
    let (mut seen, mut depth) = ([0.0; 3], 0.0_f64);
    for (color, thickness) in slabs {
        let weight = (-depth).exp() * -(-thickness).exp_m1();
        for (sum, channel) in seen.iter_mut().zip(color) {
            *sum += weight * channel;
        }
        depth += thickness;
    }
    let [r, g, b] = seen;
    [r, g, b, -(-depth).exp_m1()]
}

/// The middles of so many equal parts of the way from 0 to 1.
pub fn middles(parts: u32) -> impl Iterator<Item = f64> {
    (0..parts).map(move |part| (f64::from(part) + 0.5) / f64::from(parts))
}
