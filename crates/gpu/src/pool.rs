//! Memory on the device. A plan asks for resources; what is held already with the content that one of them needs is
//! shared, and everything else is made anew, so that the plan before keeps what it has until the new one is proven.

use std::collections::BTreeSet;

use serde::Serialize;
use volgraph_graph::{Digest, ResourceKind};
use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, Device, Extent3d, Texture, TextureDescriptor,
    TextureDimension, TextureUsages, TextureView,
};

/// How passes write a resource.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Written {
    /// Whether shaders write it as a storage texture.
    pub is_storage: bool,
    /// Whether draw passes draw into it.
    pub is_target: bool,
}

/// A resource on the device; clones share it.
#[derive(Clone, Debug)]
pub struct Held {
    /// What it is.
    pub resource: ResourceKind,
    /// How it is written. Part of its identity.
    pub written: Written,
    /// The fingerprint of what it holds: (writer's fingerprint, output port).
    pub content: Option<(Digest, String)>,
    pub(crate) object: Object,
}

#[derive(Clone, Debug)]
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
    /// Resources shared with an earlier plan since the start.
    pub reused: u64,
}

/// What one allocation of a plan asks for.
#[derive(Clone, Debug)]
pub struct Wish {
    /// What it must be.
    pub resource: ResourceKind,
    /// How it is written.
    pub written: Written,
    /// What it would best hold already.
    pub contents: BTreeSet<(Digest, String)>,
}

/// A held resource, as wishes are compared with it: what it is, how it is written, what it holds.
pub type Offer = (ResourceKind, Written, Option<(Digest, String)>);

/// Which held resource each wish shares, if any: one of the same kind and use that holds what the wish's only user
/// would write. Nothing else is shared, so that what is held stays as it is while the plan with the wishes is tried:
/// a node whose result is there already does not run.
#[must_use]
pub fn shared(held: &[Offer], wishes: &[Wish]) -> Vec<Option<usize>> {
    let fits = |wish: &Wish, (resource, written, content): &Offer| {
        *resource == wish.resource
            && *written == wish.written
            && wish.contents.len() == 1
            && content
                .as_ref()
                .is_some_and(|content| wish.contents.contains(content))
    };
    wishes
        .iter()
        .map(|wish| held.iter().position(|offer| fits(wish, offer)))
        .collect()
}

pub(crate) fn make(device: &Device, resource: ResourceKind, written: Written) -> Held {
    let object = match resource {
        ResourceKind::Texture {
            dimensions,
            extent,
            format,
        } => {
            let mut usage =
                TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST | TextureUsages::COPY_SRC;
            if written.is_storage {
                usage |= TextureUsages::STORAGE_BINDING;
            }
            if written.is_target {
                usage |= TextureUsages::RENDER_ATTACHMENT;
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
                | BufferUsages::INDIRECT
                | BufferUsages::COPY_DST
                | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        })),
    };
    Held {
        resource,
        written,
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
            written: Written::default(),
            contents: content
                .map(|c| ([c; 32], "out".to_owned()))
                .into_iter()
                .collect(),
        }
    }

    fn offer(bytes: u64, is_storage: bool, content: Option<u8>) -> Offer {
        let content = content.map(|content| ([content; 32], "out".to_owned()));
        let written = Written {
            is_storage,
            is_target: false,
        };
        (ResourceKind::Buffer { bytes }, written, content)
    }

    #[test]
    fn what_holds_the_content_is_shared() {
        let held = [
            offer(8, false, Some(1)),
            offer(8, false, Some(2)),
            offer(4, false, Some(3)),
        ];
        let wishes = [
            wish(8, None),
            wish(8, Some(2)),
            wish(4, Some(9)),
            wish(16, Some(1)),
        ];
        assert_eq!(shared(&held, &wishes), [None, Some(1), None, None]);
    }

    #[test]
    fn what_would_be_overwritten_is_not_shared() {
        let mut twice = wish(8, Some(1));
        twice.contents.insert(([2; 32], "out".to_owned()));
        assert_eq!(shared(&[offer(8, false, Some(1))], &[twice]), [None]);
        let empty = offer(8, false, None);
        assert_eq!(shared(&[empty], &[wish(8, Some(1))]), [None]);
    }

    #[test]
    fn other_uses_are_another_resource() {
        let there = [offer(8, true, Some(1))];
        assert_eq!(shared(&there, &[wish(8, Some(1))]), [None]);
        let mut drawn = wish(8, Some(1));
        drawn.written.is_target = true;
        assert_eq!(shared(&[offer(8, false, Some(1))], &[drawn]), [None]);
    }
}
