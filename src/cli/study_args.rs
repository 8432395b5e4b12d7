//! The arguments of `storegga study`.

use std::path::PathBuf;

use clap::Args;

use super::args::wall_seconds;

/// Arguments of `storegga study`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  storegga study studies/slide_sensitivity.ron --dry-run
  storegga study studies/slide_sensitivity.ron
  storegga study studies/slide.ron --coarse
  storegga study studies/slide_sensitivity.ron --jobs 4 --threads 2 --out /data/slide

A study names a scene, the values that its fields take (every combination, or a list), the numbers that are taken of each run, and
figures. Every run is checked before the first one starts. In the folder are then a log for each run, table.csv for programs,
table.md for people, and the figures.

A study that was stopped, in whatever way, goes on when it is started again: what is done is not run again, and what was
interrupted goes on from its last checkpoint. A run is done if its log is whole and of the same scene, values, end and version.

Exit codes: 0 every run is done, 3 a run diverged, 1 a run failed, 2 a mistake in the study or a scene or output that cannot be written,
130 interrupted. The table has every run, however it ended.
docs/studies.md tells the whole story.")]
pub(super) struct StudyArgs {
    /// Study file.
    pub study: PathBuf,
    /// Folder for logs, table and figures; by default runs/<study>. It is made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// List the runs, with their particles and what they will need, and what is left of earlier starts; run nothing.
    #[arg(long)]
    pub dry_run: bool,
    #[command(flatten)]
    pub how: How,
}

/// How studies are run.
#[derive(Debug, Args)]
pub(super) struct How {
    /// Take the coarse values of a study, where it has any: to see in a minute that all of it works.
    #[arg(long)]
    pub coarse: bool,
    /// Runs at once; by default as many as processors and free memory allow.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,
    /// Threads of each run; by default the processors are shared among the runs that go on at once. The results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Run everything again, also what is done.
    #[arg(long)]
    pub again: bool,
    /// Run nothing: make table, figures and page of what is done.
    #[arg(long, conflicts_with = "again")]
    pub no_run: bool,
    /// Seconds of real time between the checkpoints of a run.
    #[arg(long, value_name = "SECONDS", default_value_t = 300.0, value_parser = wall_seconds)]
    pub checkpoint_every_wall: f64,
    /// No progress and no table; errors still go to standard error.
    #[arg(long, short)]
    pub quiet: bool,
}

/// Arguments of `storegga validate`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  storegga validate --coarse
  storegga validate --page docs/validation.md
  storegga validate --no-run --page docs/validation.md
  storegga validate studies/zhou_teng.ron --page docs/validation.md

Runs studies, one after the other, and writes one page of all: what each shows, its numbers beside what was asked for, its figures. What
is missed is shown as missed. Studies that were stopped go on when it is started again, and what is done is not run again. What the page has
of other studies stays: it is kept in section.json beside their figures.

Exit codes: 0 everything was done and met, 1 something was missed or a run failed, 2 a mistake in a study or a scene or output that cannot
be written, 3 a run diverged, 130 interrupted. Coarse runs are judged by `asked_coarse` alone.")]
pub(super) struct ValidateArgs {
    /// Study files, or folders with them.
    #[arg(default_value = "studies")]
    pub studies: Vec<PathBuf>,
    /// Folder for the logs, tables and figures of all of them.
    #[arg(long, value_name = "DIR", default_value = "runs/validation")]
    pub out: PathBuf,
    /// The page, in Markdown; its figures go into a folder of its name beside it, a folder for each study. By default validation.md in the folder of the logs.
    #[arg(long, value_name = "FILE")]
    pub page: Option<PathBuf>,
    #[command(flatten)]
    pub how: How,
}
