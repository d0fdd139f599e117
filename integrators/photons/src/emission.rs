//! How many light paths a pass has.

use tyndall_core::{Figure, PassContext, PassError, Streams};
use tyndall_walk::LightPaths;

/// How many light paths a pass has, and what their photons may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Emission {
    /// Light paths emitted in a pass, at least 1.
    pub paths: u64,
    /// Bytes that photons may take at any time of a pass. Tracing and sorting them takes most: 80
    /// to 124 each in three channels.
    pub max_bytes: u64,
}

impl Default for Emission {
    /// 100,000 paths, 4 GiB.
    fn default() -> Self {
        Self {
            paths: 100_000,
            max_bytes: 4 << 30,
        }
    }
}

impl Emission {
    /// The light paths of a pass.
    pub fn light_paths<'a, 'c, R: Streams>(
        &self,
        cx: &'a PassContext<'c, R>,
    ) -> LightPaths<'a, 'c, R> {
        LightPaths::new(cx, self.paths, self.max_bytes)
    }

    /// The number of the first path of a pass among all that were ever traced.
    pub fn first_path(&self, pass: u64) -> u64 {
        pass.saturating_mul(self.paths)
    }

    /// Refuses a pass whose photons need so many bytes, if they may not take as many.
    ///
    /// # Errors
    /// [`PassError::Memory`].
    pub fn allow(&self, needed: usize) -> Result<(), PassError> {
        let (needed, allowed) = (needed as u64, self.max_bytes);
        if needed <= allowed {
            Ok(())
        } else {
            Err(PassError::Memory { needed, allowed })
        }
    }

    /// What a method tells of these options, see
    /// [`Integrator::options`](tyndall_core::Integrator::options); `by_photons` is
    /// [`DirectLight::BY_PHOTONS`](tyndall_walk::DirectLight::BY_PHOTONS).
    pub fn options(&self, by_photons: bool) -> Vec<(&'static str, String)> {
        vec![
            ("paths", self.paths.to_string()),
            ("max_bytes", self.max_bytes.to_string()),
            ("sample_lights", (!by_photons).to_string()),
        ]
    }

    /// What a method tells of a pass that has kept so many photons in media and on surfaces and
    /// has [`lost`](crate::PhotonMaps::lost) some, see
    /// [`Integrator::figures`](tyndall_core::Integrator::figures).
    pub fn figures(&self, [media, surfaces]: [usize; 2], lost: u64) -> Vec<Figure> {
        let mut figures = vec![
            Figure::total("light paths", self.paths),
            Figure::total("photons in media", media as u64),
            Figure::total("photons on surfaces", surfaces as u64),
        ];
        if lost > 0 {
            figures.push(Figure::total("photons lost, not finite", lost));
        }
        figures
    }
}
