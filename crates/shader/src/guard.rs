//! Shader code that goes wrong is survived, and told at its author's own line.
//!
//! The way of the data: [`guard`] takes a checked module and the entry points that a pass runs. `facts` finds
//! the functions that these reach; `loops` and `loads` rewrite them, so that all loops of an invocation share
//! one budget of steps and each `textureLoad` compares its operands with its texture, and remember where that
//! went wrong; `report` lets each entry point read at its start whether an earlier invocation used up its
//! budget, and write at its end into the counters, a storage buffer, what it remembers. naga validates the
//! result. The caller binds the buffer, reads it back, and [`Guarded::findings`] says what the counters mean.
//!
//! Nothing but this is touched: no value that the shader computes changes before a loop is ended. wgpu drops
//! what an entry point does not reach itself, so nothing is taken out here: bindings and overrides stay.

mod code;
mod facts;
mod loads;
mod loops;
mod report;

use std::collections::HashSet;

use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Function, ShaderStage};
use volgraph_report::{Finding, Findings, Place};

use crate::Module;
use crate::check::with_room;
use code::{Code, Shared};
use facts::{Facts, Reach};

/// The group that the counters are bound in.
const GROUP: u32 = 0;
/// WebGPU's binding numbers are below this.
const BINDINGS_END: u32 = 1000;
/// Twice a count of steps still fits in 32 bits.
const MOST_STEPS: u32 = (1 << 30) - 1;

/// What to guard.
#[derive(Clone, Copy, Debug)]
pub struct GuardRequest<'a> {
    /// How many turns all loops of one invocation may take together; a `for` of n turns takes n + 1, the last
    /// one to find its end. Brought into 1 to 2³⁰ - 1.
    pub max_steps: u32,
    /// The entry points that a pass runs.
    pub entries: &'a [&'a str],
}

/// What can go wrong at a place.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Hazard {
    /// A loop that does not end.
    Loop,
    /// A `textureLoad` outside of its texture: of its texels, levels, layers or samples.
    Load {
        /// The texture's name where it is loaded from: a variable's, or a parameter's.
        texture: String,
    },
}

/// A place that is watched.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct GuardSite {
    /// What can go wrong there.
    pub hazard: Hazard,
    /// The word `loop`, `for`, `while` or `textureLoad` in the author's file.
    pub place: Place,
}

/// A guarded module.
#[derive(Clone, Debug)]
pub struct Guarded {
    /// The module to run; the original where there is nothing to guard, or where [`Self::unguarded`] says why not.
    pub module: naga::Module,
    /// What naga found out about it.
    pub info: ModuleInfo,
    /// The places that the counters count, in the order of the counters.
    pub sites: Vec<GuardSite>,
    /// Group and binding of the counters, `array<atomic<u32>, sites + 1>`, read and written; zeros before the
    /// first pass of a frame. `None` where no entry point reports: nothing is guarded, or vertex loops alone.
    pub binding: Option<(u32, u32)>,
    /// The fragment and compute entry points, of those asked for, that use the counters.
    pub entries_with_sites: Vec<String>,
    /// The budget that was set.
    pub max_steps: u32,
    /// Why the module could not be guarded, where it could not.
    pub unguarded: Option<String>,
}

/// Guards the functions that the entry points reach. Never fails: what cannot be guarded comes back as it is,
/// with the reason in [`Guarded::unguarded`].
///
/// Vertex entry points cannot write storage: their loops end, and do not report. The turns of a loop that carries
/// a barrier are counted apart from those of the others, so that all invocations of a workgroup leave it together.
#[must_use]
pub fn guard(module: &Module, request: GuardRequest<'_>, capabilities: Capabilities) -> Guarded {
    let max_steps = request.max_steps.clamp(1, MOST_STEPS);
    let guarded = with_room(|| {
        let original = || original(module, max_steps, None);
        guard_here(module, request, max_steps, capabilities)
            .map(|done| done.unwrap_or_else(original))
    });
    let why = match guarded {
        Ok(Ok(guarded)) => return guarded,
        Ok(Err(why)) => why,
        Err(_) => "the guard failed on this shader".to_owned(),
    };
    original(module, max_steps, Some(why))
}

fn original(module: &Module, max_steps: u32, unguarded: Option<String>) -> Guarded {
    Guarded {
        module: module.naga.clone(),
        info: module.info.clone(),
        sites: Vec::new(),
        binding: None,
        entries_with_sites: Vec::new(),
        max_steps,
        unguarded,
    }
}

/// `None` where there is nothing to guard.
///
/// # Errors
/// Why it cannot be guarded.
fn guard_here(
    module: &Module,
    request: GuardRequest<'_>,
    max_steps: u32,
    capabilities: Capabilities,
) -> Result<Option<Guarded>, String> {
    let missing = request.entries.iter().find(|name| {
        let mut known = module.naga.entry_points.iter();
        !known.any(|entry| entry.name == **name)
    });
    if let Some(name) = missing {
        return Err(format!("there is no entry point `{name}`"));
    }
    let reach = Reach::new(&module.naga, request.entries);
    if !reach.has_work() {
        return Ok(None);
    }
    let Some(binding) = free_binding(&module.naga) else {
        return Err(format!("all binding numbers of @group({GROUP}) are taken"));
    };
    let mut shared = Shared::new(module, max_steps, binding);
    rewrite(&mut shared, &reach, request.entries);
    let (naga, sites, counters) = shared.finish();
    let info = Validator::new(ValidationFlags::all(), capabilities)
        .validate(&naga)
        .map_err(|error| format!("naga refuses the guarded module: {}", error.as_inner()))?;
    let entries_with_sites: Vec<String> = naga
        .entry_points
        .iter()
        .enumerate()
        .filter(|(at, entry)| {
            let uses = counters.is_some_and(|it| !info.get_entry_point(*at)[it].is_empty());
            uses && request.entries.contains(&entry.name.as_str())
        })
        .map(|(_, entry)| entry.name.clone())
        .collect();
    Ok(Some(Guarded {
        binding: counters.map(|_| (GROUP, binding)),
        module: naga,
        info,
        sites,
        entries_with_sites,
        max_steps,
        unguarded: None,
    }))
}

fn rewrite(shared: &mut Shared<'_>, reach: &Reach, entries: &[&str]) {
    let handles: Vec<_> = shared.module.functions.iter().map(|(it, _)| it).collect();
    for handle in handles {
        let Some(visit) = reach.visit(handle) else {
            continue;
        };
        let mut function = std::mem::take(&mut shared.module.functions[handle]);
        Code::new(shared, reach, &mut function).rewrite(visit.is_reported, None);
        shared.module.functions[handle] = function;
    }
    for at in 0..shared.module.entry_points.len() {
        let entry = &mut shared.module.entry_points[at];
        if !entries.contains(&entry.name.as_str()) {
            continue;
        }
        let is_reported = can_report(entry.stage);
        let mut function: Function = std::mem::take(&mut entry.function);
        let facts: Facts = reach.facts_of(&function);
        let reported = (is_reported && facts.has_work()).then_some(facts);
        Code::new(shared, reach, &mut function).rewrite(is_reported, reported);
        shared.module.entry_points[at].function = function;
    }
}

/// Whether an entry point of this stage may write storage everywhere.
fn can_report(stage: ShaderStage) -> bool {
    matches!(stage, ShaderStage::Fragment | ShaderStage::Compute)
}

/// The number after the highest one taken in the group, or the first free one.
fn free_binding(module: &naga::Module) -> Option<u32> {
    let taken: HashSet<u32> = module
        .global_variables
        .iter()
        .filter_map(|(_, variable)| variable.binding)
        .filter(|binding| binding.group == GROUP)
        .map(|binding| binding.binding)
        .collect();
    let next = taken.iter().max().map_or(0, |last| last.saturating_add(1));
    std::iter::once(next)
        .chain(0..BINDINGS_END)
        .find(|number| *number < BINDINGS_END && !taken.contains(number))
}

impl Guarded {
    /// The size of the counters' buffer in bytes; 0 where there is none.
    #[must_use]
    pub fn buffer_bytes(&self) -> u64 {
        match self.binding {
            Some(_) => 4 * (self.sites.len() as u64 + 1),
            None => 0,
        }
    }

    /// What the counters say: `endless-loop` (an error: the picture is not finished) and `out-of-range-load` (a
    /// warning: the picture depends on the device). `counters` is the buffer as read back; missing ones are 0.
    #[must_use]
    pub fn findings(&self, counters: &[u32]) -> Findings {
        // The first counter is not a site's: it says that a loop was ended.
        let counts = counters.iter().skip(1);
        let sites = || self.sites.iter().zip(counts.clone());
        let loops = sites().filter(|(site, _)| site.hazard == Hazard::Loop);
        let most_steps = loops.map(|(_, steps)| *steps).max().unwrap_or(0);
        sites()
            .filter(|(site, count)| match site.hazard {
                // Invocations that were ended with others took few steps, and are not to blame.
                Hazard::Loop => **count > most_steps / 2,
                Hazard::Load { .. } => **count > 0,
            })
            .map(|(site, count)| site.finding(*count, self.max_steps))
            .collect()
    }
}

impl GuardSite {
    /// What to say of a loop that took at most `count` steps, or of a load that `count` invocations did.
    #[must_use]
    pub fn finding(&self, count: u32, max_steps: u32) -> Finding {
        let who = match count {
            1 => "1 invocation".to_owned(),
            more => format!("{more} invocations"),
        };
        let finding = match &self.hazard {
            Hazard::Loop => Finding::error(
                "endless-loop",
                // How many invocations got so far before the others were cut short is chance.
                format!("this loop took more than {max_steps} steps, or the driver ended it"),
            )
            .help(
                "give it an end that is always reached: a `for` with a fixed last number, or a `break` that does not \
                 depend on what may be NaN or stand still; if it has one, let fewer turns do (a longer `step` or \
                 `shadow_step`): software drivers end all loops of a pixel after some 65,000 turns together",
            ),
            Hazard::Load { texture } => Finding::warning(
                "out-of-range-load",
                format!("this loads from outside of `{texture}` in {who}; what it gets depends on the device"),
            )
            .help(format!(
                "clamp the coordinates, or test them against `textureDimensions({texture})`; a level must be below \
                 `textureNumLevels({texture})`"
            )),
        };
        finding.at(self.place.clone())
    }
}
