//! Oracles, scene generators, the hard-case catalogue, the conformance suite.
