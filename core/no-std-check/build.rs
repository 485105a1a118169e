//! Undefined symbols are errors in the shared library, as they are in a program.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("linux") {
        println!("cargo::rustc-cdylib-link-arg=-nostartfiles");
        println!("cargo::rustc-cdylib-link-arg=-Wl,--no-undefined");
        println!("cargo::rustc-cdylib-link-arg=-Wl,--gc-sections");
    }
}
