use glam::Vec3;
use std::time::Instant;
use tyndall_bvh::*;
use tyndall_core::*;
use tyndall_testkit::rng;
fn main() {
    let n: usize = std::env::var("N")
        .ok()
        .map_or(500_000, |s| s.parse().unwrap());
    let mut r = rng(1);
    let mut p = || Vec3::from_array(r.next());
    let centers: Vec<Vec3> = (0..n).map(|_| p()).collect();
    let rad = (30.0 / (n as f32 * 4.18879)).cbrt();
    let radii = vec![rad; n];
    let rays: Vec<Ray> = (0..20000)
        .map(|_| {
            let a = p();
            let b = p();
            let d = (b - a).normalize();
            Ray::new(a - 2.0 * d, d)
        })
        .collect();
    for q in [Quality::Fast, Quality::High] {
        let t = Instant::now();
        let d = Discs::build(&centers, &radii, q).unwrap();
        println!(
            "{q:?} build {:?} bytes/disc {}",
            t.elapsed(),
            d.bytes() as f32 / n as f32
        );
        for _ in 0..3 {
            let (mut hits, mut sum) = (0u64, 0.0f32);
            let t = Instant::now();
            for ray in &rays {
                d.along(ray, |slot, t, d2| {
                    hits += 1;
                    sum += 1.0 - d2 * 1600.0;
                    std::hint::black_box((slot, t));
                });
            }
            let e = t.elapsed().as_secs_f64();
            println!(
                "  along {:.2} us/ray {:.1} hits/ray {:.2} ns/hit {sum}",
                e * 1e6 / 2e4,
                hits as f64 / 2e4,
                e * 1e9 / hits as f64
            );
        }
    }
}
