//! Output files appear whole or not at all.

use std::{
    fs::File,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

use tempfile::{NamedTempFile, TempPath};

use crate::in_file::InFile;

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The system refuses.
    #[error("cannot be written: {0}")]
    Io(#[from] io::Error),
    /// The picture cannot be encoded.
    #[error("cannot be encoded: {0}")]
    Image(#[from] image::ImageError),
    /// Nothing is known about files of that name.
    #[error("unknown picture format: the name must end in .png or .exr")]
    UnknownExtension,
    /// A folder would be mixed up with what is there.
    #[error("is there already, and not an empty folder")]
    Occupied,
}

/// Lets `write` fill a file beside `path`, then gives it that name. On any error nothing is left, and a file that was
/// there before stays as it was.
///
/// # Errors
/// The system's, or those of `write`.
pub fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), OutputError>,
) -> Result<(), InFile<OutputError>> {
    prepare(path, write)?.publish()
}

/// A file that is complete but has not got its name yet. Dropped, it is gone.
#[derive(Debug)]
pub struct Prepared {
    path: PathBuf,
    temporary: TempPath,
}

impl Prepared {
    /// Gives the file its name.
    ///
    /// # Errors
    /// The system's.
    pub fn publish(self) -> Result<(), InFile<OutputError>> {
        let Self { path, temporary } = self;
        temporary.persist(&path).map_err(|e| InFile::at(&path)(e.error.into()))
    }
}

/// Lets `write` fill a file beside `path`: where several files belong together, all are prepared before any appears.
///
/// # Errors
/// The system's, or those of `write`.
pub fn prepare(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), OutputError>,
) -> Result<Prepared, InFile<OutputError>> {
    let whole = || -> Result<Prepared, OutputError> {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let (file, temporary) = NamedTempFile::new_in(folder)?.into_parts();
        let mut writer = BufWriter::new(file);
        write(&mut writer)?;
        writer.flush()?;
        make_readable(writer.get_ref())?;
        Ok(Prepared { path: path.to_owned(), temporary })
    };
    whole().map_err(InFile::at(path))
}

/// Temporary files are private; a result is not.
#[cfg(unix)]
fn make_readable(file: &File) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn make_readable(_: &File) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.bin");
        let failed = write_whole(&path, |w| {
            w.write_all(b"half")?;
            Err(io::Error::other("disk on fire").into())
        });
        assert!(failed.is_err());
        assert_eq!(folder.path().read_dir().unwrap().count(), 0);
    }

    #[test]
    fn a_success_replaces_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.bin");
        for text in ["first", "second"] {
            write_whole(&path, |w| Ok(w.write_all(text.as_bytes())?)).unwrap();
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(folder.path().read_dir().unwrap().count(), 1);
    }
}
