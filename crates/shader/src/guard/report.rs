//! What an entry point reads at its start and writes at its end.
//!
//! ```wgsl
//! if atomicLoad(&guard_counters[0]) != 0 { guard_steps = 0; guard_loop_steps = most; }
//! // …, and before each `return` and `discard`:
//! if guard_ended_loop != 0 { atomicAdd(&guard_counters[guard_ended_loop], 1); atomicStore(&guard_counters[0], 1); }
//! if guard_stray_load != 0 { atomicAdd(&guard_counters[guard_stray_load], 1); }
//! ```
//!
//! So one invocation that used up its budget stops all later ones: a frame never takes long. These report nothing:
//! no loop of theirs takes more than twice `most`, and loads behind an ended loop are not looked at.

use naga::{AtomicFunction, Barrier, BinaryOperator, Expression, Handle, Statement};

use super::MOST_STEPS;
use super::code::{Code, Var};
use super::facts::Facts;

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
            self.count(Var::EndedLoop, |code| {
                let flag = code.counter(0);
                let one = code.number(1);
                code.store(flag, one);
            });
        }
        if facts.loads {
            self.count(Var::StrayLoad, |_| {});
        }
    }

    /// Adds 1 to the counter that `var` names, if it names one.
    fn count(&mut self, var: Var, also: impl FnOnce(&mut Self)) {
        let site = self.value(var);
        let is_set = self.with_number(BinaryOperator::NotEqual, site, 0);
        self.when(is_set, |code| {
            let one = code.number(1);
            let base = code.pointer(Var::Counters);
            let pointer = code.add(Expression::Access { base, index: site });
            code.push(Statement::Atomic {
                pointer,
                fun: AtomicFunction::Add,
                value: one,
                result: None,
            });
            also(code);
        });
    }

    fn counter(&mut self, index: u32) -> Handle<Expression> {
        let base = self.pointer(Var::Counters);
        self.add(Expression::AccessIndex { base, index })
    }
}
