//! The graph whose orders are measured.

use volgraph_graph::{Node, NodeId, Plan, View};
use volgraph_nodes::draws_volumes;
use volgraph_reference::Progress;
use volgraph_report::{Finding, Findings};

use super::declared::{self, Declared};
use super::limits::{self, SceneLimit};
use super::{Axis, OrdersOptions};
use crate::truth::plan_without_device;
use crate::{NoProgress, Overrides, ParamOverride, Scene, Session, Truth, TruthOptions};

/// A graph, ready to be measured.
pub struct Target {
    /// The scene, with early termination off.
    pub scene: Scene,
    /// The raycasts that the picture is made of.
    raycasts: Vec<String>,
    /// The one whose slots declare.
    main: String,
    /// Smallest and largest step that its parameter takes.
    pub(super) step_range: (f64, f64),
}

/// Settings of a slot for all raycasts of a graph. A choice that is a file is looked for from the current folder.
#[must_use]
pub fn slot_settings(scene: &Scene, slots: &[(String, String)]) -> Vec<ParamOverride> {
    let nodes = scene.desc.nodes.iter();
    let raycasts = nodes.filter(|(_, node)| draws_volumes(&node.kind));
    raycasts
        .flat_map(|(name, _)| {
            slots.iter().filter_map(move |(slot, choice)| {
                let path = choice
                    .ends_with(".wgsl")
                    .then(|| std::path::absolute(choice).ok());
                let choice = path
                    .flatten()
                    .map_or_else(|| choice.clone(), |it| it.display().to_string());
                ParamOverride::parse(&format!("{name}.slots.{slot}={choice}")).ok()
            })
        })
        .collect()
}

/// The truth of a scene in a view, with some settings. However segments are classified and wherever they end, what is
/// approximated is one integral: choices of these slots that the reference does not know give way to those it knows.
///
/// # Errors
/// As [`Truth::of`].
pub fn integral_truth(
    scene: &Scene,
    view: &View,
    settings: &[ParamOverride],
    options: &TruthOptions,
    progress: &dyn Progress,
) -> Result<Truth, Findings> {
    let known = [("classify", "post"), ("traverse", "uniform")];
    let known = known.map(|(slot, choice)| (slot.to_owned(), choice.to_owned()));
    let mut overrides = scene.overrides.clone();
    // Renderers of one way to walk have no slot `traverse`.
    let has_slot = |setting: &ParamOverride| {
        let node = scene.desc.nodes.get(&setting.target);
        let kind = node.and_then(|node| scene.registry.node(&node.kind));
        kind.is_some_and(|kind| kind.slots().iter().any(|slot| slot.name == setting.name))
    };
    let known = slot_settings(scene, &known).into_iter().filter(has_slot);
    overrides.params.extend(known);
    overrides.params.extend(settings.iter().cloned());
    let scene = scene.with_overrides(&overrides, &NoProgress)?;
    let plan = plan_without_device(&scene, view.size)?;
    Truth::of(&plan, view, options, progress)
}

impl Target {
    /// A scene with its slots set, and early termination off.
    ///
    /// # Errors
    /// What is wrong with the graph; `no-step` where no raycast with a step makes the picture.
    pub fn new(scene: &Scene, slots: &[(String, String)]) -> Result<Self, Findings> {
        scene.check_color_output()?;
        let mut overrides = scene.overrides.clone();
        overrides.params.extend(slot_settings(scene, slots));
        let scene = scene.with_overrides(&overrides, &NoProgress)?;
        let plan = plan_without_device(&scene, [16, 16])?;
        let raycasts: Vec<&Node> = plan
            .order
            .iter()
            .map(|id| &plan.graph.nodes[*id])
            .filter(|node| draws_volumes(&node.kind_name()) && has(node, "step"))
            .collect();
        let Some(last) = raycasts.last() else {
            return Err(Finding::error(
                "no-step",
                "no raycast with a step makes this picture, so there is no order in the step",
            )
            .into());
        };
        let main = last.name.clone();
        let step_range = last
            .specs()
            .iter()
            .find(|spec| spec.name == "step")
            .and_then(|spec| spec.range)
            .unwrap_or((0.01, 64.0));
        let names: Vec<String> = raycasts.iter().map(|node| node.name.clone()).collect();
        let ends: Vec<_> = raycasts
            .iter()
            .filter(|node| has(node, "early_termination"))
            .filter_map(|node| setting(&node.name, "early_termination", 0.0))
            .collect();
        let overrides = Overrides {
            params: overrides.params.into_iter().chain(ends).collect(),
            ..overrides
        };
        Ok(Self {
            scene: scene.with_overrides(&overrides, &NoProgress)?,
            raycasts: names,
            main,
            step_range,
        })
    }

    /// Settings of a number for all raycasts.
    pub(super) fn settings(&self, param: &str, value: f64) -> Vec<ParamOverride> {
        let nodes = self.raycasts.iter();
        nodes
            .filter_map(|node| setting(node, param, value))
            .collect()
    }

    /// The raycast whose slots declare, in a plan.
    pub(super) fn main<'p>(&self, plan: &'p Plan) -> Option<(NodeId, &'p Node)> {
        let mut nodes = plan.order.iter().map(|id| (*id, &plan.graph.nodes[*id]));
        nodes.find(|(_, node)| node.name == self.main)
    }

    /// What is declared, by its slots or by the options, and of which quantity.
    pub(super) fn declared(
        &self,
        session: &Session,
        axis: Axis,
        options: &OrdersOptions,
    ) -> Result<(Option<Declared>, &'static str), Findings> {
        let Some((_, node)) = self.main(session.plan()) else {
            return Ok((None, "colour"));
        };
        let quantity = declared::quantity(node);
        if let (Some(order), Axis::Step) = (options.expected, axis) {
            let by = "--expect".to_owned();
            return Ok((Some(Declared { order, by }), quantity));
        }
        Ok((declared::of(node, axis)?, quantity))
    }

    /// What limits orders in its scene.
    pub(super) fn limits(&self, plan: &Plan, view: &View) -> Vec<SceneLimit> {
        let main = self.main(plan);
        main.map(|(id, _)| limits::of(&plan.context(id, view, None), view))
            .unwrap_or_default()
    }
}

fn has(node: &Node, param: &str) -> bool {
    node.specs().iter().any(|spec| spec.name == param)
}

pub(super) fn setting(node: &str, param: &str, value: f64) -> Option<ParamOverride> {
    // With a point, as numbers are written in graphs.
    ParamOverride::parse(&format!("{node}.{param}={value:?}")).ok()
}
