//! From a `raycast` node, or another renderer, to the scene that the reference computes.
//!
//! Slots that only choose how an integral is taken (`classify`, `traverse`) do not matter here: all of them approximate
//! one picture. What the reference has no closed form for is refused by name (`not-covered`), never left out.

use volgraph_graph::{NodeContext, NodeKind, View};
use volgraph_reference::{Field, Gradients, Kernel, Rays, Scene, Shadow, Technique};
use volgraph_report::Finding;

use super::behind::behind;
use super::covered::{self, choice_of, refusal};
use super::labels::{Row, labels};
use super::looks::{look, window};
use super::space::{clip, half_side};
use super::values::Values;
use crate::placement;
use crate::shear_warp::ShearWarp;
use crate::software_raycast::{self, SoftwareRaycast};

/// The rays of a view.
#[must_use]
pub fn rays(view: &View) -> Rays {
    let lens = view.lens();
    Rays {
        eye: view.camera.eye,
        right: view.camera.right,
        up: view.camera.up,
        forward: view.camera.forward,
        half_extent: lens.half_extent,
        is_orthographic: lens.is_orthographic,
        size: view.size,
    }
}

/// The scene of a `raycast` node in a view, or of another renderer (see [`crate::draws_volumes`]).
///
/// # Errors
/// `not-covered` where the reference does not know how to compute it; `missing-input`.
pub fn raycast_scene(node: &NodeContext<'_>, view: &View) -> Result<Scene, Finding> {
    if node.kind_name() == ShearWarp::default().name() {
        // The same matter; that its rays are parallel is the view's.
        return software_raycast::scene(node, view);
    }
    let is_software = node.kind_name() == SoftwareRaycast::default().name();
    if !is_software && !crate::draws_volumes(&node.kind_name()) {
        let message = format!(
            "the reference computes the pictures of raycasts, and this is a `{}`",
            node.kind_name()
        );
        return Err(node
            .error("not-covered", message)
            .help("connect the port `color` of a raycast"));
    }
    covered::check(node)?;
    let own = Values::own(node);
    let field = Field::new(placement::volume(node, "volume")?).with_kernel(kernel(node)?);
    let (labels, rows) = labels(node)?;
    let mut looks = vec![look(&own, 0)?];
    for row in &rows {
        looks.push(look(
            &Values {
                row: row.params,
                ..own
            },
            row.transfer,
        )?);
    }
    Ok(Scene {
        rays: rays(view),
        field,
        gradients: gradients(node),
        clip: clip(&own)?,
        labels,
        technique: technique(&own, &rows)?,
        looks,
        shadow: shadow(node),
        background: behind(node, view)?,
    })
}

fn kernel(node: &NodeContext<'_>) -> Result<Kernel, Finding> {
    Ok(match choice_of(node, "reconstruct") {
        "nearest" => Kernel::Nearest,
        "trilinear" => Kernel::Linear,
        "tricubic" => Kernel::Bspline,
        "catmull_rom" => Kernel::CatmullRom,
        other => return Err(refusal(node, &format!("the reconstruction `{other}`"))),
    })
}

fn gradients(node: &NodeContext<'_>) -> Gradients {
    match (
        choice_of(node, "gradient"),
        choice_of(node, "gradient_method"),
    ) {
        ("central", _) => Gradients::Central,
        ("analytic", _) => Gradients::Trilinear,
        ("tricubic", _) => Gradients::Bspline,
        ("stored", "sobel") => Gradients::StoredSobel,
        ("stored", "central") => Gradients::StoredCentral,
        // Nobody reads it, or it would have been refused.
        _ => Gradients::default(),
    }
}

fn shadow(node: &NodeContext<'_>) -> Shadow {
    match choice_of(node, "shadow") {
        _ if choice_of(node, "light") == "unlit" => Shadow::None,
        "surface" => Shadow::Solid,
        "transmittance" => Shadow::Matter,
        _ => Shadow::None,
    }
}

fn technique(own: &Values<'_>, rows: &[Row<'_>]) -> Result<Technique, Finding> {
    let node = &own.node;
    Ok(match choice_of(node, "technique") {
        "dvr" => Technique::VolumeRendering,
        "mip" => Technique::Maximum,
        "minip" => Technique::Minimum,
        "average" => Technique::Average,
        "xray" => {
            let mut windows = vec![window(own)?];
            for row in rows {
                windows.push(window(&Values {
                    row: row.params,
                    ..*own
                })?);
            }
            let half_side = half_side(placement::volume(node, "volume")?.grid());
            Technique::Xray {
                windows,
                absorption: own.float("absorption") / half_side,
                film: own.vector("film"),
            }
        }
        "isosurface" | "isosurface_dvr" => Technique::Surfaces {
            has_faces: own.text("cut_faces") == "drawn",
            with_matter: choice_of(node, "technique") == "isosurface_dvr",
        },
        "isosurfaces_translucent" => Technique::Surfaces {
            has_faces: false,
            with_matter: false,
        },
        other => return Err(refusal(node, &format!("the technique `{other}`"))),
    })
}
