//! Memory on the device. A pooled resource is reclaimed by description: a plan asks for kinds, and gets what is
//! held of equal kind and use, preferably with the content that it needs, before anything is made anew.

use std::collections::BTreeSet;

use serde::Serialize;
use volgraph_graph::{Digest, ResourceKind};
use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, Device, Extent3d, Texture, TextureDescriptor,
    TextureDimension, TextureUsages, TextureView,
};

/// A resource on the device.
#[derive(Debug)]
pub struct Held {
    /// What it is.
    pub resource: ResourceKind,
    /// Whether shaders write it as a storage texture. Part of its identity.
    pub is_storage: bool,
    /// The fingerprint of what it holds: (writer's fingerprint, output port).
    pub content: Option<(Digest, String)>,
    pub(crate) object: Object,
}

#[derive(Debug)]
pub(crate) enum Object {
    Texture { texture: Texture, view: TextureView },
    Buffer(Buffer),
}

impl Held {
    pub(crate) fn texture(&self) -> Option<&Texture> {
        match &self.object {
            Object::Texture { texture, .. } => Some(texture),
            Object::Buffer(_) => None,
        }
    }

    pub(crate) fn view(&self) -> Option<&TextureView> {
        match &self.object {
            Object::Texture { view, .. } => Some(view),
            Object::Buffer(_) => None,
        }
    }

    pub(crate) fn buffer(&self) -> Option<&Buffer> {
        match &self.object {
            Object::Buffer(buffer) => Some(buffer),
            Object::Texture { .. } => None,
        }
    }
}

/// Counts and bytes of what is held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PoolReport {
    /// Textures held.
    pub textures: usize,
    /// Buffers held.
    pub buffers: usize,
    /// Bytes of both.
    pub bytes: u64,
    /// Resources made since the start.
    pub made: u64,
    /// Resources taken over from an earlier plan since the start.
    pub reused: u64,
}

/// What one allocation of a plan asks for.
#[derive(Clone, Debug)]
pub struct Wish {
    /// What it must be.
    pub resource: ResourceKind,
    /// Whether shaders write it as a storage texture.
    pub is_storage: bool,
    /// What it would best hold already.
    pub contents: BTreeSet<(Digest, String)>,
}

/// A held resource, as wishes are compared with it: what it is, whether it is a storage texture, what it holds.
pub type Offer = (ResourceKind, bool, Option<(Digest, String)>);

/// How wishes are met from what is held: for each wish the index of a held resource, or `None` where one must be
/// made. Content comes first, so that no wish takes what another one could keep.
#[must_use]
pub fn match_wishes(held: &[Offer], wishes: &[Wish]) -> Vec<Option<usize>> {
    let mut taken = vec![false; held.len()];
    let mut matched = vec![None; wishes.len()];
    for by_content in [true, false] {
        for (wish, slot) in wishes.iter().zip(&mut matched) {
            if slot.is_some() {
                continue;
            }
            let fits = |at: &usize| {
                let (resource, is_storage, content) = &held[*at];
                !taken[*at]
                    && *resource == wish.resource
                    && *is_storage == wish.is_storage
                    && (!by_content
                        || content
                            .as_ref()
                            .is_some_and(|content| wish.contents.contains(content)))
            };
            *slot = (0..held.len()).find(fits);
            if let Some(at) = *slot {
                taken[at] = true;
            }
        }
    }
    matched
}

pub(crate) fn make(device: &Device, resource: ResourceKind, is_storage: bool) -> Held {
    let object = match resource {
        ResourceKind::Texture {
            dimensions,
            extent,
            format,
        } => {
            let mut usage =
                TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST | TextureUsages::COPY_SRC;
            if is_storage {
                usage |= TextureUsages::STORAGE_BINDING;
            }
            let texture = device.create_texture(&TextureDescriptor {
                label: None,
                size: Extent3d {
                    width: extent[0],
                    height: extent[1],
                    depth_or_array_layers: extent[2],
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: match dimensions {
                    1 => TextureDimension::D1,
                    2 => TextureDimension::D2,
                    _ => TextureDimension::D3,
                },
                format,
                usage,
                view_formats: &[],
            });
            let view = texture.create_view(&Default::default());
            Object::Texture { texture, view }
        }
        ResourceKind::Buffer { bytes } => Object::Buffer(device.create_buffer(&BufferDescriptor {
            label: None,
            size: bytes.next_multiple_of(4),
            usage: BufferUsages::VERTEX
                | BufferUsages::STORAGE
                | BufferUsages::COPY_DST
                | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        })),
    };
    Held {
        resource,
        is_storage,
        content: None,
        object,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wish(bytes: u64, content: Option<u8>) -> Wish {
        Wish {
            resource: ResourceKind::Buffer { bytes },
            is_storage: false,
            contents: content
                .map(|c| ([c; 32], "out".to_owned()))
                .into_iter()
                .collect(),
        }
    }

    #[test]
    fn content_is_kept_by_whom_it_serves() {
        let held = |bytes, content: u8| {
            (
                ResourceKind::Buffer { bytes },
                false,
                Some(([content; 32], "out".to_owned())),
            )
        };
        let there = [held(8, 1), held(8, 2), held(4, 3)];
        let wishes = [
            wish(8, None),
            wish(8, Some(1)),
            wish(4, Some(9)),
            wish(16, None),
        ];
        assert_eq!(
            match_wishes(&there, &wishes),
            [Some(1), Some(0), Some(2), None]
        );
    }

    #[test]
    fn other_uses_are_another_resource() {
        let there = [(ResourceKind::Buffer { bytes: 8 }, true, None)];
        assert_eq!(match_wishes(&there, &[wish(8, None)]), [None]);
    }
}
