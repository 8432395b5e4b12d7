//! `storegga runout`.

use std::io;
use std::process::ExitCode;

use super::exit::say;
use super::export::{open, unwritable};
use super::plot::{Out, default_folder, unknown};
use super::view_args::RunoutArgs;
use crate::error::UserError;
use crate::figures::{Curve, LineFigure, Marks};
use crate::number::short;
use crate::replace::replace;
use crate::results::{BODIES, BULK, COLUMN, Envelope, Extent, Frame, PARTICLES, Results, center_height, upper_surface};

/// Says how far a phase has come, what it leaves, and how high the water stood.
pub(super) fn runout(args: &RunoutArgs) -> Result<ExitCode, UserError> {
    let results = open(&args.log)?;
    let phase = phase(&results, args.phase.as_deref())?;
    let direction = direction(args, &results)?;
    let seen = Seen::of(&results, phase, direction)?;
    let name = results.facts.phases.get(phase).map_or("fluid", String::as_str);
    say(&told(args, &results, name, &seen));
    let out = Out { folder: args.out.clone().unwrap_or_else(|| default_folder(&args.log)), format: args.format };
    out.make()?;
    write(&results, name, &seen, &out)?;
    Ok(ExitCode::SUCCESS)
}

/// The unit vector along which it slides, in the plane or in space.
fn direction(args: &RunoutArgs, results: &Results) -> Result<[f64; 3], UserError> {
    let mut direction = args.direction.unwrap_or([1.0, 0.0, 0.0]);
    direction[results.facts.dimension.min(3)..].fill(0.0);
    let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !length.is_normal() {
        return Err(UserError::plain("--direction: expected a direction in the plane of the log, such as 1,0"));
    }
    Ok(direction.map(|x| x / length))
}

/// The phase called `name`, or the only one.
fn phase(results: &Results, name: Option<&str>) -> Result<usize, UserError> {
    let phases = &results.facts.phases;
    match name {
        Some(name) => {
            let found = phases.iter().position(|known| known == name);
            found.ok_or_else(|| unknown("phase", name, phases.iter().map(String::as_str)))
        }
        None if phases.len() == 1 => Ok(0),
        None => Err(UserError::plain("there are several phases: say which slides with --phase")
            .help(format!("they are {}", phases.join(", ")))),
    }
}

/// What the frames show.
struct Seen {
    extents: Vec<Extent>,
    /// Height (m) of the centre in the first and the last frame.
    heights: [f64; 2],
    /// Upper surface of the phase in the first and the last frame.
    outlines: [Vec<[f64; 2]>; 2],
    envelope: Envelope,
}

impl Seen {
    fn of(results: &Results, phase: usize, direction: [f64; 3]) -> Result<Self, UserError> {
        let facts = &results.facts;
        let mut seen: Option<Self> = None;
        let outline = |frame: &Frame| upper_surface(frame, phase, facts.up, facts.spacing);
        let read = results.frames(
            PARTICLES,
            |_| true,
            |_, frame| {
                let height = center_height(&frame, phase, facts.up).unwrap_or(f64::NAN);
                let seen = seen.get_or_insert_with(|| Self {
                    extents: Vec::new(),
                    heights: [height; 2],
                    outlines: [outline(&frame), Vec::new()],
                    envelope: Envelope::from(&frame, facts.dimension, facts.up, facts.spacing),
                });
                seen.extents.extend(Extent::of(&frame, phase, direction));
                seen.heights[1] = height;
                seen.outlines[1] = outline(&frame);
                seen.envelope.enter(&frame);
                Ok(())
            },
        );
        read.map_err(|error| UserError::plain(error.to_string()))?;
        match seen {
            Some(seen) if !seen.extents.is_empty() => Ok(seen),
            _ => Err(UserError::plain(format!("{} has no frames of that phase", results.path().display()))),
        }
    }

    /// Greatest velocity (m/s) of the bulk's front between two frames, and the middle of its time (s).
    fn greatest_velocity(&self) -> Option<(f64, f64)> {
        let between = self.extents.windows(2).map(|pair| {
            let duration = pair[1].time - pair[0].time;
            ((pair[1].bulk_front - pair[0].bulk_front) / duration, 0.5 * (pair[0].time + pair[1].time))
        });
        between.max_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// The level axis beside x.
fn across(results: &Results) -> &'static str {
    if results.facts.up == 1 && results.facts.dimension == 3 { "z" } else { "y" }
}

fn told(args: &RunoutArgs, results: &Results, name: &str, seen: &Seen) -> String {
    let (Some(start), Some(end)) = (seen.extents.first(), seen.extents.last()) else { return String::new() };
    let mut told = format!(
        "{}: `{name}` along ({}), from {} to {} s, {} frames\n",
        args.log.display(),
        args.direction.unwrap_or([1.0, 0.0, 0.0])[..results.facts.dimension]
            .iter()
            .map(|x| short(*x))
            .collect::<Vec<_>>()
            .join(", "),
        short(start.time),
        short(end.time),
        seen.extents.len(),
    );
    told.push_str(&format!("  {:<38}{:>12}{:>12}{:>12}\n", "", "start (m)", "end (m)", "way (m)"));
    let mut row = |name: &str, from: f64, to: f64| {
        told.push_str(&format!("  {name:<38}{:>12}{:>12}{:>12}\n", short(from), short(to), short(to - from)));
    };
    row("front, foremost particle", start.front, end.front);
    row(&format!("front of {} % of it", short(100.0 * BULK)), start.bulk_front, end.bulk_front);
    row("centre of mass", start.center, end.center);
    row("height of the centre of mass", seen.heights[0], seen.heights[1]);
    row("rear", start.rear, end.rear);
    row("length, rear to front", start.front - start.rear, end.front - end.rear);
    if let Some((velocity, time)) = seen.greatest_velocity() {
        told.push_str(&format!(
            "  front of {} %: at most {} m/s, at {} s (between frames)\n",
            short(100.0 * BULK),
            short(velocity),
            short(time)
        ));
    }
    let columns = || seen.envelope.columns();
    let highest = columns().max_by(|a, b| a.1.highest.0.total_cmp(&b.1.highest.0));
    let lowest = columns().min_by(|a, b| a.1.lowest.0.total_cmp(&b.1.lowest.0));
    for (word, found) in [
        ("highest", highest.map(|(place, of)| (place, of.highest))),
        ("lowest", lowest.map(|(place, of)| (place, of.lowest))),
    ] {
        if let Some((place, (elevation, time))) = found {
            told.push_str(&format!(
                "  {word} wave elevation: {} m at x = {} m{}, {} s\n",
                short(elevation),
                short(place[0]),
                if results.facts.dimension == 3 {
                    format!(", {} = {} m", across(results), short(place[1]))
                } else {
                    String::new()
                },
                short(time)
            ));
        }
    }
    if columns().next().is_none() {
        told.push_str("  there is no wave elevation: no column is left between the walls\n");
    }
    if BODIES.iter().any(|topic| results.frame_times(topic).len() > 1) {
        told.push_str("  careful: walls or structures move; where they pass, elevations hold the volume that they take or leave\n");
    }
    told.push_str(&format!(
        "  elevations are those of columns {} spacings wide, in the frames of the log\n",
        short(COLUMN)
    ));
    told
}

fn write(results: &Results, name: &str, seen: &Seen, out: &Out) -> Result<(), UserError> {
    let title = results.facts.title.clone();
    let curve = |name: &str, points: Vec<[f64; 2]>, marks: Marks| Curve { name: name.to_owned(), points, marks };
    let over_time =
        |value: fn(&Extent) -> f64| seen.extents.iter().map(|extent| [extent.time, value(extent)]).collect();
    let bulk = format!("front of {} %", short(100.0 * BULK));
    let runout = LineFigure {
        title: title.clone(),
        axes: ["time (s)".to_owned(), format!("{name}: place along its way (m)")],
        curves: vec![
            curve("front", over_time(|extent| extent.front), Marks::Line),
            curve(&bulk, over_time(|extent| extent.bulk_front), Marks::Line),
            curve("centre of mass", over_time(|extent| extent.center), Marks::Line),
            curve("rear", over_time(|extent| extent.rear), Marks::Line),
        ],
        ..LineFigure::default()
    };
    out.write(&format!("{name}_runout"), &runout)?;
    let at = |k: usize| seen.extents.get(k).map_or(String::new(), |extent| format!("{} s", short(extent.time)));
    let outline = LineFigure {
        title: title.clone(),
        axes: ["x (m)".to_owned(), format!("upper surface of {name} (m)")],
        curves: vec![
            curve(&at(0), seen.outlines[0].clone(), Marks::Dashes),
            curve(&at(seen.extents.len() - 1), seen.outlines[1].clone(), Marks::Line),
        ],
        ..LineFigure::default()
    };
    out.write(&format!("{name}_outline"), &outline)?;
    let [highest, lowest] = seen.envelope.along_x();
    let envelope = LineFigure {
        title,
        axes: ["x (m)".to_owned(), "wave elevation (m)".to_owned()],
        curves: vec![curve("highest", highest, Marks::Line), curve("lowest", lowest, Marks::Line)],
        ..LineFigure::default()
    };
    out.write("wave_envelope", &envelope)?;
    let extents = seen.extents.iter().map(|e| vec![e.time, e.front, e.bulk_front, e.center, e.rear]);
    let names = ["time [s]", "front [m]", "bulk front [m]", "centre of mass [m]", "rear [m]"];
    table(out, &format!("{name}_runout.csv"), &names, extents)?;
    let rows = seen.outlines[1].iter().map(|point| point.to_vec());
    table(out, &format!("{name}_outline.csv"), &["x [m]", "height [m]"], rows)?;
    let rows =
        seen.envelope.columns().map(|([x, y], of)| vec![x, y, of.highest.0, of.highest.1, of.lowest.0, of.lowest.1]);
    let across = format!("{} [m]", across(results));
    let names = ["x [m]", &across, "highest [m]", "time of highest [s]", "lowest [m]", "time of lowest [s]"];
    table(out, "wave_envelope.csv", &names, rows)
}

/// Writes numbers as CSV, and says so.
fn table(out: &Out, name: &str, names: &[&str], rows: impl Iterator<Item = Vec<f64>>) -> Result<(), UserError> {
    let path = out.folder.join(name.replace(['/', ':', '='], "_"));
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut lines = rows.map(|row| row.iter().map(f64::to_string).collect::<Vec<_>>());
    let written = writer.write_record(names).and_then(|()| lines.try_for_each(|line| writer.write_record(line)));
    let bytes = written.map_err(io::Error::from).and_then(|()| writer.into_inner().map_err(|error| error.into_error()));
    bytes.and_then(|bytes| replace(&path, &bytes)).map_err(|error| unwritable(&path, &error))?;
    say(&format!("{}\n", path.display()));
    Ok(())
}
