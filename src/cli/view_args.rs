//! The arguments of the commands that show what is in logs.

use std::path::PathBuf;

use clap::Args;

/// Which frames of a log.
#[derive(Debug, Clone, Args)]
pub(super) struct Frames {
    /// Only frames from this simulated time (s) on.
    #[arg(long, value_name = "SECONDS")]
    pub from: Option<f64>,
    /// Only frames up to this simulated time (s).
    #[arg(long, value_name = "SECONDS")]
    pub to: Option<f64>,
    /// Only every so many-th frame.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub every: u32,
}

impl Frames {
    /// Whether frame `number` of those at `times` (s) is meant.
    pub fn take(&self, times: &[f64], number: usize) -> bool {
        // Times in a log are rounded to nanoseconds.
        const ROUNDING: f64 = 1e-9;
        let Some(time) = times.get(number) else { return false };
        let first = times.iter().position(|time| self.from.is_none_or(|from| *time >= from - ROUNDING));
        let is_beat =
            first.is_some_and(|first| number >= first && (number - first).is_multiple_of(self.every as usize));
        is_beat && self.to.is_none_or(|to| *time <= to + ROUNDING)
    }
}

/// Arguments of `storegga export`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  storegga export runs/submarine_slide.mcap --vtk paraview
  storegga export runs/submarine_slide.mcap --vtk paraview --from 0.4 --to 0.8 --every 2

ParaView opens paraview/particles.pvd, walls.pvd and structures.pvd; the representation `Point Gaussian` shows particles as
discs. Python reads them with pyvista. Units are those of the log, SI; each file names them in its field data.")]
pub(super) struct ExportArgs {
    /// Log, whole or torn.
    pub log: PathBuf,
    /// Folder for the files of VTK: a .vtp for each frame, and a .pvd for particles, walls and structures. It is made if it
    /// does not exist.
    #[arg(long, value_name = "DIR")]
    pub vtk: PathBuf,
    #[command(flatten)]
    pub frames: Frames,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_counted_from_the_first_that_is_wanted() {
        let times = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5];
        let taken = |frames: Frames| (0..7).filter(|k| frames.take(&times, *k)).collect::<Vec<_>>();
        assert_eq!(taken(Frames { from: None, to: None, every: 1 }), [0, 1, 2, 3, 4, 5]);
        assert_eq!(taken(Frames { from: Some(0.1), to: Some(0.4), every: 2 }), [1, 3]);
        assert!(taken(Frames { from: Some(0.6), to: None, every: 1 }).is_empty());
    }
}
