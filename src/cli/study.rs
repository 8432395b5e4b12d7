//! `storegga study`.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread;
use std::time::{Duration, Instant};

use bevy_app::PluginGroup;

use super::exit::{self, complain, say};
use super::number::{bytes, count, duration, short};
use super::study_args::{How, StudyArgs};
use super::study_frames;
use super::study_progress::StudyProgress;
use super::table::Table as Text;
use crate::app::StopFlag;
use crate::checkpoint::program_checksum;
use crate::error::UserError;
use crate::log::is_being_written;
use crate::scene::available_memory;
use crate::study::{
    Ended, Event, FigureFile, Left, Limits, Place, Plan, Row, Study, Table, Task, caption, execute, look, write_figures,
};

/// Runs what is not done of a study, and makes its table and figures.
pub(super) fn study<P: PluginGroup>(args: &StudyArgs, plugins: fn() -> P) -> Result<ExitCode, UserError> {
    let stop = exit::stop_on_interrupt();
    let folder = args.out.clone().unwrap_or_else(|| default_folder(&args.study));
    let Some((plan, place, shares)) = planned(&args.study, folder, &args.how, plugins, &stop)? else {
        return Ok(ExitCode::from(exit::INTERRUPTED));
    };
    if args.dry_run {
        say(&dry_run(&plan, &place, &shares, args.how.again));
        return Ok(ExitCode::SUCCESS);
    }
    let done = carried_out(plan, &place, &shares, &args.how, &stop)?;
    Ok(ExitCode::from(done.code))
}

/// A study, as far as it is done.
pub(super) struct Done {
    pub plan: Plan,
    pub rows: Vec<Row>,
    /// The figures as PNG.
    pub figures: Vec<FigureFile>,
    pub code: u8,
}

/// The study in `file` done in `folder`; none if it was stopped before its first run.
pub(super) fn done<P: PluginGroup>(
    file: &Path,
    folder: PathBuf,
    how: &How,
    plugins: fn() -> P,
    stop: &StopFlag,
) -> Result<Option<Done>, UserError> {
    let Some((plan, place, shares)) = planned(file, folder, how, plugins, stop)? else { return Ok(None) };
    carried_out(plan, &place, &shares, how, stop).map(Some)
}

fn planned<P: PluginGroup>(
    file: &Path,
    folder: PathBuf,
    how: &How,
    plugins: fn() -> P,
    stop: &StopFlag,
) -> Result<Option<(Plan, Place, Shares)>, UserError> {
    let study = Study::read(file, how.coarse)?;
    refuse_other_folder(&folder)?;
    let Some(plan) = Plan::new(study, plugins, stop)? else { return Ok(None) };
    let shares = Shares::of(how, &plan);
    let place = Place { folder, threads: shares.threads, checkpoint_every: how.checkpoint_every_wall };
    Ok(Some((plan, place, shares)))
}

fn carried_out(plan: Plan, place: &Place, shares: &Shares, how: &How, stop: &StopFlag) -> Result<Done, UserError> {
    let _lock = take_folder(&place.folder, plan.study.text())?;
    let mut rows = vec![Row::Waiting; plan.runs.len()];
    let tasks = tasks(&plan, place, how, &mut rows)?;
    let wrong = !how.no_run && run(&plan, tasks, place, shares, how.quiet, stop, &mut rows)?;
    let mut figures = write_figures(&plan, &rows, &place.folder)?;
    // Whatever becomes of a figure, the table is written.
    let frames = study_frames::write(&plan, &rows, place);
    let wrong = match frames {
        Ok(frames) => {
            figures.extend(frames);
            wrong
        }
        Err(error) => {
            exit::report(&error);
            true
        }
    };
    figures.sort();
    let described = |(k, file): (usize, String)| FigureFile { number: k + 1, file, caption: caption(&plan, k) };
    let figures: Vec<FigureFile> = figures.into_iter().map(described).collect();
    let table = Table { plan: &plan, rows: &rows };
    table.write_csv(&place.folder.join("table.csv"))?;
    table.write_markdown(&place.folder.join("table.md"), &figures)?;
    if !how.quiet {
        say(&shown(&table, &place.folder, &figures));
    }
    let code = code(&rows, wrong, how.no_run, stop);
    Ok(Done { plan, rows, figures, code })
}

/// `runs/<study>`.
fn default_folder(study: &Path) -> PathBuf {
    Path::new("runs").join(study.file_stem().unwrap_or(study.as_os_str()))
}

/// The file by which the folder of a study is known. It has the study's text, and is locked while a start is at work.
const MARK: &str = ".study.ron";

/// Refuses a folder with other things in it.
fn refuse_other_folder(folder: &Path) -> Result<(), UserError> {
    let mut entries = fs::read_dir(folder).into_iter().flatten();
    if folder.join(MARK).is_file() || entries.next().is_none() {
        return Ok(());
    }
    let message = format!("{} is not the folder of a study, and not empty", folder.display());
    Err(UserError::plain(message).help("choose another folder with --out"))
}

/// Makes the folder, and keeps other starts out of it as long as the file is open.
fn take_folder(folder: &Path, text: &str) -> Result<File, UserError> {
    let fail = |error: std::io::Error| {
        let message = format!("cannot write into the folder {}: {error}", folder.display());
        UserError::plain(message).help("choose another folder with --out")
    };
    fs::create_dir_all(folder).map_err(fail)?;
    let mut mark = File::options().write(true).create(true).truncate(false).open(folder.join(MARK)).map_err(fail)?;
    if mark.try_lock().is_err() {
        let message = format!("another study is at work in {}", folder.display());
        return Err(UserError::plain(message).help("wait for its end, or choose another folder with --out"));
    }
    mark.set_len(0).and_then(|()| mark.write_all(text.as_bytes())).map_err(fail)?;
    Ok(mark)
}

/// How processors and memory are shared.
struct Shares {
    limits: Limits,
    threads: usize,
}

/// Part of the free memory that runs may take.
const USABLE: f64 = 0.9;

impl Shares {
    fn of(args: &How, plan: &Plan) -> Self {
        let processors = thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let memory = USABLE * available_memory();
        let fitting = fitting(plan.runs.iter().map(|run| run.memory).collect(), memory);
        let usual = (processors / args.threads.map_or(1, usize::from)).clamp(1, fitting);
        let jobs = args.jobs.map_or(usual, usize::from).min(plan.runs.len()).max(1);
        let threads = args.threads.map_or(processors / jobs, usize::from).max(1);
        Self { limits: Limits { jobs, memory }, threads }
    }
}

/// How many of the largest runs, of so many bytes each, fit into `memory` together; one at least.
fn fitting(mut needs: Vec<f64>, memory: f64) -> usize {
    needs.sort_by(|a, b| b.total_cmp(a));
    let mut sum = 0.0;
    let fit = needs.iter().take_while(|need| {
        sum += **need;
        sum <= memory
    });
    fit.count().max(1)
}

/// What is left of a run, once no process of an earlier start writes its log any more.
fn settled(plan: &Plan, place: &Place, k: usize) -> Result<Left, UserError> {
    /// How long (s) a run may take to stop whose study was killed.
    const PATIENCE: Duration = Duration::from_secs(60);
    let (log, started) = (place.log(plan, k), Instant::now());
    while is_being_written(&log) {
        if started.elapsed() > PATIENCE {
            return Err(UserError::plain(format!("another run is writing {}", log.display())));
        }
        thread::sleep(Duration::from_millis(100));
    }
    Ok(look(&plan.runs[k], &log))
}

/// What is to be done; the rows of what is done already are filled in.
fn tasks(plan: &Plan, place: &Place, args: &How, rows: &mut [Row]) -> Result<Vec<Task>, UserError> {
    let (mut tasks, mut other_builds, program) = (Vec::new(), 0, program_checksum());
    for (run, row) in rows.iter_mut().enumerate() {
        let left = settled(plan, place, run)?;
        let name = &plan.runs[run].name;
        let tell = |what: &str| {
            if !args.quiet {
                complain(&format!("{name}: {what}\n"))
            }
        };
        match left {
            Left::Finished(finished) if !args.again => {
                let record = finished.record.as_ref();
                other_builds += usize::from(record.is_some_and(|record| record.program != program));
                *row = Row::of(plan, finished, &place.log(plan, run))?;
                continue;
            }
            Left::Unfinished(_, time) if !args.again => {
                tell(&format!("goes on from t = {} s", short(time)));
                *row = Row::Interrupted;
                tasks.push(Task { run, goes_on: true });
                continue;
            }
            Left::Nothing(Some(why)) => tell(&format!("is run again: {why}")),
            _ => {}
        }
        tasks.push(Task { run, goes_on: false });
    }
    if other_builds > 0 {
        let what = "of another build of this version; if it computes otherwise, --again runs them again";
        complain(&format!("Warning: {other_builds} of the runs that are done are {what}\n"));
    }
    if !args.quiet {
        let done = rows.len() - tasks.len();
        complain(&format!("{} runs, {done} done before, {} to do\n", rows.len(), tasks.len()));
    }
    Ok(tasks)
}

/// Does the tasks and fills in their rows; whether a run was refused.
fn run(
    plan: &Plan,
    mut tasks: Vec<Task>,
    place: &Place,
    shares: &Shares,
    is_quiet: bool,
    stop: &StopFlag,
    rows: &mut [Row],
) -> Result<bool, UserError> {
    let jobs = shares.limits.jobs;
    if jobs > 1 {
        // The longest first, or it would go on alone at the end.
        tasks.sort_by(|a, b| plan.runs[b.run].duration.total_cmp(&plan.runs[a.run].duration));
    }
    let mut progress = StudyProgress::new(plan, &tasks, jobs, is_quiet);
    let mut is_refused = false;
    let done = execute(plan, tasks, place, shares.limits, stop, |event| {
        match event {
            Event::Started(task) => progress.start(task.run),
            Event::Passing(running) => progress.pass(running),
            Event::Warned(task, what) => progress.tell(&format!("{}: warning: {what}", plan.runs[task.run].name)),
            Event::Anew(task, why) => {
                progress.tell(&format!("{}: is run again: {why}", plan.runs[task.run].name));
                progress.wait(task.run);
            }
            Event::Ended(task, ended) => {
                let log = place.log(plan, task.run);
                is_refused |= matches!(ended, Ended::Failed(Some(2), _));
                let row = row(plan, task.run, &log, ended, stop)?;
                let what = if let Row::Failed(why) = &row { format!("failed: {why}") } else { row.word().to_owned() };
                progress.end(task.run, &what, row.wall());
                rows[task.run] = row;
                Table { plan, rows }.write_csv(&place.folder.join("table.csv"))?;
            }
        }
        Ok(())
    });
    progress.finish();
    done.map(|()| is_refused)
}

/// The row of a run that has just ended.
fn row(plan: &Plan, run: usize, log: &Path, ended: Ended, stop: &StopFlag) -> Result<Row, UserError> {
    match (look(&plan.runs[run], log), ended) {
        // A run that was stopped before it could hear of it.
        (Left::Unfinished(..) | Left::Nothing(_), Ended::Failed(None, _)) if stop.is_set() => Ok(Row::Interrupted),
        (_, Ended::Failed(_, why)) => Ok(Row::Failed(why)),
        (Left::Finished(finished), Ended::ByItself) => Row::of(plan, finished, log),
        (_, Ended::ByItself) if stop.is_set() => Ok(Row::Interrupted),
        (Left::Nothing(why), Ended::ByItself) => Ok(Row::Failed(why.unwrap_or_else(|| "it left no log".to_owned()))),
        (Left::Unfinished(..), Ended::ByItself) => Ok(Row::Interrupted),
    }
}

/// `is_left`: whether nothing was to be run.
fn code(rows: &[Row], is_refused: bool, is_left: bool, stop: &StopFlag) -> u8 {
    let any = |is: fn(&Row) -> bool| rows.iter().any(is);
    if stop.is_set() || (!is_left && any(|row| matches!(row, Row::Interrupted))) {
        exit::INTERRUPTED
    } else if is_refused {
        exit::WRONG_INPUT
    } else if any(|row| matches!(row, Row::Failed(_))) {
        exit::FAILED
    } else if any(|row| matches!(row, Row::Diverged(_))) {
        exit::DIVERGED
    } else {
        0
    }
}

/// The table on a terminal, and what was written.
fn shown(table: &Table<'_>, folder: &Path, figures: &[FigureFile]) -> String {
    let mut lines = table.lines().into_iter();
    let head = lines.next().unwrap_or_default();
    let mut text = Text::new(head.iter().map(String::as_str));
    lines.for_each(|line| text.push(line));
    let files = ["table.csv", "table.md"].into_iter().chain(figures.iter().map(|figure| &*figure.file));
    let files: String = files.map(|file| format!("{}\n", folder.join(file).display())).collect();
    text.render() + &files
}

/// What would be run.
fn dry_run(plan: &Plan, place: &Place, shares: &Shares, again: bool) -> String {
    let mut text = Text::new(["run", "particles", "memory", "duration", ""]);
    for (k, run) in plan.runs.iter().enumerate() {
        let all = run.particles.fluid + run.particles.wall + run.particles.structure;
        let what = match look(run, &place.log(plan, k)) {
            _ if again => "to run".to_owned(),
            Left::Finished(finished) => (if finished.has_diverged { "diverged" } else { "done" }).to_owned(),
            Left::Unfinished(_, time) => format!("goes on from t = {} s", short(time)),
            Left::Nothing(None) => "to run".to_owned(),
            Left::Nothing(Some(why)) => format!("to run again: {why}"),
        };
        let estimate = duration(run.duration / shares.threads as f64);
        text.push([run.name.clone(), count(all as u64), bytes(run.memory), estimate, what]);
    }
    let Limits { jobs, memory } = shares.limits;
    let threads = super::summary::threads(shares.threads);
    let at_once =
        format!("Up to {jobs} at once, on {threads} each, in {} of memory; durations are estimates.\n", bytes(memory));
    text.render() + &at_once
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_run_at_once_as_fit_together() {
        assert_eq!(fitting(vec![1.0, 4.0, 3.0], 7.5), 2);
        assert_eq!(fitting(vec![1.0, 4.0, 3.0], 8.0), 3);
        assert_eq!(fitting(vec![9.0], 8.0), 1);
    }

    #[test]
    fn the_folder_is_named_after_the_study() {
        assert_eq!(default_folder(Path::new("studies/slide.ron")), Path::new("runs/slide"));
    }
}
