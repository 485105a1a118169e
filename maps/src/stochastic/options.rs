//! What a user chooses, and what each choice loses.

use thiserror::Error;

/// Most texels along a side: the sum of as many moments as such a map has texels does not overflow.
pub const MOST_SIZE: u32 = 4096;
/// Most filter planes.
pub const MOST_PLANES: u32 = 64;
/// Most coarse levels: a texel of the last is 2^8 wide.
pub const MOST_COARSE_LEVELS: u32 = 8;
/// [`StochasticOptions::widest_raise`] as in the paper: no map is wider.
pub const UNLIMITED_RAISE: f32 = 65536.0;
/// Largest exponent of an EVSM: `MOST_SIZE²·e^(2·35)` is below the largest f32.
pub const MOST_EXPONENT: f32 = 35.0;

/// Why options are refused.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum StochasticError {
    /// A number is outside its range, or not a number.
    #[error("stochastic shadow map: {field} is {value}, outside {least}..={most}")]
    OutOfRange {
        /// The field.
        field: &'static str,
        /// Its value.
        value: f64,
        /// Least value.
        least: f64,
        /// Largest value.
        most: f64,
    },
    /// Moments would overflow.
    #[error("stochastic shadow map: {field} is {value}: beyond {most} moments overflow")]
    Overflow {
        /// The field.
        field: &'static str,
        /// Its value.
        value: f64,
        /// Largest value.
        most: f64,
    },
}

/// Where filter planes lie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Placement {
    /// At even steps of depth between the nearest and the farthest receiver, as in the paper.
    Depth,
    /// At even steps of inverse depth: the width of penumbrae is linear in it.
    InverseDepth,
    /// Where receivers are: as dense as the cube root of their density over inverse depth. That is what makes the mean error least where
    /// the error between two planes grows with the square of their distance. The question is open in the paper (section 9).
    #[default]
    Receivers,
}

/// What depth is filtered as (section 5.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Basis {
    /// Depth and its square (eq. 5). Light leaks wherever a footprint holds occluders at several depths.
    Variance,
    /// The same of `e^(c·z)` and `−e^(−c·z)`, z being depth in −1..=1. Less light leaks with a larger `exponent` c, and float noise grows in
    /// wide penumbrae.
    Exponential {
        /// c, above 0, at most [`MOST_EXPONENT`].
        exponent: f32,
    },
}

/// The shape of a sample's circle of confusion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Footprint {
    /// An ellipse with the light's half-extents where eq. 6 has the radius of the light. For a rectangle it is too small, by a factor of
    /// 4/π in area.
    Ellipse,
    /// The light's own shape.
    #[default]
    Rectangle,
}

/// Where the middle of a sample's circle of confusion is taken to be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Centers {
    /// In the middle of the texel that holds it (section 7.3): penumbrae become wider than they are.
    Texel,
    /// Where it is: the projection of the hit from the middle of the light (section 5.3, step 2).
    #[default]
    Projected,
}

/// A stochastic soft shadow map.
///
/// Visibility comes filtered, without noise a receiver sees, but approximate: shadows near contacts are lost, light
/// leaks where a footprint holds several depths, and fine occluders flicker when the light moves. The masks of umbra4 have none of
/// that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StochasticOptions {
    /// Texels along each side, in `1..=`[`MOST_SIZE`]. Details below a texel are lost, and become flicker in motion.
    pub size: u32,
    /// Filter planes, in `1..=`[`MOST_PLANES`]. Between planes shadows are a mixture of a sharper and a softer one: contacts blur.
    pub planes: u32,
    /// Where they lie.
    pub placement: Placement,
    /// What depth is filtered as.
    pub basis: Basis,
    /// Shape of the circle of confusion.
    pub footprint: Footprint,
    /// Its middle.
    pub centers: Centers,
    /// The widest radius, texels, in `0.0..=`[`UNLIMITED_RAISE`], to which a sample's may be raised by its closest occluding neighbour (section 5.2).
    /// Partly occluded surfaces are sampled sparsely; this closes the holes. 0 leaves noise in penumbrae. Without limit, as in the paper, light
    /// spreads into umbrae by as much as the penumbra is wide; 2 texels hold a sample of every stratum, and below 3.2 (0.4 of the 8 that are gathered)
    /// such a sample is never merged with the wide ones of a coarse level.
    pub widest_raise: f32,
    /// Coarse levels (section 7.2), in `0..=`[`MOST_COARSE_LEVELS`]. Each doubles the widest penumbra that is gathered whole, 4
    /// texels without any; what is wider becomes narrower than it is.
    pub coarse_levels: u32,
    /// Whether a texel gathers every second sample of each direction only (section 7.3): a quarter of the work. Its noise is
    /// structured, and `smoothed` removes it.
    pub interleaved: bool,
    /// Whether levels are smoothed over 3 × 3 texels as they are resolved: the noise of interleaving and of the strata goes, and the sharpest
    /// edges become a texel wider.
    pub smoothed: bool,
    /// Whether tiles that no receiver looks at are left out (section 7.5). Visibility is the same, bit for bit.
    pub active_tiles: bool,
    /// Other seeds look from other places of the light: another noise.
    pub seed: u32,
    /// The least radius of a sample, texels, in `0.5..=8.0`: below 1.5 holes stay between samples that are in focus.
    pub least_radius: f32,
    /// The least standard deviation of depth, in `0.0..=1.0` of half the range of receivers' depths: the bias of shadow maps. Too
    /// little gives acne, too much loses contacts.
    pub least_deviation: f32,
    /// The widest direction that the map covers, as a tangent along the light's longer edge, in `0.01..=100.0`. Receivers beyond are taken as lit,
    /// and counted: one map cannot see the whole half space, and a wide one has few texels for each direction.
    pub reach: f32,
}

impl Default for StochasticOptions {
    fn default() -> Self {
        Self {
            size: 1024,
            planes: 4,
            placement: Placement::Receivers,
            basis: Basis::Exponential { exponent: 20.0 },
            footprint: Footprint::Rectangle,
            centers: Centers::Projected,
            widest_raise: 2.0,
            coarse_levels: 6,
            interleaved: true,
            smoothed: true,
            active_tiles: true,
            seed: 0,
            least_radius: 1.5,
            least_deviation: 0.005,
            reach: 2.0,
        }
    }
}

impl StochasticOptions {
    /// Whether they can be used.
    ///
    /// # Errors
    /// The first field that is outside its range, with its value.
    pub fn check(&self) -> Result<(), StochasticError> {
        let integers = [
            ("size", self.size, 1, MOST_SIZE),
            ("planes", self.planes, 1, MOST_PLANES),
            ("coarse_levels", self.coarse_levels, 0, MOST_COARSE_LEVELS),
        ];
        for (field, value, least, most) in integers {
            check(field, f64::from(value), f64::from(least), f64::from(most))?;
        }
        let floats = [
            ("least_radius", self.least_radius, 0.5, 8.0),
            ("widest_raise", self.widest_raise, 0.0, f64::from(UNLIMITED_RAISE)),
            ("least_deviation", self.least_deviation, 0.0, 1.0),
            ("reach", self.reach, 0.01, 100.0),
        ];
        for (field, value, least, most) in floats {
            check(field, f64::from(value), least, most)?;
        }
        if let Basis::Exponential { exponent } = self.basis {
            let (field, value, most) = ("exponent", f64::from(exponent), f64::from(MOST_EXPONENT));
            if value > most {
                return Err(StochasticError::Overflow { field, value, most });
            }
            check(field, value, f64::from(f32::MIN_POSITIVE), most)?;
        }
        Ok(())
    }

    /// The choices of the paper, where it names them: 1024² texels, an EVSM, two coarse levels, planes at even steps of depth, footprints
    /// around the middles of texels, radii raised without limit. Penumbrae come out up to twice as wide as they are.
    pub fn paper() -> Self {
        Self {
            placement: Placement::Depth,
            footprint: Footprint::Ellipse,
            centers: Centers::Texel,
            widest_raise: UNLIMITED_RAISE,
            coarse_levels: 2,
            ..Self::default()
        }
    }

    /// Levels of a plane, the finest included.
    pub fn levels(&self) -> u32 {
        self.coarse_levels + 1
    }
}

/// NaN is in no range.
fn check(field: &'static str, value: f64, least: f64, most: f64) -> Result<(), StochasticError> {
    if (least..=most).contains(&value) {
        Ok(())
    } else {
        Err(StochasticError::OutOfRange { field, value, least, most })
    }
}
