//! Renders that are killed, interrupted or run out of disk, and continued.

#![cfg(unix)]

use exr::prelude::{AnyChannels, FlatSamples, ReadChannels, ReadLayers, read};
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A render that takes a second or so.
struct Bench {
    folder: TempDir,
    passes: &'static str,
}

impl Bench {
    fn new(passes: &'static str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        Self { folder, passes }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, output: &str, more: &[&str]) -> Command {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("tyndall"));
        let scene = format!("{}/../scenes/cornell_fog.toml", env!("CARGO_MANIFEST_DIR"));
        command
            .args(["render", &scene, "-o"])
            .arg(self.path(output))
            .args(["--set", "film.width=12", "--set", "film.height=12"])
            .args(["--threads", "2"])
            .args(more)
            .stderr(Stdio::piped());
        command
    }

    fn run(&self, output: &str, more: &[&str]) -> Output {
        let output = self.command(output, more).output();
        output.expect("the command runs")
    }

    fn whole(&self) -> AnyChannels<FlatSamples> {
        let done = self.run("whole.exr", &["--passes", self.passes]);
        assert!(done.status.success(), "{}", said(&done));
        pixels(&self.path("whole.exr"))
    }

    /// A render that leaves a checkpoint after every pass.
    fn start(&self, more: &[&str]) -> Child {
        let often = ["--passes", self.passes, "--checkpoint-interval", "0.001s"];
        let mut command = self.command("out.exr", &[&often[..], more].concat());
        command.spawn().expect("the command runs")
    }

    /// Interrupts a render as soon as it has left a checkpoint.
    fn interrupted(&self, more: &[&str]) -> Output {
        let child = self.start(more);
        wait_for(&self.path("out.exr.checkpoint"));
        signal(&child, "-INT");
        let done = child.wait_with_output().expect("an end");
        assert!(done.status.success(), "{}", said(&done));
        done
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).expect("a folder");
        let names = entries.map(|e| e.expect("an entry").file_name());
        let mut names: Vec<_> = names.map(|n| n.to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Every channel of an image, without what is said of it.
fn pixels(path: &Path) -> AnyChannels<FlatSamples> {
    let reader = read().no_deep_data().largest_resolution_level();
    let reader = reader.all_channels().first_valid_layer().all_attributes();
    reader
        .from_file(path)
        .expect("an image")
        .layer_data
        .channel_data
}

fn wait_for(path: &Path) {
    let start = Instant::now();
    while !path.exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "no {path:?}");
        sleep(Duration::from_millis(2));
    }
}

fn signal(child: &Child, signal: &str) {
    let pid = child.id().to_string();
    let sent = Command::new("kill").args([signal, &pid]).status();
    assert!(sent.expect("kill runs").success());
}

/// A checkpoint left by an interrupted render.
fn left() -> (Bench, Vec<u8>) {
    let bench = Bench::new("100000");
    bench.interrupted(&[]);
    let bytes = fs::read(bench.path("out.exr.checkpoint")).expect("a checkpoint");
    (bench, bytes)
}

#[test]
fn killed_at_twenty_random_moments_it_ends_with_the_same_bits() {
    let bench = Bench::new("200");
    let whole = bench.whole();
    assert!(bench.run("out.exr", &["--passes", "1"]).status.success());
    let old = fs::read(bench.path("out.exr")).expect("an image");
    let mut random = 1_u64;
    let (mut kills, mut continued) = (0, 0);
    for _ in 0..100 {
        let mut child = bench.start(&["--resume"]);
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        sleep(Duration::from_millis(30 + (random >> 33) % 90));
        child.kill().expect("a process");
        let done = child.wait_with_output().expect("an end");
        continued += u32::from(said(&done).contains("going on after"));
        if done.status.signal() == Some(9) {
            kills += 1;
            let image = fs::read(bench.path("out.exr")).expect("an image");
            assert!(image == old || pixels(&bench.path("out.exr")) == whole);
        } else {
            assert!(done.status.success(), "{}", said(&done));
        }
        if kills == 20 {
            break;
        }
    }
    assert_eq!(kills, 20);
    assert!(continued > 5, "only {continued} went on from a checkpoint");
    let done = bench
        .start(&["--resume"])
        .wait_with_output()
        .expect("an end");
    assert!(done.status.success(), "{}", said(&done));
    assert!(pixels(&bench.path("out.exr")) == whole);
    let again = bench.run("out.exr", &["--passes", "200"]);
    assert!(again.status.success(), "{}", said(&again));
    assert!(pixels(&bench.path("out.exr")) == whole, "a second run");
    let names = bench.names();
    let kept = names.iter().filter(|n| !n.starts_with(".tyndall-"));
    assert!(kept.eq(["out.exr", "whole.exr"].iter()), "{names:?}");
}

#[test]
fn ctrl_c_leaves_an_image_and_a_checkpoint_that_ends_with_the_same_bits() {
    let bench = Bench::new("400");
    let whole = bench.whole();
    let stopped = said(&bench.interrupted(&[]));
    assert!(stopped.contains("--resume goes on"), "{stopped}");
    assert!(
        pixels(&bench.path("out.exr")) != whole,
        "it was not stopped"
    );
    assert_eq!(
        bench.names(),
        ["out.exr", "out.exr.checkpoint", "whole.exr"]
    );
    let done = bench.run("out.exr", &["--passes", "400", "--resume"]);
    assert!(said(&done).contains("going on after"), "{}", said(&done));
    assert!(pixels(&bench.path("out.exr")) == whole);
    assert_eq!(bench.names(), ["out.exr", "whole.exr"]);
}

#[test]
fn a_part_of_a_render_is_resumed_as_that_part() {
    let bench = Bench::new("400");
    let part = ["--first-pass", "5", "--passes", "400"];
    let whole = bench.run("whole.exr", &part);
    assert!(whole.status.success(), "{}", said(&whole));
    bench.interrupted(&part[..2]);
    let done = bench.run("out.exr", &[&part[..], &["--resume"]].concat());
    assert!(said(&done).contains("going on after"), "{}", said(&done));
    assert!(pixels(&bench.path("out.exr")) == pixels(&bench.path("whole.exr")));
}

#[test]
fn without_a_checkpoint_it_starts_afresh_and_says_so() {
    let bench = Bench::new("2");
    let done = bench.run("out.exr", &["--passes", "2", "--resume"]);
    assert!(done.status.success() && said(&done).contains("starting afresh"));
    assert!(pixels(&bench.path("out.exr")) == bench.whole());
    fs::write(bench.path("out.exr.checkpoint"), "old").expect("a file");
    let done = bench.run("out.exr", &["--passes", "2"]);
    assert!(
        said(&done).contains("--resume would have continued"),
        "{}",
        said(&done)
    );
    assert_eq!(bench.names(), ["out.exr", "whole.exr"]);
}

#[test]
fn a_time_budget_counts_the_time_spent_before() {
    let (bench, _) = left();
    let image = pixels(&bench.path("out.exr"));
    let done = bench.run("out.exr", &["--time", "0.001s", "--resume"]);
    assert!(done.status.success(), "{}", said(&done));
    assert!(
        pixels(&bench.path("out.exr")) == image,
        "nothing was left to do"
    );
}

/// The same checkpoint with another body, and the checksum that goes with it.
fn with_body(checkpoint: &[u8], change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let (header, body) = checkpoint.split_at(52);
    let mut body = body.to_vec();
    change(&mut body);
    let length = (body.len() as u64).to_le_bytes();
    let checksum = blake3::hash(&body);
    [&header[..12], &length, checksum.as_bytes(), &body].concat()
}

#[test]
fn a_damaged_checkpoint_is_an_error_that_leaves_all_as_it_was() {
    let (bench, good) = left();
    let image = fs::read(bench.path("out.exr")).expect("an image");
    let flipped = |at: usize| {
        let mut bytes = good.clone();
        bytes[at] ^= 1;
        bytes
    };
    let older = |body: &mut Vec<u8>| {
        let version = env!("CARGO_PKG_VERSION").len();
        body[version] ^= 1;
    };
    let cases = [
        (Vec::new(), "no checkpoint"),
        (
            b"an image, perhaps, or a letter to somebody or other".repeat(9),
            "no checkpoint",
        ),
        (good[..20].to_vec(), "cut off"),
        (good[..good.len() - 1].to_vec(), "cut off"),
        ([&good[..], b"more"].concat(), "cut off"),
        (flipped(0), "no checkpoint"),
        (flipped(8), "another version"),
        (flipped(12), "cut off"),
        (flipped(30), "damaged"),
        (flipped(good.len() / 2), "damaged"),
        (with_body(&good, older), "was left by tyndall"),
        (with_body(&good, |body| body.truncate(99)), "damaged"),
        (with_body(&good, Vec::clear), "damaged"),
    ];
    for (bytes, problem) in cases {
        fs::write(bench.path("out.exr.checkpoint"), &bytes).expect("a file");
        let done = bench.run("out.exr", &["--passes", "2", "--resume"]);
        let said = said(&done);
        assert_eq!(done.status.code(), Some(5), "{problem}: {said}");
        assert!(
            said.contains("out.exr.checkpoint") && said.contains(problem),
            "{said}"
        );
        assert!(said.contains("without --resume"), "{said}");
        assert_eq!(said.trim_end().lines().count(), 1, "{said}");
        assert!(fs::read(bench.path("out.exr.checkpoint")).expect("a file") == bytes);
    }
    assert!(fs::read(bench.path("out.exr")).expect("an image") == image);
}

#[test]
fn a_checkpoint_of_another_render_is_an_error() {
    let (bench, _) = left();
    for (more, problem) in [
        (&["--seed", "1"][..], "--seed 0"),
        (&["--first-pass", "1"], "--first-pass 0"),
        (&["--set", "media.fog.sigma_s=0.3"], "another scene"),
        (&["--set", "film.width=13"], "another scene"),
        (&["--set", "integrator.max_depth=3"], "another scene"),
    ] {
        let done = bench.run("out.exr", &[more, &["--passes", "2", "--resume"]].concat());
        let said = said(&done);
        assert_eq!(done.status.code(), Some(5), "{said}");
        assert!(
            said.contains(problem) && said.contains("out.exr.checkpoint"),
            "{said}"
        );
    }
}

#[test]
fn a_full_disk_is_an_error_that_leaves_the_old_image() {
    let bench = Bench::new("3");
    assert!(bench.run("out.exr", &["--passes", "1"]).status.success());
    let old = fs::read(bench.path("out.exr")).expect("an image");
    let render = bench.command("out.exr", &["--passes", "3"]);
    let mut limited = Command::new("sh");
    limited.args(["-c", "trap '' XFSZ; ulimit -f 1; exec \"$0\" \"$@\""]);
    limited.arg(render.get_program()).args(render.get_args());
    let done = limited.output().expect("a shell");
    let said = said(&done);
    assert_eq!(done.status.code(), Some(4), "{said}");
    assert!(said.contains("out.exr: cannot be written"), "{said}");
    assert!(
        said.contains("out.exr.checkpoint: cannot be written"),
        "{said}"
    );
    assert!(fs::read(bench.path("out.exr")).expect("an image") == old);
    assert_eq!(bench.names(), ["out.exr"]);
}

#[test]
fn an_image_that_cannot_be_written_at_the_end_leaves_its_passes() {
    let bench = Bench::new("200");
    let whole = bench.whole();
    let child = bench.start(&[]);
    wait_for(&bench.path("out.exr.checkpoint"));
    fs::create_dir(bench.path("out.exr")).expect("a folder in the way");
    let done = child.wait_with_output().expect("an end");
    assert_eq!(done.status.code(), Some(4), "{}", said(&done));
    fs::remove_dir(bench.path("out.exr")).expect("a folder");
    let done = bench.run("out.exr", &["--passes", "200", "--resume"]);
    assert!(
        said(&done).contains("going on after 200"),
        "{}",
        said(&done)
    );
    assert!(pixels(&bench.path("out.exr")) == whole);
}
