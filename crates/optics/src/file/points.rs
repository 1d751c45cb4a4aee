//! Lists of control points, in both forms, with everything that can be wrong in them.

use volgraph_report::ron_text::{Fields, Value};
use volgraph_report::{Finding, Findings};

use super::read_position;
use crate::color::read_color;
use crate::curve::Curve;
use crate::transfer::Absorption;

const MAX_POINTS: usize = 4096;

/// Largest extinction per reference length; past it one step is opaque whatever its length.
const MAX_EXTINCTION: f64 = 1e6;

/// Largest refractive index: germanium's is 4.
const MAX_INDEX: f64 = 4.0;

/// Control points of a curve of `N` values: position and value.
pub(super) type Points<const N: usize> = Vec<(f64, [f64; N])>;

pub(super) fn read_opacity(value: &Value<'_>) -> Result<[f64; 1], Finding> {
    let opacity = value.f64()?;
    if (0.0..=1.0).contains(&opacity) {
        Ok([opacity])
    } else {
        let message = format!("the opacity {opacity:?} is outside 0 to 1");
        Err(value
            .error("out-of-range", message)
            .help("give 0 to 1, or use `extinction`"))
    }
}

pub(super) fn read_extinction(value: &Value<'_>) -> Result<[f64; 1], Finding> {
    let extinction = value.f64()?;
    if (0.0..=MAX_EXTINCTION).contains(&extinction) {
        Ok([extinction])
    } else {
        let message = format!("the extinction {extinction:?} is outside 0 to 1e6");
        Err(value
            .error("out-of-range", message)
            .help("give an extinction of 0 or more"))
    }
}

pub(super) fn read_index(value: &Value<'_>) -> Result<[f64; 1], Finding> {
    let index = value.f64()?;
    if (1.0..=MAX_INDEX).contains(&index) {
        Ok([index])
    } else {
        let message = format!("the refractive index {index:?} is outside 1 to 4");
        Err(value
            .error("out-of-range", message)
            .help("give 1 (vacuum and, nearly, air) or more: water is 1.33, glass 1.5"))
    }
}

/// Positions must stay in `bounds` and not decrease.
pub(super) struct Order {
    bounds: Option<(f64, f64)>,
    last: Option<f64>,
}

impl Order {
    pub(super) fn new(bounds: Option<(f64, f64)>) -> Self {
        Self { bounds, last: None }
    }

    pub(super) fn read(&mut self, value: &Value<'_>) -> Result<f64, Finding> {
        let at = read_position(value)?;
        let last = self.last.replace(at);
        if let Some((lo, hi)) = self.bounds.filter(|(lo, hi)| !(*lo..=*hi).contains(&at)) {
            let message = format!("the position {at:?} is outside the domain, {lo:?} to {hi:?}");
            return Err(value.error("out-of-range", message).help(
                "give positions inside the domain, or `domain: data` for positions in data units",
            ));
        }
        match last.filter(|last| *last > at) {
            Some(last) => Err(value
                .error(
                    "decreasing",
                    format!("the position {at:?} comes after {last:?}"),
                )
                .help("sort the control points by position")),
            None => Ok(at),
        }
    }
}

pub(super) fn items<'s>(findings: &mut Findings, value: &Value<'s>) -> Option<Vec<Value<'s>>> {
    let items = findings.take(value.items())?;
    if items.is_empty() {
        findings.push(
            value
                .error("no-points", "there is no control point")
                .help("give at least one"),
        );
        return None;
    }
    if items.len() > MAX_POINTS {
        let message = format!("{} control points are more than {MAX_POINTS}", items.len());
        findings.push(
            value
                .error("too-large", message)
                .help("give fewer control points"),
        );
        return None;
    }
    Some(items)
}

/// Reads `[(at, value), …]`; what does not fit becomes findings, and then the points are not complete.
pub(super) fn read_pairs<const N: usize>(
    findings: &mut Findings,
    value: &Value<'_>,
    bounds: Option<(f64, f64)>,
    read_value: impl Fn(&Value<'_>) -> Result<[f64; N], Finding>,
) -> Option<Points<N>> {
    let mut order = Order::new(bounds);
    let mut points = Points::new();
    let items = items(findings, value)?;
    for item in &items {
        let pair = findings.take(item.items().and_then(|pair| {
            <[Value<'_>; 2]>::try_from(pair)
                .map_err(|_| item.error("wrong-type", "expected a pair (position, value)"))
        }));
        if let Some([at, value]) = pair {
            let at = findings.take(order.read(&at));
            points.extend(at.zip(findings.take(read_value(&value))));
        }
    }
    (points.len() == items.len()).then_some(points)
}

/// Reads `[(at: …, color: …, opacity: …), …]`.
pub(super) fn read_points(
    findings: &mut Findings,
    value: &Value<'_>,
    bounds: Option<(f64, f64)>,
) -> Option<(Points<3>, Absorption)> {
    let mut order = Order::new(bounds);
    let (mut colors, mut opacities, mut extinctions) =
        (Points::new(), Points::new(), Points::new());
    let items = items(findings, value)?;
    let mut first_uses_opacity = None;
    for item in &items {
        let Some(entries) = findings.take_all(item.fields()) else {
            continue;
        };
        let mut fields = Fields::new(entries);
        let mut need = |name: &'static str| {
            let value = fields.take(name);
            if value.is_none() {
                let message = format!("the control point's `{name}` is missing");
                findings.push(
                    item.error("missing-field", message)
                        .help("a control point is (at: position, color: colour, opacity: 0 to 1)"),
                );
            }
            value
        };
        let (at, color) = (need("at"), need("color"));
        let extinction = fields.take("extinction");
        let opacity = fields.take("opacity");
        if opacity.is_none() && extinction.is_none() {
            let message = "the control point has neither `opacity` nor `extinction`";
            findings.push(
                item.error("missing-field", message)
                    .help("give one of the two"),
            );
        }
        if opacity.is_some() || extinction.is_some() {
            let uses_opacity = opacity.is_some();
            let is_mixed = *first_uses_opacity.get_or_insert(uses_opacity) != uses_opacity;
            if is_mixed || (opacity.is_some() && extinction.is_some()) {
                let message = "control points mix `opacity` and `extinction`";
                findings.push(
                    item.error("exclusive-fields", message)
                        .help("use one of the two in all"),
                );
            }
        }
        fields.finish(findings);
        let at = at.and_then(|at| findings.take(order.read(&at)));
        let color = color.and_then(|color| findings.take(read_color(&color)));
        let opacity = opacity.and_then(|value| findings.take(read_opacity(&value)));
        let extinction = extinction.and_then(|value| findings.take(read_extinction(&value)));
        colors.extend(at.zip(color));
        opacities.extend(at.zip(opacity));
        extinctions.extend(at.zip(extinction));
    }
    let is_whole = |len: usize| len == items.len();
    if is_whole(colors.len()) && is_whole(opacities.len()) {
        Some((colors, Absorption::Opacity(Curve::new(opacities))))
    } else if is_whole(colors.len()) && is_whole(extinctions.len()) {
        Some((colors, Absorption::Extinction(Curve::new(extinctions))))
    } else {
        None
    }
}
