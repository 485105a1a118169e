//! The ray tracer at umbra4's time, and at umbra4's error, as table 8 of Wang et al. 2016 has it.

use crate::report::{
    curve::{Curve, Knot, Reading},
    methods::Family,
    results::{Entry, Results},
};

/// One method of umbra4 against one family of rays.
pub struct Equal<'a> {
    /// The method of umbra4.
    pub ours: &'a Entry,
    /// The family of rays.
    pub rays: Family,
    /// What mean error its time buys with rays.
    pub error_at_equal_time: Reading,
    /// What seconds its mean error takes with rays.
    pub seconds_at_equal_error: Reading,
}

/// Every method of umbra4 against every family of rays.
pub fn equal(results: &Results) -> Vec<Equal<'_>> {
    let curves: Vec<(Family, Curve)> =
        results.families().filter(|f| f.is_rays()).map(|family| (family, curve(results, family))).collect();
    let ours = results.methods.iter().filter(|m| m.family.is_some_and(Family::is_exact));
    ours.flat_map(|ours| {
        curves.iter().map(move |(rays, curve)| Equal {
            ours,
            rays: *rays,
            error_at_equal_time: curve.error_at(ours.run.seconds()),
            seconds_at_equal_error: curve.seconds_at(ours.difference.mean),
        })
    })
    .collect()
}

fn curve(results: &Results, family: Family) -> Curve {
    Curve::through(results.of(family).map(|entry| {
        let index = entry.run.index_seconds;
        Knot { index, work: entry.run.seconds() - index, error: entry.difference.mean }
    }))
}
