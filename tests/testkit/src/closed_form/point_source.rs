//! A point light in an infinite isotropic medium.

use crate::quadrature::integrate;
use std::f64::consts::PI;

/// Beyond, 1/cosh is nothing.
const FAR: f64 = 40.0;

/// Single scattering of an isotropic point light of 1 W along a ray, W·sr⁻¹·m⁻².
///
/// σs/(4π)² ∫₀ˢ exp(−σt (t + d)) / d² dt with d² = h² + (t − t₀)²: the light is at distance `h`
/// from the ray, nearest to it at `t_0`; the ray has length `s`, which may be infinite. With
/// t = t₀ + h sinh y the integrand is exp(−σt (t₀ + h exp y))/(h cosh y), smooth on the scale of 1;
/// relative error below 1e-9 for `h` down to 1e-4 of the other lengths, σt times them up to 100.
///
/// ```
/// let l = tyndall_testkit::closed_form::airlight(0.5, 0.6, 1.0, 2.0, 4.0);
/// assert!((l / 1.102_236_27e-3 - 1.0).abs() < 1e-8);
/// ```
///
/// # Panics
/// If `h` is not positive.
pub fn airlight(sigma_s: f64, sigma_t: f64, h: f64, t_0: f64, s: f64) -> f64 {
    assert!(h > 0.0, "h {h}: the light must not lie on the ray");
    let start = (-t_0 / h).asinh().max(-FAR);
    let opaque = (start.exp() + 150.0 / (sigma_t * h)).ln(); // attenuated by exp(−150)
    let end = ((s - t_0) / h).asinh().min(FAR).min(opaque);
    let integral = integrate(start, end, 128, |y| {
        (-sigma_t * (t_0 + h * y.exp())).exp() / (h * y.cosh())
    });
    sigma_s / (4.0 * PI).powi(2) * integral
}

/// Fluence at distance `r` from an isotropic point light of 1 W in an infinite medium of isotropic
/// scattering, W·m⁻², uncollided light included.
///
/// Case, de Hoffmann & Placzek (1953), "Introduction to the Theory of Neutron Diffusion": with
/// σt = 1, the pole κ of a atanh(κ)/κ = 1 and the continuum
/// φ(r) = [−∂κ²/∂a exp(−κr) + ∫₀¹ exp(−r/ν) g(ν) dν/ν²]/(4πr),
/// g(ν) = 1/[(1 − aν atanh ν)² + (πaν/2)²]. The 1 in g is the uncollided light and is taken out of
/// the integral. Relative error below 1e-8 for σt `r` in \[1e-3, 100\].
///
/// ```
/// let phi = tyndall_testkit::closed_form::point_source_fluence(0.5, 1.0, 1.0);
/// assert!((phi - 0.058_695_1).abs() < 1e-7);
/// ```
///
/// # Panics
/// If `albedo` is not in \[0, 1\], or `sigma_t` or `r` not positive.
pub fn point_source_fluence(albedo: f64, sigma_t: f64, r: f64) -> f64 {
    assert!(
        (0.0..=1.0).contains(&albedo) && sigma_t > 0.0 && r > 0.0,
        "albedo {albedo}, sigma_t {sigma_t}, r {r}: out of range"
    );
    let depth = sigma_t * r;
    // ν = tanh x resolves the logarithm at ν = 1; g − 1 falls with ν².
    let continuum = integrate(0.0, 20.0, 400, |x| {
        let nu = x.tanh();
        let regular = 1.0 - albedo * nu * x;
        let singular = 0.5 * PI * albedo * nu;
        let g = 1.0 / (regular * regular + singular * singular);
        (-depth / nu).exp() * (g - 1.0) / (nu * nu * x.cosh().powi(2))
    });
    let (kappa, residue) = pole(albedo);
    let pole = residue * (-kappa * depth).exp();
    let uncollided = (-depth).exp() / depth;
    sigma_t * sigma_t * (pole + uncollided + continuum) / (4.0 * PI * depth)
}

/// κ of a atanh(κ) = κ in \[0, 1) and −∂κ²/∂a there.
fn pole(albedo: f64) -> (f64, f64) {
    if albedo == 0.0 {
        return (1.0, 0.0);
    }
    if albedo == 1.0 {
        return (0.0, 3.0);
    }
    // κ = tanh x: a x = tanh x; bisection, for x in (0, 1/a].
    let (mut low, mut high) = (0.0, 1.0 / albedo);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if albedo * middle < f64::tanh(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    let x = 0.5 * (low + high);
    let kappa = x.tanh();
    // dκ/da = −x/(a/(1−κ²) − 1), with 1 − κ² = 1/cosh².
    let slope = x / (albedo * x.cosh().powi(2) - 1.0);
    (kappa, 2.0 * kappa * slope)
}
