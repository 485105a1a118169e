//! What the engine hands over, snapped once: occluders and receivers on the lattice.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;
use thiserror::Error;
use umbra4_core::{
    AnyLight, Facing, Lattice, Layers, Lift, SnapError,
    glam::{DVec3, IVec3, Vec3},
    stage::snap_receivers::lifted,
};

use crate::arrangement::Arrangement;

/// Why a scene is refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SceneError {
    /// A vertex is not finite, or outside the lattice.
    #[error("vertex {index}: {source}")]
    Vertex {
        /// Index of the vertex.
        index: usize,
        /// What is wrong with it.
        source: SnapError,
    },
    /// A receiver is not finite, or outside the lattice.
    #[error("receiver {index}: {source}")]
    Receiver {
        /// Index of the receiver.
        index: usize,
        /// What is wrong with it.
        source: SnapError,
    },
    /// A receiver's surface normal is zero or not finite.
    #[error("normal {index} is {normal}: it points nowhere")]
    Normal {
        /// Index of the receiver.
        index: usize,
        /// The normal given.
        normal: Vec3,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are only {vertices}")]
    IndexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex index it names.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// There are more elements than a 32-bit index can name.
    #[error("{count} {field} are too many: at most {most} can be indexed")]
    TooMany {
        /// "vertices", "triangles" or "receivers".
        field: &'static str,
        /// How many were given.
        count: usize,
        /// How many can be.
        most: usize,
    },
    /// A mesh does not move to another number of vertices.
    #[error("{count} vertices for a mesh of {vertices}")]
    VertexCount {
        /// Vertices given.
        count: usize,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// Two arrays that belong together differ in length.
    #[error("{count} layers for {receivers} receivers")]
    LayerCount {
        /// Layers given.
        count: usize,
        /// Receivers given.
        receivers: usize,
    },
    /// Two arrays that belong together differ in length.
    #[error("{count} normals for {receivers} receivers")]
    NormalCount {
        /// Normals given.
        count: usize,
        /// Receivers given.
        receivers: usize,
    },
}

/// Largest number of elements of one kind.
const MOST: usize = (u32::MAX - 1) as usize;

fn check_count(field: &'static str, count: usize) -> Result<(), SceneError> {
    if count > MOST { Err(SceneError::TooMany { field, count, most: MOST }) } else { Ok(()) }
}

/// The triangles that block light, on the lattice. One snapped scene serves all lights and frames.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Occluders {
    vertices: Vec<IVec3>,
    triangles: Vec<[u32; 3]>,
    arrangement: Option<Arrangement>,
}

impl Occluders {
    /// Snaps an indexed mesh. Degenerate triangles are legal and block nothing.
    ///
    /// # Errors
    /// The first vertex that is not finite or outside the lattice; the first index out of range.
    pub fn new(lattice: &Lattice, vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<Self, SceneError> {
        Self::snapped(vertices, triangles, |v| lattice.snap(*v))
    }

    /// As [`Occluders::new`], from f64 coordinates: for worlds far from the origin.
    ///
    /// # Errors
    /// As [`Occluders::new`].
    pub fn from_f64(lattice: &Lattice, vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, SceneError> {
        Self::snapped(vertices, triangles, |v| lattice.snap_f64(*v))
    }

    fn snapped<V: Sync>(
        vertices: &[V],
        triangles: &[[u32; 3]],
        snap: impl Fn(&V) -> Result<IVec3, SnapError> + Sync + Send,
    ) -> Result<Self, SceneError> {
        check_count("vertices", vertices.len())?;
        check_count("triangles", triangles.len())?;
        let triangles = each(triangles.len(), |triangle| {
            let indices = triangles[triangle];
            match indices.into_iter().find(|&vertex| vertex as usize >= vertices.len()) {
                Some(vertex) => Err(SceneError::IndexOutOfRange { triangle, vertex, vertices: vertices.len() }),
                None => Ok(indices),
            }
        })?;
        let vertices = snap_all(vertices, snap, |index, source| SceneError::Vertex { index, source })?;
        Ok(Self { vertices, triangles, arrangement: None })
    }

    /// The same occluders, in an order that suits every light, and with their neighbours found: worth its while for a mesh
    /// that serves many lights or frames. Runs for lights with an area then neither sort triangles nor search
    /// for neighbours (hard shadows are found as before). Masks are the same.
    ///
    /// [`Occluders::vertices`], [`Occluders::triangles`] and the triangles that [`Occluders::corners`] counts come in another
    /// order afterwards.
    #[must_use]
    pub fn arranged(self) -> Self {
        let Self { mut vertices, mut triangles, arrangement } = self;
        let arrangement = arrangement.unwrap_or_else(|| Arrangement::of(&mut vertices, &mut triangles));
        Self { vertices, triangles, arrangement: Some(arrangement) }
    }

    /// Moves the vertices, which come in the order in which they were given to [`Occluders::new`]. An arrangement stays
    /// good (the masks always are; triangles that end up far from where they were arranged take more time).
    ///
    /// ```
    /// use umbra4_cpu::Occluders;
    /// use umbra4_core::{glam::{DVec3, Vec3}, Bounds, Lattice};
    ///
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// let mut vertices = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    /// let mut occluders = Occluders::new(&lattice, &vertices, &[[0, 1, 2], [2, 1, 3]])?.arranged();
    /// for frame in 0..3 {
    ///     vertices[3].z = 1.0 + frame as f32;
    ///     occluders.move_vertices(&lattice, &vertices)?;
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Another number of vertices; the first that is not finite or outside the lattice. Nothing has moved then.
    pub fn move_vertices(&mut self, lattice: &Lattice, vertices: &[Vec3]) -> Result<(), SceneError> {
        self.moved(vertices, |v| lattice.snap(*v))
    }

    /// As [`Occluders::move_vertices`], from f64 coordinates.
    ///
    /// # Errors
    /// As [`Occluders::move_vertices`].
    pub fn move_vertices_f64(&mut self, lattice: &Lattice, vertices: &[DVec3]) -> Result<(), SceneError> {
        self.moved(vertices, |v| lattice.snap_f64(*v))
    }

    fn moved<V: Sync>(
        &mut self,
        vertices: &[V],
        snap: impl Fn(&V) -> Result<IVec3, SnapError> + Sync + Send,
    ) -> Result<(), SceneError> {
        if vertices.len() != self.vertices.len() {
            return Err(SceneError::VertexCount { count: vertices.len(), vertices: self.vertices.len() });
        }
        let vertices = snap_all(vertices, snap, |index, source| SceneError::Vertex { index, source })?;
        self.vertices = match &mut self.arrangement {
            Some(arrangement) => arrangement.follow(&vertices, &self.triangles),
            None => vertices,
        };
        Ok(())
    }

    /// The triangles for which `first` holds, and the others: each a mesh of the same vertices, in the same order. Triangles of which
    /// nothing is said are among the others. An arrangement is lost.
    pub fn split(&self, first: &[bool]) -> (Self, Self) {
        let is_first = |(index, _): &(usize, &[u32; 3])| first.get(*index).copied().unwrap_or(false);
        let (ours, others): (Vec<_>, Vec<_>) = self.triangles.iter().enumerate().partition(is_first);
        let mesh = |triangles: Vec<(usize, &[u32; 3])>| Self {
            vertices: self.vertices.clone(),
            triangles: triangles.into_iter().map(|(_, triangle)| *triangle).collect(),
            arrangement: None,
        };
        (mesh(ours), mesh(others))
    }

    /// The same triangles with every vertex in a place of its own: what they have in common, they have by their indices.
    pub(crate) fn by_indices(&self) -> Self {
        let vertices = (0..self.vertices.len() as i32).map(|index| IVec3::new(index, 0, 0)).collect();
        Self { vertices, triangles: self.triangles.clone(), arrangement: None }
    }

    /// What was found of an arranged mesh.
    pub(crate) fn arrangement(&self) -> Option<&Arrangement> {
        self.arrangement.as_ref()
    }

    /// Lattice coordinates of the vertices.
    pub fn vertices(&self) -> &[IVec3] {
        &self.vertices
    }

    /// Vertex indices of the triangles; all in range.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of triangle `index`, or `None` where there is no such triangle.
    pub fn corners(&self, index: usize) -> Option<[IVec3; 3]> {
        let [a, b, c] = *self.triangles.get(index)?;
        Some([self.vertices[a as usize], self.vertices[b as usize], self.vertices[c as usize]])
    }
}

/// The points whose masks are asked for, on the lattice.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Receivers {
    points: Vec<IVec3>,
    /// Of all of them, or of none.
    facings: Vec<Facing>,
    /// Of all of them, or of none.
    layers: Vec<Layers>,
}

impl Receivers {
    /// Raw receivers, taken as they are: no self-shadow lift.
    ///
    /// # Errors
    /// The first point that is not finite or outside the lattice.
    pub fn raw(lattice: &Lattice, points: &[Vec3]) -> Result<Self, SceneError> {
        check_count("receivers", points.len())?;
        let points = snap_all(points, |p| lattice.snap(*p), |index, source| SceneError::Receiver { index, source })?;
        Ok(Self { points, facings: Vec::new(), layers: Vec::new() })
    }

    /// As [`Receivers::raw`], from f64 coordinates.
    ///
    /// # Errors
    /// As [`Receivers::raw`].
    pub fn raw_f64(lattice: &Lattice, points: &[DVec3]) -> Result<Self, SceneError> {
        check_count("receivers", points.len())?;
        let points =
            snap_all(points, |p| lattice.snap_f64(*p), |index, source| SceneError::Receiver { index, source })?;
        Ok(Self { points, facings: Vec::new(), layers: Vec::new() })
    }

    /// Receivers that lie on surfaces with the given normals (of any length, towards the side that is seen), such as a
    /// G-buffer's: each is lifted off its surface along the normal's dominant axis, so that the surface and its coplanar
    /// neighbours do not shadow it. `lift` follows from how the positions were rounded, see [`Lift`].
    ///
    /// # Errors
    /// As [`Receivers::raw`]; a normal that is zero or not finite; arrays of different lengths.
    pub fn on_surfaces(lattice: &Lattice, points: &[Vec3], normals: &[Vec3], lift: Lift) -> Result<Self, SceneError> {
        if normals.len() != points.len() {
            return Err(SceneError::NormalCount { count: normals.len(), receivers: points.len() });
        }
        let Self { points, facings, layers } = Self::raw(lattice, points)?;
        let lifted = |index: usize| {
            lifted(points[index], normals[index], lift).ok_or(SceneError::Normal { index, normal: normals[index] })
        };
        Ok(Self { points: each(points.len(), lifted)?, facings, layers })
    }

    /// The same receivers, each of which faces the side that its surface's normal points to (of any length): a light that lies
    /// wholly behind that surface does not reach it, and no triangle is looked at for it; all bits of its mask are set. Worth
    /// its while where light from behind is not asked for, since receivers in the shade of their own object cost most. The test
    /// is [`Facing`]'s.
    ///
    /// ```
    /// use umbra4_cpu::{CpuExecutor, Occluders, Receivers};
    /// use umbra4_core::{AreaLight, Bounds, Lattice, Lift, glam::{DVec3, Vec3}};
    ///
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// let lamp = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 16, 16)?.snap(&lattice, Lift::NONE)?;
    /// let receivers = Receivers::raw(&lattice, &[Vec3::ZERO, Vec3::ZERO])?.facing(&[Vec3::Y, Vec3::NEG_Y])?;
    /// let (visibility, _) = CpuExecutor::new().visibility(&Occluders::default(), &lamp, &receivers)?;
    /// assert_eq!(visibility, [1.0, 0.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Another number of normals than receivers; the first normal that points nowhere.
    pub fn facing(self, normals: &[Vec3]) -> Result<Self, SceneError> {
        let Self { points, layers, .. } = self;
        if normals.len() != points.len() {
            return Err(SceneError::NormalCount { count: normals.len(), receivers: points.len() });
        }
        let facing = |index: usize| match Facing::of(normals[index]) {
            Facing::UNKNOWN => Err(SceneError::Normal { index, normal: normals[index] }),
            facing => Ok(facing),
        };
        Ok(Self { facings: each(points.len(), facing)?, points, layers })
    }

    /// The same receivers, each on layers of its own: of casters, those that have a layer in common shadow it
    /// ([`crate::Caster::on_layers`]). Occluders that are no casters are on no layer, and shadow every receiver.
    ///
    /// # Errors
    /// Another number of layers than receivers.
    pub fn on_layers(self, layers: &[Layers]) -> Result<Self, SceneError> {
        let receivers = self.points.len();
        if layers.len() != receivers {
            return Err(SceneError::LayerCount { count: layers.len(), receivers });
        }
        Ok(Self { layers: layers.to_vec(), ..self })
    }

    /// The layers that each receiver is on; empty where all are on every layer.
    pub fn layers(&self) -> &[Layers] {
        &self.layers
    }

    /// The layers that receiver `index` is on.
    pub(crate) fn layers_of(&self, index: usize) -> Layers {
        self.layers.get(index).copied().unwrap_or(Layers::ALL)
    }

    /// Which way each receiver faces; empty where they may look to any side.
    pub fn facings(&self) -> &[Facing] {
        &self.facings
    }

    /// Which way receiver `index` faces.
    pub(crate) fn facing_of(&self, index: usize) -> Facing {
        self.facings.get(index).copied().unwrap_or(Facing::UNKNOWN)
    }

    /// Whether one of them sees the light where nothing lies between.
    pub(crate) fn meet(&self, light: impl Into<AnyLight>) -> bool {
        let light = light.into();
        self.points.iter().enumerate().any(|(index, p)| self.facing_of(index).sees(&light, *p))
    }

    /// Lattice coordinates of the receivers.
    pub fn points(&self) -> &[IVec3] {
        &self.points
    }

    /// Number of receivers.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// True where there are none.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }
}

fn snap_all<P: Sync>(
    points: &[P],
    snap: impl Fn(&P) -> Result<IVec3, SnapError> + Sync + Send,
    error: impl Fn(usize, SnapError) -> SceneError + Sync,
) -> Result<Vec<IVec3>, SceneError> {
    each(points.len(), |index| snap(&points[index]).map_err(|source| error(index, source)))
}

/// Makes `count` things on all threads. The first that is refused is named, whatever the number of threads.
fn each<T: Default + Send>(
    count: usize,
    make: impl Fn(usize) -> Result<T, SceneError> + Sync,
) -> Result<Vec<T>, SceneError> {
    let refused: Mutex<Option<(usize, SceneError)>> = Mutex::new(None);
    let refuse = |index: usize, error: SceneError| {
        let mut first = refused.lock().unwrap_or_else(PoisonError::into_inner);
        if first.as_ref().is_none_or(|(earlier, _)| index < *earlier) {
            *first = Some((index, error));
        }
        T::default()
    };
    let things = (0..count).into_par_iter().map(|index| make(index).unwrap_or_else(|error| refuse(index, error)));
    let things = things.collect();
    match refused.into_inner().unwrap_or_else(PoisonError::into_inner) {
        None => Ok(things),
        Some((_, error)) => Err(error),
    }
}
