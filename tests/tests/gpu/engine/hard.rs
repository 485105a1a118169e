//! Lights without extent in an engine's frame, beside one with an area.

use umbra4_core::{
    AnyLight, DirectionalLight, PointLight, Punctual,
    glam::{DVec3, IVec3},
    kernel::NOWHERE,
};
use umbra4_tests::{
    device::{buffer, read, read_layer, texture},
    hard_shadows::oracle,
};
use umbra4_wgpu::{
    Gpu, Image, Lamp, Light, SoftShadows,
    wgpu::{BufferUsages, TextureFormat, TextureUsages},
};

use super::{
    fixture::{Expected, SIZE, World, lattice, light},
    frames::{PIXELS, check_lattice, on_device, shadowed, submit, wish},
};

/// A word a pixel: 1 where the light is blocked, or nothing is seen.
fn masks(expected: &Expected, light: Punctual) -> Vec<u32> {
    let points: Vec<IVec3> = expected.receivers.iter().map(|p| IVec3::from_array(*p)).collect();
    let there = |p: &IVec3| p.to_array() != NOWHERE;
    let seen: Vec<IVec3> = points.iter().copied().filter(there).collect();
    let mut found = oracle(light, &seen, &expected.corners()).into_iter();
    points.iter().map(|p| if there(p) { found.next().expect("a bit each") as u32 } else { 1 }).collect()
}

pub fn lights_without_extent_are_exact(gpu: &Gpu) {
    let world = World::new(gpu, 21, wish(40));
    // Such that some receivers are in shadow, and others are not.
    let nowhere = world.expected.receivers.iter().filter(|p| **p == NOWHERE).count();
    let mixed = |light: Punctual| {
        let blocked: u32 = masks(&world.expected, light).iter().sum();
        (nowhere + PIXELS / 20..PIXELS * 19 / 20).contains(&(blocked as usize))
    };
    let points = (2..12).map(|k| PointLight { position: DVec3::new(0.3, 0.25 * f64::from(k), -0.2) });
    let point = points.into_iter().find(|point| mixed(point.snap(&lattice()).expect("inside"))).expect("a height");
    let suns = (1..12).map(|k| DirectionalLight { towards: DVec3::new(1.0, 0.15 * f64::from(k), -0.1) });
    let sun = suns.into_iter().find(|sun| mixed(sun.snap().expect("a direction"))).expect("a slope");
    let lamps: [Lamp; 3] = [point.into(), light(5, 9, 0.0).into(), sun.into()];
    let snapped = [point.snap(&lattice()).expect("inside"), sun.snap().expect("a direction")];
    let usage = TextureUsages::COPY_DST | TextureUsages::COPY_SRC;
    let target = texture(gpu, [SIZE[0], SIZE[1], 3], TextureFormat::R32Float, usage);
    let words = [1, 5, 1].map(|words| buffer(gpu, &vec![0xaa; 4 * words * PIXELS], BufferUsages::COPY_SRC));
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    // Twice: the second frame finds the buffers of the first.
    for _ in 0..2 {
        let asked: Vec<Light<'_>> = (0..)
            .zip(lamps)
            .map(|(layer, lamp)| Light {
                lamp,
                masks: Some(&words[layer as usize]),
                ..shadowed(light(5, 9, 0.0), Image::Texture { texture: &target, layer })
            })
            .collect();
        submit(gpu, |encoder| {
            let meshes = world.meshes();
            shadows.record(encoder, &world.frame(&meshes, &asked)).expect("the frame is sound");
        });
        check_lattice(&on_device(gpu, &shadows), &world.expected);
        for (light, layer) in snapped.into_iter().zip([0, 2]) {
            assert_eq!(shadows.snapped().expect("a frame").lights[layer], AnyLight::from(light));
            let expected = masks(&world.expected, light);
            let bytes = read(gpu, &words[layer], 4 * PIXELS as u64);
            assert!(bytemuck::pod_collect_to_vec::<u8, u32>(&bytes) == expected, "masks of {light:?}");
            let lit: Vec<u8> = expected.iter().flat_map(|blocked| (1.0 - *blocked as f32).to_le_bytes()).collect();
            assert!(read_layer(gpu, &target, layer as u32) == lit, "visibility of {light:?}");
        }
    }
}
