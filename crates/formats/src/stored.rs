//! Elements that lie along the axes of a file: read step by step, or left where they are as one run.

use std::path::PathBuf;

use volgraph_volume::{ScalarType, VolumeError, Voxels};

use crate::axes::Axes;
use crate::contents::Data;
use crate::load::Limits;
use crate::rescale::Rescale;
use crate::stream::Job;

/// Plain elements that lie in one run of a file, which was seen to hold all of them.
#[derive(Clone, Debug)]
pub(crate) struct FileRun {
    pub file: PathBuf,
    /// Bytes before the first element.
    pub offset: u64,
    pub count: u64,
    pub scalar_type: ScalarType,
    pub big_endian: bool,
    /// What is done to the elements.
    pub rescale: Option<Rescale>,
}

/// A job whose elements lie along the axes of a file.
pub(crate) struct Stored<'a> {
    pub job: Job<'a>,
    pub axes: Axes,
    /// What is done to the values; its stored type is that of the job.
    pub rescale: Option<Rescale>,
}

impl Data for Stored<'_> {
    fn read(&self, step: u32, limits: &Limits) -> Result<Voxels, VolumeError> {
        let values = match self.axes.run_of_step(step) {
            Some(run) => self.job.read(run, limits)?,
            None => {
                let all = self.job.read((0, self.job.count), limits)?;
                self.axes.step(all, step)
            }
        };
        Ok(match &self.rescale {
            Some(rescale) => rescale.apply(values),
            None => values,
        })
    }

    fn run(&self, step: u32, limits: &Limits) -> Result<Option<FileRun>, VolumeError> {
        let (Some((from, count)), true) = (self.axes.run_of_step(step), self.axes.is_plain())
        else {
            return Ok(None);
        };
        let ([piece], Some(start)) = (self.job.pieces.as_slice(), self.job.plain_start(limits)?)
        else {
            return Ok(None);
        };
        Ok(Some(FileRun {
            file: piece.input.path.clone(),
            offset: start + from * self.job.scalar_type.size() as u64,
            count,
            scalar_type: self.job.scalar_type,
            big_endian: self.job.big_endian,
            rescale: self.rescale,
        }))
    }
}
