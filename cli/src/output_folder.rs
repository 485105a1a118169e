//! Output folders appear whole or not at all.

use std::{
    fs,
    path::{Path, PathBuf},
};

use tempfile::TempDir;

use crate::{in_file::InFile, output::OutputError};

/// A folder that is being filled, under another name beside its own. Dropped, it is gone.
#[derive(Debug)]
pub struct PreparedFolder {
    path: PathBuf,
    temporary: TempDir,
}

impl PreparedFolder {
    /// Begins the folder that will be `path`.
    ///
    /// # Errors
    /// Something is there that is not an empty folder; the system's.
    pub fn new(path: &Path) -> Result<Self, InFile<OutputError>> {
        let new = || -> Result<TempDir, OutputError> {
            check_free(path)?;
            let parent = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
            Ok(tempfile::Builder::new().prefix(".umbra4-").tempdir_in(parent)?)
        };
        Ok(Self { path: path.to_owned(), temporary: new().map_err(InFile::at(path))? })
    }

    /// Puts a file into the folder; `name` may have folders of its own.
    ///
    /// # Errors
    /// The system's.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<(), InFile<OutputError>> {
        let file = self.temporary.path().join(name);
        let write = || -> Result<(), OutputError> {
            if let Some(parent) = file.parent() {
                fs::create_dir_all(parent)?;
            }
            Ok(fs::write(&file, bytes)?)
        };
        write().map_err(InFile::at(&self.path.join(name)))
    }

    /// Gives the folder its name.
    ///
    /// # Errors
    /// The name has been taken since; the system's.
    pub fn publish(self) -> Result<(), InFile<OutputError>> {
        let Self { path, temporary } = self;
        let publish = || -> Result<(), OutputError> {
            check_free(&path)?;
            if path.exists() {
                fs::remove_dir(&path)?;
            }
            make_readable(temporary.path())?;
            fs::rename(temporary.path(), &path)?;
            // Nothing is left under that name for it to remove.
            let _ = temporary.keep();
            Ok(())
        };
        publish().map_err(InFile::at(&path))
    }
}

fn check_free(path: &Path) -> Result<(), OutputError> {
    let free = !path.exists() || path.is_dir() && path.read_dir()?.next().is_none();
    if free { Ok(()) } else { Err(OutputError::Occupied) }
}

/// Temporary folders are private; a result is not.
#[cfg(unix)]
fn make_readable(folder: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(folder, fs::Permissions::from_mode(0o755))
}

#[cfg(not(unix))]
fn make_readable(_: &Path) -> std::io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_appears_when_it_is_whole() {
        let parent = tempfile::tempdir().unwrap();
        let path = parent.path().join("out");
        let folder = PreparedFolder::new(&path).unwrap();
        folder.write("a/b.txt", "b").unwrap();
        assert!(!path.exists());
        folder.publish().unwrap();
        assert_eq!(fs::read_to_string(path.join("a/b.txt")).unwrap(), "b");
        assert_eq!(parent.path().read_dir().unwrap().count(), 1);
    }

    #[test]
    fn an_abandoned_folder_leaves_nothing() {
        let parent = tempfile::tempdir().unwrap();
        let folder = PreparedFolder::new(&parent.path().join("out")).unwrap();
        folder.write("a", "half").unwrap();
        drop(folder);
        assert_eq!(parent.path().read_dir().unwrap().count(), 0);
    }

    #[test]
    fn what_is_there_is_kept() {
        let parent = tempfile::tempdir().unwrap();
        let path = parent.path().join("out");
        fs::create_dir(&path).unwrap();
        let folder = PreparedFolder::new(&path).unwrap();
        fs::write(path.join("precious"), "1").unwrap();
        assert!(folder.publish().is_err());
        assert!(PreparedFolder::new(&path).unwrap_err().to_string().contains("not an empty folder"));
        assert_eq!(parent.path().read_dir().unwrap().count(), 1);
        fs::remove_file(path.join("precious")).unwrap();
        PreparedFolder::new(&path).unwrap().publish().unwrap();
    }
}
