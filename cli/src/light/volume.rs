//! Lights that fill a volume: their samples lie anywhere in it.

use umbra4_core::{
    Bounds, EllipsoidLight, Lattice, SphereLight, TubeLight, VolumeLightError,
    cloud::Cloud,
    glam::{DVec3, IVec3},
    volume_light::snap_points,
};

/// A volume that shines to all sides, world.
#[derive(Clone, Debug, PartialEq)]
pub enum Volume {
    /// A ball.
    Sphere(SphereLight),
    /// A ball of other axes.
    Ellipsoid(EllipsoidLight),
    /// A round tube.
    Tube(TubeLight),
    /// Samples where they are given.
    Points(Vec<DVec3>),
}

/// A volume with its number of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeSource {
    /// Where it shines from.
    pub volume: Volume,
    /// Samples, in `1..=1024`; of points, as many as there are.
    pub samples: usize,
}

/// Points that stand for a volume where its brightness is concerned, at most.
const STAND_INS: usize = 64;

impl VolumeSource {
    /// What the lattice has to hold of it.
    pub fn bounds(&self) -> Bounds {
        match &self.volume {
            Volume::Sphere(ball) => around(ball.center, DVec3::splat(ball.radius)),
            Volume::Ellipsoid(ball) => {
                let [a, b, c] = ball.axes;
                around(ball.center, (a * a + b * b + c * c).powf(0.5))
            }
            Volume::Tube(tube) => {
                let [from, to] = [tube.from, tube.to].map(|end| around(end, DVec3::splat(tube.radius)));
                from.union(to)
            }
            Volume::Points(points) => Bounds::of(points.iter().copied()),
        }
    }

    /// Its samples on the lattice.
    ///
    /// # Errors
    /// A size that is no size; a light too small for the lattice; samples outside it.
    pub fn snap(&self, lattice: &Lattice) -> Result<Cloud<Vec<IVec3>>, VolumeLightError> {
        let room = vec![IVec3::ZERO; self.samples];
        match &self.volume {
            Volume::Sphere(ball) => ball.snap(lattice, room),
            Volume::Ellipsoid(ball) => ball.snap(lattice, room),
            Volume::Tube(tube) => tube.snap(lattice, room),
            Volume::Points(points) => snap_points(lattice, points, room),
        }
    }

    /// A few points that stand for it.
    pub fn stand_ins(&self) -> Vec<DVec3> {
        match &self.volume {
            Volume::Sphere(ball) => across(ball.center, DVec3::AXES.map(|axis| axis * ball.radius)),
            Volume::Ellipsoid(ball) => across(ball.center, ball.axes),
            Volume::Tube(tube) => (0..16).map(|k| tube.from.lerp(tube.to, (f64::from(k) + 0.5) / 16.0)).collect(),
            Volume::Points(points) => points.iter().step_by(points.len().div_ceil(STAND_INS).max(1)).copied().collect(),
        }
    }

    /// What it is, in a few words.
    pub fn kind(&self) -> String {
        let name = match &self.volume {
            Volume::Sphere(_) => "a sphere",
            Volume::Ellipsoid(_) => "an ellipsoid",
            Volume::Tube(_) => "a tube",
            Volume::Points(_) => "a cloud",
        };
        format!("{name} of {} samples", self.samples)
    }
}

fn around(center: DVec3, reach: DVec3) -> Bounds {
    Bounds::of([center - reach, center + reach])
}

/// Half-way to the surface along all axes, both ways.
fn across(center: DVec3, axes: [DVec3; 3]) -> Vec<DVec3> {
    axes.into_iter().flat_map(|axis| [center - axis * 0.5, center + axis * 0.5]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_hold_all_samples() {
        let lattice = Lattice::covering(Bounds { min: DVec3::splat(-9.0), max: DVec3::splat(9.0) }).unwrap();
        let axes = [DVec3::new(1.0, 1.0, 0.0), DVec3::new(-0.5, 2.0, 0.0), DVec3::new(0.0, 0.3, 0.7)];
        let (from, to) = (DVec3::new(-1.0, 2.0, 0.0), DVec3::new(2.0, 0.5, 1.0));
        for volume in [
            Volume::Sphere(SphereLight { center: DVec3::ONE, radius: 0.7 }),
            Volume::Ellipsoid(EllipsoidLight { center: DVec3::NEG_ONE, axes }),
            Volume::Tube(TubeLight { from, to, radius: 0.25 }),
        ] {
            let source = VolumeSource { volume, samples: 1000 };
            let Bounds { min, max } = source.bounds();
            let (slack, cloud) = (DVec3::splat(2.0 * lattice.step()), source.snap(&lattice).unwrap());
            for sample in cloud.samples().iter().map(|sample| lattice.to_world(*sample)) {
                assert!(sample.cmpge(min - slack).all() && sample.cmple(max + slack).all(), "{source:?}: {sample}");
            }
            for point in source.stand_ins() {
                assert!(point.cmpge(min).all() && point.cmple(max).all(), "{source:?}: {point}");
            }
        }
    }
}
