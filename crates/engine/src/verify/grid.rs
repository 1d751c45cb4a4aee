//! Halving the spacing of the grids of analytic sources.
//!
//! The truth is the float64 reference of the same field on a grid four times finer than the finest: its own error is a
//! sixteenth of the smallest one that is measured, which raises an order of 2 by no more than 0.05. Steps are far below
//! the finest spacing, of one world length for all, so that what is left of their error is floor. The session stays with
//! the finest grid: this study is the last.

use volgraph_graph::SourceDesc;
use volgraph_nodes::source::transfer::TransferSource;
use volgraph_optics::ReferenceLength;
use volgraph_report::Findings;
use volgraph_shader::ParamValue;

use super::errors::Look;
use super::step::{Course, draw, note_one_sided, truth};
use super::{Against, Axis, OrdersOptions, Study, Target, Tell, slot_settings};
use crate::{ParamOverride, Session};

/// Voxels along the longest side of the finest grid that is measured.
const FINEST: u32 = 64;

/// How many times finer the truth's grid is.
const TRUTH: u32 = 4;

/// Segments along the longest side.
const SEGMENTS: f64 = 512.0;

/// An analytic source and the voxels of its coarsest grid.
struct Refined {
    name: String,
    dims: [u32; 3],
    is_node_centred: bool,
}

impl Refined {
    fn of(name: &str, desc: &SourceDesc, halvings: u32) -> Self {
        let dims = match desc.params.get("dims").map(|it| &it.value) {
            Some(ParamValue::Vector(dims)) if dims.len() == 3 => {
                [dims[0], dims[1], dims[2]].map(|side| side as u32)
            }
            _ => [64; 3],
        };
        let is_node_centred =
            desc.params.get("node_centred").map(|it| &it.value) == Some(&ParamValue::Bool(true));
        // The shape of the given grid, at a size that leaves the finest one affordable.
        let cells = dims.map(|side| side.saturating_sub(u32::from(is_node_centred)).max(1));
        let longest = f64::from(cells.into_iter().max().unwrap_or(1));
        let coarsest = f64::from((FINEST >> halvings.min(4)).max(1));
        let dims = cells.map(|side| ((f64::from(side) * coarsest / longest).round() as u32).max(1));
        Self {
            name: name.to_owned(),
            dims,
            is_node_centred,
        }
    }

    /// The setting of a grid so many times finer than the coarsest.
    fn finer(&self, times: u32) -> Option<ParamOverride> {
        let [x, y, z] = self
            .dims
            .map(|side| side * times + u32::from(self.is_node_centred));
        ParamOverride::parse(&format!("{}.dims=({x}, {y}, {z})", self.name)).ok()
    }

    fn longest(&self) -> u32 {
        self.dims.into_iter().max().unwrap_or(1)
    }
}

/// The study, or why there is none.
pub(super) fn study(
    target: &Target,
    session: &mut Session,
    options: &OrdersOptions,
    tell: Tell<'_>,
) -> Result<Result<Study, String>, Findings> {
    let halvings = options.halvings.min(5);
    let sources = session.scene().desc.sources.iter();
    let refined: Vec<Refined> = sources
        .filter(|(_, desc)| desc.kind == "analytic" && !desc.params.contains_key("levels"))
        .map(|(name, desc)| Refined::of(name, desc, halvings))
        .collect();
    let Some(first) = refined.first() else {
        return Ok(Err(
            "no source is `analytic`, and a field is known finer than its file in no other"
                .to_owned(),
        ));
    };
    let declared = target.declared(session, Axis::Grid, options)?;
    if declared.1 == "colour" && !has_world_lengths(session) {
        return Ok(Err(
            "the transfer function's opacity is stated for voxels, so that finer grids are of denser matter; \
             give it `reference_length: (world: …)`"
                .to_owned(),
        ));
    }
    let dims = |times: u32| {
        refined
            .iter()
            .filter_map(|it| it.finer(times))
            .collect::<Vec<_>>()
    };
    let voxels = |times: u32| f64::from(first.longest() * times);
    let (least, most) = target.step_range;
    let (mut steps, mut looks) = (Vec::new(), Vec::new());
    for halving in 0..=halvings {
        let times = 1 << halving;
        tell("drawing", u64::from(halving), u64::from(halvings) + 1);
        let step = (voxels(times) / SEGMENTS).clamp(least, most);
        let mut sets = dims(times);
        sets.extend(target.settings("step", step));
        let picture = draw(session, sets)?;
        steps.push(1.0 / voxels(times));
        looks.push(Look::from(&picture));
    }
    let mut sets = dims(TRUTH << halvings);
    // The truth's grid is trilinear, whatever reconstructs the coarser ones.
    let trilinear = [("reconstruct".to_owned(), "trilinear".to_owned())];
    sets.extend(slot_settings(session.scene(), &trilinear));
    let (truth, against) = match truth(session, &sets, options, tell)? {
        Ok(rendered) => (Look::from(&rendered), Against::Reference),
        Err(because) => {
            let finer = Look::from(&draw(session, sets)?);
            let because =
                format!("{because}; the picture of a grid {TRUTH} times finer stands in for it");
            (finer, Against::Next { because })
        }
    };
    let course = Course {
        steps,
        looks,
        truth: Some(truth),
        against,
        is_surface: declared.1 == "depth",
    };
    let (quantities, one_sided) = course.quantities(declared, &[], options);
    Ok(Ok(Study {
        axis: Axis::Grid,
        against: course.against,
        quantities,
        limits: Vec::new(),
        one_sided,
        notes: note_one_sided(one_sided).into_iter().collect(),
    }))
}

fn has_world_lengths(session: &Session) -> bool {
    let mut sources = session.scene().sources.values();
    sources.all(|source| {
        let transfer = source.as_any().downcast_ref::<TransferSource>();
        transfer
            .is_none_or(|it| matches!(it.transfer.reference_length(), ReferenceLength::World(_)))
    })
}
