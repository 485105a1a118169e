//! Soft shadows from micro-occluders that are rebuilt from one shadow map and projected back onto the light.
//!
//! Seed: Schwarz, Stamminger, "Microquad Soft Shadow Mapping Revisited", 2008. Four neighbouring texel centres, where they lie nearer to
//! the light than the receiver, are the corners of a *microquad*; three of them those of a *microtri* (section 2). As
//! the receiver sees it, it covers the convex hull of its corners on the light (section 3), of which a mask is made, from a table of
//! half-spaces (3.2) or row by row (3.3), and OR-ed into the receiver's. Beside it what the paper compares with: micropatches, rectangles, and
//! areas that are added up.
//!
//! What it cannot do: it knows what the light's centre sees and nothing else. Occluders behind others cast no shadow, contact shadows
//! end a bias before the contact, and detail is that of the texels.
//!
//! | file | answers |
//! |---|---|
//! | [`options`] | which micro-occluders, which footprint, which map; what is refused |
//! | [`fit`] | where the map looks |
//! | [`params`] | what kernels are told |
//! | [`projection`] | where a texel lies on the light, as a receiver sees it |
//! | [`search`] | which texels a receiver has to look at |
//! | [`hull`] | the convex hull of a microquad |
//! | [`rows`], [`half_spaces`], [`rectangles`], [`area`] | what a footprint blocks, in four ways |
//! | [`gather`] | all of it, for one receiver |
//! | [`drawn`] | a map that was drawn, for whoever looks at it |

pub mod area;
#[cfg(not(target_arch = "spirv"))]
pub mod drawn;
#[cfg(not(target_arch = "spirv"))]
pub mod fit;
pub mod gather;
pub mod half_spaces;
pub mod hull;
pub mod options;
pub mod params;
pub mod projection;
pub mod rectangles;
pub mod rows;
pub mod search;

#[cfg(not(target_arch = "spirv"))]
pub use drawn::DrawnMap;
#[cfg(not(target_arch = "spirv"))]
pub use options::{Field, MicroquadError};
pub use options::{Footprint, HalfSpaces, MapOptions, MicroOccluders, MicroquadOptions};
