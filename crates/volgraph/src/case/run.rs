//! Renders what a case's expectations need, and measures.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Serialize;
use volgraph_graph::{GraphDesc, read};
use volgraph_measure::{Comparison, MeasureError, compare_without_flip};
use volgraph_report::{Finding, Findings};
use volgraph_shader::ParamValue;

use super::figures::{not_finite, order_of};
use super::settings::{fixed_stages, in_case, last_of_each, setting, stage_setting, staged_nodes};
use super::{Case, Expectation, ExpectationKind, GraphName, Other, Param, Set};
use crate::{AdapterChoice, Overrides, Picture, Session, SessionOptions, ShaderFolders, scene};

/// What all cases are run with.
#[derive(Clone, Debug, Default)]
pub struct CaseOptions {
    /// Which adapter.
    pub adapter: AdapterChoice,
    /// Where shaders are, besides the graph's folder.
    pub shader_folders: ShaderFolders,
    /// Folders of volumes.
    pub data: Vec<PathBuf>,
}

/// What became of an expectation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// The expectation, as the case has it.
    pub expectation: String,
    /// Whether it holds.
    pub passed: bool,
    /// The figure that decided; `None` where there are no two pictures of numbers to compare.
    pub measured: Option<f64>,
    /// What it is held against.
    pub bound: Option<f64>,
    /// The figures in words.
    pub detail: String,
    /// Why it could not be measured.
    #[serde(skip)]
    pub findings: Findings,
}

impl Case {
    /// Renders and measures: an outcome for each expectation, in their order. A picture that cannot be rendered fails
    /// the expectations that need it.
    ///
    /// # Errors
    /// What [`check`](Self::check) finds, or where the graph cannot be read.
    pub fn run(&self, options: &CaseOptions) -> Result<Vec<Outcome>, Findings> {
        self.check().into_result(())?;
        let text = scene::read_text(&self.graph.path)?;
        let mut run = Run {
            case: self,
            options,
            desc: read::graph(&self.graph.path, &text)?,
            pictures: Vec::new(),
        };
        Ok(self
            .expect
            .iter()
            .map(|expectation| run.outcome(expectation))
            .collect())
    }
}

struct Run<'c> {
    case: &'c Case,
    options: &'c CaseOptions,
    desc: GraphDesc,
    /// Graph and settings → what was rendered.
    pictures: Vec<(PathBuf, Vec<Set>, Rendered)>,
}

type Rendered = Result<Arc<Picture>, Findings>;

/// A figure, its bound, and both in words.
struct Measured {
    passed: bool,
    figure: Option<(f64, f64)>,
    detail: String,
}

impl Run<'_> {
    fn outcome(&mut self, expectation: &Expectation) -> Outcome {
        let mut outcome = Outcome {
            expectation: expectation.text.clone(),
            passed: false,
            measured: None,
            bound: None,
            detail: String::new(),
            findings: Findings::new(),
        };
        match self.measure(expectation) {
            Ok(measured) => {
                outcome.passed = measured.passed;
                (outcome.measured, outcome.bound) = measured.figure.unzip();
                outcome.detail = measured.detail;
            }
            Err(findings) => {
                "it could not be measured".clone_into(&mut outcome.detail);
                outcome.findings = findings;
            }
        }
        outcome
    }

    fn measure(&mut self, expectation: &Expectation) -> Result<Measured, Findings> {
        match &expectation.kind {
            ExpectationKind::Finite => {
                let count = not_finite(&*self.own(&[])?);
                Ok(Measured {
                    passed: count == 0,
                    figure: Some((count as f64, 0.0)),
                    detail: format!("{count} pixels are not finite"),
                })
            }
            ExpectationKind::StagesAgree { max } => {
                let fragment = self.stage("fragment", expectation)?;
                let compute = self.stage("compute", expectation)?;
                let (a, b) = (self.own(&fragment)?, self.own(&compute)?);
                Ok(at_most(&a, &b, "max", *max, |comparison| {
                    comparison.max.error
                }))
            }
            ExpectationKind::Halving {
                param,
                from,
                times,
                rmse,
                order,
            } => self.halving(param, *from, *times, (*rmse, *order)),
            ExpectationKind::Equals { other, max } => {
                let (a, b) = (self.own(&[])?, self.other(other)?);
                Ok(at_most(&a, &b, "max", *max, |comparison| {
                    comparison.max.error
                }))
            }
            ExpectationKind::Differs { other, rmse } => {
                let (a, b) = (self.own(&[])?, self.other(other)?);
                Ok(measured(&a, &b, |comparison| Measured {
                    passed: comparison.rmse >= *rmse,
                    figure: Some((comparison.rmse, *rmse)),
                    detail: format!("rmse {:.3e}, at least {rmse:e}", comparison.rmse),
                }))
            }
        }
    }

    /// The pictures of a parameter halved again and again: the last two must be near, and the errors must fall.
    fn halving(
        &mut self,
        param: &Param,
        from: Option<f64>,
        times: u32,
        (rmse, order): (f64, Option<f64>),
    ) -> Result<Measured, Findings> {
        let Some(start) = from.or_else(|| self.value_of(param)) else {
            let message = format!(
                "neither the case nor the graph sets `{}.{}`",
                param.node, param.name
            );
            return Err(Finding::error("no-start", message)
                .at(param.place.clone())
                .help("say what is halved: `from: 1.0`")
                .into());
        };
        let mut pictures = Vec::new();
        for halved in 0..=times {
            let value = start / f64::from(1_u32 << halved);
            pictures.push(self.own(&[setting(param, &format!("{value}"))?])?);
        }
        let mut errors = Vec::new();
        for pair in pictures.windows(2) {
            match compare_without_flip(&pair[0], &pair[1]) {
                Ok(comparison) => errors.push(comparison.rmse),
                Err(error) => return Ok(incomparable(&error)),
            }
        }
        let last = errors.last().copied().unwrap_or_default();
        let shown: Vec<String> = errors.iter().map(|error| format!("{error:.3e}")).collect();
        let mut detail = format!("rmse {}, at most {rmse:e}", shown.join(" then "));
        if errors.iter().all(|error| *error == 0.0) {
            // Nothing was tested: an empty picture, or a parameter that nothing reads.
            return Ok(Measured {
                passed: false,
                figure: Some((last, rmse)),
                detail: format!(
                    "`{}.{}` changes nothing in the picture",
                    param.node, param.name
                ),
            });
        }
        let mut outcome = Measured {
            passed: last <= rmse,
            figure: Some((last, rmse)),
            detail: String::new(),
        };
        if let Some(bound) = order {
            match order_of(&errors) {
                None => detail += "; too near for an order",
                Some(order) => {
                    detail += &format!("; order {order:.2}, at least {bound}");
                    if outcome.passed && order < bound {
                        outcome.passed = false;
                        outcome.figure = Some((order, bound));
                    }
                }
            }
        }
        Ok(Measured { detail, ..outcome })
    }

    /// The value that the case sets for a parameter, or else the graph.
    fn value_of(&self, param: &Param) -> Option<f64> {
        let set = self
            .case
            .set
            .iter()
            .rev()
            .map(|set| &set.value)
            .find(|set| !set.is_slot && set.target == param.node && set.name == param.name);
        let in_graph = || self.desc.nodes.get(&param.node)?.params.get(&param.name);
        let value = set
            .map(|set| &set.value)
            .or_else(|| in_graph().map(|given| &given.value));
        match value? {
            ParamValue::Float(value) => Some(*value),
            ParamValue::Int(value) => Some(*value as f64),
            _ => None,
        }
    }

    /// The settings that run every node of the case's graph that can run in either stage in this one.
    fn stage(&self, stage: &str, expectation: &Expectation) -> Result<Vec<Set>, Findings> {
        let nodes = staged_nodes(&self.desc);
        if nodes.is_empty() {
            return Err(Finding::error(
                "no-stage",
                "no node of the graph runs in more than one stage",
            )
            .at(expectation.place.clone())
            .help("leave `stages_agree` out")
            .into());
        }
        nodes
            .into_iter()
            .map(|(node, _)| stage_setting(node, stage, &expectation.place))
            .collect()
    }

    fn own(&mut self, more: &[Set]) -> Rendered {
        let sets = self.case.set.iter().chain(more).cloned().collect();
        let graph = self.case.graph.path.clone();
        self.picture(&graph, sets)
    }

    fn other(&mut self, other: &Other) -> Rendered {
        match &other.graph {
            None => self.own(&other.set),
            Some(GraphName { path, .. }) => self.picture(path, other.set.clone()),
        }
    }

    /// Renders a graph with these settings, once.
    fn picture(&mut self, graph: &Path, sets: Vec<Set>) -> Rendered {
        let sets = last_of_each(fixed_stages(graph)?.into_iter().chain(sets));
        let known = self
            .pictures
            .iter()
            .find(|(path, settings, _)| path == graph && *settings == sets);
        if let Some((.., rendered)) = known {
            return rendered.clone();
        }
        let options = SessionOptions {
            adapter: self.options.adapter.clone(),
            size: self.case.size,
            overrides: Overrides {
                params: sets.iter().map(|set| set.value.clone()).collect(),
                data: self.options.data.clone(),
                ..Overrides::default()
            },
            shader_folders: self.options.shader_folders.clone(),
            with_layers: true,
            ..SessionOptions::default()
        };
        let rendered = Session::open(graph, &options)
            .and_then(|mut session| session.render())
            .map(|(picture, _)| Arc::new(picture))
            .map_err(|findings| findings.into_iter().map(|f| in_case(f, &sets)).collect());
        self.pictures
            .push((graph.to_path_buf(), sets, rendered.clone()));
        rendered
    }
}

fn at_most(
    a: &Picture,
    b: &Picture,
    name: &str,
    bound: f64,
    figure: impl Fn(&Comparison) -> f64,
) -> Measured {
    measured(a, b, |comparison| {
        let figure = figure(comparison);
        Measured {
            passed: figure <= bound,
            figure: Some((figure, bound)),
            detail: format!("{name} {figure:.3e}, at most {bound:e}"),
        }
    })
}

fn measured(a: &Picture, b: &Picture, judge: impl Fn(&Comparison) -> Measured) -> Measured {
    match compare_without_flip(a, b) {
        Ok(comparison) => judge(&comparison),
        Err(error) => incomparable(&error),
    }
}

fn incomparable(error: &MeasureError) -> Measured {
    Measured {
        passed: false,
        figure: None,
        detail: error.to_string(),
    }
}
