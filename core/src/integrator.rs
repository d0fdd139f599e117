//! Estimators of the light that arrives at a sensor.

use crate::{Figure, HostTypes, Sampler, SensorRay, Streams};
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

/// An estimator of radiance.
///
/// One *pass* prepares (traces light paths, builds a structure) and then estimates every pixel.
/// The contract: the mean of [`Integrator::estimate`] plus splats, over samples and passes,
/// converges to the expected radiance; it is already divided by the light paths emitted; it is
/// finite. The driver counts what is not finite and reports it; nothing is clamped in silence.
///
/// Radii and the like depend on the pass index alone, so passes run in any order on any machine.
/// State that must follow earlier passes lives in `Pixel` (per pixel, kept by the driver from pass
/// to pass) or rides in `previous`. A driver stops a render and continues it in another process
/// through [`Integrator::save_pass`] and [`Integrator::save_pixel`]: a method whose `Pass` or
/// `Pixel` has a size must say what is to be kept of it, if only that it is nothing; until it does,
/// its renders are refused rather than continued wrongly.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot render the host `{H}`",
    note = "the host lacks a capability that the integrator bounds on; the notes below name it"
)]
pub trait Integrator<H: HostTypes>: Sync {
    /// What a pass prepares for its pixels.
    type Pass: Send + Sync + 'static;
    /// What a pixel remembers from pass to pass.
    type Pixel: Default + Clone + Send + 'static;

    /// Prepares a pass. `previous` is what the last pass on this machine prepared, if any: memory
    /// to reuse, or a state to continue for methods that are sequential by nature.
    ///
    /// # Errors
    /// See [`PassError`].
    fn begin_pass<R: Streams>(
        &self,
        host: &H,
        cx: &PassContext<'_, R>,
        previous: Option<Self::Pass>,
    ) -> Result<Self::Pass, PassError>;

    /// The radiance arriving along `ray`, without its weight.
    fn estimate(
        &self,
        host: &H,
        pass: &Self::Pass,
        pixel: &mut Self::Pixel,
        ray: &SensorRay<H::Spectrum>,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum;

    /// What the pass adds to the image by itself: light traced to the sensor.
    fn splats<'p>(&self, pass: &'p Self::Pass) -> &'p [Splat<H::Spectrum>] {
        let _ = pass;
        &[]
    }

    /// What a reader of the image must know of a pass, asked when all its pixels are estimated:
    /// errors met, radii, light paths. A figure has the same name in every pass.
    fn figures(&self, pass: &Self::Pass) -> Vec<Figure> {
        let _ = pass;
        Vec::new()
    }

    /// The options with which it renders, defaults filled in, as names and values: with a seed and
    /// the passes all that it takes to render the same picture again. Those that the others make
    /// void are left out.
    fn options(&self) -> Vec<(&'static str, String)> {
        Vec::new()
    }

    /// Appends to `bytes` what the next pass must find in `previous`: nothing for methods that only
    /// reuse its memory.
    ///
    /// # Errors
    /// [`StateError::Unsaved`], by default for a `Pass` that has a size.
    fn save_pass(&self, pass: &Self::Pass, bytes: &mut Vec<u8>) -> Result<(), StateError> {
        let _ = (pass, bytes);
        stateless::<Self::Pass>()
    }

    /// The `previous` of the next pass, from what [`Integrator::save_pass`] wrote; `None`, the
    /// default, where that is nothing.
    ///
    /// # Errors
    /// [`StateError::Corrupt`].
    fn restore_pass(&self, host: &H, bytes: &[u8]) -> Result<Option<Self::Pass>, StateError> {
        let _ = host;
        match bytes {
            [] => Ok(None),
            _ => Err(StateError::Corrupt),
        }
    }

    /// Appends to `bytes` what a pixel remembers.
    ///
    /// # Errors
    /// [`StateError::Unsaved`], by default for a `Pixel` that has a size.
    fn save_pixel(&self, pixel: &Self::Pixel, bytes: &mut Vec<u8>) -> Result<(), StateError> {
        let _ = (pixel, bytes);
        stateless::<Self::Pixel>()
    }

    /// A pixel, from what [`Integrator::save_pixel`] wrote at the front of `bytes`, which it takes
    /// off; a fresh one by default.
    ///
    /// # Errors
    /// [`StateError::Corrupt`].
    fn restore_pixel(&self, bytes: &mut &[u8]) -> Result<Self::Pixel, StateError> {
        let _ = bytes;
        Ok(Self::Pixel::default())
    }
}

/// What has no size remembers nothing.
fn stateless<T>() -> Result<(), StateError> {
    match size_of::<T>() {
        0 => Ok(()),
        _ => Err(StateError::Unsaved),
    }
}

/// Why a render cannot be continued in another process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum StateError {
    /// The method remembers earlier passes and does not save what it remembers.
    Unsaved,
    /// The bytes are not what the method saved.
    Corrupt,
}

impl fmt::Display for StateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unsaved => {
                "the integrator remembers earlier passes and cannot save what it remembers: \
                 its renders run from their start to their end"
            }
            Self::Corrupt => "the saved state is not one of this integrator: start afresh",
        })
    }
}

impl std::error::Error for StateError {}

/// A contribution to the film: its value is added to the pixel that holds `raster`.
#[derive(Clone, Copy, Debug)]
pub struct Splat<S> {
    /// Where on the film, in pixels.
    pub raster: [f32; 2],
    /// Radiance, divided by the light paths of the pass.
    pub value: S,
}

/// What a pass knows of the render it belongs to.
#[derive(Debug)]
pub struct PassContext<'a, R> {
    /// Index of the pass, from 0; the progressive schedules depend on it and on nothing else.
    pub pass: u64,
    /// Random streams of the pass.
    pub streams: &'a R,
    cancelled: &'a AtomicBool,
}

impl<'a, R: Streams> PassContext<'a, R> {
    /// A context; `cancelled` is set from outside to stop the pass early.
    pub fn new(pass: u64, streams: &'a R, cancelled: &'a AtomicBool) -> Self {
        Self {
            pass,
            streams,
            cancelled,
        }
    }

    /// Whether to give up: check between batches of light paths, return [`PassError::Cancelled`].
    pub fn cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

/// Why a pass could not be prepared.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PassError {
    /// The render was cancelled.
    Cancelled,
    /// The structure would not fit: bytes needed and bytes allowed.
    Memory {
        /// What the pass would take.
        needed: u64,
        /// What the configuration grants.
        allowed: u64,
    },
    /// The method cannot render this scene; the text says why and what to do.
    Unsupported(String),
}

impl fmt::Display for PassError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cancelled => write!(f, "the render was cancelled"),
            Self::Memory { needed, allowed } => {
                write!(
                    f,
                    "the pass needs {needed} bytes, {allowed} are allowed: allow more, or trace fewer \
                     paths a pass"
                )
            }
            Self::Unsupported(why) => f.write_str(why),
        }
    }
}

impl std::error::Error for PassError {}
