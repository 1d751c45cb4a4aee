//! Guarded modules: loads from textures.

use naga::back::pipeline_constants::process_overrides;
use naga::back::spv;

use crate::guard::{SPEND, assert_has, compute, wgsl};

const TEXTURES: &str = "
@group(0) @binding(0) var flat_texture: texture_2d<f32>;
@group(0) @binding(1) var layers: texture_2d_array<u32>;
@group(0) @binding(2) var line: texture_1d<f32>;
@group(0) @binding(3) var samples: texture_multisampled_2d<f32>;
@group(0) @binding(4) var solid: texture_3d<f32>;
@group(0) @binding(5) var kept: texture_storage_2d<rgba8unorm, read>;
@group(0) @binding(6) var depth: texture_depth_2d;
";

/// What stands between the test and the load.
fn stray(site: u32) -> String {
    format!("{{ let _ = guard_stray_load; if (_ == 0u) {{ guard_stray_load = {site}u; }} }}")
}

#[test]
fn a_load_compares_its_operands_with_its_texture() {
    let stray = stray(1);
    for (load, test, made) in [
        (
            "textureLoad(flat_texture, vec2i(id.xy), 0).x",
            format!(
                "let _ = textureDimensions(flat_texture, 0i); if any((vec2<u32>(_) >= _)) {stray}"
            ),
            "textureLoad(flat_texture, _, 0i)",
        ),
        (
            "f32(textureLoad(layers, vec2i(id.xy), i32(id.z), 0).x)",
            format!(
                "let _ = textureNumLayers(layers); if any((vec2<u32>(_) >= _)) {stray} \
                 if (u32(_) >= _) {stray}"
            ),
            "textureLoad(layers, _, _, 0i)",
        ),
        (
            "textureLoad(line, i32(id.x), 0).x",
            format!("let _ = textureDimensions(line, 0i); if (u32(_) >= _) {stray}"),
            "textureLoad(line, _, 0i)",
        ),
        (
            "textureLoad(samples, vec2i(id.xy), i32(id.z)).x",
            format!(
                "let _ = textureNumSamples(samples); if any((vec2<u32>(_) >= _)) {stray} \
                 if (u32(_) >= _) {stray}"
            ),
            "textureLoad(samples, _, _)",
        ),
        (
            "textureLoad(solid, id, 0).x",
            format!("let _ = textureDimensions(solid, 0i); if any((vec3<u32>(id) >= _)) {stray}"),
            "textureLoad(solid, id, 0i)",
        ),
        (
            "textureLoad(kept, vec2i(id.xy)).x",
            format!("let _ = textureDimensions(kept); if any((vec2<u32>(_) >= _)) {stray}"),
            "textureLoad(kept, _)",
        ),
        (
            "textureLoad(depth, vec2i(id.xy), 0)",
            format!("let _ = textureDimensions(depth, 0i); if any((vec2<u32>(_) >= _)) {stray}"),
            "textureLoad(depth, _, 0i)",
        ),
        (
            "textureLoad(flat_texture, vec2i(id.xy), id.z).x",
            format!(
                "let _ = textureNumLevels(flat_texture); \
                 let _ = textureDimensions(flat_texture, min(_, (_ - 1u))); \
                 if (_ >= _) {stray} if any((vec2<u32>(_) >= _)) {stray}"
            ),
            "textureLoad(flat_texture, _, id.z)",
        ),
    ] {
        let guarded = compute(TEXTURES, &format!("let x = {load};"));
        assert_has(&guarded, &test);
        // The load stands right behind its test, its operands as they were.
        let text = wgsl(&guarded);
        let end = text.find(&test).unwrap() + test.len();
        let next = text[end..].split_once(';').unwrap().0;
        assert!(next.ends_with(made), "`{next}` is not `{made}`");
        assert_eq!(guarded.sites.len(), 1);
        assert_eq!(guarded.binding, Some((0, 7)));
        // Loads alone stop no other invocation.
        assert!(!text.contains("guard_counters[0]"), "{text}");
        assert_has(
            &guarded,
            "let _ = guard_stray_load; if (_ != 0u) { atomicAdd((&guard_counters[_]), 1u); } return;",
        );
    }
}

#[test]
fn loads_are_tested_in_the_order_that_they_run() {
    let guarded = compute(
        TEXTURES,
        "let a = textureLoad(flat_texture, vec2i(id.xy), 0).x; let at = vec2i(i32(a), i32(id.z)); \
         let b = textureLoad(flat_texture, at, 0).x + textureLoad(depth, at + 1, 0);",
    );
    assert_eq!(guarded.sites.len(), 3);
    let text = wgsl(&guarded);
    let places: Vec<usize> = ["guard_stray_load = 1u", "let a =", "guard_stray_load = 2u"]
        .iter()
        .chain(&["guard_stray_load = 3u", "textureLoad(depth", "let b ="])
        .map(|part| text.find(part).unwrap())
        .collect();
    assert!(places.is_sorted(), "{places:?} in {text}");
}

#[test]
fn a_load_in_a_loops_condition_is_tested_in_each_turn() {
    let guarded = compute(
        TEXTURES,
        "var i = 0; while textureLoad(line, i, 0).x < 0.5 { i++; }\n\
         loop { continuing { i++; break if textureLoad(line, i, 0).x < 0.5; } }",
    );
    let test = "let _ = textureDimensions(line, 0i); if (u32(_) >= _) { let _ = guard_stray_load; \
                let _ = guard_loop_steps; if ((_ | _) == 0u) { guard_stray_load =";
    assert_has(&guarded, &format!("{SPEND} let _ = i; {test} 2u;"));
    let text = wgsl(&guarded);
    let continuing = text.find("continuing").unwrap();
    assert!(
        text[continuing..].contains(&format!("{test} 4u;")),
        "{text}"
    );
}

#[test]
fn a_load_from_a_parameter_is_tested_where_it_stands() {
    let guarded = compute(
        &format!(
            "{TEXTURES}\nfn first(image: texture_3d<f32>) -> f32 {{ return textureLoad(image, vec3i(-1), 0).x; }}"
        ),
        "let x = first(solid);",
    );
    assert_has(
        &guarded,
        "fn first(image: texture_3d<f32>) -> f32 { let _ = vec3(-1i); let _ = textureDimensions(image, 0i);",
    );
    assert_eq!(wgsl(&guarded).matches("textureDimensions").count(), 1);
}

#[test]
fn overrides_are_still_there_and_constant_operands_can_be_evaluated() {
    let guarded = compute(
        &format!("{TEXTURES}\noverride turns: u32 = 3u;\noverride unused: u32 = 1u;"),
        "for (var i = 0u; i < turns; i++) { \
         _ = textureLoad(flat_texture, vec2i(-1, 7), -1); \
         _ = textureLoad(layers, vec2i(0), 1, 0); }",
    );
    let constants = [("turns", 5.0), ("unused", 2.0)];
    let constants = constants
        .iter()
        .map(|(name, value)| ((*name).to_owned(), *value));
    let (module, info) = process_overrides(
        &guarded.module,
        &guarded.info,
        Some((naga::ShaderStage::Compute, "main")),
        &constants.collect(),
    )
    .unwrap();
    let entry = spv::PipelineOptions {
        shader_stage: naga::ShaderStage::Compute,
        entry_point: "main".to_owned(),
    };
    spv::write_vec(&module, &info, &spv::Options::default(), Some(&entry)).unwrap();
}
