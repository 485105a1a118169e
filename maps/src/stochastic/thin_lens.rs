//! The thin-lens camera (sections 3 and 4): the lens is the light, focused on a plane; a texel's ray runs from a place of the light through the
//! texel's middle on that plane.
//!
//! Texels are tangents, so that the map covers the same directions from the light's middle on every plane, and what a lens unit is in texels of
//! a plane at depth d (m of eq. 6) is `scale / d`.

use glam::Vec2;

/// Which directions a map covers, and where it is in focus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    /// Tangents at the outer corner of texel (0, 0).
    pub first: Vec2,
    /// Texels a unit of tangent, along the columns and the rows of the map.
    pub scale: Vec2,
    /// Inverse depth of the plane in focus.
    pub focus: f32,
    /// Texels along each side.
    pub size: u32,
}

/// A ray: at depth d it is at `from + slope·d`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts on the light, `−1..=1` each.
    pub from: Vec2,
    /// What a and b grow by a unit of d.
    pub slope: Vec2,
}

impl Ray {
    /// a and b at a depth.
    #[inline(always)]
    pub fn at(&self, depth: f32) -> Vec2 {
        Vec2::new(self.from.x + self.slope.x * depth, self.from.y + self.slope.y * depth)
    }
}

impl ThinLens {
    /// Through all of `tangents` (least and largest), focused at inverse depth `focus`. Tangents that do not differ get a little room.
    #[cfg(not(target_arch = "spirv"))]
    pub fn covering(tangents: [Vec2; 2], focus: f32, size: u32) -> Self {
        let [low, high] = tangents;
        let room = 1.0 / 1024.0 * (1.0 + low.abs().max(high.abs()).max_element());
        let width = (high - low).max(Vec2::splat(room));
        let middle = (low + high) * 0.5;
        // A texel more on either side, so that what lies on the border has neighbours.
        let scale = Vec2::splat((size.max(4) - 2) as f32) / width;
        let scale = if size < 4 { Vec2::splat(size as f32) / width } else { scale };
        Self { first: middle - Vec2::splat(size as f32 * 0.5) / scale, scale, focus, size }
    }

    /// The ray of texel (`column`, `row`) from place `from` of the light.
    #[inline(always)]
    pub fn ray(&self, column: u32, row: u32, from: Vec2) -> Ray {
        let x = self.first.x + (column as f32 + 0.5) / self.scale.x;
        let y = self.first.y + (row as f32 + 0.5) / self.scale.y;
        Ray { from, slope: Vec2::new(x - from.x * self.focus, y - from.y * self.focus) }
    }

    /// Where a tangent lies in the map, texels: whole numbers are borders between texels.
    #[inline(always)]
    pub fn texels(&self, tangent: Vec2) -> Vec2 {
        Vec2::new((tangent.x - self.first.x) * self.scale.x, (tangent.y - self.first.y) * self.scale.y)
    }

    /// How far the ray of a texel that looks from `from` has moved across the map at another inverse depth, texels: rays are lines in
    /// tangents over inverse depth. (Of a hit, this is how far the middle of its circle of confusion lies from its texel.)
    #[inline(always)]
    pub fn shift(&self, from: Vec2, inverse_depth: f32) -> Vec2 {
        let away = inverse_depth - self.focus;
        Vec2::new(from.x * away * self.scale.x, from.y * away * self.scale.y)
    }

    /// Whether a place of the map, texels, lies inside.
    #[inline(always)]
    pub fn holds(&self, at: Vec2) -> bool {
        let size = self.size as f32;
        at.x >= 0.0 && at.y >= 0.0 && at.x < size && at.y < size
    }
}
