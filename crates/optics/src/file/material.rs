//! The field `material`: control points with any of the values of a material.

use volgraph_report::ron_text::{Fields, Value};
use volgraph_report::{Finding, Findings};

use super::points::{Order, items};
use crate::material::{Material, MaterialField, MaterialPoint};

const HELP: &str = "a control point is (at: position, ambient: 0 to 1, diffuse: 0 to 1, specular: 0 to 1, \
                    shininess: 1 to 256), and may leave out what it does not say";

/// Reads `[(at: …, ambient: …, diffuse: …, specular: …, shininess: …), …]`.
pub(super) fn read_material(
    findings: &mut Findings,
    value: &Value<'_>,
    bounds: Option<(f64, f64)>,
) -> Option<MaterialField> {
    let mut order = Order::new(bounds);
    let items = items(findings, value)?;
    let mut points: Vec<MaterialPoint> = Vec::new();
    for item in &items {
        let Some(entries) = findings.take_all(item.fields()) else {
            continue;
        };
        let mut fields = Fields::new(entries);
        let at = fields.take("at");
        let given = Material::NAMES.map(|name| fields.take(name));
        fields.finish(findings);
        let mut missing = |message: &str| {
            findings.push(item.error("missing-field", message).help(HELP));
        };
        if at.is_none() {
            missing("the control point's `at` is missing");
        }
        let says_something = given.iter().any(Option::is_some);
        if !says_something {
            missing("the control point says nothing of the material");
        }
        let at = at.and_then(|at| findings.take(order.read(&at)));
        let mut is_whole = says_something;
        let values = std::array::from_fn(|i| {
            let read = findings.take(read_value(given[i].as_ref()?, i));
            is_whole &= read.is_some();
            read
        });
        points.extend(at.filter(|_| is_whole).map(|at| (at, values)));
    }
    (points.len() == items.len()).then(|| MaterialField::new(points))
}

fn read_value(value: &Value<'_>, which: usize) -> Result<f64, Finding> {
    let number = value.f64()?;
    let (low, high) = Material::BOUNDS[which];
    if (low..=high).contains(&number) {
        return Ok(number);
    }
    let name = Material::NAMES[which];
    let message = format!("`{name}` is {number:?}, outside {low:?} to {high:?}");
    Err(value.error("out-of-range", message).help(HELP))
}
