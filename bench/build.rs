//! Links Embree 3, where its feature asks for it.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var_os("CARGO_FEATURE_EMBREE").is_some() {
        println!("cargo::rustc-link-lib=dylib=embree3");
    }
}
