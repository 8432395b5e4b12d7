//! `storegga doctor`.

use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;

use serde_json::{Value, json};

use super::args::DoctorArgs;
use super::exit::{self, say};
use super::number::{bytes, count, short};
use super::recover::{damage_object, damages};
use super::table::Table;
use crate::error::UserError;
use crate::log::{ChannelReport, Examination, examine_log};

/// Says what is in a log, and whether it is whole and has no gaps.
pub(super) fn doctor(args: &DoctorArgs) -> Result<ExitCode, UserError> {
    let found = examine_log(&args.log).map_err(|error| UserError::plain(error.to_string()))?;
    if args.json {
        say(&format!("{}\n", object(&args.log, &found)));
    } else {
        say(&text(&args.log, &found));
    }
    Ok(if found.is_healthy() { ExitCode::SUCCESS } else { ExitCode::from(exit::FAILED) })
}

/// `whole`, `torn` where the end is missing, or `damaged`.
fn state(found: &Examination) -> &'static str {
    let torn_at = found.ending.bytes;
    match found.damages.as_slice() {
        _ if found.ending.whole => "whole",
        damages if damages.iter().all(|damage| damage.offset + damage.bytes == torn_at) => "torn",
        _ => "damaged",
    }
}

fn text(log: &Path, found: &Examination) -> String {
    if found.is_empty() && !found.ending.whole {
        return format!(
            "{}: {}, and nothing in its {} can be read or recovered: only the beginning of a log is there\n  cannot be read:\n{}",
            log.display(),
            state(found),
            bytes(found.ending.bytes as f64),
            damages(&found.damages)
        );
    }
    let library = if found.library.is_empty() { "an unknown program" } else { &found.library };
    let mut text = format!("{}: {}, written by {library}\n", log.display(), state(found));
    let mut line = |name: &str, what: &str| {
        if !what.is_empty() {
            let _ = writeln!(text, "  {name:<9}{what}");
        }
    };
    line("title", found.entry("parameters", "title").unwrap_or_default().trim_matches('"'));
    line("run", &run(found));
    let [chunks, stored, unpacked] = found.chunks;
    let share = if unpacked > 0 { 100.0 * stored as f64 / unpacked as f64 } else { 100.0 };
    let size = bytes(found.ending.bytes as f64);
    line(
        "size",
        &format!("{size}; {chunks} chunks, compressed to {} % of {}", short(share.round()), bytes(unpacked as f64)),
    );
    let attached =
        found.attachments.iter().map(|(name, kind, size)| format!("{name} ({kind}, {})", bytes(*size as f64)));
    line("attached", &attached.collect::<Vec<_>>().join(", "));
    let records = found.metadata.iter().map(|(name, record)| format!("{name} ({})", record.len()));
    line("metadata", &records.collect::<Vec<_>>().join(", "));
    text += &channels(found);
    if !found.damages.is_empty() {
        text += "  cannot be read:\n";
        text += &damages(&found.damages);
        let _ = writeln!(text, "  `storegga recover {}` makes a whole log of what can be read", log.display());
    }
    text
}

/// How the run ended, and when.
fn run(found: &Examination) -> String {
    let time = found.entry("end", "time [s]").and_then(|time| time.parse().ok());
    let time = time.or(found.span().map(|span| span.1)).map_or_else(|| "?".to_owned(), short);
    let steps = found.entry("end", "step").map_or_else(String::new, |step| format!(" after {step} steps"));
    let until =
        found.entry("program", "until [s]").map_or_else(String::new, |until| format!(", asked to run to {until} s"));
    match found.run_end() {
        Some(how) => format!("{how} at t = {time} s{steps}{until}"),
        None => format!("the log does not say how the run ended; its last message is at t = {time} s{until}"),
    }
}

fn channels(found: &Examination) -> String {
    let mut table = Table::new(["channel", "messages", "size", "t (s)", "every (s)", "seen (s)", "missing", "gaps"]);
    let mut fields = String::new();
    for channel in &found.channels {
        let span = channel.span.map(seconds).map_or_else(|| "-".to_owned(), |(from, to)| range(from, to));
        let seen = channel.intervals.map(seconds).map_or_else(|| "-".to_owned(), |(least, most)| range(least, most));
        let expected = channel.expected.map_or_else(|| "-".to_owned(), |interval| short(interval as f64 / 1e9));
        table.push([
            channel.topic.clone(),
            count(channel.messages),
            bytes(channel.bytes as f64),
            span,
            expected,
            seen,
            count(channel.missing),
            count(channel.gaps),
        ]);
        if !channel.fields.is_empty() {
            let named = channel.fields.iter().map(|(name, unit)| match unit.as_str() {
                "" | "1" => name.clone(),
                unit => format!("{name} [{unit}]"),
            });
            let _ = writeln!(fields, "    {}: {}", channel.topic, named.collect::<Vec<_>>().join(", "));
        }
    }
    let fields = if fields.is_empty() { fields } else { format!("  fields\n{fields}") };
    table.render() + &fields
}

fn seconds((from, to): (u64, u64)) -> (f64, f64) {
    (from as f64 / 1e9, to as f64 / 1e9)
}

/// `0 to 0.5`, or one number if both are the same.
fn range(from: f64, to: f64) -> String {
    let (from, to) = (short(from), short(to));
    if from == to { from } else { format!("{from} to {to}") }
}

/// The same for programs. Times in s, sizes in bytes.
fn object(log: &Path, found: &Examination) -> Value {
    let [chunks, stored, unpacked] = found.chunks;
    json!({
        "log": log.display().to_string(),
        "state": state(found),
        "healthy": found.is_healthy(),
        "library": found.library,
        "end": found.run_end(),
        "span_s": found.span().map(|(from, to)| [from, to]),
        "bytes": found.ending.bytes,
        "chunks": {"count": chunks, "stored_bytes": stored, "unpacked_bytes": unpacked},
        "channels": found.channels.iter().map(channel_object).collect::<Vec<_>>(),
        "attachments": found.attachments.iter().map(|(name, media_type, bytes)| {
            json!({"name": name, "media_type": media_type, "bytes": bytes})
        }).collect::<Vec<_>>(),
        "metadata": found.metadata,
        "damages": found.damages.iter().map(damage_object).collect::<Vec<_>>(),
    })
}

fn channel_object(channel: &ChannelReport) -> Value {
    json!({
        "topic": channel.topic,
        "schema": channel.schema,
        "encoding": channel.encoding,
        "fields": channel.fields.iter().map(|(name, unit)| json!({"name": name, "unit": unit})).collect::<Vec<_>>(),
        "messages": channel.messages,
        "bytes": channel.bytes,
        "span_s": channel.span.map(seconds),
        "expected_interval_s": channel.expected.map(|interval| interval as f64 / 1e9),
        "intervals_s": channel.intervals.map(seconds),
        "missing": channel.missing,
        "gaps": channel.gaps,
    })
}
