//! Guarded modules: places, findings, what cannot be guarded, and volgraph's own shaders.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use naga::valid::Capabilities;
use volgraph_report::{Finding, Severity};
use volgraph_shader::{GuardSite, Hazard, LinkRequest, Linked, ShaderRoots, check, link};

use crate::guard::guard_in;
use crate::{Files, start};

fn load(texture: &str) -> Hazard {
    Hazard::Load {
        texture: texture.to_owned(),
    }
}

#[test]
fn a_site_has_the_authors_place_three_files_deep() {
    let files = Files::new(&[
        (
            "shaders/a.wgsl",
            "// ä\n#import \"lib/b.wgsl\"\n\n@compute @workgroup_size(1)\nfn main() {\n    _ = b();\n\
             /* ä */ for (var i = 0; i < 3; i++) { }\n}\n",
        ),
        (
            "shaders/lib/b.wgsl",
            "#import \"c.wgsl\"\nfn b() -> f32 {\n  var x = 1.0;\n  /* ü */ while c(x) < 0.5 { x *= 2.0; }\n  return x;\n}\n",
        ),
        (
            "shaders/lib/c.wgsl",
            "#import \"../deep/d.wgsl\"\nfn c(x: f32) -> f32 { return d(i32(x)); }\n",
        ),
        (
            "shaders/deep/d.wgsl",
            "// Ω\n@group(0) @binding(0) var grey: texture_2d<f32>;\nstruct Params { /// @default 1\n a: f32, }\n\
             fn d(x: i32) -> f32 {\n\tvar sum = 0.0;\n\tloop\n\t{\n\t\tsum += 1.0; if sum > params.a { break; }\n\t}\n\
             \treturn sum + textureLoad(grey, vec2i(x,\n x), 0).x;\n}\n",
        ),
    ]);
    let guarded = guard_in(&files.check().unwrap(), &["main"]);
    let expected = [
        (Hazard::Loop, "shaders/deep/d.wgsl", "loop"),
        (load("grey"), "shaders/deep/d.wgsl", "textureLoad"),
        (Hazard::Loop, "shaders/lib/b.wgsl", "while"),
        (Hazard::Loop, "shaders/a.wgsl", "for"),
    ]
    .map(|(hazard, path, needle)| GuardSite {
        hazard,
        place: files.place(path, needle),
    });
    assert_eq!(guarded.sites, expected);
    assert_eq!(
        start(&guarded.sites[0].place),
        ("shaders/deep/d.wgsl".into(), 7, 2)
    );
}

#[test]
fn a_load_as_a_part_of_a_longer_expression_has_its_own_place() {
    let files = Files::one(
        "@group(0) @binding(0) var grey: texture_2d<f32>;\n\
         fn mixed(image: texture_2d<f32>, x: f32) -> f32 { return 1.0 + textureLoad(image, vec2i(1), 0).y * x; }\n\
         @compute @workgroup_size(1)\nfn main() { if mixed(grey, textureLoad(grey, vec2i(0), 0).x) < 1.0 { return; } }\n",
    );
    let guarded = guard_in(&files.check().unwrap(), &["main"]);
    let found: Vec<_> = guarded
        .sites
        .iter()
        .map(|site| (site.hazard.clone(), start(&site.place)))
        .collect();
    let start_of = |call: &str| start(&files.place("shaders/a.wgsl", call));
    assert_eq!(
        found,
        [
            (load("image"), start_of("textureLoad(image")),
            (load("grey"), start_of("textureLoad(grey")),
        ]
    );
}

#[test]
fn counters_become_findings() {
    let files = Files::one(
        "@group(0) @binding(0) var grey: texture_2d<f32>;\n@compute @workgroup_size(1)\nfn main() {\n\
         loop { if textureLoad(grey, vec2i(7), 0).x > 0.0 { break; } }\n while true { break; } }\n",
    );
    let guarded = guard_in(&files.check().unwrap(), &["main"]);
    assert!(guarded.findings(&[0, 0, 0, 0]).is_empty());
    // What says that a loop was ended is not a site, and what was not read back went well.
    assert!(guarded.findings(&[9]).is_empty());
    assert!(guarded.findings(&[]).is_empty());

    let findings = guarded.findings(&[1, 1, 40, 0]);
    let [ended, stray] = findings.sorted()[..] else {
        panic!("{findings}");
    };
    let place = |finding: &Finding| finding.place.clone().unwrap();
    assert_eq!(
        (ended.code, ended.severity),
        ("endless-loop", Severity::Error)
    );
    assert_eq!(place(ended), files.place("shaders/a.wgsl", "loop"));
    assert!(ended.message.contains("more than 1000 steps,"), "{ended}");
    assert!(ended.help.as_deref().unwrap().contains("shadow_step"));
    assert_eq!(
        (stray.code, stray.severity),
        ("out-of-range-load", Severity::Warning)
    );
    assert_eq!(place(stray), files.place("shaders/a.wgsl", "textureLoad"));
    assert!(
        stray.message.contains("`grey` in 40 invocations"),
        "{stray}"
    );
    let help = stray.help.as_deref().unwrap();
    assert!(help.contains("textureDimensions(grey)"), "{stray}");

    // A driver ended the first loop together with the last, which took the steps.
    let last = guarded.findings(&[1, 3, 0, 900]);
    assert_eq!(last.sorted().len(), 1, "{last}");
    assert_eq!(
        last.sorted()[0].place,
        Some(files.place("shaders/a.wgsl", "while"))
    );
}

#[test]
fn what_cannot_be_guarded_stays_as_it_is_and_says_why() {
    // No binding number is left.
    let mut full = String::new();
    for number in 0..1000 {
        full += &format!("@group(0) @binding({number}) var<uniform> v{number}: u32;\n");
    }
    full += "@compute @workgroup_size(1) fn main() { loop { break; } }";
    let full = Files(vec![("shaders/a.wgsl", full)]).check().unwrap();
    let guarded = guard_in(&full, &["main"]);
    let why = guarded.unguarded.as_deref().unwrap();
    assert!(why.contains("binding numbers"), "{why}");
    assert_eq!((guarded.binding, guarded.buffer_bytes()), (None, 0));
    assert_eq!(
        guarded.module.global_variables.len(),
        full.naga.global_variables.len()
    );

    // What naga refuses, it refuses of the original too: capabilities that the module was not checked with.
    let wide =
        Files::one("@compute @workgroup_size(1) fn main() { var x = 1.0lf; loop { break; } }");
    let wide = check(wide.link().unwrap(), Capabilities::FLOAT64).unwrap();
    let guarded = guard_in(&wide, &["main"]);
    let why = guarded.unguarded.as_deref().unwrap();
    assert!(why.contains("naga refuses"), "{why}");
    assert!(guarded.sites.is_empty() && guarded.entries_with_sites.is_empty());

    // A name that is not there guards nothing, and says so.
    let guarded = guard_in(&full, &["main", "mian"]);
    let why = guarded.unguarded.as_deref().unwrap();
    assert!(why.contains("`mian`"), "{why}");
    assert!(guard_in(&full, &[]).unguarded.is_none());
}

/// volgraph's own nodes; each choice of each slot that they reach is in one of them at least.
pub fn own_shaders() -> Vec<Linked> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shaders");
    let roots = ShaderRoots::on_disk().root(&folder);
    let slots = std::fs::read_dir(folder.join("slot")).expect("a shader of the folder");
    let slots: BTreeMap<String, Vec<String>> = slots
        .map(|slot| {
            slot.expect("a shader of the folder")
                .file_name()
                .into_string()
                .expect("a shader of the folder")
        })
        .map(|slot| (slot.clone(), roots.choices(&slot)))
        .collect();
    let first: BTreeMap<String, String> = slots
        .iter()
        .map(|(slot, choices)| (slot.clone(), choices[0].clone()))
        .collect();
    let mut linked_all = Vec::new();
    for node in std::fs::read_dir(folder.join("node")).expect("a shader of the folder") {
        let node = node.expect("a shader of the folder").path();
        let (mut seen, mut covered) = (BTreeSet::new(), BTreeSet::new());
        let mut pending = vec![first.clone()];
        while let Some(choice) = pending.pop() {
            let mut request = LinkRequest::new(&node);
            request.slots.clone_from(&choice);
            let linked = link(&roots, &request).expect("a shader of the folder");
            if !seen.insert(linked.slots_used.clone()) {
                continue;
            }
            for slot in linked.slots_used.keys() {
                for other in &slots[slot] {
                    if !covered.insert((slot.clone(), other.clone())) {
                        continue;
                    }
                    let mut changed = choice.clone();
                    changed.insert(slot.clone(), other.clone());
                    pending.push(changed);
                }
            }
            linked_all.push(linked);
        }
    }
    linked_all
}

/// Names, bindings and parameters are global to a node: any two choices of two slots must get on with each other.
#[test]
fn any_two_choices_link() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shaders");
    let roots = ShaderRoots::on_disk().root(&folder);
    let mut pairs = 0;
    let slots: BTreeMap<String, Vec<String>> = own_shaders()
        .iter()
        .flat_map(|linked| linked.slots_used.keys().cloned().collect::<Vec<_>>())
        .map(|slot| (slot.clone(), roots.choices(&slot)))
        .collect();
    // Slots are reached by way of these.
    let far = [
        ("technique", "dvr"),
        ("light", "phong_ends"),
        ("classify", "preintegrated_2d"),
    ];
    for (first, choices) in &slots {
        for (second, others) in slots.range(first.clone()..).skip(1) {
            for (choice, other) in choices
                .iter()
                .flat_map(|a| others.iter().map(move |b| (a, b)))
            {
                let mut request = LinkRequest::new("node/raycast.wgsl");
                request.slots = slots
                    .iter()
                    .map(|(slot, choices)| (slot.clone(), choices[0].clone()))
                    .collect();
                request
                    .slots
                    .extend(far.map(|(slot, choice)| (slot.to_owned(), choice.to_owned())));
                request.slots.insert(first.clone(), choice.clone());
                request.slots.insert(second.clone(), other.clone());
                if let Err(findings) = link(&roots, &request) {
                    panic!("{first} {choice}, {second} {other}: {findings}");
                }
                pairs += 1;
            }
        }
    }
    assert!(pairs > 1000, "{pairs}");
}

#[test]
fn volgraphs_own_shaders_can_be_guarded() {
    let mut loops = BTreeSet::new();
    let mut loads = BTreeSet::new();
    let all = own_shaders();
    assert!(all.len() > 50, "{}", all.len());
    for linked in all {
        let choice = format!("{:?}", linked.slots_used);
        let module = check(linked, Capabilities::default()).unwrap();
        let entries: Vec<String> = module
            .entry_points()
            .iter()
            .map(|entry| entry.name.clone())
            .collect();
        let entries: Vec<&str> = entries.iter().map(String::as_str).collect();
        let guarded = guard_in(&module, &entries);
        assert_eq!(guarded.unguarded, None, "{choice}");
        for site in guarded.sites {
            let (file, line, _) = start(&site.place);
            let file = file.rsplit_once("shaders/").unwrap().1.to_owned();
            let text = module.linked.file_text(&site.place.file).unwrap();
            let line = text.lines().nth(line as usize - 1).unwrap();
            let at: String = line.chars().skip(site.place.column as usize - 1).collect();
            match site.hazard {
                Hazard::Loop => {
                    assert!(at.starts_with("for"), "{at}");
                    loops.insert(file);
                }
                Hazard::Load { texture } => {
                    assert!(at.starts_with(&format!("textureLoad({texture},")), "{at}");
                    loads.insert(file);
                }
            }
        }
    }
    let has = |files: &BTreeSet<String>, file: &str| assert!(files.contains(file), "{files:?}");
    has(&loops, "node/raycast.wgsl");
    has(&loops, "slot/gradient_method/sobel.wgsl");
    has(&loads, "slot/behind/texture.wgsl");
    has(&loads, "slot/volumes/one.wgsl");
}
