//! Light in closed form.

use crate::{FALSE_ALARM, fixed, fog};
use glam::Vec3;
use std::f64::consts::PI;
use tyndall_core::{Medium, PhaseFunction, Ray, Rgb, Sampler, Spectrum, warp};
use tyndall_media::Homogeneous;
use tyndall_photon_beams::{Estimate, Extent, Kernel, PhotonBeams};
use tyndall_testkit::closed_form::{LaserRow, airlight, laser_row_sum, point_source_fluence};
use tyndall_testkit::hosts::{AnalyticHost, Interface, Laser, Light, View};
use tyndall_testkit::stats::{Figures, extrapolated};
use tyndall_testkit::{Run, Tier, in_both_tiers, rng};

/// What scatters so rarely that twice is never: single scattering is in closed form.
const RARELY: f32 = 1e-4;

in_both_tiers! {
    rows_of_a_laser_at_any_angle,
    rows_of_a_laser_for_any_radius,
    rows_of_short_beams,
    rows_of_channels_far_apart,
    rows_far_from_the_origin,
    airlight_of_a_point_light_and_its_bias,
    fluence_of_a_point_light,
    the_furnace_is_white_away_from_the_boundary,
}

/// A laser's row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    /// Of the angle between beam and ray.
    cos_theta: f64,
    laser_radius: f32,
    distance: f32,
    along: f32,
    /// Where the laser starts.
    origin: Vec3,
    sigma_t: Rgb,
    /// Mean cosine of what scatters.
    g: f32,
}

const FLUX: f32 = 3.0;
const SIGMA_T: Rgb = Rgb::new(0.1, 0.3, 0.6);

impl Row {
    pub(crate) fn at_degrees(degrees: f64) -> Self {
        Self {
            cos_theta: degrees.to_radians().cos(),
            laser_radius: 0.05,
            distance: 2.5,
            along: 2.0,
            origin: Vec3::ZERO,
            sigma_t: SIGMA_T,
            g: 0.5,
        }
    }

    /// Of a row that is wide enough for blur of this radius.
    fn half_width(&self, radius: f32) -> f32 {
        1.1 * (self.laser_radius + radius)
    }

    fn host(&self, radius: f32) -> AnalyticHost<Homogeneous<Rgb>> {
        let medium = fog(self.sigma_t * (1.0 - RARELY), self.sigma_t * RARELY, self.g);
        let laser = Laser {
            flux: FLUX,
            radius: self.laser_radius,
            cos_theta: self.cos_theta as f32,
            distance: self.distance,
            along: self.along,
            half_width: self.half_width(radius),
            pixels: 40,
        };
        let mut host = AnalyticHost::laser(medium, laser);
        if let Light::Beam { center, .. } = &mut host.light {
            *center += self.origin;
        }
        if let View::Row { first, .. } = &mut host.view {
            first.origin += self.origin;
        }
        host
    }

    /// The row as it is where places are `f32`: of e = (x, y, z), by how much they move the rays of
    /// `host` against its laser, x is along the laser, and z shortens the rays.
    fn rounded(&self, host: &AnalyticHost<Homogeneous<Rgb>>) -> Self {
        let near = Self {
            origin: Vec3::ZERO,
            ..*self
        };
        let between = |host: &AnalyticHost<_>| match (&host.light, &host.view) {
            (Light::Beam { center, .. }, View::Row { first, .. }) => {
                first.origin.as_dvec3() - center.as_dvec3()
            }
            _ => panic!("a laser and its row"),
        };
        let e = between(host) - between(&near.host(0.0));
        let shorter = e.z / (1.0 - self.cos_theta * self.cos_theta).sqrt();
        Self {
            distance: (f64::from(self.distance) - shorter) as f32,
            along: (f64::from(self.along) + e.x - shorter * self.cos_theta) as f32,
            ..*self
        }
    }

    /// The sum of the row in a channel, as blurred by an estimator with a constant kernel.
    ///
    /// Light is attenuated as e^−σ(t + v): blur that displaces (t, v) along the plane of ray and beam
    /// averages that over the kernel, blur across both does not. Displacements e of what is
    /// gathered from where the ray is, z of them in the plane and across the one that is not
    /// blurred along:
    /// - 1D: none.
    /// - 2D: t + v changes by z (1 + cos θ)/sin θ, z in a disc, whichever of ray and beam is the
    ///   cylinder: the exponent is symmetrical in them.
    /// - 3D: t = e_z/sin θ, v = e_z cot θ − e_x, with e in a ball.
    fn sum(&self, channel: usize, estimate: Estimate, radius: f32) -> f64 {
        let sigma_t = f64::from(self.sigma_t.channel(channel));
        let cos_theta = self.cos_theta;
        let sin_theta = (1.0 - cos_theta * cos_theta).sqrt();
        let ahead = Vec3::new(cos_theta as f32, 0.0, sin_theta as f32);
        let medium = fog(Rgb::default(), Rgb::splat(1.0), self.g);
        let phase = medium.phase(Vec3::ZERO).eval(-ahead, Vec3::NEG_X);
        let row = |radius: f32| {
            laser_row_sum(&LaserRow {
                sigma_s: sigma_t * f64::from(RARELY),
                sigma_t,
                phase: f64::from(phase),
                flux: f64::from(FLUX),
                radius: f64::from(radius),
                cos_theta,
                distance: f64::from(self.distance),
                along: f64::from(self.along),
            })
        };
        let disc = row(radius) / row(0.0);
        let blurred = match estimate {
            Estimate::BeamBeam1D => {
                // By a share that goes to 2D at small angles.
                let x = ((0.1 - sin_theta) / (0.1 - 0.03)).clamp(0.0, 1.0);
                let share = x * x * (3.0 - 2.0 * x);
                1.0 - share + share * disc
            }
            Estimate::PointBeam2D
            | Estimate::BeamPoint2D
            | Estimate::BeamBeam2DRay
            | Estimate::BeamBeam2DBeam => disc,
            Estimate::PointPoint3D
            | Estimate::PointBeam3D
            | Estimate::BeamPoint3D
            | Estimate::BeamBeam3D => {
                over_ball(sigma_t * f64::from(radius) * ((1.0 + cos_theta) / sin_theta).hypot(1.0))
            }
        };
        row(self.laser_radius) * blurred
    }

    /// Takes the sums of all channels.
    pub(crate) fn measure(
        &self,
        figures: &mut Figures,
        (method, estimate, radius): (&PhotonBeams, Estimate, f32),
        run: Run,
        precision: f64,
    ) {
        let length = f64::from(2.0 * self.half_width(radius));
        let host = self.host(radius);
        let (found, row) = (run.measure(&host, method), self.rounded(&host));
        for (c, mean) in found.into_iter().enumerate() {
            let name = format!("{estimate} of radius {radius}, channel {c}, {self:?}");
            let expected = row.sum(c, estimate, radius);
            figures.add(name, mean.scaled(length), expected, precision);
        }
    }
}

/// The mean of e^(x·g) over a ball of radius 1, of |g| = `g`: 3 (g cosh g − sinh g)/g³.
fn over_ball(g: f64) -> f64 {
    if g < 1e-3 {
        return 1.0 + g * g / 10.0;
    }
    3.0 * (g * g.cosh() - g.sinh()) / g.powi(3)
}

/// Beams are met by every ray that passes them, by few points, and photons by few rays.
fn effort(estimate: Estimate, tier: Tier, seed: u64) -> (u64, Run, f64) {
    let (paths, passes, samples, precision) = match (estimate, estimate.takes_beams()) {
        (Estimate::BeamPoint2D | Estimate::BeamPoint3D, _) => (100, [40, 800], 8, 0.05),
        (_, true) => (100, [16, 400], 1, 0.03),
        (Estimate::PointPoint3D, _) => (2_000, [60, 1_000], 4, 0.12),
        (_, false) => (2_000, [40, 600], 1, 0.08),
    };
    let run = Run {
        passes: tier.passes(passes),
        samples,
        seed,
    };
    (paths, run, long(tier, precision))
}

/// Whether whole rays meet whole beams: a test of those is quick.
fn by_beams(estimate: Estimate) -> bool {
    let marched = matches!(estimate, Estimate::BeamPoint2D | Estimate::BeamPoint3D);
    estimate.takes_beams() && !marched
}

/// The precision asked for: a third in the long tier.
pub(crate) fn long(tier: Tier, precision: f64) -> f64 {
    match tier {
        Tier::Short => precision,
        Tier::Long => precision / 3.0,
    }
}

fn rows_of_a_laser_at_any_angle(tier: Tier) {
    let mut figures = Figures::default();
    let almost = 1e-6_f64.to_degrees();
    let angles = [5.0, 30.0, 90.0 - almost, 90.0, 90.0 + almost, 140.0, 175.0];
    for (seed, degrees) in (1..).zip(angles) {
        let mut row = Row::at_degrees(degrees);
        if degrees == 90.0 {
            row.cos_theta = 0.0;
        }
        for estimate in Estimate::ALL {
            if tier == Tier::Short && !by_beams(estimate) && degrees != 30.0 {
                continue;
            }
            let (paths, run, precision) = effort(estimate, tier, seed);
            let method = fixed(estimate, 0.05).kernel(Kernel::Constant).paths(paths);
            row.measure(&mut figures, (&method, estimate, 0.05), run, precision);
        }
    }
    figures.check(FALSE_ALARM);
}

/// In 1D no radius and no kernel leaves a bias: the attenuation is that of where the lines pass.
fn rows_of_a_laser_for_any_radius(tier: Tier) {
    let mut figures = Figures::default();
    let row = Row::at_degrees(60.0);
    for (seed, radius) in (1..).zip([1e-3, 0.02, 0.1, 0.6]) {
        for kernel in [Kernel::Epanechnikov, Kernel::Gaussian] {
            let (_, run, precision) = effort(Estimate::BeamBeam1D, tier, seed);
            let method = fixed(Estimate::BeamBeam1D, radius).kernel(kernel);
            let method = method.paths(if radius < 0.01 { 1_000 } else { 100 });
            let what = (&method, Estimate::BeamBeam1D, radius);
            row.measure(&mut figures, what, run, precision);
        }
        if radius < 0.1 {
            continue; // photons are hardly met
        }
        for estimate in Estimate::ALL {
            if tier == Tier::Short && radius < 0.5 {
                continue;
            }
            let (paths, run, precision) = effort(estimate, tier, seed);
            let method = fixed(estimate, radius).kernel(Kernel::Constant);
            let method = method.paths(paths);
            row.measure(&mut figures, (&method, estimate, radius), run, precision);
        }
    }
    figures.check(FALSE_ALARM);
}

fn rows_of_short_beams(tier: Tier) {
    let mut figures = Figures::default();
    for (seed, degrees) in [(1, 40.0), (2, 125.0)] {
        let row = Row::at_degrees(degrees);
        for estimate in Estimate::ALL {
            if !by_beams(estimate) && (tier == Tier::Short || !estimate.takes_beams()) {
                continue;
            }
            for (light, sight) in [
                (Extent::Short, Extent::Long),
                (Extent::Long, Extent::Short),
                (Extent::Short, Extent::Short),
            ] {
                let (_, run, _) = effort(estimate, tier, seed);
                let method = fixed(estimate, 0.1).kernel(Kernel::Constant).paths(300);
                let method = method.light_beams(light).sight_beams(sight);
                let what = (&method, estimate, 0.1);
                row.measure(&mut figures, what, run, long(tier, 0.1));
            }
        }
    }
    figures.check(FALSE_ALARM);
}

/// What is clear in one channel is opaque in another; nearly all is scattered back.
fn rows_of_channels_far_apart(tier: Tier) {
    let mut figures = Figures::default();
    let row = Row {
        sigma_t: Rgb::new(0.015, 0.15, 1.5),
        distance: 1.0,
        along: 0.8,
        g: -0.95,
        ..Row::at_degrees(70.0)
    };
    for estimate in Estimate::ALL {
        if !by_beams(estimate) {
            continue;
        }
        for (light, sight) in [
            (Extent::Long, Extent::Long),
            (Extent::Short, Extent::Long),
            (Extent::Long, Extent::Short),
        ] {
            let (_, run, _) = effort(estimate, tier, 1);
            let run = Run { samples: 8, ..run };
            let method = fixed(estimate, 0.1).kernel(Kernel::Constant).paths(1_000);
            let method = method.light_beams(light).sight_beams(sight);
            row.measure(
                &mut figures,
                (&method, estimate, 0.1),
                run,
                long(tier, 0.15),
            );
        }
    }
    figures.check(FALSE_ALARM);
}

fn rows_far_from_the_origin(tier: Tier) {
    let mut figures = Figures::default();
    for (seed, degrees) in [(1, 20.0), (2, 90.0), (3, 160.0)] {
        let row = Row {
            origin: Vec3::new(1e4, -9_876.5, 5_432.1),
            ..Row::at_degrees(degrees)
        };
        for estimate in Estimate::ALL {
            if tier == Tier::Short && !by_beams(estimate) {
                continue;
            }
            let (paths, run, precision) = effort(estimate, tier, seed);
            let method = fixed(estimate, 0.1).kernel(Kernel::Constant).paths(paths);
            row.measure(&mut figures, (&method, estimate, 0.1), run, precision);
        }
    }
    figures.check(FALSE_ALARM);
}

/// Beams of all directions from a point, and all orders of the bias in the radius.
fn airlight_of_a_point_light_and_its_bias(tier: Tier) {
    let sigma_t = 0.6_f32;
    let medium = fog(sigma_t * (1.0 - RARELY), sigma_t * RARELY, 0.0);
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    let light = Vec3::new(0.5, 1.0, 0.0);
    let host = AnalyticHost::infinite_medium(medium, light, 1.0, View::Rays(vec![ray]));
    let sigma_s = f64::from(sigma_t * RARELY);
    let expected = airlight(sigma_s, f64::from(sigma_t), 1.0, 0.5, f64::INFINITY);
    let mut figures = Figures::default();
    for estimate in Estimate::ALL {
        if tier == Tier::Short && !by_beams(estimate) {
            continue; // rows of lasers tell
        }
        let (paths, passes, precision) = match estimate.takes_beams() {
            true => (1_000, [24, 1_000], 0.06),
            false => (3_000, [150, 2_000], 0.09),
        };
        let mean = |radius: f32, seed| {
            let run = Run {
                passes: tier.passes(passes),
                samples: 1,
                seed,
            };
            run.measure(&host, &fixed(estimate, radius).paths(paths))[0]
        };
        // The bias is ∝ r²: without it light is right.
        let without = extrapolated(mean(0.2, 1), mean(0.4, 2), 2);
        let name = estimate.to_string();
        figures.add(name, without, expected, long(tier, precision));
    }
    figures.check(FALSE_ALARM);
}

/// Many times scattered light, from all directions.
fn fluence_of_a_point_light(tier: Tier) {
    let (sigma_t, distance) = (2.0_f32, 0.5_f32);
    let mut figures = Figures::default();
    for (albedo, estimate) in [(0.5, Estimate::BeamBeam1D), (0.9, Estimate::BeamBeam2DRay)] {
        let medium = fog((1.0 - albedo) * sigma_t, albedo * sigma_t, 0.0);
        let light = Vec3::new(3.0, -2.0, 1.0);
        let position = light + distance * Vec3::Z;
        let host = AnalyticHost::infinite_medium(medium, light, 1.0, View::Fluence { position });
        let run = Run {
            passes: tier.passes([80, 1_500]),
            samples: 40,
            seed: 1,
        };
        let mean = run.measure(&host, &fixed(estimate, 0.02).paths(1_000))[0];
        let depth = f64::from(sigma_t * distance);
        let uncollided = (-depth).exp() / (4.0 * PI * f64::from(distance * distance));
        let all = point_source_fluence(f64::from(albedo), f64::from(sigma_t), f64::from(distance));
        let name = format!("{estimate} {albedo}");
        figures.add(name, mean, all - uncollided, long(tier, 0.06));
    }
    figures.check(FALSE_ALARM);
}

/// From around the middle of a ball in all directions: rays leave it almost straight.
pub(crate) fn outwards() -> View {
    let mut sampler = rng(1);
    let mut ray = || {
        let middle = 0.1 * warp::uniform_sphere(sampler.next());
        Ray::new(middle, warp::uniform_sphere(sampler.next()))
    };
    View::Rays((0..64).map(|_| ray()).collect())
}

/// Blur reaches out of the ball by e·N, and what is outside is lost: that of E[(e·N)⁺] of the ray,
/// where it leaves. Across the ray e·N = 0; else directions are uniform and it is E|e|/4, with
/// E|e| = 2r/3 over a disc and 3r/4 over a ball for the constant kernel. Blur along a ball's beam
/// and ray shifts what is gathered, not what there is: only a chord that leaves is cut.
fn the_furnace_is_white_away_from_the_boundary(tier: Tier) {
    let mut figures = Figures::default();
    for (interface, white) in [
        (Interface::Matched, 1.0),
        (Interface::Dielectric(1.5), 2.25),
    ] {
        for (g, estimate, radius, mean_blur) in [
            (0.0, Estimate::BeamBeam1D, 0.05, 0.0),
            (0.5, Estimate::BeamBeam1D, 0.05, 0.0),
            (0.95, Estimate::BeamBeam1D, 0.05, 0.0),
            (-0.95, Estimate::BeamBeam1D, 0.05, 0.0),
            (0.0, Estimate::BeamBeam2DRay, 0.15, 2.0 / 3.0),
            (0.0, Estimate::BeamBeam2DBeam, 0.15, 0.0),
            (0.0, Estimate::BeamBeam3D, 0.15, 0.75),
        ] {
            let sigma_s = Rgb::new(0.5, 1.0, 2.0);
            let medium = fog(Rgb::default(), sigma_s, g);
            let host = AnalyticHost::furnace(medium, 1.0, interface, outwards());
            let sharp = g.abs() > 0.9;
            let run = Run {
                passes: tier.passes(if sharp { [60, 1_000] } else { [20, 600] }),
                samples: 1,
                seed: 1,
            };
            let method = fixed(estimate, radius).kernel(Kernel::Constant);
            let found = run.measure(&host, &method.paths(1_000));
            for (c, mean) in found.into_iter().enumerate() {
                let sigma_s = f64::from(sigma_s.channel(c));
                let lost = sigma_s * (-sigma_s).exp() * mean_blur * f64::from(radius) / 4.0;
                let precision = match (sharp, radius > 0.1) {
                    (true, _) => 0.25,
                    (false, true) => 0.04,
                    (false, false) => 0.08,
                };
                let name = format!("{estimate} g {g} {interface:?} channel {c}");
                figures.add(name, mean, white * (1.0 - lost), long(tier, precision));
            }
        }
    }
    figures.check(FALSE_ALARM);
}
