//! `--tev`: the image while it renders, in the viewer tev.
//!
//! A thread of its own talks to tev, so that the render waits for nothing: a picture that comes
//! while the last one is on its way is left out.

use std::io;
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};
use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};
use tyndall_core::Spectrum;
use tyndall_driver::Film;

/// Between two pictures.
const INTERVAL: Duration = Duration::from_millis(500);

/// What tev may take to accept a connection or a piece of a picture.
const PATIENCE: Duration = Duration::from_secs(1);

/// Pixels a packet, in whole rows.
const PIXELS: usize = 1 << 18;

/// A film shown in tev.
pub(crate) struct Preview {
    pictures: SyncSender<Picture>,
    ended: Receiver<()>,
    shown: Option<Instant>,
}

/// The radiance of a film, row by row, channels innermost.
struct Picture {
    resolution: [u32; 2],
    values: Vec<f32>,
}

impl Preview {
    /// Shows films of spectrum `S` as the image `name` of the tev at `address` (`HOST:PORT`); `say`
    /// tells the user when tev is silent.
    pub(crate) fn start<S: Spectrum>(
        address: String,
        name: String,
        say: impl Fn(&str) + Send + 'static,
    ) -> Self {
        let (pictures, queue) = sync_channel(1);
        let (end, ended) = sync_channel(0);
        let channels: &[&str] = match S::CHANNELS {
            1 => &["Y"],
            _ => &["R", "G", "B"],
        };
        thread::spawn(move || {
            // Dropped at the end of the thread, which `finish` waits for.
            let _end: SyncSender<()> = end;
            let viewer = Viewer {
                address,
                name,
                channels,
                client: None,
            };
            viewer.run(&queue, &say);
        });
        Self {
            pictures,
            ended,
            shown: None,
        }
    }

    /// Shows the film if it is time for it and tev has taken the last one.
    pub(crate) fn show<S: Spectrum>(&mut self, film: &Film<S>) {
        if self.shown.is_some_and(|shown| shown.elapsed() < INTERVAL) {
            return;
        }
        if self.pictures.try_send(picture(film)).is_ok() {
            self.shown = Some(Instant::now());
        }
    }

    /// Shows the last film, unless tev takes too long.
    pub(crate) fn finish<S: Spectrum>(self, film: &Film<S>) {
        let begun = Instant::now();
        let mut last = picture(film);
        while let Err(TrySendError::Full(picture)) = self.pictures.try_send(last) {
            if begun.elapsed() > PATIENCE {
                return;
            }
            last = picture;
            thread::sleep(Duration::from_millis(5));
        }
        drop(self.pictures);
        // Ends by the thread's end or by patience; there is nothing else to do in either case.
        let _ = self.ended.recv_timeout(2 * PATIENCE);
    }
}

fn picture<S: Spectrum>(film: &Film<S>) -> Picture {
    Picture {
        resolution: film.resolution(),
        values: film.mean().iter().map(|&value| value as f32).collect(),
    }
}

/// The thread's side.
struct Viewer {
    address: String,
    name: String,
    channels: &'static [&'static str],
    client: Option<TevClient>,
}

impl Viewer {
    fn run(mut self, queue: &Receiver<Picture>, say: &impl Fn(&str)) {
        let mut silent = false;
        for picture in queue {
            let sent = self.send(&picture);
            if let (Err(e), false) = (&sent, silent) {
                let why = match e.kind() {
                    io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => {
                        "it takes no data".into()
                    }
                    _ => e.to_string(),
                };
                let address = &self.address;
                say(&format!(
                    "note: no preview from tev at {address}: {why}; still trying"
                ));
            }
            silent = sent.is_err();
            if silent {
                self.client = None;
            }
        }
    }

    fn send(&mut self, picture: &Picture) -> io::Result<()> {
        if self.client.is_none() {
            self.client = Some(self.connect(picture.resolution)?);
        }
        let Some(client) = &mut self.client else {
            return Ok(());
        };
        let [width, _] = picture.resolution;
        let count = self.channels.len();
        let rows = (PIXELS / width as usize).max(1);
        let offsets: Vec<u64> = (0..count as u64).collect();
        for (i, band) in picture
            .values
            .chunks(rows * width as usize * count)
            .enumerate()
        {
            client.send(PacketUpdateImage {
                image_name: &self.name,
                grab_focus: false,
                channel_names: self.channels,
                channel_offsets: &offsets,
                channel_strides: &vec![count as u64; count],
                x: 0,
                y: (i * rows) as u32,
                width,
                height: (band.len() / (width as usize * count)) as u32,
                data: band,
            })?;
        }
        Ok(())
    }

    fn connect(&self, [width, height]: [u32; 2]) -> io::Result<TevClient> {
        let mut addresses = self.address.to_socket_addrs()?;
        let mut socket = Err(io::Error::other("the host has no address"));
        while let (Err(_), Some(address)) = (&socket, addresses.next()) {
            socket = TcpStream::connect_timeout(&address, PATIENCE);
        }
        let socket = socket?;
        socket.set_write_timeout(Some(PATIENCE))?;
        let mut client = TevClient::wrap(socket);
        client.send(PacketCreateImage {
            image_name: &self.name,
            grab_focus: true,
            width,
            height,
            channel_names: self.channels,
        })?;
        Ok(client)
    }
}
