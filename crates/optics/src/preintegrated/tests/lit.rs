//! The tables of materials and of moments against quadrature.

use super::super::*;
use super::{ALL, COLOR_BOUND, Random, transfer};
use crate::Material;

const DEFAULT: Material = Material {
    ambient: 0.3,
    diffuse: 0.6,
    specular: 0.25,
    shininess: 32.0,
};

/// Steps, knots beside those of the colours, and fractions that some points do not give; in 0..1 or -1000..3000.
const MATERIALS: [&str; 2] = [
    "[(at: 0.1, ambient: 0.1), (at: 0.3003, diffuse: 0.9, specular: 0), (at: 0.4991, ambient: 0.8, shininess: 4), \
      (at: 0.5003, diffuse: 0.2, specular: 1), (at: 0.5003, specular: 0.3, shininess: 200), (at: 0.9, diffuse: 1)]",
    "[(at: -500, ambient: 0.9, diffuse: 0), (at: 130, specular: 1), (at: 800, ambient: 0, diffuse: 1), \
      (at: 801, specular: 0, shininess: 9)]",
];

/// The transfer functions of the plain tables, with materials.
fn lit() -> Vec<(&'static str, TransferFunction)> {
    ALL.iter()
        .map(|(name, text)| {
            let field = MATERIALS[usize::from(*name == "mapped")];
            let body = text.strip_suffix(')').unwrap();
            (*name, transfer(&format!("{body}, material: {field})")))
        })
        .collect()
}

/// Twelve integrals over a segment: `ka c`, `ks`; `kd c`, `m ks`; and the moments of `kd c`, `ks`. By the midpoint rule
/// over thousands of slabs, cut at all knots; shares no code with the tables.
fn quadrature(
    transfer: &TransferFunction,
    default: Option<Material>,
    (front, back): (f64, f64),
    length: f64,
) -> [f64; 12] {
    let mut cuts: Vec<f64> = transfer.knots();
    cuts.extend(transfer.material.knots());
    cuts.retain(|s| front.min(back) < *s && *s < front.max(back));
    cuts.sort_by(f64::total_cmp);
    if front > back {
        cuts.reverse();
    }
    let graded = |k: u32, steps: u32| {
        let x = f64::from(k) / f64::from(steps);
        x * x * (3.0 - 2.0 * x)
    };
    let (mut sums, mut depth, mut from, mut place) = ([0.0; 12], 0.0_f64, front, 0.0);
    for to in cuts.into_iter().chain([back]) {
        let share = if back == front {
            1.0
        } else {
            (to - from) / (back - front)
        };
        let steps = 300 + (20_000.0 * share) as u32;
        for k in 0..steps {
            let (t0, t1) = (graded(k, steps), graded(k + 1, steps));
            let s = from + 0.5 * (t0 + t1) * (to - from);
            let slab = transfer.extinction(s) * length * share * (t1 - t0);
            let weight = (-depth).exp() * opacity_from_extinction(slab);
            let t = place + share * 0.5 * (t0 + t1);
            let m = default.map_or(
                Material {
                    ambient: 1.0,
                    diffuse: 1.0,
                    specular: 1.0,
                    shininess: 1.0,
                },
                |default| transfer.material(s, default),
            );
            let [r, g, b] = transfer.color(s);
            let values = [
                m.ambient * r,
                m.ambient * g,
                m.ambient * b,
                m.specular,
                m.diffuse * r,
                m.diffuse * g,
                m.diffuse * b,
                m.specular * m.shininess,
                t * m.diffuse * r,
                t * m.diffuse * g,
                t * m.diffuse * b,
                t * m.specular,
            ];
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += weight * value;
            }
            depth += slab;
        }
        place += share;
        from = to;
    }
    sums
}

/// Pairs of entries that include neighbours.
fn pairs(n: u32, count: usize) -> Vec<(u32, u32)> {
    let mut random = Random(11);
    (0..count)
        .map(|k| {
            let front = random.below(n);
            let reach = [n, n / 16, 4][k % 3].max(2);
            let back = (front + random.below(reach)).min(n - 1);
            if random.below(2) == 0 {
                (front, back)
            } else {
                (back, front)
            }
        })
        .collect()
}

/// Largest errors of the materials and of the moments.
fn worst_errors(
    transfer: &TransferFunction,
    tables: &(PreintegratedMaterial, PreintegratedMoments),
    default: Option<Material>,
    length: f64,
) -> (f64, f64) {
    let (material, moments) = tables;
    let n = material.size;
    let (mut worst, mut worst_moment) = (0.0_f64, 0.0_f64);
    for (front, back) in pairs(n, 21) {
        let ends = [front, back].map(|i| node(transfer.range(), n, i));
        let truth = quadrature(transfer, default, (ends[0], ends[1]), length);
        let at = (front + n * back) as usize;
        for i in 0..4 {
            let error = |value: f32, truth: f64| (f64::from(value) - truth).abs();
            worst_moment = worst_moment.max(error(moments.entries[at][i], truth[8 + i]));
            if default.is_some() {
                worst = worst.max(error(material.ambient[at][i], truth[i]));
                let unit = if i == 3 { 256.0 } else { 1.0 };
                worst = worst.max(error(material.diffuse[at][i], truth[4 + i]) / unit);
            }
        }
    }
    (worst, worst_moment)
}

fn tables(
    transfer: &TransferFunction,
    n: u32,
    length: f64,
    default: Option<Material>,
) -> (PreintegratedMaterial, PreintegratedMoments) {
    (
        transfer
            .preintegrated_material(n, length, default.unwrap_or(DEFAULT))
            .unwrap(),
        transfer.preintegrated_moments(n, length, default).unwrap(),
    )
}

#[test]
fn materials_and_moments_agree_with_quadrature() {
    for (name, transfer) in lit() {
        for (length, default) in [(0.25, Some(DEFAULT)), (1.0, None), (6.0, Some(DEFAULT))] {
            let tables = tables(&transfer, 1024, length, default);
            let (material, moments) = worst_errors(&transfer, &tables, default, length);
            println!("{name}, length {length}: material {material:.1e}, moments {moments:.1e}");
            assert!(
                material < COLOR_BOUND,
                "{name}, length {length}: {material:e}"
            );
            assert!(
                moments < COLOR_BOUND,
                "{name}, length {length}: {moments:e}"
            );
        }
    }
}

#[test]
fn the_bound_sees_wrong_tables() {
    let (_, transfer) = lit().swap_remove(2);
    let right = tables(&transfer, 1024, 1.0, Some(DEFAULT));
    let duller = Material {
        specular: 0.2,
        ..DEFAULT
    };
    let plain = self::transfer(super::STEPS);
    // Other defaults where the file does not say; the field `material` left out; another length; front for back.
    let of_plain = tables(&plain, 1024, 1.0, Some(DEFAULT));
    assert!(worst_errors(&transfer, &of_plain, Some(DEFAULT), 1.0).0 > COLOR_BOUND);
    assert!(worst_errors(&plain, &of_plain, Some(duller), 1.0).0 > COLOR_BOUND);
    let longer = tables(&transfer, 1024, 1.001, Some(DEFAULT));
    let (material, moments) = worst_errors(&transfer, &longer, Some(DEFAULT), 1.0);
    assert!(material > COLOR_BOUND && moments > COLOR_BOUND);
    let mut turned = right.clone();
    for (front, back) in (0..1024).flat_map(|front| (0..1024).map(move |back| (front, back))) {
        turned.1.entries[front + 1024 * back] = right.1.entries[back + 1024 * front];
    }
    assert!(worst_errors(&transfer, &turned, Some(DEFAULT), 1.0).1 > COLOR_BOUND);
}

#[test]
fn constant_fractions_are_those_of_the_plain_table() {
    for (name, text) in ALL {
        let transfer = transfer(text);
        let plain = transfer.preintegrated_table(1024, 1.5).unwrap();
        let material = transfer.preintegrated_material(1024, 1.5, DEFAULT).unwrap();
        let lit = material.ambient.iter().zip(&material.diffuse);
        for (plain, (ambient, diffuse)) in plain.entries.iter().zip(lit) {
            let [r, g, b, depth] = plain.map(f64::from);
            let specular = DEFAULT.specular * opacity_from_extinction(depth);
            let truth = [r, g, b].map(|c| (DEFAULT.ambient * c, DEFAULT.diffuse * c));
            for (i, (ambient_truth, diffuse_truth)) in truth.into_iter().enumerate() {
                assert!(
                    (f64::from(ambient[i]) - ambient_truth).abs() < COLOR_BOUND,
                    "{name}"
                );
                assert!(
                    (f64::from(diffuse[i]) - diffuse_truth).abs() < COLOR_BOUND,
                    "{name}"
                );
            }
            assert!(
                (f64::from(ambient[3]) - specular).abs() < COLOR_BOUND,
                "{name}"
            );
            assert!(
                (f64::from(diffuse[3]) - 32.0 * specular).abs() < 32.0 * COLOR_BOUND,
                "{name}"
            );
        }
    }
}

#[test]
fn moments_of_a_constant_have_a_closed_form_and_both_ends_are_the_whole() {
    let constant = transfer("(color: (0.2, 0.4, 2.0), extinction: [(0, 3.0)])");
    for length in [1e-3, 0.5, 4.0] {
        let depth: f64 = 3.0 * length;
        // ∫₀¹ t T exp(-T t) dt, by parts; the quotient cancels at the smallest length.
        let moment = if length < 0.01 {
            depth / 2.0 - depth * depth / 3.0 + depth.powi(3) / 8.0
        } else {
            -(-depth).exp_m1() / depth - (-depth).exp()
        };
        let table = constant.preintegrated_moments(65, length, None).unwrap();
        for entry in &table.entries {
            for (value, truth) in entry.iter().zip([0.2, 0.4, 2.0, 1.0]) {
                assert!(
                    (f64::from(*value) - truth * moment).abs() < 1e-6 * moment,
                    "{entry:?}"
                );
            }
        }
    }
    for (name, transfer) in lit() {
        let plain = transfer.preintegrated_table(200, 1.0).unwrap();
        let moments = transfer.preintegrated_moments(200, 1.0, None).unwrap();
        for (plain, moment) in plain.entries.iter().zip(&moments.entries) {
            let opacity = opacity_from_extinction(f64::from(plain[3])) as f32;
            let whole = [plain[0], plain[1], plain[2], opacity];
            let is_part = |(m, w): (&f32, &f32)| *m >= 0.0 && *m <= w + 1e-5;
            assert!(
                moment.iter().zip(&whole).all(is_part),
                "{name}: {moment:?} of {whole:?}"
            );
        }
    }
}

#[test]
fn what_is_no_lit_table_is_refused() {
    let (_, transfer) = lit().swap_remove(0);
    assert!(transfer.preintegrated_material(63, 1.0, DEFAULT).is_err());
    assert!(transfer.preintegrated_material(64, 0.0, DEFAULT).is_err());
    assert!(transfer.preintegrated_moments(5000, 1.0, None).is_err());
    assert!(transfer.preintegrated_moments(64, f64::NAN, None).is_err());
    assert!(transfer.material_table(1023, DEFAULT).is_err());
    assert_eq!(
        transfer.material_table(1024, DEFAULT).unwrap()[0],
        [0.1, 0.9, 0.0, 4.0]
    );
}
