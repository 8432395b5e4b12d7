//! The command line: what `storegga run`, `resume`, `study`, `validate`, `check`, `test`, `scenes`, `recover`, `doctor`, `plot`, `movie`, `forces`, `runout`, `export`,
//! `reference` and `schema` do.
//!
//! [`main`] is the whole program for any set of plugins, so that a program of one's own with further plugins is
//! `fn main() -> ExitCode { storegga::cli::main(|| MyPlugins) }`.

mod args;
mod check;
mod doctor;
mod exit;
mod export;
mod forces;
mod json;
mod movie;
mod plot;
mod progress;
mod recover;
mod resume;
mod run;
mod runout;
mod scenes;
mod schema;
mod simulate;
mod study;
mod study_args;
mod study_frames;
mod study_progress;
mod summary;
mod table;
mod test;
mod validate;
mod validation_page;
mod view_args;
mod warnings;

use std::process::ExitCode;

use bevy_app::PluginGroup;
use clap::Parser;

use crate::number;
use args::{Arguments, Command};

/// The program: reads the command line, does what it says and returns the exit code: 0 done, 1 an expectation failed or a log
/// is not whole, 2 the user's input or what cannot be written, 3 the run diverged, 101 a bug, 130 interrupted.
pub fn main<P: PluginGroup>(plugins: fn() -> P) -> ExitCode {
    exit::explain_panics();
    exit::hear_of_full_disks();
    let done = match Arguments::parse().command {
        Command::Run(args) => run::run(&args, plugins),
        Command::Resume(args) => resume::resume(&args, plugins),
        Command::Study(args) => study::study(&args, plugins),
        Command::Validate(args) => validate::validate(&args, plugins),
        Command::Check(args) => check::check(&args, plugins),
        Command::Test(args) => test::test(&args, plugins),
        Command::Scenes(args) => scenes::list(&args, plugins),
        Command::Recover(args) => recover::recover(&args),
        Command::Doctor(args) => doctor::doctor(&args),
        Command::Plot(args) => plot::plot(&args),
        Command::Movie(args) => movie::movie(&args),
        Command::Forces(args) => forces::forces(&args, plugins),
        Command::Runout(args) => runout::runout(&args),
        Command::Export(args) => export::export(&args),
        Command::Reference => schema::reference(plugins),
        Command::Schema => schema::schema(plugins),
    };
    exit::unless_unheard(done.unwrap_or_else(|error| exit::report(&error)))
}
