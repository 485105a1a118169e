//! Lights of other kinds than rectangles, on the host.

use umbra4_core::{
    AnyLight, DirectionalLight, EllipsoidLight, Exact, Facing, Fast, Lattice, LatticeLight, PointLight, Punctual,
    PunctualLightError, TubeLight, VolumeLightError,
    cloud::{Cloud, CloudError, CloudMask},
    cloud_extent::CloudExtent,
    cloud_order::OrderedCloud,
    cloud_table::{CloudTable, PlaneTable, TableError, TableSize},
    cloud_tiles::CloudTiles,
    emission::{Emission, EmissionError, Shape, Weight},
    glam::{DVec3, IVec3, Vec3},
    hierarchy::Levels,
    kernel::resolve_cloud::SampleTile,
    lanes::{Four, Sixteen},
    occluder::Occluder,
    order::BoxCurve,
    params::CloudParams,
    punctual_frame::PunctualFrame,
    shaft::{BoxTile, around, box_of, build_box_level, meet},
    stage::{
        resolve_cloud::{CloudGroup, CloudScene, resolve_cloud},
        resolve_punctual::{PunctualGroup, PunctualScene, resolve_punctual},
    },
    volume_light::snap_points,
};

#[unsafe(no_mangle)]
pub extern "C" fn check_back(light: &LatticeLight, points: &[IVec3]) -> (AnyLight, IVec3, bool) {
    (light.back().into(), light.back().sample(1, 2), light.reaches(points))
}

#[unsafe(no_mangle)]
pub extern "C" fn check_facing(normal: Vec3, light: &LatticeLight, lamp: &Punctual, p: IVec3) -> [bool; 3] {
    let facing = Facing::of(normal);
    [facing.is_away_from(light, p), facing.is_away_from_punctual(*lamp, p), facing.is_away_from_box([p; 2], p)]
}

#[unsafe(no_mangle)]
pub extern "C" fn check_point_light(position: DVec3, lattice: &Lattice) -> Result<[Punctual; 2], PunctualLightError> {
    Ok([PointLight { position }.snap(lattice)?, DirectionalLight { towards: position }.snap()?])
}

#[unsafe(no_mangle)]
pub extern "C" fn check_faces(light: &Punctual, p: IVec3, corners: &[IVec3; 3]) -> (Option<u32>, u32, PunctualFrame) {
    (light.face_of(p), light.faces_of(corners), light.frame(2))
}

#[unsafe(no_mangle)]
pub extern "C" fn check_resolve_punctual(scene: &PunctualScene<'_>, group: &mut PunctualGroup) {
    resolve_punctual::<Four, Exact>(scene, group);
    resolve_punctual::<f32, Fast>(scene, group);
}

#[unsafe(no_mangle)]
pub extern "C" fn check_emission(
    rows: u32,
    columns: u32,
    room: &mut [Weight],
    radiance: &[[f32; 3]],
    shape: Shape<'_>,
) -> Result<[f32; 3], EmissionError> {
    let _ = Emission::shaped(rows, columns, &mut room[..], shape)?;
    let emission = Emission::textured(rows, columns, room, radiance)?;
    Ok(emission.fraction(emission.lit::<u32>(&[1, 2, 3])))
}

#[unsafe(no_mangle)]
pub extern "C" fn check_cloud(samples: &[IVec3]) -> Result<(usize, [IVec3; 2]), CloudError> {
    let cloud = Cloud::new(samples)?;
    Ok((cloud.words(), CloudTiles::new(cloud.samples()).extent().bounds()))
}

#[unsafe(no_mangle)]
pub extern "C" fn check_ordered_cloud(samples: &[IVec3], mask: &[u32], out: &mut [u32]) -> usize {
    let ordered = OrderedCloud::new(samples);
    ordered.write(mask, out);
    ordered.samples().len()
}

#[unsafe(no_mangle)]
pub extern "C" fn check_told_cloud(
    tiles: &CloudTiles<'_>,
    levels: &Levels,
    bounds: [IVec3; 2],
    out: &mut [SampleTile],
) -> CloudParams {
    out.iter_mut().zip(tiles.sample_tiles()).for_each(|(out, tile)| *out = tile);
    CloudParams::new(tiles.extent(), tiles.len() as u32, &BoxCurve::through(bounds), levels)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_cloud_occluder(extent: &CloudExtent, corners: [IVec3; 3]) -> [Option<Occluder>; 2] {
    [extent.occluder::<f32>(corners), extent.occluder::<f64>(corners)]
}

#[unsafe(no_mangle)]
pub extern "C" fn check_meeting_boxes(points: &[IVec3], corners: [IVec3; 3]) -> bool {
    meet(box_of(corners), around(points))
}

#[unsafe(no_mangle)]
pub extern "C" fn check_volumes(
    lattice: &Lattice,
    points: &[DVec3],
    room: &mut [IVec3],
) -> Result<usize, VolumeLightError> {
    let [center, a, b, c] = [DVec3::ONE, DVec3::X, DVec3::Y, DVec3::Z];
    let words = EllipsoidLight { center, axes: [a, b, c] }.snap(lattice, &mut room[..])?.words();
    let tube = TubeLight { from: a, to: b, radius: 1.0 }.snap(lattice, &mut room[..])?.words();
    Ok(words + tube + snap_points(lattice, points, room)?.words())
}

#[unsafe(no_mangle)]
pub extern "C" fn check_box_level(id: usize, below: &[BoxTile]) -> BoxTile {
    build_box_level(id, below)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_resolve_cloud(scene: &CloudScene<'_, CloudTiles<'_>>, group: &mut CloudGroup) {
    resolve_cloud::<Four, Exact, _>(scene, group);
    resolve_cloud::<f32, Fast, _>(scene, group);
}

#[unsafe(no_mangle)]
pub extern "C" fn check_resolve_cloud_by_table(scene: &CloudScene<'_, PlaneTable<'_>>, group: &mut CloudGroup) {
    resolve_cloud::<Sixteen, Fast, _>(scene, group);
}

#[unsafe(no_mangle)]
pub extern "C" fn check_cloud_table<'a>(
    cloud: &'a Cloud<&'a [IVec3]>,
    size: TableSize,
    room: &'a mut [u32],
) -> Result<CloudMask, TableError> {
    let table = CloudTable::new(cloud, size, room)?;
    let _ = table.planes();
    Ok([table.size().distances; 32])
}
