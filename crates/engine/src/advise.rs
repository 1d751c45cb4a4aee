//! What sampling a graph asks for: Carson's rule for the transfer function of the field, beside what is measured.
//!
//! The way of the data: a scene's raycast names a volume and a transfer function; [`spectrum`] gives their highest relevant
//! frequencies and the lengths of the field's gradients; the rule makes a rate of them, and of the rate a step
//! ([`Rule`]). [`Measurement`]s are errors against the float64 reference. [`Advice::sentence`] says what to do.
//!
//! The composition of a transfer function with the band limit nu_U (cycles per unit of the scalar) and a scalar field has
//! the band limit nu_U times the largest slope of the field along a ray (Bergner et al. 2006, "A spectral analysis of
//! function composition and its implications for sampling in direct volume visualization"). For a wave of the frequency
//! nu_S and values over a range A the largest slope is pi nu_S A: Carson's rule of frequency modulation. Twice as many
//! samples are asked for.

mod measure;
pub mod spectrum;
mod words;

use std::f64::consts::PI;

use serde::Serialize;
use volgraph_graph::NodeContext;
use volgraph_nodes::{placement, raycast, transfer_table};
use volgraph_report::{Finding, Findings};

pub use self::measure::{MEASURED_STEPS, Measurement, measure};
use self::spectrum::AxisSpectrum;
use crate::scene::Scene;
use crate::truth::plan_without_device;

/// What is known of a volume.
#[derive(Clone, Debug, Serialize)]
pub struct VolumeBand {
    /// Voxels along the axes.
    pub dims: [u32; 3],
    /// The type of its scalars.
    pub scalar_type: &'static str,
    /// The smallest and the largest scalar.
    pub range: (f64, f64),
    /// World length of the smallest spacing: the voxel that steps are in.
    pub voxel: f64,
    /// Along x, y and z.
    pub axes: [AxisSpectrum; 3],
    /// The largest gradient, data units per voxel of the smallest spacing.
    pub gradient_max: f64,
    /// The gradient that a thousandth of the voxels exceeds.
    pub gradient_999: f64,
    /// The gradient that half of the voxels exceed.
    pub gradient_median: f64,
}

/// What is known of a transfer function.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TransferBand {
    /// nu_U of the extinction, cycles per data unit.
    pub extinction: f64,
    /// nu_U of extinction and colours, cycles per data unit.
    pub all: f64,
}

/// A rate of samples, and the step of it.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Rule {
    /// The band limit of the composition, cycles per voxel.
    pub cycles_per_voxel: f64,
    /// Half a cycle, voxels; infinite where nothing changes.
    pub step: f64,
}

impl Rule {
    fn new(cycles_per_voxel: f64) -> Self {
        Self {
            cycles_per_voxel,
            step: 0.5 / cycles_per_voxel,
        }
    }
}

/// What sampling a graph asks for.
#[derive(Clone, Debug, Serialize)]
pub struct Advice {
    /// The raycast's name.
    pub node: String,
    /// Its technique.
    pub technique: String,
    /// Its choice of `classify`, and its step.
    pub classify: String,
    /// The volume.
    pub volume: VolumeBand,
    /// The transfer function; `None` where the technique reads none.
    pub transfer: Option<TransferBand>,
    /// Carson's rule: pi nu_U nu_S times the range, of the axis that asks for most.
    pub by_spectra: Option<Rule>,
    /// nu_U times the largest gradient.
    pub by_largest_gradient: Option<Rule>,
    /// nu_U times the gradient that a thousandth of the voxels exceeds.
    pub by_common_gradient: Option<Rule>,
    /// Half a cycle of the field alone, voxels: what is left where classification is integrated.
    pub field_step: f64,
    /// Errors by classification and step.
    pub measured: Vec<Measurement>,
    /// How what was measured differs from the graph.
    pub notes: Vec<String>,
}

impl Advice {
    /// Of a scene's output `color`, which is a raycast's, or of the raycast behind it.
    ///
    /// # Errors
    /// `no-raycast` where none draws it, and whatever is wrong with the graph.
    pub fn of(scene: &Scene) -> Result<Self, Findings> {
        let plan = plan_without_device(scene, [64, 64])?;
        let view = plan.view();
        let raycast = plan
            .order
            .iter()
            .map(|id| plan.context(*id, &view, None))
            .rfind(|node| volgraph_nodes::draws_volumes(&node.kind_name()))
            .ok_or_else(|| {
                Finding::error("no-raycast", "the graph has no raycast that is drawn")
                    .help("name a graph whose output `color` comes from a raycast")
            })?;
        Self::of_node(&raycast)
    }

    fn of_node(node: &NodeContext<'_>) -> Result<Self, Findings> {
        let volume = placement::volume(node, "volume")?;
        let range = volume.statistics().range().unwrap_or((0.0, 0.0));
        let voxel = volume.grid().min_spacing();
        let axes = spectrum::of_volume(volume);
        let gradients = spectrum::gradients(volume);
        let rank = |share: f64| {
            let at = (share * gradients.len() as f64) as usize;
            let at = at.min(gradients.len().saturating_sub(1));
            voxel * gradients.get(at).copied().unwrap_or(0.0)
        };
        let volume_band = VolumeBand {
            dims: volume.grid().dims,
            scalar_type: volume.voxels().scalar_type().name(),
            range,
            voxel,
            axes,
            gradient_max: rank(1.0),
            gradient_999: rank(0.999),
            gradient_median: rank(0.5),
        };
        // Of several labels' transfer functions the one that asks for most.
        let transfers = transfer_table::transfers(node).unwrap_or_default();
        let bands = transfers
            .iter()
            .filter(|_| range.1 > range.0)
            .map(|transfer| {
                let value = |at: f64| raycast::data_value(volume, transfer.domain(), at);
                let (low, span) = (value(0.0), value(1.0) - value(0.0));
                let (extinction, all) =
                    spectrum::of_transfer(transfer, range, |value| (value - low) / span);
                TransferBand { extinction, all }
            });
        let transfer = bands.max_by(|a, b| a.all.total_cmp(&b.all));
        // Of the field, cycles per voxel of the smallest spacing.
        let field = axes
            .iter()
            .map(|axis| axis.cycles_per_voxel / axis.spacing * voxel)
            .fold(0.0, f64::max);
        let rule = |slope: f64| transfer.map(|transfer| Rule::new(transfer.all * slope));
        Ok(Self {
            node: node.name().to_owned(),
            technique: node.slot("technique").to_owned(),
            classify: node.slot("classify").to_owned(),
            by_spectra: rule(PI * field * (range.1 - range.0)),
            by_largest_gradient: rule(volume_band.gradient_max),
            by_common_gradient: rule(volume_band.gradient_999),
            field_step: 0.5 / field,
            volume: volume_band,
            transfer,
            measured: Vec::new(),
            notes: Vec::new(),
        })
    }
}
