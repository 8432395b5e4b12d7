//! `storegga export`.

use std::fs::{File, create_dir_all};
use std::io::{BufWriter, Error, Write};
use std::path::Path;
use std::process::ExitCode;

use super::exit::say;
use super::view_args::{ExportArgs, Frames};
use crate::error::UserError;
use crate::log::LogError;
use crate::number::count;
use crate::results::{BODIES, PARTICLES, Results, write_collection, write_points};

/// Writes the frames of a log as files of VTK.
pub(super) fn export(args: &ExportArgs) -> Result<ExitCode, UserError> {
    let results = open(&args.log)?;
    let folder = args.vtk.as_path();
    let times = results.frame_times(PARTICLES);
    if !(0..times.len()).any(|number| args.frames.take(&times, number)) {
        return Err(UserError::plain(format!("{} has no frames of particles at these times", args.log.display()))
            .help("`storegga doctor` says which there are"));
    }
    create_dir_all(folder).map_err(|error| unwritable(folder, &error))?;
    for topic in [PARTICLES].iter().chain(&BODIES) {
        // Bodies that do not move have one frame, which is wanted whatever its time.
        let is_still = *topic != PARTICLES && results.frame_times(topic).len() == 1;
        let all = Frames { from: None, to: None, every: 1 };
        let files = export_topic(&results, topic, if is_still { &all } else { &args.frames }, folder)?;
        if files > 0 {
            let collection = folder.join(topic.trim_start_matches('/')).with_extension("pvd");
            let frames = if files == 1 { "frame" } else { "frames" };
            say(&format!("{}: {} {frames}\n", collection.display(), count(files as u64)));
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Opens a log for showing it.
pub(super) fn open(log: &Path) -> Result<Results, UserError> {
    Results::open(log).map_err(|error| UserError::plain(error.to_string()))
}

/// Writes the wanted frames of a topic, and what strings them together; how many there are.
fn export_topic(results: &Results, topic: &str, frames: &Frames, folder: &Path) -> Result<usize, UserError> {
    let (name, times) = (topic.trim_start_matches('/'), results.frame_times(topic));
    let mut files: Vec<(f64, String)> = Vec::new();
    let mut failure = None;
    let read = results.frames(
        topic,
        |number| frames.take(&times, number),
        |number, frame| {
            let file = format!("{name}_{number:05}.vtp");
            let path = folder.join(&file);
            files.push((frame.time, file));
            write(&path, |out| write_points(&frame, out)).map_err(|error| {
                failure = Some(unwritable(&path, &error));
                LogError::new(&path, "write", error)
            })
        },
    );
    read.map_err(|error| failure.unwrap_or_else(|| UserError::plain(error.to_string())))?;
    if !files.is_empty() {
        let path = folder.join(name).with_extension("pvd");
        let named = files.iter().map(|(time, file)| (*time, file.as_str()));
        write(&path, |out| write_collection(named, out)).map_err(|error| unwritable(&path, &error))?;
    }
    Ok(files.len())
}

/// Writes a file.
fn write(path: &Path, content: impl FnOnce(&mut BufWriter<File>) -> Result<(), Error>) -> Result<(), Error> {
    let mut out = BufWriter::new(File::create(path)?);
    content(&mut out)?;
    out.flush()
}

/// What is said of a file or folder that cannot be written.
pub(super) fn unwritable(path: &Path, error: &Error) -> UserError {
    UserError::plain(format!("cannot write {}: {error}", path.display()))
}
