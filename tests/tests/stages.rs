//! Each kernel alone on a device, against the same function on the host, over the same input: a divergence names its kernel.
//! `UMBRA4_GPU` says which adapter must be there, see [`umbra4_tests::gpu::required`].

use std::collections::HashMap;

use libtest_mimic::{Arguments, Failed, Trial};
use umbra4_core::{
    Executor, Pass, Plan, SceneFacts,
    edge_plane::LightGrid,
    glam::IVec3,
    jitter::Pattern,
    kernel::{
        Access, Kernel,
        dispatch::{Dispatch, MaskLayout, Role, counters, dispatches},
        probe::{Helper, IN, OUT},
        resolve::stride,
    },
    order::CodeFrame,
    params::{JitteredParams, Params, PassParams},
    proj4::{KeyTile, Keys, covers},
};
use umbra4_tests::{
    alone::{OnDevice, on_host},
    compare::{Amount, compare_masks},
    gpu::announced,
    oracle::{behind, hit},
    rng::Rng,
    scene::Inputs,
    scenes::{self, EXPONENTS, GENERATORS},
};
use umbra4_wgpu::Gpu;

const SEEDS: u64 = 4;
/// Fewer receivers than most scenes have, so that blocks are tested as well.
const BLOCK: u32 = 96;

/// Runs every dispatch of a plan on the device and on the host, from the host's buffers, and compares what they wrote.
struct Lockstep<'a> {
    plan: &'a Plan,
    layout: MaskLayout,
    params: Params,
    pattern: Pattern,
    device: &'a mut OnDevice,
    buffers: HashMap<Role, Vec<u32>>,
    /// What the device made of the keys.
    device_keys: HashMap<Role, Vec<u32>>,
    masks: Vec<u32>,
    compared: HashMap<Kernel, usize>,
}

impl<'a> Lockstep<'a> {
    fn new(plan: &'a Plan, layout: MaskLayout, inputs: &Inputs, device: &'a mut OnDevice) -> Self {
        let grid = LightGrid::new(inputs.light);
        let points = inputs.occluders.vertices().iter().chain(inputs.receivers.points());
        let bounds = points.fold([IVec3::MAX, IVec3::MIN], |[low, high], p| [low.min(*p), high.max(*p)]);
        let params = Params::new(&grid, &CodeFrame::around(&grid.frame, bounds), plan.levels());
        let facts = plan.facts();
        let (triangles, receivers) = (facts.triangles as usize, facts.receivers as usize);
        let block = facts.block.min(facts.receivers) as usize;
        let sorted = triangles.max(block);
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
            words(Role::Masks, 1, block * layout.stride as usize + 1),
            words(Role::Counts, 4, block),
            words(Role::LitCounts, 1, receivers),
        ]);
        let device_keys = HashMap::from([(Role::TriangleKeys, Vec::new()), (Role::ReceiverKeys, Vec::new())]);
        let pattern = Pattern::of(&inputs.light);
        Self {
            plan,
            layout,
            params,
            pattern,
            device,
            buffers,
            device_keys,
            masks: Vec::new(),
            compared: HashMap::new(),
        }
    }

    fn step(&mut self, dispatch: &Dispatch<'_>) -> Result<(), String> {
        let Dispatch { kernel, pass, roles } = *dispatch;
        let params = JitteredParams { params: self.params.with_pass(&pass), pattern: self.pattern };
        let mut host: Vec<Vec<u32>> = roles.iter().map(|role| self.buffers[role].clone()).collect();
        let mut device = host.clone();
        self.device.run(kernel, &params, &mut device);
        on_host(kernel, &params, &mut host);
        let keys = matches!(kernel, Kernel::KeyTriangles | Kernel::KeyReceivers);
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

/// The device's keys keep every pair that the oracle finds relevant.
fn check_coverage(inputs: &Inputs, triangle_keys: &[Keys], receiver_keys: &[Keys]) -> Result<usize, String> {
    let light = &inputs.light;
    let pairs = (0..light.rows).flat_map(|i| (0..light.columns).map(move |j| (i, j)));
    let samples: Vec<IVec3> = pairs.map(|(i, j)| light.sample(i, j)).collect();
    let mut relevant = 0;
    for (r, &p) in inputs.receivers.points().iter().enumerate() {
        if behind(light, p) {
            continue;
        }
        for (t, &corners) in inputs.triangles().iter().enumerate() {
            if samples.iter().any(|&sample| hit(p, sample, corners)) {
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
    let (mut relevant, mut words) = (0, 0);
    for seed in 0..SEEDS {
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
        let layout = MaskLayout { resolve, stride: stride(inputs.light.rows, bits), counted, slice: 256 };
        let plan = Plan::new(SceneFacts {
            triangles: inputs.occluders.triangles().len() as u32,
            receivers: inputs.receivers.len() as u32,
            visibility: true,
            block: BLOCK,
            jittered,
            ..SceneFacts::default()
        });
        let mut lockstep = Lockstep::new(&plan, layout, &inputs, &mut device);
        plan.run(&mut lockstep).map_err(|error| format!("seed {seed}: {error}"))?;
        let expected = inputs.oracle();
        let got = mask_rows(&lockstep.masks, &inputs, bits);
        let amount = if expected.is_empty() { Amount::None } else { Amount::Some };
        compare_masks(&expected, &got, inputs.light.rows, inputs.light.columns, amount)
            .map_err(|error| format!("seed {seed}: {error}"))?;
        let [triangles, receivers] =
            [Role::TriangleKeys, Role::ReceiverKeys].map(|role| keys(&lockstep.device_keys[&role]));
        relevant += check_coverage(&inputs, &triangles, &receivers).map_err(|error| format!("seed {seed}: {error}"))?;
        words += lockstep.compared.values().sum::<usize>();
    }
    println!("{name}: {words} words of every kernel are the host's; {relevant} relevant pairs are kept");
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
        let params = <Params as bytemuck::Zeroable>::zeroed().with_pass(&pass);
        let params = JitteredParams { params, ..bytemuck::Zeroable::zeroed() };
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

fn main() {
    let arguments = Arguments::from_args();
    let (gpu, missing) = announced();
    type Check = Box<dyn FnOnce(&Gpu) -> Result<(), Failed> + Send>;
    let mut checks: Vec<(String, Check)> = vec![("every_integer_helper".to_owned(), Box::new(every_integer_helper))];
    for (index, (name, _)) in GENERATORS.iter().enumerate() {
        checks.push((format!("every_kernel_alone::{name}"), Box::new(move |gpu| every_kernel_alone(gpu, index))));
    }
    let trials = checks.into_iter().map(|(name, check)| {
        let gpu = gpu.clone();
        let trial = Trial::test(name, move || check(&gpu.map_err(Failed::from)?));
        trial.with_ignored_flag(missing)
    });
    libtest_mimic::run(&arguments, trials.collect()).exit();
}
