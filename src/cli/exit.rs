//! How the program ends, and what it says then.

use std::io::{self, IsTerminal, Write};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::{env, panic};

use super::args::Input;
use crate::app::StopFlag;
use crate::error::UserError;

/// An expectation failed, or a log is not whole.
pub(super) const FAILED: u8 = 1;
/// The user's input is wrong, or output cannot be written.
pub(super) const WRONG_INPUT: u8 = 2;
/// The run diverged.
pub(super) const DIVERGED: u8 = 3;
/// A bug, of the program or of a plugin.
pub(super) const BUG: u8 = 101;
/// Ctrl-C or SIGTERM.
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

/// Whether something could not be printed to standard output.
static UNHEARD: AtomicBool = AtomicBool::new(false);

/// Prints to standard output; that nobody listens any more, or that the disk is full, is told once.
pub(super) fn say(text: &str) {
    let mut out = io::stdout().lock();
    if let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush())
        && !UNHEARD.swap(true, Ordering::Relaxed)
    {
        report(&UserError::plain(format!("cannot write to standard output: {error}")));
    }
}

/// The exit code `code`, unless the program did well but could not say so.
pub(super) fn unless_unheard(code: ExitCode) -> ExitCode {
    let unheard = UNHEARD.load(Ordering::Relaxed) && code == ExitCode::SUCCESS;
    if unheard { ExitCode::from(WRONG_INPUT) } else { code }
}

/// Lets a file that grows beyond what the user may write fail with an error, as a full disk does; by itself the signal SIGXFSZ
/// ends the program on the spot.
#[cfg(unix)]
pub(super) fn hear_of_full_disks() {
    // Without the handler the program is not worse off than before.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
}

/// There is no such signal.
#[cfg(not(unix))]
pub(super) fn hear_of_full_disks() {}

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

/// A flag that the first Ctrl-C or SIGTERM sets; the second ends the program on the spot. SIGHUP is left alone, so that
/// `nohup` works.
pub(super) fn stop_on_interrupt() -> StopFlag {
    let stop = StopFlag::default();
    let flag = stop.clone();
    let is_set = ctrlc::set_handler(move || interrupt(&flag)).is_ok() && stop_on_termination(stop.clone());
    if !is_set {
        complain("Warning: Ctrl-C or SIGTERM will end the program at once: its handler cannot be installed\n");
    }
    stop
}

/// Sets the flag when standard input ends, if that is asked for.
pub(super) fn stop_at_end_of_input(asked: Input, stop: &StopFlag) {
    if asked.stop_at_end_of_input {
        let stop = stop.clone();
        std::thread::spawn(move || {
            // Whatever ends it, nobody is there any more.
            let _ = io::copy(&mut io::stdin().lock(), &mut io::sink());
            stop.stop();
        });
    }
}

fn interrupt(stop: &StopFlag) {
    if stop.is_set() {
        std::process::exit(i32::from(INTERRUPTED));
    }
    stop.stop();
    complain("\nstopping after this step and closing the log; press Ctrl-C again to stop at once\n");
}

/// Whether SIGTERM, with which batch systems end a run, is now heard.
#[cfg(unix)]
fn stop_on_termination(stop: StopFlag) -> bool {
    use signal_hook::consts::SIGTERM;
    use signal_hook::iterator::Signals;

    let Ok(mut signals) = Signals::new([SIGTERM]) else { return false };
    std::thread::spawn(move || signals.forever().for_each(|_| interrupt(&stop)));
    true
}

/// There is no such signal.
#[cfg(not(unix))]
fn stop_on_termination(_: StopFlag) -> bool {
    true
}
