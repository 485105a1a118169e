//! The resolve stages of `umbra4-core`, compiled for each instruction set, mask word and precision: here and once. They take
//! longest to compile, and change only when core does; `umbra4-cpu`, which brings memory and threads, is another crate so that
//! changing it does not compile them again. What several stages do is a function of its own ([`umbra4_core::lanes::Lanes::apart`]).
//!
//! A part of `umbra4-cpu`: what of this is for users, it exports.

mod compiled;
mod isa;
mod kernels;
mod lanes;

pub use isa::{Detected, Isa};
pub use kernels::{CasterKernels, CloudKernels, Kernels, resolve_punctual};
