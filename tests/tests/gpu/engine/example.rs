//! The example engine: what umbra4 recorded into its frames is what the CPU executor finds for the same lattice.

use umbra4_core::{
    Lattice, Lift,
    glam::{DVec3, IVec3},
    kernel::NOWHERE,
};
use umbra4_cpu::{CpuExecutor, Occluders, Receivers};
use umbra4_tests::device::{read_layer, texture};
use umbra4_wgpu::{
    Gpu, VisibilityFormat,
    wgpu::{CommandEncoderDescriptor, TextureFormat, TextureUsages, TextureViewDescriptor},
};

use super::frames::{on_device, submit};
use crate::{renderer::Renderer, scene};

const SIZE: [u32; 2] = [128, 72];
const SAMPLES: u32 = 256;

pub fn the_example_engine_has_the_shadows_of_the_cpu(gpu: &Gpu) {
    let picture = texture(gpu, [SIZE[0], SIZE[1], 1], TextureFormat::Rgba8Unorm, TextureUsages::RENDER_ATTACHMENT)
        .create_view(&TextureViewDescriptor::default());
    let mut engine = Renderer::new(&gpu.device, &gpu.queue, SIZE, TextureFormat::Rgba8Unorm).expect("it starts");
    for time in [0.0, 2.0, 7.5] {
        submit(gpu, |encoder| engine.frame(encoder, &picture, time).expect("the frame is sound"));
        let got = read_layer(gpu, engine.visibility(), 0);
        let got: Vec<u16> = bytemuck::pod_collect_to_vec(&got);
        let expected = on_cpu(gpu, &engine, time);
        let differing = got.iter().zip(&expected).filter(|(got, lit)| **got != half(**lit)).count();
        assert_eq!(got.len(), expected.len());
        assert_eq!(differing, 0, "pixels differ at {time} s");
        let share =
            |lit: fn(u32) -> bool| expected.iter().filter(|count| lit(**count)).count() as f64 / got.len() as f64;
        let (umbra, penumbra, lit) = (share(|n| n == 0), share(|n| n > 0 && n < SAMPLES), share(|n| n == SAMPLES));
        println!("{time} s: {umbra:.3} dark, {penumbra:.3} penumbra, {lit:.3} lit, {differing} differing");
        assert!(umbra > 0.02 && penumbra > 0.02 && lit > 0.2, "the picture shows something");
    }
}

fn half(lit: u32) -> u16 {
    VisibilityFormat::Float16.bits(lit, SAMPLES) as u16
}

/// Lit counts of all pixels.
fn on_cpu(gpu: &Gpu, engine: &Renderer, time: f32) -> Vec<u32> {
    let lattice = Lattice::covering(scene::bounds()).expect("finite bounds");
    let got = on_device(gpu, engine.shadows());
    assert_eq!(got.status, umbra4_wgpu::Status::default(), "nothing is refused");
    let world = |p: &[i32; 3]| -> DVec3 { lattice.to_world(IVec3::from_array(*p)) };
    let vertices: Vec<DVec3> = got.vertices.iter().map(world).collect();
    let occluders = Occluders::from_f64(&lattice, &vertices, &got.triangles).expect("all are on the lattice");
    let seen: Vec<DVec3> = got.receivers.iter().filter(|p| **p != NOWHERE).map(world).collect();
    let receivers = Receivers::raw_f64(&lattice, &seen).expect("all are on the lattice");
    let light = scene::area_light(time).and_then(|light| light.snap(&lattice, Lift::NONE)).expect("a light");
    let (visibility, _) = CpuExecutor::new().visibility(&occluders, &light, &receivers).expect("it fits");
    let mut visibility = visibility.iter();
    let mut lit = |p: &[i32; 3]| match *p == NOWHERE {
        true => 0,
        false => (visibility.next().expect("one each") * SAMPLES as f32).round() as u32,
    };
    got.receivers.iter().map(&mut lit).collect()
}

/// A second size, after the first.
pub fn the_example_engine_can_be_resized(gpu: &Gpu) {
    let mut engine = Renderer::new(&gpu.device, &gpu.queue, SIZE, TextureFormat::Rgba8Unorm).expect("it starts");
    for size in [SIZE, [33, 60], [150, 20]] {
        engine.resize(size);
        let picture = texture(gpu, [size[0], size[1], 1], TextureFormat::Rgba8Unorm, TextureUsages::RENDER_ATTACHMENT)
            .create_view(&TextureViewDescriptor::default());
        let mut encoder = gpu.device.create_command_encoder(&CommandEncoderDescriptor::default());
        engine.frame(&mut encoder, &picture, 1.0).expect("the frame is sound");
        gpu.queue.submit([encoder.finish()]);
        let got: Vec<u16> = bytemuck::pod_collect_to_vec(&read_layer(gpu, engine.visibility(), 0));
        let expected: Vec<u16> = on_cpu(gpu, &engine, 1.0).iter().map(|lit| half(*lit)).collect();
        assert!(got == expected, "pixels differ at {size:?}");
    }
}
