//! Rays whose colour and transmittance are known to 40 digits (`exact_rays.py` computes them with mpmath): constant,
//! linear, quadratic and sampled sinusoidal scalars, each under a smooth, a linear, a step and a peak transfer function.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use glam::DVec3;
use volgraph_optics::TransferFunction;
use volgraph_reference::{Field, Look, Materials, Matter, Rays, Scene, Silent, render};
use volgraph_volume::{Grid, Volume, Voxels};

/// 1024 times the samples of the sinusoid, twice and its first once more.
const SINES: [f64; 16] = [
    512.0, 688.0, 837.0, 936.0, 972.0, 936.0, 837.0, 688.0, 512.0, 336.0, 187.0, 88.0, 52.0, 88.0,
    187.0, 336.0,
];

/// A grid of samples at whole numbers whose box spans them.
fn field(dims: [u32; 3], value: impl Fn(u32, u32) -> f64) -> Field {
    let mut voxels = Vec::new();
    for _ in 0..dims[2] {
        for y in 0..dims[1] {
            voxels.extend((0..dims[0]).map(|x| value(x, y)));
        }
    }
    let mut grid = Grid::axis_aligned(dims, DVec3::ONE, DVec3::ZERO);
    grid.node_centred = true;
    Field::new(&Volume::new("ray", grid, Voxels::F64(voxels)).unwrap())
}

/// The field, and the direction of the ray from its first corner.
fn scalar(name: &str) -> (Field, DVec3) {
    match name {
        "constant" => (field([9, 1, 1], |_, _| 614.0 / 1024.0), DVec3::X),
        "linear" => (field([9, 1, 1], |x, _| f64::from(x) / 8.0), DVec3::X),
        "quadratic" => {
            let diagonal = DVec3::new(1.0, 1.0, 0.0).normalize();
            (field([9, 9, 1], |x, y| f64::from(x * y) / 64.0), diagonal)
        }
        _ => (
            field([33, 1, 1], |x, _| SINES[x as usize % 16] / 1024.0),
            DVec3::X,
        ),
    }
}

fn transfer(name: &str) -> TransferFunction {
    let absorption = match name {
        "smooth" => "opacity: [(0, 0), (1, 0.75)]",
        "linear" => "extinction: [(0, 0.03125), (1, 0.5)]",
        "step" => "extinction: [(0, 0), (0.5, 0), (0.5, 0.75), (1, 0.75)]",
        _ => "extinction: [(0, 0), (0.59375, 0), (0.6015625, 12), (0.609375, 0), (1, 0)]",
    };
    let text = format!(
        "(domain: data, reference_length: (world: 1), color: [(0, (1, 0.25, 0)), (1, (0, 0.5, 1))], {absorption})"
    );
    TransferFunction::parse("transfer.ron".as_ref(), &text).unwrap()
}

/// One pixel that looks along a direction from before a position.
fn rays(direction: DVec3) -> Rays {
    let right = direction.cross(DVec3::Z).normalize();
    Rays {
        eye: -3.0 * direction,
        right,
        up: right.cross(direction),
        forward: direction,
        half_extent: [1e-9, 1e-9],
        is_orthographic: false,
        size: [1, 1],
    }
}

#[test]
fn sixteen_rays_are_right_to_the_tolerance() {
    let mut count = 0;
    for line in include_str!("exact_rays.tsv").lines().skip(1) {
        let fields: Vec<&str> = line.split('\t').collect();
        let numbers: Vec<f64> = fields[2..].iter().map(|n| n.parse().unwrap()).collect();
        let (field, direction) = scalar(fields[0]);
        let matter = Matter::new(&transfer(fields[1]), (0.0, 1.0), 1.0, &Materials::NONE);
        let scene = Scene::unlit(rays(direction), field, Look::unlit(matter));
        for tolerance in [1e-4, 1e-8, 1e-10] {
            let rendered = render(&scene, tolerance, &Silent).unwrap();
            let [r, g, b, a] = rendered.color[0];
            let error = [
                r - numbers[0],
                g - numbers[1],
                b - numbers[2],
                1.0 - a - numbers[3],
            ]
            .map(f64::abs)
            .into_iter()
            .fold(0.0, f64::max);
            // Rounding: some thousand operations of float64.
            assert!(
                error <= tolerance.max(1e-13),
                "{} {}: {error:e} at {tolerance:e}",
                fields[0],
                fields[1]
            );
            assert!(error <= rendered.error[0] + 1e-13, "{line}: {error:e}");
            assert!(rendered.error[0] <= tolerance, "{line}");
        }
        count += 1;
    }
    assert_eq!(count, 16);
}
