//! Keeps off the terminal what drivers, and libraries that they load, write to standard error: Mesa's Vulkan layer complains there of a missing
//! XDG_RUNTIME_DIR. What matters of it comes back as an error.

/// Does some work while nothing reaches standard error; what was written comes out after all if the work panics.
#[cfg(unix)]
pub fn quietly<T>(work: impl FnOnce() -> T) -> T {
    // Where it cannot be kept, it is seen: no reason not to work.
    let _kept = kept::Kept::begin().ok();
    work()
}

/// Does some work.
#[cfg(not(unix))]
pub fn quietly<T>(work: impl FnOnce() -> T) -> T {
    work()
}

#[cfg(unix)]
mod kept {
    use std::{
        fs::File,
        io::{self, Seek, stderr},
        os::fd::{AsFd, OwnedFd},
        thread,
    };

    use rustix::stdio::dup2_stderr;

    /// Standard error, until this is dropped a file without a name.
    pub struct Kept {
        terminal: OwnedFd,
        file: File,
    }

    impl Kept {
        pub fn begin() -> io::Result<Self> {
            let file = tempfile::tempfile()?;
            let terminal = stderr().as_fd().try_clone_to_owned()?;
            dup2_stderr(&file)?;
            Ok(Self { terminal, file })
        }
    }

    impl Drop for Kept {
        fn drop(&mut self) {
            // Nothing can be done, or said, where these fail.
            let _ = dup2_stderr(&self.terminal);
            if thread::panicking() {
                let _ = self.file.rewind().and_then(|()| io::copy(&mut self.file, &mut stderr()));
            }
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::io::Write;

    use super::*;

    #[test]
    fn what_is_written_meanwhile_is_not_seen() {
        let length = || std::fs::metadata("/proc/self/fd/2").map_or(0, |file| file.len());
        let written = quietly(|| {
            let before = length();
            // Not by a macro, which tests capture.
            std::io::stderr().write_all(b"chatter\n").unwrap();
            length() - before
        });
        if cfg!(target_os = "linux") {
            assert_eq!(written, 8);
        }
    }
}
