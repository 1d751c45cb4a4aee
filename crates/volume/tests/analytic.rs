//! Analytic fields against their own definitions: gradients, ranges, symmetry, samples.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use glam::DVec3;
use volgraph_volume::analytic::{AnalyticField, FIELDS, grid, sample, voxel_centre};
use volgraph_volume::{ScalarType, Voxels};

/// Points spread evenly over the cube (the R3 sequence of Roberts), none of them special.
fn points(count: u32) -> impl Iterator<Item = DVec3> {
    let step = DVec3::new(
        0.819_172_513_396_164,
        0.671_043_606_703_789,
        0.549_700_477_901_970,
    );
    (1..=count).map(move |i| (step * f64::from(i)).fract() * 2.0 - 1.0)
}

fn field(name: &str, params: &[(&str, f64)]) -> AnalyticField {
    let params: Vec<_> = params
        .iter()
        .map(|&(name, value)| (name.to_owned(), value))
        .collect();
    AnalyticField::by_name(name, &params).unwrap()
}

fn all() -> Vec<AnalyticField> {
    let mut all: Vec<_> = AnalyticField::names()
        .map(|name| field(name, &[]))
        .collect();
    for (n, l, m) in [
        (1, 0, 0),
        (2, 1, 0),
        (2, 1, -1),
        (3, 2, 2),
        (4, 3, -2),
        (5, 1, 1),
        (10, 9, 4),
        (10, 0, 0),
    ] {
        let quantum = [
            ("n", f64::from(n)),
            ("l", f64::from(l)),
            ("m", f64::from(m)),
        ];
        all.push(field("hydrogen", &quantum));
    }
    all.push(field("ramp", &[("x", 1.0), ("y", -2.0), ("z", 3.0)]));
    all
}

/// Largest difference between a gradient and the central differences of Richardson's fourth order.
fn gradient_error(field: &AnalyticField, gradient: impl Fn(DVec3) -> DVec3) -> f64 {
    let h = 1e-3 / 4.0;
    let difference = |p: DVec3, axis: DVec3, h: f64| {
        (field.value(p + axis * h) - field.value(p - axis * h)) / (2.0 * h)
    };
    let numeric =
        |p: DVec3, axis: DVec3| (4.0 * difference(p, axis, h / 2.0) - difference(p, axis, h)) / 3.0;
    points(300)
        .map(|p| {
            let exact = gradient(p);
            let numeric = DVec3::from_array(DVec3::AXES.map(|axis| numeric(p, axis)));
            (exact - numeric).length() / exact.length().max(1.0)
        })
        .fold(0.0, f64::max)
}

#[test]
fn gradients_are_those_of_the_values() {
    for field in all() {
        let error = gradient_error(&field, |p| field.gradient(p));
        assert!(error < 2e-7, "{field:?}: {error:e}");
    }
    // The check sees a wrong factor and a wrong sign.
    let gyroid = field("gyroid", &[]);
    assert!(gradient_error(&gyroid, |p| gyroid.gradient(p) * 1.00001) > 2e-6);
    assert!(gradient_error(&gyroid, |p| gyroid.gradient(p) * DVec3::new(1.0, 1.0, -1.0)) > 0.1);
}

#[test]
fn gradients_are_zero_where_there_is_none() {
    for field in all() {
        let gradient = field.gradient(DVec3::ZERO);
        assert!(
            gradient.is_finite() && field.value(DVec3::ZERO).is_finite(),
            "{field:?}"
        );
    }
    assert_eq!(field("sphere", &[]).gradient(DVec3::ZERO), DVec3::ZERO);
    assert!(
        field("torus", &[])
            .gradient(DVec3::new(0.55, 0.0, 0.0))
            .is_finite()
    );
}

#[test]
fn the_marschner_lobb_signal_has_the_papers_values() {
    let signal = field("marschner_lobb", &[]);
    // By hand: on the axis ρ_r(0) = cos(12 π) = 1; at r = 1 ρ_r = cos(12 π cos(π/2)) = 1.
    assert!((signal.value(DVec3::ZERO) - 1.5 / 2.5).abs() < 1e-12);
    assert!((signal.value(DVec3::new(0.6, 0.8, 1.0)) - 0.5 / 2.5).abs() < 1e-12);
    // Where 12 cos(π r / 2) = 11, ρ_r = −1.
    let r = (11.0_f64 / 12.0).acos() * 2.0 / std::f64::consts::PI;
    assert!((signal.value(DVec3::new(r, 0.0, 0.0)) - 1.0 / 2.5).abs() < 1e-12);
    let range = points(20_000)
        .map(|p| signal.value(p))
        .fold((1.0_f64, 0.0_f64), |(lo, hi), v| (lo.min(v), hi.max(v)));
    assert!(
        range.0 >= 0.0 && range.0 < 0.01 && range.1 <= 1.0 && range.1 > 0.99,
        "{range:?}"
    );
}

#[test]
fn c60_has_sixty_atoms_with_three_neighbours_each() {
    let AnalyticField::C60(c60) = field("c60", &[]) else {
        panic!("not c60");
    };
    let field = AnalyticField::C60(c60.clone());
    let atoms = c60.atoms();
    assert_eq!(atoms.len(), 60);
    // Edge over circumradius of the truncated icosahedron: 2 / √(9 φ + 10).
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let edge = 0.72 * 2.0 / (9.0 * golden + 10.0).sqrt();
    for atom in atoms {
        assert!((atom.length() - 0.72).abs() < 1e-14);
        assert!((field.value(*atom) - 1.0).abs() < 1e-12);
        let distances = || atoms.iter().map(|other| atom.distance(*other));
        assert_eq!(distances().filter(|d| (d - edge).abs() < 1e-12).count(), 3);
        assert_eq!(
            distances().filter(|d| *d < edge - 1e-12).count(),
            1,
            "only itself is nearer"
        );
    }
    // Uphill from an atom to the brightest point near it: the doc's bound.
    let mut p = atoms[0];
    for _ in 0..200 {
        p += field.gradient(p) * 1e-3;
    }
    assert!(field.gradient(p).length() < 1e-6);
    assert!((1.0..1.001).contains(&field.value(p)), "{}", field.value(p));
}

#[test]
fn orbitals_match_closed_forms_and_peak_at_one() {
    // 1s: exp(−2 r); 2p_z: z² exp(−r) e² / 4; 3d_xy-like (m = −2): (x y)² exp(−2 r / 3) scaled.
    let s = field("hydrogen", &[("n", 1.0), ("l", 0.0), ("extent", 3.0)]);
    let pz = field("hydrogen", &[("n", 2.0), ("l", 1.0), ("extent", 10.0)]);
    let dxy = field(
        "hydrogen",
        &[("n", 3.0), ("l", 2.0), ("m", -2.0), ("extent", 10.0)],
    );
    for p in points(50) {
        assert!((s.value(p) - (-6.0 * p.length()).exp()).abs() < 1e-12);
        let q = p * 10.0;
        let e = std::f64::consts::E;
        assert!((pz.value(p) - q.z * q.z * (-q.length()).exp() * e * e / 4.0).abs() < 1e-12);
        // (x y)² r⁴ peaks at r = 6 on the diagonals, where x y = r² / 2.
        let peak = (6.0_f64.powi(2) / 2.0).powi(2) * (-4.0_f64).exp();
        let density = (q.x * q.y).powi(2) * (-2.0 * q.length() / 3.0).exp();
        assert!((dxy.value(p) - density / peak).abs() < 1e-12);
    }
    for field in all().iter().filter(|field| field.name() == "hydrogen") {
        let best = points(40_000).map(|p| field.value(p)).fold(0.0, f64::max);
        assert!(best <= 1.0 + 1e-12, "{field:?}: {best}");
    }
    // A d orbital's doughnut: the node of Y20 lies where 3 cos² θ = 1.
    let d = field("hydrogen", &[]);
    assert!(d.value(DVec3::new(0.2, 0.2, 0.2)) < 1e-24);
}

#[test]
fn surfaces_lie_where_they_are_said_to() {
    for p in points(20) {
        let on_sphere = p.normalize() * 0.7;
        assert!((field("sphere", &[]).value(on_sphere) - 0.5).abs() < 1e-14);
        let ring = p.truncate().normalize();
        let on_torus = (ring * (0.55 + 0.25 * p.z.cos())).extend(0.25 * p.z.sin());
        assert!((field("torus", &[]).value(on_torus) - 0.5).abs() < 1e-14);
    }
    let ramp = field("ramp", &[("x", 1.0), ("y", -2.0), ("z", 3.0)]);
    assert_eq!(ramp.value(DVec3::new(1.0, -1.0, 1.0)), 1.0);
    assert_eq!(ramp.value(DVec3::new(-1.0, 1.0, -1.0)), 0.0);
    for name in ["sphere", "torus", "gyroid", "ramp", "marschner_lobb"] {
        let corners = (0..8).map(|i| {
            DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 2.0 - 1.0
        });
        for p in points(2000).chain(corners) {
            let value = field(name, &[]).value(p);
            assert!((0.0..=1.0).contains(&value), "{name} at {p}: {value}");
        }
    }
}

#[test]
fn samples_are_the_field_at_voxel_centres() {
    let dims = [5, 4, 3];
    for field in all() {
        let volume = sample(&field, dims, ScalarType::F64).unwrap();
        let bytes = sample(&field, dims, ScalarType::U8).unwrap();
        let shorts = sample(&field, dims, ScalarType::I16).unwrap();
        assert_eq!((volume.name(), *volume.grid()), (field.name(), grid(dims)));
        for z in 0..3 {
            for y in 0..4 {
                for x in 0..5 {
                    let centre = voxel_centre(dims, [x, y, z]);
                    let index = DVec3::new(x.into(), y.into(), z.into());
                    let world = volume.grid().world_from_index.transform_point3(index);
                    assert!((world * 2.0 - centre).length() < 1e-15);
                    let value = field.value(centre);
                    assert_eq!(volume.voxel([x, y, z]), value);
                    assert_eq!(
                        bytes.voxel([x, y, z]),
                        (value.clamp(0.0, 1.0) * 255.0).round()
                    );
                    assert_eq!(
                        shorts.voxel([x, y, z]),
                        (value.clamp(-1.0, 1.0) * 32767.0).round()
                    );
                }
            }
        }
    }
    let (lo, hi) = (grid(dims).corners_world()[0], grid(dims).corners_world()[7]);
    assert!((lo + 0.5).length() < 1e-15 && (hi - 0.5).length() < 1e-15);
    for ty in ScalarType::ALL {
        let volume = sample(&field("constant", &[("value", 1.0)]), [2, 1, 1], ty).unwrap();
        assert_eq!(volume.voxels().scalar_type(), ty);
        assert_eq!(
            volume.voxels().get(1),
            ty.range().map_or(1.0, |(_, max)| max)
        );
    }
    let once = sample(&field("c60", &[]), [16; 3], ScalarType::F32).unwrap();
    let twice = sample(&field("c60", &[]), [16; 3], ScalarType::F32).unwrap();
    assert_eq!(once.digest(), twice.digest());
    assert!(matches!(once.voxels(), Voxels::F32(_)));
}

#[test]
fn what_does_not_exist_or_fit_is_refused() {
    let code = |name: &str, params: &[(&str, f64)]| {
        let params: Vec<_> = params
            .iter()
            .map(|&(name, value)| (name.to_owned(), value))
            .collect();
        let error = AnalyticField::by_name(name, &params).unwrap_err();
        assert!(
            error.to_string().contains(name) || name == "hydrogen" || name == "ramp",
            "{error}"
        );
        error.code()
    };
    let nan = f64::NAN;
    for (name, params) in [
        ("spher", &[][..]),
        ("sphere", &[("radios", 1.0)]),
        ("sphere", &[("radius", nan)]),
        ("sphere", &[("radius", -1.0)]),
        ("sphere", &[("radius", 0.5), ("radius", 0.6)]),
        ("torus", &[("falloff", 0.0)]),
        ("hydrogen", &[("n", 2.5)]),
        ("hydrogen", &[("n", 2.0), ("l", 2.0)]),
        ("hydrogen", &[("n", 3.0), ("l", 1.0), ("m", 2.0)]),
        ("ramp", &[("x", 0.0)]),
    ] {
        assert_eq!(code(name, params), "volume-field", "{name} {params:?}");
    }
    let constant = field("constant", &[]);
    let refused = |dims| sample(&constant, dims, ScalarType::F64).unwrap_err().code();
    assert_eq!(refused([0, 1, 1]), "volume-grid");
    assert_eq!(refused([10_000; 3]), "volume-too-large");
    assert_eq!(refused([u32::MAX; 3]), "volume-too-large");
    for info in FIELDS {
        for parameter in info.parameters {
            assert!(
                (parameter.min..=parameter.max).contains(&parameter.default),
                "{}",
                parameter.name
            );
        }
    }
}
