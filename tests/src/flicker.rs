//! Temporal noise: how much more, or otherwise, the visibility of neighbouring frames differs than that of exact ones does.

use umbra4_core::glam::DVec3;

use crate::scene::WorldScene;

/// Of the difference images of successive frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flicker {
    /// Mean change of a receiver from frame to frame, exact.
    pub exact: f64,
    /// The same, filtered.
    pub filtered: f64,
    /// Mean distance of both changes: noise, and what filtering makes of the change itself.
    pub noise: f64,
    /// The root of the mean square of that distance.
    pub root_mean_square: f64,
    /// The largest.
    pub most: f64,
}

/// The scene with its light moved by `frame` small steps, a hundredth of its edge each, aslant.
#[must_use]
pub fn moved(scene: &WorldScene, frame: u32) -> WorldScene {
    let corner = scene.corner + DVec3::new(0.01, 0.0, 0.004) * f64::from(frame);
    WorldScene { corner, ..scene.clone() }
}

/// Of frames in order, each filtered and exact visibility of the same receivers. Fewer than two have no flicker.
pub fn flicker(frames: &[(Vec<f32>, Vec<f32>)]) -> Flicker {
    let mut sum = Flicker::default();
    let mut count = 0_usize;
    for pair in frames.windows(2) {
        let [(filtered, exact), (next_filtered, next_exact)] = pair else { unreachable!("windows of two") };
        let lengths = [exact.len(), next_filtered.len(), next_exact.len()];
        assert_eq!(lengths, [filtered.len(); 3], "of the same receivers");
        for k in 0..filtered.len() {
            let change = f64::from(next_filtered[k] - filtered[k]);
            let wanted = f64::from(next_exact[k] - exact[k]);
            let away = (change - wanted).abs();
            sum.filtered += change.abs();
            sum.exact += wanted.abs();
            sum.noise += away;
            sum.root_mean_square += away * away;
            sum.most = sum.most.max(away);
        }
        count += filtered.len();
    }
    let one = 1.0 / count.max(1) as f64;
    Flicker {
        exact: sum.exact * one,
        filtered: sum.filtered * one,
        noise: sum.noise * one,
        root_mean_square: (sum.root_mean_square * one).sqrt(),
        most: sum.most,
    }
}

/// The difference image of two frames, a binary PGM `across` pixels wide: gray where nothing changes, white and black where `1 / gain` of the
/// light is gained and lost.
#[must_use]
pub fn difference_image(before: &[f32], after: &[f32], across: usize, gain: f32) -> Vec<u8> {
    assert_eq!(before.len(), after.len(), "of the same receivers");
    let mut image = format!("P5\n{across} {}\n255\n", before.len() / across.max(1)).into_bytes();
    image.extend(
        before.iter().zip(after).map(|(before, after)| (127.5 + 127.5 * gain * (after - before)).round() as u8),
    );
    image
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_compared() {
        let frames = [(vec![0.5, 0.25], vec![0.5, 0.0]), (vec![1.0, 0.25], vec![0.5, 0.5])];
        let found = flicker(&frames);
        let expected = Flicker { exact: 0.25, filtered: 0.25, noise: 0.5, root_mean_square: 0.5, most: 0.5 };
        assert_eq!(found, expected);
        assert_eq!(flicker(&frames[..1]), Flicker::default());
    }

    #[test]
    fn images_of_differences_are_gray_where_nothing_changes() {
        let image = difference_image(&[0.5, 0.5, 1.0, 0.0], &[0.5, 0.75, 0.0, 0.125], 2, 4.0);
        assert_eq!(image, [b"P5\n2 2\n255\n" as &[u8], &[128, 255, 0, 191]].concat());
    }
}
