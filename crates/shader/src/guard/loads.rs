//! The loads from textures in what a statement evaluates.
//!
//! Before each one, its operands are compared with its texture, negative ones as the large numbers that they are
//! without a sign. The first that lies outside is remembered, unless a loop was ended before: a cut loop leaves
//! wrong numbers behind, and they are not the author's.

use naga::{
    BinaryOperator, Expression, Handle, ImageDimension, ImageQuery, Literal, MathFunction, Range,
    RelationalFunction, ScalarKind, Span, Statement, TypeInner,
};

use super::Hazard;
use super::code::{Code, Var};

/// The operands of a load.
struct Load {
    image: Handle<Expression>,
    coordinate: Handle<Expression>,
    array_index: Option<Handle<Expression>>,
    sample: Option<Handle<Expression>>,
    level: Option<Handle<Expression>>,
}

impl Code<'_, '_> {
    /// Emits a range in parts, so that each load's check stands right before it.
    pub(super) fn emit_guarded(&mut self, range: Range<Expression>, span: Span) {
        let mut part: Option<(Handle<Expression>, Handle<Expression>)> = None;
        for handle in range {
            if let Some(load) = self.load_at(handle) {
                if let Some((first, last)) = part.take() {
                    let before = Range::new_from_bounds(first, last);
                    self.keep(Statement::Emit(before), span);
                }
                self.guard_load(&load, self.function.expressions.get_span(handle));
            }
            part = Some((part.map_or(handle, |(first, _)| first), handle));
        }
        if let Some((first, last)) = part {
            self.keep(Statement::Emit(Range::new_from_bounds(first, last)), span);
        }
    }

    fn load_at(&self, handle: Handle<Expression>) -> Option<Load> {
        match self.function.expressions[handle] {
            Expression::ImageLoad {
                image,
                coordinate,
                array_index,
                sample,
                level,
            } => Some(Load {
                image,
                coordinate,
                array_index,
                sample,
                level,
            }),
            _ => None,
        }
    }

    fn guard_load(&mut self, load: &Load, span: Span) {
        let Some((dim, texture)) = self.texture(load.image) else {
            return;
        };
        let site = self.shared.site(Hazard::Load { texture }, span);
        let image = load.image;
        let mut outside = Vec::new();
        let mut size_level = load.level;
        // Each texture has a level 0.
        if let Some(level) = load.level.filter(|level| !self.is_zero(*level)) {
            let level = self.unsigned(level);
            let levels = self.query(image, ImageQuery::NumLevels);
            outside.push(self.binary(BinaryOperator::GreaterEqual, level, levels));
            // No driver is asked for the size of a level that there is not.
            let last = self.with_number(BinaryOperator::Subtract, levels, 1);
            size_level = Some(self.add(Expression::Math {
                fun: MathFunction::Min,
                arg: level,
                arg1: Some(last),
                arg2: None,
                arg3: None,
            }));
        }
        let coordinate = self.unsigned(load.coordinate);
        let size = self.query(image, ImageQuery::Size { level: size_level });
        let mut beyond = self.binary(BinaryOperator::GreaterEqual, coordinate, size);
        if dim != ImageDimension::D1 {
            beyond = self.add(Expression::Relational {
                fun: RelationalFunction::Any,
                argument: beyond,
            });
        }
        outside.push(beyond);
        let counted = [
            (load.array_index, ImageQuery::NumLayers),
            (load.sample, ImageQuery::NumSamples),
        ];
        for (index, count) in counted {
            if let Some(index) = index {
                let index = self.unsigned(index);
                let count = self.query(image, count);
                outside.push(self.binary(BinaryOperator::GreaterEqual, index, count));
            }
        }
        for condition in outside {
            self.when(condition, |code| {
                let stray = code.value(Var::StrayLoad);
                let mut before = stray;
                if code.reach.reported.has_loops() {
                    let ended = code.value(Var::LoopSteps);
                    before = code.binary(BinaryOperator::InclusiveOr, stray, ended);
                }
                let is_first = code.with_number(BinaryOperator::Equal, before, 0);
                code.when(is_first, |code| code.set(Var::StrayLoad, site));
            });
        }
    }

    /// Dimension and name of the texture, a variable, a parameter, or one of an array of them.
    fn texture(&self, image: Handle<Expression>) -> Option<(ImageDimension, String)> {
        let types = &self.shared.module.types;
        let (ty, name) = match self.function.expressions[image] {
            Expression::GlobalVariable(variable) => {
                let variable = &self.shared.module.global_variables[variable];
                (variable.ty, &variable.name)
            }
            Expression::FunctionArgument(at) => {
                let argument = self.function.arguments.get(at as usize)?;
                (argument.ty, &argument.name)
            }
            Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => {
                let Expression::GlobalVariable(array) = self.function.expressions[base] else {
                    return None;
                };
                let array = &self.shared.module.global_variables[array];
                let TypeInner::BindingArray { base, .. } = types[array.ty].inner else {
                    return None;
                };
                (base, &array.name)
            }
            _ => return None,
        };
        match types[ty].inner {
            TypeInner::Image { dim, .. } => Some((dim, name.clone().unwrap_or_default())),
            _ => None,
        }
    }

    fn is_zero(&self, number: Handle<Expression>) -> bool {
        matches!(
            self.function.expressions[number],
            Expression::Literal(Literal::I32(0) | Literal::U32(0))
        )
    }

    /// The same bits without a sign.
    fn unsigned(&mut self, expr: Handle<Expression>) -> Handle<Expression> {
        self.add(Expression::As {
            expr,
            kind: ScalarKind::Uint,
            convert: Some(4),
        })
    }

    fn query(&mut self, image: Handle<Expression>, query: ImageQuery) -> Handle<Expression> {
        self.add(Expression::ImageQuery { image, query })
    }
}
