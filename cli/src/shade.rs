//! From what the executor says about every receiver to a picture.

use rayon::prelude::*;
use umbra4_core::{
    AreaLight,
    glam::{DVec3, Vec3},
};

use crate::{
    hard_light::HardLight,
    picture::{Meaning, Picture},
    primary::{GBuffer, Hit},
};

/// Colour of surfaces that come without.
const PLAIN: Vec3 = Vec3::new(0.62, 0.61, 0.59);
/// What is seen where nothing is.
const BACKDROP: Vec3 = Vec3::new(0.66, 0.68, 0.70);
/// Light of the sky, from above, and what the ground sends back, from below.
const SKY: Vec3 = Vec3::new(0.125, 0.150, 0.190);
const BOUNCE: Vec3 = Vec3::new(0.070, 0.060, 0.050);
/// Colour of the lamp.
const WARM: Vec3 = Vec3::new(1.62, 1.46, 1.22);
/// Points each way by which the lamp's form factor is found.
const FORM_FACTOR: u32 = 4;

/// How surfaces reflect, and how the picture is set up.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    /// Linear reflectance of every triangle; empty where all are of one colour.
    pub colors: &'a [Vec3],
    /// Middle of what is shown, world: full exposure is there.
    pub focus: DVec3,
    /// Distance from `focus` at which surfaces have faded into the backdrop, world.
    pub fade: f64,
}

/// What lights the scene.
#[derive(Clone, Copy, Debug)]
pub enum Emitter {
    /// A light with an area.
    Area(AreaLight),
    /// One without.
    Hard(HardLight),
}

/// The lit scene. `visibility` holds a value for every pixel that sees something, in order.
pub fn shaded(seen: &GBuffer, visibility: &[f32], light: &Emitter, look: &Look<'_>) -> Picture {
    let lamp = Lamp::new(light);
    let at_focus = lamp.facing(look.focus).max(f64::MIN_POSITIVE);
    let mut lit = visibility.iter();
    let receivers: Vec<Option<(Hit, f32)>> =
        seen.hits.iter().map(|hit| hit.map(|hit| (hit, lit.next().copied().unwrap_or(1.0)))).collect();
    let pixels = receivers
        .par_iter()
        .map(|receiver| {
            let Some((hit, visible)) = receiver else { return BACKDROP };
            let (position, normal) = (hit.position.as_dvec3(), hit.normal.as_dvec3());
            let color = look.colors.get(hit.triangle as usize).copied().unwrap_or(PLAIN);
            let direct = (lamp.irradiance(position, normal) / at_focus) as f32 * visible;
            let ambient = BOUNCE.lerp(SKY, hit.normal.y * 0.5 + 0.5);
            let light = color * (WARM * direct + ambient);
            light.lerp(BACKDROP, fade(position.distance(look.focus) / look.fade))
        })
        .collect();
    picture(seen, pixels, Meaning::Light)
}

/// The fraction of lit samples, as a gray.
pub fn visibility(seen: &GBuffer, visibility: &[f32]) -> Picture {
    data(seen, visibility, |v| Vec3::splat(*v))
}

/// Umbra, penumbra and lit, in three colours; the penumbra's varies with its depth.
pub fn penumbra(seen: &GBuffer, visibility: &[f32]) -> Picture {
    data(seen, visibility, |&v| {
        if v <= 0.0 {
            Vec3::new(0.10, 0.11, 0.27)
        } else if v >= 1.0 {
            Vec3::new(0.96, 0.94, 0.86)
        } else {
            Vec3::new(0.72, 0.16, 0.24).lerp(Vec3::new(0.99, 0.70, 0.28), v)
        }
    })
}

/// A heat map, from black over red and yellow to white, of the number of triangles that block something of each
/// receiver; logarithmic, white at the largest.
pub fn pairs(seen: &GBuffer, pairs: &[u32]) -> Picture {
    let log = |n: u32| (1.0 + n as f32).ln();
    let most = log(pairs.iter().copied().max().unwrap_or(0)).max(f32::MIN_POSITIVE);
    data(seen, pairs, |&n| {
        let heat = 3.0 * log(n) / most;
        Vec3::new(heat, heat - 1.0, heat - 2.0).clamp(Vec3::ZERO, Vec3::ONE)
    })
}

/// Blue-gray where nothing is seen: no value of any view.
const NOTHING: Vec3 = Vec3::new(0.30, 0.34, 0.40);

fn data<T>(seen: &GBuffer, values: &[T], color: impl Fn(&T) -> Vec3) -> Picture {
    let mut values = values.iter();
    let pixels = seen.hits.iter().map(|hit| hit.and_then(|_| values.next()).map_or(NOTHING, &color)).collect();
    picture(seen, pixels, Meaning::Data)
}

fn picture(seen: &GBuffer, pixels: Vec<Vec3>, meaning: Meaning) -> Picture {
    Picture { width: seen.width, height: seen.height, pixels, meaning }
}

/// 0 near by, 1 far away, smooth between.
fn fade(distance: f64) -> f32 {
    let t = (distance * 1.8 - 0.8).clamp(0.0, 1.0) as f32;
    t * t * (3.0 - 2.0 * t)
}

/// The light without its occluders.
enum Lamp {
    /// A few points that stand for its area, its normal and its middle.
    Area { points: Vec<DVec3>, normal: DVec3, center: DVec3 },
    /// As it is.
    Hard(HardLight),
}

impl Lamp {
    fn new(light: &Emitter) -> Self {
        let light = match light {
            Emitter::Area(light) => light,
            Emitter::Hard(light) => return Self::Hard(*light),
        };
        let [corner, along_u, _, along_v] = light.corners();
        let (u, v) = (along_u - corner, along_v - corner);
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(FORM_FACTOR);
        let points = (0..FORM_FACTOR * FORM_FACTOR)
            .map(|i| corner + u * at(i % FORM_FACTOR) + v * at(i / FORM_FACTOR))
            .collect();
        Self::Area {
            points,
            normal: u.normalize_or_zero().cross(v.normalize_or_zero()).normalize_or_zero(),
            center: light.center(),
        }
    }

    /// Irradiance at an unoccluded point, up to the lamp's power.
    fn irradiance(&self, position: DVec3, normal: DVec3) -> f64 {
        let (points, own_normal) = match self {
            Self::Area { points, normal, .. } => (points, normal),
            Self::Hard(light) => return light.irradiance(position, normal),
        };
        let from = |point: &DVec3| {
            let towards = point - position;
            let squared = towards.length_squared().max(f64::MIN_POSITIVE);
            let cosines = normal.dot(towards).max(0.0) * own_normal.dot(-towards).max(0.0);
            cosines / (squared * squared)
        };
        points.iter().map(from).sum()
    }

    /// As [`Lamp::irradiance`], on a surface that is tilted half-way towards the lamp.
    fn facing(&self, position: DVec3) -> f64 {
        let towards = match self {
            Self::Area { center, .. } | Self::Hard(HardLight::Lamp(center)) => *center - position,
            Self::Hard(HardLight::Sun(towards)) => *towards,
        };
        let towards = towards.normalize_or(DVec3::Y);
        self.irradiance(position, (towards + DVec3::Y).normalize_or(DVec3::Y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one_hit() -> GBuffer {
        let hit = Hit { position: Vec3::ZERO, normal: Vec3::Y, triangle: 0 };
        GBuffer { width: 2, height: 1, hits: vec![None, Some(hit)] }
    }

    #[test]
    fn only_pixels_that_see_something_take_a_value() {
        assert_eq!(visibility(&one_hit(), &[0.25]).pixels, [NOTHING, Vec3::splat(0.25)]);
    }

    #[test]
    fn the_lamp_lights_what_it_faces() {
        let light = AreaLight::new(DVec3::new(-0.5, 2.0, -0.5), DVec3::X, DVec3::Z, 4, 4).unwrap();
        let look = Look { colors: &[], focus: DVec3::ZERO, fade: 100.0 };
        let lit = shaded(&one_hit(), &[1.0], &Emitter::Area(light), &look).pixels[1];
        let dark = shaded(&one_hit(), &[0.0], &Emitter::Area(light), &look).pixels[1];
        assert!(lit.x > 3.0 * dark.x && dark.x > 0.0);
    }

    #[test]
    fn no_pairs_are_black() {
        assert_eq!(pairs(&one_hit(), &[0]).pixels[1], Vec3::ZERO);
        assert_eq!(pairs(&one_hit(), &[9]).pixels[1], Vec3::ONE);
    }
}
