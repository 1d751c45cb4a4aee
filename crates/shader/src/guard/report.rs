//! What an entry point reads at its start and writes at its end.
//!
//! ```wgsl
//! if atomicLoad(&guard_counters[0]) != 0 { guard_steps = 0; guard_loop_steps = most; }
//! // …, and before each `return` and `discard`:
//! if guard_ended_loop != 0 {
//!     atomicMax(&guard_counters[guard_ended_loop], guard_loop_steps);
//!     if guard_loop_steps > few { atomicStore(&guard_counters[0], 1); }
//! }
//! if guard_stray_load != 0 { atomicAdd(&guard_counters[guard_stray_load], 1); }
//! ```
//!
//! So one invocation that used up its budget stops all later ones: a frame never takes long. These report nothing:
//! no loop of theirs takes more than twice `most`, and loads behind an ended loop are not looked at.
//!
//! A loop's counter keeps the most steps that an invocation took in it. A driver that runs some invocations together
//! ends the loops of all of them, also of those that only waited after a few steps: those are not to blame, and do
//! not stop others. The one that they waited for may be outside of the picture, and then reports nothing.

use naga::{AtomicFunction, Barrier, BinaryOperator, Expression, Handle, Statement};

use super::MOST_STEPS;
use super::code::{Code, Var};
use super::facts::Facts;

/// An endless loop takes more, whoever ends it.
const FEW_STEPS: u32 = 1024;

impl Code<'_, '_> {
    pub(super) fn prologue(&mut self, facts: Facts) {
        if !facts.has_loops() {
            return;
        }
        let flag = self.counter(0);
        let mut stop = self.load(flag);
        if facts.barrier_loops {
            // Invocations may read different things here, and must go on alike.
            let pointer = self.pointer(Var::Stop);
            self.push(Statement::Atomic {
                pointer,
                fun: AtomicFunction::InclusiveOr,
                value: stop,
                result: None,
            });
            self.push(Statement::ControlBarrier(Barrier::WORK_GROUP));
            stop = self.load(pointer);
        }
        let must_stop = self.with_number(BinaryOperator::NotEqual, stop, 0);
        self.when(must_stop, |code| {
            if facts.loops {
                code.set(Var::Steps, 0);
            }
            if facts.barrier_loops {
                code.set(Var::UniformSteps, 0);
            }
            code.set(Var::LoopSteps, MOST_STEPS + 1);
        });
    }

    pub(super) fn epilogue(&mut self, facts: Facts) {
        if facts.has_loops() {
            self.note(Var::EndedLoop, AtomicFunction::Max, |code| {
                let steps = code.value(Var::LoopSteps);
                let few = FEW_STEPS.min(code.shared.max_steps / 2);
                let is_many = code.with_number(BinaryOperator::Greater, steps, few);
                code.when(is_many, |code| {
                    let flag = code.counter(0);
                    let one = code.number(1);
                    code.store(flag, one);
                });
                steps
            });
        }
        if facts.loads {
            self.note(Var::StrayLoad, AtomicFunction::Add, |code| code.number(1));
        }
    }

    /// Brings a value into the counter that `var` names, if it names one.
    fn note(
        &mut self,
        var: Var,
        fun: AtomicFunction,
        value: impl FnOnce(&mut Self) -> Handle<Expression>,
    ) {
        let site = self.value(var);
        let is_set = self.with_number(BinaryOperator::NotEqual, site, 0);
        self.when(is_set, |code| {
            let value = value(code);
            let base = code.pointer(Var::Counters);
            let pointer = code.add(Expression::Access { base, index: site });
            code.push(Statement::Atomic {
                pointer,
                fun,
                value,
                result: None,
            });
        });
    }

    fn counter(&mut self, index: u32) -> Handle<Expression> {
        let base = self.pointer(Var::Counters);
        self.add(Expression::AccessIndex { base, index })
    }
}
