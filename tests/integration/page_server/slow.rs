//! Slow lines: a proxy that passes so many bytes a second after a delay, and a client that answers as a page does.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::thread;
use std::time::{Duration, Instant};

use crate::support::*;

use super::client::{PING, Shown, Socket, TEXT, frame};

/// Flags of an image, and the length of the head of a part.
const MOVES: u32 = 1;
const WHOLE: u32 = 2;
const LOSSY: u32 = 4;
const HEAD: usize = 24;
const PONG: u8 = 10;
/// The delay of the lines in each direction.
const DELAY: Duration = Duration::from_millis(50);
/// What the lines pass at once: a packet.
const PACKET: usize = 1500;

/// Passes bytes one way until either end is closed: so many a second, after the delay.
fn pass(mut from: TcpStream, mut to: TcpStream, rate: f64) {
    let (sender, receiver) = channel::<(Instant, Vec<u8>)>();
    thread::spawn(move || {
        for (due, bytes) in receiver {
            thread::sleep(due.saturating_duration_since(Instant::now()));
            if to.write_all(&bytes).is_err() {
                break;
            }
        }
        let _ = to.shutdown(std::net::Shutdown::Both);
    });
    let (mut packet, mut free) = ([0; PACKET], Instant::now());
    while let Ok(length @ 1..) = from.read(&mut packet) {
        free = free.max(Instant::now()) + Duration::from_secs_f64(length as f64 / rate);
        thread::sleep(free.saturating_duration_since(Instant::now()));
        if sender.send((free + DELAY, packet[..length].to_vec())).is_err() {
            break;
        }
    }
}

/// A WebSocket on a line of so many bits a second.
fn slow_socket(shown: &Shown, bits: f64) -> Socket {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a port");
    let client = TcpStream::connect(listener.local_addr().expect("it has one")).expect("a line");
    let (near, far) = (listener.accept().expect("it is there").0, shown.connect());
    for stream in [&near, &far, &client] {
        stream.set_nodelay(true).expect("a connection");
        stream.set_read_timeout(Some(Duration::from_secs(60))).expect("a limit");
    }
    let clone = |stream: &TcpStream| stream.try_clone().expect("another handle");
    for (from, to) in [(clone(&near), clone(&far)), (far, near)] {
        thread::spawn(move || pass(from, to, bits / 8.0));
    }
    shown.socket_on(client)
}

/// The next whole image: its size, its flags and its bytes. Parts and pings are answered at once.
fn next_image(socket: &mut Socket) -> ([u32; 2], u32, Vec<u8>) {
    let (mut image, mut message) = (Vec::new(), Vec::new());
    loop {
        let (kind, content) = socket.receive_frame();
        match kind & 15 {
            PING => socket.0.write_all(&frame(PONG, &content)).expect("a connection"),
            TEXT => {}
            _ => message.extend(content),
        }
        if kind & 0x80 == 0 || kind & 15 == PING || kind & 15 == TEXT {
            continue;
        }
        socket.send(r#"{"do":"taken"}"#);
        let number = |at: usize| u32::from_le_bytes(message[at..at + 4].try_into().expect("four"));
        let [width, height, flags, length, from] = [4, 8, 12, 16, 20].map(number);
        image.truncate(from as usize);
        assert_eq!(image.len(), from as usize, "a part is missing");
        image.extend(&message[HEAD..]);
        message.clear();
        if image.len() == length as usize {
            return ([width, height], flags, image);
        }
    }
}

/// Ends the movement, also when the test fails.
struct Ends<'a>(&'a AtomicBool);

impl Drop for Ends<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Orbits for a while on a line of so many bits a second; the images in a second, their mean bytes, and the share of JPEGs.
fn orbited(socket: &mut Socket, seconds: f64) -> [f64; 3] {
    let mut hand = Socket(socket.0.try_clone().expect("another handle"));
    let is_over = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            while !is_over.load(Ordering::Relaxed) {
                hand.send(r#"{"do":"orbit","by":[0.01,0]}"#);
                thread::sleep(Duration::from_millis(30));
            }
        });
        let _ends = Ends(&is_over);
        // Until the line is known, and what was on it has passed.
        let start = Instant::now();
        while start.elapsed() < Duration::from_secs(3) {
            next_image(socket);
        }
        let (start, mut all) = (Instant::now(), Vec::new());
        while start.elapsed().as_secs_f64() < seconds {
            let (_, flags, bytes) = next_image(socket);
            // On a busy machine movements come so late that it rests between them.
            if flags & MOVES == 0 {
                continue;
            }
            assert_ne!(flags & WHOLE, 0, "a part of an image while it moves");
            all.push([1.0, bytes.len() as f64, f64::from(u8::from(flags & LOSSY != 0))]);
        }
        let [count, bytes, lossy] = [0, 1, 2].map(|i| all.iter().map(|row| row[i]).sum::<f64>());
        [count / start.elapsed().as_secs_f64(), bytes / count, lossy / count]
    })
}

/// The image at rest.
fn at_rest(socket: &mut Socket) -> Vec<u8> {
    loop {
        let (size, flags, bytes) = next_image(socket);
        if flags & (MOVES | LOSSY) == 0 && flags & WHOLE != 0 {
            assert_eq!(size, [1024, 768]);
            return bytes;
        }
    }
}

#[test]
fn images_move_on_slow_lines_and_are_exact_at_rest() {
    let scene = repository("scenes/cutouts.json");
    let options = ["--no-open", "--samples", "1"];
    let shown = Shown::begin_sized(&scene, "1024x768", |command| command.args(options));
    // Half of what is asked of a machine that does nothing else.
    for (bits, least) in [(1e6, 1.0), (1e7, 4.0)] {
        let mut slow = slow_socket(&shown, bits);
        let [images, bytes, lossy] = orbited(&mut slow, 4.0);
        println!("{bits} bits a second: {images:.1} images of {bytes:.0} bytes, {lossy:.2} JPEG");
        assert!(images >= least && lossy > 0.5, "{images} images a second, {lossy} of them JPEGs");
        // A rest before the last movement is exact, too.
        while bits == 1e7 && at_rest(&mut slow) != at_rest(&mut shown.socket()) {}
    }
    let [images, _, lossy] = orbited(&mut shown.socket(), 3.0);
    println!("one machine: {images:.1} images a second, {lossy:.2} JPEG");
    assert!(lossy < 0.5, "{lossy} of the images on one machine are JPEGs");
}
