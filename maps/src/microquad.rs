//! Micro-occluders made of one shadow map.
