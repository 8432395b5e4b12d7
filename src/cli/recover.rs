//! `storegga recover`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::json;

use super::args::RecoverArgs;
use super::exit::say;
use super::number::{bytes, count, short};
use super::run::{make_folder, refuse_to_overwrite};
use super::table::Table;
use crate::error::UserError;
use crate::log::{Copied, Damage, recover_log};

/// Makes a whole log of a torn one, and says what is in it and what is not.
pub(super) fn recover(args: &RecoverArgs) -> Result<ExitCode, UserError> {
    let out = args.out.clone().unwrap_or_else(|| default_out(&args.log));
    refuse_to_overwrite(&out)?;
    make_folder(&out)?;
    let copied = recover_log(&args.log, &out).map_err(|error| {
        let wrong = UserError::plain(error.to_string());
        if error.path() == args.log { wrong } else { wrong.help("choose another file with --out") }
    })?;
    if args.json {
        say(&format!("{}\n", object(&args.log, &out, &copied)));
    } else {
        say(&text(&args.log, &out, &copied));
    }
    Ok(ExitCode::SUCCESS)
}

/// `<log>.recovered.mcap` beside the log.
fn default_out(log: &Path) -> PathBuf {
    log.with_extension("recovered.mcap")
}

fn text(log: &Path, out: &Path, copied: &Copied) -> String {
    let until = copied.last_time().map_or_else(String::new, |time| format!(" up to t = {} s", short(time)));
    let messages = count(copied.messages());
    let mut text = if copied.ending.whole {
        format!("{} was whole; {} has its {messages} messages{until}\n", log.display(), out.display())
    } else {
        format!("{}: {messages} messages{until} are kept in {}\n", log.display(), out.display())
    };
    let mut table = Table::new(["channel", "messages", "last (s)", "missing between"]);
    for channel in &copied.channels {
        let last = channel.last_time().map_or_else(|| "-".to_owned(), short);
        table.push([channel.topic.clone(), count(channel.messages), last, count(channel.missing)]);
    }
    text += &table.render();
    if !copied.damages.is_empty() {
        let size = bytes(copied.ending.bytes as f64);
        text += &format!("  lost: {} of {size}\n", bytes(copied.lost_bytes as f64));
        text += &damages(&copied.damages);
    }
    text
}

/// Most damages that are told one by one.
const TOLD: usize = 10;

/// A line for each part that cannot be read.
pub(super) fn damages(damages: &[Damage]) -> String {
    let told = damages.iter().take(TOLD).map(|damage| {
        let size = if damage.bytes > 0 { format!(", {}", bytes(damage.bytes as f64)) } else { String::new() };
        format!("    at byte {}{size}: {}\n", damage.offset, damage.what)
    });
    let more = damages.len().saturating_sub(TOLD);
    let more = if more > 0 { format!("    and {more} more\n") } else { String::new() };
    told.chain([more]).collect()
}

/// The same for programs. Times in s, sizes in bytes.
fn object(log: &Path, out: &Path, copied: &Copied) -> serde_json::Value {
    let channels = copied.channels.iter().map(|channel| {
        json!({
            "topic": channel.topic,
            "messages": channel.messages,
            "missing": channel.missing,
            "last_s": channel.last_time(),
        })
    });
    json!({
        "log": log.display().to_string(),
        "out": out.display().to_string(),
        "was_whole": copied.ending.whole,
        "messages": copied.messages(),
        "last_s": copied.last_time(),
        "channels": channels.collect::<Vec<_>>(),
        "bytes": copied.ending.bytes,
        "lost_bytes": copied.lost_bytes,
        "damages": copied.damages.iter().map(damage_object).collect::<Vec<_>>(),
    })
}

/// A part that cannot be read, for programs.
pub(super) fn damage_object(damage: &Damage) -> serde_json::Value {
    json!({"offset": damage.offset, "bytes": damage.bytes, "what": damage.what})
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_recovered_log_lies_beside_the_torn_one() {
        assert_eq!(default_out(Path::new("runs/tank.mcap")), Path::new("runs/tank.recovered.mcap"));
        assert_eq!(default_out(Path::new("torn")), Path::new("torn.recovered.mcap"));
    }
}
