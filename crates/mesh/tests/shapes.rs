//! Signed distances of shapes against closed forms.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use common::{
    Faces, Random, below, both, cuboid, cuboid_distance, icosphere, mesh, moved, torus,
    torus_distance, turned,
};
use glam::DVec3;
use volgraph_mesh::{Sign, SignMethod, SignedDistance};

const HALF: DVec3 = DVec3::new(1.0, 2.0, 0.5);

fn distances(faces: Faces, sign: Sign, method: SignMethod) -> SignedDistance {
    let distance = SignedDistance::new(&mesh(faces), sign).unwrap();
    assert_eq!(distance.method(), method);
    distance
}

/// Points everywhere, and points very near to and exactly beside each corner, edge and face of a box.
fn probes(half: DVec3) -> Vec<DVec3> {
    let mut random = Random(7);
    let mut probes: Vec<DVec3> = (0..4000).map(|_| random.point(3.0)).collect();
    for i in 0..27 {
        let side = |n: i32| f64::from(n % 3 - 1);
        let on = DVec3::new(side(i), side(i / 3), side(i / 9)) * half;
        for scale in [1e-3, 1e-6, 1e-9] {
            probes.extend((0..40).map(|_| on + random.point(scale)));
        }
    }
    probes
}

#[test]
fn a_box_is_exact_at_faces_edges_and_corners() {
    for (sign, method) in [
        (Sign::Auto, SignMethod::PseudoNormal),
        (Sign::Winding, SignMethod::Winding),
    ] {
        let distance = distances(cuboid(HALF), sign, method);
        for p in probes(HALF) {
            let (got, want) = (distance.at(p), cuboid_distance(p, HALF));
            assert!(
                (got - want).abs() < 1e-14,
                "{sign:?} {p}: {got}, not {want}"
            );
        }
    }
    let unsigned = distances(cuboid(HALF), Sign::Unsigned, SignMethod::Unsigned);
    assert_eq!(unsigned.at(DVec3::ZERO), 0.5);
}

#[test]
fn a_ball_is_as_round_as_its_chords() {
    let (positions, triangles) = icosphere(5);
    let sagitta = triangles
        .iter()
        .map(|corners| {
            corners
                .iter()
                .map(|&i| positions[i as usize])
                .sum::<DVec3>()
                / 3.0
        })
        .map(|middle| 1.0 - middle.length())
        .fold(0.0, f64::max);
    assert!(sagitta < 1e-3);
    let distance = distances((positions, triangles), Sign::Auto, SignMethod::PseudoNormal);
    let mut random = Random(3);
    for _ in 0..5000 {
        let p = random.point(2.0);
        let off = distance.at(p) - (p.length() - 1.0);
        // The mesh lies within the ball.
        assert!(
            (-1e-14..sagitta * 1.01).contains(&off),
            "{p}: {off} of {sagitta}"
        );
    }
}

#[test]
fn a_torus_is_as_round_as_its_chords() {
    let distance = distances(
        torus(2.0, 0.7, 200, 80),
        Sign::Auto,
        SignMethod::PseudoNormal,
    );
    assert_eq!(distance.report().euler, 0);
    // Sagittas of the chords around and across.
    let bound = 2.7 * (1.0 - (std::f64::consts::PI / 200.0).cos())
        + 0.7 * (1.0 - (std::f64::consts::PI / 80.0).cos());
    let mut random = Random(4);
    for _ in 0..5000 {
        let p = random.point(3.0);
        let off = distance.at(p) - torus_distance(p, 2.0, 0.7);
        assert!(off.abs() < bound, "{p}: {off} of {bound}");
    }
}

#[test]
fn an_open_bowl_has_an_inside_by_winding_numbers() {
    let bowl = below(0.0, icosphere(4));
    let distance = distances(bowl.clone(), Sign::Auto, SignMethod::Winding);
    assert!(distance.report().boundary_edges > 30);
    assert!(distance.warnings()[0].contains("not closed"));
    // A half ball's winding number is that of a disc seen from behind: 1/2 in its plane.
    for (z, want) in [
        (-0.9, true),
        (-0.5, true),
        (-0.05, true),
        (0.05, false),
        (0.5, false),
        (-1.1, false),
    ] {
        let p = DVec3::new(0.01, 0.02, z);
        assert_eq!(distance.at(p) < 0.0, want, "{z}");
    }
    let on_axis = distance.winding_number(DVec3::new(0.0, 0.0, 0.5)).unwrap();
    // The rim of the bowl is a zigzag near z = 0: the disc's solid angle is 2π (1 - cos) to a few percent.
    let want = 0.5 * (1.0 - 0.5 / 1.25_f64.sqrt());
    assert!((on_axis - want).abs() < 0.02, "{on_axis}, not {want}");
    // The distance itself is exact whatever the sign.
    let mut random = Random(5);
    for _ in 0..1000 {
        let p = random.point(0.9) - DVec3::Z;
        if p.z < -0.1 {
            let off = distance.at(p).abs() - (p.length() - 1.0).abs();
            assert!(off.abs() < 5e-3, "{p}: {off}");
        }
    }
    // Turned around, it is turned back.
    let inverted = distances(turned(bowl), Sign::Auto, SignMethod::Winding);
    assert!(inverted.warnings()[0].contains("inwards"));
    let (back, there) = (
        inverted.at(DVec3::NEG_Z * 0.5),
        distance.at(DVec3::NEG_Z * 0.5),
    );
    assert!((back - there).abs() < 1e-14, "{back}, {there}");
}

#[test]
fn overlapping_and_nested_parts_are_solid_and_cavities_are_not() {
    let ball = |x: f64, scale: f64| moved(icosphere(3), DVec3::X * x, scale);
    let sides = |faces: Faces, method: SignMethod, inside: &[f64], outside: &[f64]| {
        let distance = distances(faces, Sign::Auto, method);
        for &x in inside {
            assert!(distance.at(DVec3::X * x) < 0.0, "{x}");
        }
        for &x in outside {
            assert!(distance.at(DVec3::X * x) > 0.0, "{x}");
        }
    };
    let winding = SignMethod::Winding;
    let lens = both(ball(0.0, 1.0), ball(1.0, 1.0));
    sides(
        lens.clone(),
        winding,
        &[-0.9, 0.1, 0.5, 0.95, 1.05, 1.9],
        &[-1.1, 2.1],
    );
    let nested = both(ball(0.0, 1.0), ball(0.0, 0.5));
    sides(nested, winding, &[0.0, 0.45, 0.55, 0.95], &[1.1]);
    let cavity = both(ball(0.0, 1.0), turned(ball(0.0, 0.5)));
    sides(cavity, winding, &[0.55, 0.95], &[0.0, 0.45, 1.1]);
    let apart = both(ball(0.0, 1.0), ball(3.0, 1.0));
    sides(
        apart,
        SignMethod::PseudoNormal,
        &[0.9, 2.1, 3.5],
        &[1.1, 1.9, 4.1],
    );
    // Pseudo-normals alone take the inner wall for the outside of the other ball: why `auto` does not choose them.
    let wrong = SignedDistance::new(&mesh(lens), Sign::PseudoNormal).unwrap();
    assert!(wrong.at(DVec3::X * 1.05) > 0.0 || wrong.at(DVec3::X * -0.05) > 0.0);
    assert!(wrong.warnings()[0].contains("may be wrong"));
}

#[test]
fn a_ball_of_inverted_faces_is_turned() {
    let distance = distances(turned(icosphere(2)), Sign::Auto, SignMethod::PseudoNormal);
    assert!(distance.at(DVec3::ZERO) < -0.9 && distance.at(DVec3::X * 2.0) > 0.9);
    assert!(distance.warnings()[0].contains("inwards"));
    // Edges and corners were turned with the faces.
    let distance = distances(turned(cuboid(HALF)), Sign::Auto, SignMethod::PseudoNormal);
    for p in probes(HALF) {
        let (got, want) = (distance.at(p), cuboid_distance(p, HALF));
        assert!((got - want).abs() < 1e-14, "{p}: {got}, not {want}");
    }
}

/// A ball whose vertices were moved in and out at random: sharp edges, and corners that are peak and pit at once.
fn thorns(seed: u64) -> Faces {
    let (mut positions, triangles) = icosphere(2);
    let mut random = Random(seed);
    for position in &mut positions {
        *position *= 0.15 + random.unit().powi(2);
    }
    (positions, triangles)
}

#[test]
fn thorns_have_the_side_that_all_solid_angles_tell() {
    for seed in [1, 2, 3] {
        for faces in [thorns(seed), turned(thorns(seed))] {
            let (positions, triangles) = faces.clone();
            let normal = distances(faces.clone(), Sign::Auto, SignMethod::PseudoNormal);
            let winding = distances(faces, Sign::Winding, SignMethod::Winding);
            let mut random = Random(seed);
            let mut probes: Vec<DVec3> = (0..1000).map(|_| random.point(1.0)).collect();
            for &[a, b, _] in &triangles {
                let [a, b] = [a, b].map(|i| positions[i as usize]);
                let along = a.lerp(b, random.unit());
                for scale in [0.1, 1e-4] {
                    probes.extend([a, along].map(|on| on + random.point(scale)));
                }
            }
            for p in probes {
                let whole: f64 = triangles
                    .iter()
                    .map(|corners| {
                        let [a, b, c] = corners.map(|i| positions[i as usize] - p);
                        let (la, lb, lc) = (a.length(), b.length(), c.length());
                        let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
                        2.0 * a.dot(b.cross(c)).atan2(below)
                    })
                    .sum();
                let inside = whole.abs() > 2.0 * std::f64::consts::PI;
                assert_eq!(normal.at(p) < 0.0, inside, "pseudo-normals at {p}");
                assert_eq!(winding.at(p) < 0.0, inside, "winding numbers at {p}");
            }
        }
    }
}

#[test]
fn repeated_vertices_are_one() {
    let (positions, triangles) = cuboid(HALF);
    let soup: Vec<DVec3> = triangles
        .iter()
        .flatten()
        .map(|&i| positions[i as usize])
        .collect();
    let numbered = (0..12).map(|i| [i * 3, i * 3 + 1, i * 3 + 2]).collect();
    // Moved so that coordinates are 0, of either sign.
    let signed = (0..).zip(&soup).map(|(i, &p)| match i % 2 {
        0 => p - HALF,
        _ => -(HALF - p),
    });
    let signed: Vec<DVec3> = signed.collect();
    assert!(
        signed
            .iter()
            .flat_map(DVec3::to_array)
            .any(|x| x == 0.0 && x.is_sign_negative())
    );
    let report = mesh((signed, numbered)).report();
    assert!(report.is_watertight(), "0 and -0 are one place");
    let numbered = (0..12).map(|i| [i * 3, i * 3 + 1, i * 3 + 2]).collect();
    let report = mesh((soup.clone(), numbered)).report();
    assert!(report.is_watertight() && report.is_oriented());
    assert_eq!(
        (report.vertices, report.duplicates, report.euler),
        (36, 28, 2)
    );
    let numbered = (0..12).map(|i| [i * 3, i * 3 + 1, i * 3 + 2]).collect();
    let distance = distances((soup, numbered), Sign::Auto, SignMethod::PseudoNormal);
    let p = HALF + 1e-7;
    assert!((distance.at(p) - cuboid_distance(p, HALF)).abs() < 1e-15);
}

#[test]
fn reports_count_what_is_wrong() {
    let report = mesh(cuboid(HALF)).report();
    assert_eq!(
        (report.vertices, report.triangles, report.components),
        (8, 12, 1)
    );
    assert!((report.signed_volume - 8.0).abs() < 1e-12);
    assert_eq!(report.bounds, (-HALF, HALF));
    let (positions, mut triangles) = cuboid(HALF);
    triangles[0].swap(0, 1);
    let report = mesh((positions.clone(), triangles.clone())).report();
    assert_eq!(
        (
            report.turned_edges,
            report.is_watertight(),
            report.is_oriented()
        ),
        (3, true, false)
    );
    triangles.remove(0);
    let report = mesh((positions.clone(), triangles.clone())).report();
    assert_eq!(
        (report.boundary_edges, report.turned_edges, report.euler),
        (3, 0, 1)
    );
    triangles.push(triangles[0]);
    let report = mesh((positions, triangles)).report();
    assert_eq!(report.non_manifold_edges, 2);
    let text = report.to_string();
    assert!(
        text.contains("non-manifold edges  2") && text.contains("watertight          no"),
        "{text}"
    );
    let report = mesh(both(cuboid(HALF), moved(cuboid(HALF), DVec3::X * 5.0, 1.0))).report();
    assert_eq!(
        (report.components, report.components_meet, report.euler),
        (2, false, 4)
    );
}
