//! A device and a scene of triangles, released when dropped.

use std::ffi::CString;

use umbra4::model::Model;

use super::{EmbreeError, ffi};

/// How the scene is built.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// The slow build with spatial splits.
    pub high_quality: bool,
    /// Watertight traversal.
    pub robust: bool,
    /// No instructions beyond AVX2, to compare with machines that have no more.
    pub avx2: bool,
    /// A hierarchy that follows vertices that move.
    pub refit: bool,
}

/// Triangles that rays can be shot at.
pub struct TriangleScene {
    device: ffi::Handle,
    scene: ffi::Handle,
}

// SAFETY: Embree's scenes may be traced from any number of threads once they are committed, as this one is.
unsafe impl Sync for TriangleScene {}

impl TriangleScene {
    /// Copies the model and builds its hierarchy on `threads` threads.
    pub fn new(model: &Model, options: Options, threads: usize) -> Result<Self, EmbreeError> {
        let isa = if options.avx2 { ",isa=avx2" } else { "" };
        let config = CString::new(format!("threads={threads}{isa}")).unwrap_or_default();
        // SAFETY: `config` is a C string that outlives the call.
        let device = unsafe { ffi::rtcNewDevice(config.as_ptr()) };
        if device.is_null() {
            // SAFETY: a null device asks for the error of this thread.
            return Err(EmbreeError { code: unsafe { ffi::rtcGetDeviceError(device) } });
        }
        // SAFETY: `device` is valid.
        let this = Self { device, scene: unsafe { ffi::rtcNewScene(device) } };
        this.check()?;
        let quality = match options {
            Options { refit: true, .. } => ffi::QUALITY_LOW,
            Options { high_quality: true, .. } => ffi::QUALITY_HIGH,
            _ => ffi::QUALITY_MEDIUM,
        };
        let flags = if options.robust { ffi::SCENE_ROBUST } else { ffi::SCENE_NONE };
        let flags = flags | if options.refit { ffi::SCENE_DYNAMIC } else { ffi::SCENE_NONE };
        // SAFETY: `scene` is valid, and the values are those of the header.
        unsafe {
            ffi::rtcSetSceneBuildQuality(this.scene, quality);
            ffi::rtcSetSceneFlags(this.scene, flags);
        }
        // SAFETY: `device` is valid.
        let geometry = unsafe { ffi::rtcNewGeometry(device, ffi::GEOMETRY_TRIANGLE) };
        this.check()?;
        let vertices = positions(model);
        let filled = this
            .fill(geometry, ffi::BUFFER_VERTEX, ffi::FORMAT_FLOAT3, &vertices)
            .and_then(|()| this.fill(geometry, ffi::BUFFER_INDEX, ffi::FORMAT_UINT3, &model.triangles));
        // SAFETY: `geometry` is valid; its buffers are filled or it is not attached; it is released once here, while
        // the scene holds its own reference.
        unsafe {
            if filled.is_ok() {
                if options.refit {
                    ffi::rtcSetGeometryBuildQuality(geometry, ffi::QUALITY_REFIT);
                }
                ffi::rtcCommitGeometry(geometry);
                ffi::rtcAttachGeometry(this.scene, geometry);
            }
            ffi::rtcReleaseGeometry(geometry);
            ffi::rtcCommitScene(this.scene);
        }
        filled?;
        this.check()?;
        Ok(this)
    }

    /// Lets the hierarchy follow the model's vertices: of the model it was made of, or of one with as many vertices.
    pub fn refit(&self, model: &Model) -> Result<(), EmbreeError> {
        let vertices = positions(model);
        // SAFETY: `scene` is valid, and its first geometry is the only one.
        let geometry = unsafe { ffi::rtcGetGeometry(self.scene, 0) };
        // SAFETY: the geometry has a buffer of vertices.
        let data = unsafe { ffi::rtcGetGeometryBufferData(geometry, ffi::BUFFER_VERTEX, 0) };
        self.check()?;
        // SAFETY: the buffer was made for as many vertices; nobody else has it.
        unsafe {
            std::ptr::copy_nonoverlapping(vertices.as_ptr(), data.cast(), vertices.len());
            ffi::rtcUpdateGeometryBuffer(geometry, ffi::BUFFER_VERTEX, 0);
            ffi::rtcCommitGeometry(geometry);
            ffi::rtcCommitScene(self.scene);
        }
        self.check()
    }

    /// The handle that rays are shot at.
    pub fn handle(&self) -> ffi::Handle {
        self.scene
    }

    /// Copies `items` into a buffer that Embree owns, and pads as it needs to.
    fn fill<T: Copy>(
        &self,
        geometry: ffi::Handle,
        buffer: i32,
        format: i32,
        items: &[[T; 3]],
    ) -> Result<(), EmbreeError> {
        // SAFETY: `geometry` is valid; the stride is that of the format's three 4-byte values.
        let data =
            unsafe { ffi::rtcSetNewGeometryBuffer(geometry, buffer, 0, format, size_of::<[T; 3]>(), items.len()) };
        self.check()?;
        // SAFETY: without an error, `data` has room for `items.len()` items of that stride, and is fresh memory.
        unsafe { std::ptr::copy_nonoverlapping(items.as_ptr(), data.cast(), items.len()) };
        Ok(())
    }

    fn check(&self) -> Result<(), EmbreeError> {
        // SAFETY: `device` is valid.
        match unsafe { ffi::rtcGetDeviceError(self.device) } {
            0 => Ok(()),
            code => Err(EmbreeError { code }),
        }
    }
}

fn positions(model: &Model) -> Vec<[f32; 3]> {
    model.vertices.iter().map(|v| v.to_array()).collect()
}

impl Drop for TriangleScene {
    fn drop(&mut self) {
        // SAFETY: both are valid (or null, where Embree could not make the scene), and are released once.
        unsafe {
            if !self.scene.is_null() {
                ffi::rtcReleaseScene(self.scene);
            }
            ffi::rtcReleaseDevice(self.device);
        }
    }
}
