//! `volgraph watch`: render, wait until something that the picture depends on changes, render again.
//!
//! The way of the data: a [`Session`] is opened (again and again until it can be), its dependencies go to a
//! [`FileWatch`]; changed files become a [`Change`], the session's answer is told ([`tell`]) and the picture saved.
//! A change that is refused is given a moment: many editors save in two steps, and the second may mend what the first
//! left half done. Only then is the diagnostic shown, once. A picture that cannot be saved is kept until it can.

mod against;
mod exec;
mod tell;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use volgraph::{
    Change, ChangedFile, Dependencies, Drawn, Findings, Outcome, Picture, Session, TruthOptions,
    embedded, registry, verify::integral_truth,
};
use volgraph_graph::is_embedded;
use volgraph_picture::SaveOptions;
use volgraph_watch::{FileWatch, WatchOptions};

use self::exec::Exec;
use self::tell::Teller;
use super::errors;
use super::reference::Rows;
use crate::args::WatchArgs;
use crate::output;
use crate::progress::Bars;

/// How long a refused change may take to be mended before it is told.
const PATIENCE: Duration = Duration::from_millis(60);

/// How long it may take in all where one change comes after the other.
const LONGEST_PATIENCE: Duration = Duration::from_secs(1);

/// How often it is tried to save a picture that could not be saved.
const RETRY: Duration = Duration::from_millis(500);

/// How often a command that runs is looked after.
const TICK: Duration = Duration::from_millis(50);

pub fn run(args: &WatchArgs) -> anyhow::Result<ExitCode> {
    super::check_output(&args.output)?;
    let is_reference = against::is_reference(args);
    let compared = args.against.as_deref().filter(|_| !is_reference);
    let compared = compared
        .map(|file| against::picture(args, file))
        .transpose()?;
    let mut watch = FileWatch::new(WatchOptions {
        poll: args.poll.map(Duration::from_millis),
        ..WatchOptions::default()
    });
    let mut watcher = Watcher {
        args,
        teller: Teller::new(args, compared),
        is_reference,
        exec: args.exec.clone().map(|line| Exec::new(line, args.json)),
        session: None,
        told: None,
        unsaved: None,
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

struct Changes {
    paths: BTreeSet<PathBuf>,
    since: Instant,
}

/// A picture that could not be saved.
struct Unsaved {
    picture: Picture,
    since: Instant,
    next_try: Instant,
    why: Findings,
}

struct Watcher<'a> {
    args: &'a WatchArgs,
    teller: Teller<'a>,
    /// Whether pictures are compared with their truth.
    is_reference: bool,
    exec: Option<Exec>,
    session: Option<Session>,
    /// The findings that were told last, until there is a picture of what the files say.
    told: Option<Findings>,
    /// The last picture, where it is not on disk.
    unsaved: Option<Unsaved>,
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
            Err(findings) => self.refuse(findings, &[], None),
        }
        Ok(dependencies)
    }

    /// Tells why a change was refused, in full where that is not what was told last.
    fn refuse(&mut self, findings: Findings, changed: &[PathBuf], remade: Option<&str>) {
        let is_new = self.told.as_ref() != Some(&findings);
        self.teller.refused(&findings, changed, remade, is_new);
        self.told = Some(findings);
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
        let chosen = session.chosen().cloned();
        self.session = Some(session);
        match drawn {
            Ok((picture, frame)) => {
                self.save(picture, start, |teller, saved| {
                    teller.first(&frame, chosen.as_ref(), saved);
                });
                (Ok(()), dependencies)
            }
            Err(findings) => (Err(findings), dependencies),
        }
    }

    /// Applies what changed, and what changes while it is refused, until there is a picture or patience ends.
    fn follow(&mut self, watch: &mut FileWatch, changes: Changes) -> anyhow::Result<Dependencies> {
        let mut changes = changes;
        let mut remade = None;
        let mut start = Instant::now();
        loop {
            let (refused, dependencies) = self.apply(&changes, &mut remade);
            let Some(findings) = refused else {
                return Ok(dependencies);
            };
            arm(watch, &dependencies);
            let more = watch.wait(Some(PATIENCE))?;
            if more.is_none() || start.elapsed() > LONGEST_PATIENCE {
                let paths: Vec<PathBuf> = changes.paths.iter().cloned().collect();
                // A watched folder tells of files as well that are none of the picture's.
                let is_known = |path: &PathBuf| dependencies.files.contains_key(path);
                let is_new = self.told.as_ref() != Some(&findings);
                if is_new || more.is_none() && changes.paths.iter().any(is_known) {
                    self.refuse(findings, &paths, remade.take().as_deref());
                }
                start = Instant::now();
            }
            match more {
                Some(more) => changes.paths.extend(more),
                None => return Ok(dependencies),
            }
        }
    }

    /// Applies changed files once. Why it was refused, if it was, and what to watch now. `remade` is why the device was
    /// opened again, where that is not told yet.
    fn apply(
        &mut self,
        changes: &Changes,
        remade: &mut Option<String>,
    ) -> (Option<Findings>, Dependencies) {
        let Some(session) = &mut self.session else {
            let (opened, dependencies) = self.open();
            return (opened.err(), dependencies);
        };
        let settled = Instant::now();
        let bars = Bars::new();
        let change = Change::Files(changes.paths.clone());
        let applied = session.apply_with(&change, &bars);
        bars.clear();
        let dependencies = session.dependencies().clone();
        match applied {
            Ok(Outcome::Unchanged) => {
                let is_mended = self.told.take().is_some();
                let remade = remade.take().or_else(|| session.take_device_remade());
                self.teller
                    .unchanged(&changes.paths, is_mended, remade.as_deref());
                (None, dependencies)
            }
            Ok(Outcome::Drawn(drawn)) => {
                let Drawn {
                    picture,
                    mut report,
                } = *drawn;
                report.device_remade = report.device_remade.or(remade.take());
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
            Err(refused) => {
                *remade = refused.device_remade.or(remade.take());
                (Some(refused.findings), dependencies)
            }
        }
    }

    /// Saves a new picture. A folder that is gone or a full disk is told as well, and it is tried again.
    fn save(
        &mut self,
        picture: Picture,
        since: Instant,
        tell: impl FnOnce(&mut Teller<'_>, tell::Saved<'_>),
    ) {
        self.told = None;
        let before = self.unsaved.take();
        if let Err((picture, why)) = self.try_to_save(picture, since, tell) {
            let is_new = before.is_none_or(|before| before.why != why);
            self.teller.refused(&why, &[], None, is_new);
            self.unsaved = Some(Unsaved {
                picture,
                since,
                next_try: Instant::now() + RETRY,
                why,
            });
        }
    }

    /// Tries once more to save what could not be saved, when it is time.
    fn save_later(&mut self) {
        let is_due = |unsaved: &mut Unsaved| unsaved.next_try <= Instant::now();
        let Some(unsaved) = self.unsaved.take_if(is_due) else {
            return;
        };
        let Unsaved { picture, since, .. } = unsaved;
        let saved = self.try_to_save(picture, since, |teller, saved| {
            teller.saved_later(saved);
        });
        if let Err((picture, why)) = saved {
            if why != unsaved.why {
                self.teller.refused(&why, &[], None, true);
            }
            self.unsaved = Some(Unsaved {
                picture,
                since,
                next_try: Instant::now() + RETRY,
                why,
            });
        }
    }

    fn try_to_save(
        &mut self,
        picture: Picture,
        since: Instant,
        tell: impl FnOnce(&mut Teller<'_>, tell::Saved<'_>),
    ) -> Result<(), (Picture, Findings)> {
        let output = &self.args.output;
        let dependencies = self.session.as_ref().map(Session::dependencies);
        let checked = dependencies.map_or(Ok(()), |them| check_overwrites(self.args, them));
        if let Err(why) = checked {
            return Err((picture, why));
        }
        let start = Instant::now();
        let bits = super::png_bits(&self.args.png_bits);
        let options = SaveOptions::default().with_png_bits(bits).live();
        if let Err(error) = picture.save(output, options) {
            let why = errors::of_picture(&error, output);
            return Err((picture, why.into()));
        }
        self.count += 1;
        let now = Instant::now();
        self.look_up_truth();
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
        Ok(())
    }

    /// Hands the truth of what is drawn to the teller: computed once for a scene and view, whatever the shaders do.
    fn look_up_truth(&mut self) {
        let Some(session) = self.session.as_ref().filter(|_| self.is_reference) else {
            return;
        };
        let bars = Bars::new();
        let options = TruthOptions::default();
        let truth = integral_truth(session.scene(), session.view(), &[], &options, &Rows(&bars));
        bars.clear();
        let picture = truth.and_then(|truth| truth.picture());
        self.teller.hold_against(picture);
    }

    /// Waits for a change, and looks meanwhile after the command that runs and the picture that is not saved.
    fn wait(&mut self, watch: &mut FileWatch) -> anyhow::Result<Changes> {
        loop {
            self.save_later();
            let is_running = self.exec.as_mut().is_some_and(Exec::look_after);
            let tick = match &self.unsaved {
                _ if is_running => Some(TICK),
                Some(_) => Some(RETRY),
                None => None,
            };
            let Some(mut paths) = watch.wait(tick)? else {
                continue;
            };
            // In a folder that is watched, what is saved is no news.
            paths.retain(|path| !is_same_path(path, &self.args.output));
            if !paths.is_empty() {
                return Ok(Changes {
                    paths,
                    since: watch.told_since().unwrap_or_else(Instant::now),
                });
            }
        }
    }
}

/// Whether a graph of this name is on disk, as it seems at least, or part of the program.
fn is_there(graph: &Path) -> bool {
    let path = embedded::locate(graph);
    is_embedded(&path) || path.symlink_metadata().is_ok()
}

fn is_same_path(a: &Path, b: &Path) -> bool {
    match (std::path::absolute(a), std::path::absolute(b)) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    }
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
