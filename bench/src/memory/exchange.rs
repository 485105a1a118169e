//! What the parent hands to its child: a scene and its receivers, as the bytes they are in memory.

use std::io::{Error, ErrorKind, Read, Result, Write};

use umbra4_core::{
    AreaLight, Bounds,
    glam::{DVec3, Vec3},
};

/// A scene and its receivers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Handed {
    pub(super) vertices: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    /// Corner and edges of the light.
    pub(super) lamp: [DVec3; 3],
    /// Rows and columns of the light.
    pub(super) samples: [u32; 2],
    /// Of everything.
    pub(super) bounds: Bounds,
}

impl Handed {
    /// Bytes of the triangles and receivers.
    pub(super) fn bytes(&self) -> u64 {
        let points = self.vertices.len() + self.positions.len() + self.normals.len();
        (size_of::<Vec3>() * points + size_of::<[u32; 3]>() * self.triangles.len()) as u64
    }

    /// The light.
    pub(super) fn light(&self) -> std::result::Result<AreaLight, umbra4_core::LightError> {
        AreaLight::new(self.lamp[0], self.lamp[1], self.lamp[2], self.samples[0], self.samples[1])
    }

    /// Writes everything.
    pub(super) fn write(&self, to: &mut impl Write) -> Result<()> {
        let lengths = [self.vertices.len(), self.triangles.len(), self.positions.len(), self.normals.len()];
        to.write_all(bytemuck::bytes_of(&lengths.map(|length| length as u64)))?;
        to.write_all(bytemuck::bytes_of(&self.samples))?;
        to.write_all(bytemuck::cast_slice(&self.lamp))?;
        to.write_all(bytemuck::cast_slice(&[self.bounds.min, self.bounds.max]))?;
        to.write_all(bytemuck::cast_slice(&self.vertices))?;
        to.write_all(bytemuck::cast_slice(&self.triangles))?;
        to.write_all(bytemuck::cast_slice(&self.positions))?;
        to.write_all(bytemuck::cast_slice(&self.normals))
    }

    /// Reads everything, into memory of just the size it takes.
    pub(super) fn read(from: &mut impl Read) -> Result<Self> {
        let mut lengths = [0_u64; 4];
        from.read_exact(bytemuck::bytes_of_mut(&mut lengths))?;
        let mut samples = [0_u32; 2];
        from.read_exact(bytemuck::bytes_of_mut(&mut samples))?;
        let (mut lamp, mut bounds) = ([DVec3::ZERO; 3], [DVec3::ZERO; 2]);
        from.read_exact(bytemuck::cast_slice_mut(&mut lamp))?;
        from.read_exact(bytemuck::cast_slice_mut(&mut bounds))?;
        let [min, max] = bounds;
        Ok(Self {
            vertices: items(from, lengths[0])?,
            triangles: items(from, lengths[1])?,
            positions: items(from, lengths[2])?,
            normals: items(from, lengths[3])?,
            lamp,
            samples,
            bounds: Bounds { min, max },
        })
    }
}

fn items<T: bytemuck::Pod>(from: &mut impl Read, length: u64) -> Result<Vec<T>> {
    let length = usize::try_from(length).map_err(|_| Error::from(ErrorKind::InvalidData))?;
    let mut items = vec![T::zeroed(); length];
    from.read_exact(bytemuck::cast_slice_mut(&mut items))?;
    Ok(items)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let handed = Handed {
            vertices: vec![Vec3::X, Vec3::Y, Vec3::Z],
            triangles: vec![[0, 1, 2]],
            positions: vec![Vec3::splat(0.5); 2],
            normals: vec![Vec3::NEG_Y; 2],
            lamp: [DVec3::Y, DVec3::X, DVec3::Z],
            samples: [64, 32],
            bounds: Bounds { min: DVec3::ZERO, max: DVec3::ONE },
        };
        let mut bytes = Vec::new();
        handed.write(&mut bytes).unwrap();
        assert_eq!(Handed::read(&mut &bytes[..]).unwrap(), handed);
        assert_eq!(handed.bytes(), 7 * 12 + 12);
        assert!(Handed::read(&mut &bytes[..bytes.len() - 1]).is_err());
    }
}
