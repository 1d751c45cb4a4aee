//! Labels beside points, where there is room.

use plotters::style::text_anchor::HPos;

/// Labels that are placed: their left, top, right and bottom.
#[derive(Default)]
pub struct Labels(Vec<[i32; 4]>);

impl Labels {
    /// Keeps labels off a point.
    pub fn keep(&mut self, (x, y): (i32, i32), radius: i32) {
        self.0
            .push([x - radius, y - radius, x + radius, y + radius]);
    }

    /// Where a label of the point goes: beside it, or a little higher or lower; nowhere where all of that is taken.
    pub fn place(&mut self, label: &str, (x, y): (i32, i32), side: HPos) -> Option<(i32, i32)> {
        let width = i32::try_from(label.chars().count()).ok()? * 7;
        for shift in [0, 10, -10, 16, 24, -18, 32] {
            let (at, left) = match side {
                HPos::Right => (x - 11, x - 11 - width),
                _ => (x + 11, x + 11),
            };
            let place = [left, y + shift - 7, left + width, y + shift + 7];
            let is_free = self.0.iter().all(|other| {
                place[0] >= other[2]
                    || place[2] <= other[0]
                    || place[1] >= other[3]
                    || place[3] <= other[1]
            });
            if is_free {
                self.0.push(place);
                return Some((at, y + shift));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_do_not_cover_each_other() {
        let mut labels = Labels::default();
        let first = labels.place("abcdef", (100, 100), HPos::Right).unwrap();
        let second = labels.place("abcdef", (102, 101), HPos::Right).unwrap();
        assert_eq!(first, (89, 100));
        assert!((second.1 - first.1).abs() >= 14);
        // In the end there is no room.
        let placed = (0..20).filter(|_| labels.place("abcdef", (100, 100), HPos::Right).is_some());
        assert!(placed.count() < 10);
    }
}
