//! A camera that is rolled by quarters, and its picture turned back.

use crate::{Camera, Picture};

/// The camera after so many quarters, its right side going up.
pub(in crate::case) fn camera(camera: &Camera, quarters: u32) -> Camera {
    let mut rolled = *camera;
    for _ in 0..quarters {
        (rolled.right, rolled.up) = (rolled.up, -rolled.right);
    }
    rolled
}

/// The picture of a rolled camera as the camera that is not rolled would see it.
pub(in crate::case) fn picture(picture: &Picture, quarters: u32) -> Picture {
    let (last_x, last_y) = (picture.width - 1, picture.height - 1);
    super::moved(picture, |x, y| match quarters % 4 {
        1 => [last_x - y, x],
        2 => [last_x - x, last_y - y],
        3 => [y, last_y - x],
        _ => [x, y],
    })
}
