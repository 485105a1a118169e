//! Kernel `resolve_cloud_by_table`: [`super::resolve_cloud`], by lookups in a [table of planes](crate::cloud_table).

use crate::{
    cloud_pair::{OWN_PLANE, Pair},
    kernel::{
        fetch,
        resolve_cloud::{CloudElement, full},
        store,
    },
    params::CloudParams,
    plane_cell::{CellGrid, PlaneCell},
    precision::PrecisionMode,
    shaft::{box_of, reaches},
    statistics::Tally,
};

/// A word of a table of planes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct TableWord {
    /// Bits of an entry.
    pub word: u32,
}

impl CloudElement for TableWord {
    #[inline(always)]
    fn mark<P: PrecisionMode>(
        pair: &Pair,
        params: &CloudParams,
        table: &[Self],
        start: usize,
        masks: &mut [u32],
        _: &mut Tally,
    ) -> u32 {
        let (samples, extent) = (params.samples(), params.extent());
        let cells = CellGrid::new(&extent, params.table());
        let words = samples.div_ceil(32);
        let (mut cut, mut k) = ([ALL; OWN_PLANE + 1], 0);
        while k <= OWN_PLANE {
            if pair.cuts >> k & 1 == 1 {
                cut[k] = cells.cell(pair, k);
            }
            k += 1;
        }
        let (mut found, mut word) = (0, 0);
        while word < words {
            let lit = full(samples, word) & !fetch(masks, start + word as usize, u32::MAX);
            found += (lit & behind(&cells, &cut, table, words, word)).count_ones();
            word += 1;
        }
        if found == 0 || !reaches(pair.receiver, extent.bounds(), box_of(pair.corners)) {
            return 0;
        }
        word = 0;
        while word < words {
            let place = start + word as usize;
            let blocked = full(samples, word) & behind(&cells, &cut, table, words, word);
            store(masks, place, fetch(masks, place, 0) | blocked);
            word += 1;
        }
        found
    }
}

/// The cell of a plane that cuts nothing.
const ALL: PlaneCell = PlaneCell { direction: 0, slot: -1 };

/// Word `word`, of `words`, of the samples on the inner sides of all planes.
#[inline(always)]
fn behind(cells: &CellGrid, planes: &[PlaneCell; OWN_PLANE + 1], table: &[TableWord], words: u32, word: u32) -> u32 {
    let (mut inside, mut k) = (u32::MAX, 0);
    while k <= OWN_PLANE {
        if planes[k].slot >= 0 {
            inside &= match cells.entry(planes[k]) {
                Some(entry) => fetch(table, (entry * words + word) as usize, TableWord { word: 0 }).word,
                None => 0,
            };
        }
        k += 1;
    }
    inside
}
