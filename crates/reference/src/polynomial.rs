//! Polynomials of a parameter between 0 and 1: what a scalar, or a gradient, is along a ray inside of one cell.

/// Terms that there is room for: of a tricubic field, of degree 9.
const TERMS: usize = 10;

/// A polynomial of degree 9 at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polynomial {
    /// Of the powers 0 and up; those behind `count` are 0.
    terms: [f64; TERMS],
    count: usize,
}

/// Parameters strictly between 0 and 1, rising.
#[derive(Clone, Copy, Debug)]
pub struct Roots {
    at: [f64; TERMS],
    count: usize,
}

impl Roots {
    const NONE: Self = Self {
        at: [0.0; TERMS],
        count: 0,
    };

    fn push(&mut self, root: f64) {
        if self.count < TERMS {
            self.at[self.count] = root;
            self.count += 1;
        }
    }

    /// The roots.
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        &self.at[..self.count]
    }
}

impl Polynomial {
    /// Of up to ten terms, the constant one first; more are left out.
    #[must_use]
    pub fn new(given: &[f64]) -> Self {
        let mut terms = [0.0; TERMS];
        let count = given.len().clamp(1, TERMS);
        for (to, from) in terms.iter_mut().zip(given) {
            *to = *from;
        }
        Self { terms, count }
    }

    /// The cubic through four values, at 0, 1/3, 2/3 and 1 (Newton's divided differences).
    #[must_use]
    pub fn through([a, b, c, d]: [f64; 4]) -> Self {
        let cube = 4.5 * (d - 3.0 * c + 3.0 * b - a);
        let square = 4.5 * (a - 2.0 * b + c) - cube;
        Self::new(&[a, d - a - cube - square, square, cube])
    }

    /// Its terms.
    #[must_use]
    pub fn terms(&self) -> &[f64] {
        &self.terms[..self.count]
    }

    /// Its value.
    #[must_use]
    pub fn at(&self, w: f64) -> f64 {
        let terms = self.terms().iter().rev();
        terms.fold(0.0, |sum, term| sum * w + term)
    }

    /// Its slope.
    #[must_use]
    pub fn slope(&self, w: f64) -> f64 {
        let mut sum = 0.0;
        for power in (1..self.count).rev() {
            sum = sum * w + power as f64 * self.terms[power];
        }
        sum
    }

    /// Its derivative.
    #[must_use]
    pub fn derivative(&self) -> Self {
        let mut terms = [0.0; TERMS];
        for power in 1..self.count {
            terms[power - 1] = power as f64 * self.terms[power];
        }
        Self {
            terms,
            count: (self.count - 1).max(1),
        }
    }

    /// Its integral from one parameter to another.
    #[must_use]
    pub fn integral(&self, from: f64, to: f64) -> f64 {
        let up_to = |w: f64| {
            let mut sum = 0.0;
            for power in (0..self.count).rev() {
                sum = (sum + self.terms[power] / (power as f64 + 1.0)) * w;
            }
            sum
        };
        up_to(to) - up_to(from)
    }

    /// The sum of both.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            terms: std::array::from_fn(|i| self.terms[i] + other.terms[i]),
            count: self.count.max(other.count),
        }
    }

    /// That many times it.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self {
            terms: self.terms.map(|term| factor * term),
            count: self.count,
        }
    }

    /// The product of both; terms beyond degree 9 must be 0.
    #[must_use]
    pub fn by(&self, other: &Self) -> Self {
        let mut terms = [0.0; TERMS];
        for (i, a) in self.terms().iter().enumerate() {
            for (j, b) in other.terms().iter().enumerate() {
                if let Some(term) = terms.get_mut(i + j) {
                    *term += a * b;
                }
            }
        }
        Self {
            terms,
            count: (self.count + other.count - 1).min(TERMS),
        }
    }

    /// The polynomial of `start + w change`.
    #[must_use]
    pub fn of(&self, start: f64, change: f64) -> Self {
        let line = Self::new(&[start, change]);
        let mut sum = Self::new(&[0.0]);
        for term in self.terms().iter().rev() {
            sum = sum.by(&line).plus(&Self::new(&[*term]));
        }
        sum
    }

    /// Whether all of its values between 0 and 1 have one sign: those of its control points in Bernstein's form have.
    fn is_of_one_sign(&self) -> bool {
        let degree = self.count - 1;
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for i in 0..=degree {
            // C(i, k) / C(degree, k), k rising.
            let mut share = 1.0;
            let mut point = 0.0;
            for k in 0..=i {
                point += share * self.terms[k];
                if k < i {
                    share *= (i - k) as f64 / (degree - k) as f64;
                }
            }
            least = least.min(point);
            most = most.max(point);
        }
        least > 0.0 || most < 0.0
    }

    /// Where its sign changes, strictly between 0 and 1.
    #[must_use]
    pub fn sign_changes(&self) -> Roots {
        let mut roots = Roots::NONE;
        if self.count < 2 || self.is_of_one_sign() {
            return roots;
        }
        let mut low = 0.0;
        let turns = self.turns();
        for high in turns.as_slice().iter().copied().chain([1.0]) {
            if (self.at(low) >= 0.0) != (self.at(high) >= 0.0) {
                let root = self.solve(low, high, 0.0);
                if 0.0 < root && root < 1.0 {
                    roots.push(root);
                }
            }
            low = high;
        }
        roots
    }

    /// The parameters between 0 and 1 at which it turns: it is monotone between neighbours.
    #[must_use]
    pub fn turns(&self) -> Roots {
        if self.count > 4 {
            return self.derivative().sign_changes();
        }
        let [_, b, c, d] = [0, 1, 2, 3].map(|i| self.terms[i]);
        let mut turns = Roots::NONE;
        let (first, second) = quadratic_roots(3.0 * d, 2.0 * c, b);
        let mut last = 0.0;
        for root in [first, second] {
            if root > last && root < 1.0 {
                turns.push(root);
                last = root;
            }
        }
        turns
    }

    /// The parameter in `low..high`, between which it is monotone, at which it takes a value between those at the ends:
    /// bisection, with Newton's steps where they stay inside.
    #[must_use]
    pub fn solve(&self, low: f64, high: f64, value: f64) -> f64 {
        let (mut low, mut high) = (low, high);
        let rises = self.at(high) >= self.at(low);
        let mut w = 0.5 * (low + high);
        for _ in 0..64 {
            let off = self.at(w) - value;
            if off == 0.0 {
                break;
            }
            if (off > 0.0) == rises {
                high = w;
            } else {
                low = w;
            }
            let step = w - off / self.slope(w);
            let next = if step > low && step < high {
                step
            } else {
                0.5 * (low + high)
            };
            if next == w || high - low <= f64::EPSILON {
                break;
            }
            w = next;
        }
        w
    }
}

/// The real roots of `a x² + b x + c`, rising; those that there are not are not-a-number.
fn quadratic_roots(a: f64, b: f64, c: f64) -> (f64, f64) {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return (f64::NAN, f64::NAN);
    }
    // No cancellation: the larger root in size first, the other by the product of both.
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    let (first, second) = (q / a, c / q);
    // Also where one of them is not-a-number.
    if first <= second {
        (first, second)
    } else {
        (second, first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_of_a_product_are_those_of_its_factors() {
        let places = [0.05, 0.2, 0.21, 0.5, 0.75, 0.9];
        let mut product = Polynomial::new(&[1.0]);
        for place in places {
            product = product.by(&Polynomial::new(&[-place, 1.0]));
        }
        let roots = product.sign_changes();
        assert_eq!(roots.as_slice().len(), places.len());
        for (root, place) in roots.as_slice().iter().zip(places) {
            assert!((root - place).abs() < 1e-9, "{root} {place}");
        }
        // A double root is no change of the sign.
        let square = Polynomial::new(&[0.25, -1.0, 1.0]);
        assert!(square.sign_changes().as_slice().is_empty());
    }

    #[test]
    fn substitution_integral_and_slope_agree() {
        let p = Polynomial::new(&[0.3, -1.0, 2.0, 0.7]);
        let q = p.of(0.25, 0.5);
        for w in [0.0, 0.3, 1.0] {
            assert!((q.at(w) - p.at(0.25 + 0.5 * w)).abs() < 1e-14);
            assert!((p.derivative().at(w) - p.slope(w)).abs() < 1e-14);
        }
        assert!((q.integral(0.0, 1.0) * 0.5 - p.integral(0.25, 0.75)).abs() < 1e-14);
        let values = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|w| p.at(w));
        assert!((Polynomial::through(values).at(0.4) - p.at(0.4)).abs() < 1e-13);
    }
}
