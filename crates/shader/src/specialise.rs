//! Parameters with `@choices` or `@constant` as constants of a module: what they rule out is not compiled.
//!
//! A choice is a member of `struct Params` like any other, and a shader reads it like any other:
//! `if params.refinement == 3u { … }`. Its value stays in the uniform. But where a pipeline is built the value is known, so
//! [`specialise`] writes it in place of each load, works out what follows from it, and leaves of each `if` that it decides
//! the side that is taken. Software drivers run both sides of an `if` on a uniform, the loops in them for at least a turn;
//! GPUs keep registers for both. Plain numbers stay uniforms: they change while somebody moves a slider.
//!
//! The way of the data: loads of choices become literals; what is computed of literals alone becomes one, calls of
//! functions that return one included (they stand before their callers); `if`s on literals are resolved; what stands
//! behind a statement that leaves the block goes. naga validates the result. Spans stay, so that findings keep their
//! places; bindings stay, so that layouts do not depend on choices.

use std::collections::{BTreeMap, HashMap, HashSet};

use naga::compact::{KeepUnused, compact};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{
    Arena, BinaryOperator, Block, Expression, Function, GlobalVariable, Handle, Literal, Range,
    Scalar, ScalarKind, Statement, TypeInner, UnaryOperator,
};

use crate::Module;
use crate::check::with_room;

/// Parameter → the index of its choice, or its value. What is not in here stays what it is in the uniform.
pub type Choices = BTreeMap<String, i64>;

/// The module with these choices as constants. The uniform must hold the same values: other loads of it, as of the whole
/// struct, still read them.
///
/// # Errors
/// Why naga refuses the result; the module as it is does the same then, more slowly.
pub fn specialise(
    module: &Module,
    choices: &Choices,
    capabilities: Capabilities,
) -> Result<Module, String> {
    with_room(|| specialise_here(module, choices, capabilities))
        .unwrap_or_else(|_| Err("specialising failed on this shader".to_owned()))
}

fn specialise_here(
    module: &Module,
    choices: &Choices,
    capabilities: Capabilities,
) -> Result<Module, String> {
    let Some(known) = Known::new(module, choices) else {
        return Ok(module.clone());
    };
    let mut naga = module.naga.clone();
    let mut returned = HashMap::new();
    let handles: Vec<_> = naga.functions.iter().map(|(handle, _)| handle).collect();
    for handle in handles {
        let mut function = std::mem::take(&mut naga.functions[handle]);
        known.rewrite(&naga, &returned, &mut function);
        if let Some(literal) = only_returned(&function) {
            returned.insert(handle, literal);
        }
        naga.functions[handle] = function;
    }
    for at in 0..naga.entry_points.len() {
        let mut function = std::mem::take(&mut naga.entry_points[at].function);
        known.rewrite(&naga, &returned, &mut function);
        naga.entry_points[at].function = function;
    }
    // Results of calls that are not made any more must not stand there.
    compact(&mut naga, KeepUnused::Yes);
    let info = Validator::new(ValidationFlags::all(), capabilities)
        .validate(&naga)
        .map_err(|error| {
            let inner: &dyn std::error::Error = error.as_inner();
            let causes = std::iter::successors(Some(inner), |error| error.source());
            let causes: Vec<String> = causes.map(ToString::to_string).collect();
            format!("naga refuses the specialised module: {}", causes.join(": "))
        })?;
    Ok(Module {
        naga,
        info,
        ..module.clone()
    })
}

/// The functions that return one literal whatever they are given.
type Returned = HashMap<Handle<Function>, Literal>;

/// What is known of the members of `params`.
struct Known {
    params: Handle<GlobalVariable>,
    /// By the member's index.
    members: BTreeMap<u32, Literal>,
}

impl Known {
    /// `None` where nothing is known.
    fn new(module: &Module, choices: &Choices) -> Option<Self> {
        let globals = &module.naga.global_variables;
        let (params, variable) = globals
            .iter()
            .find(|(_, variable)| variable.name.as_deref() == Some("params"))?;
        let TypeInner::Struct { members, .. } = &module.naga.types[variable.ty].inner else {
            return None;
        };
        let mut known = BTreeMap::new();
        for (index, member) in (0..).zip(members) {
            let spec = module
                .params()
                .iter()
                .find(|spec| Some(&spec.name) == member.name.as_ref());
            let is_choice = spec.is_some_and(|spec| spec.is_constant);
            let choice = member.name.as_ref().and_then(|name| choices.get(name));
            let (true, Some(&choice)) = (is_choice, choice) else {
                continue;
            };
            let literal = match module.naga.types[member.ty].inner {
                TypeInner::Scalar(Scalar::U32) => Literal::U32(u32::try_from(choice).ok()?),
                TypeInner::Scalar(Scalar {
                    kind: ScalarKind::Sint,
                    width: 4,
                }) => Literal::I32(i32::try_from(choice).ok()?),
                _ => continue,
            };
            known.insert(index, literal);
        }
        let members = known;
        (!members.is_empty()).then_some(Self { params, members })
    }

    fn rewrite(&self, module: &naga::Module, returned: &Returned, function: &mut Function) {
        // An expression only refers to those before it.
        let handles: Vec<_> = function.expressions.iter().map(|(it, _)| it).collect();
        for handle in handles {
            let literal = self.literal(module, returned, &function.expressions, handle);
            if let Some(literal) = literal {
                function.expressions[handle] = Expression::Literal(literal);
            }
        }
        let body = std::mem::take(&mut function.body);
        function.body = resolved(body, &function.expressions, returned);
        let mut live = HashSet::new();
        computed(&function.body, &mut live);
        // A name keeps what it names, and what that is made of.
        let expressions = &function.expressions;
        let is_there = |handle| live.contains(&handle) || expressions[handle].needs_pre_emit();
        function
            .named_expressions
            .retain(|handle, _| is_there(*handle));
    }

    /// The literal that an expression is worth.
    fn literal(
        &self,
        module: &naga::Module,
        returned: &Returned,
        expressions: &Arena<Expression>,
        handle: Handle<Expression>,
    ) -> Option<Literal> {
        let known = |handle| literal_at(module, expressions, handle);
        match expressions[handle] {
            Expression::Load { pointer } => match expressions[pointer] {
                Expression::AccessIndex { base, index } => match expressions[base] {
                    Expression::GlobalVariable(variable) if variable == self.params => {
                        self.members.get(&index).copied()
                    }
                    _ => None,
                },
                _ => None,
            },
            Expression::CallResult(function) => returned.get(&function).copied(),
            Expression::Unary {
                op: UnaryOperator::LogicalNot,
                expr,
            } => match known(expr)? {
                Literal::Bool(value) => Some(Literal::Bool(!value)),
                _ => None,
            },
            Expression::Binary { op, left, right } => binary(op, known(left), known(right)),
            Expression::Select {
                condition,
                accept,
                reject,
            } => match known(condition)? {
                Literal::Bool(true) => known(accept),
                Literal::Bool(false) => known(reject),
                _ => None,
            },
            _ => None,
        }
    }
}

/// The literal that stands here, itself or as a module's constant.
fn literal_at(
    module: &naga::Module,
    expressions: &Arena<Expression>,
    handle: Handle<Expression>,
) -> Option<Literal> {
    match expressions[handle] {
        Expression::Literal(literal) => Some(literal),
        Expression::Constant(constant) => {
            match module.global_expressions[module.constants[constant].init] {
                Expression::Literal(literal) => Some(literal),
                _ => None,
            }
        }
        _ => None,
    }
}

/// Whole numbers compared, and truths combined; one side may be enough for these.
fn binary(op: BinaryOperator, left: Option<Literal>, right: Option<Literal>) -> Option<Literal> {
    use BinaryOperator as B;
    let truth = |literal| match literal {
        Some(Literal::Bool(value)) => Some(value),
        _ => None,
    };
    let order = match (left, right) {
        (Some(Literal::U32(a)), Some(Literal::U32(b))) => Some(a.cmp(&b)),
        (Some(Literal::I32(a)), Some(Literal::I32(b))) => Some(a.cmp(&b)),
        (Some(Literal::Bool(a)), Some(Literal::Bool(b))) => Some(a.cmp(&b)),
        _ => None,
    };
    let value = match op {
        B::Equal => order?.is_eq(),
        B::NotEqual => order?.is_ne(),
        B::Less => order?.is_lt(),
        B::LessEqual => order?.is_le(),
        B::Greater => order?.is_gt(),
        B::GreaterEqual => order?.is_ge(),
        B::LogicalAnd | B::And => match (truth(left), truth(right)) {
            (Some(false), _) | (_, Some(false)) => false,
            (Some(true), Some(true)) => true,
            _ => return None,
        },
        B::LogicalOr | B::InclusiveOr => match (truth(left), truth(right)) {
            (Some(true), _) | (_, Some(true)) => true,
            (Some(false), Some(false)) => false,
            _ => return None,
        },
        _ => return None,
    };
    Some(Literal::Bool(value))
}

/// The block without what literals rule out.
fn resolved(block: Block, expressions: &Arena<Expression>, returned: &Returned) -> Block {
    let mut out = Block::with_capacity(block.len());
    for (statement, span) in block.span_into_iter() {
        match statement {
            // Literals are there from the start and are not emitted.
            Statement::Emit(range) => {
                for range in emitted(range, expressions) {
                    out.push(Statement::Emit(range), span);
                }
            }
            Statement::Call { ref function, .. } if returned.contains_key(function) => {}
            Statement::If {
                condition,
                accept,
                reject,
            } => {
                let side = match expressions[condition] {
                    Expression::Literal(Literal::Bool(true)) => Ok(accept),
                    Expression::Literal(Literal::Bool(false)) => Ok(reject),
                    _ => Err((accept, reject)),
                };
                match side {
                    Ok(side) => out.extend_block(resolved(side, expressions, returned)),
                    Err((accept, reject)) => {
                        let accept = resolved(accept, expressions, returned);
                        let reject = resolved(reject, expressions, returned);
                        let statement = Statement::If {
                            condition,
                            accept,
                            reject,
                        };
                        out.push(statement, span);
                    }
                }
            }
            Statement::Block(block) => {
                let block = resolved(block, expressions, returned);
                out.push(Statement::Block(block), span);
            }
            Statement::Loop {
                body,
                continuing,
                break_if,
            } => {
                let statement = Statement::Loop {
                    body: resolved(body, expressions, returned),
                    continuing: resolved(continuing, expressions, returned),
                    break_if,
                };
                out.push(statement, span);
            }
            Statement::Switch {
                selector,
                mut cases,
            } => {
                for case in &mut cases {
                    let body = std::mem::take(&mut case.body);
                    case.body = resolved(body, expressions, returned);
                }
                out.push(Statement::Switch { selector, cases }, span);
            }
            other => out.push(other, span),
        }
        if out.last().is_some_and(leaves) {
            break;
        }
    }
    out
}

/// Adds what the statements of a block compute.
fn computed(block: &Block, found: &mut HashSet<Handle<Expression>>) {
    for statement in block {
        match statement {
            Statement::Emit(range) => found.extend(range.clone()),
            Statement::Call { result, .. } | Statement::Atomic { result, .. } => {
                found.extend(*result);
            }
            Statement::WorkGroupUniformLoad { result, .. } => {
                found.insert(*result);
            }
            Statement::Block(block) => computed(block, found),
            Statement::If { accept, reject, .. } => {
                computed(accept, found);
                computed(reject, found);
            }
            Statement::Loop {
                body, continuing, ..
            } => {
                computed(body, found);
                computed(continuing, found);
            }
            Statement::Switch { cases, .. } => {
                for case in cases {
                    computed(&case.body, found);
                }
            }
            _ => {}
        }
    }
}

/// Whether nothing behind this statement runs.
fn leaves(statement: &Statement) -> bool {
    matches!(
        statement,
        Statement::Break | Statement::Continue | Statement::Return { .. } | Statement::Kill
    )
}

/// The stretches of a range that are not literals.
fn emitted(range: Range<Expression>, expressions: &Arena<Expression>) -> Vec<Range<Expression>> {
    let mut stretches: Vec<(Handle<Expression>, Handle<Expression>)> = Vec::new();
    let mut is_open = false;
    for handle in range {
        if expressions[handle].needs_pre_emit() {
            is_open = false;
        } else if let (true, Some(last)) = (is_open, stretches.last_mut()) {
            last.1 = handle;
        } else {
            stretches.push((handle, handle));
            is_open = true;
        }
    }
    let ranges = stretches.into_iter();
    ranges
        .map(|(first, last)| Range::new_from_bounds(first, last))
        .collect()
}

/// The literal that a function returns, where it does nothing else.
fn only_returned(function: &Function) -> Option<Literal> {
    let (last, before) = function.body.split_last()?;
    let Statement::Return { value: Some(value) } = last else {
        return None;
    };
    let computes = |it: &Statement| matches!(it, Statement::Emit(_));
    match function.expressions[*value] {
        Expression::Literal(literal) if before.iter().all(computes) => Some(literal),
        _ => None,
    }
}
