//! Uniforms that every invocation reads once, at its start.
//!
//! Software drivers check and broadcast a uniform's value at each place that reads it, in loops at each turn: a product
//! with a matrix of a uniform takes three quarters of the time of a trilinear sample. [`hoist_uniforms`] has each entry point copy the uniforms
//! that it uses into private variables, and all functions read those; drivers keep them where they are at hand. GPUs read
//! uniforms for nothing, and are better left alone.
//!
//! What is large, or an array that is indexed, stays where it is. Bindings stay as they are.

use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{
    AddressSpace, Block, Expression, Function, GlobalVariable, Handle, Range, Span, Statement,
    Type, TypeInner, UniqueArena,
};

use crate::Module;
use crate::check::with_room;

/// Bytes of the largest uniform that is copied.
const MOST_BYTES: u32 = 1024;

/// The module with its uniforms read at the start of each entry point.
///
/// # Errors
/// Why naga refuses the result; the module as it is does the same then, more slowly.
pub fn hoist_uniforms(module: &Module, capabilities: Capabilities) -> Result<Module, String> {
    with_room(|| hoist_here(module, capabilities))
        .unwrap_or_else(|_| Err("reading uniforms once failed on this shader".to_owned()))
}

fn hoist_here(module: &Module, capabilities: Capabilities) -> Result<Module, String> {
    let mut naga = module.naga.clone();
    let uniforms: Vec<_> = naga
        .global_variables
        .iter()
        .filter(|(_, it)| it.space == AddressSpace::Uniform && is_small(&naga.types, it.ty))
        .map(|(handle, it)| (handle, it.clone()))
        .collect();
    let copies: Vec<_> = uniforms
        .into_iter()
        .map(|(uniform, variable)| {
            let copy = GlobalVariable {
                name: variable.name.map(|name| format!("{name}_copy")),
                space: AddressSpace::Private,
                binding: None,
                init: None,
                ..variable
            };
            let span = naga.global_variables.get_span(uniform);
            (uniform, naga.global_variables.append(copy, span))
        })
        .collect();
    for (_, function) in naga.functions.iter_mut() {
        redirect(function, &copies);
    }
    for (at, point) in naga.entry_points.iter_mut().enumerate() {
        let info = module.info.get_entry_point(at);
        redirect(&mut point.function, &copies);
        let used = copies
            .iter()
            .filter(|(uniform, _)| !info[*uniform].is_empty());
        for (uniform, copy) in used {
            copy_at_start(&mut point.function, *uniform, *copy);
        }
    }
    let info = Validator::new(ValidationFlags::all(), capabilities)
        .validate(&naga)
        .map_err(|error| format!("naga refuses the module: {}", error.as_inner()))?;
    Ok(Module {
        naga,
        info,
        ..module.clone()
    })
}

/// Whether a value of the type is copied: no array, and nothing large.
fn is_small(types: &UniqueArena<Type>, ty: Handle<Type>) -> bool {
    match &types[ty].inner {
        TypeInner::Scalar(_) | TypeInner::Vector { .. } | TypeInner::Matrix { .. } => true,
        TypeInner::Struct { members, span } => {
            *span <= MOST_BYTES && members.iter().all(|member| is_small(types, member.ty))
        }
        _ => false,
    }
}

/// A uniform, and its copy.
type Copied = (Handle<GlobalVariable>, Handle<GlobalVariable>);

fn redirect(function: &mut Function, copies: &[Copied]) {
    for (_, expression) in function.expressions.iter_mut() {
        if let Expression::GlobalVariable(variable) = expression
            && let Some((_, copy)) = copies.iter().find(|(uniform, _)| uniform == variable)
        {
            *variable = *copy;
        }
    }
}

fn copy_at_start(
    function: &mut Function,
    uniform: Handle<GlobalVariable>,
    copy: Handle<GlobalVariable>,
) {
    let expressions = &mut function.expressions;
    let span = Span::UNDEFINED;
    let pointer = expressions.append(Expression::GlobalVariable(copy), span);
    let uniform = expressions.append(Expression::GlobalVariable(uniform), span);
    let value = expressions.append(Expression::Load { pointer: uniform }, span);
    let mut body = Block::with_capacity(function.body.len() + 2);
    body.push(Statement::Emit(Range::new_from_bounds(value, value)), span);
    body.push(Statement::Store { pointer, value }, span);
    body.extend_block(std::mem::take(&mut function.body));
    function.body = body;
}
