//! The kernels of stochastic soft shadow maps, one id after the other on the host: what a GPU runs, without a GPU.

use std::convert::Infallible;

use umbra4_core::Facing;
use umbra4_maps::{
    kernel::{
        MapKernel,
        stochastic::{levels, light_field, passes::passes, radii, receivers, samples, tiles},
    },
    stochastic::{
        StochasticOptions,
        elementary::Elementary,
        fit::Fit,
        gather::Gathered,
        params::LensParams,
        tiles::tiles_start,
        trace::{Corners, NOTHING, NOWHERE, Node},
        tree::Tree,
    },
};

use crate::scene::Inputs;

/// In which order ids run: on a GPU, in any.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ids {
    /// From 0 on.
    Forward,
    /// From the last on.
    Backward,
    /// By steps that have no divisor in common with their number.
    Scattered,
}

impl Ids {
    fn run(self, count: u32, mut kernel: impl FnMut(usize)) {
        // A prime beyond the number of ids of every test.
        const STEP: u64 = 1_000_003;
        for k in 0..count {
            let id = match self {
                Self::Forward => k,
                Self::Backward => count - 1 - k,
                Self::Scattered => (u64::from(k) * STEP % u64::from(count)) as u32,
            };
            kernel(id as usize);
        }
        // Threads of the last workgroup that have nothing to do.
        kernel(count as usize);
    }
}

/// What kernels are bound to. What is not written by a pass before it is read holds rubbish at first.
struct Memory {
    vertices: Vec<[i32; 3]>,
    triangles: Vec<[u32; 3]>,
    order: Vec<u32>,
    placed: Vec<Corners>,
    nodes: Vec<Node>,
    depths: Vec<f32>,
    receivers: Vec<[i32; 3]>,
    facings: Vec<u32>,
    tiles: Vec<u32>,
    heads: Vec<u32>,
    next: Vec<u32>,
    samples: Vec<Elementary>,
    found: Vec<f32>,
    raised: Vec<f32>,
    widest: Vec<f32>,
    gathered: Vec<Gathered>,
    resolved: Vec<Gathered>,
    sums: Vec<Gathered>,
    visibility: Vec<f32>,
}

const RUBBISH: f32 = 7.25e8;

impl Memory {
    fn new(inputs: &Inputs, params: &LensParams) -> Self {
        let (texels, all) = ((params.size * params.size) as usize, params.level_start(params.levels) as usize);
        let tiles = tiles_start(params, params.levels) as usize;
        let (points, triangles) = (inputs.receivers.points(), inputs.occluders.triangles());
        let gathered = Gathered { weight: RUBBISH, moments: [RUBBISH; 4] };
        let sample = Elementary { weight: RUBBISH, radius: RUBBISH, ..Elementary::NONE };
        Self {
            vertices: inputs.occluders.vertices().iter().map(|p| p.to_array()).collect(),
            triangles: triangles.to_vec(),
            // Any order will do: the last triangle first.
            order: (0..triangles.len() as u32).rev().collect(),
            placed: vec![NOWHERE; triangles.len()],
            nodes: vec![NOTHING; Tree::new(params.triangles).nodes() as usize],
            depths: vec![RUBBISH; texels],
            receivers: points.iter().map(|p| p.to_array()).collect(),
            facings: inputs.receivers.facings().iter().copied().map(Facing::word).collect(),
            tiles: vec![0; tiles],
            heads: vec![3; texels],
            next: vec![5; texels],
            samples: vec![sample; all],
            found: vec![RUBBISH; texels],
            raised: vec![RUBBISH; texels],
            widest: vec![RUBBISH; tiles],
            gathered: vec![gathered; all],
            resolved: vec![gathered; all],
            sums: vec![Gathered::NONE; points.len()],
            visibility: vec![RUBBISH; points.len()],
        }
    }

    fn run(&mut self, kernel: MapKernel, id: usize, p: &LensParams) {
        let m = self;
        match kernel {
            MapKernel::PlaceTriangles => {
                light_field::place_triangles(id, p, &m.vertices, &m.triangles, &m.order, &mut m.placed);
            }
            MapKernel::BoundTriangles => light_field::bound_triangles(id, p, &m.placed, &mut m.nodes),
            MapKernel::BoundNodes => light_field::bound_nodes(id, p, &mut m.nodes),
            MapKernel::SampleLightField => light_field::sample_light_field(id, p, &m.placed, &m.nodes, &mut m.depths),
            MapKernel::MarkLookedAt => tiles::mark_looked_at(id, p, &m.receivers, &mut m.tiles, set),
            MapKernel::MarkActive => tiles::mark_active(id, p, &mut m.tiles, set),
            MapKernel::MarkData => tiles::mark_data(id, p, &mut m.tiles, set),
            MapKernel::MarkMerged => tiles::mark_merged(id, p, &mut m.tiles, set),
            MapKernel::ClearLists => samples::clear_lists(id, p, &mut m.heads),
            MapKernel::LinkSamples => samples::link_samples(id, p, &mut m.heads, &mut m.next, std::mem::replace),
            MapKernel::MergeSamples => {
                samples::merge_samples(id, p, &m.tiles, &m.heads, &m.next, &m.depths, &mut m.samples);
            }
            MapKernel::FindClosest => radii::find_closest(id, p, &m.tiles, &m.samples, &mut m.found),
            MapKernel::RaiseRadii => radii::raise_radii(id, p, &m.tiles, &m.samples, &m.found, &mut m.raised),
            MapKernel::LendRadii => radii::lend_radii(id, p, &m.raised, &mut m.samples),
            MapKernel::CoarsenSamples => levels::coarsen_samples(id, p, &m.tiles, &mut m.samples),
            MapKernel::FindWidest => levels::find_widest(id, p, &m.samples, &mut m.widest),
            MapKernel::GatherSamples => {
                levels::gather_samples(id, p, &m.tiles, &m.widest, &m.samples, &mut m.gathered);
            }
            MapKernel::ResolveLevel => levels::resolve_level(id, p, &m.tiles, &m.gathered, &mut m.resolved),
            MapKernel::LookUp => receivers::look_up(id, p, &m.receivers, &m.resolved, &mut m.sums),
            MapKernel::FindVisibility => {
                receivers::find_visibility(id, p, &m.receivers, &m.facings, &m.sums, &mut m.visibility);
            }
            other => panic!("{other:?} is no kernel of these maps"),
        }
    }
}

fn set(word: &mut u32, bits: u32) {
    *word |= bits;
}

/// What receivers see; `None` where there is nothing to map. `options` are good.
pub fn visibility(inputs: &Inputs, options: &StochasticOptions, ids: Ids) -> Option<Vec<f32>> {
    let fit = Fit::new(&inputs.light, inputs.receivers.points(), options).expect("options are good")?;
    let params = fit.params(options, inputs.occluders.triangles().len() as u32);
    let mut memory = Memory::new(inputs, &params);
    let receivers = inputs.receivers.len() as u32;
    let done: Result<(), Infallible> = passes(&params, fit.planes(), receivers, |kernel, params| {
        if kernel == MapKernel::MarkLookedAt {
            memory.tiles.fill(0);
        }
        ids.run(params.count, |id| memory.run(kernel, id, &params));
        Ok(())
    });
    let Ok(()) = done;
    Some(memory.visibility)
}
