//! What a raycast's labels mean, for the reference.

use volgraph_graph::{NodeContext, ParamRow};
use volgraph_reference::{Field, Labels};
use volgraph_report::Finding;

use crate::source::segments::{LABELS, Segment};
use crate::{placement, segmentation};

/// A look that labels have: their parameters, and the row of their transfer function.
pub(super) struct Row<'g> {
    pub(super) params: Option<&'g ParamRow>,
    pub(super) transfer: usize,
}

/// The labels of a node, and the looks that they have beside the node's own, which is the look 0.
pub(super) fn labels<'g>(
    node: &NodeContext<'g>,
) -> Result<(Option<Labels>, Vec<Row<'g>>), Finding> {
    if !segmentation::has_labels(node) {
        return Ok((None, Vec::new()));
    }
    let placed = segmentation::placed(node)?;
    let segments = segmentation::segments(node);
    // The node's own transfer function is the first row, where it has one.
    let own = usize::from(node.is_connected("transfer"));
    let mut rows = Vec::new();
    let mut known: Vec<*const Segment> = Vec::new();
    let mut looks = vec![0; LABELS];
    let mut is_visible = vec![true; LABELS];
    for label in 0..=u8::MAX {
        let at = usize::from(label);
        let Some(segment) = segments.and_then(|segments| segments.segment(label)) else {
            continue;
        };
        is_visible[at] = segment.is_visible;
        // What is not drawn may have no transfer function.
        if !segment.is_visible {
            continue;
        }
        let seen = known.iter().position(|one| std::ptr::eq(*one, segment));
        looks[at] = 1 + seen.unwrap_or_else(|| {
            known.push(segment);
            rows.push(Row {
                params: Some(&segment.params),
                transfer: segment.transfer.map_or(0, |at| at + own),
            });
            rows.len() - 1
        });
    }
    let labels = Labels {
        field: Field::new(placement::volume(node, "labels")?).placed(placed.index_from_world),
        low: placed.low,
        high: placed.high,
        is_blocky: node.text("label_boundary") == "blocky",
        looks,
        is_visible,
    };
    Ok((Some(labels), rows))
}
