//! What casters cost: the scene's own mesh as casters of every kind, before the plain light.

use umbra4_core::{
    Layers,
    emission::{Emission, WHOLE, Weight},
    glam::Vec2,
    texture::{TextureSize, Wrap},
};
use umbra4_cpu::{Caster, CasterIndex, CpuExecutor, Occluders, Receivers, Statistics};

use crate::{contender::ContenderError, problem::Problem};

/// Texels along an edge of the texture that cuts.
const TEXELS: u32 = 64;
/// Textures along an edge of the scene.
const TEXTURES: f32 = 16.0;
/// Triangles of the caster that moves: one in so many.
const MOVING: usize = 50;

/// Casters, and what is asked of them.
pub(super) struct CasterCase {
    casters: Vec<Caster>,
    /// Where the receivers are on layers of their own.
    receivers: Option<Receivers>,
    /// Where light is asked for, not visibility.
    emission: Option<Emission<Vec<Weight>>>,
    /// Made before: all but the last caster stay.
    index: Option<std::cell::RefCell<CasterIndex>>,
}

impl CasterCase {
    fn of(casters: Vec<Caster>) -> Self {
        Self { casters, receivers: None, emission: None, index: None }
    }

    /// Indexes the casters, or those that move, and shadows the receivers.
    ///
    /// # Errors
    /// Whatever umbra4 refuses.
    pub(super) fn run(&self, executor: &CpuExecutor, problem: &Problem<'_>) -> Result<Statistics, ContenderError> {
        let receivers = self.receivers.as_ref().unwrap_or(&problem.receivers);
        let Some(index) = &self.index else {
            let index = executor.index_casters(&self.casters, &problem.light);
            let mut statistics = self.ask(executor, &index, receivers)?;
            statistics.seconds_by_stage.splice(0..0, index.statistics().seconds_by_stage.iter().copied());
            return Ok(statistics);
        };
        let mut index = index.borrow_mut();
        if let Some((place, caster)) = self.casters.iter().enumerate().next_back() {
            executor.index_caster(&mut index, place, caster)?;
        }
        self.ask(executor, &index, receivers)
    }

    fn ask(
        &self,
        executor: &CpuExecutor,
        index: &CasterIndex,
        receivers: &Receivers,
    ) -> Result<Statistics, ContenderError> {
        Ok(match &self.emission {
            Some(emission) => executor.caster_light(index, receivers, emission)?.1,
            None => executor.caster_visibility(index, receivers)?.1,
        })
    }
}

/// The scene's mesh, as casters.
///
/// # Errors
/// Whatever umbra4 refuses.
pub(super) fn caster_cases(
    problem: &Problem<'_>,
    occluders: &Occluders,
) -> Result<Vec<(&'static str, CasterCase)>, ContenderError> {
    let light = problem.light;
    let opaque = || Caster::opaque(occluders.clone());
    let size = TextureSize { width: TEXELS, height: TEXELS, wrap: [Wrap::Repeat; 2] };
    // A hole of a texture's fourth.
    let alphas: Vec<u8> = (0..TEXELS * TEXELS)
        .map(|texel| if (texel % TEXELS).max(texel / TEXELS) < TEXELS / 2 { 0 } else { 255 })
        .collect();
    let cut = Caster::cutout(occluders.clone(), &seen_from_above(occluders), size, &alphas, 128)?;
    let uniform = || {
        let weights = vec![[WHOLE; 3]; light.sample_count() as usize];
        Emission::new(light.rows, light.columns, weights).map_err(ContenderError::from)
    };
    let tinted = |emission| CasterCase { emission: Some(emission), ..CasterCase::of(Vec::new()) };
    let (world, hero) = parts(occluders);
    let both = [Caster::opaque(world), Caster::opaque(hero)];
    let odd = |index: usize| Layers::from_bits(if index.is_multiple_of(2) { u32::MAX } else { 1 });
    let layers: Vec<Layers> = (0..problem.receivers.len()).map(odd).collect();
    let on_layers = problem.receivers.clone().on_layers(&layers)?;
    let apart = vec![both[0].clone().on_layers(Layers::from_bits(1)), both[1].clone().on_layers(Layers::from_bits(2))];
    let index = CpuExecutor::new().index_casters(&both, &light);
    let mut cases = vec![
        ("the mesh as one caster", CasterCase::of(vec![opaque()])),
        ("… cut out by a texture", CasterCase::of(vec![cut])),
        (
            "… tinted, for its light",
            CasterCase { casters: vec![Caster::tinted(occluders.clone(), [0.9, 0.5, 0.2])?], ..tinted(uniform()?) },
        ),
        ("… with its planes offset", CasterCase::of(vec![opaque().with_plane_offset(1 << 10)?])),
        ("two casters", CasterCase::of(both.to_vec())),
        ("… on layers", CasterCase { receivers: Some(on_layers), ..CasterCase::of(apart) }),
        ("… of which the smaller moves", CasterCase { index: Some(index.into()), ..CasterCase::of(both.to_vec()) }),
    ];
    let parts = occluders.closed_parts();
    if parts.triangles().contains(&true) {
        let (closed, open) = occluders.split(parts.triangles());
        let casters = vec![Caster::opaque(closed).closed()?, Caster::opaque(open)];
        cases.insert(1, ("… its closed parts as closed", CasterCase::of(casters)));
    }
    Ok(cases)
}

/// Texture coordinates from above: walls are seen edge-on, and stretch it.
fn seen_from_above(occluders: &Occluders) -> Vec<Vec2> {
    let vertices = occluders.vertices();
    let extent = vertices.iter().map(|v| v.x.abs().max(v.z.abs())).max().unwrap_or(1).max(1);
    let scale = TEXTURES / extent as f32;
    vertices.iter().map(|v| Vec2::new(v.x as f32 * scale, (v.z + v.y / 3) as f32 * scale)).collect()
}

/// The mesh without one run of its triangles, and that run.
fn parts(occluders: &Occluders) -> (Occluders, Occluders) {
    let count = occluders.triangles().len();
    let moves: Vec<bool> = (0..count).map(|triangle| triangle >= count - count / MOVING).collect();
    let (hero, world) = occluders.split(&moves);
    (world, hero)
}
