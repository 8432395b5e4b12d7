//! `storegga plot`.

pub(super) mod fields;
pub(super) mod profiles;
mod reference;
mod series;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use super::exit::say;
use super::export::{open, unwritable};
use super::view_args::{PictureFormat, PlotArgs};
use crate::error::UserError;
use crate::figures::{Figure, save};
use crate::results::Results;
use crate::scene::document::nearest;
use reference::Reference;

/// Draws what is asked for: particles, series, profiles. Where nothing is, some of everything.
pub(super) fn plot(args: &PlotArgs) -> Result<ExitCode, UserError> {
    let results = open(&args.log)?;
    let out = Out { folder: args.out.clone().unwrap_or_else(|| default_folder(&args.log)), format: args.format };
    let is_open = args.fields.is_empty() && args.series.is_empty() && args.profiles.is_empty();
    if args.reference.is_some() && args.series.len() + args.profiles.len() != 1 {
        let message = "--reference needs one --series or one --profile to be compared with";
        return Err(UserError::plain(message));
    }
    let reference = args.reference.as_deref().map(Reference::read).transpose()?;
    out.make()?;
    if is_open {
        fields::draw(&results, args, &fields::usual(&results), &out)?;
        series::draw_all(&results, &out)?;
    }
    fields::draw(&results, args, &args.fields, &out)?;
    for wanted in &args.series {
        series::draw(&results, wanted, reference.as_ref(), args.points, &out)?;
    }
    for wanted in &args.profiles {
        profiles::draw(&results, args, wanted, reference.as_ref(), &out)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// `plots/<log>`.
pub(super) fn default_folder(log: &Path) -> PathBuf {
    Path::new("plots").join(log.file_stem().unwrap_or(log.as_os_str()))
}

/// Where figures go, and as what.
pub(super) struct Out {
    pub folder: PathBuf,
    pub format: PictureFormat,
}

impl Out {
    /// Makes the folder.
    pub fn make(&self) -> Result<(), UserError> {
        std::fs::create_dir_all(&self.folder).map_err(|error| unwritable(&self.folder, &error))
    }

    /// Writes a figure under `name`, and says so.
    pub fn write(&self, name: &str, figure: &impl Figure) -> Result<(), UserError> {
        for extension in self.format.extensions() {
            let path = self.folder.join(name.replace(['/', ':', '='], "_")).with_added_extension(extension);
            save(figure, &path).map_err(|what| UserError::plain(format!("cannot write {}: {what}", path.display())))?;
            say(&format!("{}\n", path.display()));
        }
        Ok(())
    }
}

/// The complaint about a `name` of a `what` that the log does not have.
pub(super) fn unknown<'a>(what: &str, name: &str, known: impl Iterator<Item = &'a str> + Clone) -> UserError {
    let error = UserError::plain(format!("the log has no {what} `{name}`"));
    let all = known.clone().collect::<Vec<_>>().join(", ");
    match nearest(name, known) {
        Some(candidate) => error.help(format!("did you mean `{candidate}`?")),
        None => error.help(format!("it has {all}")),
    }
}

/// The frames to draw: those nearest to the given times (s), or the last.
fn numbers(results: &Results, topic: &str, times: &[f64]) -> Result<Vec<usize>, UserError> {
    let count = results.frame_times(topic).len();
    if count == 0 {
        return Err(UserError::plain(format!("{} has no frames of particles", results.path().display())));
    }
    let last = results.frame_times(topic)[count - 1];
    if let Some(late) = times.iter().find(|time| **time > last + 1e-9 || **time < 0.0) {
        return Err(UserError::plain(format!("--at {late}: the log has frames from 0 to {last} s")));
    }
    if times.is_empty() {
        return Ok(vec![count - 1]);
    }
    Ok(times.iter().filter_map(|time| results.nearest_frame(topic, *time)).collect())
}
