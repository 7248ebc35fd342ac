//! A client of the page: plain requests, and a WebSocket by hand.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use serde_json::{Value, json};

use crate::support::*;

/// The longest wait for anything: shorter than the silence after which the server closes a WebSocket.
const PATIENCE: Duration = Duration::from_secs(15);
pub(super) const CLOSE: u8 = 8;
pub(super) const PING: u8 = 9;
pub(super) const TEXT: u8 = 1;

/// The command, which shows a page.
pub(super) struct Shown {
    pub(super) process: Child,
    pub(super) port: u16,
    pub(super) token: String,
}

impl Drop for Shown {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Shown {
    /// Shows a small scene, without a browser.
    pub(super) fn begin() -> Self {
        Self::begin_with(|command| command.arg("--no-open"))
    }

    /// Shows it by a command that is changed.
    pub(super) fn begin_with(change: impl FnOnce(&mut Command) -> &mut Command) -> Self {
        Self::begin_of(&repository("scenes/hard/tiny-scene.json"), change)
    }

    /// Shows a file.
    pub(super) fn begin_of(file: &Path, change: impl FnOnce(&mut Command) -> &mut Command) -> Self {
        Self::begin_sized(file, "12x8", change)
    }

    /// Shows a file in a size.
    pub(super) fn begin_sized(
        file: &Path,
        size: &str,
        change: impl FnOnce(&mut Command) -> &mut Command,
    ) -> Self {
        let mut command = wavecrest(&repository(""));
        command.args(["view", "--size", size, "-q"]).arg(file);
        let mut process =
            change(&mut command).stdout(Stdio::piped()).spawn().expect("the command runs");
        let mut line = String::new();
        BufReader::new(process.stdout.take().expect("a pipe")).read_line(&mut line).expect("text");
        let address = line.strip_prefix("http://127.0.0.1:").expect("an address of this machine");
        let (port, path) = address.split_once('/').expect("a path");
        let token = path.strip_suffix("/\n").expect("one part").to_owned();
        Self { process, port: port.parse().expect("a port"), token }
    }

    pub(super) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)).expect("a connection");
        stream.set_read_timeout(Some(PATIENCE)).expect("a limit");
        stream.set_write_timeout(Some(PATIENCE)).expect("a limit");
        stream
    }

    /// The answer to a request: the words in capitals stand for the address.
    pub(super) fn ask(&self, request: &str) -> String {
        let mut stream = self.connect();
        let _ = stream.write_all(self.filled(request).as_bytes());
        rest(&mut stream)
    }

    pub(super) fn filled(&self, request: &str) -> String {
        let request = request.replace("HOST", "127.0.0.1:PORT").replace("TOKEN", &self.token);
        request.replace("PORT", &self.port.to_string())
    }

    /// The page.
    pub(super) fn page(&self) -> String {
        self.ask("GET /TOKEN/ HTTP/1.1\r\nHost: HOST\r\n\r\n")
    }

    pub(super) fn socket(&self) -> Socket {
        self.socket_on(self.connect())
    }

    /// A WebSocket on a connection that leads here.
    pub(super) fn socket_on(&self, stream: TcpStream) -> Socket {
        let [path, host, origin] =
            ["/TOKEN/", "HOST", "http://HOST"].map(|words| self.filled(words));
        Socket::open(stream, &path, &host, &origin).unwrap_or_else(|told| panic!("{told}"))
    }
}

/// A request for a WebSocket after its path, without its origin; the key is that of RFC 6455.
pub(super) const UPGRADE: &str = "socket HTTP/1.1\r\nHost: HOST\r\nConnection: Upgrade\r\n\
    Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";

/// What comes until the end of a connection, however it ends.
pub(super) fn rest(stream: &mut TcpStream) -> String {
    let mut bytes = Vec::new();
    let ended = stream.read_to_end(&mut bytes);
    let kind = ended.map_err(|error| error.kind());
    assert!(!matches!(kind, Err(ErrorKind::WouldBlock | ErrorKind::TimedOut)), "it stays open");
    String::from_utf8_lossy(&bytes).into_owned()
}

/// A WebSocket of the page.
pub(super) struct Socket(pub(super) TcpStream);

/// A frame of a client, with a mask that leaves the bytes as they are.
pub(super) fn frame(kind: u8, content: &[u8]) -> Vec<u8> {
    let length = u16::try_from(content.len()).expect("a small frame");
    let [high, low] = length.to_be_bytes();
    [&[0x80 | kind, 0x80 | 126, high, low, 0, 0, 0, 0], content].concat()
}

impl Socket {
    /// The WebSocket of the page at a path, or the answer in its place.
    pub(super) fn open(
        mut stream: TcpStream,
        path: &str,
        host: &str,
        origin: &str,
    ) -> Result<Self, String> {
        let request = format!("GET {path}{UPGRADE}Origin: {origin}\r\n\r\n");
        stream.write_all(request.replace("HOST", host).as_bytes()).expect("a connection");
        let mut head = Vec::new();
        while !head.ends_with(b"\r\n\r\n") {
            let mut byte = [0];
            stream.read_exact(&mut byte).expect("a head");
            head.extend(byte);
        }
        if !head.starts_with(b"HTTP/1.1 101 ") {
            return Err(text(&head).to_owned() + &rest(&mut stream));
        }
        assert!(text(&head).contains("s3pPLMBiTxaQ9kYGzzhZRbK+xOo="), "{}", text(&head));
        Ok(Self(stream))
    }

    pub(super) fn send(&mut self, request: &str) {
        self.0.write_all(&frame(TEXT, request.as_bytes())).expect("a connection");
    }

    /// The next frame: its first byte, and what it has.
    pub(super) fn receive_frame(&mut self) -> (u8, Vec<u8>) {
        let mut head = [0; 2];
        self.0.read_exact(&mut head).expect("a frame");
        let extended = [0, 2, 8][usize::from(head[1].saturating_sub(125))];
        let mut length = [0; 8];
        self.0.read_exact(&mut length[8 - extended..]).expect("a length");
        let length = if extended > 0 { u64::from_be_bytes(length) } else { head[1].into() };
        let mut content = vec![0; length as usize];
        self.0.read_exact(&mut content).expect("a message");
        (head[0], content)
    }

    /// The next message that is text.
    pub(super) fn receive(&mut self) -> Value {
        loop {
            let (kind, content) = self.receive_frame();
            if kind == 0x80 | TEXT {
                return serde_json::from_slice(&content).expect("JSON");
            }
        }
    }

    /// The next message of a kind.
    pub(super) fn next(&mut self, kind: &str) -> Value {
        std::iter::repeat_with(|| self.receive()).find(|told| told["kind"] == kind).expect("one")
    }

    /// What a probe finds, after all that was asked for before.
    pub(super) fn probe(&mut self, at: [f64; 2]) -> Value {
        self.send(&json!({"do": "probe", "at": at}).to_string());
        loop {
            let told = self.next("probe");
            if told["at"] == json!(at) {
                return told["record"].clone();
            }
        }
    }

    /// Sends until the server closes; returns how many of at most `most` were sent, and what it said last.
    pub(super) fn flood(mut self, frame: &[u8], most: usize) -> (usize, String) {
        let sent = (0..most).take_while(|_| self.0.write_all(frame).is_ok()).count();
        (sent, rest(&mut self.0))
    }
}
