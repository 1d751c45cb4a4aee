//! Writing statements into a function of naga's, and the variables that the guard adds to a module.

use std::collections::{HashMap, HashSet};
use std::num::NonZeroU32;

use naga::{
    AddressSpace, ArraySize, BinaryOperator, Block, Expression, Function, GlobalVariable, Handle,
    Literal, MemoryDecorations, Range, ResourceBinding, Scalar, Span, Statement, StorageAccess,
    Type, TypeInner,
};

use super::facts::Reach;
use super::{GROUP, GuardSite, Hazard};
use crate::{Linked, Module};

/// What the guard keeps at module scope; made when first asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Var {
    /// Steps that this invocation's loops have left.
    Steps,
    /// Steps left to its loops that carry barriers: the same number in all invocations of a workgroup.
    UniformSteps,
    /// 1 + the site of the loop to blame; 0: none.
    EndedLoop,
    /// The steps that loop took; above 0 where a loop of this invocation was ended.
    LoopSteps,
    /// 1 + the site of the first load that went astray; 0: none.
    StrayLoad,
    /// What a workgroup read of the first counter, any of them.
    Stop,
    /// The counters.
    Counters,
}

impl Var {
    fn name(self) -> &'static str {
        match self {
            Self::Steps => "guard_steps",
            Self::UniformSteps => "guard_uniform_steps",
            Self::EndedLoop => "guard_ended_loop",
            Self::LoopSteps => "guard_loop_steps",
            Self::StrayLoad => "guard_stray_load",
            Self::Stop => "guard_stop",
            Self::Counters => "guard_counters",
        }
    }
}

/// The module that is being rewritten.
pub(super) struct Shared<'a> {
    pub module: naga::Module,
    pub sites: Vec<GuardSite>,
    pub u32_type: Handle<Type>,
    linked: &'a Linked,
    pub max_steps: u32,
    binding: u32,
    vars: HashMap<Var, Handle<GlobalVariable>>,
}

impl<'a> Shared<'a> {
    pub fn new(module: &'a Module, max_steps: u32, binding: u32) -> Self {
        let mut naga = module.naga.clone();
        let u32_type = unnamed(&mut naga, TypeInner::Scalar(Scalar::U32));
        Self {
            module: naga,
            sites: Vec::new(),
            u32_type,
            linked: &module.linked,
            max_steps,
            binding,
            vars: HashMap::new(),
        }
    }

    /// The rewritten module, its sites, and the counters where any function uses them.
    pub fn finish(mut self) -> (naga::Module, Vec<GuardSite>, Option<Handle<GlobalVariable>>) {
        let counters = self.vars.get(&Var::Counters).copied();
        if let Some(counters) = counters {
            // How many there are is known only now.
            let length = u32::try_from(self.sites.len()).unwrap_or(u32::MAX - 1);
            let base = unnamed(&mut self.module, TypeInner::Atomic(Scalar::U32));
            let array = TypeInner::Array {
                base,
                size: ArraySize::Constant(NonZeroU32::MIN.saturating_add(length)),
                stride: 4,
            };
            self.module.global_variables[counters].ty = unnamed(&mut self.module, array);
        }
        (self.module, self.sites, counters)
    }

    /// A new site: 1 + its number. The word that the span starts with is its place.
    pub fn site(&mut self, hazard: Hazard, span: Span) -> u32 {
        let range = span.to_range().unwrap_or(0..0);
        let text = self.linked.text.get(range.clone()).unwrap_or("");
        let word = text.find(|c: char| !c.is_ascii_alphabetic());
        let place = self.linked.place(range.start, word.unwrap_or(text.len()));
        self.sites.push(GuardSite { hazard, place });
        u32::try_from(self.sites.len()).unwrap_or(u32::MAX)
    }

    fn var(&mut self, var: Var) -> Handle<GlobalVariable> {
        if let Some(handle) = self.vars.get(&var) {
            return *handle;
        }
        let atomic = TypeInner::Atomic(Scalar::U32);
        let (space, ty, init, binding) = match var {
            Var::Steps | Var::UniformSteps => {
                let steps = Expression::Literal(Literal::U32(self.max_steps));
                let steps = self
                    .module
                    .global_expressions
                    .append(steps, Span::default());
                (AddressSpace::Private, self.u32_type, Some(steps), None)
            }
            Var::EndedLoop | Var::LoopSteps | Var::StrayLoad => {
                (AddressSpace::Private, self.u32_type, None, None)
            }
            Var::Stop => {
                let ty = unnamed(&mut self.module, atomic);
                (AddressSpace::WorkGroup, ty, None, None)
            }
            Var::Counters => {
                let space = AddressSpace::Storage {
                    access: StorageAccess::LOAD | StorageAccess::STORE,
                };
                let binding = ResourceBinding {
                    group: GROUP,
                    binding: self.binding,
                };
                (space, self.u32_type, None, Some(binding))
            }
        };
        let variable = GlobalVariable {
            name: Some(self.free_name(var.name())),
            space,
            binding,
            ty,
            init,
            memory_decorations: MemoryDecorations::empty(),
        };
        let handle = self
            .module
            .global_variables
            .append(variable, Span::default());
        self.vars.insert(var, handle);
        handle
    }

    /// `name`, or with as many `_` behind it as make it new.
    fn free_name(&self, name: &str) -> String {
        let module = &self.module;
        let names = module.global_variables.iter().map(|(_, it)| &it.name);
        let names = names.chain(module.functions.iter().map(|(_, it)| &it.name));
        let names = names.chain(module.constants.iter().map(|(_, it)| &it.name));
        let names = names.chain(module.overrides.iter().map(|(_, it)| &it.name));
        let names = names.chain(module.types.iter().map(|(_, it)| &it.name));
        let mut taken: HashSet<&str> = names.filter_map(Option::as_deref).collect();
        taken.extend(module.entry_points.iter().map(|it| it.name.as_str()));
        let mut free = name.to_owned();
        while taken.contains(free.as_str()) {
            free.push('_');
        }
        free
    }
}

fn unnamed(module: &mut naga::Module, inner: TypeInner) -> Handle<Type> {
    module
        .types
        .insert(Type { name: None, inner }, Span::default())
}

/// The body of one function, as it is written anew. New expressions stand behind those there are and are emitted
/// where they are used.
pub(super) struct Code<'a, 'm> {
    pub shared: &'a mut Shared<'m>,
    pub reach: &'a Reach,
    pub function: &'a mut Function,
    block: Block,
    pending: Option<(Handle<Expression>, Handle<Expression>)>,
}

impl<'a, 'm> Code<'a, 'm> {
    pub fn new(shared: &'a mut Shared<'m>, reach: &'a Reach, function: &'a mut Function) -> Self {
        Self {
            shared,
            reach,
            function,
            block: Block::new(),
            pending: None,
        }
    }

    pub fn add(&mut self, expression: Expression) -> Handle<Expression> {
        let is_emitted = !expression.needs_pre_emit();
        if !is_emitted {
            self.emit();
        }
        let handle = self
            .function
            .expressions
            .append(expression, Span::default());
        if is_emitted {
            let first = self.pending.map_or(handle, |(first, _)| first);
            self.pending = Some((first, handle));
        }
        handle
    }

    /// Emits what was added.
    fn emit(&mut self) {
        if let Some((first, last)) = self.pending.take() {
            let range = Range::new_from_bounds(first, last);
            self.block.push(Statement::Emit(range), Span::default());
        }
    }

    pub fn push(&mut self, statement: Statement) {
        self.keep(statement, Span::default());
    }

    /// Adds a statement of the author's.
    pub fn keep(&mut self, statement: Statement, span: Span) {
        self.emit();
        self.block.push(statement, span);
    }

    /// What `write` writes, as a block of its own.
    pub fn write(&mut self, write: impl FnOnce(&mut Self)) -> Block {
        self.emit();
        let outer = std::mem::take(&mut self.block);
        write(self);
        let written = self.finish();
        self.block = outer;
        written
    }

    /// What was written so far.
    pub fn finish(&mut self) -> Block {
        self.emit();
        std::mem::take(&mut self.block)
    }

    /// `if condition { write }`.
    pub fn when(&mut self, condition: Handle<Expression>, write: impl FnOnce(&mut Self)) {
        let accept = self.write(write);
        self.push(Statement::If {
            condition,
            accept,
            reject: Block::new(),
        });
    }

    pub fn number(&mut self, number: u32) -> Handle<Expression> {
        self.add(Expression::Literal(Literal::U32(number)))
    }

    pub fn pointer(&mut self, var: Var) -> Handle<Expression> {
        let variable = self.shared.var(var);
        self.add(Expression::GlobalVariable(variable))
    }

    pub fn load(&mut self, pointer: Handle<Expression>) -> Handle<Expression> {
        self.add(Expression::Load { pointer })
    }

    pub fn value(&mut self, var: Var) -> Handle<Expression> {
        let pointer = self.pointer(var);
        self.load(pointer)
    }

    pub fn store(&mut self, pointer: Handle<Expression>, value: Handle<Expression>) {
        self.push(Statement::Store { pointer, value });
    }

    pub fn set(&mut self, var: Var, number: u32) {
        let value = self.number(number);
        let pointer = self.pointer(var);
        self.store(pointer, value);
    }

    pub fn binary(
        &mut self,
        op: BinaryOperator,
        left: Handle<Expression>,
        right: Handle<Expression>,
    ) -> Handle<Expression> {
        self.add(Expression::Binary { op, left, right })
    }

    /// `left op number`.
    pub fn with_number(
        &mut self,
        op: BinaryOperator,
        left: Handle<Expression>,
        number: u32,
    ) -> Handle<Expression> {
        let right = self.number(number);
        self.binary(op, left, right)
    }
}
