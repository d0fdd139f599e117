//! `--tev` against a stand-in that decodes its packets.

use exr::prelude::read_first_rgba_layer_from_file;
use std::io::Read;
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Command, Output};
use std::thread;
use std::time::{Duration, Instant};

fn render(folder: &Path, address: &str, budget: [&str; 2]) -> Output {
    let scene = format!("{}/../scenes/cornell_fog.toml", env!("CARGO_MANIFEST_DIR"));
    Command::new(assert_cmd::cargo::cargo_bin("tyndall"))
        .args(["render", &scene, "-o"])
        .arg(folder.join("out.exr"))
        .args(["--set", "film.width=30", "--set", "film.height=20"])
        .args(["--threads", "2", "--tev", address])
        .args(budget)
        .output()
        .expect("the command runs")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The bytes of a packet.
struct Packet(Vec<u8>);

impl Packet {
    fn take(&mut self, count: usize) -> Vec<u8> {
        let rest = self.0.split_off(count);
        std::mem::replace(&mut self.0, rest)
    }

    fn number(&mut self, bytes: usize) -> u64 {
        let taken = self.take(bytes);
        taken.iter().rev().fold(0, |n, &b| n << 8 | u64::from(b))
    }

    fn text(&mut self) -> String {
        let end = self.0.iter().position(|&b| b == 0).expect("an end of text");
        let text = String::from_utf8(self.take(end)).expect("UTF-8");
        self.take(1);
        text
    }

    fn texts(&mut self) -> Vec<String> {
        let count = self.number(4);
        (0..count).map(|_| self.text()).collect()
    }
}

/// An image in the viewer.
#[derive(Debug, Default)]
struct Shown {
    name: String,
    size: [usize; 2],
    channels: Vec<String>,
    values: Vec<f32>,
    updates: usize,
}

/// Reads packets as tev does, until the stream ends.
fn view(mut stream: TcpStream) -> Shown {
    let mut shown = Shown::default();
    let mut length = [0; 4];
    while stream.read_exact(&mut length).is_ok() {
        let mut packet = vec![0; u32::from_le_bytes(length) as usize - 4];
        stream.read_exact(&mut packet).expect("a whole packet");
        let mut packet = Packet(packet);
        let kind = packet.number(1);
        packet.number(1);
        let name = packet.text();
        match kind {
            4 => {
                let size = [0; 2].map(|_: usize| packet.number(4) as usize);
                let channels = packet.texts();
                let values = vec![f32::NAN; size[0] * size[1] * channels.len()];
                shown = Shown {
                    name,
                    size,
                    channels,
                    values,
                    updates: 0,
                };
            }
            6 => update(&mut shown, &name, packet),
            other => panic!("a packet of kind {other}"),
        }
    }
    shown
}

fn update(shown: &mut Shown, name: &str, mut packet: Packet) {
    assert_eq!(name, shown.name);
    let channels = packet.texts();
    assert_eq!(channels, shown.channels);
    let [x, y, width, height] = [0; 4].map(|_: usize| packet.number(4) as usize);
    assert!(x + width <= shown.size[0] && y + height <= shown.size[1]);
    let offsets: Vec<_> = channels.iter().map(|_| packet.number(8) as usize).collect();
    let strides: Vec<_> = channels.iter().map(|_| packet.number(8) as usize).collect();
    let data = packet.0.chunks_exact(4);
    let data: Vec<_> = data
        .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        .collect();
    for pixel in 0..width * height {
        let (column, row) = (x + pixel % width, y + pixel / width);
        for channel in 0..channels.len() {
            let value = data[offsets[channel] + pixel * strides[channel]];
            let at = (row * shown.size[0] + column) * channels.len() + channel;
            shown.values[at] = value;
        }
    }
    shown.updates += 1;
}

fn listener() -> (TcpListener, String) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address").to_string();
    (listener, address)
}

#[test]
fn the_viewer_ends_with_the_picture_that_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let (listener, address) = listener();
    let viewer = thread::spawn(move || view(listener.accept().expect("a connection").0));
    let done = render(folder.path(), &address, ["--passes", "40"]);
    assert!(done.status.success(), "{}", said(&done));
    let shown = viewer.join().expect("packets that can be read");
    assert!(shown.name.ends_with("out.exr"), "{}", shown.name);
    assert_eq!((shown.size, shown.updates > 1), ([30, 20], true));
    assert_eq!(shown.channels, ["R", "G", "B"]);
    let image = read_first_rgba_layer_from_file(
        folder.path().join("out.exr"),
        |size, _| vec![f32::NAN; 3 * size.area()],
        |values: &mut Vec<f32>, at, (r, g, b, _): (f32, f32, f32, f32)| {
            let i = 3 * (30 * at.y() + at.x());
            values[i..i + 3].copy_from_slice(&[r, g, b]);
        },
    );
    let written = image.expect("an image").layer_data.channel_data.pixels;
    assert_eq!(shown.values, written);
}

#[test]
fn a_viewer_that_is_not_there_or_goes_away_is_a_notice() {
    let folder = tempfile::tempdir().expect("a folder");
    let (listener, address) = listener();
    drop(listener);
    let nobody = render(folder.path(), &address, ["--passes", "3"]);
    let (listener, address) = self::listener();
    let leaver = thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("a connection");
        stream.read_exact(&mut [0; 4]).expect("a packet begins");
    });
    // Long enough for several pictures.
    let left = render(folder.path(), &address, ["--time", "2s"]);
    leaver.join().expect("no panic");
    for done in [nobody, left] {
        assert!(done.status.success(), "{}", said(&done));
        let notices = said(&done).matches("no preview from tev at").count();
        assert_eq!(notices, 1, "{}", said(&done));
    }
}

#[test]
fn a_viewer_that_hangs_does_not_stall_the_render() {
    let folder = tempfile::tempdir().expect("a folder");
    let (listener, address) = listener();
    let begun = Instant::now();
    // Pictures of 3 MB: the system's buffers take a few of them.
    let scene = format!("{}/../scenes/laser.toml", env!("CARGO_MANIFEST_DIR"));
    let done = Command::new(assert_cmd::cargo::cargo_bin("tyndall"))
        .args(["render", &scene, "-o"])
        .arg(folder.path().join("out.exr"))
        .args(["--set", "film.width=500", "--set", "film.height=500"])
        .args(["--time", "8s", "--tev", &address])
        .output()
        .expect("the command runs");
    assert!(done.status.success(), "{}", said(&done));
    assert!(said(&done).contains("it takes no data"), "{}", said(&done));
    assert!(begun.elapsed() < Duration::from_secs(60));
    drop(listener);
}

#[test]
fn an_address_without_a_port_is_a_wrong_command_line() {
    let folder = tempfile::tempdir().expect("a folder");
    for address in ["localhost", ":14158", "localhost:tev", "localhost:99999"] {
        let done = render(folder.path(), address, ["--passes", "1"]);
        assert_eq!(done.status.code(), Some(2), "{address}");
    }
}
