//! How the program ends, and what it says then.

use std::io::{self, IsTerminal, Write};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::{env, panic};

use crate::app::StopFlag;
use crate::error::UserError;

/// An expectation failed.
pub(super) const FAILED: u8 = 1;
/// The user's input is wrong.
pub(super) const WRONG_INPUT: u8 = 2;
/// The run diverged.
pub(super) const DIVERGED: u8 = 3;
/// A bug, of the program or of a plugin.
pub(super) const BUG: u8 = 101;
/// Ctrl-C.
pub(super) const INTERRUPTED: u8 = 130;

/// Where bugs are reported.
const TRACKER: &str = "the issue tracker of storegga";

/// Shows an error of the user, and returns its exit code.
pub(super) fn report(error: &UserError) -> ExitCode {
    complain(&error.render(colour()));
    ExitCode::from(WRONG_INPUT)
}

/// Whether standard error shows colours.
pub(super) fn colour() -> bool {
    io::stderr().is_terminal() && env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Prints to standard output. Nobody may be listening any more, and that is no error.
pub(super) fn say(text: &str) {
    let mut out = io::stdout().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}

/// Prints to standard error.
pub(super) fn complain(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Makes a panic say that it is a bug, and what to do about it. The program then ends with code 101.
pub(super) fn explain_panics() {
    panic::set_hook(Box::new(|info| {
        let what = info.payload_as_str().unwrap_or("(no message)");
        let place = info.location().map(|at| format!(" at {at}")).unwrap_or_default();
        let arguments: Vec<String> = env::args().skip(1).collect();
        complain(&format!(
            "\nError: this is a bug in storegga {version}, not a mistake of yours.\n  {what}{place}\n  \
             Please report it on {TRACKER}, with this text, the scene and the command: storegga {command}\n",
            version = env!("CARGO_PKG_VERSION"),
            command = arguments.join(" "),
        ));
    }));
}

/// A flag that the first Ctrl-C sets; the second ends the program on the spot.
pub(super) fn stop_on_interrupt() -> StopFlag {
    let stop = StopFlag::default();
    let handler = stop.clone();
    let was_asked = AtomicBool::new(false);
    let set = ctrlc::set_handler(move || {
        if was_asked.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(INTERRUPTED));
        }
        handler.stop();
        complain("\nstopping after this step and closing the log; press Ctrl-C again to stop at once\n");
    });
    if set.is_err() {
        complain("Warning: Ctrl-C will end the program at once: its handler cannot be installed\n");
    }
    stop
}
