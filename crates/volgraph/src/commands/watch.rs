//! `volgraph watch`: render, wait until something that the picture depends on changes, render again.
//!
//! The way of the data: a [`Session`] is opened (again and again until it can be), its dependencies go to a
//! [`FileWatch`]; changed files become a [`Change`], the session's answer is told ([`tell`]) and the picture saved.
//! A change that is refused is given a moment: many editors save in two steps, and the second may mend what the first
//! left half done. Only then is the diagnostic shown, once.

mod exec;
mod tell;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use volgraph::{
    Change, ChangedFile, Dependencies, Drawn, Finding, Findings, Outcome, Picture, Place, Refused,
    Session, embedded, registry,
};
use volgraph_graph::is_embedded;
use volgraph_picture::SaveOptions;
use volgraph_watch::{FileWatch, WatchOptions};

use self::exec::Exec;
use self::tell::Teller;
use super::errors;
use crate::args::WatchArgs;
use crate::output;
use crate::progress::Bars;

/// How long a refused change may take to be mended before it is told.
const PATIENCE: Duration = Duration::from_millis(60);

/// How often a command that runs is looked after.
const TICK: Duration = Duration::from_millis(50);

pub fn run(args: &WatchArgs) -> anyhow::Result<ExitCode> {
    super::check_output(&args.output)?;
    let compared = args.against.as_deref().map(|file| against(args, file));
    let compared = compared.transpose()?;
    let mut watch = FileWatch::new(WatchOptions {
        poll: args.poll.map(Duration::from_millis),
        ..WatchOptions::default()
    });
    let mut watcher = Watcher {
        args,
        teller: Teller::new(args, compared),
        exec: args
            .exec
            .clone()
            .map(|command| Exec::new(command, args.json)),
        session: None,
        unopened: None,
        count: 0,
    };
    let mut dependencies = watcher.begin()?;
    loop {
        arm(&mut watch, &dependencies);
        watcher.teller.watching(&dependencies, &watch);
        if output::is_closed() {
            return Ok(ExitCode::SUCCESS);
        }
        let changes = watcher.wait(&mut watch)?;
        dependencies = watcher.follow(&mut watch, changes)?;
    }
}

/// The picture that pictures are compared with.
fn against(args: &WatchArgs, file: &Path) -> Result<Picture, Findings> {
    super::check_overwrites(&args.output, [file])?;
    let picture = Picture::load(file).map_err(|error| errors::of_picture(&error, file))?;
    let size = args.scene.size;
    if [picture.width, picture.height] == size {
        return Ok(picture);
    }
    let (width, height) = (picture.width, picture.height);
    let message = format!(
        "it has {width}x{height} pixels, and the pictures to compare with it {}x{}",
        size[0], size[1]
    );
    Err(Finding::error("picture-sizes", message)
        .at(Place::whole_file(file))
        .help(format!("add `--size {width}x{height}`"))
        .into())
}

struct Changes {
    paths: std::collections::BTreeSet<PathBuf>,
    since: Instant,
}

struct Watcher<'a> {
    args: &'a WatchArgs,
    teller: Teller<'a>,
    exec: Option<Exec>,
    session: Option<Session>,
    /// Why there is no session yet.
    unopened: Option<Findings>,
    /// Pictures saved.
    count: u64,
}

impl Watcher<'_> {
    /// Opens the graph and renders; what is wrong with it is told, and waited for.
    fn begin(&mut self) -> anyhow::Result<Dependencies> {
        let (opened, dependencies) = self.open();
        match opened {
            Ok(()) => {}
            // There is nothing to wait for where the graph itself is not there.
            Err(findings) if !is_there(&self.args.scene.graph) => return Err(findings.into()),
            Err(findings) if has_code(&findings, super::OVERWRITES) => return Err(findings.into()),
            Err(findings) => {
                self.teller.refused(&findings, &[], None, true);
                self.unopened = Some(findings);
            }
        }
        Ok(dependencies)
    }

    /// Opens a session and draws its first picture.
    fn open(&mut self) -> (Result<(), Findings>, Dependencies) {
        let start = Instant::now();
        let scene = &self.args.scene;
        let bars = Bars::new();
        let opened = Session::begin(
            &scene.graph,
            &super::session_options(scene, Some(&self.args.output)),
            registry(),
            &bars,
        );
        bars.clear();
        let mut session = match opened {
            Ok(session) => session,
            Err(unopened) => return (Err(unopened.findings), unopened.dependencies),
        };
        let dependencies = session.dependencies().clone();
        if let Err(findings) = check_overwrites(self.args, &dependencies) {
            return (Err(findings), dependencies);
        }
        super::tell_warnings(scene, session.scene());
        self.teller.begins(&session);
        let drawn = session.render_checked();
        self.session = Some(session);
        match drawn {
            Ok((picture, frame)) => {
                self.save(picture, start, |teller, saved| teller.first(&frame, saved));
                (Ok(()), dependencies)
            }
            Err(findings) => (Err(findings), dependencies),
        }
    }

    /// Applies what changed, and what changes while it is refused, until there is a picture or patience ends.
    fn follow(&mut self, watch: &mut FileWatch, changes: Changes) -> anyhow::Result<Dependencies> {
        let mut changes = changes;
        let mut is_new = false;
        loop {
            let (refused, dependencies) = self.apply(&changes);
            let Some(refused) = refused else {
                return Ok(dependencies);
            };
            is_new |= !refused.is_repeat;
            arm(watch, &dependencies);
            match watch.wait(Some(PATIENCE))? {
                Some(more) => {
                    changes = Changes {
                        paths: changes.paths.union(&more).cloned().collect(),
                        since: changes.since,
                    }
                }
                None => {
                    // A watched folder tells of files as well that are none of the picture's.
                    let is_known = |path: &PathBuf| dependencies.files.contains_key(path);
                    if is_new || changes.paths.iter().any(is_known) {
                        let paths: Vec<PathBuf> = changes.paths.into_iter().collect();
                        let remade = refused.device_remade.as_deref();
                        self.teller
                            .refused(&refused.findings, &paths, remade, is_new);
                    }
                    return Ok(dependencies);
                }
            }
        }
    }

    /// Applies changed files once. Why it was refused, if it was, and what to watch now.
    fn apply(&mut self, changes: &Changes) -> (Option<Refused>, Dependencies) {
        let Some(session) = &mut self.session else {
            let (opened, dependencies) = self.open();
            let refused = opened.err().map(|findings| Refused {
                is_repeat: self.unopened.replace(findings.clone()).as_ref() == Some(&findings),
                findings,
                device_remade: None,
            });
            return (refused, dependencies);
        };
        let settled = Instant::now();
        let bars = Bars::new();
        let change = Change::Files(changes.paths.clone());
        let applied = session.apply_with(&change, &bars);
        bars.clear();
        let dependencies = session.dependencies().clone();
        match applied {
            Ok(Outcome::Unchanged) => {
                self.teller.unchanged(&changes.paths);
                (None, dependencies)
            }
            Ok(Outcome::Drawn(drawn)) => {
                if let Err(findings) = check_overwrites(self.args, &dependencies) {
                    let refused = Refused {
                        findings,
                        is_repeat: false,
                        device_remade: drawn.report.device_remade,
                    };
                    return (Some(refused), dependencies);
                }
                let Drawn {
                    picture,
                    mut report,
                } = *drawn;
                let is_known = |file: &ChangedFile| dependencies.files.contains_key(&file.path);
                if report.changed.iter().any(is_known) {
                    report.changed.retain(is_known);
                }
                let settle = settled - changes.since;
                self.save(picture, changes.since, |teller, saved| {
                    teller.drawn(&report, settle, saved);
                });
                (None, dependencies)
            }
            Err(refused) => (Some(refused), dependencies),
        }
    }

    /// Saves a picture and tells of it. A folder that is gone or a full disk is told as well; the next picture tries anew.
    fn save(
        &mut self,
        picture: Picture,
        since: Instant,
        tell: impl FnOnce(&mut Teller<'_>, tell::Saved<'_>),
    ) {
        let output = &self.args.output;
        let start = Instant::now();
        let bits = super::png_bits(&self.args.png_bits);
        let options = SaveOptions::default().with_png_bits(bits).live();
        match picture.save(output, options) {
            Ok(_) => {
                self.count += 1;
                let now = Instant::now();
                let saved = tell::Saved {
                    picture: &picture,
                    number: self.count,
                    save: now - start,
                    total: now - since,
                };
                tell(&mut self.teller, saved);
                self.teller.keep(picture);
                if let Some(exec) = &mut self.exec {
                    exec.start(output, self.count);
                }
            }
            Err(error) => {
                let finding = errors::of_picture(&error, output);
                let help =
                    "the picture is not saved; once this is mended, the next change saves again";
                self.teller
                    .refused(&finding.help(help).into(), &[], None, true);
            }
        }
    }

    /// Waits for a change, and looks after the command that runs.
    fn wait(&mut self, watch: &mut FileWatch) -> anyhow::Result<Changes> {
        loop {
            let is_running = self.exec.as_mut().is_some_and(Exec::look_after);
            let tick = is_running.then_some(TICK);
            if let Some(paths) = watch.wait(tick)? {
                return Ok(Changes {
                    paths,
                    since: watch.told_since().unwrap_or_else(Instant::now),
                });
            }
        }
    }
}

fn is_there(graph: &Path) -> bool {
    let graph = embedded::locate(graph);
    is_embedded(&graph) || graph.exists()
}

fn has_code(findings: &Findings, code: &str) -> bool {
    findings.into_iter().any(|finding| finding.code == code)
}

fn check_overwrites(args: &WatchArgs, dependencies: &Dependencies) -> Result<(), Findings> {
    let files = dependencies.files.keys().map(PathBuf::as_path);
    super::check_overwrites(&args.output, files)
}

/// Hands what the picture depends on to the watcher.
fn arm(watch: &mut FileWatch, dependencies: &Dependencies) {
    watch.watch(dependencies.files.clone(), dependencies.folders.clone());
}
