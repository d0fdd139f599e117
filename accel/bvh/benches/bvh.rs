use glam::Vec3;
#[derive(Clone, Copy)]
struct Instant(f64);
fn cpu() -> f64 {
    std::fs::read_dir("/proc/self/task")
        .unwrap()
        .map(|d| {
            std::fs::read_to_string(d.unwrap().path().join("schedstat"))
                .unwrap()
                .split(' ')
                .next()
                .unwrap()
                .parse::<f64>()
                .unwrap()
        })
        .sum::<f64>()
        * 1e-9
}
impl Instant {
    fn now() -> Self {
        Self(cpu())
    }
    fn elapsed(&self) -> std::time::Duration {
        std::time::Duration::from_secs_f64(cpu() - self.0)
    }
}

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
    let random: Vec<Ray> = (0..20000)
        .map(|_| {
            let a = p();
            let b = p();
            let d = (b - a).normalize();
            Ray::new(a - 2.0 * d, d)
        })
        .collect();
    let eye = Vec3::new(0.5, 0.45, -1.2);
    let camera: Vec<Ray> = (0..320 * 180 / 4)
        .map(|i| {
            let (x, y) = ((i % 160) as f32 / 160.0, (i / 160) as f32 / 90.0);
            let d = (Vec3::new(0.1 + 0.8 * x, 0.1 + 0.8 * y, 0.0) - eye).normalize();
            Ray::new(eye, d)
        })
        .collect();
    let bounds: Vec<Aabb> = centers
        .iter()
        .map(|c| Aabb {
            min: *c - rad,
            max: *c + rad,
        })
        .collect();
    if std::env::var("BUILD").is_ok() {
        let mut best = f64::MAX;
        for _ in 0..10 {
            let t = Instant::now();
            std::hint::black_box(Discs::build(&centers, &radii, Quality::Fast).unwrap());
            best = best.min(t.elapsed().as_secs_f64());
        }
        println!("build random order {best}");
        let d = Discs::build(&centers, &radii, Quality::Fast).unwrap();
        let centers: Vec<Vec3> = d.order().iter().map(|i| centers[*i as usize]).collect();
        let mut best = f64::MAX;
        for _ in 0..10 {
            let t = Instant::now();
            std::hint::black_box(Discs::build(&centers, &radii, Quality::Fast).unwrap());
            best = best.min(t.elapsed().as_secs_f64());
        }
        println!("build own order {best}");
        return;
    }
    for q in [Quality::Fast, Quality::High] {
        let t = Instant::now();
        let d = Discs::build(&centers, &radii, q).unwrap();
        println!(
            "{q:?} build {:?} bytes/disc {}",
            t.elapsed(),
            d.bytes() as f32 / n as f32
        );
        let (b, _) = Bvh::build(&bounds, q).unwrap();
        for rays in [&random, &camera] {
            let rays = &rays[..4000.min(rays.len())];
            let m = rays.len() as f64;
            let (mut alone, mut all) = (f64::MAX, f64::MAX);
            let (mut hits, mut blocks) = (0u64, 0usize);
            for _ in 0..std::env::var("REPS").map_or(25, |s| s.parse().unwrap()) {
                let t = Instant::now();
                blocks = 0;
                for ray in rays {
                    b.traverse(ray, |r| {
                        std::hint::black_box(&r);
                        blocks += r.len()
                    });
                }
                alone = alone.min(t.elapsed().as_secs_f64());
                hits = 0;
                let mut sum = 0.0f32;
                let t = Instant::now();
                for ray in rays {
                    d.along(ray, |slot, t, d2| {
                        hits += 1;
                        sum += (1.0 - d2 * 1600.0) * t;
                        let _ = slot;
                    });
                }
                all = all.min(t.elapsed().as_secs_f64());
                std::hint::black_box(sum);
            }
            println!(
                "  {:.1} blocks {:.1} hits; tree alone {:.2} us, along {:.2} us {:.2} ns/hit",
                blocks as f64 / m / 64.0,
                hits as f64 / m,
                alone * 1e6 / m,
                all * 1e6 / m,
                all * 1e9 / hits as f64
            );
        }
    }
}
