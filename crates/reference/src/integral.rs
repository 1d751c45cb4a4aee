//! Emission and absorption over a smooth piece of a ray, to a tolerance.
//!
//! Extinction and emission are taken at seven Gauss-Legendre points; the optical depth up to each of them is the
//! integral of the polynomial through the extinctions (collocation), and the emission seen through it is summed by
//! Gauss's weights. The last two Legendre coefficients of both integrands bound the error from above: what they
//! leave out is smaller still; and the emission of white must come to the opacity, which is known. Where the bound is over
//! the tolerance, the piece is halved.

use std::sync::OnceLock;

use crate::curve::Curve;

/// Points of the rule.
const POINTS: usize = 7;

/// A part of a piece is halved at most so often, and a piece has at most so many parts: rounding sets an end to what
/// halving gains. What is left then counts as error.
const MAX_HALVINGS: u32 = 40;
const MAX_PARTS: u32 = 4096;

struct Rule {
    /// In -1..1.
    nodes: [f64; POINTS],
    weights: [f64; POINTS],
    /// `inner[i][j]`: what the value at node j adds to the integral from -1 to node i.
    inner: [[f64; POINTS]; POINTS],
    /// `coefficients[k][j]`: what the value at node j adds to the Legendre coefficient k.
    coefficients: [[f64; POINTS]; POINTS],
}

/// Legendre polynomials 0 to n at x.
fn legendre(x: f64) -> [f64; POINTS + 1] {
    let mut values = [1.0; POINTS + 1];
    values[1] = x;
    for k in 1..POINTS {
        let n = k as f64;
        values[k + 1] = ((2.0 * n + 1.0) * x * values[k] - n * values[k - 1]) / (n + 1.0);
    }
    values
}

fn rule() -> &'static Rule {
    static RULE: OnceLock<Rule> = OnceLock::new();
    RULE.get_or_init(|| {
        let n = POINTS as f64;
        let mut nodes = [0.0; POINTS];
        let mut weights = [0.0; POINTS];
        for (i, (node, weight)) in nodes.iter_mut().zip(&mut weights).enumerate() {
            let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..50 {
                let values = legendre(x);
                slope = n * (x * values[POINTS] - values[POINTS - 1]) / (x * x - 1.0);
                x -= values[POINTS] / slope;
            }
            *node = x;
            *weight = 2.0 / ((1.0 - x * x) * slope * slope);
        }
        let at = nodes.map(legendre);
        let coefficients = std::array::from_fn(|k| {
            std::array::from_fn(|j| (k as f64 + 0.5) * weights[j] * at[j][k])
        });
        let inner = std::array::from_fn(|i: usize| {
            std::array::from_fn(|j: usize| {
                (0..POINTS)
                    .map(|k| {
                        let coefficient: f64 = (k as f64 + 0.5) * weights[j] * at[j][k];
                        let integral = if k == 0 {
                            nodes[i] + 1.0
                        } else {
                            (at[i][k + 1] - at[i][k - 1]) / (2.0 * k as f64 + 1.0)
                        };
                        coefficient * integral
                    })
                    .sum()
            })
        });
        Rule {
            nodes,
            weights,
            inner,
            coefficients,
        }
    })
}

/// What a ray has met so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Linear premultiplied colour.
    pub color: [f64; 3],
    /// Share of the light behind that still reaches the eye.
    pub transmittance: f64,
    /// Distance at which half of the light is gone, once it is.
    pub half: Option<f64>,
    /// Bound of the absolute error of any component so far.
    pub error: f64,
    /// No component of what is yet to come is larger.
    pub brightest: f64,
}

impl Default for Light {
    fn default() -> Self {
        Self {
            color: [0.0; 3],
            transmittance: 1.0,
            half: None,
            error: 0.0,
            brightest: 1.0,
        }
    }
}

impl Light {
    /// Adds a surface of a linear colour and an opacity at a distance.
    pub fn surface(&mut self, color: [f64; 3], opacity: f64, distance: f64) {
        for (sum, value) in self.color.iter_mut().zip(color) {
            *sum += self.transmittance * opacity * value;
        }
        self.transmittance *= 1.0 - opacity;
        if self.half.is_none() && self.transmittance <= 0.5 {
            self.half = Some(distance);
        }
    }

    /// Adds what lies between the parameters `from` and `to` of a curve; `matter` gives linear colour and extinction per
    /// world unit at a parameter, and is smooth between them. The error is at most `allowance` per world unit.
    pub fn piece(
        &mut self,
        curve: &Curve,
        (from, to): (f64, f64),
        allowance: f64,
        matter: impl Fn(f64) -> ([f64; 3], f64),
    ) {
        let length = curve.end - curve.start;
        // Parts still to do, the next one last: (start, end, halvings).
        let mut open = [(0.0, 0.0, 0_u32); MAX_HALVINGS as usize + 2];
        open[0] = (from, to, 0);
        let mut count = 1;
        let mut parts = 0;
        while count > 0 {
            count -= 1;
            parts += 1;
            let (start, end, halvings) = open[count];
            let part = Part::new((start, end), length, self.brightest, &matter);
            let error = self.transmittance * part.error;
            let is_over = error > allowance * (end - start) * length;
            if is_over && halvings < MAX_HALVINGS && parts < MAX_PARTS {
                let middle = 0.5 * (start + end);
                open[count] = (middle, end, halvings + 1);
                open[count + 1] = (start, middle, halvings + 1);
                count += 2;
                continue;
            }
            self.add(curve, &part, error);
        }
    }

    fn add(&mut self, curve: &Curve, part: &Part, error: f64) {
        let after = self.transmittance * (-part.depth).exp();
        if self.half.is_none() && after <= 0.5 {
            let depth = (2.0 * self.transmittance).ln().max(0.0);
            self.half = Some(curve.distance(part.place_of(depth)));
        }
        for (sum, value) in self.color.iter_mut().zip(part.color) {
            *sum += self.transmittance * value;
        }
        self.transmittance = after;
        self.error += error;
    }
}

/// A part of a piece: parameters of its curve.
struct Part {
    start: f64,
    end: f64,
    /// World length of the curve.
    length: f64,
    color: [f64; 3],
    depth: f64,
    /// Of the extinction over it.
    extinctions: [f64; POINTS],
    error: f64,
}

impl Part {
    fn new(
        (start, end): (f64, f64),
        length: f64,
        brightest: f64,
        matter: &impl Fn(f64) -> ([f64; 3], f64),
    ) -> Self {
        let rule = rule();
        let (middle, reach) = (0.5 * (start + end), 0.5 * (end - start));
        let half = reach * length;
        let mut colors = [[0.0; 3]; POINTS];
        let mut extinctions = [0.0; POINTS];
        for (i, node) in rule.nodes.iter().enumerate() {
            (colors[i], extinctions[i]) = matter(middle + reach * node);
        }
        if extinctions == [0.0; POINTS] {
            return Self {
                start,
                end,
                length,
                color: [0.0; 3],
                depth: 0.0,
                extinctions,
                error: 0.0,
            };
        }
        let sum = |weights: &[f64; POINTS], values: &[f64; POINTS]| -> f64 {
            weights.iter().zip(values).map(|(w, v)| w * v).sum()
        };
        let depth = half * sum(&rule.weights, &extinctions);
        let mut emitted = [0.0; POINTS];
        for i in 0..POINTS {
            let before = half * sum(&rule.inner[i], &extinctions);
            emitted[i] = extinctions[i] * (-before).exp();
        }
        let mut color = [0.0; 3];
        let mut error: f64 = 0.0;
        let tail = |values: &[f64; POINTS]| {
            2.0 * half
                * (sum(&rule.coefficients[POINTS - 1], values).abs()
                    + sum(&rule.coefficients[POINTS - 2], values).abs())
        };
        for channel in 0..3 {
            let values: [f64; POINTS] = std::array::from_fn(|i| colors[i][channel] * emitted[i]);
            color[channel] = half * sum(&rule.weights, &values);
            error = error.max(tail(&values));
        }
        // What is emitted in white is the opacity, which is known. In a piece so deep that all points but none of its light
        // are behind the light's end, this alone tells.
        let opacity = half * sum(&rule.weights, &emitted);
        let missed = (opacity + (-depth).exp_m1()).abs();
        let white = colors.iter().flatten().copied().fold(0.0, f64::max);
        error = error.max(white * missed);
        // An error of the depth changes everything behind it.
        error = error.max(tail(&emitted)) + brightest * tail(&extinctions).min(1.0);
        Self {
            start,
            end,
            length,
            color,
            depth,
            extinctions,
            error,
        }
    }

    /// The parameter up to which the optical depth is `depth`.
    fn place_of(&self, depth: f64) -> f64 {
        let rule = rule();
        let reach = 0.5 * (self.end - self.start);
        let half = reach * self.length;
        let coefficients: [f64; POINTS] = std::array::from_fn(|k| {
            let terms = rule.coefficients[k].iter().zip(&self.extinctions);
            terms.map(|(w, v)| w * v).sum()
        });
        let up_to = |x: f64| {
            let values = legendre(x);
            let terms = (1..POINTS).map(|k| {
                coefficients[k] * (values[k + 1] - values[k - 1]) / (2.0 * k as f64 + 1.0)
            });
            half * (coefficients[0] * (x + 1.0) + terms.sum::<f64>())
        };
        let (mut low, mut high) = (-1.0, 1.0);
        for _ in 0..52 {
            let middle = 0.5 * (low + high);
            if up_to(middle) < depth {
                low = middle;
            } else {
                high = middle;
            }
        }
        self.start + reach * (low + 1.0)
    }
}
