//! Rays through the centres of pixels.

use glam::DVec3;

/// A ray: where it starts, and its unit direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// World position of the start.
    pub origin: DVec3,
    /// Unit world direction.
    pub direction: DVec3,
}

impl Ray {
    /// The world position at a distance.
    #[must_use]
    pub fn at(&self, distance: f64) -> DVec3 {
        self.origin + distance * self.direction
    }
}

/// The rays of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rays {
    /// World position of the eye.
    pub eye: DVec3,
    /// World direction to the right of the picture, a unit vector like the next two.
    pub right: DVec3,
    /// World direction to the top of the picture.
    pub up: DVec3,
    /// World direction into the picture.
    pub forward: DVec3,
    /// Half the width and height of the view: at distance 1 in perspective, in world units otherwise.
    pub half_extent: [f64; 2],
    /// Whether rays are parallel.
    pub is_orthographic: bool,
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
}

impl Rays {
    /// The ray through the centre of a pixel; `y` counts from the top.
    #[must_use]
    pub fn ray(&self, x: u32, y: u32) -> Ray {
        let [across, up] = self.place(x, y);
        let aside =
            self.right * (across * self.half_extent[0]) + self.up * (up * self.half_extent[1]);
        if self.is_orthographic {
            Ray {
                origin: self.eye + aside,
                direction: self.forward,
            }
        } else {
            Ray {
                origin: self.eye,
                direction: (self.forward + aside).normalize(),
            }
        }
    }

    /// World distance from a position to the eye, or to the eye's plane where rays are parallel.
    #[must_use]
    pub fn distance_to_eye(&self, world: DVec3) -> f64 {
        let from_eye = world - self.eye;
        if self.is_orthographic {
            from_eye.dot(self.forward).max(0.0)
        } else {
            from_eye.length()
        }
    }

    /// Where the centre of a pixel is in the picture: -1 to 1 to the right and to the top.
    #[must_use]
    pub fn place(&self, x: u32, y: u32) -> [f64; 2] {
        [
            (f64::from(x) + 0.5) / f64::from(self.size[0]) * 2.0 - 1.0,
            1.0 - (f64::from(y) + 0.5) / f64::from(self.size[1]) * 2.0,
        ]
    }
}
