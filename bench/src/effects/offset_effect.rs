//! What an offset of the triangles' planes darkens: masks with offsets of several sizes, against those without.

use std::fmt::Write;

use umbra4_core::glam::IVec3;
use umbra4_cpu::{Caster, CpuExecutor, Occluders};

use crate::{contender::ContenderError, problem::Problem};

/// In thousandths of the light's longer edge.
const OFFSETS: [u32; 3] = [1, 10, 100];

/// A line an offset. Of the mesh as it is, and of its closed parts as closed.
///
/// # Errors
/// Whatever umbra4 refuses.
pub(super) fn markdown(
    scene: &str,
    executor: &CpuExecutor,
    occluders: &Occluders,
    problem: &Problem<'_>,
) -> Result<String, ContenderError> {
    let light = problem.light;
    let edge = |step: IVec3, count: u32| step.as_dvec3().length() * f64::from(count);
    let longer = edge(light.step_u, light.columns).max(edge(light.step_v, light.rows));
    let parts = occluders.closed_parts();
    let (closed, open) = occluders.split(parts.triangles());
    let casters = |offset: u32| -> Result<[Vec<Caster>; 2], ContenderError> {
        let both_sides = Caster::opaque(occluders.clone()).with_plane_offset(offset)?;
        let closed = Caster::opaque(closed.clone()).closed()?.with_plane_offset(offset)?;
        Ok([vec![both_sides], vec![closed, Caster::opaque(open.clone())]])
    };
    let lit = |casters: &[Caster]| -> Result<Vec<u32>, ContenderError> {
        let index = executor.index_casters(casters, &light);
        Ok(executor.caster_lit_counts(&index, &problem.receivers)?.0)
    };
    let without = casters(0)?;
    let without = [lit(&without[0])?, lit(&without[1])?];
    let mut out = format!(
        "\n| {scene}: offset ÷ the light's edge | samples that it darkens | receivers that lose half the light | … closed parts \
         as closed: samples | receivers |\n|---|--:|--:|--:|--:|\n"
    );
    for thousandths in OFFSETS {
        let casters = casters((longer * f64::from(thousandths) / 1000.0) as u32)?;
        // Writing to a string cannot fail.
        let _ = write!(out, "| {} ", f64::from(thousandths) / 1000.0);
        for (casters, without) in casters.iter().zip(&without) {
            let Darkened { samples, receivers } = Darkened::between(without, &lit(casters)?, light.sample_count());
            let _ = write!(out, "| {:.3} % | {:.3} % ", 100.0 * samples, 100.0 * receivers);
        }
        out.push_str("|\n");
    }
    Ok(out)
}

/// Shares of samples, and of receivers.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Darkened {
    samples: f64,
    receivers: f64,
}

impl Darkened {
    /// Of lit counts with and without.
    fn between(without: &[u32], with: &[u32], samples: u32) -> Self {
        let lost = || without.iter().zip(with).map(|(without, with)| without.saturating_sub(*with));
        let of = |sum: f64, all: f64| sum / all.max(1.0);
        let all = without.len() as f64;
        Self {
            samples: of(lost().map(f64::from).sum(), all * f64::from(samples)),
            receivers: of(lost().filter(|lost| 2 * lost >= samples).count() as f64, all),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_darkened_is_counted() {
        let found = Darkened::between(&[4, 4, 0, 3], &[4, 1, 0, 2], 4);
        assert_eq!(found, Darkened { samples: 4.0 / 16.0, receivers: 1.0 / 4.0 });
        assert_eq!(Darkened::between(&[], &[], 4), Darkened { samples: 0.0, receivers: 0.0 });
    }
}
