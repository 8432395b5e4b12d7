//! The arguments of the command line.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand};

use super::study_args::{StudyArgs, ValidateArgs};
use super::view_args::{ExportArgs, ForcesArgs, MovieArgs, PlotArgs, RunoutArgs};

/// Simulates submarine landslides, the waves they raise, and the forces with which they hit structures.
#[derive(Debug, Parser)]
#[command(
    name = "storegga",
    version,
    after_help = "\
Examples:
  storegga run scenes/two_phase_tank.ron
  storegga check scenes/two_phase_tank.ron --set spacing=0.002
  storegga test

Exit codes: 0 done, 1 an expectation failed or a log is not whole, 2 wrong input or output that cannot be written,
3 the run diverged, 130 interrupted (Ctrl-C, SIGTERM)."
)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Run a scene and write its log.
    Run(RunArgs),
    /// Go on with a run that was stopped, from its last checkpoint.
    Resume(ResumeArgs),
    /// Run a scene with many values, and make a table and figures of what comes out.
    Study(StudyArgs),
    /// Run the studies that compare the program with the paper, measurements and exact solutions, and write one page of them.
    Validate(ValidateArgs),
    /// Say what a run of a scene would be like, without running it.
    Check(CheckArgs),
    /// Run scenes and compare them with their expectations.
    Test(TestArgs),
    /// List the scenes that are shipped.
    Scenes(ScenesArgs),
    /// Make a whole log of one that was torn or damaged.
    Recover(RecoverArgs),
    /// Say what is in a log, and whether it is whole and has no gaps.
    Doctor(DoctorArgs),
    /// Draw what is in a log: particles, series, profiles, beside references.
    Plot(PlotArgs),
    /// Draw every frame of a log, as an animation.
    Movie(MovieArgs),
    /// Judge the force on a structure: peak, mean, impulse, coefficients, raw and filtered.
    Forces(ForcesArgs),
    /// Say how far a slide has come, what it leaves, and how high the waves were.
    Runout(RunoutArgs),
    /// Write the frames of a log as files that ParaView opens.
    Export(ExportArgs),
    /// Print the page of every field of a scene in Markdown: meaning, unit, default, range.
    #[command(after_help = "\
Example:
  storegga reference > docs/scene.md

The page has what the plugins of this program read; docs/scene.md is that of the plugins that are shipped.")]
    Reference,
    /// Print the JSON Schema of scenes, for editors and for programs that write scenes.
    #[command(after_help = "\
Example:
  storegga schema > scene.schema.json

Scenes are RON. The schema has them as JSON: (a: 1) is {\"a\": 1}, (1, 2) is [1, 2], Name(a: 1) is {\"Name\": {\"a\": 1}}.
docs/scene.md says what works in which editor.")]
    Schema,
}

/// Arguments of `storegga run`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  storegga run scenes/two_phase_tank.ron --set spacing=0.008 --until 0.5
  storegga run scenes/two_phase_tank.ron --set phases.mud.rheology.yield_stress=500 --out runs/stiff.mcap
  storegga run scenes/two_phase_tank.ron --json | jq .updates_per_s
  storegga run scenes/submarine_slide.ron --checkpoint-every 0.1
  storegga run scenes/submarine_slide.ron --checkpoint-every-wall 600

With either of the last two, runs/submarine_slide.checkpoint always holds a state from which `storegga resume` goes on.
Checkpoints change nothing in the results. A run that has not ended is not lost to a new one of the same name: its checkpoint and its
log are kept, and a warning says how they are called.

The log is an MCAP file: Foxglove opens it, and so does every MCAP library.
docs/scene.md is the page of all fields of a scene, with their units and defaults.")]
pub(super) struct RunArgs {
    /// Scene file.
    pub scene: PathBuf,
    #[command(flatten)]
    pub overrides: Overrides,
    /// End the run at this simulated time (s) instead of the scene's; expectations are checked only if that is not earlier.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = positive_seconds)]
    pub until: Option<f64>,
    /// Log file; by default runs/<scene>.mcap. Its folder is made if it does not exist.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Write a checkpoint after every so many seconds of simulated time, beside the log: <log>.checkpoint, without the .mcap.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = positive_seconds)]
    pub checkpoint_every: Option<f64>,
    /// Write a checkpoint after every so many seconds of real time; goes together with the other one.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = wall_seconds)]
    pub checkpoint_every_wall: Option<f64>,
    #[command(flatten)]
    pub threads: Threads,
    #[command(flatten)]
    pub shown: Shown,
    #[command(flatten)]
    pub input: Input,
}

/// Arguments of `storegga resume`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  storegga run scenes/submarine_slide.ron --checkpoint-every 0.1      (killed, or the power failed)
  storegga resume runs/submarine_slide.checkpoint
  storegga resume runs/submarine_slide.checkpoint --until 3           (it ended at 2 s, and shall go on)

The run goes on to its end with the same bits as if it had not been stopped, with any number of threads, and goes on writing
checkpoints. Its log is continued in its place: messages of the old log that are later than the checkpoint are dropped, for the
run computes them again; the old log stays until everything up to the checkpoint is copied. Expectations are checked over the
whole run. With --until it has the bits of one run to that time.

Refused, with the reason: a checkpoint that is damaged, cut off, or of another version of the program or other plugins; a scene,
or a file that it reads, that has changed; a log that is gone or belongs to another run.
docs/restart.md tells the whole story.")]
pub(super) struct ResumeArgs {
    /// Checkpoint, as `storegga run --checkpoint-every` writes it.
    pub checkpoint: PathBuf,
    /// End the run at this simulated time (s), later or earlier than it was asked for at first; expectations are checked only if
    /// that is not earlier than the scene's end.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = positive_seconds)]
    pub until: Option<f64>,
    #[command(flatten)]
    pub threads: Threads,
    #[command(flatten)]
    pub shown: Shown,
    #[command(flatten)]
    pub input: Input,
}

/// Arguments of `storegga check`.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  storegga check scenes/two_phase_tank.ron --set spacing=0.002

docs/scene.md is the page of all fields of a scene, with their units and defaults.")]
pub(super) struct CheckArgs {
    /// Scene file.
    pub scene: PathBuf,
    #[command(flatten)]
    pub overrides: Overrides,
    #[command(flatten)]
    pub threads: Threads,
}

/// Arguments of `storegga test`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  storegga test                                  every scene in scenes/ that has expectations
  storegga test scenes/ci/*.ron                  these scenes
  storegga test scenes/two_phase_tank.ron --set spacing=0.008

Exit code 0 if every expectation is met, 1 if one is not, 2 if a scene is wrong.
docs/scene.md is the page of all fields of a scene; its section `expect` says what can be expected.")]
pub(super) struct TestArgs {
    /// Scene files; by default all in the folder of scenes that have expectations.
    pub scenes: Vec<PathBuf>,
    #[command(flatten)]
    pub folder: ScenesArgs,
    #[command(flatten)]
    pub overrides: Overrides,
    #[command(flatten)]
    pub threads: Threads,
    /// No progress.
    #[arg(long, short)]
    pub quiet: bool,
}

/// Arguments of `storegga scenes`.
#[derive(Debug, Args)]
pub(super) struct ScenesArgs {
    /// Folder of the scenes.
    #[arg(long = "scenes", value_name = "DIR", default_value = "scenes")]
    pub folder: PathBuf,
}

/// Arguments of `storegga recover`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  storegga recover runs/submarine_slide.mcap
  storegga recover runs/submarine_slide.mcap --out runs/slide_until_the_power_failed.mcap

Everything that was whole when the run ended is kept: that is at least everything up to the last frame of particles.
The log itself is only read.")]
pub(super) struct RecoverArgs {
    /// Log that was torn, as by a kill or a power cut, or damaged.
    pub log: PathBuf,
    /// Log to write; by default <log>.recovered.mcap beside it.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Print one JSON object to standard output, and nothing else there.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `storegga doctor`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  storegga doctor runs/submarine_slide.mcap
  storegga doctor runs/submarine_slide.mcap --json | jq .metadata.defaults

Missing are messages by their numbers, gaps are outputs that did not come at the scene's interval.
Exit code 0 if the log is whole and has neither, 1 if not, 2 if it is no log.")]
pub(super) struct DoctorArgs {
    /// Log, whole or torn.
    pub log: PathBuf,
    /// Print one JSON object to standard output, and nothing else there.
    #[arg(long)]
    pub json: bool,
}

/// Overrides of values of the scene.
#[derive(Debug, Args)]
pub(super) struct Overrides {
    /// Override a value of the scene, such as spacing=0.008, fluids.0.shape.max.1=0.5 or
    /// phases.mud.rheology.yield_stress=500; can be given again and again.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub set: Vec<String>,
}

/// What a run shows.
#[derive(Debug, Clone, Copy, Args)]
pub(super) struct Shown {
    /// Print one JSON object to standard output, and nothing else there.
    #[arg(long)]
    pub json: bool,
    /// No progress and no summary; errors and failed expectations still go to standard error.
    #[arg(long, short)]
    pub quiet: bool,
}

/// What standard input is for.
#[derive(Debug, Clone, Copy, Args)]
pub(super) struct Input {
    /// Stop as on Ctrl-C when standard input ends: for programs that start runs and must not leave them behind.
    #[arg(long)]
    pub stop_at_end_of_input: bool,
}

/// Number of threads.
#[derive(Debug, Args)]
pub(super) struct Threads {
    /// Number of threads; by default as many as the machine has. The results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

impl Threads {
    /// The number asked for, or that of the machine.
    pub fn count(&self) -> usize {
        let available = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        self.threads.map_or_else(available, usize::from)
    }
}

fn positive_seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds.is_finite() => Ok(seconds),
        _ => Err("expected a time in seconds greater than 0, such as 0.5".to_owned()),
    }
}

/// Seconds that a clock can measure.
pub(super) fn wall_seconds(text: &str) -> Result<f64, String> {
    let seconds = positive_seconds(text)?;
    match Duration::try_from_secs_f64(seconds) {
        Ok(_) => Ok(seconds),
        Err(_) => Err("no clock runs that long: expected a time in seconds, such as 600".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn times_are_positive_and_finite() {
        assert_eq!(positive_seconds("0.5"), Ok(0.5));
        for wrong in ["0", "-1", "nan", "inf", "soon", ""] {
            assert!(positive_seconds(wrong).is_err() && wall_seconds(wrong).is_err(), "{wrong}");
        }
        assert_eq!((wall_seconds("1e9"), positive_seconds("1e300")), (Ok(1e9), Ok(1e300)));
        assert!(wall_seconds("1e300").is_err());
    }
}
