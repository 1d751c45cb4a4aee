//! The fields that expectations have, each with the values that it may take: a bound that nothing could fail is refused.

use volgraph_report::ron_text::{Fields, Value};
use volgraph_report::{Finding, Findings};

use crate::case::kinds::{Area, Axis, Param, Values};
use crate::case::read::missing;

/// Most halvings: steps beyond them are lost in f32.
const MAX_HALVINGS: u32 = 8;

/// What pixels must have.
pub fn values(fields: &mut Fields<'_>, findings: &mut Findings) -> Values {
    Values {
        color: fields.read(findings, "color", Value::f64s::<4>),
        opacity: fields.read(findings, "opacity", Value::f64),
        depth: fields.read(findings, "depth", Value::f64),
    }
}

/// A pixel, `(x, y)`.
pub fn corner(value: &Value<'_>) -> Result<[u32; 2], Finding> {
    let numbers: Vec<u32> = value
        .items()?
        .iter()
        .map(Value::u32)
        .collect::<Result<_, _>>()?;
    <[u32; 2]>::try_from(numbers).map_err(|_| {
        value
            .error(
                "bad-value",
                "a pixel is a column and a row, from the top left",
            )
            .help("write it as `(x, y)`, or `centre`")
    })
}

/// Two corners, `((x, y), (x, y))`.
pub fn area(value: &Value<'_>) -> Result<Area, Finding> {
    let corners: Vec<[u32; 2]> = value
        .items()?
        .iter()
        .map(corner)
        .collect::<Result<_, _>>()?;
    match corners.as_slice() {
        &[first, last] if first[0] <= last[0] && first[1] <= last[1] => Ok(Area { first, last }),
        _ => Err(value
            .error(
                "bad-value",
                "an area is its top left and its bottom right pixel",
            )
            .help("write it as `((8, 8), (55, 55))`")),
    }
}

/// An axis of the world.
pub fn axis(value: &Value<'_>) -> Result<Axis, Finding> {
    match value.string()?.as_str() {
        "x" => Ok(Axis::X),
        "y" => Ok(Axis::Y),
        "z" => Ok(Axis::Z),
        _ => Err(value
            .error("bad-value", "a mirror stands across an axis of the world")
            .help("write \"x\", \"y\" or \"z\"")),
    }
}

/// The least share of the pixels that something holds for.
pub fn least_share(value: &Value<'_>) -> Result<f64, Finding> {
    match value.f64()? {
        share if share > 0.0 && share <= 1.0 => Ok(share),
        0.0 => Err(cannot_fail(
            value,
            "a share of at least 0 is that of any picture",
            "give the least share that must be there, such as 0.01",
        )),
        _ => Err(value
            .error("bad-value", "a share of the pixels is 0 to 1")
            .help("write a number such as 0.01")),
    }
}

/// The share of the pixels that something need not hold for.
pub fn excepted_share(value: &Value<'_>) -> Result<f64, Finding> {
    match value.f64()? {
        share if (0.0..1.0).contains(&share) => Ok(share),
        1.0 => Err(cannot_fail(
            value,
            "all pixels are left out",
            "leave out no more than must be, such as 0.01",
        )),
        _ => Err(value
            .error("bad-value", "a share of the pixels is 0 to 1")
            .help("write a number such as 0.01")),
    }
}

/// A bound of an error.
pub fn positive(value: &Value<'_>) -> Result<f64, Finding> {
    match value.f64()? {
        number if number >= 0.0 => Ok(number),
        _ => Err(value.error("bad-value", "a bound is at least 0")),
    }
}

/// A bound of a mean ꟻLIP, which is 0 to 1.
pub fn flip(value: &Value<'_>) -> Result<f64, Finding> {
    match positive(value)? {
        bound if bound < 1.0 => Ok(bound),
        _ => Err(cannot_fail(
            value,
            "no two pictures are farther apart than 1",
            "give a bound such as 0.01",
        )),
    }
}

/// An order of convergence, at least.
pub fn least_order(value: &Value<'_>) -> Result<f64, Finding> {
    match value.f64()? {
        order if order > 0.0 => Ok(order),
        _ => Err(value
            .error(
                "bad-value",
                "an order is above 0: at 0 pictures need not converge",
            )
            .help("give the least order that theory allows, such as 1.5")),
    }
}

/// An error, at least.
pub fn least_error(value: &Value<'_>) -> Result<f64, Finding> {
    match value.f64()? {
        error if error > 0.0 => Ok(error),
        0.0 => Err(cannot_fail(
            value,
            "any picture has an error of at least 0",
            "give the least error that can be seen, such as 0.01",
        )),
        _ => Err(value.error("bad-value", "a bound is at least 0")),
    }
}

fn cannot_fail(value: &Value<'_>, why: &str, help: &str) -> Finding {
    value
        .error("bad-value", format!("this expectation cannot fail: {why}"))
        .help(help)
}

/// Node and parameter, `"image.step"`.
pub fn param(fields: &mut Fields<'_>, findings: &mut Findings, value: &Value<'_>) -> Option<Param> {
    let param = fields.read(findings, "param", |value| {
        let text = value.string()?;
        match text.split_once('.') {
            Some((node, name)) if !node.is_empty() && !name.is_empty() => Ok(Param {
                node: node.to_owned(),
                name: name.to_owned(),
                place: value.place(),
            }),
            _ => Err(value.error(
                "bad-value",
                "name a node and its parameter: `\"image.step\"`",
            )),
        }
    });
    if param.is_none() && !findings.has_errors() {
        findings.push(missing(value, "param", "add `param: \"image.step\"`"));
    }
    param
}

/// What is halved first.
pub fn start(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<f64> {
    fields.read(findings, "from", |value| match value.f64()? {
        from if from > 0.0 => Ok(from),
        _ => Err(value.error("bad-value", "what is halved is above 0")),
    })
}

/// How often something is halved.
pub fn halvings(value: &Value<'_>, least: u32) -> Result<u32, Finding> {
    match value.u32()? {
        halvings if (least..=MAX_HALVINGS).contains(&halvings) => Ok(halvings),
        _ => Err(value
            .error(
                "bad-value",
                format!("halve {least} to {MAX_HALVINGS} times"),
            )
            .help("errors of more halvings are lost in f32")),
    }
}

/// A bound of an error, which must be there.
pub fn bound(
    fields: &mut Fields<'_>,
    findings: &mut Findings,
    name: &'static str,
    value: &Value<'_>,
) -> Option<f64> {
    required(fields, findings, name, value, "1e-4", positive)
}

/// A number that must be there.
pub fn required(
    fields: &mut Fields<'_>,
    findings: &mut Findings,
    name: &'static str,
    value: &Value<'_>,
    example: &str,
    read: impl Fn(&Value<'_>) -> Result<f64, Finding>,
) -> Option<f64> {
    let Some(given) = fields.take(name) else {
        let help = format!("add `{name}: {example}` or another bound");
        findings.push(missing(value, name, &help));
        return None;
    };
    findings.take(read(&given))
}
