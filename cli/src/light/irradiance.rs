//! What an unoccluded surface gets of a light.

use umbra4_core::glam::DVec3;

use super::{AreaSource, HardLight, Light, Source};

/// Points each way by which the form factor of an area is found.
const FORM_FACTOR: u32 = 4;

/// A light without its occluders, of power 1.
pub struct Lamp {
    form: Form,
}

enum Form {
    /// A few points that stand for the area; its area, normal and middle.
    Area { points: Vec<DVec3>, area: f64, normal: DVec3, center: DVec3, two_sided: bool },
    /// As it is.
    Hard(HardLight),
    /// A few points that stand for the volume.
    Volume(Vec<DVec3>),
}

impl Lamp {
    /// That of a light.
    pub fn new(light: &Light) -> Self {
        let form = match &light.source {
            Source::Area(source) => Form::of_area(source),
            Source::Hard(light) => Form::Hard(*light),
            Source::Volume(volume) => Form::Volume(volume.stand_ins()),
        };
        Self { form }
    }

    /// Irradiance at a point with that normal: of a light with an area (world units squared) the whole rectangle
    /// counts, as if all of it emitted what the mean sample does.
    pub fn irradiance(&self, position: DVec3, normal: DVec3) -> f64 {
        let (points, area, own_normal, two_sided) = match &self.form {
            Form::Area { points, area, normal, two_sided, .. } => (points, *area, *normal, *two_sided),
            Form::Hard(light) => return light.irradiance(position, normal),
            Form::Volume(points) => {
                let of = |point: &DVec3| HardLight::Lamp(*point).irradiance(position, normal);
                return points.iter().map(of).sum::<f64>() / points.len().max(1) as f64;
            }
        };
        let from = |point: &DVec3| {
            let towards = point - position;
            let squared = towards.length_squared().max(f64::MIN_POSITIVE);
            let emitted = own_normal.dot(-towards);
            let emitted = if two_sided { emitted.abs() } else { emitted.max(0.0) };
            normal.dot(towards).max(0.0) * emitted / (squared * squared)
        };
        points.iter().map(from).sum::<f64>() * area / f64::from(FORM_FACTOR * FORM_FACTOR)
    }

    /// As [`Lamp::irradiance`], on a surface that is tilted half-way towards the light.
    pub fn facing(&self, position: DVec3) -> f64 {
        let towards = match &self.form {
            Form::Area { center, .. } => *center - position,
            Form::Hard(light) => light.towards(position),
            Form::Volume(points) => points.iter().sum::<DVec3>() / points.len().max(1) as f64 - position,
        };
        let towards = towards.normalize_or(DVec3::Y);
        self.irradiance(position, (towards + DVec3::Y).normalize_or(DVec3::Y))
    }
}

impl Form {
    fn of_area(source: &AreaSource) -> Self {
        let light = &source.front().area;
        let [corner, along_u, _, along_v] = light.corners();
        let (u, v) = (along_u - corner, along_v - corner);
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(FORM_FACTOR);
        let points = (0..FORM_FACTOR * FORM_FACTOR)
            .map(|i| corner + u * at(i % FORM_FACTOR) + v * at(i / FORM_FACTOR))
            .collect();
        // Of length 1 each first, so that tiny lights keep their normal.
        let (across, along) = (u.normalize_or_zero(), v.normalize_or_zero());
        let sine = across.cross(along);
        Self::Area {
            points,
            area: sine.length() * u.length() * v.length(),
            normal: sine.normalize_or_zero(),
            center: light.center(),
            two_sided: source.back().is_some(),
        }
    }
}

#[cfg(test)]
mod tests {
    use umbra4_core::SphereLight;

    use super::*;
    use crate::{
        light::{Volume, VolumeSource},
        light_file::LightShape,
    };

    fn square(two_sided: bool, edge: f64) -> Light {
        let half = -0.5 * edge;
        let shape = LightShape { corner: [half, 10.0, half], edge_u: [edge, 0.0, 0.0], edge_v: [0.0, 0.0, edge] };
        let source = Source::Area(AreaSource::new(&shape, [4, 4], None, two_sided).unwrap());
        Light { label: "square".to_owned(), power: DVec3::ONE, source }
    }

    #[test]
    fn a_small_area_is_as_bright_as_a_point() {
        let lamp = Light::hard("lamp", HardLight::Lamp(DVec3::new(0.0, 10.0, 0.0)));
        let (area, point) = (Lamp::new(&square(false, 0.1)), Lamp::new(&lamp));
        let at = |lamp: &Lamp| lamp.irradiance(DVec3::ZERO, DVec3::Y);
        assert!((at(&area) / at(&point) / 0.01 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_volume_is_as_bright_as_a_point() {
        let center = DVec3::new(0.0, 10.0, 0.0);
        let volume = Volume::Sphere(SphereLight { center, radius: 0.5 });
        let source = Source::Volume(VolumeSource { volume, samples: 64 });
        let sphere = Light { label: "sphere".to_owned(), power: DVec3::ONE, source };
        let at = |light: &Light| Lamp::new(light).irradiance(DVec3::X, DVec3::Y);
        assert!((at(&sphere) / at(&Light::hard("lamp", HardLight::Lamp(center))) - 1.0).abs() < 0.01);
    }

    #[test]
    fn one_side_shines_or_both() {
        let above = |two_sided| Lamp::new(&square(two_sided, 1.0)).irradiance(DVec3::Y * 20.0, -DVec3::Y);
        let below = |two_sided| Lamp::new(&square(two_sided, 1.0)).irradiance(DVec3::ZERO, DVec3::Y);
        assert_eq!(above(false), 0.0);
        assert!((above(true) / below(true) - 1.0).abs() < 1e-9 && below(true) == below(false));
    }
}
