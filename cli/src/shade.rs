//! From what the executor says about every receiver to a picture.

use rayon::prelude::*;
use umbra4_core::glam::{DVec3, Vec3};

use crate::{
    fractions::Fractions,
    light::{Lamp, Light},
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
/// White light of a lamp.
pub const WARM: Vec3 = Vec3::new(1.62, 1.46, 1.22);
/// White light of lights that have a colour of their own: as bright, and white.
pub const NEUTRAL: Vec3 = Vec3::splat(1.45);

/// How surfaces reflect, and how the picture is set up.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    /// Linear reflectance of every triangle; empty where all are of one colour.
    pub colors: &'a [Vec3],
    /// Middle of what is shown, world: full exposure is there.
    pub focus: DVec3,
    /// Distance from `focus` at which surfaces have faded into the backdrop, world.
    pub fade: f64,
    /// What a surface at the focus sends back of all lights, were it white.
    pub white: Vec3,
}

/// The lit scene. `fractions` holds those of every light, for every pixel that sees something, in order.
pub fn shaded(seen: &GBuffer, lights: &[Light], fractions: &[Fractions<'_>], look: &Look<'_>) -> Picture {
    let lamps: Vec<(&Light, Lamp)> = lights.iter().map(|light| (light, Lamp::new(light))).collect();
    let irradiance = |light: &Light, lamp: &Lamp, hit: &Hit| {
        light.power * lamp.irradiance(hit.position.as_dvec3(), hit.normal.as_dvec3())
    };
    let unit = exposure(&lamps, seen, look.focus, irradiance);
    let direct = |receiver: usize, hit: &Hit| {
        let of_light = |((light, lamp), fractions): (&(&Light, Lamp), &Fractions<'_>)| {
            (irradiance(light, lamp, hit) / unit).as_vec3() * fractions.color(receiver)
        };
        lamps.iter().zip(fractions).map(of_light).sum::<Vec3>()
    };
    let mut receivers = 0..;
    let receivers: Vec<Option<(&Hit, usize)>> =
        seen.hits.iter().map(|hit| hit.as_ref().zip(hit.and_then(|_| receivers.next()))).collect();
    let color_of = |receiver: &Option<(&Hit, usize)>| {
        let Some((hit, receiver)) = *receiver else { return BACKDROP };
        let color = look.colors.get(hit.triangle as usize).copied().unwrap_or(PLAIN);
        let ambient = BOUNCE.lerp(SKY, hit.normal.y * 0.5 + 0.5);
        let light = color * (look.white * direct(receiver, hit) + ambient);
        light.lerp(BACKDROP, fade(hit.position.as_dvec3().distance(look.focus) / look.fade))
    };
    // What is seen through panes has their colours.
    let tint = |pixel: usize| seen.tints.get(pixel).copied().unwrap_or(Vec3::ONE);
    let pixels = receivers.par_iter().enumerate().map(|(pixel, receiver)| tint(pixel) * color_of(receiver)).collect();
    picture(seen, pixels, Meaning::Light)
}

/// The irradiance that is shown as white: that of all lights at the focus, or, where none shines there, the largest.
fn exposure(
    lamps: &[(&Light, Lamp)],
    seen: &GBuffer,
    focus: DVec3,
    irradiance: impl Fn(&Light, &Lamp, &Hit) -> DVec3 + Sync,
) -> f64 {
    let at_focus: DVec3 = lamps.iter().map(|(light, lamp)| light.power * lamp.facing(focus)).sum();
    if at_focus.max_element() > 0.0 {
        return at_focus.max_element();
    }
    let all = |hit: &Hit| lamps.iter().map(|(light, lamp)| irradiance(light, lamp, hit)).sum::<DVec3>().max_element();
    let largest = seen.hits.par_iter().flatten().map(all).reduce(|| 0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

/// The fraction of lit samples, as a gray.
pub fn visibility(seen: &GBuffer, visibility: &[f32]) -> Picture {
    data(seen, visibility, |v| Vec3::splat(*v))
}

/// The fractions of red, green and blue that get through.
pub fn light(seen: &GBuffer, fractions: &[Vec3]) -> Picture {
    data(seen, fractions, |fraction| *fraction)
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

#[cfg(test)]
mod tests {
    use umbra4_core::AreaLight;

    use super::*;
    use crate::light::HardLight;

    fn one_hit() -> GBuffer {
        let hit = Hit { position: Vec3::ZERO, normal: Vec3::Y, triangle: 0 };
        GBuffer { width: 2, height: 1, hits: vec![None, Some(hit)], tints: Vec::new() }
    }

    #[test]
    fn only_pixels_that_see_something_take_a_value() {
        assert_eq!(visibility(&one_hit(), &[0.25]).pixels, [NOTHING, Vec3::splat(0.25)]);
    }

    #[test]
    fn what_is_seen_through_a_pane_has_its_colour() {
        let look = Look { colors: &[], focus: DVec3::ZERO, fade: 100.0, white: NEUTRAL };
        let tint = Vec3::new(1.0, 0.5, 0.0);
        let [plain, tinted] =
            [vec![], vec![tint; 2]].map(|tints| shaded(&GBuffer { tints, ..one_hit() }, &[], &[], &look).pixels);
        assert_eq!(tinted, plain.iter().map(|pixel| pixel * tint).collect::<Vec<_>>());
    }

    #[test]
    fn the_lamp_lights_what_it_faces() {
        let light = AreaLight::new(DVec3::new(-0.5, 2.0, -0.5), DVec3::X, DVec3::Z, 4, 4).unwrap();
        let lights = [Light::plain("lamp", light)];
        let [lit, dark] = [1.0, 0.0].map(|fraction| pixel(&lights, fraction));
        assert!(lit.x > 3.0 * dark.x && dark.x > 0.0);
    }

    #[test]
    fn lights_add_up_and_have_colours() {
        let red = Light { power: DVec3::X, ..Light::hard("red", HardLight::Sun(DVec3::Y)) };
        let blue = Light { power: DVec3::Z, ..Light::hard("blue", HardLight::Sun(DVec3::Y)) };
        let [both, red] = [vec![red.clone(), blue], vec![red]].map(|lights| pixel(&lights, 1.0) - pixel(&lights, 0.0));
        let expected = NEUTRAL * PLAIN;
        assert!((both - Vec3::new(expected.x, 0.0, expected.z)).abs().max_element() < 1e-6, "{both}");
        assert!((red - Vec3::new(expected.x, 0.0, 0.0)).abs().max_element() < 1e-6, "{red}");
    }

    #[test]
    fn lights_that_miss_the_focus_still_light_what_they_meet() {
        let below = Light::hard("below", HardLight::Sun(DVec3::NEG_Y));
        assert_eq!(pixel(&[below], 1.0), pixel(&[], 1.0));
        let dark = Light { power: DVec3::ZERO, ..Light::hard("dark", HardLight::Sun(DVec3::Y)) };
        assert_eq!(pixel(&[dark], 1.0), pixel(&[], 1.0));
    }

    fn pixel(lights: &[Light], fraction: f32) -> Vec3 {
        let look = Look { colors: &[], focus: DVec3::ZERO, fade: 100.0, white: NEUTRAL };
        let fractions: Vec<Fractions<'_>> = lights.iter().map(|_| Fractions::Plain(vec![fraction])).collect();
        shaded(&one_hit(), lights, &fractions, &look).pixels[1]
    }

    #[test]
    fn no_pairs_are_black() {
        assert_eq!(pairs(&one_hit(), &[0]).pixels[1], Vec3::ZERO);
        assert_eq!(pairs(&one_hit(), &[9]).pixels[1], Vec3::ONE);
    }
}
