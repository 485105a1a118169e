//! Each kernel alone on a device, against the same function on the host, over the same input: a divergence names its kernel.

use std::{cell::RefCell, collections::HashMap};

use libtest_mimic::Failed;
use umbra4_core::{
    Executor, Facing, Pass, Plan, Punctual, SceneFacts,
    edge_plane::LightGrid,
    emission::WHOLE,
    glam::IVec3,
    jitter::Pattern,
    kernel::{
        Access, Kernel,
        dispatch::{Dispatch, MaskLayout, Reduction, Role, counters, dispatches},
        pack_light::{CHANNELS, whole},
        probe::{Helper, IN, OUT},
        resolve::stride,
        weigh::packed,
    },
    order::CodeFrame,
    params::{JitteredParams, Params, PassParams, PunctualParams},
    proj4::{KeyTile, Keys, covers},
};
use umbra4_tests::{
    alone::{OnDevice, Told, on_host},
    budget,
    compare::{Amount, compare_masks},
    facings::{self, settled},
    gpu::{Test, test},
    hard_shadows::property,
    ledger::say,
    oracle::{behind, hit, hit_towards},
    rng::Rng,
    scene::Inputs,
    scenes::{self, EXPONENTS, GENERATORS},
    weights::{expected, weights},
};
use umbra4_wgpu::Gpu;

const SEEDS: u64 = 4;
/// Scenes of each generator with lights without extent, of which there are many in each.
const PUNCTUAL_ROUNDS: usize = 2;
/// Fewer receivers than most scenes have, so that blocks are tested as well.
const BLOCK: u32 = 96;

/// Runs every dispatch of a plan on the device and on the host, from the host's buffers, and compares what they wrote.
struct Lockstep<'a> {
    plan: &'a Plan,
    layout: MaskLayout,
    told: Told,
    device: &'a mut OnDevice,
    buffers: HashMap<Role, Vec<u32>>,
    /// What the device made of the keys.
    device_keys: HashMap<Role, Vec<u32>>,
    masks: Vec<u32>,
    compared: HashMap<Kernel, usize>,
}

impl<'a> Lockstep<'a> {
    fn new(plan: &'a Plan, layout: MaskLayout, told: Told, inputs: &Inputs, device: &'a mut OnDevice) -> Self {
        let facts = plan.facts();
        let (triangles, receivers) = (facts.triangles as usize, facts.receivers as usize);
        let block = facts.block.min(facts.receivers) as usize;
        let sorted = triangles.max(block);
        let masked = if facts.punctual { receivers } else { block };
        // Nothing empty can be bound.
        let words = |role, each: usize, count: usize| (role, vec![0_u32; each * count.max(1)]);
        let given = |role, bytes: &[u8]| {
            let bytes = if bytes.is_empty() { &[0; 12] } else { bytes };
            (role, bytemuck::pod_collect_to_vec(bytes))
        };
        let buffers = HashMap::from([
            given(Role::Vertices, bytemuck::cast_slice(inputs.occluders.vertices())),
            given(Role::Triangles, bytemuck::cast_slice(inputs.occluders.triangles())),
            given(Role::Receivers, bytemuck::cast_slice(inputs.receivers.points())),
            words(Role::TriangleKeys, 5, triangles),
            words(Role::TriangleOrder, 2, triangles),
            words(Role::SpareOrder, 2, sorted),
            words(Role::Counters, 1, counters(sorted as u32) as usize),
            words(Role::Occluders, 12, triangles),
            words(Role::Nodes, size_of::<KeyTile>() / 4, plan.levels().tiles()),
            words(Role::ReceiverKeys, 5, block),
            words(Role::ReceiverOrder, 2, block),
            words(Role::Masks, 1, masked * layout.stride as usize + 1),
            words(Role::Counts, 4, masked),
            words(Role::LitCounts, 1, receivers),
            words(Role::WeighedLight, 3, receivers),
        ]);
        let device_keys = HashMap::from([(Role::TriangleKeys, Vec::new()), (Role::ReceiverKeys, Vec::new())]);
        Self { plan, layout, told, device, buffers, device_keys, masks: Vec::new(), compared: HashMap::new() }
    }

    fn set_facings(&mut self, facings: &[Facing]) {
        self.buffers.insert(Role::Facings, facings.iter().map(|facing| facing.word()).collect());
    }

    fn step(&mut self, dispatch: &Dispatch<'_>) -> Result<(), String> {
        let Dispatch { kernel, pass, roles } = *dispatch;
        let told = self.told.with_pass(&pass);
        let mut host: Vec<Vec<u32>> = roles.iter().map(|role| self.buffers[role].clone()).collect();
        let mut device = host.clone();
        self.device.run(kernel, &told, &mut device);
        on_host(kernel, &told, &mut host);
        let keys = matches!(
            kernel,
            Kernel::KeyTriangles | Kernel::KeyReceivers | Kernel::KeyPunctualTriangles | Kernel::KeyPunctualReceivers
        );
        for (k, role) in roles.iter().enumerate() {
            if kernel.info().bound[k].access != Access::Write {
                continue;
            }
            if keys && k + 1 < roles.len() {
                let all = self.device_keys.get_mut(role).ok_or("no keys")?;
                all.extend(&device[k][..5 * pass.count as usize]);
            }
            // Keys, and the codes made of them, are floats: they may differ, and have to cover what is relevant.
            if !keys {
                // How many signs go to the integers depends on how a device rounds.
                let counted = |word: usize| *role != Role::Counts || word % 4 != 3;
                let differs = (0..host[k].len()).find(|&word| counted(word) && device[k][word] != host[k][word]);
                if let Some(word) = differs {
                    let (got, want) = (device[k][word], host[k][word]);
                    return Err(format!("{kernel:?} {pass:?}: {role:?}[{word}] is {got:#x}, not {want:#x}"));
                }
                *self.compared.entry(kernel).or_default() += host[k].len();
            }
            self.buffers.insert(*role, host[k].clone());
        }
        Ok(())
    }
}

impl Executor for Lockstep<'_> {
    type Error = String;

    fn dispatch(&mut self, pass: &Pass) -> Result<(), String> {
        let (plan, layout) = (self.plan, self.layout);
        dispatches(plan, &layout, pass, &mut |dispatch| self.step(dispatch))?;
        if pass.stage == umbra4_core::stage::Stage::Reduce {
            let count = pass.count as usize * layout.stride as usize;
            self.masks.extend(&self.buffers[&Role::Masks][..count]);
        }
        Ok(())
    }
}

fn keys(words: &[u32]) -> Vec<Keys> {
    words.chunks_exact(5).map(|own| std::array::from_fn(|k| f32::from_bits(own[k]))).collect()
}

fn bounds(inputs: &Inputs) -> [IVec3; 2] {
    let points = inputs.occluders.vertices().iter().chain(inputs.receivers.points());
    points.fold([IVec3::MAX, IVec3::MIN], |[low, high], p| [low.min(*p), high.max(*p)])
}

/// Whether a triangle blocks a sample that receivers before the light could see.
fn blocks_samples(inputs: &Inputs) -> impl Fn(IVec3, [IVec3; 3]) -> bool {
    let light = inputs.light;
    let pairs = (0..light.rows).flat_map(|i| (0..light.columns).map(move |j| (i, j)));
    let samples: Vec<IVec3> = pairs.map(|(i, j)| light.sample(i, j)).collect();
    move |p, corners| !behind(&light, p) && samples.iter().any(|&sample| hit(p, sample, corners))
}

/// The device's keys, in a lockstep, keep every pair that the oracle finds relevant.
fn check_coverage(
    inputs: &Inputs,
    lockstep: &Lockstep<'_>,
    is_relevant: impl Fn(IVec3, [IVec3; 3]) -> bool,
) -> Result<usize, String> {
    let [triangle_keys, receiver_keys] =
        [Role::TriangleKeys, Role::ReceiverKeys].map(|role| keys(&lockstep.device_keys[&role]));
    let mut relevant = 0;
    for (r, &p) in inputs.receivers.points().iter().enumerate() {
        for (t, &corners) in inputs.triangles().iter().enumerate() {
            if is_relevant(p, corners) {
                relevant += 1;
                if !covers(&triangle_keys[t], &receiver_keys[r]) {
                    return Err(format!("triangle {t} blocks receiver {r}, but is not kept: {p}, {corners:?}"));
                }
            }
        }
    }
    Ok(relevant)
}

/// Masks of `rows` words of `bits` bits, from words of 32 bits.
fn mask_rows(masks: &[u32], inputs: &Inputs, bits: u32) -> Vec<u64> {
    let (rows, stride) = (inputs.light.rows as usize, stride(inputs.light.rows, bits) as usize);
    let row = |mask: &[u32], i: usize| match bits {
        16 => u64::from(mask[i / 2] >> (16 * (i % 2)) & 0xffff),
        32 => u64::from(mask[i]),
        _ => u64::from(mask[2 * i]) | u64::from(mask[2 * i + 1]) << 32,
    };
    masks.chunks_exact(stride).flat_map(|mask| (0..rows).map(move |i| row(mask, i))).collect()
}

fn every_kernel_alone(gpu: &Gpu, generator: usize) -> Result<(), Failed> {
    let (name, generate) = GENERATORS[generator];
    let mut device = OnDevice::new(gpu);
    let (mut relevant, mut words, mut away) = (0, 0, 0);
    for seed in 0..budget::of(SEEDS) {
        let mut rng = Rng::named(seed, name);
        let mut samples = scenes::grid(&mut rng, [16, 32, 64][seed as usize % 3]);
        if seed >= 2 {
            samples = samples.jittered(&mut rng);
        }
        let inputs = generate(&mut rng, samples).inputs(EXPONENTS[seed as usize % EXPONENTS.len()]);
        let bits = match inputs.light.columns {
            ..=16 => 16,
            17..=32 => 32,
            _ => 64,
        };
        let counted = seed % 2 == 1;
        let jittered = inputs.light.jitter.is_some();
        let resolve = match (bits, jittered, counted) {
            (..=32, false, false) => Kernel::Resolve32Exact,
            (..=32, false, true) => Kernel::Resolve32ExactCounted,
            (..=32, true, false) => Kernel::Resolve32ExactJittered,
            (..=32, true, true) => Kernel::Resolve32ExactJitteredCounted,
            (_, false, false) => Kernel::Resolve64Exact,
            (_, false, true) => Kernel::Resolve64ExactCounted,
            (_, true, false) => Kernel::Resolve64ExactJittered,
            (_, true, true) => Kernel::Resolve64ExactJitteredCounted,
        };
        let layout = MaskLayout {
            resolve,
            stride: stride(inputs.light.rows, bits),
            counted,
            slice: 256,
            reduction: Reduction::Both,
        };
        // Receivers that face some way, of a regular and of a jittered light.
        let facings = if seed % 3 == 0 { facings_of(&inputs, seed) } else { Vec::new() };
        let plan = Plan::new(SceneFacts {
            triangles: inputs.occluders.triangles().len() as u32,
            receivers: inputs.receivers.len() as u32,
            visibility: true,
            block: BLOCK,
            facing: !facings.is_empty(),
            jittered,
            ..SceneFacts::default()
        });
        let grid = LightGrid::new(inputs.light);
        let params = Params::new(&grid, &CodeFrame::around(&grid.frame, bounds(&inputs)), plan.levels());
        let told = Told::Area(JitteredParams { params, pattern: Pattern::of(&inputs.light) });
        let weights = weights(&mut Rng::named(seed, "weights"), inputs.light.sample_count() as usize);
        let mut lockstep = Lockstep::new(&plan, layout, told, &inputs, &mut device);
        let all_weights = weights.iter().flat_map(|weight| packed(*weight)).collect();
        lockstep.buffers.insert(Role::Weights, all_weights);
        lockstep.set_facings(&facings);
        plan.run(&mut lockstep).map_err(|error| format!("seed {seed}: {error}"))?;
        let full = vec![u64::MAX >> (64 - inputs.light.columns); inputs.light.rows as usize];
        let is_away = |r: usize, facing: Facing| facing.is_away_from(&inputs.light, inputs.receivers.points()[r]);
        let masks = settled(inputs.oracle(), &full, &facings, is_away);
        away += facings.iter().enumerate().filter(|(r, facing)| is_away(*r, **facing)).count();
        let got = mask_rows(&lockstep.masks, &inputs, bits);
        let amount = if masks.is_empty() { Amount::None } else { Amount::Some };
        compare_masks(&masks, &got, inputs.light.rows, inputs.light.columns, amount)
            .map_err(|error| format!("seed {seed}: {error}"))?;
        if facings.is_empty() {
            let sums = expected(&inputs, &weights).concat();
            let weighed = lockstep.buffers[&Role::WeighedLight].iter().map(|sum| u64::from(*sum));
            assert!(weighed.take(sums.len()).eq(sums), "seed {seed}: sums of weights");
        }
        relevant += check_coverage(&inputs, &lockstep, blocks_samples(&inputs))
            .map_err(|error| format!("seed {seed}: {error}"))?;
        words += lockstep.compared.values().sum::<usize>();
    }
    assert!(away > 0, "{name}: no receiver faces away");
    println!(
        "{name}: {words} words of every kernel are the host's; {relevant} relevant pairs are kept; {away} receivers face away"
    );
    Ok(())
}

/// Facings of all receivers.
fn facings_of(inputs: &Inputs, seed: u64) -> Vec<Facing> {
    let normals = facings::normals(&mut Rng::named(seed, "facings"), inputs, &facings::samples(inputs));
    normals.into_iter().map(Facing::of).collect()
}

/// The kernels of lights without extent, face by face, certified or not, counted or not.
fn every_punctual_kernel_alone(gpu: &Gpu, generator: usize) -> Result<(), Failed> {
    let (name, _) = GENERATORS[generator];
    let device = RefCell::new(OnDevice::new(gpu));
    let (relevant, lights) = (RefCell::new(0), RefCell::new(0));
    let compared = property(name, budget::of(PUNCTUAL_ROUNDS), |inputs, light| {
        let counted = *lights.borrow() % 2 == 1;
        *lights.borrow_mut() += 1;
        let (found, bits) = punctual_masks(inputs, light, counted, &[], &mut device.borrow_mut())?;
        *relevant.borrow_mut() += found;
        if counted {
            let facings = facings_of(inputs, 7);
            let (_, settled) = punctual_masks(inputs, light, counted, &facings, &mut device.borrow_mut())?;
            let is_away = |(facing, p): (&Facing, &IVec3)| facing.is_away_from_punctual(*light, *p);
            let away = facings.iter().zip(inputs.receivers.points()).map(is_away);
            if !settled.iter().copied().eq(bits.iter().zip(away).map(|(bit, away)| bit | u16::from(away))) {
                return Err("receivers that face away".to_owned());
            }
        }
        Ok(bits)
    });
    let (lights, relevant) = (lights.into_inner(), relevant.into_inner());
    say(&format!(
        "kernels of lights without extent, each alone, {name}: {lights} lights, {} bits are the oracle's; {relevant} relevant \
         pairs are kept",
        compared.bits
    ));
    Ok(())
}

/// Relevant pairs, and a bit a receiver.
fn punctual_masks(
    inputs: &Inputs,
    light: &Punctual,
    counted: bool,
    facings: &[Facing],
    device: &mut OnDevice,
) -> Result<(usize, Vec<u16>), String> {
    let points = inputs.receivers.points();
    let resolve = if counted { Kernel::ResolvePunctualExactCounted } else { Kernel::ResolvePunctualExact };
    let layout = MaskLayout { resolve, stride: 1, counted, slice: 256, reduction: Reduction::LitCounts };
    let with = |face: &u32| points.iter().any(|p| light.face_of(*p) == Some(*face));
    let mut faces: Vec<u32> = (0..light.faces()).filter(with).collect();
    if faces.is_empty() {
        faces.push(0);
    }
    let (mut relevant, mut masks, mut counts) = (0, None, None);
    for (place, &face) in faces.iter().enumerate() {
        let plan = Plan::new(SceneFacts {
            triangles: inputs.occluders.triangles().len() as u32,
            receivers: points.len() as u32,
            visibility: place + 1 == faces.len(),
            block: BLOCK,
            facing: !facings.is_empty(),
            punctual: true,
            ..SceneFacts::default()
        });
        let codes = CodeFrame::around(light.frame(face).light_frame(), bounds(inputs));
        let told = Told::Punctual(PunctualParams::new(light, face, &codes, plan.levels()));
        let mut lockstep = Lockstep::new(&plan, layout, told, inputs, device);
        lockstep.set_facings(facings);
        // Those of the faces before are kept.
        for (role, before) in [(Role::Masks, masks.take()), (Role::Counts, counts.take())] {
            if let Some(before) = before {
                lockstep.buffers.insert(role, before);
            }
        }
        plan.run(&mut lockstep).map_err(|error| format!("face {face}: {error}"))?;
        relevant += check_coverage(inputs, &lockstep, |p, corners| {
            let blocked = match (light.position(), light.towards()) {
                (Some(position), _) => hit(p, position, corners),
                (_, towards) => hit_towards(p, towards.unwrap_or_default(), corners),
            };
            light.face_of(p) == Some(face) && blocked
        })?;
        masks = lockstep.buffers.remove(&Role::Masks);
        counts = lockstep.buffers.remove(&Role::Counts);
        if place + 1 == faces.len() {
            let lit = &lockstep.buffers[&Role::LitCounts];
            let of_masks = lockstep.masks.iter().map(|blocked| 1 - blocked);
            if !lit.iter().copied().take(points.len()).eq(of_masks) {
                return Err("lit counts are not those of the masks".to_owned());
            }
        }
    }
    let masks = masks.unwrap_or_default();
    Ok((relevant, masks.iter().take(points.len()).map(|word| *word as u16).collect()))
}

/// Sums of weights as pictures, of every size of a light that rounds in its own way.
fn every_picture_of_light(gpu: &Gpu) -> Result<(), Failed> {
    const SIZE: [u32; 2] = [37, 29];
    let mut device = OnDevice::new(gpu);
    let mut rng = Rng::new(23);
    for (samples, texels) in [(1, 1), (1, 2), (63, 1), (256, 2), (4096, 1), (4096, 2)] {
        let all = whole(samples);
        let sums: Vec<u32> = (0..3 * SIZE[0] * SIZE[1])
            .map(|_| match rng.below(5) {
                0 => 0,
                1 => all,
                2 => all - 1,
                3 => 1 + rng.below(1000) as u32,
                _ => (rng.next_u64() % u64::from(all + 1)) as u32,
            })
            .collect();
        let words = SIZE[0] * CHANNELS / texels;
        let pitch = words + 5;
        let pass = PassParams {
            count: pitch * SIZE[1],
            width: SIZE[0],
            pitch,
            texels,
            elements: all,
            ..PassParams::default()
        };
        let told = Told::from(<Params as bytemuck::Zeroable>::zeroed()).with_pass(&pass);
        let mut host = [sums.clone(), vec![7; (pitch * SIZE[1]) as usize]];
        let mut got = host.clone();
        on_host(Kernel::PackLight, &told, &mut host);
        device.run(Kernel::PackLight, &told, &mut got);
        assert!(got[1] == host[1], "{samples} samples, {texels} channels a word");
        let lines = got[1].chunks_exact(pitch as usize).flat_map(|line| &line[..words as usize]);
        let channels: Vec<u8> = lines.flat_map(|word| word.to_le_bytes()).collect();
        let size = if texels == 2 { 2 } else { 4 };
        for (k, channel) in channels.chunks_exact(size).enumerate() {
            let sum = if k % 4 == 3 { all } else { sums[k / 4 * 3 + k % 4] };
            let part = f64::from(sum) / f64::from(samples * u32::from(WHOLE));
            // f64 has digits enough for one rounding to be the only one.
            let bits = match channel {
                [a, b] => u32::from(u16::from_le_bytes([*a, *b])),
                _ => bytemuck::pod_read_unaligned(channel),
            };
            let wanted =
                if size == 2 { u32::from(half::f16::from_f64(part).to_bits()) } else { (part as f32).to_bits() };
            assert_eq!(bits, wanted, "{sum} of {all}");
        }
    }
    Ok(())
}

/// Words in which carries run, and any.
fn word(rng: &mut Rng) -> u32 {
    let any = rng.next_u64() as u32;
    match rng.below(6) {
        0 => 0,
        1 => u32::MAX,
        2 => 1 << (any % 32),
        3 => (1_u32 << (any % 32)).wrapping_neg(),
        4 => (1_u32 << (any % 32)).wrapping_sub(1),
        _ => any,
    }
}

fn every_integer_helper(gpu: &Gpu) -> Result<(), Failed> {
    const PROBES: usize = 20_000;
    let mut device = OnDevice::new(gpu);
    let mut rng = Rng::new(17);
    for helper in Helper::ALL {
        let mut words: Vec<u32> = (0..IN * PROBES).map(|_| word(&mut rng)).collect();
        if matches!(helper, Helper::Word | Helper::Pair) {
            let most = if helper == Helper::Pair { 65 } else { 33 };
            for probe in words.chunks_exact_mut(IN) {
                (probe[2], probe[3]) = (rng.below(most) as u32, rng.below(most) as u32);
            }
        }
        let pass = PassParams { count: PROBES as u32, shift: helper as u32, ..PassParams::default() };
        let params = Told::from(<Params as bytemuck::Zeroable>::zeroed()).with_pass(&pass);
        let mut host = [words.clone(), vec![0; OUT * PROBES]];
        let mut got = host.clone();
        on_host(Kernel::Probe, &params, &mut host);
        device.run(Kernel::Probe, &params, &mut got);
        let differs = host[1].iter().zip(&got[1]).position(|(a, b)| a != b);
        if let Some(word) = differs {
            let given = &words[word / OUT * IN..][..IN];
            return Err(format!("{helper:?} of {given:x?}: {:x}, not {:x}", got[1][word], host[1][word]).into());
        }
        let distinct: std::collections::HashSet<&[u32]> = host[1].chunks_exact(OUT).collect();
        assert!(distinct.len() > 2, "{helper:?} gives only {} different answers", distinct.len());
    }
    Ok(())
}

pub fn tests() -> Vec<Test> {
    let mut tests = vec![
        test("every_integer_helper", every_integer_helper),
        test("every_picture_of_light", every_picture_of_light),
    ];
    for (index, (name, _)) in GENERATORS.iter().enumerate() {
        tests.push(test(format!("every_kernel_alone::{name}"), move |gpu| every_kernel_alone(gpu, index)));
        let punctual = move |gpu: &Gpu| every_punctual_kernel_alone(gpu, index);
        tests.push(test(format!("every_punctual_kernel_alone::{name}"), punctual));
    }
    tests
}
