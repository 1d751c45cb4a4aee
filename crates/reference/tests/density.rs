//! Matter so dense that all of its light comes from a sliver of a cell: no point of a rule may miss it.

#![expect(clippy::unwrap_used, reason = "a case fails by panicking")]

mod common;

use common::rays_along_z;
use glam::DVec3;
use volgraph_optics::TransferFunction;
use volgraph_reference::{Field, Look, Materials, Matter, Scene, Silent, render};
use volgraph_volume::{Grid, Volume, Voxels};

/// Four voxels in a row from `from` to `to`, seen along them; colours and extinctions linear in the scalar.
fn scene(from: f32, to: f32, extinction: f64) -> Scene {
    let grid = Grid::axis_aligned([2, 2, 2], DVec3::ONE, DVec3::ZERO);
    let voxels = [[from; 4], [to; 4]].concat();
    let field = Field::new(&Volume::new("dense", grid, Voxels::F32(voxels)).unwrap());
    let text = format!(
        "(domain: data, reference_length: (world: 1), color: [(0, (1, 0, 0)), (1, (0.5, 1, 0))],
          extinction: [(0, 0), (1, {extinction})])"
    );
    let transfer = TransferFunction::parse("dense.ron".as_ref(), &text).unwrap();
    let matter = Matter::new(&transfer, (0.0, 1.0), 1.0, &Materials::NONE);
    Scene::unlit(rays_along_z([1, 1]), field, Look::unlit(matter))
}

#[test]
fn the_light_of_dense_matter_is_that_of_its_front() {
    for extinction in [1.0, 30.0, 1e3, 1e6] {
        // One scalar all along, through a box of two world units: 1 - exp(-2 extinction), of its colour.
        let rendered = render(&scene(1.0, 1.0, extinction), 1e-8, &Silent).unwrap();
        let opacity = -(-2.0 * extinction).exp_m1();
        let expected = [0.5 * opacity, opacity, 0.0, opacity];
        let pairs = rendered.color[0].into_iter().zip(expected);
        let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(
            off < 1e-8 && rendered.error[0] <= 1e-8,
            "{extinction}: {off:e} off, {:e} said",
            rendered.error[0]
        );
        // Half a world unit of nothing, then from nothing upwards: the depth after z is extinction z² / 2, and green is the
        // mean of z over the light, √(π / 2 extinction) where nothing is left behind.
        if extinction > 100.0 {
            let rendered = render(&scene(0.0, 1.0, extinction), 1e-8, &Silent).unwrap();
            let green = (std::f64::consts::FRAC_PI_2 / extinction).sqrt();
            let off = (rendered.color[0][1] - green).abs();
            assert!(off < 1e-8, "{extinction}: {off:e} off, of {green}");
        }
    }
}
