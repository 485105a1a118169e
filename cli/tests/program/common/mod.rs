//! Small files and a way to run the program.
#![allow(dead_code)] // no test file needs all of it

pub mod gltf;

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

pub const LIGHT: &str = r#"{"corner":[-1,4,-1],"edge_u":[2,0,0],"edge_v":[0,0,2]}"#;
pub const TETRAHEDRON: &str = "v -1 1 -1\nv 1 1 -1\nv 0 1 1\nv 0 2 0\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// A folder with `light.json`, `model.obj` and `receivers.npy`, removed at the end.
pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.write("light.json", LIGHT);
        folder.write("model.obj", TETRAHEDRON);
        let receivers: Vec<f32> = (0..60).map(|i| (i * 37 % 41) as f32 * 0.15 - 3.0).collect();
        folder.write("receivers.npy", array(&[20, 3], &receivers));
        folder
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.path(name), bytes).unwrap();
    }

    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<String> =
            self.0.path().read_dir().unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// Runs the program in this folder.
    pub fn run(&self, args: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_umbra4"))
            .args(args.split_whitespace())
            .current_dir(self.0.path())
            .output()
            .unwrap()
    }

    /// Runs the program, which must succeed; returns its standard output.
    pub fn succeed(&self, args: &str) -> String {
        let output = self.run(args);
        assert!(output.status.success(), "{args}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs the program, which must fail as agreed: exit code 2, one line that holds `words`, no new file; and nothing on
    /// standard output but, at most, what was about to be rendered.
    pub fn fail(&self, args: &str, words: &str) {
        let before = self.names();
        let output = self.run(args);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{args}: {message}");
        assert_eq!(message.lines().count(), 1, "{args}: {message}");
        assert!(message.contains(words), "{args}: {message}");
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(said.is_empty() || said.starts_with("rendering ") && said.lines().count() == 1, "{args}: {said}");
        assert_eq!(self.names(), before, "{args}");
    }
}

/// An .npy file in memory.
pub fn array<T: npyz::AutoSerialize + Copy>(shape: &[u64], values: &[T]) -> Vec<u8> {
    let mut bytes = Vec::new();
    umbra4::array_file::write_array(&mut bytes, shape, values.iter().copied()).unwrap();
    bytes
}

/// Shape, type and elements of an .npy file.
pub fn read_array<T: npyz::Deserialize>(path: &Path) -> (Vec<u64>, String, Vec<T>) {
    parse_array(&fs::read(path).unwrap())
}

pub fn parse_array<T: npyz::Deserialize>(bytes: &[u8]) -> (Vec<u64>, String, Vec<T>) {
    let file = npyz::NpyFile::new(bytes).unwrap();
    (file.shape().to_vec(), file.dtype().descr(), file.into_vec().unwrap())
}
