//! What a process holds resident, and its peak.

/// Bytes that this process held resident at most, so far; `None` where the system does not say.
pub(super) fn peak() -> Option<u64> {
    field("VmHWM:")
}

/// Bytes that this process holds resident.
pub(super) fn now() -> Option<u64> {
    field("VmRSS:")
}

/// Lets the peak begin anew at what is held now; where the system refuses that, the peak stays as it is, and it is said.
pub(super) fn reset_peak() {
    // 5 is what proc(5) gives for this.
    if let Err(error) = std::fs::write("/proc/self/clear_refs", "5") {
        eprintln!("the peak cannot be reset ({error}): that of computing includes that of snapping");
    }
}

fn field(name: &str) -> Option<u64> {
    parse(&std::fs::read_to_string("/proc/self/status").ok()?, name)
}

/// A field of a `/proc/…/status`, in bytes.
fn parse(status: &str, name: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_read() {
        let status = "Name:\tx\nVmPeak:\t  9 kB\nVmHWM:\t   1234 kB\nVmRSS:\t 7 kB\n";
        assert_eq!((parse(status, "VmHWM:"), parse(status, "VmRSS:")), (Some(1234 * 1024), Some(7 * 1024)));
        assert_eq!(parse("Name:\tx\n", "VmHWM:"), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_peak_grows_with_what_is_touched() {
        let before = peak();
        let touched = vec![1_u8; 512 << 20];
        let after = peak();
        assert!(touched.iter().step_by(4096).all(|&byte| byte == 1));
        assert!(before.zip(after).is_some_and(|(before, after)| after >= before && after >= 512 << 20));
    }
}
