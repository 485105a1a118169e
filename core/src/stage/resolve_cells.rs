//! Stage `resolve_cells`: all triangles of a cell against up to sixteen of its receivers.
//!
//! Seed: Wang et al. 2016, Algorithm 1 (lines 19 to 24) and Algorithm 3. Departure: sixteen receivers are taken at once,
//! in lanes. Nothing else is left out, so that pairs are counted as the paper counts them: a receiver whose mask is full
//! goes on.

use crate::{
    edge_plane::LightGrid,
    jitter::Regular,
    lanes::Lanes,
    mask_word::MaskWord,
    occluder::Occluder,
    precision::PrecisionMode,
    proj4::Keys,
    stage::resolve::{Group, Meeting},
    statistics::Tally,
};

/// How a mask is filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Rows {
    /// A word a row (section 3.3).
    #[default]
    Words,
    /// A light sample at a time, as in Algorithm 1, lines 22 to 24. The bits are the same.
    Bits,
}

/// The triangles of a scene as one light sees them, and what is done with a pair.
#[derive(Clone, Copy, Debug)]
pub struct CellScene<'a> {
    /// The light.
    pub grid: &'a LightGrid,
    /// All triangles; `None` for those that block nothing.
    pub triangles: &'a [Option<(Keys, Occluder)>],
    /// Whether pairs are held to the full-coverage test (Algorithm 3, lines 5 and 6).
    pub early_rejection: bool,
    /// How a mask is filled.
    pub rows: Rows,
}

/// Fills the masks of a group with the triangles `list` of its cell.
#[inline(always)]
pub fn resolve_cell<L: Lanes, W: MaskWord, P: PrecisionMode>(
    scene: &CellScene<'_>,
    list: &[u32],
    group: &mut Group<W>,
) {
    if group.active == 0 {
        return;
    }
    let mut meeting = Meeting::<L::Long>::new::<L, W, P>(scene.grid, group);
    let mut at = 0;
    while at < list.len() && group.active != 0 {
        let found = scene.triangles.get(list[at] as usize);
        at += 1;
        let Some(Some((keys, occluder))) = found else { continue };
        group.counts.pairs_tested += Tally::from(group.active.count_ones());
        let mut kept = group.active;
        if scene.early_rejection {
            kept &= group.needs.dominated_by::<L>(keys);
        }
        if kept == 0 {
            continue;
        }
        group.counts.pairs_kept += Tally::from(kept.count_ones());
        match scene.rows {
            Rows::Words => meeting.meet::<L, W, P, Regular>(scene.grid, &Regular, occluder, kept, group),
            Rows::Bits => meeting.meet_bits::<L, W, P>(scene.grid, occluder, kept, group),
        }
    }
    group.sum_relevant();
}
