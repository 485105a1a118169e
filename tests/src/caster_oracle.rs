//! The oracle of casters: masks, optical depths and light on the lattice, all pairs, sample by sample. Written apart from core, from
//! the rules themselves.
//!
//! A scene is a list of casters, each a mesh with a surface; a caster matters to a receiver iff their layers have a bit in common. A
//! sample is blocked iff an opaque triangle, or an opaque texel of a cutout, blocks it ([`hit::blocks`]); what it is seen through
//! adds its optical depth ([`hit::sees_through`]). What a hit's place on the triangle is, [`texel`] says; what depths let through,
//! [`depth`]; which meshes have an inside, [`closed`].

pub mod closed;
pub mod depth;
pub mod hit;
pub mod texel;

use std::ops::Range;

use rayon::prelude::*;
use umbra4_core::{LatticeLight, glam::IVec3};

use crate::oracle;
use hit::Cone;
use texel::{Corners, OracleTexture};

/// What a mesh does to the light that meets it.
#[derive(Clone, Debug, PartialEq)]
pub enum OracleSurface {
    /// Stops it.
    Opaque,
    /// Stops it where a texture says so.
    Cutout {
        /// Alphas.
        texture: OracleTexture<u8>,
        /// Texture coordinates, a triangle each.
        coordinates: Vec<Corners>,
        /// Texels of this alpha or more stop light.
        threshold: u8,
    },
    /// Lets some of it through.
    Tinted {
        /// Optical depths: red, green, blue.
        texture: OracleTexture<[u16; 3]>,
        /// Texture coordinates, a triangle each; none where the first texel is all there is.
        coordinates: Option<Vec<Corners>>,
    },
}

/// A mesh that light meets.
#[derive(Clone, Debug, PartialEq)]
pub struct OracleCaster {
    /// Corners of all triangles.
    pub triangles: Vec<[IVec3; 3]>,
    /// What they do to light.
    pub surface: OracleSurface,
    /// Whether those of components without a boundary have an inside.
    pub closed: bool,
    /// Lattice units that planes are moved by towards the light.
    pub offset: i32,
    /// A set of 32.
    pub layers: u32,
}

impl OracleCaster {
    /// Opaque, open, where it is, on all layers.
    pub fn opaque(triangles: Vec<[IVec3; 3]>) -> Self {
        Self { triangles, surface: OracleSurface::Opaque, closed: false, offset: 0, layers: u32::MAX }
    }

    /// The same mesh with another surface.
    #[must_use]
    pub fn with_surface(self, surface: OracleSurface) -> Self {
        Self { surface, ..self }
    }

    /// Leaves triangles out.
    pub fn remove(&mut self, triangles: Range<usize>) {
        self.triangles.drain(triangles.clone());
        match &mut self.surface {
            OracleSurface::Cutout { coordinates, .. }
            | OracleSurface::Tinted { coordinates: Some(coordinates), .. } => {
                coordinates.drain(triangles);
            }
            _ => {}
        }
    }

    fn is_tinted(&self) -> bool {
        matches!(self.surface, OracleSurface::Tinted { .. })
    }
}

/// A point that light falls on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OracleReceiver {
    /// Where it is.
    pub point: IVec3,
    /// A set of 32.
    pub layers: u32,
}

impl From<IVec3> for OracleReceiver {
    fn from(point: IVec3) -> Self {
        Self { point, layers: u32::MAX }
    }
}

/// All samples of a light, row by row. Those of a regular one not by [`LatticeLight::sample`]: where jitter puts them is input.
pub fn samples(light: &LatticeLight) -> Vec<IVec3> {
    let one = |row: u32, column: u32| match light.jitter.is_some() {
        true => light.sample(row, column),
        false => light.origin + light.step_v * row as i32 + light.step_u * column as i32,
    };
    (0..light.rows).flat_map(|row| (0..light.columns).map(move |column| one(row, column))).collect()
}

/// A light, its samples, and what of the casters does not depend on the receiver.
#[derive(Debug)]
pub struct Prepared<'a> {
    light: &'a LatticeLight,
    samples: Vec<IVec3>,
    casters: &'a [OracleCaster],
    /// For every caster, which of its triangles have an inside behind them.
    closed: Vec<Vec<bool>>,
}

/// What is seen of a light from one receiver.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// Blocked samples, a word for each row, bit j the column j.
    pub mask: Vec<u64>,
    /// Optical depths of what the samples are seen through, row by row; of those that are blocked, too. None where all are
    /// because the receiver lies behind the light.
    pub depths: Option<Vec<[u16; 3]>>,
}

/// How often the rules that are not the plain one have decided something.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Decisions {
    /// Samples that meet a cutout's triangle at a texel that is not opaque.
    pub cut_out: u64,
    /// Samples that meet a cutout's triangle at one that is.
    pub kept: u64,
    /// Samples that the plain rule blocks, but triangles that face the light do not.
    pub faced: u64,
    /// Samples blocked with the plane moved and not where it is, or the other way round.
    pub moved: u64,
    /// Depths added.
    pub tinted: u64,
    /// Depths not added, or added, since a sample lies exactly on an edge.
    pub on_edge: u64,
    /// Casters passed over for their layers.
    pub apart: u64,
}

impl Decisions {
    /// Adds those of another run.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self {
            cut_out: self.cut_out + other.cut_out,
            kept: self.kept + other.kept,
            faced: self.faced + other.faced,
            moved: self.moved + other.moved,
            tinted: self.tinted + other.tinted,
            on_edge: self.on_edge + other.on_edge,
            apart: self.apart + other.apart,
        }
    }
}

impl<'a> Prepared<'a> {
    /// For a light and all casters.
    pub fn new(light: &'a LatticeLight, casters: &'a [OracleCaster]) -> Self {
        let inside = |caster: &OracleCaster| match caster.closed {
            true => closed::in_closed_components(&caster.triangles),
            false => vec![false; caster.triangles.len()],
        };
        Self { light, samples: samples(light), casters, closed: casters.iter().map(inside).collect() }
    }

    /// What one receiver sees.
    pub fn seen(&self, receiver: OracleReceiver) -> (Seen, Decisions) {
        let light = self.light;
        let mut decisions = Decisions::default();
        if oracle::behind(light, receiver.point) {
            let full = u64::MAX >> (64 - light.columns);
            return (Seen { mask: vec![full; light.rows as usize], depths: None }, decisions);
        }
        let mut blocked = vec![false; self.samples.len()];
        let mut depths = vec![[0_u16; 3]; self.samples.len()];
        for (caster, closed) in self.casters.iter().zip(&self.closed) {
            if caster.layers & receiver.layers == 0 {
                decisions.apart += 1;
            } else if caster.is_tinted() {
                self.add_depths(caster, receiver.point, &mut depths, &mut decisions);
            } else {
                self.add_blocked(caster, closed, receiver.point, &mut blocked, &mut decisions);
            }
        }
        let word = |row: &[bool]| row.iter().enumerate().fold(0, |word, (j, &bit)| word | u64::from(bit) << j);
        let mask = blocked.chunks(light.columns as usize).map(word).collect();
        (Seen { mask, depths: Some(depths) }, decisions)
    }

    fn add_blocked(
        &self,
        caster: &OracleCaster,
        closed: &[bool],
        p: IVec3,
        blocked: &mut [bool],
        decisions: &mut Decisions,
    ) {
        for (t, (&triangle, &closed)) in caster.triangles.iter().zip(closed).enumerate() {
            let cone = Cone::new(p, triangle);
            let offset = hit::offset_side(self.light, triangle).filter(|_| caster.offset != 0);
            if cone.misses(self.light, offset) {
                continue;
            }
            for (&sample, blocked) in self.samples.iter().zip(blocked.iter_mut()) {
                let plain = cone.plain(sample);
                let unmoved = plain.filter(|_| !closed || hit::is_behind(triangle, sample));
                decisions.faced += u64::from(plain.is_some() && unmoved.is_none());
                let met = match offset {
                    None => unmoved,
                    Some(side) => cone
                        .with_plane_moved(sample, side, caster.offset)
                        .filter(|_| !closed || hit::is_behind(triangle, sample)),
                };
                decisions.moved += u64::from(met.is_some() != unmoved.is_some());
                let Some(weights) = met else { continue };
                *blocked |= match &caster.surface {
                    OracleSurface::Cutout { texture, coordinates, threshold } => {
                        let opaque = *texture.at(&coordinates[t], &weights) >= *threshold;
                        decisions.kept += u64::from(opaque);
                        decisions.cut_out += u64::from(!opaque);
                        opaque
                    }
                    _ => true,
                };
            }
        }
    }

    fn add_depths(&self, caster: &OracleCaster, p: IVec3, depths: &mut [[u16; 3]], decisions: &mut Decisions) {
        let OracleSurface::Tinted { texture, coordinates } = &caster.surface else { return };
        let steps = [self.light.step_u, self.light.step_v];
        for (t, &triangle) in caster.triangles.iter().enumerate() {
            let cone = Cone::new(p, triangle);
            if cone.misses(self.light, None) {
                continue;
            }
            for (&sample, depth) in self.samples.iter().zip(depths.iter_mut()) {
                let Some(weights) = cone.plain(sample) else { continue };
                decisions.on_edge += u64::from(weights.contains(&0));
                if weights.contains(&0) && !cone.sees_moved(sample, steps) {
                    continue;
                }
                decisions.tinted += 1;
                let added = match coordinates {
                    Some(coordinates) => texture.at(&coordinates[t], &weights),
                    None => &texture.texels[0],
                };
                *depth = depth::sum(*depth, *added);
            }
        }
    }
}

/// What all receivers see.
pub fn seen(light: &LatticeLight, receivers: &[OracleReceiver], casters: &[OracleCaster]) -> (Vec<Seen>, Decisions) {
    let prepared = Prepared::new(light, casters);
    let of_each: Vec<_> = receivers.par_iter().map(|&receiver| prepared.seen(receiver)).collect();
    let decisions = of_each.iter().fold(Decisions::default(), |sum, (_, own)| sum.with(*own));
    (of_each.into_iter().map(|(seen, _)| seen).collect(), decisions)
}

/// The masks of all receivers, receiver-major, as [`crate::compare::compare_masks`] takes them.
pub fn masks(seen: &[Seen]) -> Vec<u64> {
    seen.iter().flat_map(|seen| seen.mask.iter().copied()).collect()
}

/// The light of a receiver, of samples with given weights, row by row.
pub fn light_of(light: &LatticeLight, seen: &Seen, weights: &[[u16; 3]]) -> [u32; 3] {
    let mut sum = [0_u64; 3];
    let Some(depths) = &seen.depths else { return [0; 3] };
    for (k, (weight, depth)) in weights.iter().zip(depths).enumerate() {
        let (row, column) = (k / light.columns as usize, k % light.columns as usize);
        if seen.mask[row] >> column & 1 == 0 {
            for channel in 0..3 {
                sum[channel] += u64::from(depth::transmitted(weight[channel], depth[channel]));
            }
        }
    }
    sum.map(|sum| u32::try_from(sum).expect("4096 weights of 16 bits are below 2^28"))
}
