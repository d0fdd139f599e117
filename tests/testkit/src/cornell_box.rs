//! The scene of benches, and of what is measured of the heap.

/// The text of a scene file: a Cornell box of side 2, filled with the medium `fog` (the value of
/// its key, as `{ kind = "homogeneous", sigma_a = 0.02, sigma_s = 0.25 }`), with a ball of glass in it
/// and a picture of 320 × 180.
pub fn cornell_box(fog: &str) -> String {
    format!(
        r#"
camera = {{ position = [0, 1, 3.6], look_at = [0, 1, 0], fov = 38, medium = "fog" }}
film = {{ width = 320, height = 180 }}
media.fog = {fog}
materials.white = {{ kind = "diffuse", reflectance = 0.73 }}
materials.red = {{ kind = "diffuse", reflectance = [0.63, 0.065, 0.05] }}
materials.green = {{ kind = "diffuse", reflectance = [0.14, 0.45, 0.091] }}
materials.glass = {{ kind = "dielectric", ior = 1.5, inside = "vacuum" }}
shapes = [
    {{ kind = "quad", corner = [-1, 0, 1], edge_u = [2, 0, 0], edge_v = [0, 0, -2], material = "white" }},
    {{ kind = "quad", corner = [-1, 2, -1], edge_u = [2, 0, 0], edge_v = [0, 0, 2], material = "white" }},
    {{ kind = "quad", corner = [-1, 0, -1], edge_u = [2, 0, 0], edge_v = [0, 2, 0], material = "white" }},
    {{ kind = "quad", corner = [-1, 0, 1], edge_u = [0, 0, -2], edge_v = [0, 2, 0], material = "red" }},
    {{ kind = "quad", corner = [1, 0, -1], edge_u = [0, 0, 2], edge_v = [0, 2, 0], material = "green" }},
    {{ kind = "quad", corner = [-0.25, 1.99, -0.25], edge_u = [0.5, 0, 0], edge_v = [0, 0, 0.5], material = "white", emission = [17, 12, 6] }},
    {{ kind = "sphere", center = [0, 0.8, 0], radius = 0.4, material = "glass" }},
]
"#
    )
}
