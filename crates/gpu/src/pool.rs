//! Memory on the device. A plan asks for resources; what is held already with the content that one of them needs is
//! shared, and everything else is made anew, so that the plan before keeps what it has until the new one is proven.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, PoisonError};

use serde::Serialize;
use volgraph_graph::{Digest, Extent, ResourceKind, TileTag};
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
    /// Whether it is filled in tiles. Who looks at it sees to it that it has his own first.
    pub is_tiled: bool,
}

/// A resource on the device; clones share it.
#[derive(Clone, Debug)]
pub struct Held {
    /// What it is.
    pub resource: ResourceKind,
    /// How it is written. Part of its identity.
    pub written: Written,
    content: Arc<Mutex<Content>>,
    pub(crate) object: Object,
}

/// What a resource holds.
#[derive(Clone, Debug, Default)]
struct Content {
    /// The fingerprint of all of it: (writer's fingerprint, output port).
    whole: Option<(Digest, String)>,
    /// Of what is filled in tiles, how large they are, and which ones it has, by where they start.
    tile: Extent,
    tiles: BTreeMap<Extent, TileTag>,
}

#[derive(Clone, Debug)]
pub(crate) enum Object {
    Texture { texture: Texture, view: TextureView },
    Buffer(Buffer),
}

impl Held {
    /// The fingerprint of what it holds: (writer's fingerprint, output port).
    #[must_use]
    pub fn content(&self) -> Option<(Digest, String)> {
        self.with_content(|content| content.whole.clone())
    }

    /// Takes note of what it holds now.
    pub(crate) fn set_content(&mut self, whole: Option<(Digest, String)>) {
        if self.written.is_tiled {
            self.with_content(|content| content.whole = whole);
            return;
        }
        // A clone that another installation relies on holds what it held.
        self.content = Arc::new(Mutex::new(Content {
            whole,
            ..Content::default()
        }));
    }

    /// Takes note of how large tiles are from now on: others overlap with them.
    pub(crate) fn set_tile_extent(&self, extent: Extent) {
        self.with_content(|content| {
            if content.tile != extent {
                content.tile = extent;
                content.tiles.clear();
            }
        });
    }

    /// Whether a tile that starts here is there.
    pub(crate) fn has_tile(&self, origin: Extent, tag: TileTag) -> bool {
        self.with_content(|content| content.tiles.get(&origin) == Some(&tag))
    }

    /// Takes note of a tile that is written; `None` before it is.
    pub(crate) fn set_tile(&self, origin: Extent, tag: Option<TileTag>) {
        self.with_content(|content| match tag {
            Some(tag) => content.tiles.insert(origin, tag),
            None => content.tiles.remove(&origin),
        });
    }

    fn with_content<T>(&self, what: impl FnOnce(&mut Content) -> T) -> T {
        what(&mut self.content.lock().unwrap_or_else(PoisonError::into_inner))
    }

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
/// a node whose result is there already does not run. Only what is filled in tiles goes on whatever it holds, best with
/// what is wished, each to one wish.
#[must_use]
pub fn shared(held: &[Offer], wishes: &[Wish]) -> Vec<Option<usize>> {
    let holds = |wish: &Wish, content: &Option<(Digest, String)>| {
        wish.contents.len() == 1
            && content
                .as_ref()
                .is_some_and(|content| wish.contents.contains(content))
    };
    let fits = |wish: &Wish, (resource, written, _): &Offer| {
        *resource == wish.resource && *written == wish.written
    };
    let mut gone = BTreeSet::new();
    let mut taken = Vec::with_capacity(wishes.len());
    for wish in wishes {
        let mut offers = (0..held.len()).filter(|at| fits(wish, &held[*at]));
        let at = if wish.written.is_tiled {
            let free: Vec<usize> = offers.filter(|at| !gone.contains(at)).collect();
            let best = free.iter().find(|at| holds(wish, &held[**at].2));
            best.or(free.first()).copied()
        } else {
            offers.find(|at| holds(wish, &held[*at].2))
        };
        gone.extend(at.filter(|_| wish.written.is_tiled));
        taken.push(at);
    }
    taken
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
        content: Arc::default(),
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
            ..Written::default()
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
    fn what_is_filled_in_tiles_goes_on_with_one_wish_each() {
        let tiled = |offer: Offer| {
            let written = Written {
                is_tiled: true,
                ..offer.1
            };
            (offer.0, written, offer.2)
        };
        let held = [
            tiled(offer(8, false, Some(1))),
            tiled(offer(8, false, Some(2))),
            offer(8, false, Some(3)),
        ];
        let wishes = [2, 3, 4].map(|content| {
            let mut wish = wish(8, Some(content));
            wish.written.is_tiled = true;
            wish
        });
        assert_eq!(shared(&held, &wishes), [Some(1), Some(0), None]);
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
