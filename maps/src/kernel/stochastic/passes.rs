//! The order of the kernels: all of a map, for the planes one after the other.

use crate::{
    kernel::MapKernel,
    stochastic::{
        params::{ACTIVE_TILES, LensParams},
        tiles::tiles_across,
        tree::Tree,
    },
};

/// Says every pass, in order: a kernel, and its parameters with their number of ids, which may be 0. `planes` are inverse depths, from the
/// nearest to the farthest. Tiles have to be cleared before every [`MapKernel::MarkLookedAt`], and sums before all.
///
/// # Errors
/// The first that `pass` returns.
pub fn passes<E>(
    params: &LensParams,
    planes: &[f32],
    receivers: u32,
    mut pass: impl FnMut(MapKernel, LensParams) -> Result<(), E>,
) -> Result<(), E> {
    let texels = params.with_count(params.size * params.size);
    let tree = Tree::new(params.triangles);
    pass(MapKernel::PlaceTriangles, params.with_count(params.triangles))?;
    for level in 0..tree.levels {
        let kernel = if level == 0 { MapKernel::BoundTriangles } else { MapKernel::BoundNodes };
        pass(kernel, params.with_level(level).with_count(tree.count(level)))?;
    }
    pass(MapKernel::SampleLightField, texels)?;
    for index in 0..planes.len() {
        plane(&params.with_plane(planes, index), receivers, &mut pass)?;
    }
    pass(MapKernel::FindVisibility, params.with_count(receivers))
}

/// Those of one plane.
fn plane<E>(
    params: &LensParams,
    receivers: u32,
    pass: &mut impl FnMut(MapKernel, LensParams) -> Result<(), E>,
) -> Result<(), E> {
    let texels_of = |level: u32| {
        let size = params.level_size(level);
        params.with_level(level).with_count(size * size)
    };
    let tiles_of = |level: u32| {
        let across = tiles_across(params, level);
        params.with_level(level).with_count(across * across)
    };
    if params.is(ACTIVE_TILES) {
        pass(MapKernel::MarkLookedAt, params.with_count(receivers))?;
        for level in 1..params.levels {
            pass(MapKernel::MarkActive, tiles_of(level))?;
        }
        for level in (0..params.levels).rev() {
            pass(MapKernel::MarkData, tiles_of(level))?;
        }
        pass(MapKernel::MarkMerged, tiles_of(0))?;
    }
    if params.moves() {
        pass(MapKernel::ClearLists, texels_of(0))?;
        pass(MapKernel::LinkSamples, texels_of(0))?;
    }
    pass(MapKernel::MergeSamples, texels_of(0))?;
    if params.widest_raise > 0.0 {
        pass(MapKernel::FindClosest, texels_of(0))?;
        pass(MapKernel::RaiseRadii, texels_of(0))?;
        pass(MapKernel::LendRadii, texels_of(0))?;
    }
    for level in 1..params.levels {
        pass(MapKernel::CoarsenSamples, texels_of(level))?;
    }
    for level in 0..params.levels {
        pass(MapKernel::FindWidest, tiles_of(level))?;
    }
    for level in 0..params.levels {
        pass(MapKernel::GatherSamples, texels_of(level))?;
    }
    for level in (0..params.levels).rev() {
        pass(MapKernel::ResolveLevel, texels_of(level))?;
    }
    pass(MapKernel::LookUp, params.with_count(receivers))
}
