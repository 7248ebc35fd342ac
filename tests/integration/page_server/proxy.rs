//! The page through what lies between it and a browser on another machine: a tunnel, and servers before it.

use std::io::{Read, Write, copy};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::thread;

use super::client::{Shown, Socket, rest};
use crate::support::text;

/// Passes connections on to a port, each with the head of its request changed. Returns its own port.
fn proxy(to: u16, change: impl Fn(String) -> String + Send + 'static) -> u16 {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a port");
    let port = listener.local_addr().expect("an address").port();
    thread::spawn(move || {
        for stream in listener.incoming() {
            let mut client = stream.expect("a connection");
            let mut server = TcpStream::connect((Ipv4Addr::LOCALHOST, to)).expect("a connection");
            let mut head = Vec::new();
            while !head.ends_with(b"\r\n\r\n") {
                let mut byte = [0];
                client.read_exact(&mut byte).expect("a head");
                head.extend(byte);
            }
            server.write_all(change(text(&head).to_owned()).as_bytes()).expect("a connection");
            let [mut asks, mut answers] =
                [&client, &server].map(|stream| stream.try_clone().expect("a connection"));
            thread::spawn(move || copy(&mut asks, &mut server));
            thread::spawn(move || {
                let _ = copy(&mut answers, &mut client);
                client.shutdown(Shutdown::Both)
            });
        }
    });
    port
}

/// What a browser on another machine asks for: a host, a path above that of the page, and the origin of the page.
type Asked = [String; 3];

/// The answers to a browser at a port: the page, and what its WebSocket begins with, or the answer in place of one.
fn browse(port: u16, [host, above, origin]: &Asked, token: &str) -> [String; 2] {
    let connect = || TcpStream::connect((Ipv4Addr::LOCALHOST, port)).expect("a connection");
    let mut stream = connect();
    let request = format!("GET {above}/{token}/ HTTP/1.1\r\nHost: {host}\r\n\r\n");
    stream.write_all(request.as_bytes()).expect("a connection");
    let page = rest(&mut stream);
    let socket = Socket::open(connect(), &format!("{above}/{token}/"), host, origin);
    [page, socket.map_or_else(|answer| answer, |mut socket| socket.next("state").to_string())]
}

#[test]
fn a_tunnel_and_servers_before_the_page_lead_to_it() {
    let usual = Shown::begin();
    let allowed = Shown::begin_with(|command| {
        command.args(["--no-open", "--allow-origin", "https://Pages.example:443/"])
    });
    let asked = |words: [&str; 3]| words.map(str::to_owned);
    let as_it_is = |shown: &Shown| proxy(shown.port, |head| head);
    // As many servers pass requests on: under the name by which they know the page.
    let renamed = |shown: &Shown| {
        let host = format!("Host: 127.0.0.1:{}", shown.port);
        proxy(shown.port, move |head| head.replace("Host: pages.example", &host))
    };
    let tunnel = as_it_is(&usual);
    let own = format!("localhost:{tunnel}");
    let through_tunnel = [own.clone(), String::new(), format!("http://{own}")];
    let secure = asked(["localhost", "", "https://localhost"]);
    let path = asked(["localhost", "/below", "http://localhost"]);
    let below = proxy(usual.port, |head| head.replacen("/below/", "/", 1));
    let foreign = asked(["pages.example", "", "https://pages.example"]);
    let other_port = asked(["pages.example:81", "", "https://pages.example:81"]);
    let plain = asked(["pages.example", "", "http://pages.example"]);
    for (what, port, asked, shown, let_in) in [
        ("a tunnel", tunnel, &through_tunnel, &usual, [true; 2]),
        ("a server that takes encryption off", as_it_is(&usual), &secure, &usual, [true; 2]),
        ("a server with the page below a path", below, &path, &usual, [true; 2]),
        ("a server that is allowed", as_it_is(&allowed), &foreign, &allowed, [true; 2]),
        ("one that hides its name", renamed(&allowed), &foreign, &allowed, [true; 2]),
        ("one of its name at another port", as_it_is(&allowed), &other_port, &allowed, [false; 2]),
        ("one of its name without encryption", as_it_is(&allowed), &plain, &allowed, [true, false]),
        ("a server that is not allowed", as_it_is(&usual), &foreign, &usual, [false; 2]),
        ("one that hides its name", renamed(&usual), &foreign, &usual, [true, false]),
    ] {
        let answers = browse(port, asked, &shown.token);
        for ((answer, is_let_in), begin) in answers.iter().zip(let_in).zip(["HTTP/1.1 200 ", "{"]) {
            let begin = if is_let_in { begin } else { "HTTP/1.1 403 " };
            assert!(answer.starts_with(begin), "{what}: {answer}");
            assert!(is_let_in || answer.contains("--allow-origin https://"), "{what}: {answer}");
        }
    }
}
