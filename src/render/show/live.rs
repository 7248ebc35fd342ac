//! Shows the image in the viewer tev while it is rendered.
//!
//! A separate thread sends finished tiles over TCP. No rendering thread waits for the viewer: one
//! that is gone or no longer reads is abandoned.

use std::net::{TcpStream, ToSocketAddrs};
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::tile::Tile;

/// Timeout of a viewer, for answers and for sent data.
const PATIENCE: Duration = Duration::from_secs(5);

const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// A finished tile, within the shown image.
struct TilePixels {
    tile: Tile,
    values: Vec<f32>,
}

/// A connection to a viewer.
pub(super) struct Live {
    window: Tile,
    parts: Sender<TilePixels>,
    /// Receives the outcome once everything is sent, or nothing can be.
    end: Mutex<Receiver<Option<Error>>>,
}

impl Live {
    /// Connects to the viewer at `address` and creates a black image called `name`.
    ///
    /// # Errors
    /// If there is none, or it does not accept the image.
    pub(super) fn connect(address: &str, name: &str, window: Tile) -> Result<Self> {
        let cannot = |cause: std::io::Error| {
            let message = format!("cannot reach the viewer: {cause}");
            let error = Error::new(ErrorKind::Io, message).in_file(address).because(cause);
            error.remedy("start tev first; the render continues without it")
        };
        let mut client = open(address).map_err(cannot)?;
        // A zero ends a name in the protocol.
        let name = name.replace('\0', " ");
        let Tile { width, height, .. } = window;
        let image = PacketCreateImage {
            image_name: &name,
            grab_focus: true,
            width,
            height,
            channel_names: &CHANNELS,
        };
        client.send(image).map_err(cannot)?;
        let (parts, to_send) = mpsc::channel();
        let (ended, end) = mpsc::channel();
        let sender = std::thread::Builder::new().spawn(move || {
            let failed = send_all(&mut client, &name, &to_send).err();
            // The receiver may be gone.
            let _ = ended.send(failed.map(lost));
        });
        sender.map_err(cannot)?;
        Ok(Self { window, parts, end: Mutex::new(end) })
    }

    /// Queues a tile to be sent.
    pub(super) fn send(&self, tile: &Tile, pixels: &[[f32; 3]]) {
        let (x, y) = (tile.x - self.window.x, tile.y - self.window.y);
        let part =
            TilePixels { tile: Tile { x, y, ..*tile }, values: pixels.as_flattened().to_vec() };
        // Without a viewer the tile is dropped.
        let _ = self.parts.send(part);
    }

    /// Waits briefly for the last tiles to be sent; returns the error, if any.
    pub(super) fn finish(self) -> Option<Error> {
        let Self { parts, end, .. } = self;
        drop(parts);
        let end = end.into_inner().unwrap_or_else(PoisonError::into_inner);
        end.recv_timeout(PATIENCE)
            .unwrap_or_else(|_| Some(lost(std::io::ErrorKind::TimedOut.into())))
    }
}

fn open(address: &str) -> std::io::Result<TevClient> {
    let mut failed = std::io::Error::from(std::io::ErrorKind::NotFound);
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, PATIENCE) {
            Ok(stream) => {
                stream.set_write_timeout(Some(PATIENCE))?;
                return Ok(TevClient::wrap(stream));
            }
            Err(error) => failed = error,
        }
    }
    Err(failed)
}

/// Sends the parts until there are no more.
fn send_all(
    client: &mut TevClient,
    name: &str,
    parts: &Receiver<TilePixels>,
) -> std::io::Result<()> {
    for TilePixels { tile: Tile { x, y, width, height }, values } in parts {
        client.send(PacketUpdateImage {
            image_name: name,
            grab_focus: false,
            channel_names: &CHANNELS,
            channel_offsets: &[0, 1, 2],
            channel_strides: &[3, 3, 3],
            x,
            y,
            width,
            height,
            data: &values,
        })?;
    }
    Ok(())
}

fn lost(cause: std::io::Error) -> Error {
    Error::new(ErrorKind::Io, format!("lost the viewer: {cause}"))
        .remedy("the image is not affected")
        .because(cause)
}
