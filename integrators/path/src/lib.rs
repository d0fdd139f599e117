//! Volumetric path tracing: the unbiased reference.
