//! What holds umbra4 to its word: oracles, comparators, scene generators, the hard-case catalogue and the conformance
//! suite that every executor instantiates.
//!
//! | file | answers |
//! |---|---|
//! | [`oracle`] | the masks on the lattice, in `i128`, by brute force |
//! | [`bigint`] | the same rule in big integers: checks the oracle |
//! | [`second_oracle`] | the masks on the unsnapped world coordinates, exactly: checks the snap |
//! | [`caster_oracle`] | masks, optical depths and light of casters: cutouts, tints, closed meshes, planes that are moved |
//! | [`compare`] | are two results the same bits? |
//! | [`filtered`] | are two lists of filtered visibility the same, but for what floats decide? |
//! | [`scene`], [`scenes`], [`meshes`], [`grids`], [`slab`] | scenes in lattice integers or world floats, deterministic |
//! | [`caster_scenes`], [`caster_inputs`] | scenes of casters, and what an executor is given of them |
//! | [`caster_suite`] | what executors have to pass, of casters |
//! | [`hard_cases`] | the named cases, each with what must hold beyond equality with the oracle |
//! | [`hard_shadows`], [`weights`], [`clouds`] | lights without extent; emissions; clouds of samples |
//! | [`irradiance`] | what masks come to at Lambertian receivers, in f64 |
//! | [`facings`] | receivers that face some way |
//! | [`spheres`] | a scene and options for the approximate family |
//! | [`gpu`], [`device`] | the executor on a GPU, for the suite; an engine's buffers and textures |
//! | [`flicker`] | do neighbouring frames differ as exact ones do? |
//! | [`alone`] | one kernel alone, on a device and on the host |
//! | [`serial_maps`] | all kernels of stochastic soft shadow maps, on the host |
//! | [`suite`], [`ledger`] | one suite, instantiated per word width and executor, and its totals |
//! | [`budget`] | how much tests compare |

pub mod alone;
pub mod bigint;
pub mod budget;
pub mod caster_inputs;
pub mod caster_oracle;
pub mod caster_scenes;
pub mod caster_suite;
pub mod clouds;
pub mod compare;
pub mod device;
pub mod facings;
pub mod filtered;
pub mod flicker;
pub mod gpu;
pub mod grids;
pub mod hard_cases;
pub mod hard_shadows;
pub mod irradiance;
pub mod ledger;
pub mod meshes;
pub mod oracle;
pub mod rng;
pub mod scene;
pub mod scenes;
pub mod second_oracle;
pub mod serial_maps;
pub mod slab;
pub mod spheres;
pub mod suite;
pub mod weights;

/// The README's example compiles.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;
