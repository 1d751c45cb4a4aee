//! Histograms of volumes, counted once for each volume, beside the interface.

use std::sync::{Arc, OnceLock};

use volgraph_graph::Digest;
use volgraph_nodes::source::bricks::BricksSource;
use volgraph_nodes::source::volume::VolumeSource;
use volgraph_optics::{Domain, TransferFunction};
use volgraph_volume::{Histogram, Volume};

/// Bins of a histogram.
const BINS: usize = 256;

/// The histogram of the volume that was last asked for.
#[derive(Default)]
pub(crate) struct Histograms {
    last: Option<(Digest, Arc<OnceLock<Counted>>)>,
}

/// A volume's histogram, and the percentiles that the interface names.
pub(crate) struct Counted {
    pub histogram: Histogram,
    /// Percent, value.
    pub percentiles: Vec<(f64, f64)>,
}

impl Histograms {
    /// The histogram, once it is counted.
    pub fn of(
        &mut self,
        digest: Digest,
        volume: &Arc<Volume>,
        wake: &egui::Context,
    ) -> Option<Arc<OnceLock<Counted>>> {
        if let Some((known, counted)) = &self.last
            && *known == digest
        {
            return Some(Arc::clone(counted));
        }
        let counted = Arc::new(OnceLock::new());
        self.last = Some((digest, Arc::clone(&counted)));
        let (filled, volume, wake) = (Arc::clone(&counted), Arc::clone(volume), wake.clone());
        std::thread::spawn(move || {
            let histogram = volume.histogram(BINS);
            let statistics = volume.statistics();
            let percentiles = [1.0, 25.0, 50.0, 75.0, 99.0].map(|p| (p, statistics.percentile(p)));
            let _ = filled.set(Counted {
                histogram,
                percentiles: percentiles.to_vec(),
            });
            wake.request_repaint();
        });
        Some(counted)
    }
}

/// The scalars of a transfer function's domain, from and to data values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    low: f64,
    width: f64,
}

impl Scale {
    /// Of this transfer function over this volume, whose values have this range: of one in bricks, that of all levels.
    pub fn of(transfer: &TransferFunction, volume: &Volume, range: Option<(f64, f64)>) -> Self {
        let data = range.unwrap_or((0.0, 1.0));
        let (low, high) = match transfer.domain() {
            Domain::Data => (0.0, 1.0),
            Domain::Range => data,
            Domain::Normalised => volume.voxels().scalar_type().range().unwrap_or(data),
        };
        let width = if high > low { high - low } else { 1.0 };
        Self { low, width }
    }

    /// The data value of a scalar.
    pub fn data(&self, scalar: f64) -> f64 {
        self.low + scalar * self.width
    }

    /// The scalar of a data value.
    pub fn scalar(&self, data: f64) -> f64 {
        (data - self.low) / self.width
    }
}

/// The share of the voxels that a transfer function lets be seen: those of which one voxel hides more than a thousandth.
pub(crate) fn visible_share(
    histogram: &Histogram,
    transfer: &TransferFunction,
    scale: Scale,
) -> f64 {
    let total: u64 = histogram.counts.iter().sum();
    let width = (histogram.hi - histogram.lo) / histogram.counts.len().max(1) as f64;
    let seen = histogram.counts.iter().enumerate().filter(|(bin, _)| {
        let data = histogram.lo + (*bin as f64 + 0.5) * width;
        transfer.opacity(scale.scalar(data)) > 1e-3
    });
    let seen: u64 = seen.map(|(_, count)| count).sum();
    seen as f64 / total.max(1) as f64
}

/// The range of all finite values of the first volume of a scene.
pub(crate) fn first_range(scene: &volgraph_engine::Scene) -> Option<(f64, f64)> {
    scene.sources.values().find_map(|source| {
        let any = source.as_any();
        match any.downcast_ref::<VolumeSource>() {
            Some(source) => source.volume.statistics().range(),
            None => any.downcast_ref::<BricksSource>()?.scalars().range,
        }
    })
}

/// The first volume of a scene: its name and itself; of one in bricks, a level that memory holds.
pub(crate) fn first_volume(
    scene: &volgraph_engine::Scene,
) -> Option<(String, Digest, Arc<Volume>)> {
    scene.sources.iter().find_map(|(name, source)| {
        let any = source.as_any();
        let volume = match any.downcast_ref::<VolumeSource>() {
            Some(source) => &source.volume,
            None => any.downcast_ref::<BricksSource>()?.overview()?,
        };
        Some((name.clone(), source.digest(), Arc::clone(volume)))
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn what_is_seen_is_counted_by_opacity() {
        let histogram = Histogram {
            lo: 0.0,
            hi: 10.0,
            counts: vec![60, 20, 10, 10],
        };
        let text = r##"(domain: data, points: [(at: 0, color: "#000000", opacity: 0), (at: 5, color: "#ffffff", opacity: 0),
            (at: 5, color: "#ffffff", opacity: 0.5), (at: 10, color: "#ffffff", opacity: 0.5)])"##;
        let transfer = TransferFunction::parse(Path::new("test.ron"), text).unwrap();
        let scale = Scale {
            low: 0.0,
            width: 1.0,
        };
        assert!((visible_share(&histogram, &transfer, scale) - 0.2).abs() < 1e-12);
        assert_eq!(scale.data(scale.scalar(3.0)), 3.0);
    }
}
