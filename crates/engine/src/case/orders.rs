//! Convergence: a parameter halved again and again, and how fast the pictures come to rest.

use std::sync::Arc;

use volgraph_measure::compare_without_flip;
use volgraph_report::{Finding, Findings, Place};
use volgraph_shader::ParamValue;

use super::figures::order_of;
use super::measure::incomparable;
use super::outcome::{Curve, Measured, Shown};
use super::run::Run;
use super::settings::setting;
use super::{Expectation, ExpectationKind, OrderAgainst, Param, Point};
use crate::Picture;

/// The pictures of a parameter halved again and again, and what their errors are.
struct Series {
    pictures: Vec<Shown>,
    curve: Curve,
}

impl Series {
    fn errors(&self) -> Vec<f64> {
        self.curve.points.iter().map(|(_, error)| *error).collect()
    }

    fn shown(&self) -> String {
        let errors = self.errors();
        let errors: Vec<String> = errors.iter().map(|error| format!("{error:.3e}")).collect();
        errors.join(" then ")
    }

    /// The first picture and the last one.
    fn ends(&self) -> Vec<Shown> {
        let ends = [self.pictures.first(), self.pictures.last()];
        ends.into_iter().flatten().cloned().collect()
    }
}

impl Run<'_> {
    /// The pictures of a parameter halved again and again: the last two must be near, and the errors must fall.
    pub(super) fn halving(
        &mut self,
        point: &Point,
        param: &Param,
        from: Option<f64>,
        times: u32,
        (rmse, order): (f64, Option<f64>),
    ) -> Result<Measured, Findings> {
        let series = match self.series(point, param, from, times, None)? {
            Ok(series) => series,
            Err(measured) => return Ok(measured),
        };
        let errors = series.errors();
        let last = errors.last().copied().unwrap_or_default();
        let mut detail = format!("rmse {}, at most {rmse:e}", series.shown());
        let (mut passed, mut figure) = (last <= rmse, Some((last, rmse)));
        if let Some(bound) = order {
            match order_of(&series.curve.points) {
                None => detail += "; too near for an order",
                Some(order) => {
                    detail += &format!("; order {order:.2}, at least {bound}");
                    if passed && order < bound {
                        passed = false;
                        figure = Some((order, bound));
                    }
                }
            }
        }
        let mut measured = Measured::new(passed, figure, detail).with(series.ends());
        measured.curve = Some(series.curve);
        Ok(measured)
    }

    /// The order of convergence.
    pub(super) fn order(
        &mut self,
        point: &Point,
        param: &Param,
        from: Option<f64>,
        halvings: u32,
        against: OrderAgainst,
        at_least: f64,
    ) -> Result<Measured, Findings> {
        let truth = match against {
            OrderAgainst::Successive => None,
            OrderAgainst::Reference => {
                let request = self.renderer.own(point, &[])?;
                Some(self.truth(&request, &asking(&param.place))?)
            }
        };
        let series = match self.series(point, param, from, halvings, truth.as_ref())? {
            Ok(series) => series,
            Err(measured) => return Ok(measured),
        };
        let errors = format!("rmse {}", series.shown());
        let mut measured = match order_of(&series.curve.points) {
            None => Measured::new(
                false,
                None,
                format!(
                    "{errors}: no order can be told of errors that are those of f32; use `equals`"
                ),
            ),
            Some(order) => {
                let detail = format!("order {order:.2}, at least {at_least}; {errors}");
                Measured::new(order >= at_least, Some((order, at_least)), detail)
            }
        };
        measured = measured.with(series.ends());
        measured.curve = Some(series.curve);
        Ok(measured)
    }

    /// Renders them, and compares each with the next one, or all with the truth. What ends it early is a measurement.
    fn series(
        &mut self,
        point: &Point,
        param: &Param,
        from: Option<f64>,
        halvings: u32,
        truth: Option<&Arc<Picture>>,
    ) -> Result<Result<Series, Measured>, Findings> {
        let Some(start) = from.or_else(|| self.value_of(param, point)) else {
            let message = format!(
                "neither the case nor the graph sets `{}.{}`",
                param.node, param.name
            );
            return Err(Finding::error("no-start", message)
                .at(param.place.clone())
                .help("say what is halved: `from: 1.0`")
                .into());
        };
        let (mut pictures, mut values) = (Vec::new(), Vec::new());
        for halved in 0..=halvings {
            let value = start / f64::from(1_u32 << halved);
            let rendered = self.own(point, &[setting(param, &format!("{value}"))?])?;
            values.push(value);
            pictures.push(rendered.shown());
        }
        let mut points = Vec::new();
        for (at, shown) in pictures.iter().enumerate() {
            let next = pictures.get(at + 1).map(|next| &next.picture);
            let Some(against) = truth.or(next) else {
                break;
            };
            match compare_without_flip(&shown.picture, against) {
                Ok(comparison) => points.push((values[at], comparison.rmse)),
                Err(error) => return Ok(Err(incomparable(&error))),
            }
        }
        let name = format!("{}.{}", param.node, param.name);
        if pictures
            .windows(2)
            .all(|pair| pair[0].picture.color == pair[1].picture.color)
        {
            // Nothing was tested: an empty picture, or a parameter that nothing reads.
            let detail = format!("`{name}` changes nothing in the picture");
            return Ok(Err(
                Measured::new(false, None, detail).with(pictures.into_iter().take(1))
            ));
        }
        let curve = Curve { name, points };
        Ok(Ok(Series { pictures, curve }))
    }

    /// The value that point or case set for a parameter, or else the graph.
    fn value_of(&self, param: &Param, point: &Point) -> Option<f64> {
        let case = self.renderer.case;
        let sets = case.set.iter().chain(&point.set);
        let set = sets
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
}

/// What asks for the truth, as far as findings need it.
fn asking(place: &Place) -> Expectation {
    Expectation {
        kind: ExpectationKind::Finite,
        text: String::new(),
        place: place.clone(),
    }
}
