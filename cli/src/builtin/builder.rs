//! Collects coloured triangles from simple solids, and parts with surfaces of their own.

use std::f64::consts::TAU;

use umbra4_core::glam::{DVec3, Vec3};

use crate::model::{Casting, Model, Part, Parts, Surface};

#[derive(Default)]
pub(super) struct Builder {
    model: Model,
    parts: Parts,
    /// Texture coordinates of the vertices of the part that is being built.
    coordinates: Vec<[f32; 2]>,
    colors: Vec<Vec3>,
    color: Vec3,
}

impl Builder {
    /// Colour of everything that follows: linear reflectance.
    pub(super) fn color(&mut self, r: f32, g: f32, b: f32) {
        self.color = Vec3::new(r, g, b);
    }

    pub(super) fn finish(self) -> (Model, Parts, Vec<Vec3>) {
        (self.model, self.parts, self.colors)
    }

    /// What `build` adds is a part with that surface.
    pub(super) fn part(&mut self, label: &str, surface: Surface, build: impl FnOnce(&mut Self)) {
        let (triangles, vertices) = (self.model.triangles.len(), self.model.vertices.len());
        build(self);
        self.parts.push(Part {
            label: label.to_owned(),
            names: vec![label.to_owned()],
            triangles: triangles..self.model.triangles.len(),
            vertices: vertices..self.model.vertices.len(),
            coordinates: std::mem::take(&mut self.coordinates),
            surface,
            one_sided: false,
            casting: Casting::default(),
        });
    }

    /// A vertex of a part with a texture, all of whose vertices are such.
    pub(super) fn textured_vertex(&mut self, position: DVec3, coordinates: [f32; 2]) -> u32 {
        self.coordinates.push(coordinates);
        self.vertex(position)
    }

    pub(super) fn vertex(&mut self, position: DVec3) -> u32 {
        self.model.vertices.push(position.as_vec3());
        self.model.vertices.len() as u32 - 1
    }

    pub(super) fn triangle(&mut self, corners: [u32; 3]) {
        self.model.triangles.push(corners);
        self.colors.push(self.color);
    }

    pub(super) fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.triangle([a, b, c]);
        self.triangle([a, c, d]);
    }

    /// An axis-aligned box.
    pub(super) fn cuboid(&mut self, min: DVec3, max: DVec3) {
        let corner = |i: usize| DVec3::new([min.x, max.x][i & 1], [min.y, max.y][i >> 1 & 1], [min.z, max.z][i >> 2]);
        let v: [u32; 8] = std::array::from_fn(|i| self.vertex(corner(i)));
        for [a, b, c, d] in [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]] {
            self.quad([v[a], v[b], v[c], v[d]]);
        }
    }

    /// A surface of revolution about the vertical through `base`: `profile` holds (radius, height) from bottom to top;
    /// `shape` scales the radius by angle and height. Radius 0 closes it.
    pub(super) fn revolve(
        &mut self,
        base: DVec3,
        profile: &[(f64, f64)],
        sides: usize,
        shape: impl Fn(f64, f64) -> f64,
    ) {
        let mut below: Option<Vec<u32>> = None;
        for &(radius, height) in profile {
            let ring: Vec<u32> = (0..sides)
                .map(|side| {
                    let angle = side as f64 / sides as f64 * TAU;
                    let r = radius * shape(angle, height);
                    self.vertex(base + DVec3::new(r * angle.cos(), height, -r * angle.sin()))
                })
                .collect();
            if let Some(below) = below {
                for side in 0..sides {
                    let next = (side + 1) % sides;
                    self.quad([below[side], below[next], ring[next], ring[side]]);
                }
            }
            below = Some(ring);
        }
    }

    /// A round bar that tapers from `radius.0` to `radius.1`, open at its ends.
    pub(super) fn tube(&mut self, from: DVec3, to: DVec3, radius: (f64, f64), sides: usize) {
        let axis = (to - from).normalize_or(DVec3::Y);
        let (u, v) = axis.any_orthonormal_pair();
        let mut ring = |center: DVec3, radius: f64| -> Vec<u32> {
            (0..sides)
                .map(|side| {
                    let angle = side as f64 / sides as f64 * TAU;
                    self.vertex(center + (u * angle.cos() + v * angle.sin()) * radius)
                })
                .collect()
        };
        let (first, last) = (ring(from, radius.0), ring(to, radius.1));
        for side in 0..sides {
            let next = (side + 1) % sides;
            self.quad([first[side], first[next], last[next], last[side]]);
        }
    }

    /// A ball.
    pub(super) fn sphere(&mut self, center: DVec3, radius: f64, rings: usize) {
        let profile: Vec<(f64, f64)> = (0..=rings)
            .map(|ring| {
                let angle = ring as f64 / rings as f64 * TAU * 0.5;
                (radius * angle.sin(), -radius * angle.cos())
            })
            .collect();
        self.revolve(center, &profile, 2 * rings, |_, _| 1.0);
    }
}
