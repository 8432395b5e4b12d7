//! Every scene that has expectations is a test: the coarse variants in `scenes/ci`, and with `STOREGGA_FULL=1` the shipped
//! scenes at their own spacing and their variants in `scenes/fine` too.

#[path = "support/shipped.rs"]
mod shipped;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};
use storegga::app::{End, StopFlag, end_time, open, run};
use storegga::expect::evaluate;
use storegga::scene::open_document;
use storegga_standard::StandardPlugins;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let full = std::env::var_os("STOREGGA_FULL").is_some_and(|value| value == "1");
    let coarse = trials("scenes/ci", "ci/", false);
    let shipped = trials("scenes", "", !full);
    let fine = trials("scenes/fine", "fine/", !full);
    libtest_mimic::run(&arguments, coarse.into_iter().chain(shipped).chain(fine).collect()).exit_code()
}

/// A test for each scene of a folder that has expectations or cannot be read.
fn trials(folder: &str, prefix: &str, ignored: bool) -> Vec<Trial> {
    let trial = |path: PathBuf| {
        let name = format!("{prefix}{}", path.file_stem().unwrap_or_default().to_string_lossy());
        Trial::test(name, move || meets_expectations(&path)).with_ignored_flag(ignored)
    };
    shipped::scenes(folder).into_iter().filter(|path| is_expected_of(path)).map(trial).collect()
}

fn is_expected_of(path: &Path) -> bool {
    let Ok(scene) = open_document(path, &[]) else { return true };
    scene.node("expect").is_some_and(|expect| !expect.items().is_empty())
}

fn meets_expectations(path: &Path) -> Result<(), Failed> {
    let document = open_document(path, &[]).map_err(|error| error.render(false))?;
    let mut app = open(StandardPlugins, document).map_err(|error| error.render(false))?;
    let world = app.world_mut();
    let end_time = end_time(world);
    match run(world, end_time, &StopFlag::default(), |_| {}) {
        End::Done => {}
        end => return Err(format!("the run did not reach its end: {end:?}").into()),
    }
    let failed: Vec<String> =
        evaluate(world).iter().filter(|check| !check.pass).map(|check| format!("{check:?}")).collect();
    if failed.is_empty() { Ok(()) } else { Err(failed.join("\n").into()) }
}
