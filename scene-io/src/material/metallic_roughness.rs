//! The material of glTF 2.0 with `KHR_materials_ior` and `KHR_materials_transmission`.

/// Metal, plastic, paint, frosted and thin glass, and what is between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MetallicRoughness<S> {
    /// Reflectance of the metal at normal incidence, of the diffuse base, and tint of what is
    /// transmitted; 0 to 1.
    pub(crate) base_color: S,
    /// Share of metal, 0 to 1.
    pub(crate) metallic: f32,
    /// Root of the α of GGX, 0 to 1.
    pub(crate) roughness: f32,
    /// Index of refraction of what is not metal.
    pub(crate) ior: f32,
    /// Share of light that passes the coat and is transmitted, 0 to 1; the rest meets the diffuse
    /// base.
    pub(crate) transmission: f32,
    /// Whether the surface is a sheet that light passes without bending, rather than the boundary
    /// of a body.
    pub(crate) thin: bool,
}
