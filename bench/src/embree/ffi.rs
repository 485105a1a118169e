//! The part of Embree 3's C interface that the benchmark calls; names and values are those of its headers.

use std::ffi::{c_char, c_int, c_uint, c_void};

/// `RTCDevice`, `RTCScene` and `RTCGeometry`: opaque pointers.
pub type Handle = *mut c_void;

/// `RTC_BUFFER_TYPE_INDEX`
pub const BUFFER_INDEX: c_int = 0;
/// `RTC_BUFFER_TYPE_VERTEX`
pub const BUFFER_VERTEX: c_int = 1;
/// `RTC_FORMAT_UINT3`
pub const FORMAT_UINT3: c_int = 0x5003;
/// `RTC_FORMAT_FLOAT3`
pub const FORMAT_FLOAT3: c_int = 0x9003;
/// `RTC_GEOMETRY_TYPE_TRIANGLE`
pub const GEOMETRY_TRIANGLE: c_int = 0;
/// `RTC_BUILD_QUALITY_LOW`: of a scene, a hierarchy a geometry, each of that geometry's quality
pub const QUALITY_LOW: c_int = 0;
/// `RTC_BUILD_QUALITY_MEDIUM`, the default
pub const QUALITY_MEDIUM: c_int = 1;
/// `RTC_BUILD_QUALITY_HIGH`
pub const QUALITY_HIGH: c_int = 2;
/// `RTC_BUILD_QUALITY_REFIT`, of a geometry
pub const QUALITY_REFIT: c_int = 3;
/// `RTC_SCENE_FLAG_NONE`
pub const SCENE_NONE: c_int = 0;
/// `RTC_SCENE_FLAG_DYNAMIC`
pub const SCENE_DYNAMIC: c_int = 1;
/// `RTC_SCENE_FLAG_ROBUST`
pub const SCENE_ROBUST: c_int = 1 << 2;
/// `RTC_INTERSECT_CONTEXT_FLAG_COHERENT`
pub const CONTEXT_COHERENT: c_int = 1;
/// `RTC_INVALID_GEOMETRY_ID`
pub const INVALID_GEOMETRY: c_uint = c_uint::MAX;

/// `RTCIntersectContext` of a library built for one level of instances and without minimal curve widths.
#[repr(C)]
pub struct IntersectContext {
    pub flags: c_int,
    pub filter: Option<unsafe extern "C" fn(*const c_void)>,
    pub instances: [c_uint; 1],
}

/// `RTCRay` (N = 1), `RTCRay8`, `RTCRay16`: aligned to what the widest of them asks for.
#[repr(C, align(64))]
pub struct Rays<const N: usize> {
    pub org_x: [f32; N],
    pub org_y: [f32; N],
    pub org_z: [f32; N],
    pub tnear: [f32; N],
    pub dir_x: [f32; N],
    pub dir_y: [f32; N],
    pub dir_z: [f32; N],
    pub time: [f32; N],
    /// Set to −∞ where the ray is blocked.
    pub tfar: [f32; N],
    pub mask: [c_uint; N],
    pub id: [c_uint; N],
    pub flags: [c_uint; N],
}

/// The `valid` argument of packets: −1 for rays that are traced, 0 for others.
#[repr(C, align(64))]
pub struct Valid<const N: usize>(pub [c_int; N]);

unsafe extern "C" {
    pub fn rtcNewDevice(config: *const c_char) -> Handle;
    pub fn rtcReleaseDevice(device: Handle);
    pub fn rtcGetDeviceError(device: Handle) -> c_int;
    pub fn rtcNewScene(device: Handle) -> Handle;
    pub fn rtcReleaseScene(scene: Handle);
    pub fn rtcSetSceneBuildQuality(scene: Handle, quality: c_int);
    pub fn rtcSetSceneFlags(scene: Handle, flags: c_int);
    pub fn rtcCommitScene(scene: Handle);
    pub fn rtcNewGeometry(device: Handle, kind: c_int) -> Handle;
    pub fn rtcReleaseGeometry(geometry: Handle);
    pub fn rtcCommitGeometry(geometry: Handle);
    pub fn rtcSetGeometryBuildQuality(geometry: Handle, quality: c_int);
    pub fn rtcGetGeometry(scene: Handle, id: c_uint) -> Handle;
    pub fn rtcGetGeometryBufferData(geometry: Handle, buffer: c_int, slot: c_uint) -> *mut c_void;
    pub fn rtcUpdateGeometryBuffer(geometry: Handle, buffer: c_int, slot: c_uint);
    pub fn rtcAttachGeometry(scene: Handle, geometry: Handle) -> c_uint;
    pub fn rtcSetNewGeometryBuffer(
        geometry: Handle,
        buffer: c_int,
        slot: c_uint,
        format: c_int,
        byte_stride: usize,
        items: usize,
    ) -> *mut c_void;
    pub fn rtcOccluded1(scene: Handle, context: *mut IntersectContext, ray: *mut Rays<1>);
    pub fn rtcOccluded8(valid: *const c_int, scene: Handle, context: *mut IntersectContext, rays: *mut Rays<8>);
    pub fn rtcOccluded16(valid: *const c_int, scene: Handle, context: *mut IntersectContext, rays: *mut Rays<16>);
}

const _: () = {
    assert!(size_of::<Rays<8>>() == 12 * 8 * 4);
    assert!(size_of::<Rays<16>>() == 12 * 16 * 4);
    assert!(std::mem::offset_of!(Rays<1>, flags) == 44);
    assert!(std::mem::offset_of!(IntersectContext, instances) == 16);
};
