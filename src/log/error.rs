//! What can go wrong with a log.

use std::{
    error::Error,
    fmt, io,
    path::{Path, PathBuf},
};

/// A log could not be created, written or finished.
///
/// Its `Display` is one line that a person can act on, such as
/// `cannot write the log runs/a.mcap: No space left on device (os error 28)`.
#[derive(Debug)]
pub struct LogError {
    path: PathBuf,
    attempt: &'static str,
    cause: Box<dyn Error + Send + Sync>,
}

impl LogError {
    /// Says that the `attempt` (a verb: "create", "write", "finish") on the log at `path` failed with `cause`.
    pub(crate) fn new(path: &Path, attempt: &'static str, cause: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self { path: path.to_owned(), attempt, cause: cause.into() }
    }

    /// The file that was to hold the log.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The error of the operating system behind this one, where there is one: the disk is full, a folder is
    /// missing.
    pub fn io_error(&self) -> Option<&io::Error> {
        let mut link: Option<&(dyn Error + 'static)> = Some(self.cause.as_ref());
        while let Some(error) = link {
            if let Some(found) = error.downcast_ref() {
                return Some(found);
            }
            link = error.source();
        }
        None
    }
}

impl fmt::Display for LogError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cannot {} the log {}: ", self.attempt, self.path.display())?;
        // The MCAP library words every such failure as "I/O error from writing, or reading a compression
        // stream"; what the operating system said is what helps.
        match self.io_error() {
            Some(error) => error.fmt(f),
            None => self.cause.fmt(f),
        }
    }
}

impl Error for LogError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        Some(self.cause.as_ref())
    }
}
