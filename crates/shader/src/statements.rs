//! Finds the statement that an expression without a place of its own stands in.
//!
//! naga gives the bare use of a local variable no span; an error about one (`if x`, with `x` a number) would be
//! told at the function as a whole. The smallest statement that takes the expression is much nearer.

use naga::valid::{EntryPointError, FunctionError, ValidationError};
use naga::{Block, Expression, Handle, Module, Span, Statement};

/// The span of the statement that takes the expression that `error` is about.
pub(crate) fn blamed_statement(module: &Module, error: &ValidationError) -> Option<Span> {
    let (function, source) = match error {
        ValidationError::Function { handle, source, .. } => {
            (module.functions.try_get(*handle).ok()?, source)
        }
        ValidationError::EntryPoint {
            name,
            stage,
            source: EntryPointError::Function(source),
        } => {
            let mut points = module.entry_points.iter();
            let point = points.find(|point| point.name == *name && point.stage == *stage)?;
            (&point.function, source)
        }
        _ => return None,
    };
    // The expression may have been made long before, as `let`; what counts is who takes it in the end.
    let is_emitted = matches!(source, FunctionError::Expression { .. });
    let expression = match source {
        FunctionError::Expression { handle, .. }
        | FunctionError::InvalidIfType(handle)
        | FunctionError::InvalidSwitchType(handle)
        | FunctionError::InvalidStorePointer(handle)
        | FunctionError::InvalidStoreValue { actual: handle, .. }
        | FunctionError::InvalidStoreTexture { actual: handle, .. }
        | FunctionError::InvalidStoreTypes { value: handle, .. }
        | FunctionError::InvalidReturnType {
            expression: Some(handle),
            ..
        } => *handle,
        _ => return None,
    };
    find(&function.body, expression, is_emitted)
}

fn find(block: &Block, expression: Handle<Expression>, is_emitted: bool) -> Option<Span> {
    block.span_iter().find_map(|(statement, span)| {
        let inner: Vec<&Block> = match statement {
            Statement::Block(block) => vec![block],
            Statement::If { accept, reject, .. } => vec![accept, reject],
            Statement::Switch { cases, .. } => cases.iter().map(|case| &case.body).collect(),
            Statement::Loop {
                body, continuing, ..
            } => vec![body, continuing],
            _ => Vec::new(),
        };
        let is_it = || match statement {
            Statement::Emit(range) => {
                is_emitted && range.clone().any(|emitted| emitted == expression)
            }
            _ => takes(statement, expression),
        };
        let own = || (is_it() && span.is_defined()).then_some(*span);
        inner
            .into_iter()
            .find_map(|block| find(block, expression, is_emitted))
            .or_else(own)
    })
}

fn takes(statement: &Statement, expression: Handle<Expression>) -> bool {
    let taken = match statement {
        Statement::Call { arguments, .. } => return arguments.contains(&expression),
        Statement::Store { pointer, value } => [Some(*pointer), Some(*value)],
        Statement::ImageStore {
            coordinate, value, ..
        } => [Some(*coordinate), Some(*value)],
        Statement::If { condition, .. } => [Some(*condition), None],
        Statement::Switch { selector, .. } => [Some(*selector), None],
        Statement::Loop { break_if, .. } => [*break_if, None],
        Statement::Return { value } => [*value, None],
        _ => [None, None],
    };
    taken.contains(&Some(expression))
}
