//! Photons on surfaces, and the walk of sight that gathers them.

use super::{FALSE_ALARM, maps};
use glam::Vec3;
use std::marker::PhantomData;
use std::path::Path;
use tyndall_core::{HostTypes, MediumId, Ray, Rgb, Sampler, SensorRay, Spectrum};
use tyndall_density::{Dimension, Kernel, SurfacePoint};
use tyndall_photons::{Gather, Incident, Neighbours, PhotonMaps, Search, Sight, radiance};
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::rng;
use tyndall_testkit::stats::{Moments, check_means};
use tyndall_walk::{ByPhotons, BySampling, DirectLight, Event, Segment, Vertex, Walk};

const HEAD: &str = r#"
camera = { position = [0, 0, 1], look_at = [0, 0, 0], fov = 40 }
film = { width = 4, height = 4 }
"#;

fn scene(text: &str) -> Scene<Rgb> {
    let file = SceneFile::parse(&format!("{HEAD}{text}"), Path::new("surfaces"), &[]);
    let scene = file.and_then(|file| file.build());
    scene.unwrap_or_else(|why| panic!("{why}"))
}

/// Gathers photons of surfaces alone.
struct Surfaces<'a, D> {
    maps: &'a PhotonMaps<Rgb>,
    gather: Gather,
    final_gather: u32,
    direct: PhantomData<D>,
}

impl<D: DirectLight<Scene<Rgb>>> Sight<Scene<Rgb>> for Surfaces<'_, D> {
    type Direct = D;

    fn segment(
        &mut self,
        walk: &mut Walk<'_, Scene<Rgb>>,
        segment: Segment<Scene<Rgb>>,
        _: bool,
        sampler: &mut impl Sampler,
    ) -> (Rgb, Event<Scene<Rgb>>) {
        (Rgb::default(), walk.transmit(segment, sampler))
    }

    fn collision(&mut self, _: &<Scene<Rgb> as HostTypes>::Medium, _: &Vertex<Scene<Rgb>>) -> Rgb {
        unreachable!("segments transmit")
    }

    fn surface(&mut self, point: &SurfacePoint<'_, Scene<Rgb>>, light: Incident) -> Rgb {
        let photons = &self.maps.surfaces;
        self.gather.incident(photons, point, light).radiance
    }

    fn final_gather(&self) -> u32 {
        self.final_gather
    }
}

/// Radiance along parallel rays around one, the mean over them, over passes.
fn measured<D: DirectLight<Scene<Rgb>>>(
    host: &Scene<Rgb>,
    ray: Ray,
    (search, final_gather): (Search, u32),
    (passes, paths): (u64, u64),
) -> [Moments; 3] {
    let mut found = [Moments::new(); 3];
    for pass in 0..passes {
        let maps = maps::<_, D>(host, pass, paths);
        let mut surfaces = Surfaces {
            maps: &maps,
            gather: Gather::new(search, Kernel::Epanechnikov),
            final_gather,
            direct: PhantomData::<D>,
        };
        let mut sampler = rng(pass);
        let seen = (0..RAYS).map(|i| {
            let along = 0.8 * (i as f32 / (RAYS - 1) as f32 - 0.5);
            let ray = Ray::new(ray.origin + along * Vec3::Z, ray.direction);
            let start = SensorRay::new(ray, MediumId::VACUUM);
            radiance(host, &start, &mut surfaces, &mut sampler)
        });
        let seen = seen.sum::<Rgb>() / RAYS as f32;
        for (i, moments) in found.iter_mut().enumerate() {
            moments.push(f64::from(seen.channel(i)));
        }
    }
    found
}

fn check(name: &str, found: [Moments; 3], expected: Rgb) {
    let cases: Vec<_> = (0..3)
        .map(|i| (name, found[i].estimate(), f64::from(expected.channel(i))))
        .collect();
    check_means(&cases, FALSE_ALARM / 12.0).unwrap_or_else(|why| panic!("{why}"));
}

/// Rays whose mean is taken.
const RAYS: u32 = 32;

const SEARCHES: [Search; 2] = [
    Search::Within(0.3),
    Search::Nearest(Neighbours {
        photons: 60.0,
        dimension: Dimension::Two,
        max_radius: 0.5,
    }),
];

#[test]
fn sunlight_on_a_floor() {
    // ρE cos θ/π for any radius that ends on the floor; beside it stands a wall, lit as well, and
    // within the radius of the point, but not on its plane.
    let host = scene(
        r#"
        materials.floor = { kind = "diffuse", reflectance = [0.5, 0.2, 0.9] }
        materials.black = { kind = "diffuse", reflectance = 0 }
        lights = [{ kind = "directional", direction = [-0.6, -0.8, 0], irradiance = [2, 3, 1] }]
        shapes = [
            { kind = "quad", corner = [-2, 0, 2], edge_u = [4, 0, 0], edge_v = [0, 0, -4], material = "floor" },
            { kind = "quad", corner = [-0.25, 0.05, 2], edge_u = [0, 0, -4], edge_v = [0, 0.5, 0], material = "black" },
        ]
    "#,
    );
    let ray = Ray::new(Vec3::new(0.1, 0.5, 0.0), Vec3::NEG_Y);
    let expected = Rgb::new(0.5 * 2.0, 0.2 * 3.0, 0.9) * (0.8 / std::f32::consts::PI);
    for search in SEARCHES {
        let found = measured::<ByPhotons>(&host, ray, (search, 0), (24, 8_000));
        check("by photons", found, expected);
        let found = measured::<BySampling>(&host, ray, (search, 0), (24, 8_000));
        check("by sampling", found, expected);
    }
}

/// A box of side 4 whose walls reflect ρ and emit 1 − ρ, with what is in it.
fn furnace(inside: &str) -> Scene<Rgb> {
    scene(&format!(
        r#"
        materials.wall = {{ kind = "diffuse", reflectance = [0.5, 0.2, 0.8], emission = [0.5, 0.8, 0.2] }}
        materials.mirror = {{ kind = "mirror" }}
        materials.glossy = {{ kind = "metallic_roughness", base_color = 1, metallic = 1, roughness = 0.28 }}
        materials.coated = {{ kind = "metallic_roughness", base_color = 1, metallic = 0, roughness = 0 }}
        shapes = [
            {{ kind = "quad", corner = [-2, -2, 2], edge_u = [4, 0, 0], edge_v = [0, 0, -4], material = "wall" }},
            {{ kind = "quad", corner = [-2, 2, -2], edge_u = [4, 0, 0], edge_v = [0, 0, 4], material = "wall" }},
            {{ kind = "quad", corner = [-2, -2, -2], edge_u = [4, 0, 0], edge_v = [0, 4, 0], material = "wall" }},
            {{ kind = "quad", corner = [2, -2, 2], edge_u = [-4, 0, 0], edge_v = [0, 4, 0], material = "wall" }},
            {{ kind = "quad", corner = [-2, -2, 2], edge_u = [0, 0, -4], edge_v = [0, 4, 0], material = "wall" }},
            {{ kind = "quad", corner = [2, -2, -2], edge_u = [0, 0, 4], edge_v = [0, 4, 0], material = "wall" }},
            {inside}
        ]
    "#
    ))
}

#[test]
fn walls_that_glow() {
    let host = furnace("");
    let ray = Ray::new(Vec3::new(0.1, 0.2, 0.0), Vec3::NEG_Y);
    for search in SEARCHES {
        for final_gather in [0, 3] {
            let found = measured::<ByPhotons>(&host, ray, (search, final_gather), (24, 8_000));
            check("by photons", found, Rgb::splat(1.0));
        }
        // Walks that end in corners would see a wall that glows at no distance: samples of it
        // have no finite variance.
        let found = measured::<BySampling>(&host, ray, (search, 0), (24, 8_000));
        check("by sampling", found, Rgb::splat(1.0));
    }
}

#[test]
fn an_integrating_sphere() {
    // Irradiance P/(4πR²)/(1 − ρ) everywhere: a disc cuts a cap of area πr² out of a sphere, so
    // that no radius blurs it. The lamp is as far from all that walks meet.
    let host = scene(
        r#"
        materials.matt = { kind = "diffuse", reflectance = [0.5, 0.2, 0.8] }
        lights = [{ kind = "point", position = [0, 0, 0], power = 10 }]
        shapes = [{ kind = "sphere", center = [0, 0, 0], radius = 1.5, material = "matt" }]
    "#,
    );
    let ray = Ray::new(Vec3::new(0.1, 0.2, 0.0), Vec3::NEG_Y);
    let expected = [0.5, 0.2, 0.8].map(|rho| {
        let direct = 10.0 / (4.0 * std::f32::consts::PI * 1.5 * 1.5);
        rho / std::f32::consts::PI * direct / (1.0 - rho)
    });
    for search in SEARCHES {
        for final_gather in [0, 3] {
            let effort = (16, 6_000);
            let found = measured::<BySampling>(&host, ray, (search, final_gather), effort);
            check("by sampling", found, Rgb(Vec3::from(expected)));
            let found = measured::<ByPhotons>(&host, ray, (search, final_gather), effort);
            check("by photons", found, Rgb(Vec3::from(expected)));
        }
    }
}

#[test]
fn mirrors_and_coats() {
    for material in ["mirror", "coated"] {
        white_in_the_furnace(material, SEARCHES[0], (70, 8_000));
    }
}

#[test]
fn what_is_nearly_specular() {
    // A sharp lobe makes much of few photons: a disc almost to the edge holds the more of them.
    white_in_the_furnace("glossy", Search::Within(0.75), (48, 20_000));
}

/// White things in the furnace are white: a mirror, a metal whose lobe is sharp at its middle and
/// not beside it, and a diffuse base under a mirror-like coat. The materials promise 1 %. (Sampling
/// lights that meet surfaces at corners has no finite variance, and is not tried here.)
fn white_in_the_furnace(material: &str, search: Search, effort: (u64, u64)) {
    let host = furnace(&format!(
        r#"{{ kind = "quad", corner = [-1.2, 0, 1.2], edge_u = [2.4, 0, 0], edge_v = [0, 0, -2.4], material = "{material}" }},"#
    ));
    let ray = Ray::new(
        Vec3::new(0.0, 1.0, 0.5),
        Vec3::new(0.0, -1.0, -0.5).normalize(),
    );
    for final_gather in [0, 2] {
        for moments in measured::<ByPhotons>(&host, ray, (search, final_gather), effort) {
            let found = moments.estimate();
            let off = (found.mean - 1.0).abs();
            // One in 15,000 is beyond four standard errors.
            assert!(
                off < 0.01 + 4.0 * found.standard_error,
                "{material}: {found:?}"
            );
            assert!(found.standard_error < 0.025, "{material}: {found:?}");
        }
    }
}
