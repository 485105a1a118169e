//! Compiles the kernels and writes them, with their manifest, into `exec-wgpu/shaders`, or into the folder given.

use std::{
    env,
    error::Error,
    fmt::Debug,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use serde_json::json;
use sha2::{Digest, Sha256};
use spirv_builder::{ModuleResult, SpirvBuilder, SpirvMetadata};
use umbra4_core::kernel::{self, Bound, KernelInfo, WORKGROUP};
use umbra4_maps::kernel as map_kernel;

mod inputs;

/// The Vulkan memory model's atomics and naga's agree on this target.
const TARGET: &str = "spirv-unknown-vulkan1.1";
/// A rustup toolchain with rust-gpu's backend, and the backend itself.
const VARIABLES: [&str; 2] = ["UMBRA4_RUST_GPU_TOOLCHAIN", "UMBRA4_RUST_GPU_BACKEND"];

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize()?;
    let folder = env::args_os().nth(1).map_or_else(|| root.join("exec-wgpu/shaders"), PathBuf::from);
    let [toolchain, backend] = VARIABLES.map(|name| {
        env::var(name).map_err(|_| format!("{name} is not set: `cargo gpu install` prints a toolchain and a backend"))
    });
    let (toolchain, backend) = (toolchain?, backend?);
    let modules = compile(&root, &toolchain, backend.into())?;

    fs::create_dir_all(&folder)?;
    let mut entries = Vec::new();
    for (name, bindings) in kernel::TABLE.iter().map(line).chain(map_kernel::TABLE.iter().map(line)) {
        let path = modules.iter().find(|(entry, _)| entry == name).map(|(_, path)| path);
        let code = fs::read(path.ok_or_else(|| format!("kernel {name} has no entry point"))?)?;
        fs::write(folder.join(format!("{name}.spv")), &code)?;
        entries.push(entry(name, &bindings, &code));
    }
    let version = Command::new("rustc").env("RUSTUP_TOOLCHAIN", &toolchain).arg("--version").output()?;
    let manifest = json!({
        "compiler": String::from_utf8(version.stdout)?.trim(),
        "target": TARGET,
        "inputs": inputs::hash(&root)?,
        "modules": entries,
    });
    fs::write(folder.join("manifest.json"), format!("{manifest:#}\n"))?;
    println!("{} modules in {}", entries.len(), folder.display());
    Ok(())
}

/// Entry points and the files of their modules.
fn compile(root: &Path, toolchain: &str, backend: PathBuf) -> Result<Vec<(String, PathBuf)>, Box<dyn Error>> {
    let mut builder = SpirvBuilder::new(root.join("shaders-rust"), TARGET);
    builder.toolchain_overwrite = Some(toolchain.to_owned());
    builder.rustc_codegen_spirv_location = Some(backend);
    // Nothing of the machine that it was compiled on.
    builder.spirv_metadata = SpirvMetadata::None;
    builder.multimodule = true;
    match builder.build()?.module {
        ModuleResult::MultiModule(modules) => Ok(modules.into_iter().collect()),
        ModuleResult::SingleModule(_) => Err("one module for all entry points".into()),
    }
}

/// The entry point of a line of any table, and what it is bound to.
fn line<K, G, P, S: Debug>(info: &KernelInfo<K, G, P, S>) -> (&'static str, Vec<String>) {
    let text = |Bound { slot, access }: &Bound<S>| format!("{slot:?}: {access:?}").to_lowercase();
    (info.name, info.bound.iter().map(text).collect())
}

fn entry(name: &str, bindings: &[String], code: &[u8]) -> serde_json::Value {
    json!({
        "entry_point": name,
        "workgroup": WORKGROUP,
        "bindings": bindings,
        "sha256": inputs::hexadecimal(&Sha256::digest(code)),
    })
}
