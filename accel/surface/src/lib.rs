//! Surfaces for ray tracing: triangle meshes, spheres, quads and discs over Embree or an embedded BVH.
