//! Which functions the entry points reach, and what is in them.

use std::ops::BitOrAssign;

use naga::{Block, Expression, Function, Handle, Statement};

use super::can_report;

/// What a function does, itself or through those it calls.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Facts {
    /// It has loops without barriers.
    pub loops: bool,
    /// It has loops that carry barriers.
    pub barrier_loops: bool,
    pub loads: bool,
    /// All invocations of a workgroup must come through it together.
    pub barriers: bool,
}

impl Facts {
    /// Whether there is anything that reports.
    pub fn has_work(self) -> bool {
        self.has_loops() || self.loads
    }

    pub fn has_loops(self) -> bool {
        self.loops || self.barrier_loops
    }
}

impl BitOrAssign for Facts {
    fn bitor_assign(&mut self, other: Self) {
        self.loops |= other.loops;
        self.barrier_loops |= other.barrier_loops;
        self.loads |= other.loads;
        self.barriers |= other.barriers;
    }
}

/// How a function is reached.
#[derive(Clone, Copy, Debug)]
pub(super) struct Visit {
    /// From an entry point that can report.
    pub is_reported: bool,
}

/// The functions that the entry points reach.
#[derive(Debug)]
pub(super) struct Reach {
    /// Of all functions, by handle.
    facts: Vec<Facts>,
    visits: Vec<Option<Visit>>,
    /// Of the entry points that can report.
    pub reported: Facts,
    has_vertex_loops: bool,
}

impl Reach {
    pub fn new(module: &naga::Module, entries: &[&str]) -> Self {
        let mut reach = Self {
            facts: Vec::with_capacity(module.functions.len()),
            visits: vec![None; module.functions.len()],
            reported: Facts::default(),
            has_vertex_loops: false,
        };
        // Callees come before their callers.
        for (_, function) in module.functions.iter() {
            let facts = reach.facts_of(function);
            reach.facts.push(facts);
        }
        let mut pending = Vec::new();
        let run = |name: &String| entries.contains(&name.as_str());
        for entry in module.entry_points.iter().filter(|it| run(&it.name)) {
            let facts = reach.facts_of(&entry.function);
            let is_reported = can_report(entry.stage);
            if is_reported {
                reach.reported |= facts;
            } else {
                reach.has_vertex_loops |= facts.has_loops();
            }
            pending.extend(calls(&entry.function).map(|callee| (callee, is_reported)));
        }
        while let Some((handle, is_reported)) = pending.pop() {
            let visit = &mut reach.visits[handle.index()];
            if visit.is_some_and(|before| before.is_reported || !is_reported) {
                continue;
            }
            *visit = Some(Visit { is_reported });
            let callees = calls(&module.functions[handle]);
            pending.extend(callees.map(|callee| (callee, is_reported)));
        }
        reach
    }

    /// Whether there is anything to guard.
    pub fn has_work(&self) -> bool {
        self.reported.has_work() || self.has_vertex_loops
    }

    /// How a function is reached; `None` where it is not.
    pub fn visit(&self, function: Handle<Function>) -> Option<Visit> {
        self.visits.get(function.index()).copied().flatten()
    }

    /// What a function does whose callees are known.
    pub fn facts_of(&self, function: &Function) -> Facts {
        let is_load = |expression: &Expression| matches!(expression, Expression::ImageLoad { .. });
        let mut facts = Facts {
            loads: function.expressions.iter().any(|(_, it)| is_load(it)),
            barriers: self.has_barrier(&function.body),
            ..Facts::default()
        };
        each(&function.body, &mut |statement| match statement {
            Statement::Loop {
                body, continuing, ..
            } => {
                let is_shared = self.has_barrier(body) || self.has_barrier(continuing);
                facts.barrier_loops |= is_shared;
                facts.loops |= !is_shared;
            }
            Statement::Call { function, .. } => facts |= self.facts[function.index()],
            _ => {}
        });
        facts
    }

    /// Whether invocations wait for each other in this block.
    pub fn has_barrier(&self, block: &Block) -> bool {
        let mut has = false;
        each(block, &mut |statement| {
            has |= match statement {
                Statement::ControlBarrier(_)
                | Statement::MemoryBarrier(_)
                | Statement::WorkGroupUniformLoad { .. } => true,
                Statement::Call { function, .. } => self.facts[function.index()].barriers,
                _ => false,
            };
        });
        has
    }
}

fn calls(function: &Function) -> impl Iterator<Item = Handle<Function>> + use<> {
    let mut callees = Vec::new();
    each(&function.body, &mut |statement| {
        if let Statement::Call { function, .. } = statement {
            callees.push(*function);
        }
    });
    callees.into_iter()
}

/// Visits all statements of a block, nested ones too.
fn each(block: &Block, visit: &mut impl FnMut(&Statement)) {
    for statement in block {
        visit(statement);
        match statement {
            Statement::Block(inner) => each(inner, visit),
            Statement::If { accept, reject, .. } => {
                each(accept, visit);
                each(reject, visit);
            }
            Statement::Switch { cases, .. } => {
                for case in cases {
                    each(&case.body, visit);
                }
            }
            Statement::Loop {
                body, continuing, ..
            } => {
                each(body, visit);
                each(continuing, visit);
            }
            _ => {}
        }
    }
}
