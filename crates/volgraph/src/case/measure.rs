//! Measures what an expectation speaks of.

use std::path::Path;
use std::sync::Arc;

use volgraph_measure::{Comparison, MeasureError, compare, compare_without_flip};
use volgraph_picture::SaveOptions;
use volgraph_report::{Finding, Findings, Place};

use super::figures::{not_finite, seen};
use super::invariance::{agree, mirrored, rolled, stored};
use super::kinds::{Area, PictureBound, Values};
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
                let whole = Area {
                    first: [0, 0],
                    last: [own.picture.width - 1, own.picture.height - 1],
                };
                self.values(&own, within.unwrap_or(whole), values, *max, expectation)
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

    /// The largest error of an area's pixels against values that are given, or against its first pixel.
    fn values(
        &self,
        own: &Rendered,
        area: Area,
        values: &Values,
        max: f64,
        expectation: &Expectation,
    ) -> Result<Measured, Findings> {
        let picture = &own.picture;
        let mut values = *values;
        if values.is_empty() {
            let first = picture.pixel(area.first[0], area.first[1]);
            values.color = first.map(|color| color.map(f64::from));
        }
        let layer = |layer: Option<&Vec<f32>>, name: &str| {
            layer.cloned().ok_or_else(|| {
                let message = format!("the picture has no {name}");
                Finding::error("no-layer", message)
                    .at(expectation.place.clone())
                    .help("the node of the output `color` has to have it: a raycast does")
            })
        };
        let opacity = match values.opacity {
            Some(expected) => Some((expected, layer(picture.opacity.as_ref(), "opacity")?)),
            None => None,
        };
        let depth = match values.depth {
            Some(expected) => Some((expected, layer(picture.depth.as_ref(), "depth")?)),
            None => None,
        };
        let mut worst = (0.0_f64, String::new());
        let mut look = |what: &str, x: u32, y: u32, seen: f32, expected: f64| {
            let error = (f64::from(seen) - expected).abs();
            // What is no number is worse than anything.
            let error = if error.is_nan() { f64::INFINITY } else { error };
            if error > worst.0 || worst.1.is_empty() {
                worst = (error, format!("{what} {seen} for {expected} at ({x}, {y})"));
            }
        };
        for y in area.first[1]..=area.last[1] {
            for x in area.first[0]..=area.last[0] {
                let at = y as usize * picture.width as usize + x as usize;
                if let (Some(expected), Some(color)) = (values.color, picture.pixel(x, y)) {
                    for (at, what) in ["red", "green", "blue", "alpha"].iter().enumerate() {
                        look(what, x, y, color[at], expected[at]);
                    }
                }
                for (what, values) in [("opacity", &opacity), ("depth", &depth)] {
                    if let Some((expected, seen)) = values {
                        let seen = seen.get(at).copied().unwrap_or(f32::NAN);
                        look(what, x, y, seen, *expected);
                    }
                }
            }
        }
        let mut measured = Measured::at_most("max", worst.0, max);
        measured.detail += &format!("; {}", worst.1);
        Ok(measured.with([own.shown()]))
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

    fn stored_picture(
        &self,
        own: &Rendered,
        file: &Path,
        bound: PictureBound,
        expectation: &Expectation,
    ) -> Result<Measured, Findings> {
        let told = |code, message: String, help: &str| {
            Findings::from(
                Finding::error(code, message)
                    .at(expectation.place.clone())
                    .help(help),
            )
        };
        if self.renderer.options.bless {
            let folder = file.parent().unwrap_or(Path::new(""));
            let made = if folder.as_os_str().is_empty() {
                Ok(())
            } else {
                std::fs::create_dir_all(folder)
            };
            let failed = |why: String| {
                let message = format!("{} cannot be written: {why}", file.display());
                told("io", message, "check that you may write there")
            };
            made.map_err(|error| failed(error.to_string()))?;
            let saved = own.picture.save(file, SaveOptions::default());
            let report = saved.map_err(|error| failed(error.to_string()))?;
            let mut detail = format!("written to {}", file.display());
            if report.nan_pixels > 0 {
                detail += &format!("; {} pixels are not numbers", report.nan_pixels);
            }
            return Ok(Measured::new(report.nan_pixels == 0, None, detail).with([own.shown()]));
        }
        if !file.is_file() {
            let message = format!("there is no picture {}", file.display());
            return Err(told(
                "missing-picture",
                message,
                "`volgraph test --bless` writes it: look at it before you keep it",
            ));
        }
        let there = Picture::load(file).map_err(|error| {
            Findings::from(Finding::error("picture", error.to_string()).at(Place::whole_file(file)))
        })?;
        let compared = match bound {
            PictureBound::Flip(_) => compare(&own.picture, &there),
            _ => compare_without_flip(&own.picture, &there),
        };
        let measured = match compared {
            Err(error) => incomparable(&error),
            Ok(comparison) => match bound {
                PictureBound::Flip(bound) => {
                    Measured::at_most("flip", comparison.flip.unwrap_or(f64::INFINITY), bound)
                }
                PictureBound::Rmse(bound) => Measured::at_most("rmse", comparison.rmse, bound),
                PictureBound::Max(bound) => Measured::at_most("max", comparison.max.error, bound),
            },
        };
        let stored = Shown {
            name: file.display().to_string(),
            picture: Arc::new(there),
        };
        Ok(measured.with([own.shown(), stored]))
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
