//! The file of a log while it is written: nobody else writes it, and it stays where it is.

use std::fs::{File, Metadata, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use super::LogError;

/// Where a log is written.
#[derive(Debug)]
pub(super) struct Place {
    pub path: PathBuf,
    /// What the system knows the file by; `None` for what is no plain file.
    identity: Option<Identity>,
}

impl Place {
    /// Creates the file at `path`, or empties it, unless another program is writing a log there.
    pub fn create(path: &Path) -> Result<(File, Self), LogError> {
        let fail = |error: io::Error| LogError::new(path, "create", error);
        // It is not emptied before it is clear that no run writes it.
        let file = OpenOptions::new().write(true).create(true).truncate(false).open(path).map_err(fail)?;
        if is_written(&file) {
            return Err(LogError::new(path, "create", "another run is writing it"));
        }
        let data = file.metadata().map_err(fail)?;
        if data.is_file() {
            file.set_len(0).map_err(fail)?;
        }
        let identity = data.is_file().then(|| identity(&data)).flatten();
        Ok((file, Self { path: path.to_owned(), identity }))
    }

    /// Whether the file still is where it was created: what is written to one that was removed is lost.
    pub fn check(&self) -> Result<(), LogError> {
        let Some(created) = self.identity else { return Ok(()) };
        let now = std::fs::metadata(&self.path).ok();
        if now.as_ref().and_then(identity) == Some(created) {
            return Ok(());
        }
        Err(LogError::new(&self.path, "write", "it was removed, moved or replaced while it was written"))
    }
}

/// Whether another program is writing the log `file`; if not, nobody else does while `file` is open. Where locks are not known, as
/// in some file systems of networks, nobody seems to.
///
/// A process that is being started holds what its parent had locked until its own program begins: so a lock counts only if it
/// stays.
pub(super) fn is_written(file: &File) -> bool {
    let is_locked = || matches!(file.try_lock(), Err(TryLockError::WouldBlock));
    for _ in 0..LOOKS {
        if !is_locked() {
            return false;
        }
        thread::sleep(BETWEEN_LOOKS);
    }
    is_locked()
}

/// How often a lock is looked at before it counts, and how long apart.
const LOOKS: u32 = 20;
const BETWEEN_LOOKS: Duration = Duration::from_millis(10);

/// Whether a program is writing a log at `path`.
pub(crate) fn is_being_written(path: &Path) -> bool {
    File::open(path).is_ok_and(|file| is_written(&file))
}

/// Device and number of a file.
type Identity = (u64, u64);

#[cfg(unix)]
fn identity(data: &Metadata) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt;

    Some((data.dev(), data.ino()))
}

/// An open file cannot be removed there.
#[cfg(not(unix))]
fn identity(_: &Metadata) -> Option<Identity> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_counts_only_if_it_stays() -> io::Result<()> {
        let path = std::env::temp_dir().join(format!("storegga-lock-{}", std::process::id()));
        let holder = File::create(&path)?;
        holder.lock()?;
        assert!(is_written(&File::open(&path)?), "the lock stays");
        // As of a process that is being started.
        let holder = thread::spawn(move || {
            thread::sleep(2 * BETWEEN_LOOKS);
            drop(holder);
        });
        assert!(!is_written(&File::open(&path)?), "the lock is gone after a moment");
        assert!(holder.join().is_ok());
        std::fs::remove_file(&path)
    }
}
