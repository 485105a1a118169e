//! Shadow maps whose texels look from random places of the light.
