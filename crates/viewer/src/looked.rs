//! A node's port as the graph panel shows it: its numbers, and grey or coloured planes of them.

use volgraph_engine::{Findings, LOOK, Plan, TexelValues, Texels};
use volgraph_report::Finding;

/// What a port holds, on the host.
#[derive(Clone, Debug)]
pub struct Looked {
    /// `node.port`.
    pub name: String,
    /// Width, height, depth in texels.
    pub extent: [u32; 3],
    /// The texels' format, as wgpu names it.
    pub format: String,
    /// Numbers of each texel.
    pub channels: usize,
    /// Texel after texel, x fastest.
    pub values: Vec<f32>,
    /// Smallest and largest finite number of the first three channels.
    pub range: (f32, f32),
    /// Why there is nothing to see.
    pub trouble: Option<Findings>,
}

/// A plane of a port, to be painted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LookedPlane {
    /// Width and height.
    pub size: [usize; 2],
    /// Red, green, blue of each texel, the first row first.
    pub codes: Vec<[u8; 3]>,
}

impl Looked {
    /// From what was read of a session's output.
    pub(crate) fn of(plan: &Plan, texels: Result<Texels, Findings>) -> Self {
        let link = plan.graph.outputs.get(LOOK);
        let name = link.map_or_else(String::new, |link| {
            format!("{}.{}", plan.graph.nodes[link.node].name, link.port)
        });
        let empty = |trouble: Findings| Self {
            name: name.clone(),
            extent: [0; 3],
            format: String::new(),
            channels: 1,
            values: Vec::new(),
            range: (0.0, 1.0),
            trouble: Some(trouble),
        };
        let texels = match texels {
            Ok(texels) => texels,
            Err(findings) => return empty(findings),
        };
        let format = format!("{:?}", texels.format).to_lowercase();
        let Some((channels, values)) = numbers(&texels, &format) else {
            let why = format!("the numbers of {format} texels are not shown");
            return empty(Finding::error("look", why).into());
        };
        let shown = values.chunks_exact(channels);
        let range = shown
            .flat_map(|texel| texel.iter().take(3))
            .filter(|value| value.is_finite())
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), value| {
                (low.min(*value), high.max(*value))
            });
        Self {
            name,
            extent: texels.extent,
            format,
            channels,
            values,
            range: if range.0 <= range.1 {
                range
            } else {
                (0.0, 1.0)
            },
            trouble: None,
        }
    }

    /// The numbers of a texel.
    #[must_use]
    pub fn texel(&self, [x, y, z]: [u32; 3]) -> Option<&[f32]> {
        let [width, height, depth] = self.extent;
        if x >= width || y >= height || z >= depth {
            return None;
        }
        let at = (z as usize * height as usize + y as usize) * width as usize + x as usize;
        self.values
            .get(at * self.channels..(at + 1) * self.channels)
    }

    /// The plane across `axis` (0 to 2) at `index`, from black at the smallest to white at the largest number; numbers
    /// that are not finite are magenta.
    #[must_use]
    pub fn plane(&self, axis: usize, index: u32) -> LookedPlane {
        let (across, down) = match axis {
            0 => (1, 2),
            1 => (0, 2),
            _ => (0, 1),
        };
        let (low, high) = self.range;
        let scale = if high > low {
            255.0 / (high - low)
        } else {
            0.0
        };
        let code = |value: f32| ((value - low) * scale).round().clamp(0.0, 255.0) as u8;
        let size = [self.extent[across] as usize, self.extent[down] as usize];
        let mut codes = Vec::with_capacity(size[0] * size[1]);
        for row in 0..self.extent[down] {
            for column in 0..self.extent[across] {
                let mut at = [0; 3];
                at[axis.min(2)] = index;
                at[across] = column;
                at[down] = row;
                codes.push(match self.texel(at) {
                    Some(texel) if texel.iter().any(|value| !value.is_finite()) => [255, 0, 255],
                    Some([grey]) => [code(*grey); 3],
                    Some([red, green]) => [code(*red), code(*green), 0],
                    Some([red, green, blue, ..]) => [code(*red), code(*green), code(*blue)],
                    _ => [0; 3],
                });
            }
        }
        LookedPlane { size, codes }
    }
}

/// Numbers of each texel, and all of them.
fn numbers(texels: &Texels, format: &str) -> Option<(usize, Vec<f32>)> {
    let bytes = match &texels.values {
        TexelValues::Scalars(values) => return Some((1, values.clone())),
        TexelValues::Pairs(values) => return Some((2, values.as_flattened().to_vec())),
        TexelValues::Colors(values) => return Some((4, values.as_flattened().to_vec())),
        TexelValues::Bytes(bytes) => bytes,
    };
    let channels = match format {
        _ if format.starts_with("rgba") => 4,
        _ if format.starts_with("rg") => 2,
        _ => 1,
    };
    let halves = || {
        let pairs = bytes.as_chunks::<2>().0;
        pairs.iter().map(|pair| u16::from_le_bytes(*pair))
    };
    let words = || {
        let words = bytes.as_chunks::<4>().0;
        words.iter().map(|word| u32::from_le_bytes(*word))
    };
    let values = match format.trim_start_matches(['r', 'g', 'b', 'a']) {
        "16float" => halves()
            .map(|bits| half::f16::from_bits(bits).to_f32())
            .collect(),
        "16unorm" => halves().map(|code| f32::from(code) / 65535.0).collect(),
        "16uint" => halves().map(f32::from).collect(),
        "16sint" => halves().map(|bits| f32::from(bits.cast_signed())).collect(),
        "8unorm" => bytes.iter().map(|code| f32::from(*code) / 255.0).collect(),
        "8snorm" => bytes
            .iter()
            .map(|code| f32::from(code.cast_signed()) / 127.0)
            .collect(),
        "8uint" => bytes.iter().map(|code| f32::from(*code)).collect(),
        "32uint" => words().map(|word| word as f32).collect(),
        "32sint" => words().map(|word| word.cast_signed() as f32).collect(),
        _ => return None,
    };
    Some((channels, values))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Looked {
        Looked {
            name: "ramp.value".to_owned(),
            extent: [3, 2, 2],
            format: "r32float".to_owned(),
            channels: 1,
            values: (0..12).map(|i| i as f32).collect(),
            range: (0.0, 11.0),
            trouble: None,
        }
    }

    #[test]
    fn planes_across_each_axis_hold_their_texels() {
        let ramp = ramp();
        let grey = |value: f32| [(value / 11.0 * 255.0).round() as u8; 3];
        let z = ramp.plane(2, 1);
        assert_eq!((z.size, z.codes[4]), ([3, 2], grey(10.0)));
        let y = ramp.plane(1, 1);
        assert_eq!((y.size, y.codes[3]), ([3, 2], grey(9.0)));
        let x = ramp.plane(0, 2);
        assert_eq!((x.size, x.codes[2]), ([2, 2], grey(8.0)));
        assert_eq!(ramp.texel([3, 0, 0]), None);
        // Beyond the last plane there is nothing.
        assert_eq!(ramp.plane(2, 9).codes[0], [0; 3]);
    }

    #[test]
    fn numbers_that_are_none_are_seen() {
        let mut ramp = ramp();
        ramp.values[0] = f32::NAN;
        assert_eq!(ramp.plane(2, 0).codes[0], [255, 0, 255]);
    }
}
