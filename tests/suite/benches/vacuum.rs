//! What a host that could hold media pays in a scene without any: instructions of `path` in the
//! command's own host, over those in the same host whose medium cannot exist.
//!
//!     cargo bench -p tyndall-suite --bench vacuum
//!
//! Needs Valgrind. Fails above 1.02.

use std::path::Path as FilePath;
use std::process::Command;
use tyndall_core::*;
use tyndall_driver::{Budget, Render};
use tyndall_path::Path;
use tyndall_scene_io::{Hit, Scene, SceneFile};

const SCENE: &str = r#"
camera = { position = [0, 1, 3.6], look_at = [0, 1, 0], fov = 38 }
film = { width = 24, height = 24 }
materials.white = { kind = "diffuse", reflectance = [0.7, 0.6, 0.5] }
materials.glass = { kind = "dielectric", ior = 1.5 }
shapes = [
    { kind = "box", min = [-2, 0, -2], max = [2, 2.5, 4], material = "white" },
    { kind = "box", min = [-0.7, 0, -0.7], max = [-0.1, 1.2, -0.1], material = "white" },
    { kind = "sphere", center = [0.5, 0.4, 0.2], radius = 0.4, material = "glass" },
    { kind = "quad", corner = [-0.3, 2.4, -0.3], edge_u = [0.6, 0, 0], edge_v = [0, 0, 0.6], material = "white", emission = 9 },
]
"#;

/// Share of instructions that may be lost.
const ALLOWED: f64 = 1.02;

/// The command's host, in a world where the compiler knows that there are no media.
struct Airless(Scene<Rgb>);

impl HostTypes for Airless {
    type Spectrum = Rgb;
    type Hit = Hit;
    type Medium = Vacuum<Rgb>;
}

impl Media for Airless {
    fn medium(&self, _: MediumId) -> Option<&Vacuum<Rgb>> {
        None
    }
    fn medium_across(&self, hit: &Hit, direction: glam::Vec3, here: MediumId) -> MediumId {
        self.0.medium_across(hit, direction, here) // indices of refraction are the host's affair
    }
    fn has_null_surfaces(&self) -> bool {
        self.0.has_null_surfaces()
    }
}

/// The rest is the same.
macro_rules! delegate {
    ($($capability:ident { $(fn $name:ident($($argument:ident: $kind:ty),*) -> $result:ty;)* })*) => {
        $(impl $capability for Airless {
            $(fn $name(&self, $($argument: $kind),*) -> $result {
                self.0.$name($($argument),*)
            })*
        })*
    };
}

delegate! {
    Geometry {
        fn bounds() -> Aabb;
        fn intersect(ray: &Ray, here: MediumId) -> Option<(f32, Hit)>;
        fn surface(hit: &Hit) -> Surface;
        fn spawn(from: &Anchor<Hit>, direction: glam::Vec3) -> Ray;
        fn connect(from: &Anchor<Hit>, to: &Anchor<Hit>) -> Ray;
        fn occluded(ray: &Ray) -> bool;
    }
    Shading {
        fn surface_kind(hit: &Hit) -> SurfaceKind;
        fn bsdf_eval(hit: &Hit, wo: glam::Vec3, wi: glam::Vec3, from: PathFrom) -> Rgb;
        fn bsdf_sample(hit: &Hit, wo: glam::Vec3, u: [f32; 3], from: PathFrom) -> Option<BsdfSample<Rgb>>;
        fn emitted(hit: &Hit, wo: glam::Vec3) -> Rgb;
        fn background(direction: glam::Vec3) -> Rgb;
    }
    ShadingPdf {
        fn bsdf_pdf_w(hit: &Hit, wo: glam::Vec3, wi: glam::Vec3, from: PathFrom) -> f32;
    }
    LightDirect {
        fn sample_direct(from: glam::Vec3, u: [f32; 4]) -> Option<DirectSample<Rgb, Hit>>;
        fn pivot(ray: &Ray, u: [f32; 4]) -> Option<glam::Vec3>;
    }
    LightPdf {
        fn pdf_direct_w(from: glam::Vec3, to: &Anchor<Hit>) -> f32;
        fn pdf_emission(at: &Anchor<Hit>, direction: glam::Vec3) -> EmissionPdf;
    }
    Sensor {
        fn resolution() -> [u32; 2];
        fn sensor_ray(px: [u32; 2], u: [f32; 4]) -> SensorRay<Rgb>;
    }
}

fn main() {
    let arguments: Vec<_> = std::env::args().collect();
    match &arguments[1..] {
        [host, passes] if passes.parse::<u64>().is_ok() => {
            render(host, passes.parse().expect("just parsed"));
        }
        _ => compare(),
    }
}

fn render(host: &str, passes: u64) {
    let file = SceneFile::parse(SCENE, FilePath::new("vacuum"), &[]).expect("the scene is valid");
    let scene = file.build::<Rgb>().expect("the scene is valid");
    let (path, budget) = (Path::new(), Budget::Passes(passes));
    let threads = rayon::ThreadPoolBuilder::new().num_threads(1);
    let pool = threads.build().expect("one thread can be started");
    let film = pool.install(|| match host {
        "airless" => Render::new(&Airless(scene), &path).run(budget, |_| {}),
        _ => Render::new(&scene, &path).run(budget, |_| {}),
    });
    std::hint::black_box(film.expect("nothing stops it"));
}

#[expect(clippy::print_stdout, reason = "a bench prints its figures")]
fn compare() {
    // What loading costs drops out of the difference of two renders.
    let counts = ["full", "airless"].map(|host| instructions(host, 5) - instructions(host, 1));
    let ratio = counts[0] as f64 / counts[1] as f64;
    println!(
        "instructions of 4 passes: {} with media possible, {} without; ratio {ratio:.4}",
        counts[0], counts[1]
    );
    assert!(ratio <= ALLOWED, "vacuum costs more than {ALLOWED}");
}

fn instructions(host: &str, passes: u64) -> u64 {
    let itself = std::env::current_exe().expect("a running program has a path");
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(itself)
        .args([host, &passes.to_string()])
        .output()
        .expect("Valgrind must be installed");
    let text = String::from_utf8_lossy(&output.stderr);
    let count = text.split("Collected : ").nth(1);
    let count = count.and_then(|rest| rest.split_whitespace().next()?.parse().ok());
    count.unwrap_or_else(|| panic!("Valgrind failed: {text}"))
}
