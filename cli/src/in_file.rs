//! An error, and the file it was met in.

use std::{
    error::Error,
    path::{Path, PathBuf},
};

/// An error together with the path of the file that caused it.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source}", path.display())]
pub struct InFile<E: Error + 'static> {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub source: E,
}

impl<E: Error + 'static> InFile<E> {
    /// For `map_err`: puts `path` to an error.
    pub fn at(path: &Path) -> impl Fn(E) -> Self {
        move |source| Self { path: path.to_owned(), source }
    }
}
