//! Putting a file in the place of another: at every moment, whatever fails, the old one is there or the new one, whole.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Where a file that is to be at `path` is written first.
pub(crate) fn part_of(path: &Path) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(".part");
    name.into()
}

/// Gives the file at `part`, which is whole, the name `path`. It reaches the disk before, and its name afterwards.
pub(crate) fn put_in_place(part: &Path, path: &Path) -> io::Result<()> {
    File::options().append(true).open(part)?.sync_all()?;
    fs::rename(part, path)?;
    sync_folder(path)
}

/// Puts `bytes` at `path`: they are written to a file beside it, which then takes its place.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let part = part_of(path);
    let written = File::create(&part).and_then(|mut file| file.write_all(bytes));
    let replaced = written.and_then(|()| put_in_place(&part, path));
    if replaced.is_err() {
        let _ = fs::remove_file(&part);
    }
    replaced
}

/// Makes the name of a file reach the disk.
#[cfg(unix)]
fn sync_folder(path: &Path) -> io::Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    File::open(folder)?.sync_all()
}

/// Elsewhere a folder cannot be opened as a file.
#[cfg(not(unix))]
fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole_or_not_at_all() {
        let folder = std::env::temp_dir().join(format!("storegga-replace-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        let path = folder.join("a.checkpoint");
        for content in ["old", "new"] {
            replace(&path, content.as_bytes()).expect("it is written");
            assert_eq!(fs::read(&path).expect("it is there"), content.as_bytes());
        }
        // A folder in the place of the part: the write fails, and the file before it stays.
        fs::create_dir(part_of(&path)).expect("a folder");
        assert!(replace(&path, b"newer").is_err());
        assert_eq!(fs::read(&path).expect("it is there"), b"new");
        fs::remove_dir_all(&folder).expect("the folder is there");
    }
}
