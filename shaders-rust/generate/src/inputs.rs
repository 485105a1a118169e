//! What the SPIR-V is made from, as one hash: the sources of core, of the maps and of the shaders, and the lock file of the latter.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use sha2::{Digest, Sha256};

/// Files and folders, from the root of the repository.
const INPUTS: [&str; 7] = [
    "core/Cargo.toml",
    "core/src",
    "maps/Cargo.toml",
    "maps/src",
    "shaders-rust/Cargo.toml",
    "shaders-rust/Cargo.lock",
    "shaders-rust/src",
];

/// The hash of all inputs, in hexadecimal: of each file's path and contents, in the order of the paths.
///
/// # Errors
/// A file cannot be read.
pub fn hash(root: &Path) -> io::Result<String> {
    let mut files = Vec::new();
    for input in INPUTS {
        collect(&root.join(input), &mut files)?;
    }
    files.sort();
    let mut hash = Sha256::new();
    for file in files {
        let name = file.strip_prefix(root).unwrap_or(&file).to_string_lossy().replace('\\', "/");
        // Line ends differ between checkouts, and change nothing.
        let contents = fs::read_to_string(&file)?.replace("\r\n", "\n");
        hash.update(format!("{name}\n{}\n{contents}", contents.len()));
    }
    Ok(hexadecimal(&hash.finalize()))
}

/// Bytes as text.
pub fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn collect(path: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    if path.is_dir() {
        for entry in fs::read_dir(path)? {
            collect(&entry?.path(), files)?;
        }
    } else {
        files.push(path.to_path_buf());
    }
    Ok(())
}
