//! What an advice comes to, in a sentence.

use super::{Advice, Measurement};

/// Half a level of a picture of 8 bits.
const UNSEEN: f64 = 0.5 / 255.0;

impl Advice {
    /// The coarsest measured step of a classification at which the error is not seen in 8 bits, and neither at finer ones.
    #[must_use]
    pub fn unseen_step(&self, classify: &str) -> Option<f64> {
        let of_it = |it: &&Measurement| it.classify == classify;
        let mut measured: Vec<&Measurement> = self.measured.iter().filter(of_it).collect();
        measured.sort_by(|a, b| a.step.total_cmp(&b.step));
        measured
            .into_iter()
            .take_while(|it| it.rmse <= UNSEEN)
            .last()
            .map(|it| it.step)
    }

    /// One sentence: which classification and step, which refinement of isosurfaces, how to store volume and gradients.
    #[must_use]
    pub fn sentence(&self) -> String {
        let sampling = self.sampling();
        let refinement = if self.field_step < 2.0 {
            "find isosurfaces by `cubic` (the field changes within two voxels)"
        } else {
            "find isosurfaces by `linear` (the field is smooth over two voxels)"
        };
        format!("{sampling}; {refinement}; {}.", self.storage())
    }

    /// Why there is no rule of a transfer function.
    pub(super) fn no_rule(&self) -> &'static str {
        let (low, high) = self.volume.range;
        if low < high {
            "no transfer function is read"
        } else {
            "all voxels are alike"
        }
    }

    fn sampling(&self) -> String {
        let Some(rule) = self.by_common_gradient else {
            let why = self.no_rule();
            let step = short(self.field_step.min(1.0));
            return format!(
                "Take steps of {step} voxels or less, half a cycle of the field, as {why}"
            );
        };
        if !self.measured.is_empty() {
            return match (self.unseen_step("post"), self.unseen_step("preintegrated_2d")) {
                (Some(post), Some(integrated)) if post >= integrated => {
                    format!("Classify by `post` at a step of {post}: its error is not seen in 8 bits")
                }
                (_, Some(integrated)) => format!(
                    "Classify by `preintegrated_2d` at a step of {integrated}: its error is not seen in 8 bits"
                ),
                (Some(post), None) => {
                    format!("Classify by `post` at a step of {post}: its error is not seen in 8 bits")
                }
                (None, None) => {
                    "Classify by `preintegrated_2d` at a step of a quarter and less: at all of those measured the \
                     error is seen in 8 bits"
                        .to_owned()
                }
            };
        }
        if rule.step >= 1.0 {
            format!(
                "Classify by `post` at a step of {}: the rule is kept almost everywhere",
                short(rule.step.min(2.0))
            )
        } else {
            format!(
                "Classify by `preintegrated_2d` at a step of {}, for which `post` would need {}",
                short(self.field_step.min(1.0)),
                short(rule.step)
            )
        }
    }

    fn storage(&self) -> String {
        let (low, high) = self.volume.range;
        let level = (high - low) / 255.0;
        let volume = match (self.volume.scalar_type, self.transfer) {
            ("uint8" | "int8", _) => "8 bits hold the volume",
            // Half a cycle of the transfer function within a level is not told apart.
            (_, Some(transfer)) if transfer.all * level > 0.5 => {
                "keep all bits of the volume (the transfer function changes within a level of 8)"
            }
            (_, Some(_)) => "8 bits would hold the volume for this transfer function",
            (_, None) => "keep the volume as it is",
        };
        // The codes of the root of a gradient's length: below 1/127² of the largest there are none.
        let is_weak = self.volume.gradient_median > 0.0
            && self.volume.gradient_median < 1e-3 * self.volume.gradient_max;
        let gradients = if is_weak {
            "store gradients as half floats (most are a thousandth of the largest and less)"
        } else {
            "gradients may be stored in 8 bits (within half a degree)"
        };
        format!("{volume}; {gradients}")
    }
}

/// A step as people write it.
fn short(step: f64) -> String {
    if step >= 0.1 {
        format!("{step:.2}")
    } else {
        format!("{step:.1e}")
    }
}
