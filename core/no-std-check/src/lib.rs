//! Every function of umbra4-core and umbra4-maps that runs once a frame or more often, instantiated and exported, without std.
//!
//! Built in two ways (see `Cargo.toml`): plain, where a second panic handler, std's, would be an error; and with
//! `no-panic`, where a path to the handler is one. Left out is what formats: `Display` of errors and plans goes through
//! `core::fmt`, which has panicking paths of its own.
#![no_std]
#![allow(improper_ctypes_definitions)] // nobody calls these

#[cfg(feature = "with-std")]
extern crate std;

// The check of the check is about one function only.
#[cfg(not(feature = "with-panic"))]
mod casters;
#[cfg(not(feature = "with-panic"))]
mod gpu;
#[cfg(not(feature = "with-panic"))]
mod host;
#[cfg(not(feature = "with-panic"))]
mod kernels;
#[cfg(not(feature = "with-panic"))]
mod lights;
#[cfg(not(feature = "with-panic"))]
mod maps;

// memcpy and memset; on bare metal they come with Rust.
#[cfg(target_os = "linux")]
#[link(name = "c")]
unsafe extern "C" {}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    #[cfg(feature = "no-panic")]
    {
        unsafe extern "C" {
            fn umbra4_core_can_panic() -> !;
        }
        // SAFETY: it does not exist, so nothing that reaches this ever links.
        unsafe { umbra4_core_can_panic() }
    }
    #[cfg(not(feature = "no-panic"))]
    loop {}
}

/// Indexes out of bounds.
#[cfg(feature = "with-panic")]
#[unsafe(no_mangle)]
pub extern "C" fn check_panic(values: &[u32], index: usize) -> u32 {
    values[index]
}
