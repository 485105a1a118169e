//! The SPIR-V that users get: up to date, bound as the tables say, and open to browsers.

use std::path::Path;

use naga::{
    AddressSpace, ImageClass, ScalarKind, StorageAccess, TypeInner,
    back::{hlsl, msl, wgsl},
    front::spv,
    valid,
};
use sha2::{Digest, Sha256};
use umbra4_core::kernel::{Access, WORKGROUP};
use umbra4_wgpu::{DeviceKernel, code, manifest};

#[path = "../../../shaders-rust/generate/src/inputs.rs"]
mod inputs;

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

fn parsed() -> serde_json::Value {
    serde_json::from_str(manifest()).expect("the manifest is JSON")
}

/// A kernel as naga reads it, validated for any device.
fn module(kernel: DeviceKernel) -> (naga::Module, valid::ModuleInfo) {
    let options = spv::Options { strict_capabilities: true, ..spv::Options::default() };
    let module = spv::parse_u8_slice(code(kernel), &options).unwrap_or_else(|e| panic!("{}: {e}", kernel.name()));
    // No capability beyond those of WebGPU.
    let mut validator = valid::Validator::new(valid::ValidationFlags::all(), valid::Capabilities::empty());
    let found = validator.validate(&module).unwrap_or_else(|e| panic!("{}: {e:?}", kernel.name()));
    (module, found)
}

#[test]
fn the_modules_are_compiled_from_these_sources() {
    let now = inputs::hash(root()).expect("the sources are there");
    assert_eq!(
        parsed()["inputs"],
        now,
        "core, the maps or the shaders have changed: compile the kernels again, as the README says under \"Kernels\""
    );
}

#[test]
fn a_changed_source_is_noticed() {
    let folder = std::env::temp_dir().join(format!("umbra4-inputs-{}", std::process::id()));
    for file in
        ["core/Cargo.toml", "core/src/a.rs", "maps/Cargo.toml", "shaders-rust/Cargo.toml", "shaders-rust/Cargo.lock"]
    {
        let path = folder.join(file);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder can be made");
        std::fs::write(path, "one\n").expect("a file can be written");
    }
    for sources in ["maps/src", "shaders-rust/src"] {
        std::fs::create_dir_all(folder.join(sources)).expect("a folder can be made");
    }
    let before = inputs::hash(&folder).expect("the files are there");
    assert_eq!(before, inputs::hash(&folder).expect("the files are there"));
    std::fs::write(folder.join("core/src/a.rs"), "two\n").expect("a file can be written");
    assert_ne!(before, inputs::hash(&folder).expect("the files are there"));
    std::fs::rename(folder.join("core/src/a.rs"), folder.join("core/src/b.rs")).expect("a file can be renamed");
    std::fs::write(folder.join("core/src/b.rs"), "one\n").expect("a file can be written");
    assert_ne!(before, inputs::hash(&folder).expect("the files are there"));
    std::fs::remove_dir_all(folder).expect("the folder can be removed");
}

#[test]
fn the_modules_are_those_of_the_manifest() {
    let manifest = parsed();
    let modules = manifest["modules"].as_array().expect("a list");
    assert_eq!(modules.len(), DeviceKernel::all().count());
    for (entry, kernel) in modules.iter().zip(DeviceKernel::all()) {
        assert_eq!(entry["entry_point"], kernel.name());
        assert_eq!(entry["workgroup"], WORKGROUP);
        assert_eq!(entry["sha256"], inputs::hexadecimal(&Sha256::digest(code(kernel))), "{}", kernel.name());
    }
}

#[test]
fn the_modules_are_bound_as_the_tables_say() {
    for kernel in DeviceKernel::all() {
        let (module, found) = module(kernel);
        let entry = &module.entry_points[0];
        assert_eq!(module.entry_points.len(), 1);
        assert_eq!(entry.name, kernel.name());
        assert_eq!(entry.workgroup_size, [WORKGROUP, 1, 1], "{}", kernel.name());
        let mut bindings: Vec<(u32, Access)> = module
            .global_variables
            .iter()
            .filter(|(handle, _)| !found.get_entry_point(0)[*handle].is_empty())
            .filter_map(|(_, variable)| {
                let access = match variable.space {
                    AddressSpace::Storage { access } if access.contains(StorageAccess::STORE) => Access::Write,
                    AddressSpace::Storage { .. } => Access::Read,
                    AddressSpace::Handle => match module.types[variable.ty].inner {
                        TypeInner::Image { class: ImageClass::Sampled { kind, multi }, .. } => match (kind, multi) {
                            (ScalarKind::Float, false) => Access::Texture,
                            (ScalarKind::Float, true) => Access::Samples,
                            (ScalarKind::Uint, false) => Access::Ids,
                            (ScalarKind::Uint, true) => Access::IdSamples,
                            _ => panic!("{}: a texture of {kind:?}", kernel.name()),
                        },
                        _ => panic!("{}: neither a buffer nor a texture", kernel.name()),
                    },
                    _ => return None,
                };
                let binding = variable.binding.expect("it is bound");
                assert_eq!(binding.group, 0);
                Some((binding.binding, access))
            })
            .collect();
        bindings.sort_unstable_by_key(|(binding, _)| *binding);
        let expected: Vec<(u32, Access)> = (0..).zip([Access::Read].into_iter().chain(kernel.accesses())).collect();
        assert_eq!(bindings, expected, "{}", kernel.name());
    }
}

#[test]
fn every_module_translates_to_wgsl() {
    for kernel in DeviceKernel::all() {
        let (module, found) = module(kernel);
        let text = wgsl::write_string(&module, &found, wgsl::WriterFlags::empty())
            .unwrap_or_else(|error| panic!("{}: {error}", kernel.name()));
        let again = naga::front::wgsl::parse_str(&text).unwrap_or_else(|error| panic!("{}: {error}", kernel.name()));
        valid::Validator::new(valid::ValidationFlags::all(), valid::Capabilities::empty())
            .validate(&again)
            .unwrap_or_else(|error| panic!("{}: {error:?}", kernel.name()));
    }
}

/// What the rule of usable adapters rests on, where there is no such device to compile what comes out.
#[test]
fn every_module_translates_for_metal_and_direct3d() {
    for kernel in DeviceKernel::all() {
        let (module, found) = module(kernel);
        let (metal, _) = msl::write_string(&module, &found, &msl::Options::default(), &msl::PipelineOptions::default())
            .unwrap_or_else(|error| panic!("{}: {error}", kernel.name()));
        let mut direct3d = String::new();
        let (options, pipeline) = (hlsl::Options::default(), hlsl::PipelineOptions::default());
        hlsl::Writer::new(&mut direct3d, &options, &pipeline)
            .write(&module, &found, None)
            .unwrap_or_else(|error| panic!("{}: {error}", kernel.name()));
        assert!(metal.contains(kernel.name()) && direct3d.contains(kernel.name()), "{}", kernel.name());
    }
}
