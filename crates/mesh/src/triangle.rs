//! One triangle: its nearest point, the feature that point lies on, and the solid angle it is seen under.

use glam::DVec3;

/// What of a triangle a nearest point lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Feature {
    Face,
    /// From this corner (0 to 2) to the next.
    Edge(usize),
    Corner(usize),
}

/// How thin a triangle may be: the sine of its widest corner as seen from the longest sides.
const THINNEST: f64 = 1e-14;

/// Whether the corners span a plane that float64 can tell.
pub(crate) fn has_area(&[a, b, c]: &[DVec3; 3]) -> bool {
    // Divided by the size first: squares of very small or very large coordinates leave the range of float64.
    let size = (b - a).abs().max((c - a).abs()).max_element();
    if !(size > 0.0 && size.is_finite()) {
        return false;
    }
    let (u, v) = ((b - a) / size, (c - a) / size);
    u.cross(v).length_squared() > THINNEST * THINNEST
}

/// The point of a triangle that is nearest to `p`, and what it lies on (Ericson, Real-Time Collision Detection,
/// 5.1.5).
pub(crate) fn nearest(p: DVec3, &[a, b, c]: &[DVec3; 3]) -> (DVec3, Feature) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, Feature::Corner(0));
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (b, Feature::Corner(1));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + ab * part(d1, d1 - d3), Feature::Edge(0));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (c, Feature::Corner(2));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + ac * part(d2, d2 - d6), Feature::Edge(2));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let w = part(d4 - d3, (d4 - d3) + (d5 - d6));
        return (b + (c - b) * w, Feature::Edge(1));
    }
    let all = va + vb + vc;
    (a + ab * part(vb, all) + ac * part(vc, all), Feature::Face)
}

/// A part of a whole from 0 to 1. A triangle may be so small and so far that all its points are equally near: then any
/// part is good, and 0 / 0 is none.
fn part(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

/// The solid angle of a triangle seen from `p`, positive from behind its face (Van Oosterom & Strackee 1983, eq. 8).
pub(crate) fn solid_angle(p: DVec3, corners: &[DVec3; 3]) -> f64 {
    let [a, b, c] = corners.map(|corner| corner - p);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * a.dot(b.cross(c)).atan2(below)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn each_feature_is_nearest_where_it_should_be() {
        for (p, want, feature) in [
            ((0.2, 0.3, 5.0), (0.2, 0.3, 0.0), Feature::Face),
            ((0.5, -2.0, 1.0), (0.5, 0.0, 0.0), Feature::Edge(0)),
            ((2.0, 2.0, 1.0), (0.5, 0.5, 0.0), Feature::Edge(1)),
            ((-1.0, 0.5, 1.0), (0.0, 0.5, 0.0), Feature::Edge(2)),
            ((-1.0, -2.0, 1.0), (0.0, 0.0, 0.0), Feature::Corner(0)),
            ((3.0, -1.0, 1.0), (1.0, 0.0, 0.0), Feature::Corner(1)),
            ((-1.0, 3.0, 1.0), (0.0, 1.0, 0.0), Feature::Corner(2)),
        ] {
            let (got, at) = nearest(p.into(), &CORNERS);
            assert!(got.abs_diff_eq(want.into(), 1e-15), "{p:?}: {got}");
            assert_eq!(at, feature, "{p:?}");
        }
    }

    #[test]
    fn all_points_of_a_tiny_triangle_are_equally_near() {
        let tiny = 1e-17;
        let corners = [
            DVec3::ZERO,
            DVec3::new(tiny, tiny, 0.0),
            DVec3::new(0.0, 0.0, tiny),
        ];
        let (got, _) = nearest(DVec3::new(0.5, -0.5, 0.5), &corners);
        assert!(got.abs().max_element() <= tiny, "{got}");
    }

    #[test]
    fn a_corner_of_a_cube_is_an_eighth_of_all_directions() {
        let corners = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * 3.0);
        let eighth = std::f64::consts::PI / 2.0;
        assert!((solid_angle(DVec3::ZERO, &corners) - eighth).abs() < 1e-15);
        let [a, b, c] = corners;
        assert!((solid_angle(DVec3::ZERO, &[a, c, b]) + eighth).abs() < 1e-15);
    }

    #[test]
    fn thin_triangles_have_an_area_and_lines_have_none() {
        let with = |c: DVec3, scale: f64| has_area(&[DVec3::ZERO, DVec3::X, c].map(|p| p * scale));
        for scale in [1e-200, 1.0, 1e200] {
            assert!(with(DVec3::new(0.5, 1e-9, 0.0), scale));
            assert!(!with(DVec3::new(0.5, 0.0, 0.0), scale));
            assert!(!with(DVec3::X, scale));
        }
    }
}
