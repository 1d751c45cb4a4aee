//! How far a picture that was rendered again is from the one in its file, and how far it may be.
//!
//! PNG: each code may be off by 1, which is rounding; of codes under little alpha as much less as they show. EXR: colours
//! and opacities within 1e-5, depths and other layers within as much of their largest value where that is above 1: what f32
//! loses on another device. What has no figure counts as well: a layer that only one of the two has, and values that are
//! finite in one alone, such as the depth of a ray that hits in one and misses in the other.

use std::collections::BTreeMap;

use volgraph::Picture;
use volgraph_measure::{Comparison, ScalarDifference};
use volgraph_picture::srgb::srgb_from_linear;
use volgraph_picture::{LayerValues, PngBits};

/// What numbers of an EXR may be off by.
const EXR_BOUND: f64 = 1e-5;

/// How far two pictures are apart, in the unit of their format.
pub struct Difference {
    /// The largest difference, and where it is.
    pub largest: f64,
    place: String,
    /// What it may be.
    pub bound: f64,
    /// What is unlike and has no figure, in words.
    pub unlike: Vec<String>,
    bits: Option<PngBits>,
}

impl Difference {
    /// Of the picture in the file, and that rendered again.
    pub fn of(
        before: &Picture,
        after: &Picture,
        comparison: &Comparison,
        bits: Option<PngBits>,
    ) -> Self {
        match bits {
            Some(bits) => Self::of_codes(before, after, bits),
            None => Self::of_numbers(before, after, comparison),
        }
    }

    fn of_codes(before: &Picture, after: &Picture, bits: PngBits) -> Self {
        let most = match bits {
            PngBits::Sixteen => 65535.0,
            PngBits::Eight => 255.0,
        };
        let mut difference = Self {
            largest: 0.0,
            place: String::new(),
            // Codes are whole, but read as f32.
            bound: 1.01,
            unlike: Vec::new(),
            bits: Some(bits),
        };
        for (at, (a, b)) in before.color.iter().zip(&after.color).enumerate() {
            let width = before.width as usize;
            let place = || format!("at ({}, {})", at % width, at / width);
            difference.look(codes_apart(*a, *b, most), place);
        }
        difference
    }

    fn of_numbers(before: &Picture, after: &Picture, comparison: &Comparison) -> Self {
        let mut difference = Self {
            largest: 0.0,
            place: String::new(),
            bound: EXR_BOUND,
            unlike: Vec::new(),
            bits: None,
        };
        let max = comparison.max;
        let place = || format!("in the colour at ({}, {})", max.x, max.y);
        difference.look(max.error, place);
        let (ours, theirs) = (parts(before), parts(after));
        let compared = |name: &str| match name {
            "depth" => comparison.depth.as_ref(),
            "opacity" => comparison.opacity.as_ref(),
            layer => comparison.layers.get(layer),
        };
        let names = ours
            .keys()
            .chain(theirs.keys().filter(|it| !ours.contains_key(*it)));
        for name in names {
            match (ours.get(name), theirs.get(name), compared(name)) {
                (Some(numbers), Some(_), Some(compared)) => {
                    difference.look_at_part(name, numbers, compared);
                }
                (Some(_), Some(_), None) => difference
                    .unlike
                    .push(format!("the layer `{name}` holds vectors in one alone")),
                (_, None, _) => difference
                    .unlike
                    .push(format!("the layer `{name}` is in the file alone")),
                (None, Some(_), _) => difference
                    .unlike
                    .push(format!("the layer `{name}` is not in the file")),
            }
        }
        difference
    }

    /// A part that both have, with the numbers of one of them.
    fn look_at_part(&mut self, name: &str, numbers: &[f32], compared: &ScalarDifference) {
        if let Some(max) = compared.max {
            let finite = numbers.iter().filter(|it| it.is_finite());
            let largest = finite.map(|it| f64::from(it.abs())).fold(1.0, f64::max);
            let place = || format!("in the layer `{name}` at ({}, {})", max.x, max.y);
            self.look(max.error / largest, place);
        }
        if compared.one_sided > 0 {
            let count = compared.one_sided;
            let s = if count == 1 { "" } else { "s" };
            self.unlike.push(format!(
                "{count} value{s} of the layer `{name}` not finite in one alone"
            ));
        }
    }

    fn look(&mut self, error: f64, place: impl FnOnce() -> String) {
        if error > self.largest {
            (self.largest, self.place) = (error, place());
        }
    }

    /// Whether the pictures are the same, but for what the format and devices lose.
    pub fn holds(&self) -> bool {
        self.largest <= self.bound && self.unlike.is_empty()
    }

    /// What the largest difference is counted in.
    pub fn unit(&self) -> &'static str {
        match self.bits {
            Some(PngBits::Sixteen) => "codes of 65535",
            Some(PngBits::Eight) => "codes of 255",
            None => "linear",
        }
    }

    /// In words, all that is unlike.
    pub fn said(&self) -> String {
        let largest = (self.largest > 0.0).then(|| {
            let place = &self.place;
            match self.bits {
                Some(_) => format!("{:.1} {} {place}", self.largest, self.unit()),
                None => format!("{:.1e} {place}", self.largest),
            }
        });
        let said: Vec<String> = largest.into_iter().chain(self.unlike.clone()).collect();
        said.join("; ")
    }
}

/// The numbers of all that a picture has besides colour, by name.
fn parts(picture: &Picture) -> BTreeMap<&str, &[f32]> {
    let scalars = [("depth", &picture.depth), ("opacity", &picture.opacity)];
    let scalars = scalars
        .into_iter()
        .filter_map(|(name, numbers)| Some((name, numbers.as_deref()?)));
    let layers = picture.layers.iter().map(|layer| {
        let numbers = match &layer.values {
            LayerValues::Scalar(numbers) => numbers.as_slice(),
            LayerValues::Vector(vectors) => vectors.as_flattened(),
        };
        (layer.name.as_str(), numbers)
    });
    scalars.chain(layers).collect()
}

/// How many codes two pixels of a PNG are apart, colours weighed by the larger of their alphas.
fn codes_apart(a: [f32; 4], b: [f32; 4], most: f64) -> f64 {
    let code = |pixel: [f32; 4], i: usize| {
        let alpha = f64::from(pixel[3]);
        let straight = if alpha > 0.0 {
            f64::from(pixel[i]) / alpha
        } else {
            0.0
        };
        most * srgb_from_linear(straight.clamp(0.0, 1.0))
    };
    let alpha = f64::from(a[3].max(b[3]));
    let colors = (0..3).map(|i| alpha * (code(a, i) - code(b, i)).abs());
    colors.fold(most * f64::from((a[3] - b[3]).abs()), f64::max)
}

#[cfg(test)]
mod tests {
    use volgraph_measure::compare_without_flip;
    use volgraph_picture::Layer;

    use super::*;

    /// Of two pixels, one of which has no depth, with a layer of each form.
    fn picture() -> Picture {
        let mut picture = Picture::from_color(2, 1, vec![[0.25, 0.5, 0.75, 1.0]; 2]).unwrap();
        picture.depth = Some(vec![20.0, f32::INFINITY]);
        picture.opacity = Some(vec![1.0, 0.5]);
        let layer = |name: &str, values| Layer {
            name: name.to_owned(),
            values,
        };
        let normals = vec![[0.0, 0.0, 1.0, 1.0], [0.0; 4]];
        picture.layers = vec![
            layer("normal", LayerValues::Vector(normals)),
            layer("steps", LayerValues::Scalar(vec![1.0, 2.0])),
        ];
        picture
    }

    fn said(change: impl FnOnce(&mut Picture)) -> (bool, String) {
        let (before, mut after) = (picture(), picture());
        change(&mut after);
        let comparison = compare_without_flip(&after, &before).unwrap();
        let difference = Difference::of(&before, &after, &comparison, None);
        (difference.holds(), difference.said())
    }

    #[test]
    fn all_that_a_picture_has_is_held_against_the_other() {
        assert_eq!(said(|_| {}), (true, String::new()));
        // Rounding of a depth of 20.
        let (holds, _) = said(|it| it.depth = Some(vec![20.0 + 1e-4, f32::INFINITY]));
        assert!(holds);
        let differs = |change: fn(&mut Picture), words: &str| {
            let (holds, said) = said(change);
            assert!(!holds && said.contains(words), "{said}");
        };
        differs(|it| it.color[1][0] = 0.26, "in the colour at (1, 0)");
        differs(
            |it| it.opacity = Some(vec![1.0, 0.6]),
            "`opacity` at (1, 0)",
        );
        differs(
            |it| it.depth = Some(vec![21.0, f32::INFINITY]),
            "`depth` at (0, 0)",
        );
        differs(
            |it| it.depth = Some(vec![20.0, 20.0]),
            "1 value of the layer `depth`",
        );
        differs(
            |it| it.depth = Some(vec![f32::INFINITY; 2]),
            "1 value of the layer `depth`",
        );
        differs(|it| it.depth = None, "`depth` is in the file alone");
        differs(|it| it.layers.truncate(1), "`steps` is in the file alone");
        differs(
            |it| {
                let mut more = it.layers[1].clone();
                "more".clone_into(&mut more.name);
                it.layers.push(more);
            },
            "`more` is not in the file",
        );
        differs(
            |it| it.layers[1].values = LayerValues::Vector(vec![[0.0; 4]; 2]),
            "`steps` holds vectors in one alone",
        );
        differs(
            |it| it.layers[1].values = LayerValues::Scalar(vec![1.0, 3.0]),
            "`steps` at (1, 0)",
        );
        differs(
            |it| it.layers[0].values = LayerValues::Vector(vec![[0.0, 1.0, 0.0, 1.0], [0.0; 4]]),
            "`normal` at (0, 0)",
        );
    }
}
