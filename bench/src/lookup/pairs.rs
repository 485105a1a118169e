//! Pairs of receivers and triangles of a real scene, as core's resolve stage comes to fill their rows: those that the
//! full-coverage test and the outline have left, of receivers that are not full yet.

use std::ops::Range;

use umbra4_core::{
    Exact, LatticeLight,
    edge_plane::{LightGrid, ReceiverTile},
    exact::{Wide, behind_light},
    glam::IVec3,
    jitter::Regular,
    lanes::{Sixteen, TILE},
    occluder::Occluder,
    outline::Outlines,
    proj4::{Keys, NeedTile},
    row_mask::{Ends, is_full},
    stage::{key_receivers, key_triangles, resolve::Group},
    view::View,
};

use super::{
    edges::EdgeTile,
    fill::{fill_rows, lanes_of},
};

/// The triangles before one group of sixteen receivers. Lists go together.
#[derive(Clone, Debug)]
pub struct GroupPairs {
    /// The receivers.
    pub receivers: ReceiverTile,
    /// Bit l: the triangle and lane l's receiver are a pair.
    pub lanes: Vec<u32>,
    /// The triangles.
    pub occluders: Vec<Occluder>,
    /// Their edges, as core's rows want them.
    pub outlines: Vec<Outlines<3>>,
    /// The same, as a table does.
    pub edges: Vec<EdgeTile>,
}

impl GroupPairs {
    /// No receivers, no triangles.
    pub const EMPTY: Self = Self {
        receivers: ReceiverTile::EMPTY,
        lanes: Vec::new(),
        occluders: Vec::new(),
        outlines: Vec::new(),
        edges: Vec::new(),
    };

    /// Of the receivers `points`, at most sixteen, with all triangles in `offered` that core outlines for them. (Those whose own
    /// plane meets the light have a fourth side, and are left out.)
    pub fn new(light: &LatticeLight, points: &[IVec3], offered: &[(Keys, Occluder)]) -> Self {
        let grid = LightGrid::new(*light);
        let (mut receivers, mut needs, mut active) = (ReceiverTile::EMPTY, NeedTile::NOTHING, 0);
        for (lane, &point) in points.iter().enumerate().take(TILE) {
            if let Some(keys) = key_receivers::keys_of(&grid.frame, light, point)
                && !behind_light::<Wide>(light, point)
            {
                receivers.set(lane, point);
                needs.set(lane, &keys);
                active |= 1 << lane;
            }
        }
        let mut pairs = Self { receivers, ..Self::EMPTY };
        if active == 0 {
            return pairs;
        }
        let view = View::new::<Sixteen, Exact>(&grid, &pairs.receivers, active);
        let (mut masks, ends) = (Group::<u64>::empty(light.rows).masks, Ends::<Sixteen>::new(light.columns));
        for (keys, occluder) in offered {
            let kept = needs.dominated_by::<Sixteen>(keys) & active;
            if kept == 0 || occluder.is_mixed() {
                continue;
            }
            let mut outlines = Outlines::EMPTY;
            let seen = outlines.outline::<Sixteen, Exact, Regular>(&grid, &view, occluder, false, kept);
            if seen.outlined == 0 {
                continue;
            }
            let mut edges = EdgeTile::EMPTY;
            for lane in lanes_of(seen.outlined) {
                edges.set(lane, light, pairs.receivers.point(lane), occluder);
                let mask = &mut masks[lane];
                fill_rows::<_, _, Exact>(light, &pairs, &outlines, occluder, lane, &ends, mask);
                active &= !(u32::from(is_full(mask, light.columns)) << lane);
            }
            pairs.push(seen.outlined, *occluder, outlines, edges);
        }
        pairs
    }

    fn push(&mut self, lanes: u32, occluder: Occluder, outlines: Outlines<3>, edges: EdgeTile) {
        self.lanes.push(lanes);
        self.occluders.push(occluder);
        self.outlines.push(outlines);
        self.edges.push(edges);
    }

    /// Takes over `triangles` of another group, in the place of its own.
    pub fn take(&mut self, group: &Self, triangles: Range<usize>) {
        fn replace<T: Clone>(list: &mut Vec<T>, by: &[T]) {
            list.clear();
            list.extend_from_slice(by);
        }
        self.receivers = group.receivers;
        replace(&mut self.lanes, &group.lanes[triangles.clone()]);
        replace(&mut self.occluders, &group.occluders[triangles.clone()]);
        replace(&mut self.outlines, &group.outlines[triangles.clone()]);
        replace(&mut self.edges, &group.edges[triangles]);
    }

    /// Number of pairs.
    pub fn count(&self) -> usize {
        self.lanes.iter().map(|lanes| lanes.count_ones() as usize).sum()
    }

    /// Rows of all pairs.
    pub fn rows(&self) -> u64 {
        let pairs = self.lanes.iter().zip(&self.edges);
        pairs.flat_map(|(&lanes, edges)| lanes_of(lanes).map(|lane| u64::from(edges.count[lane]))).sum()
    }
}

/// What triangles offer to the full-coverage test; those that block nothing are left out.
pub fn offered(light: &LatticeLight, triangles: impl Iterator<Item = [IVec3; 3]>) -> Vec<(Keys, Occluder)> {
    let frame = LightGrid::new(*light).frame;
    triangles.filter_map(|corners| key_triangles::keys_of(&frame, light, corners)).collect()
}
