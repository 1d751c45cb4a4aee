//! From a linked text to a module that naga has validated, or to findings.
//!
//! A sound text is parsed and validated once. Where anything is wrong, [`crate::recover`] tries again and again, without
//! what was found faulty, so that all clashing bindings, all faulty parameter docs and what naga would only find one by
//! one are told together.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::sync::Arc;
use std::thread;

use naga::front::wgsl::{Frontend, Options};
use naga::valid::{Capabilities, ModuleInfo, ValidationError, ValidationFlags, Validator};
use naga::{TypeInner, WithSpan};
use volgraph_report::{Finding, Findings, Place, near_names};

use crate::layout::Layouts;
use crate::link::{LinkRequest, link};
use crate::params::doc::shader_param;
use crate::{Linked, ParamSpec, ShaderRoots, order, recover};

/// naga recurses over declarations that refer to each other and over nested statements: room for the longest
/// chain that a linked text of the largest size can have. Only what is touched is ever committed.
const STACK_BYTES: usize = 128 << 20;

/// A validated shader module.
#[derive(Clone, Debug)]
pub struct Module {
    /// naga's own module.
    pub naga: naga::Module,
    /// What naga found out about it.
    pub info: naga::valid::ModuleInfo,
    /// The text it was made of.
    pub linked: Arc<Linked>,
    pub(crate) params: Vec<ParamSpec>,
}

impl Module {
    /// The names of all functions, entry points included.
    pub fn function_names(&self) -> impl Iterator<Item = &str> {
        let functions = self.naga.functions.iter();
        functions
            .filter_map(|(_, function)| function.name.as_deref())
            .chain(
                self.naga
                    .entry_points
                    .iter()
                    .map(|point| point.name.as_str()),
            )
    }

    /// Where the name of this function stands.
    #[must_use]
    pub fn function_place(&self, name: &str) -> Option<Place> {
        self.function_names()
            .find(|known| *known == name)
            .and_then(|name| self.linked.declaration_place(name))
    }

    /// The finding `missing-entry` for an entry point that is not there: at the function that may be meant, or at the
    /// first line of the root.
    #[must_use]
    pub fn missing_entry(&self, entry: &str) -> Finding {
        let message = format!("there is no entry point `{entry}`, which its node runs");
        let finding = Finding::error("missing-entry", message);
        let near = near_names(entry, self.function_names()).into_iter().next();
        let finding = if let Some(place) = self.function_place(entry) {
            let stage = "`@vertex`, `@fragment`, or `@compute` and `@workgroup_size(…)`";
            finding
                .at(place)
                .help(format!("write {stage} before this function"))
        } else if let Some((near, place)) = near.and_then(|n| Some((n, self.function_place(n)?))) {
            finding
                .at(place)
                .help(format!("is `{near}` meant to be it?"))
        } else {
            let first = self.linked.files.last().map_or_else(
                || self.linked.root_place(),
                |file| Place::in_text(&file.path, &file.text, 0, file.text.len()),
            );
            finding
                .at(first)
                .help("declare it, as volgraph's own shader of this name does")
        };
        self.linked.with_imports(finding)
    }
}

/// Parses and validates a linked text.
///
/// # Errors
/// `wgsl-syntax` (the first of each file), `wgsl-type` and `wgsl-validation` (the first of each function and
/// declaration), `name-clash`, `binding-clash`, `params-doc`, each at the author's places, with the imports on the way
/// there; `wgsl-internal` where naga itself fails.
pub fn check(
    linked: impl Into<Arc<Linked>>,
    capabilities: Capabilities,
) -> Result<Module, Findings> {
    let linked = linked.into();
    with_room(|| check_here(&linked, capabilities)).unwrap_or_else(|_| {
        Err(Finding::error(
            "wgsl-internal",
            "the WGSL compiler (naga) failed on this shader",
        )
        .at(linked.root_place())
        .help("take away parts of the shader until it compiles, and report what made it fail")
        .into())
    })
}

/// Runs `work` on a thread of its own where the recursion of naga, and of what compiles its modules, has room: 128 MiB
/// of stack. What is bound to the caller's thread, such as wgpu's error scopes, has to be set up inside.
///
/// # Errors
/// What `work` panicked with.
pub fn with_room<T: Send>(work: impl Fn() -> T + Sync) -> thread::Result<T> {
    thread::scope(|scope| {
        let deep = thread::Builder::new()
            .name("volgraph-shader-check".to_owned())
            .stack_size(STACK_BYTES)
            .spawn_scoped(scope, &work);
        match deep {
            Ok(deep) => deep.join(),
            // Where there are no threads, the caller's stack must do.
            Err(_) => Ok(work()),
        }
    })
}

/// Links one file (a library, a slot's choice or a node; a path relative to the current folder or to a root)
/// with the default choices of the slots that it imports, and checks it; it needs no entry point.
///
/// # Errors
/// As [`crate::link()`] and [`check`].
pub fn check_file(
    roots: &ShaderRoots,
    path: &Path,
    default_slots: &BTreeMap<String, String>,
    capabilities: Capabilities,
) -> Result<Module, Findings> {
    let mut request = LinkRequest::new(path).base("");
    request.slots.clone_from(default_slots);
    check(link(roots, &request)?, capabilities)
}

fn check_here(linked: &Arc<Linked>, capabilities: Capabilities) -> Result<Module, Findings> {
    if let Ok(naga) = parse(&linked.text, capabilities)
        && let Ok(info) = validate(&naga, capabilities)
        && let Ok(params) = declarations(linked, &naga)
    {
        return Ok(Module {
            naga,
            info,
            linked: Arc::clone(linked),
            params,
        });
    }
    let findings = recover::all_errors(linked, capabilities);
    Err(findings
        .into_iter()
        .map(|finding| linked.with_imports(finding))
        .collect())
}

/// The parameters; or all clashing bindings and all faulty parameter docs.
pub(crate) fn declarations(
    linked: &Linked,
    module: &naga::Module,
) -> Result<Vec<ParamSpec>, Findings> {
    let mut findings = binding_clashes(linked, module);
    let params = linked
        .params
        .iter()
        .filter_map(|param| {
            let inner = params_member(module, &param.name)?;
            findings.take_all(shader_param(
                linked,
                param,
                &Layouts::new(module, linked).member_type(inner),
            ))
        })
        .collect::<Vec<_>>();
    // In a draft without what is faulty, parameters may be missing.
    let are_all_known = params.len() == linked.params.len();
    for file in linked.files.iter().filter(|_| are_all_known) {
        findings.take_all(order::check(file, &params));
    }
    findings.into_result(params)
}

/// Validates a module as [`check`] does.
pub(crate) fn validate(
    module: &naga::Module,
    capabilities: Capabilities,
) -> Result<ModuleInfo, Box<WithSpan<ValidationError>>> {
    Validator::new(ValidationFlags::all(), capabilities)
        .validate(module)
        .map_err(Box::new)
}

/// Parses WGSL as [`check`] does.
pub(crate) fn parse(
    text: &str,
    capabilities: Capabilities,
) -> Result<naga::Module, naga::front::wgsl::ParseError> {
    // The linker reads doc comments itself: it knows their places, and naga 30 gives a member the doc comment
    // of another one where an earlier member has none.
    let options = Options {
        parse_doc_comments: false,
        capabilities,
    };
    Frontend::new_with_options(options).parse(text)
}

fn params_member(module: &naga::Module, name: &str) -> Option<naga::Handle<naga::Type>> {
    let (_, params) = module
        .types
        .iter()
        .find(|(_, ty)| ty.name.as_deref() == Some("Params"))?;
    let TypeInner::Struct { members, .. } = &params.inner else {
        return None;
    };
    let member = members
        .iter()
        .find(|member| member.name.as_deref() == Some(name))?;
    Some(member.ty)
}

fn binding_clashes(linked: &Linked, module: &naga::Module) -> Findings {
    let mut first: HashMap<(u32, u32), &str> = HashMap::new();
    let mut findings = Findings::new();
    for (_, variable) in module.global_variables.iter() {
        let (Some(binding), Some(name)) = (variable.binding, &variable.name) else {
            continue;
        };
        let Some(before) = first.get(&(binding.group, binding.binding)) else {
            first.insert((binding.group, binding.binding), name);
            continue;
        };
        // The one that stands later in the text is to blame, unless the linker wrote the earlier one.
        let at = |name: &str| {
            linked
                .declared
                .iter()
                .position(|declared| declared.name == name)
        };
        let (blamed, other) = if at(before) > at(name) {
            (*before, name.as_str())
        } else {
            (name.as_str(), *before)
        };
        let is_made = |name: &str| {
            linked
                .declaration(name)
                .is_some_and(|declared| declared.is_made)
        };
        let (blamed, other) = if is_made(blamed) {
            (other, blamed)
        } else {
            (blamed, other)
        };
        let message = format!(
            "`{blamed}` and `{other}` have the same @group({}) @binding({})",
            binding.group, binding.binding
        );
        let mut finding =
            Finding::error("binding-clash", message).help("give one of them another number");
        if is_made(other) {
            finding = finding.help("that is the binding of `struct Params`: take another number");
        }
        if let Some(place) = linked.declaration_place(blamed) {
            finding = finding.at(place);
        }
        if let Some(place) = linked.declaration_place(other) {
            finding = finding.related(place, "the other one");
        }
        findings.push(finding);
    }
    findings
}
