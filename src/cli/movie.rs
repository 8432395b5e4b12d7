//! `storegga movie`.

use std::fs::{File, create_dir_all};
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use png::{BitDepth, ColorType, Encoder, Writer};

use super::exit::say;
use super::export::{open, unwritable};
use super::plot::default_folder;
use super::plot::fields::{Snapshot, figure};
use super::view_args::{Look, MovieArgs};
use crate::error::UserError;
use crate::figures::{FieldFigure, Figure, pixels};
use crate::log::LogError;
use crate::results::{PARTICLES, Results};

/// Draws the wanted frames of a log, one after the other, into an animation.
pub(super) fn movie(args: &MovieArgs) -> Result<ExitCode, UserError> {
    let results = open(&args.log)?;
    let usual = if results.facts.phases.len() > 1 { "phase" } else { "speed" };
    let field = args.field.as_deref().unwrap_or(usual);
    let path = args.out.clone().unwrap_or_else(|| default_file(&args.log, field));
    refuse_other_ending(&path)?;
    let times = results.frame_times(PARTICLES);
    let count = (0..times.len()).filter(|number| args.frames.take(&times, *number)).count();
    if count == 0 {
        return Err(UserError::plain(format!("{} has no frames of particles at these times", args.log.display()))
            .help("`storegga doctor` says which there are"));
    }
    // All frames share one scale and one frame, so they are looked at twice.
    let mut shared: Option<FieldFigure> = None;
    each_figure(&results, args, field, args.look, |figure| {
        match &mut shared {
            Some(shared) => shared.widen(&figure),
            None => shared = Some(figure),
        }
        Ok(())
    })?;
    let Some(shared) = shared else { return Ok(ExitCode::SUCCESS) };
    let mut film = Film::create(&path, shared.size(), count, args.fps)?;
    each_figure(&results, args, field, args.look, |figure| {
        let figure = FieldFigure { panels: figure.panels, ..shared.clone() };
        film.add(&figure)
    })?;
    film.finish()?;
    say(&format!("{}: {count} frames, {} a second\n", path.display(), args.fps));
    Ok(ExitCode::SUCCESS)
}

/// `plots/<log>/<field>_movie.png`.
fn default_file(log: &Path, field: &str) -> PathBuf {
    default_folder(log).join(format!("{field}_movie.png"))
}

/// Refuses a file whose name says that it is something else.
fn refuse_other_ending(path: &Path) -> Result<(), UserError> {
    let is = |ending: &std::ffi::OsStr| ["png", "apng"].iter().any(|known| ending.eq_ignore_ascii_case(known));
    if path.extension().is_some_and(is) {
        return Ok(());
    }
    let png = path.with_extension("png");
    let message = format!("the animation is an APNG: its name ends in .png or .apng, got {}", path.display());
    let other = path.with_extension(path.extension().unwrap_or("mp4".as_ref()));
    let help = format!("write {0}; `ffmpeg -i {0} {1}` makes another format of it", png.display(), other.display());
    Err(UserError::plain(message).help(help))
}

/// Calls `visit` with the figure of every wanted frame.
fn each_figure(
    results: &Results,
    args: &MovieArgs,
    field: &str,
    look: Look,
    mut visit: impl FnMut(FieldFigure) -> Result<(), UserError>,
) -> Result<(), UserError> {
    let times = results.frame_times(PARTICLES);
    let mut failure = None;
    let read = results.frames(
        PARTICLES,
        |number| args.frames.take(&times, number),
        |_, fluid| {
            let bodies = results.bodies_at(fluid.time)?;
            let drawn = figure(results, &[Snapshot { fluid, bodies }], field, look).and_then(&mut visit);
            drawn.map_err(|error| {
                let stop = LogError::new(results.path(), "draw", error.to_string());
                failure = Some(error);
                stop
            })
        },
    );
    read.map_err(|error| failure.unwrap_or_else(|| UserError::plain(error.to_string())))
}

/// An animation that is being written.
struct Film {
    path: PathBuf,
    writer: Writer<BufWriter<File>>,
}

impl Film {
    fn create(path: &Path, (width, height): (u32, u32), frames: usize, fps: u16) -> Result<Self, UserError> {
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            create_dir_all(folder).map_err(|error| unwritable(folder, &error))?;
        }
        let file = File::create(path).map_err(|error| unwritable(path, &error))?;
        let mut encoder = Encoder::new(BufWriter::new(file), width, height);
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(BitDepth::Eight);
        let frames = u32::try_from(frames).unwrap_or(u32::MAX);
        // Shown for ever, each frame for 1/fps seconds.
        let prepared = encoder.set_animated(frames, 0).and_then(|()| encoder.set_frame_delay(1, fps));
        let writer = prepared.and_then(|()| encoder.write_header());
        let writer = writer.map_err(|error| unwritable(path, &error.into()))?;
        Ok(Self { path: path.to_owned(), writer })
    }

    fn add(&mut self, figure: &impl Figure) -> Result<(), UserError> {
        let pixels = pixels(figure).map_err(|what| UserError::plain(format!("cannot draw a frame: {what}")))?;
        self.writer.write_image_data(&pixels).map_err(|error| unwritable(&self.path, &error.into()))
    }

    fn finish(self) -> Result<(), UserError> {
        self.writer.finish().map_err(|error| unwritable(&self.path, &error.into()))?;
        Ok(())
    }
}
