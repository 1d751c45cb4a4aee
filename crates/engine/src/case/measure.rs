//! Measures what an expectation speaks of.

use std::sync::Arc;

use volgraph_measure::{Comparison, MeasureError, compare_without_flip};
use volgraph_report::{Finding, Findings};

use super::figures::{not_finite, seen};
use super::invariance::{agree, mirrored, rolled, stored};
use super::kinds::Area;
use super::outcome::{Measured, Shown};
use super::reference;
use super::render::{Rendered, Request, Treatment};
use super::run::{Run, backends};
use super::settings::{stage_setting, staged_nodes};
use super::{Expectation, ExpectationKind, Point, Set};
use crate::Picture;

impl Run<'_> {
    pub(super) fn measure(
        &mut self,
        expectation: &Expectation,
        point: &Point,
    ) -> Result<Measured, Findings> {
        match &expectation.kind {
            ExpectationKind::Finite => Ok(finite(&self.own(point, &[])?)),
            ExpectationKind::Seen { at_least } => {
                let own = self.own(point, &[])?;
                let share = seen(&own.picture);
                let detail = format!("{share:.3} of the pixels, at least {at_least}");
                let measured = Measured::new(share >= *at_least, Some((share, *at_least)), detail);
                Ok(measured.with([own.shown()]))
            }
            ExpectationKind::Pixel { at, values, max } => {
                let own = self.own(point, &[])?;
                let at = at.unwrap_or([own.picture.width / 2, own.picture.height / 2]);
                let area = Area {
                    first: at,
                    last: at,
                };
                self.values(&own, area, values, *max, expectation)
            }
            ExpectationKind::Uniform {
                within,
                values,
                max,
            } => {
                let own = self.own(point, &[])?;
                let area = within.unwrap_or(self.renderer.case.whole());
                self.values(&own, area, values, *max, expectation)
            }
            ExpectationKind::StagesAgree { max } => {
                let fragment = self.stage("fragment", expectation)?;
                let compute = self.stage("compute", expectation)?;
                let (a, b) = (self.own(point, &fragment)?, self.own(point, &compute)?);
                Ok(at_most(&a, &b, *max))
            }
            ExpectationKind::AdaptersAgree { max } => self.adapters(point, *max),
            ExpectationKind::Mirrored { axis, max, except } => {
                let (a, b) = self.pair(point, Treatment::Mirrored(*axis))?;
                let back = mirrored::picture(&b.picture);
                Ok(agree(&a.picture, &back, *max, *except).with([a.shown(), moved(&b, back)]))
            }
            ExpectationKind::Rolled {
                quarters,
                max,
                except,
            } => {
                let (a, b) = self.pair(point, Treatment::Rolled(*quarters))?;
                let back = rolled::picture(&b.picture, *quarters);
                Ok(agree(&a.picture, &back, *max, *except).with([a.shown(), moved(&b, back)]))
            }
            ExpectationKind::StoredAlike { max } => {
                let mut pictures = Vec::new();
                for scalar in stored::TYPES {
                    pictures.push(self.treated(point, Treatment::Stored(scalar))?);
                }
                Ok(worst_of(&pictures, *max))
            }
            ExpectationKind::Halving {
                param,
                from,
                times,
                rmse,
                order,
            } => self.halving(point, param, *from, *times, (*rmse, *order)),
            ExpectationKind::Order {
                param,
                from,
                halvings,
                against,
                at_least,
            } => self.order(point, param, *from, *halvings, *against, *at_least),
            ExpectationKind::Equals { other, max } => {
                let other = self.renderer.other(point, other)?;
                let (a, b) = (self.own(point, &[])?, self.renderer.render(&other)?);
                Ok(at_most(&a, &b, *max))
            }
            ExpectationKind::Differs { other, rmse } => {
                let other = self.renderer.other(point, other)?;
                let (a, b) = (self.own(point, &[])?, self.renderer.render(&other)?);
                let measured = measured(&a.picture, &b.picture, |comparison| {
                    let detail = format!("rmse {:.3e}, at least {rmse:e}", comparison.rmse);
                    let figure = Some((comparison.rmse, *rmse));
                    Measured::new(comparison.rmse >= *rmse, figure, detail)
                });
                Ok(measured.with([a.shown(), b.shown()]))
            }
            ExpectationKind::Reference { rmse, max } => {
                self.reference(point, *rmse, *max, expectation)
            }
            ExpectationKind::NotSlower {
                than,
                ratio,
                frames,
            } => self.not_slower(point, than, *ratio, *frames),
            ExpectationKind::Picture { file, bound } => {
                let own = self.own(point, &[])?;
                self.stored_picture(&own, file, *bound, expectation)
            }
        }
    }

    /// The case's own picture.
    pub(super) fn own(&mut self, point: &Point, more: &[Set]) -> Result<Rendered, Findings> {
        let request = self.renderer.own(point, more)?;
        self.renderer.render(&request)
    }

    fn treated(&mut self, point: &Point, treatment: Treatment) -> Result<Rendered, Findings> {
        let request = Request {
            treatment,
            ..self.renderer.own(point, &[])?
        };
        self.renderer.render(&request)
    }

    /// The case's own picture, and that of the treated scene.
    fn pair(
        &mut self,
        point: &Point,
        treatment: Treatment,
    ) -> Result<(Rendered, Rendered), Findings> {
        Ok((self.own(point, &[])?, self.treated(point, treatment)?))
    }

    fn adapters(&mut self, point: &Point, max: f64) -> Result<Measured, Findings> {
        let mut pictures = Vec::new();
        for backend in backends() {
            let request = Request {
                adapter: Some(backend),
                ..self.renderer.own(point, &[])?
            };
            pictures.push(self.renderer.render(&request)?);
        }
        Ok(worst_of(&pictures, max))
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

    fn reference(
        &mut self,
        point: &Point,
        rmse: Option<f64>,
        max: Option<f64>,
        expectation: &Expectation,
    ) -> Result<Measured, Findings> {
        let request = self.renderer.own(point, &[])?;
        let own = self.renderer.render(&request)?;
        let truth = self.truth(&request, expectation)?;
        let measured = measured(&own.picture, &truth, |comparison| {
            let (mut passed, mut figure, mut parts) = (true, None, Vec::new());
            let figures = [
                ("rmse", comparison.rmse, rmse),
                ("max", comparison.max.error, max),
            ];
            for (name, error, bound) in figures {
                if let Some(bound) = bound {
                    parts.push(format!("{name} {error:.3e}, at most {bound:e}"));
                    if figure.is_none() || (passed && error > bound) {
                        figure = Some((error, bound));
                    }
                    passed &= error <= bound;
                }
            }
            Measured::new(passed, figure, parts.join("; "))
        });
        let name = "float64 reference".to_owned();
        let picture = truth;
        Ok(measured.with([own.shown(), Shown { name, picture }]))
    }

    pub(super) fn truth(
        &mut self,
        request: &Request,
        expectation: &Expectation,
    ) -> Result<Arc<Picture>, Findings> {
        let (session, _) = self.renderer.session(request)?;
        reference::picture(&session)
            .map(Arc::new)
            .map_err(|findings| {
                let place = || expectation.place.clone();
                findings.into_iter().map(|it| it.or_at(place)).collect()
            })
    }
}

/// A picture that was turned back.
fn moved(rendered: &Rendered, picture: Picture) -> Shown {
    Shown {
        name: format!("{}, turned back", rendered.name),
        picture: Arc::new(picture),
    }
}

fn finite(own: &Rendered) -> Measured {
    let count = not_finite(&own.picture);
    let mut detail = format!("{count} pixels are not finite");
    let hazards: Vec<String> = own
        .hazards
        .sorted()
        .iter()
        .map(|f| f.message.clone())
        .collect();
    if !hazards.is_empty() {
        detail += &format!("; {}", hazards.join("; "));
    }
    let passed = count == 0 && hazards.is_empty();
    Measured::new(passed, Some((count as f64, 0.0)), detail).with([own.shown()])
}

/// The first picture against all others: the largest error.
fn worst_of(pictures: &[Rendered], max: f64) -> Measured {
    let mut worst: Option<Measured> = None;
    if let Some((first, rest)) = pictures.split_first() {
        for other in rest {
            let measured = at_most(first, other, max);
            let figure = |measured: &Measured| measured.figure.map_or(f64::INFINITY, |it| it.0);
            if worst
                .as_ref()
                .is_none_or(|worst| figure(&measured) > figure(worst))
            {
                worst = Some(measured);
            }
        }
    }
    worst.unwrap_or_else(|| Measured::new(false, None, "there is nothing to compare".to_owned()))
}

fn at_most(a: &Rendered, b: &Rendered, bound: f64) -> Measured {
    let measured = measured(&a.picture, &b.picture, |comparison| {
        Measured::at_most("max", comparison.max.error, bound)
    });
    measured.with([a.shown(), b.shown()])
}

pub(super) fn measured(
    a: &Picture,
    b: &Picture,
    judge: impl Fn(&Comparison) -> Measured,
) -> Measured {
    match compare_without_flip(a, b) {
        Ok(comparison) => judge(&comparison),
        Err(error) => incomparable(&error),
    }
}

pub(super) fn incomparable(error: &MeasureError) -> Measured {
    Measured::new(false, None, error.to_string())
}
