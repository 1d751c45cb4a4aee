//! Which variant of a node runs: the only one, the one that was chosen before, or the fastest.
//!
//! The fastest is measured when a frame first needs it, on a small view; the choice holds as long as the runner lives, and
//! is kept for later runs of the program where there is a place for that.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use volgraph_graph::fingerprint::Hasher;
use volgraph_graph::{NodeId, Plan, View, hex};

use super::frame::Recording;
use super::{Installation, Runner};
use crate::error::GpuError;

/// The side of the view on which variants are measured.
const MEASURE_SIZE: u32 = 256;

/// The side of the tiles that software rasterisers give to their threads.
const SOFTWARE_TILE: u32 = 64;

/// The side of the view on which variants are made ready: shaders are compiled by what is drawn, not by how much of it.
const WARM_UP_SIZE: u32 = 8;

/// One round of measurements is enough where the fastest is ahead by this factor.
const CLEAR: f64 = 1.5;

/// Changes with how variants are measured and with what modules become on the way to the device, so that they are measured
/// again.
const REVISION: u32 = 2;

/// Which variant of a node is the fastest, and the times that say so, in milliseconds.
#[derive(Clone, Debug)]
pub(super) struct Chosen {
    pub variant: &'static str,
    pub measured: BTreeMap<&'static str, f64>,
}

impl Chosen {
    fn of(measured: BTreeMap<&'static str, f64>) -> Option<Self> {
        let fastest = measured.iter().min_by(|a, b| a.1.total_cmp(b.1));
        let variant = *fastest?.0;
        Some(Self { variant, measured })
    }

    /// As lines `name milliseconds`.
    fn to_text(&self) -> String {
        let lines = self.measured.iter();
        lines.map(|(name, ms)| format!("{name} {ms}\n")).collect()
    }

    /// `None` unless each of the variants has its time.
    fn from_text(text: &str, variants: &[&'static str]) -> Option<Self> {
        let mut measured = BTreeMap::new();
        for line in text.lines() {
            let (name, ms) = line.split_once(' ')?;
            let name = variants.iter().find(|variant| **variant == name)?;
            let ms: f64 = ms.parse().ok()?;
            measured.insert(*name, Some(ms).filter(|ms| ms.is_finite() && *ms > 0.0)?);
        }
        (measured.len() == variants.len()).then_some(())?;
        Self::of(measured)
    }
}

impl Runner {
    /// The variant to run: the only one, the one chosen before, or the fastest of all on a small view, measured now
    /// with the inputs that the frame has made so far.
    pub(super) fn variant(
        &mut self,
        installation: &mut Installation,
        id: NodeId,
        view: &View,
        recording: &mut Recording,
    ) -> Result<Option<&'static str>, GpuError> {
        let plan = Arc::clone(&installation.plan);
        let variants = plan.variants(id);
        let Some(&first) = variants.first() else {
            return Ok(None);
        };
        if variants.len() == 1 {
            return Ok(Some(first));
        }
        let key = variant_key(&plan, id);
        if let Some(chosen) = installation
            .chosen
            .get(&key)
            .filter(|chosen| variants.contains(&chosen.variant))
        {
            return Ok(Some(chosen.variant));
        }
        // Nodes before may share a guard with this one, whose counters the measuring clears.
        self.settle(recording)?;
        recording.check()?;
        for &variant in &variants {
            self.time(installation, id, view, WARM_UP_SIZE, variant)?;
        }
        let side = self.measure_size();
        let mut times: BTreeMap<&'static str, f64> = BTreeMap::new();
        // In turns; the fastest counts: what is beside on the machine only adds.
        for round in 0..2 {
            for &variant in &variants {
                let elapsed = self.time(installation, id, view, side, variant)?;
                let best = times.entry(variant).or_insert(elapsed);
                *best = best.min(elapsed);
            }
            if round == 0 && is_clear(&times) {
                break;
            }
        }
        let Some(chosen) = Chosen::of(times) else {
            return Ok(Some(first));
        };
        let variant = chosen.variant;
        self.kept
            .write(&self.kept_name(&plan, id), chosen.to_text().as_bytes());
        installation.chosen.insert(key, chosen);
        installation.has_chosen = true;
        Ok(Some(variant))
    }

    /// Adds what was chosen in earlier runs of the program.
    pub(super) fn recall(&self, chosen: &mut BTreeMap<String, Chosen>, plan: &Plan) {
        for &id in &plan.order {
            let variants = plan.variants(id);
            let key = variant_key(plan, id);
            if variants.len() < 2 || chosen.contains_key(&key) {
                continue;
            }
            let kept = self.kept.read(&self.kept_name(plan, id));
            let kept = kept.and_then(|bytes| String::from_utf8(bytes).ok());
            let kept = kept.and_then(|text| Chosen::from_text(&text, &variants));
            if let Some(kept) = kept {
                chosen.insert(key, kept);
            }
        }
    }

    /// Draws with a variant on a small view: milliseconds until it is done.
    fn time(
        &mut self,
        installation: &mut Installation,
        id: NodeId,
        view: &View,
        side: u32,
        variant: &'static str,
    ) -> Result<f64, GpuError> {
        // The plan's own camera has the volumes in view, wherever this frame's looks.
        let small = View {
            size: view.size.map(|n| n.min(side)),
            ..installation.plan.view()
        };
        let mut recording = Recording::new(self.encoder(), None);
        let start = Instant::now();
        self.node(installation, id, &small, Some(variant), &mut recording)?;
        self.settle(&mut recording)?;
        // What does not end need not be timed.
        recording.check()?;
        Ok(start.elapsed().as_secs_f64() * 1e3)
    }

    /// A software adapter takes long for a picture, and its threads are few: a tile for each is enough.
    fn measure_size(&self) -> u32 {
        if self.gpu.adapter().class != "software" {
            return MEASURE_SIZE;
        }
        let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let tiles = (2..MEASURE_SIZE / SOFTWARE_TILE).find(|n| (n * n) as usize >= threads);
        tiles.map_or(MEASURE_SIZE, |tiles| tiles * SOFTWARE_TILE)
    }

    /// The name under which a choice is kept: of all that it depends on, the size of the inputs included.
    fn kept_name(&self, plan: &Plan, id: NodeId) -> String {
        let node = &plan.graph.nodes[id];
        let mut hasher = Hasher::new();
        hasher.part(env!("CARGO_PKG_VERSION").as_bytes());
        hasher.part(&REVISION.to_le_bytes());
        hasher.part(self.gpu.adapter().to_string().as_bytes());
        hasher.part(variant_key(plan, id).as_bytes());
        if let Some(program) = &node.program {
            hasher.part(&program.module.linked.digest);
            hasher.part(format!("{:?}", plan.choices(id)).as_bytes());
        }
        for (port, link) in &node.inputs {
            let resource = plan.resources.get(&(link.node, link.port.clone()));
            hasher.part(format!("{port} {resource:?}").as_bytes());
        }
        format!("variant-{}", hex(&hasher.finish()))
    }
}

fn is_clear(times: &BTreeMap<&'static str, f64>) -> bool {
    let mut sorted: Vec<f64> = times.values().copied().collect();
    sorted.sort_by(f64::total_cmp);
    matches!(sorted[..], [first, second, ..] if second > CLEAR * first)
}

/// What a choice among variants depends on while the runner lives: the shaders' names, not their texts. A text that is
/// being edited need not be measured anew each time.
pub(super) fn variant_key(plan: &Plan, id: NodeId) -> String {
    let node = &plan.graph.nodes[id];
    let choices: BTreeMap<&str, &str> = node
        .slots
        .iter()
        .map(|(slot, choice)| (slot.as_str(), choice.choice.as_str()))
        .collect();
    let spec = node.program.as_ref().map(|program| &program.spec);
    format!("{} {choices:?} {spec:?}", node.kind_name())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_comes_back_from_its_text_and_nothing_else_does() {
        let variants = ["fragment", "compute"];
        let chosen = Chosen::of([("fragment", 12.5), ("compute", 3.25)].into()).unwrap();
        let back = Chosen::from_text(&chosen.to_text(), &variants).unwrap();
        assert_eq!(back.variant, "compute");
        assert_eq!(back.measured, chosen.measured);
        for wrong in [
            "",
            "fragment 1\n",
            "fragment 1\ncompute x\n",
            "fragment 1\ncompute NaN\n",
            "fragment 1\ncompute -2\n",
            "fragment 1\nmesh 2\n",
            "fragment",
            "\u{1}\u{2}",
        ] {
            assert!(Chosen::from_text(wrong, &variants).is_none(), "{wrong:?}");
        }
    }

    #[test]
    fn one_round_is_enough_where_one_is_far_ahead() {
        assert!(is_clear(&[("fragment", 10.0), ("compute", 16.0)].into()));
        assert!(!is_clear(&[("fragment", 10.0), ("compute", 14.0)].into()));
        assert!(!is_clear(&[("fragment", 10.0)].into()));
    }
}
