//! Whether pixels are what they should be.

use serde::Serialize;

use super::case::Quantity;

/// The values of a picture's pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    /// Width and height.
    pub size: [u32; 2],
    /// Four numbers for each pixel; `None` where nothing is said.
    pub values: Vec<Option<[f64; 4]>>,
}

/// How far pixels are from their truth.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Measured {
    /// The largest error of any number, of the pixels that have one.
    pub error: f64,
    /// What it may be.
    pub bound: f64,
    /// Pixels that were compared.
    pub judged: usize,
    /// Pixels with a value that is no number.
    pub non_finite: usize,
    /// Pixels that show nothing, or next to nothing, where the truth shows something.
    pub holes: usize,
    /// Pixels that show something where the truth shows nothing.
    pub phantoms: usize,
    /// Pixels that are wrong alone: truth and neighbours are smooth there.
    pub specks: usize,
    /// Why nothing was drawn.
    pub refused: Option<String>,
}

impl Measured {
    /// Whether nothing is wrong with it.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.refused.is_none()
            && self.judged > 0
            && self.non_finite == 0
            && self.holes == 0
            && self.phantoms == 0
            && self.specks == 0
            && self.error <= self.bound
    }

    /// How bad it is, to find the worst: errors in bounds, defects above all.
    #[must_use]
    pub fn badness(&self) -> f64 {
        if self.refused.is_some() || self.judged == 0 {
            return f64::INFINITY;
        }
        let defects = self.non_finite + self.holes + self.phantoms + self.specks;
        let error = if self.bound.is_finite() && self.bound > 0.0 {
            self.error / self.bound
        } else {
            0.0
        };
        1e3 * defects as f64 + error
    }

    /// What is wrong, in a few words; the error alone where nothing is.
    #[must_use]
    pub fn words(&self) -> String {
        if let Some(why) = &self.refused {
            return format!("refused: {why}");
        }
        if self.judged == 0 {
            return "nothing to judge".to_owned();
        }
        let mut words = vec![format!("{:.1e}", self.error)];
        let mut share = |count: usize, what: &str| {
            if count > 0 {
                let percent = 100.0 * count as f64 / self.judged as f64;
                words.push(format!("{what} {percent:.1} %"));
            }
        };
        share(self.non_finite, "no numbers in");
        share(self.holes, "holes in");
        share(self.phantoms, "phantoms in");
        share(self.specks, "specks in");
        words.join(", ")
    }
}

/// Opacity from which the absence of anything is a hole.
const SEEN: f64 = 0.05;

/// Compares pixels with their truth.
#[must_use]
pub fn judge(drawn: &Pixels, truth: &Pixels, quantity: Quantity, bound: f64) -> Measured {
    let mut measured = Measured {
        bound,
        ..Measured::default()
    };
    let mut errors = vec![None; truth.values.len()];
    for (at, (value, expected)) in drawn.values.iter().zip(&truth.values).enumerate() {
        let (Some(value), Some(expected)) = (value, expected) else {
            continue;
        };
        measured.judged += 1;
        // A ray that meets nothing has an infinite depth, and only that.
        let is_depth = quantity == Quantity::Depth;
        if is_depth && (value[0] == f64::INFINITY || expected[0] == f64::INFINITY) {
            measured.holes += usize::from(value[0] == f64::INFINITY && expected[0].is_finite());
            measured.phantoms += usize::from(value[0].is_finite() && !expected[0].is_finite());
            measured.non_finite += usize::from(value[0].is_nan());
            continue;
        }
        if value.iter().any(|number| !number.is_finite()) {
            measured.non_finite += 1;
            continue;
        }
        let error = (0..4)
            .map(|i| (value[i] - expected[i]).abs())
            .fold(0.0, f64::max);
        measured.error = measured.error.max(error);
        errors[at] = Some(error);
        if quantity == Quantity::Color && error > bound {
            let is_hole = expected[3] > SEEN && value[3] < 0.1 * expected[3];
            measured.holes += usize::from(is_hole);
        }
    }
    if quantity == Quantity::Color {
        measured.specks = (0..errors.len())
            .filter(|at| is_speck(*at, &errors, truth, bound))
            .count();
    }
    measured
}

/// Whether a pixel is wrong while its neighbours are right, and the truth is smooth around it.
fn is_speck(at: usize, errors: &[Option<f64>], truth: &Pixels, bound: f64) -> bool {
    let Some(error) = errors[at].filter(|error| *error > bound) else {
        return false;
    };
    let [width, height] = truth.size.map(|n| n as usize);
    let (x, y) = (at % width, at / width);
    let mut neighbours = 0;
    for ny in y.saturating_sub(1)..(y + 2).min(height) {
        for nx in x.saturating_sub(1)..(x + 2).min(width) {
            let near = ny * width + nx;
            if near == at {
                continue;
            }
            let (Some(other), Some(a), Some(b)) =
                (errors[near], truth.values[at], truth.values[near])
            else {
                continue;
            };
            let change = (0..4).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
            if other > 0.25 * error || change > 0.25 * error {
                return false;
            }
            neighbours += 1;
        }
    }
    neighbours >= 5
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(value: [f64; 4]) -> Pixels {
        Pixels {
            size: [5, 5],
            values: vec![Some(value); 25],
        }
    }

    fn measured(change: impl Fn(&mut Vec<Option<[f64; 4]>>), quantity: Quantity) -> Measured {
        let truth = flat([0.5; 4]);
        let mut drawn = truth.clone();
        change(&mut drawn.values);
        judge(&drawn, &truth, quantity, 0.01)
    }

    #[test]
    fn each_defect_is_seen() {
        assert!(measured(|_| (), Quantity::Color).holds());
        let nan = measured(|values| values[7] = Some([f64::NAN; 4]), Quantity::Color);
        assert!(nan.non_finite == 1 && !nan.holds());
        let hole = measured(|values| values[12] = Some([0.0; 4]), Quantity::Color);
        assert!(hole.holes == 1 && hole.specks == 1 && !hole.holds());
        let speck = measured(|values| values[12] = Some([0.6; 4]), Quantity::Color);
        assert!(speck.holes == 0 && speck.specks == 1 && !speck.holds());
        let shifted = measured(
            |values| values.iter_mut().for_each(|value| *value = Some([0.52; 4])),
            Quantity::Color,
        );
        assert!(shifted.specks == 0 && !shifted.holds());
        let missed = measured(
            |values| values[3] = Some([f64::INFINITY; 4]),
            Quantity::Depth,
        );
        assert!(missed.holes == 1 && missed.non_finite == 0 && !missed.holds());
        let silent = measured(|values| values.fill(None), Quantity::Color);
        assert!(!silent.holds(), "a picture of which nothing is judged");
    }
}
