//! Tolerances hold for what is brighter than 1: it shows through little transmittance that would hide anything else.

#![expect(clippy::unwrap_used, reason = "a case fails by panicking")]

mod common;

use common::rays_along_z;
use glam::DVec3;
use volgraph_optics::{Material, TransferFunction};
use volgraph_reference::{
    Background, Field, Lamp, Look, Materials, Matter, Place, Scene, Silent, render,
};
use volgraph_volume::{Grid, Volume, Voxels};

/// A black wall in front of something bright, of a colour `color`, seen along z.
fn scene(color: f64, lamp: Option<f64>, behind: f64) -> Scene {
    let dims = [2, 2, 16];
    let voxels = (0..64).map(|at| (at / 4) as f32 / 15.0).collect();
    let grid = Grid::axis_aligned(dims, DVec3::ONE, DVec3::ZERO);
    let field = Field::new(&Volume::new("wall", grid, Voxels::F32(voxels)).unwrap());
    let text = format!(
        "(domain: data, points: [(at: 0, color: (0, 0, 0), opacity: 0.6), (at: 0.5, color: (0, 0, 0), opacity: 0.6),
          (at: 0.55, color: ({color}, 1, 1), opacity: 0.9), (at: 1, color: (0, {color}, 1), opacity: 0.2)])"
    );
    let transfer = TransferFunction::parse("wall.ron".as_ref(), &text).unwrap();
    let materials = Materials {
        default: Material {
            ambient: 0.3,
            diffuse: 0.7,
            specular: 0.25,
            shininess: 20.0,
        },
        by_transfer: false,
    };
    let matter = Matter::new(&transfer, (0.0, 1.0), 1.0, &materials);
    let lamps = lamp.map(|color| {
        vec![Lamp {
            place: Place::Towards(-DVec3::Z),
            color: [color; 3],
        }]
    });
    let look = Look {
        materials,
        lamps,
        ..Look::unlit(matter)
    };
    Scene {
        background: Background::Uniform([behind, behind, behind, 1.0]),
        ..Scene::unlit(rays_along_z([2, 2]), field, look)
    }
}

#[test]
fn what_is_brighter_than_1_keeps_the_tolerance() {
    for (color, lamp, behind) in [
        (1.0, None, 0.0),
        (1.0, Some(100.0), 0.0),
        (1000.0, None, 0.0),
        (1.0, None, 1000.0),
        (30.0, Some(50.0), 1.0),
    ] {
        let scene = scene(color, lamp, behind);
        let exact = render(&scene, 1e-10, &Silent).unwrap();
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-5] {
            let rendered = render(&scene, tolerance, &Silent).unwrap();
            for at in 0..rendered.color.len() {
                let pairs = rendered.color[at].into_iter().zip(exact.color[at]);
                let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                let bound = rendered.error[at];
                assert!(
                    off <= bound + 1e-9 && bound <= tolerance,
                    "{color} {lamp:?} {behind} to {tolerance}: {off:e} off, {bound:e} said"
                );
            }
        }
    }
}
