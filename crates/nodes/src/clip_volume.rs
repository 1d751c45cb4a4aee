//! The clip volume of a raycast: another volume, whose isosurface cuts.

use volgraph_graph::NodeContext;
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;

use crate::raycast::{MAX_SEGMENTS, longest_ray};
use crate::{placement, volume_texture};

/// The parameter that chooses how it is stored.
pub(crate) fn storage_param() -> ParamSpec {
    ParamSpec {
        name: "clip_volume_storage".to_owned(),
        doc: "How the clip volume's scalars are stored, likewise.".to_owned(),
        ..volume_texture::storage_param()
    }
}

/// The longest ray must not look at the clip volume more often than shaders do (`CLIP_VOLUME_TURNS` in
/// `slot/clip/volume.wgsl`).
///
/// # Errors
/// `too-many-segments` where it would.
pub(crate) fn check_steps(node: &NodeContext<'_>) -> Result<(), Finding> {
    if !node.uses_binding("clip_volume_texture") || node.float("clip_step") <= 0.0 {
        return Ok(());
    }
    let clip = placement::volume(node, "clip_volume")?.grid();
    let voxels = if node.text("clip_volume_place") == "box" {
        f64::from(clip.dims.into_iter().max().unwrap_or(1))
    } else {
        // The most voxels that a world unit crosses along one axis.
        let index_from_world = clip.world_from_index.matrix3.inverse().transpose();
        let axes = [
            index_from_world.x_axis,
            index_from_world.y_axis,
            index_from_world.z_axis,
        ];
        let most = axes.iter().map(|axis| axis.length()).fold(0.0, f64::max);
        longest_ray(placement::placed(node, "volume")?.grid()) * most
    };
    let steps = (voxels / node.float("clip_step")).ceil();
    if steps > MAX_SEGMENTS {
        return Err(node
            .error(
                "too-many-segments",
                format!("its longest ray looks at the clip volume {steps} times, of {MAX_SEGMENTS} at most"),
            )
            .help("choose a longer `clip_step`"));
    }
    Ok(())
}
