//! A session that is edited while it lives draws what a fresh one would, or keeps what it drew last.

#![expect(clippy::unwrap_used, reason = "a case fails by panicking")]
#![expect(
    clippy::print_stdout,
    reason = "what was measured is part of the result"
)]

use std::collections::{BTreeMap, BTreeSet};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::process::Command;

use volgraph::{Change, Findings, Outcome, Session};
use volgraph_tests::{Stage, adapters};

/// The files of the scene and the texts that edits put into them; the first text of each is the one it begins with.
const FILES: [(&str, &[&str]); 6] = [
    (
        "graph.ron",
        &[
            GRAPH,
            // Valid.
            "azimuth: 10 -> azimuth: 80",
            "\"step\": 1.0 -> \"step\": 0.5",
            "\"light\": \"unlit\" -> \"light\": \"phong\"",
            "\"gain\": 1.0 -> \"gain\": 0.25",
            "(8, 8, 8) -> (9, 7, 5)",
            "// A scene -> // The same scene",
            // Not so.
            "\"gain\": 1.0 -> \"gian\": 1.0",
            "\"gain\": 1.0 -> \"gain\": 1.0.0",
            "\"technique\": \"live\" -> \"technique\": \"lively\"",
            "image.color -> image.colour",
            "(8, 8, 8) -> (0, 8, 8)",
        ],
    ),
    (
        "transfer.ron",
        &[
            "(color: (1, 0.8, 0.5), opacity: [(0, 0), (1, 0.5)])",
            "(1, 0.8, 0.5) -> (0, 0.8, 1)",
            "(1, 0.5)] -> (1, 0.9)]",
            "(1, 0.5)] -> (1, 1.5)]",
            "color -> colour",
        ],
    ),
    (
        "slot/technique/live.wgsl",
        &[
            TECHNIQUE,
            "state.sum * -> 0.5 * state.sum *",
            "unused: f32, -> unused: f32, more: vec4f,",
            "// A technique -> // This technique",
            "state.sum * -> state.some *",
            "return false; -> return;",
            "gain: f32 -> gain f32",
            "(*state).sum += -> while segment.length >= 0.0 { (*state).sum += 1.0; } (*state).sum +=",
            "state.sum * -> state.sum / (ray.near - ray.near) *",
            "mine/a.wgsl -> mine/aa.wgsl",
        ],
    ),
    (
        "mine/a.wgsl",
        &[
            "// A step on the way.\n#import \"b.wgsl\"\nfn a_of(x: f32) -> f32 {\n    return b_of(x) + 0.0;\n}\n",
            "+ 0.0 -> + 0.125",
            "+ 0.0 -> + true",
            "b.wgsl -> c.wgsl",
        ],
    ),
    (
        "mine/b.wgsl",
        &[
            "// The end of the way.\nfn b_of(x: f32) -> f32 {\n    return 2.0 * x;\n}\n",
            "2.0 -> 3.0",
            "2.0 -> 2.0 * vec2f(1.0)",
            "b_of -> b_off",
        ],
    ),
    (
        "node/background.wgsl",
        &["", " -> broken", " -> // nothing"],
    ),
];

const GRAPH: &str = r#"// A scene
(
    sources: { "v": analytic(field: "gyroid", dims: (8, 8, 8)), "t": transfer(path: "transfer.ron") },
    camera: orbit(azimuth: 10, elevation: 20),
    nodes: {
        "box": (kind: "proxy_box", in: { "volume": "v" }),
        "image": (kind: "raycast", in: { "volume": "v", "transfer": "t", "rays": "box" },
                  slots: { "technique": "live", "light": "unlit" },
                  params: { "stage": "fragment", "step": 1.0, "gain": 1.0 }),
    },
    outputs: { "color": "image.color" },
)
"#;

const TECHNIQUE: &str = r#"// A technique
#import "lib/ray.wgsl"
#import "mine/a.wgsl"
#import slot "classify"
#import slot "light"

struct Params {
    /// Factor on the colour. @default 1 @range 0 4
    gain: f32,
}

struct TechniqueState { sum: vec3f, unused: f32, }

fn technique_begin(ray: Ray) -> TechniqueState {
    var state: TechniqueState;
    return state;
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    let light = light_segment(classify_segment(*ray, segment), segment, *ray);
    (*state).sum += light * a_of(segment.length);
    return false;
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    return RayResult(vec4f(state.sum * params.gain, 1.0), RAY_NO_DEPTH);
}
"#;

/// What the disk holds: the text of each file by its number; `None` where the file is away.
type Disk = BTreeMap<&'static str, Option<usize>>;

fn text(file: &str, number: usize) -> String {
    let (_, texts) = FILES.iter().find(|(name, _)| *name == file).unwrap();
    if number == 0 {
        return texts[0].to_owned();
    }
    let (from, to) = texts[number].split_once(" -> ").unwrap();
    if from.is_empty() {
        return to.to_owned();
    }
    assert!(texts[0].contains(from), "{file}: {from}");
    texts[0].replacen(from, to, 1)
}

/// Writes a file of the scene; an empty one is taken away.
fn put(stage: &Stage, file: &str, number: Option<usize>) {
    match number.map(|number| text(file, number)) {
        Some(text) if !text.is_empty() => stage.write(file, text),
        _ => {
            let _ = std::fs::remove_file(stage.path().join(file));
        }
    }
}

fn beginning() -> Disk {
    FILES.iter().map(|(name, _)| (*name, Some(0))).collect()
}

/// SplitMix64 (Steele et al. 2014).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n as u64) as usize
    }
}

/// One edit: a file gets another text, mostly a valid one; or everything goes back.
fn edit(disk: &mut Disk, random: &mut Random) {
    let is_broken = disk.values().any(|number| *number != Some(0));
    if is_broken && random.below(3) == 0 {
        // What people do after a mistake: one file goes back.
        let changed: Vec<&str> = disk
            .iter()
            .filter(|(_, number)| **number != Some(0))
            .map(|(name, _)| *name)
            .collect();
        let back = changed[random.below(changed.len())];
        disk.insert(back, Some(0));
        return;
    }
    let (name, texts) = FILES[random.below(FILES.len())];
    let number = random.below(texts.len() + 1);
    disk.insert(name, (number < texts.len()).then_some(number));
}

/// The picture that a fresh session draws of what is on disk, or why it refuses.
fn fresh(stage: &Stage, backend: &str) -> Result<u64, Findings> {
    let mut session = stage.open("graph.ron", &[], backend, SIZE)?;
    Ok(bits(&session.render_checked()?.0.color))
}

const SIZE: [u32; 2] = [16, 16];

/// Equal for pictures that are equal bit for bit.
fn bits(color: &[[f32; 4]]) -> u64 {
    let mut hasher = DefaultHasher::new();
    for component in color.as_flattened() {
        component.to_bits().hash(&mut hasher);
    }
    hasher.finish()
}

/// Resident bytes of this process, where the system tells.
fn resident() -> Option<u64> {
    let statm = std::fs::read_to_string("/proc/self/statm").ok()?;
    let pages: u64 = statm.split_whitespace().nth(1)?.parse().ok()?;
    Some(pages * 4096)
}

fn random_edits(backend: &str, edits: usize, seed: u64) {
    let stage = Stage::new();
    let mut disk = beginning();
    for (file, number) in &disk {
        put(&stage, file, *number);
    }
    let mut session = stage.open_alone("graph.ron", backend, SIZE).unwrap();
    let first = session.render_checked().unwrap().0.color;
    let mut random = Random(seed);
    let mut last_good = first.clone();
    // The disk after each edit, and what was drawn.
    let mut history: Vec<(Disk, bool, u64)> = Vec::new();
    let mut apply = |disk: &Disk, before: &Disk, session: &mut Session| {
        let mut changed = BTreeSet::new();
        for (file, number) in disk {
            if before[file] != *number {
                put(&stage, file, *number);
                changed.insert(stage.path().join(file));
            }
        }
        let is_taken = match session.apply(&Change::Files(changed)) {
            Ok(Outcome::Drawn(drawn)) => {
                last_good = drawn.picture.color;
                true
            }
            Ok(Outcome::Unchanged) => true,
            Err(_) => false,
        };
        let (picture, _) = session.render().unwrap();
        assert!(picture.color == last_good, "the last good picture stands");
        (is_taken, picture.color)
    };
    let ends = |session: &mut Session| {
        let (_, report) = session.render().unwrap();
        let memory = report.memory;
        (
            session.live_objects(),
            report.pipelines,
            (memory.textures, memory.buffers, memory.bytes),
        )
    };
    let mut begun = None;
    for count in 0..edits {
        // After a tenth of the edits every code path has been warmed up.
        if count == edits / 10 {
            let before = std::mem::replace(&mut disk, beginning());
            let (is_taken, color) = apply(&disk, &before, &mut session);
            assert!(is_taken && color == first, "back at the beginning");
            begun = Some((ends(&mut session), resident()));
        }
        let before = disk.clone();
        edit(&mut disk, &mut random);
        let (is_taken, color) = apply(&disk, &before, &mut session);
        history.push((disk.clone(), is_taken, bits(&color)));
    }
    let before = std::mem::replace(&mut disk, beginning());
    let (is_taken, color) = apply(&disk, &before, &mut session);
    assert!(is_taken && color == first, "back at the beginning");
    let (begun, resident_before) = begun.unwrap();
    assert_eq!(
        ends(&mut session),
        begun,
        "{backend}: objects and bytes on the device"
    );
    if let (Some(before), Some(after)) = (resident_before, resident()) {
        println!(
            "{backend}: {before} bytes resident after {} edits, {after} after {edits}",
            edits / 10
        );
        // Heaps and drivers keep some of what they once had; nine times as many edits add next to nothing to this.
        assert!(
            after < before + (8 << 20),
            "{backend}: {before} bytes became {after}"
        );
    }
    let mut known: BTreeMap<Disk, Result<u64, Findings>> = BTreeMap::new();
    let (mut taken, mut refused) = (0, 0);
    for (at, (wanted, is_taken, color)) in history.into_iter().enumerate() {
        let what = format!("{backend}, edit {at}: {wanted:?}");
        let expected = known.entry(wanted).or_insert_with_key(|wanted| {
            for (file, number) in wanted {
                put(&stage, file, *number);
            }
            fresh(&stage, backend)
        });
        match expected {
            Ok(expected) => {
                taken += 1;
                assert!(is_taken, "{what}: a fresh session draws it");
                assert!(color == *expected, "{what}: as a fresh session draws it");
            }
            Err(findings) => {
                refused += 1;
                assert!(!is_taken, "{what}: a fresh session refuses: {findings}");
            }
        }
    }
    println!(
        "{backend}: {taken} edits taken, {refused} refused, {} states",
        known.len()
    );
    assert!(taken > edits / 5 && refused > edits / 5, "both kinds occur");
}

/// Heaps of several threads keep what they once had, by chance of who freed what when: up to a fifth of all memory. These
/// have the GNU allocator take one heap, and give large pieces back at once; it reads them before a process starts.
const ONE_HEAP: [(&str, &str); 2] = [
    ("MALLOC_ARENA_MAX", "1"),
    ("MALLOC_MMAP_THRESHOLD_", "131072"),
];

#[test]
fn a_thousand_random_edits() {
    if std::env::var_os(ONE_HEAP[0].0).is_none() {
        let itself = std::env::current_exe().unwrap();
        let status = Command::new(itself)
            .args(["--exact", "a_thousand_random_edits", "--nocapture"])
            .envs(ONE_HEAP)
            .status();
        assert!(status.unwrap().success(), "what it says is above");
        return;
    }
    let backends = adapters();
    random_edits(&backends[0], 1000, 1);
    for backend in &backends[1..] {
        random_edits(backend, 100, 2);
    }
}
