//! The walk over a function's statements, and the loops in it.
//!
//! A loop remembers in a local variable how many steps were left when it began. A `break` of the author's that
//! leaves it sets that to 0. What still stands there behind the loop tells that the author did not end it: the
//! budget did, or a driver that ends loops in silence, as software drivers do.
//!
//! ```wgsl
//! entered = guard_steps + 1;
//! loop {
//!     if guard_steps == 0 { break; }
//!     guard_steps = guard_steps - 1;
//!     // the author's, with `entered = 0` before each `break`
//! }
//! if entered != 0 {
//!     let took = entered - guard_steps;
//!     if took > 2 * guard_loop_steps { guard_loop_steps = took; guard_ended_loop = this; }
//! }
//! ```
//!
//! The last test blames the right one of nested loops: all of them end when the budget is used up, and an outer
//! one is to blame only where it took more than twice the steps of the inner one's last run. Loops that come
//! later take 0 steps, and are not to blame.

use naga::{BinaryOperator, Block, Expression, Handle, LocalVariable, Span, Statement, SwitchCase};

use super::Hazard;
use super::code::{Code, Var};
use super::facts::Facts;

/// What the walk knows of the place it is at.
#[derive(Clone, Copy)]
pub(super) struct Within {
    /// Whether what goes wrong is remembered.
    pub is_reported: bool,
    /// Whether a `return` ends the entry point.
    pub entry: Option<Facts>,
    /// The local variable of the loop that a `break` leaves; none where it leaves a `switch`.
    pub entered: Option<Handle<LocalVariable>>,
}

impl Code<'_, '_> {
    /// Rewrites the function; of an entry point that reports, `entry` is what it reaches.
    pub fn rewrite(&mut self, is_reported: bool, entry: Option<Facts>) {
        let within = Within {
            is_reported,
            entry,
            entered: None,
        };
        if let Some(facts) = entry {
            self.prologue(facts);
        }
        let body = std::mem::take(&mut self.function.body);
        let is_open = !matches!(
            body.last(),
            Some(Statement::Return { .. } | Statement::Kill)
        );
        self.walk(body, within);
        if let (Some(facts), true) = (entry, is_open) {
            self.epilogue(facts);
        }
        self.function.body = self.finish();
    }

    fn walk(&mut self, block: Block, within: Within) {
        for (statement, span) in block.span_into_iter() {
            self.statement(statement, span, within);
        }
    }

    fn nested(&mut self, block: Block, within: Within) -> Block {
        self.write(|code| code.walk(block, within))
    }

    fn statement(&mut self, statement: Statement, span: Span, within: Within) {
        let statement = match statement {
            Statement::Emit(range) if within.is_reported => return self.emit_guarded(range, span),
            Statement::Block(block) => Statement::Block(self.nested(block, within)),
            Statement::If {
                condition,
                accept,
                reject,
            } => Statement::If {
                condition,
                accept: self.nested(accept, within),
                reject: self.nested(reject, within),
            },
            Statement::Switch { selector, cases } => {
                let in_case = Within {
                    entered: None,
                    ..within
                };
                let cases = cases.into_iter().map(|case| SwitchCase {
                    body: self.nested(case.body, in_case),
                    ..case
                });
                Statement::Switch {
                    selector,
                    cases: cases.collect(),
                }
            }
            Statement::Loop {
                body,
                continuing,
                break_if,
            } => return self.guard_loop(body, continuing, break_if, span, within),
            Statement::Break => {
                if let Some(entered) = within.entered {
                    let zero = self.number(0);
                    let pointer = self.add(Expression::LocalVariable(entered));
                    self.store(pointer, zero);
                }
                Statement::Break
            }
            Statement::Return { value } => {
                if let Some(facts) = within.entry {
                    self.epilogue(facts);
                }
                Statement::Return { value }
            }
            // A `discard` ends the entry point from within any function; only fragment entry points reach one.
            Statement::Kill => {
                let facts = within.entry.unwrap_or(self.reach.reported);
                if within.is_reported && facts.has_work() {
                    self.epilogue(facts);
                }
                Statement::Kill
            }
            other => other,
        };
        self.keep(statement, span);
    }

    fn guard_loop(
        &mut self,
        body: Block,
        continuing: Block,
        break_if: Option<Handle<Expression>>,
        span: Span,
        within: Within,
    ) {
        // Invocations that wait for each other in a loop must leave it together, so they count its turns alike.
        let waits = self.reach.has_barrier(&body) || self.reach.has_barrier(&continuing);
        let budget = if waits { Var::UniformSteps } else { Var::Steps };
        let site = within.is_reported.then(|| {
            let site = self.shared.site(Hazard::Loop, span);
            (site, self.enter(budget))
        });
        let in_loop = Within {
            entered: site.map(|(_, entered)| entered),
            ..within
        };
        let body = self.write(|code| {
            let steps = code.value(budget);
            let is_used_up = code.with_number(BinaryOperator::Equal, steps, 0);
            code.when(is_used_up, |code| code.push(Statement::Break));
            let left = code.with_number(BinaryOperator::Subtract, steps, 1);
            let pointer = code.pointer(budget);
            code.store(pointer, left);
            code.walk(body, in_loop);
        });
        let continuing = self.write(|code| {
            code.walk(continuing, in_loop);
            if let (Some(condition), Some(entered)) = (break_if, in_loop.entered) {
                let zero = code.number(0);
                let pointer = code.add(Expression::LocalVariable(entered));
                let reject = code.load(pointer);
                let value = code.add(Expression::Select {
                    condition,
                    accept: zero,
                    reject,
                });
                code.store(pointer, value);
            }
        });
        let guarded = Statement::Loop {
            body,
            continuing,
            break_if,
        };
        self.keep(guarded, span);
        if let Some((site, entered)) = site {
            self.leave(budget, site, entered);
        }
    }

    /// `entered = steps + 1`.
    fn enter(&mut self, budget: Var) -> Handle<LocalVariable> {
        let variable = LocalVariable {
            name: Some("guard_entered".to_owned()),
            ty: self.shared.u32_type,
            init: None,
        };
        let entered = self
            .function
            .local_variables
            .append(variable, Span::default());
        let steps = self.value(budget);
        let value = self.with_number(BinaryOperator::Add, steps, 1);
        let pointer = self.add(Expression::LocalVariable(entered));
        self.store(pointer, value);
        entered
    }

    /// Blames a loop that the author did not leave.
    fn leave(&mut self, budget: Var, site: u32, entered: Handle<LocalVariable>) {
        let pointer = self.add(Expression::LocalVariable(entered));
        let entered = self.load(pointer);
        let was_ended = self.with_number(BinaryOperator::NotEqual, entered, 0);
        self.when(was_ended, |code| {
            let steps = code.value(budget);
            let took = code.binary(BinaryOperator::Subtract, entered, steps);
            let blamed = code.value(Var::LoopSteps);
            let twice = code.with_number(BinaryOperator::Multiply, blamed, 2);
            let is_to_blame = code.binary(BinaryOperator::Greater, took, twice);
            code.when(is_to_blame, |code| {
                let blamed = code.pointer(Var::LoopSteps);
                code.store(blamed, took);
                code.set(Var::EndedLoop, site);
            });
        });
    }
}
