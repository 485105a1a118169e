//! What hosts run once a light or a scene.

use umbra4_core::{
    AreaLight, Bounds, Jitter, Lattice, LatticeError, LatticeLight, Lift, LightError, Plan, SceneFacts, SnapError,
    accumulate::{Accumulation, AccumulationError},
    edge_plane::LightGrid,
    exact,
    frame::LightFrame,
    glam::{DVec3, IVec3, Vec3},
    jitter::Pattern,
    order::CodeFrame,
    plan::Pass,
    stage::Stage,
    wide::Limbs,
};

#[unsafe(no_mangle)]
pub extern "C" fn check_bounds(points: &[DVec3], other: Bounds) -> Bounds {
    Bounds::of(points.iter().copied()).union(other)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_lattice(bounds: Bounds, origin: DVec3) -> Result<Lattice, LatticeError> {
    Lattice::covering_about(bounds, origin)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_snap(lattice: &Lattice, point: Vec3) -> Result<IVec3, SnapError> {
    lattice.snap(point)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_light(
    corner: DVec3,
    edges: [DVec3; 2],
    counts: [u32; 2],
    lattice: &Lattice,
    lift: Lift,
) -> Result<LatticeLight, LightError> {
    let light = AreaLight::new(corner, edges[0], edges[1], counts[0], counts[1])?;
    light.with_jitter(Jitter::pattern(counts[0])).snap(lattice, lift)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_frame(light: &LatticeLight) -> (LightFrame, LightGrid) {
    (LightFrame::new(light), LightGrid::new(*light))
}

#[unsafe(no_mangle)]
pub extern "C" fn check_new_plan(facts: SceneFacts) -> Plan {
    Plan::new(facts)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_levels(plan: &Plan, level: usize) -> (usize, usize, usize) {
    let range = plan.levels().range(level);
    (plan.levels().tiles(), range.start, range.end)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_reason(plan: &Plan, pass: &Pass) -> (bool, &'static str) {
    let stage: Stage = pass.stage;
    plan.reason(stage)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_blocks(
    light: &LatticeLight,
    p: IVec3,
    triangle: [IVec3; 3],
    row: u32,
    column: u32,
) -> [bool; 2] {
    [
        exact::blocks::<exact::Wide>(light, p, triangle, row, column),
        exact::blocks::<Limbs>(light, p, triangle, row, column),
    ]
}

#[unsafe(no_mangle)]
pub extern "C" fn check_codes(frame: &LightFrame, bounds: [IVec3; 2]) -> CodeFrame {
    CodeFrame::around(frame, bounds)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_sample(light: &LatticeLight, row: u32, column: u32) -> (IVec3, Pattern) {
    (light.sample(row, column), Pattern::of(light))
}

#[unsafe(no_mangle)]
pub extern "C" fn check_accumulate(
    accumulation: &mut Accumulation<&mut [u32]>,
    scene: u64,
    light: &LatticeLight,
    lit: &[u32],
) -> Result<(u32, Jitter), AccumulationError> {
    Ok((accumulation.add(scene, light, lit)?, accumulation.next_jitter()))
}

#[unsafe(no_mangle)]
pub extern "C" fn check_accumulated(accumulation: &Accumulation<&mut [u32]>, visibility: &mut [f32]) {
    visibility.iter_mut().zip(accumulation.visibility()).for_each(|(to, from)| *to = from);
}
