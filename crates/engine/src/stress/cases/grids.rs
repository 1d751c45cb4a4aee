//! Grids that are thin, long, small, or spaced unevenly.

use super::rays::both_stages;
use super::{ASLANT, SIZE};
use crate::stress::case::{Bound, Case, Point, Quantity, Truth};
use crate::stress::scene_text::{SceneText, VolumeText};

pub(super) fn cases() -> Vec<Case> {
    vec![spacings(), shapes()]
}

/// Matter that is the same whatever the spacing: opacities hold for a share of the box.
fn transfer(reference: f64) -> String {
    format!(
        "(domain: range, reference_length: (world: {reference:?}), \
         color: [(0.0, (0.1, 0.3, 0.9)), (1.0, (1.0, 0.7, 0.2))], extinction: [(0.02, 0.0), (1.0, 0.5)])"
    )
}

fn spacings() -> Case {
    let all = [
        [1.0, 1.0, 1.0],
        [1.0, 1.0, 10.0],
        [1.0, 1.0, 100.0],
        [100.0, 1.0, 1.0],
    ];
    let point = |(at, spacing): (usize, [f64; 3])| {
        let [x, y, z] = spacing;
        let volume = VolumeText::floats("blob", super::BLOB, super::blob(1.0)).spaced(spacing);
        let length = (x * y * z).cbrt();
        // Along the long axis a ray runs through a hundred times more: matter is thinner there.
        let scene = SceneText::new(
            &format!("spacing_{at}"),
            volume,
            &transfer(5.0 * length),
            ASLANT,
        );
        Point::named(at as f64, format!("{x} : {y} : {z}"), scene)
    };
    let bound = Bound {
        of: |_| 3e-3,
        why: "steps are in voxels of the smallest spacing: along others the field changes less in a step",
    };
    Case {
        name: "uneven-spacing",
        breaks: "In voxels of 1 : 1 : 100 a step of one is a hundredth along one axis, gradients per index are no \
                 gradients in the world, and rays are hundreds of steps long.",
        swept: "spacing",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Reference,
        points: all.into_iter().enumerate().map(point).collect(),
        methods: both_stages(bound),
    }
}

fn shapes() -> Case {
    let all: [[u32; 3]; 7] = [
        [16, 16, 1],
        [1, 16, 16],
        [16, 1, 1],
        [2, 2, 2],
        [1, 1, 1],
        [2048, 4, 4],
        [4, 4, 2048],
    ];
    let point = |(at, dims): (usize, [u32; 3])| {
        let [nx, ny, nz] = dims.map(f64::from);
        let value = move |[x, y, z]: [f64; 3]| {
            let wave = (6.0 * x / nx + 4.0 * y / ny + 5.0 * z / nz).sin();
            0.5 + 0.5 * wave
        };
        let side = nx.max(ny).max(nz);
        let transfer = format!(
            "(domain: data(from: 0, to: 1), reference_length: (world: {:?}), \
             color: [(0.0, (0.1, 0.3, 0.9)), (1.0, (1.0, 0.7, 0.2))], extinction: [(0.0, 0.1), (1.0, 1.0)])",
            0.2 * side.min(20.0)
        );
        let volume = VolumeText::floats(&format!("shape_{at}"), dims, value);
        let camera = if side > 100.0 {
            // Along the long side, from near its end.
            if nx > nz {
                "look_at(eye: (-6.0, 2.2, 4.1), target: (30.0, 1.4, 1.3), fov_y: 40)"
            } else {
                "look_at(eye: (2.2, 4.1, -6.0), target: (1.4, 1.3, 30.0), fov_y: 40)"
            }
        } else {
            ASLANT
        };
        let scene = SceneText::new(&format!("shape_{at}"), volume, &transfer, camera);
        Point::named(at as f64, format!("{nx} × {ny} × {nz}"), scene)
    };
    let bound = Bound {
        // The fourth is 2³.
        of: |at| if at == 3.0 { 0.08 } else { 4e-3 },
        why: "chords over a kink are off by its change of slope times h²/8: of 2³ voxels (extinction 2.5 a voxel) the \
              slope goes from 0 to the range and back; of others by a tenth of that",
    };
    Case {
        name: "thin-grids",
        breaks: "A volume of one voxel has no cell between voxels, one of 2³ a single one; one of 2048 × 4 × 4 is longer \
                 than it is wide by five hundred, and its longest ray has thousands of segments.",
        swept: "voxels",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Reference,
        points: all.into_iter().enumerate().map(point).collect(),
        methods: both_stages(bound),
    }
}
