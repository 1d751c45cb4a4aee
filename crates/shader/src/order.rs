//! The order of convergence in the step (of `reconstruct` in the grid's spacing) that a shader file declares in the comment at its head.
//!
//! ```wgsl
//! // Colour and opacity of a segment: …
//! // @order 2
//! ```
//!
//! A line of its own for each; with a parameter, one for each of its choices that has an order:
//!
//! ```wgsl
//! // @order 1 where refinement=none
//! // @order 2 where refinement=linear
//! ```
//!
//! The order is what theory says where field and transfer function are smooth: the error of a picture falls like the step
//! to that power. 0 stands for an error that does not fall. A file that says nothing has none of its own.

use std::fmt;
use std::path::Path;

use volgraph_report::{Finding, Findings, Place, did_you_mean, list_names};

use crate::head::{TagLine, tag_lines};
use crate::{Linked, LinkedFile, ParamSpec, ParamType};

/// One line `@order N` or `@order N where param=choice`.
#[derive(Clone, Debug, PartialEq)]
pub struct DeclaredOrder {
    /// The power of the step that the error goes like, 0 to 16.
    pub order: f64,
    /// The parameter and its choice that it holds for; `None` where it always does.
    pub condition: Option<(String, String)>,
    /// Where the line stands.
    pub place: Place,
}

impl fmt::Display for DeclaredOrder {
    /// As it is written, without the tag: `2 where refinement=linear`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.order)?;
        match &self.condition {
            Some((param, choice)) => write!(f, " where {param}={choice}"),
            None => Ok(()),
        }
    }
}

/// The largest order that is believed.
const MOST: f64 = 16.0;

/// The orders that the head comment of a file's text declares, in its order.
///
/// # Errors
/// `order-doc` at each line that says none, or one that is said already.
pub fn declared_orders(file: &Path, text: &str) -> Result<Vec<DeclaredOrder>, Findings> {
    let mut findings = Findings::new();
    let mut orders: Vec<DeclaredOrder> = Vec::new();
    for TagLine { words, place } in tag_lines(file, text, "order") {
        let error = |message: String| {
            Finding::error("order-doc", message)
                .at(place.clone())
                .help("write `// @order 2` or `// @order 2 where param=choice`")
        };
        match read(&words) {
            Err(message) => findings.push(error(message)),
            Ok((_, condition)) if orders.iter().any(|it| it.condition == condition) => {
                findings.push(error("the order is declared twice".to_owned()));
            }
            Ok((order, condition)) => orders.push(DeclaredOrder {
                order,
                condition,
                place,
            }),
        }
    }
    findings.into_result(orders)
}

/// The words behind `@order`.
fn read(words: &[&str]) -> Result<(f64, Option<(String, String)>), String> {
    let (order, condition) = match words {
        [order] => (order, None),
        [order, "where", condition] => {
            let parts = condition.split_once('=').filter(|(param, choice)| {
                let is_name = |name: &str| {
                    !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_')
                };
                is_name(param) && is_name(choice)
            });
            let (param, choice) =
                parts.ok_or_else(|| format!("`{condition}` is no `param=choice`"))?;
            (order, Some((param.to_owned(), choice.to_owned())))
        }
        _ => {
            return Err(
                "`@order` takes a number, and may go on with `where param=choice`".to_owned(),
            );
        }
    };
    match order.parse::<f64>() {
        Ok(number) if (0.0..=MOST).contains(&number) => Ok((number, condition)),
        _ => Err(format!("`{order}` is no order: a number of 0 to {MOST}")),
    }
}

/// The order that holds where parameters have these choices: that of the first line whose condition is met, else of the
/// line without one. `None` where no line holds.
pub fn order_where(
    orders: &[DeclaredOrder],
    choice: impl Fn(&str) -> Option<String>,
) -> Option<f64> {
    let is_met = |order: &&DeclaredOrder| {
        let met = |(param, wanted): &(String, String)| choice(param).as_ref() == Some(wanted);
        order.condition.as_ref().is_some_and(met)
    };
    let always = || orders.iter().find(|order| order.condition.is_none());
    let order = orders.iter().find(is_met).or_else(always)?;
    Some(order.order)
}

impl Linked {
    /// The orders that the file which fills a slot declares; none where the slot is not in it.
    ///
    /// # Errors
    /// As [`declared_orders`]; a text that [`crate::check()`] has passed has none.
    pub fn declared_orders(&self, slot: &str) -> Result<Vec<DeclaredOrder>, Findings> {
        let path = self.slots_used.get(slot);
        let text = path.and_then(|path| self.file_text(path));
        match (path, text) {
            (Some(path), Some(text)) => declared_orders(path, text),
            _ => Ok(Vec::new()),
        }
    }
}

/// Whether a file's orders can be read, and hold for parameters and choices that there are.
pub(crate) fn check(file: &LinkedFile, params: &[ParamSpec]) -> Result<(), Findings> {
    let mut findings = Findings::new();
    for order in declared_orders(&file.path, &file.text)? {
        let Some((param, choice)) = &order.condition else {
            continue;
        };
        let choices = || {
            params.iter().filter_map(|spec| match &spec.ty {
                ParamType::Choice(choices) => Some((spec.name.as_str(), choices)),
                _ => None,
            })
        };
        let message_and_help = match choices().find(|(name, _)| name == param) {
            None => (
                format!("`{param}` is no parameter with choices"),
                did_you_mean(param, choices().map(|(name, _)| name)),
            ),
            Some((_, known)) if !known.contains(choice) => (
                format!("`{choice}` is no choice of `{param}`"),
                Some(format!(
                    "choices: {}",
                    list_names(known.iter().map(String::as_str))
                )),
            ),
            Some(_) => continue,
        };
        let (message, help) = message_and_help;
        findings.push(
            Finding::error("order-doc", message)
                .at(order.place)
                .help_opt(help),
        );
    }
    findings.into_result(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn orders(text: &str) -> Result<Vec<DeclaredOrder>, Findings> {
        declared_orders(Path::new("a.wgsl"), text)
    }

    #[test]
    fn an_order_holds_always_or_for_a_choice() {
        let text = "// What it does.\n// @order 1 where refinement=none\n// @order 2.5\n#import \"b\"\n// @order 9\n";
        let found = orders(text).unwrap();
        let shown: Vec<String> = found.iter().map(ToString::to_string).collect();
        assert_eq!(shown, ["1 where refinement=none", "2.5"]);
        assert_eq!(found[1].place.line, 3);
        let at = |choice: &'static str| {
            order_where(&found, |param| {
                (param == "refinement").then(|| choice.to_owned())
            })
        };
        assert_eq!((at("none"), at("cubic")), (Some(1.0), Some(2.5)));
        assert_eq!(order_where(&found[..1], |_| None), None);
        assert_eq!(orders("fn f() {}\n// @order 2\n").unwrap(), []);
    }

    #[test]
    fn what_is_no_order_is_told_at_its_line() {
        for line in [
            "// @order",
            "// @order two",
            "// @order -1",
            "// @order inf",
            "// @order 2 if a=b",
            "// @order 2 where a",
            "// @order 2 where a=",
            "// @order 2 3",
        ] {
            let findings = orders(&format!("// What it does.\n{line}\n")).unwrap_err();
            let finding = findings.sorted()[0];
            assert_eq!(finding.code, "order-doc", "{line}");
            assert_eq!(finding.place.as_ref().unwrap().line, 2, "{line}");
        }
        assert!(orders("// @order 2\n// @order 3\n").is_err());
    }
}
