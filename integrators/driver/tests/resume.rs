//! Renders in parts: continued from snapshots, begun at a later pass, merged.

#[path = "support/blank.rs"]
mod blank;

use blank::Blank;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tyndall_core::{
    Domain, Figure, FigureValue, Integrator, PassContext, PassError, Rgb, Sampler, SensorRay,
    Spectrum, StateError, Streams,
};
use tyndall_driver::{Budget, Film, PassStreams, Render, RenderError, Snapshot};

/// A method whose passes feed the next, as a mixture that learns does, and whose pixels remember,
/// as progressive radii do.
struct Learner {
    saves: bool,
    cancel_in_pass: Option<u64>,
    cancelled: AtomicBool,
}

impl Learner {
    fn new() -> Self {
        Self {
            saves: true,
            cancel_in_pass: None,
            cancelled: AtomicBool::new(false),
        }
    }
}

fn take<const N: usize>(bytes: &mut &[u8]) -> Result<[u8; N], StateError> {
    let (first, rest) = bytes.split_first_chunk().ok_or(StateError::Corrupt)?;
    *bytes = rest;
    Ok(*first)
}

impl Integrator<Blank> for Learner {
    type Pass = f32;
    type Pixel = f64;

    fn begin_pass<R: Streams>(
        &self,
        _: &Blank,
        cx: &PassContext<'_, R>,
        previous: Option<f32>,
    ) -> Result<f32, PassError> {
        if self.cancel_in_pass == Some(cx.pass) {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        let news = cx.streams.sampler(Domain::STRUCTURE, 0).next_1d();
        Ok(0.5 * (previous.unwrap_or(1.0) + news))
    }

    fn estimate(
        &self,
        _: &Blank,
        pass: &f32,
        pixel: &mut f64,
        _: &SensorRay<Rgb>,
        sampler: &mut impl Sampler,
    ) -> Rgb {
        let [r, g, b] = sampler.next();
        *pixel = 0.9 * *pixel + f64::from(r);
        Rgb::new(r, g * pass, b + *pixel as f32)
    }

    fn figures(&self, pass: &f32) -> Vec<Figure> {
        vec![
            Figure::total("passes", 1),
            Figure::range("mixture", *pass),
            Figure::largest("mixture", -pass),
        ]
    }

    fn save_pass(&self, pass: &f32, bytes: &mut Vec<u8>) -> Result<(), StateError> {
        if !self.saves {
            return Err(StateError::Unsaved);
        }
        bytes.extend(pass.to_le_bytes());
        Ok(())
    }

    fn restore_pass(&self, _: &Blank, mut bytes: &[u8]) -> Result<Option<f32>, StateError> {
        Ok(Some(f32::from_le_bytes(take(&mut bytes)?)))
    }

    fn save_pixel(&self, pixel: &f64, bytes: &mut Vec<u8>) -> Result<(), StateError> {
        bytes.extend(pixel.to_le_bytes());
        Ok(())
    }

    fn restore_pixel(&self, bytes: &mut &[u8]) -> Result<f64, StateError> {
        Ok(f64::from_le_bytes(take(bytes)?))
    }
}

/// Says nothing of what it remembers.
struct Silent;

impl Integrator<Blank> for Silent {
    type Pass = ();
    type Pixel = u32;

    fn begin_pass<R: Streams>(
        &self,
        _: &Blank,
        _: &PassContext<'_, R>,
        _: Option<()>,
    ) -> Result<(), PassError> {
        Ok(())
    }

    fn estimate(
        &self,
        _: &Blank,
        (): &(),
        pixel: &mut u32,
        _: &SensorRay<Rgb>,
        _: &mut impl Sampler,
    ) -> Rgb {
        *pixel += 1;
        Rgb::splat(*pixel as f32)
    }
}

/// Noise that depends on the pass alone.
struct Memoryless;

impl Integrator<Blank> for Memoryless {
    type Pass = ();
    type Pixel = ();

    fn begin_pass<R: Streams>(
        &self,
        _: &Blank,
        _: &PassContext<'_, R>,
        _: Option<()>,
    ) -> Result<(), PassError> {
        Ok(())
    }

    fn estimate(
        &self,
        _: &Blank,
        (): &(),
        (): &mut (),
        _: &SensorRay<Rgb>,
        sampler: &mut impl Sampler,
    ) -> Rgb {
        let [r, g, b] = sampler.next();
        Rgb::new(r, g, b)
    }
}

const SIZE: Blank = Blank([37, 21]);

/// Through bytes, as between two processes.
fn carried(snapshot: &Snapshot<Rgb>) -> Snapshot<Rgb> {
    let bytes = postcard::to_stdvec(snapshot).expect("bytes");
    postcard::from_bytes(&bytes).expect("a snapshot")
}

fn render<I: Integrator<Blank>>(integrator: &I, passes: u64) -> Snapshot<Rgb> {
    let render = Render::new(&SIZE, integrator).seed(3);
    render
        .advance(Budget::Passes(passes), |_| {})
        .expect("a render")
}

#[test]
fn a_render_resumed_after_any_pass_has_the_bits_of_one_that_was_not() {
    let learner = Learner::new();
    let whole = render(&learner, 7);
    let mut parts = Vec::new();
    Render::new(&SIZE, &learner)
        .seed(3)
        .run(Budget::Passes(6), |p| parts.push(carried(p.snapshot)))
        .expect("a film");
    assert_eq!(parts.len(), 6);
    for part in parts {
        let resumed = Render::new(&SIZE, &learner).seed(3).resume(part);
        let resumed = resumed.advance(Budget::Passes(7), |_| {}).expect("a film");
        assert!(resumed.film() == whole.film());
        assert_eq!(resumed.figures(), whole.figures());
    }
}

#[test]
fn a_cancelled_render_is_resumed_where_its_last_whole_pass_ended() {
    let whole = render(&Learner::new(), 7);
    let cancelled = Learner {
        cancel_in_pass: Some(4),
        ..Learner::new()
    };
    let part = Render::new(&SIZE, &cancelled)
        .seed(3)
        .cancelled_by(&cancelled.cancelled)
        .advance(Budget::Passes(7), |_| {})
        .expect("a part");
    assert_eq!(part.film().passes(), 4);
    let learner = Learner::new();
    let resumed = Render::new(&SIZE, &learner).seed(3).resume(carried(&part));
    let resumed = resumed.advance(Budget::Passes(7), |_| {}).expect("a film");
    assert!(resumed.film() == whole.film());
    assert_eq!(resumed.figures(), whole.figures());
}

#[test]
fn figures_of_passes_are_gathered_by_their_kind() {
    let mut passes = Vec::new();
    let learner = Learner::new();
    let gathered = Render::new(&SIZE, &learner)
        .seed(3)
        .advance(Budget::Passes(5), |p| {
            let streams = PassStreams::new(3, passes.len() as u64);
            let previous = passes.last().copied();
            let news = streams.sampler(Domain::STRUCTURE, 0).next_1d();
            passes.push(0.5 * (previous.unwrap_or(1.0) + news));
            assert_eq!(
                p.snapshot.figures()[0].value,
                FigureValue::Total(passes.len() as u64)
            );
        })
        .expect("a render");
    let least = passes.iter().copied().fold(f32::INFINITY, f32::min);
    let most = passes.iter().copied().fold(0.0, f32::max);
    assert!(least < most);
    let expected = [
        Figure::total("passes", 5),
        Figure {
            value: FigureValue::Range([least, most]),
            ..Figure::range("mixture", 0.0)
        },
        Figure::largest("mixture", -least),
    ];
    assert_eq!(gathered.figures(), expected);
}

#[test]
fn figures_are_read_back_from_what_they_are_written_as() {
    let range = |range| Figure {
        value: FigureValue::Range(range),
        ..Figure::range("radius in media: of the first", 0.0)
    };
    for figure in [
        Figure::total("light paths", u64::MAX),
        Figure::largest("error of transmittance", 0.1 + f32::EPSILON),
        Figure::largest("an error at most in all", f32::INFINITY),
        range([1e-30, f32::MAX]),
        range([0.0, 1.0 / 3.0]),
    ] {
        assert_eq!(figure.to_string().parse(), Ok(figure.clone()));
    }
    for text in [
        "",
        "light paths",
        "light paths: 3",
        "light paths: -3 in all",
        "a: b to c",
        "a: 1 at most 2",
    ] {
        let why = text.parse::<Figure>().expect_err(text).to_string();
        assert!(why.contains(&format!("{text:?}")), "{why}");
    }
}

#[test]
fn a_method_that_does_not_save_its_memory_is_refused() {
    let forgetful = Learner {
        saves: false,
        ..Learner::new()
    };
    let refusals = [
        (render(&forgetful, 2), "a pass"),
        (render(&Silent, 2), "a pixel"),
    ];
    for (snapshot, what) in refusals {
        assert_eq!(snapshot.resumable(), Err(StateError::Unsaved), "{what}");
        let silent = Render::new(&SIZE, &Silent).resume(snapshot);
        let refused = silent.run(Budget::Passes(3), |_| {});
        assert_eq!(refused, Err(RenderError::State(StateError::Unsaved)));
    }
    assert_eq!(render(&Memoryless, 2).resumable(), Ok(()));
}

#[test]
fn what_another_render_left_is_an_error() {
    let foreign = Render::new(&SIZE, &Learner::new())
        .resume(render(&Memoryless, 2))
        .run(Budget::Passes(3), |_| {});
    assert_eq!(foreign, Err(RenderError::State(StateError::Corrupt)));
    let foreign = Render::new(&SIZE, &Memoryless)
        .resume(render(&Learner::new(), 2))
        .run(Budget::Passes(3), |_| {});
    assert_eq!(foreign, Err(RenderError::State(StateError::Corrupt)));
    let larger = Render::new(&Blank([37, 22]), &Memoryless)
        .resume(render(&Memoryless, 2))
        .run(Budget::Passes(3), |_| {});
    assert!(
        matches!(larger, Err(RenderError::Resolution(_))),
        "{larger:?}"
    );
}

#[test]
fn a_budget_counts_what_was_spent_before() {
    let spent = render(&Memoryless, 5);
    let again = |budget| {
        let resumed = Render::new(&SIZE, &Memoryless).resume(spent.clone());
        resumed.advance(budget, |_| {}).expect("a render")
    };
    assert_eq!(again(Budget::Passes(5)), spent);
    assert_eq!(again(Budget::Passes(2)), spent, "nothing is taken away");
    assert!(spent.elapsed() > Duration::ZERO);
    assert_eq!(again(Budget::Time(spent.elapsed())), spent);
    let longer = spent.elapsed() + Duration::from_millis(5);
    let more = again(Budget::Time(longer));
    assert!(more.elapsed() >= longer && more.film().passes() > 5);
}

#[test]
fn films_are_serialised_to_the_bit_and_checked_when_read() {
    let film = render(&Memoryless, 3).into_film();
    let bytes = postcard::to_stdvec(&film).expect("bytes");
    assert!(postcard::from_bytes::<Film<Rgb>>(&bytes).expect("a film") == film);
    assert!(
        postcard::from_bytes::<Film<f32>>(&bytes).is_err(),
        "channels"
    );
    for cut in 0..bytes.len().min(64) {
        assert!(postcard::from_bytes::<Film<Rgb>>(&bytes[..cut]).is_err());
    }
}

#[test]
fn parts_merge_into_the_whole_but_for_rounding() {
    let part = |first, passes| {
        let render = Render::new(&SIZE, &Memoryless).seed(3).first_pass(first);
        render.run(Budget::Passes(passes), |_| {}).expect("a film")
    };
    let whole = part(0, 12);
    for parts in [[(0, 5), (5, 7)], [(5, 7), (0, 5)], [(0, 1), (1, 11)]] {
        let mut merged = Film::new(SIZE.0);
        for (first, passes) in parts {
            merged.merge(&part(first, passes)).expect("the same size");
        }
        assert_eq!(merged.passes(), 12);
        // Sums of a dozen terms below 1 in f64.
        let same = |a: f64, b: f64| (a - b).abs() < 1e-14;
        let variances = merged.variance_of_mean().zip(whole.variance_of_mean());
        let means = merged
            .mean()
            .iter()
            .copied()
            .zip(whole.mean().iter().copied());
        assert!(means.chain(variances).all(|(a, b)| same(a, b)));
    }
    let other = Film::new([3, 3]);
    assert!(part(0, 1).merge(&other).is_err());
}

#[test]
fn a_pass_is_watched_tile_by_tile() {
    let shares = std::sync::Mutex::new(Vec::new());
    Render::new(&SIZE, &Memoryless)
        .watched_by(&|share| shares.lock().expect("no panic").push(share))
        .run(Budget::Passes(1), |_| {})
        .expect("a film");
    let mut shares = shares.into_inner().expect("no panic");
    shares.sort_by(f64::total_cmp);
    assert_eq!(shares, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(|n| n / 6.0));
}
