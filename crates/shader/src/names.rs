//! What an unknown name may have been meant to be.
//!
//! For an identifier: what is declared at module scope, the names of its function, and WGSL's own. For a member: the
//! members of all structs that are near to it, each tried in its place; naga says whether that is one of this struct.

use std::collections::BTreeSet;
use std::ops::Range;

use naga::valid::Capabilities;
use volgraph_report::near_names;

use crate::Linked;
use crate::check::parse;
use crate::diagnose::BAD_ACCESSOR;
use crate::items::Items;

/// So many members are tried.
const MAX_TRIED: usize = 4;

/// The identifier that the unknown one at byte `offset` may be.
pub(crate) fn near_identifier(
    linked: &Linked,
    items: &Items<'_>,
    offset: usize,
    unknown: &str,
) -> Option<String> {
    let declared = linked.declared.iter().map(|known| known.name.as_str());
    let own = items.locals(offset);
    let wgsl = WGSL_NAMES.split_whitespace().chain(["true", "false"]);
    // What the author named is likelier meant than what WGSL has.
    near_names(unknown, declared.chain(own))
        .first()
        .or(near_names(unknown, wgsl).first())
        .map(|near| (*near).to_owned())
}

/// The struct member that the unknown one at these bytes of `text` may be.
pub(crate) fn near_member(
    linked: &Linked,
    text: &str,
    at: &Range<usize>,
    capabilities: Capabilities,
) -> Option<String> {
    let unknown = text.get(at.clone())?;
    let params = linked.params.iter().map(|param| param.name.as_str());
    let members: BTreeSet<&str> = linked
        .declared
        .iter()
        .flat_map(|declared| {
            let source = &linked.files[declared.file].text;
            declared
                .members
                .iter()
                .map(|member| &source[member.clone()])
        })
        .chain(params)
        .collect();
    let is_member = |candidate: &&str| {
        let tried = [&text[..at.start], candidate, &text[at.end..]].concat();
        let Err(error) = parse(&tried, capabilities) else {
            return true;
        };
        let start = error
            .labels()
            .next()
            .and_then(|(span, _)| span.to_range())
            .map(|range| range.start);
        !(error.message().starts_with(BAD_ACCESSOR) && start == Some(at.start))
    };
    near_names(unknown, members)
        .into_iter()
        .take(MAX_TRIED)
        .find(is_member)
        .map(str::to_owned)
}

/// Types and functions that need no declaration.
const WGSL_NAMES: &str = "\
    bool i32 u32 f32 f16 vec2 vec3 vec4 vec2f vec3f vec4f vec2i vec3i vec4i vec2u vec3u vec4u vec2h \
    vec3h vec4h mat2x2 mat2x3 mat2x4 mat3x2 mat3x3 mat3x4 mat4x2 mat4x3 mat4x4 mat2x2f mat2x3f mat2x4f mat3x2f \
    mat3x3f mat3x4f mat4x2f mat4x3f mat4x4f array atomic ptr sampler sampler_comparison texture_1d texture_2d \
    texture_2d_array texture_3d texture_cube texture_cube_array texture_multisampled_2d texture_storage_1d \
    texture_storage_2d texture_storage_2d_array texture_storage_3d texture_depth_2d texture_depth_2d_array \
    texture_depth_cube texture_depth_cube_array texture_depth_multisampled_2d bitcast all any select arrayLength \
    abs acos acosh asin asinh atan atanh atan2 ceil clamp cos cosh countLeadingZeros countOneBits \
    countTrailingZeros cross degrees determinant distance dot dot4U8Packed dot4I8Packed exp exp2 extractBits \
    faceForward firstLeadingBit firstTrailingBit floor fma fract frexp insertBits inverseSqrt ldexp length log \
    log2 max min mix modf normalize pow quantizeToF16 radians reflect refract reverseBits round saturate sign \
    sin sinh smoothstep sqrt step tan tanh transpose trunc dpdx dpdxCoarse dpdxFine dpdy dpdyCoarse dpdyFine \
    fwidth fwidthCoarse fwidthFine textureDimensions textureGather textureGatherCompare textureLoad \
    textureNumLayers textureNumLevels textureNumSamples textureSample textureSampleBias textureSampleCompare \
    textureSampleCompareLevel textureSampleGrad textureSampleLevel textureSampleBaseClampToEdge textureStore \
    atomicLoad atomicStore atomicAdd atomicSub atomicMax atomicMin atomicAnd atomicOr atomicXor atomicExchange \
    atomicCompareExchangeWeak pack4x8snorm pack4x8unorm pack4xI8 pack4xU8 pack4xI8Clamp pack4xU8Clamp \
    pack2x16snorm pack2x16unorm pack2x16float unpack4x8snorm unpack4x8unorm unpack4xI8 unpack4xU8 \
    unpack2x16snorm unpack2x16unorm unpack2x16float storageBarrier textureBarrier workgroupBarrier \
    workgroupUniformLoad";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn naga_knows_each_of_wgsls_names() {
        let message = |name: &str| {
            let text = format!("fn f() {{ {name}(); }}");
            parse(&text, Capabilities::all())
                .err()
                .map(|error| error.message().to_owned())
                .unwrap_or_default()
        };
        let is_unknown = |name: &str| message(name).starts_with("no definition in scope");
        assert!(is_unknown("textureSimple"), "{}", message("textureSimple"));
        let names = || WGSL_NAMES.split_whitespace();
        let unknown: Vec<_> = names().filter(|name| is_unknown(name)).collect();
        assert!(unknown.is_empty(), "{unknown:?}");
        assert_eq!(names().collect::<BTreeSet<_>>().len(), names().count());
    }
}
