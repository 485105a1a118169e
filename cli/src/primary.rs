//! What the camera sees: one triangle a pixel, by a library BVH; then the exact point on it. Where a surface lets light
//! through, what lies behind it is seen.

use std::time::Duration;

use obvhs::{
    BvhBuildParams,
    cwbvh::{CwBvh, builder::build_cwbvh_from_tris},
    ray::{Ray, RayHit},
    triangle::Triangle,
};
use rayon::prelude::*;
use umbra4_core::glam::{DVec3, Vec3, Vec3A};

use crate::{
    camera::Camera,
    model::{Model, Part, Parts},
};

/// A surface point that a pixel sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// World position: computed in f64 from the triangle's corners, then rounded once to f32.
    pub position: Vec3,
    /// The triangle's geometric normal, of length 1, on the side that is seen.
    pub normal: Vec3,
    /// Index of the triangle.
    pub triangle: u32,
}

/// What every pixel sees, row by row from the top; `None` where it sees nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct GBuffer {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width · height` pixels.
    pub hits: Vec<Option<Hit>>,
    /// What is left of red, green and blue on the way to every pixel, `0.0..=1.0`; none where nothing lets light through.
    pub tints: Vec<Vec3>,
}

impl GBuffer {
    /// The pixels that see something.
    pub fn seen(&self) -> impl Iterator<Item = &Hit> {
        self.hits.iter().flatten()
    }
}

/// Traces one ray through the middle of every pixel.
pub fn visible_surfaces(model: &Model, parts: &Parts, camera: &Camera, width: u32, height: u32) -> GBuffer {
    let tracer = Tracer::new(model, parts, camera.from());
    let pixels: Vec<(Option<Hit>, Vec3)> = (0..height)
        .into_par_iter()
        .flat_map_iter(|y| {
            let tracer = &tracer;
            (0..width).map(move |x| tracer.pixel(camera.direction(x, y, width, height)))
        })
        .collect();
    let tinted = parts.iter().any(|part| part.surface.is_tinted());
    let tints = if tinted { pixels.iter().map(|(_, tint)| *tint).collect() } else { Vec::new() };
    GBuffer { width, height, hits: pixels.into_iter().map(|(hit, _)| hit).collect(), tints }
}

/// The BVH stands in a unit frame around the eye, so that f32 serves any scale and any distance from the origin.
struct Tracer<'a> {
    model: &'a Model,
    parts: &'a Parts,
    eye: DVec3,
    bvh: Option<CwBvh>,
    /// In the order of the BVH's leaves.
    triangles: Vec<Triangle>,
    /// Index in the model of every one of `triangles`.
    owners: Vec<u32>,
}

impl<'a> Tracer<'a> {
    fn new(model: &'a Model, parts: &'a Parts, eye: DVec3) -> Self {
        let reach = model.vertices.iter().map(|v| (v.as_dvec3() - eye).abs().max_element()).fold(0.0, f64::max);
        let mut triangles = Vec::new();
        let mut owners = Vec::new();
        for (index, owner) in (0..model.triangles.len()).zip(0_u32..) {
            if let Some(corners) = model.corners(index)
                && normal(corners) != DVec3::ZERO
            {
                let [v0, v1, v2] = corners.map(|p| Vec3A::from(((p - eye) / reach).as_vec3()));
                triangles.push(Triangle { v0, v1, v2 });
                owners.push(owner);
            }
        }
        if triangles.is_empty() {
            return Self { model, parts, eye, bvh: None, triangles, owners };
        }
        let bvh = build_cwbvh_from_tris(&triangles, BvhBuildParams::medium_build(), &mut Duration::default());
        let order = &bvh.primitive_indices;
        let triangles = order.iter().map(|&i| triangles[i as usize]).collect();
        let owners = order.iter().map(|&i| owners[i as usize]).collect();
        Self { model, parts, eye, bvh: Some(bvh), triangles, owners }
    }

    /// The first surface that nothing goes through, and what is left of its light on the way.
    fn pixel(&self, direction: DVec3) -> (Option<Hit>, Vec3) {
        let Some(bvh) = &self.bvh else { return (None, Vec3::ONE) };
        let ray = Ray::new(Vec3A::ZERO, direction.as_vec3a(), 0.0, f32::MAX);
        let mut hit = RayHit::none();
        let found = bvh.ray_traverse(ray, &mut hit, |ray, id| match self.triangles[id].intersect(ray) {
            t if t < f32::INFINITY && self.lets_through(id, direction) != Vec3::ZERO => f32::INFINITY,
            t => t,
        });
        let (hit, reach) = if found { (self.hit(hit.primitive_id, direction), hit.t) } else { (None, f32::MAX) };
        let mut tint = Vec3::ONE;
        if self.parts.iter().any(|part| part.surface.is_tinted()) {
            let ray = Ray::new(Vec3A::ZERO, direction.as_vec3a(), 0.0, reach);
            bvh.ray_traverse_anyhit(ray, |ray, id| {
                let through = self.lets_through(id, direction);
                if self.triangles[id].intersect(ray) < reach && through != Vec3::ZERO {
                    tint *= through;
                }
            });
        }
        (hit, tint)
    }

    /// The triangle of the model that is in this place of the BVH's, and its part.
    fn owner(&self, place: usize) -> Option<(usize, Option<&Part>)> {
        let triangle = *self.owners.get(place)? as usize;
        Some((triangle, self.parts.of(triangle)))
    }

    /// What goes through a triangle where the ray meets it.
    fn lets_through(&self, place: usize, direction: DVec3) -> Vec3 {
        let Some((triangle, Some(part))) = self.owner(place) else { return Vec3::ZERO };
        if !part.surface.is_textured() {
            return part.surface.lets_through([0.0; 2]);
        }
        let corners = self.model.triangles.get(triangle).zip(self.model.corners(triangle));
        let Some((indices, corners)) = corners else { return Vec3::ZERO };
        let weights = weights(corners, normal(corners), self.eye, direction);
        part.surface.lets_through(part.coordinates_at(*indices, weights))
    }

    fn hit(&self, place: u32, direction: DVec3) -> Option<Hit> {
        let triangle = *self.owners.get(place as usize)?;
        let corners = self.model.corners(triangle as usize)?;
        let normal = normal(corners);
        let towards_eye = if normal.dot(direction) > 0.0 { -normal } else { normal };
        let position = on_triangle(corners, weights(corners, normal, self.eye, direction)).as_vec3();
        Some(Hit { position, normal: towards_eye.as_vec3(), triangle })
    }
}

/// Of length 1, or zero for a degenerate triangle.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    // Edges are scaled first, so that neither tiny nor huge triangles lose their normal to the range of f64.
    let (u, v) = (b - a, c - a);
    let scale = u.abs().max_element().max(v.abs().max_element());
    if scale > 0.0 { (u / scale).cross(v / scale).normalize_or_zero() } else { DVec3::ZERO }
}

/// Where the ray meets the triangle's plane: the weights of the three corners, kept inside the triangle.
fn weights([a, b, c]: [DVec3; 3], normal: DVec3, eye: DVec3, direction: DVec3) -> DVec3 {
    let (u, v) = (b - a, c - a);
    let at = eye + direction * (normal.dot(a - eye) / normal.dot(direction)) - a;
    let area = u.cross(v).dot(normal);
    let (s, t) = (at.cross(v).dot(normal) / area, u.cross(at).dot(normal) / area);
    if !(s.is_finite() && t.is_finite()) {
        // The ray grazes the plane: any point of the triangle will do.
        return DVec3::splat(1.0 / 3.0);
    }
    let (s, t) = (s.clamp(0.0, 1.0), t.clamp(0.0, 1.0));
    let excess = (s + t).max(1.0);
    DVec3::new(1.0 - (s + t) / excess, s / excess, t / excess)
}

fn on_triangle([a, b, c]: [DVec3; 3], weights: DVec3) -> DVec3 {
    a + (b - a) * weights.y + (c - a) * weights.z
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use umbra4_core::texture::{TextureSize, Wrap};

    use super::*;
    use crate::model::{Casting, Surface, Texture};

    fn square(size: f32, offset: Vec3) -> Model {
        let corner = |x: f32, z: f32| offset + Vec3::new(x, 0.0, z) * size;
        Model {
            vertices: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
            triangles: vec![[0, 1, 2], [0, 2, 3], [0, 0, 1]],
        }
    }

    #[test]
    fn hits_lie_on_the_surface_at_any_scale() {
        for size in [1e-30_f32, 1e-6, 1.0, 1e6, 1e30] {
            let model = square(size, Vec3::ZERO);
            let camera = Camera::new(DVec3::new(0.3, 2.0, 0.1) * f64::from(size), DVec3::ZERO, 30.0).unwrap();
            let seen = visible_surfaces(&model, &Parts::default(), &camera, 8, 8);
            for hit in seen.hits {
                let hit = hit.unwrap();
                assert_eq!((hit.position.y, hit.normal), (0.0, Vec3::Y));
                assert!(hit.triangle < 2);
            }
        }
    }

    #[test]
    fn degenerate_models_show_nothing() {
        let model = Model { vertices: vec![Vec3::ZERO; 3], triangles: vec![[0, 1, 2]] };
        let camera = Camera::new(DVec3::ONE, DVec3::ZERO, 30.0).unwrap();
        assert_eq!(visible_surfaces(&model, &Parts::default(), &camera, 4, 4).seen().count(), 0);
    }

    /// Two squares, one above the other, the upper one of which has a surface.
    fn covered(surface: Surface) -> (Model, Parts) {
        let mut model = square(1.0, Vec3::ZERO);
        let upper = square(1.0, Vec3::Y);
        let part = Part {
            label: "upper".to_owned(),
            names: Vec::new(),
            triangles: 3..6,
            vertices: 4..8,
            coordinates: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            surface,
            one_sided: false,
            casting: Casting::default(),
        };
        model.append(&upper);
        let mut parts = Parts::default();
        parts.push(part);
        (model, parts)
    }

    #[test]
    fn holes_and_panes_show_what_lies_behind() {
        let camera = Camera::new(DVec3::new(0.013, 40.0, 0.027), DVec3::new(0.013, 0.0, 0.027), 1.0).unwrap();
        let seen = |surface| {
            let (model, parts) = covered(surface);
            visible_surfaces(&model, &parts, &camera, 4, 4)
        };
        let heights = |seen: &GBuffer| seen.seen().map(|hit| hit.position.y).collect::<Vec<_>>();
        let opaque = seen(Surface::Opaque);
        assert_eq!((heights(&opaque), opaque.tints.len()), (vec![1.0; 16], 0));
        assert_eq!(heights(&seen(Surface::Absent)), [0.0; 16]);
        let pane = seen(Surface::Tinted(Vec3::new(1.0, 0.5, 0.0)));
        assert_eq!((heights(&pane), pane.tints), (vec![0.0; 16], vec![Vec3::new(1.0, 0.5, 0.0); 16]));
        // The half where u is below ½ is cut out; u grows along +x.
        let size = TextureSize { width: 2, height: 1, wrap: [Wrap::Repeat; 2] };
        let alphas = Arc::new(Texture { size, texels: vec![0, 255] });
        let cut = seen(Surface::Cutout { alphas, threshold: 128 });
        assert!(cut.seen().all(|hit| (hit.position.y == 1.0) == (hit.position.x > 0.0)), "{cut:?}");
        assert!(heights(&cut).contains(&0.0) && heights(&cut).contains(&1.0));
    }
}
