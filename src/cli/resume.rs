//! `storegga resume`.

use std::process::ExitCode;

use bevy_app::PluginGroup;

use super::args::ResumeArgs;
use super::exit::{self, complain};
use super::number::{count, short};
use super::progress::Progress;
use super::run::show;
use super::simulate::{Settings, simulate};
use crate::app::open;
use crate::checkpoint::{Checkpoint, Origin};
use crate::error::UserError;
use crate::scene::open_document;

/// Goes on with a run from its checkpoint.
pub(super) fn resume<P: PluginGroup>(args: &ResumeArgs, plugins: fn() -> P) -> Result<ExitCode, UserError> {
    let checkpoint = Checkpoint::read(&args.checkpoint)?;
    let about = &checkpoint.about;
    if checkpoint.is_of_another_build() {
        let what =
            "the checkpoint was written by another build of this version; if it computes otherwise, so will the run";
        complain(&format!("Warning: {what}\n"));
    }
    let scene = checkpoint.find(&about.origin.scene);
    let document = open_document(&scene, &about.origin.overrides)?;
    checkpoint.check_scene(&document)?;
    let log = checkpoint.find(&about.origin.log);
    let stop = exit::stop_on_interrupt();
    exit::stop_at_end_of_input(args.input, &stop);
    let mut app = open(plugins(), document)?;
    if !args.shown.quiet {
        let place = format!("t = {} s, step {}", short(about.time), count(about.step));
        complain(&format!("going on with {} from {place}\n", scene.display()));
    }
    let origin = Origin { until: args.until.or(about.origin.until), ..about.origin.clone() };
    let settings = Settings {
        until: origin.until,
        log: Some(&log),
        warnings: Vec::new(),
        checkpoints: Some((args.checkpoint.clone(), origin)),
        resume: Some(&checkpoint),
        threads: args.threads.count(),
    };
    let outcome = simulate(&mut app, &settings, &stop, &mut Progress::new(args.shown.quiet))?;
    show(&scene, args.shown, &log, &outcome)
}
