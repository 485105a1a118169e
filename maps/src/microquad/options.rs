//! What a user chooses, and what is refused.

#[cfg(not(target_arch = "spirv"))]
use core::fmt;

#[cfg(not(target_arch = "spirv"))]
use thiserror::Error;
#[cfg(not(target_arch = "spirv"))]
use umbra4_core::LatticeLight;

#[cfg(not(target_arch = "spirv"))]
use crate::shadow_map::SIZES;

/// What occluders are rebuilt as, from the texels of the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum MicroOccluders {
    /// A rectangle parallel to the light for each texel: the baseline. Leaks light where depths of neighbours differ.
    Micropatches,
    /// A quad between the centres of four texels that all occlude. Makes occluders smaller, by half a texel all around.
    Microquads,
    /// The same, and a triangle where three of the four do (section 2).
    #[default]
    Microtris,
}

/// How the footprint of a micro-occluder on the light is counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Footprint {
    /// Areas are added up: visibility without masks. What overlaps is counted twice, and light is never darkened evenly.
    Area,
    /// Corners are brought to the light's edges, and a rectangle is put in the quad's place: the approximation of 2007. Regular samples only, and no
    /// microtris, of which there is no such rectangle.
    Rectangles,
    /// The convex hull, from a table of half-spaces (section 3.2): samples may lie anywhere.
    Table(HalfSpaces),
    /// The convex hull, exactly, row by row (section 3.3). Regular samples only.
    #[default]
    Rows,
}

/// How fine the table of half-spaces is. It takes `directions · distances · rows` words of 32 bits, or of 64 for more than
/// 32 columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct HalfSpaces {
    /// Directions all around: a multiple of four in `4..=1024`.
    pub directions: u32,
    /// Distances from the light's centre, from one side to the other: in `2..=1024`.
    pub distances: u32,
}

impl Default for HalfSpaces {
    fn default() -> Self {
        Self { directions: 128, distances: 128 }
    }
}

/// The shadow map: how fine, where, and how far surfaces are kept from shadowing themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapOptions {
    /// Texels along each edge: a power of two in `16..=4096`. Time grows with its square, where penumbrae are wide.
    pub size: u32,
    /// The least distance from the light's plane at which occluders are drawn, in multiples of the light's longer edge: above 0, at most 1000.
    /// Nearer ones cast no shadow. The map widens as it shrinks.
    pub near: f32,
    /// How far the map reaches to each side, at most: tangent of the angle to the light's normal, above 0, at most 100. Receivers
    /// beyond see all of the light.
    pub widest: f32,
    /// Surfaces are drawn deeper by what their depth changes over so many texels: in `0.0..=16.0`.
    pub slope_bias: f32,
    /// An occluder is nearer than the receiver by at least this share of its distance: in `0.00001..=0.5`. Contact shadows end
    /// there.
    pub depth_bias: f32,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self { size: 512, near: 0.5, widest: 2.0, slope_bias: 1.0, depth_bias: 0.002 }
    }
}

/// How shadows are made from micro-occluders. The default is what the paper recommends: microtris, by exact rows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MicroquadOptions {
    /// The shadow map.
    pub map: MapOptions,
    /// What occluders are rebuilt as.
    pub occluders: MicroOccluders,
    /// How footprints are counted.
    pub footprint: Footprint,
}

/// A field that can be refused.
#[cfg(not(target_arch = "spirv"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    /// [`MapOptions::near`].
    Near,
    /// [`MapOptions::widest`].
    Widest,
    /// [`MapOptions::slope_bias`].
    SlopeBias,
    /// [`MapOptions::depth_bias`].
    DepthBias,
}

#[cfg(not(target_arch = "spirv"))]
impl fmt::Display for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Near => "map.near",
            Self::Widest => "map.widest",
            Self::SlopeBias => "map.slope_bias",
            Self::DepthBias => "map.depth_bias",
        })
    }
}

/// Why options are refused.
#[cfg(not(target_arch = "spirv"))]
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum MicroquadError {
    /// A map of a size that is none of those there are.
    #[error("map.size is {value}, not a power of two in {}..={}", SIZES.start(), SIZES.end())]
    MapSize {
        /// Texels asked for.
        value: u32,
    },
    /// A number that is not finite, or out of range.
    #[error("{field} is {value}, outside {least}..={most}")]
    OutOfRange {
        /// Which.
        field: Field,
        /// Its value.
        value: f32,
        /// The least that it may be.
        least: f32,
        /// The most.
        most: f32,
    },
    /// A table with none, or too many, or an uneven number of entries.
    #[error("footprint.directions is {value}, not a multiple of four in 4..=1024")]
    Directions {
        /// Directions asked for.
        value: u32,
    },
    /// A table with too few or too many entries.
    #[error("footprint.distances is {value}, outside 2..=1024")]
    Distances {
        /// Distances asked for.
        value: u32,
    },
    /// Microtris have no rectangle.
    #[error("footprint is Rectangles, of which microtris have none: take Table or Rows, or Microquads")]
    TrisAsRectangles,
    /// Rows and rectangles are those of regular samples.
    #[error("footprint is {footprint}, but the light's samples are jittered: take Table or Area")]
    JitteredSamples {
        /// "Rows" or "Rectangles".
        footprint: &'static str,
    },
    /// Masks were asked for.
    #[error("footprint is Area, of which there is no mask: ask for visibility")]
    NoMasks,
}

#[cfg(not(target_arch = "spirv"))]
impl MapOptions {
    /// Refuses what is out of range.
    ///
    /// # Errors
    /// The first field that is, with its value.
    pub fn check(&self) -> Result<(), MicroquadError> {
        if !(SIZES.contains(&self.size) && self.size.is_power_of_two()) {
            return Err(MicroquadError::MapSize { value: self.size });
        }
        let fields = [
            (Field::Near, self.near, 1e-3, 1000.0),
            (Field::Widest, self.widest, 1e-3, 100.0),
            (Field::SlopeBias, self.slope_bias, 0.0, 16.0),
            (Field::DepthBias, self.depth_bias, 1e-5, 0.5),
        ];
        for (field, value, least, most) in fields {
            if !(least..=most).contains(&value) {
                return Err(MicroquadError::OutOfRange { field, value, least, most });
            }
        }
        Ok(())
    }
}

#[cfg(not(target_arch = "spirv"))]
impl MicroquadOptions {
    /// Refuses what is out of range, and what does not go together with each other or with the light's samples.
    ///
    /// # Errors
    /// The first that is wrong.
    pub fn check(&self, light: &LatticeLight) -> Result<(), MicroquadError> {
        self.map.check()?;
        let regular = |footprint| match light.jitter.is_some() {
            true => Err(MicroquadError::JitteredSamples { footprint }),
            false => Ok(()),
        };
        match self.footprint {
            Footprint::Area => Ok(()),
            Footprint::Rectangles if self.occluders == MicroOccluders::Microtris => {
                Err(MicroquadError::TrisAsRectangles)
            }
            Footprint::Rectangles => regular("Rectangles"),
            Footprint::Rows => regular("Rows"),
            Footprint::Table(HalfSpaces { directions, distances }) => {
                if !(4..=1024).contains(&directions) || directions % 4 != 0 {
                    Err(MicroquadError::Directions { value: directions })
                } else if !(2..=1024).contains(&distances) {
                    Err(MicroquadError::Distances { value: distances })
                } else {
                    Ok(())
                }
            }
        }
    }
}
