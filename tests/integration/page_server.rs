//! The server of the page that `view` shows: what it refuses, what it bounds, and what does not end it.

mod client;
mod proxy;
mod slow;

use std::io::{Read, Seek, SeekFrom, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use serde_json::json;

use crate::support::*;
use client::{CLOSE, PING, Shown, TEXT, UPGRADE, frame};

/// Statuses, with the requests that get them: method, path and headers.
const REFUSED: &str = "\
404 GET / Host:HOST
404 GET /00000000000000000000000000000000/ Host:HOST
404 GET /TOKEN Host:HOST
404 GET /TOKEN0/ Host:HOST
404 GET //TOKEN/ Host:HOST
404 GET /TOKEN/../ Host:HOST
404 GET /TOKEN/..%2f..%2fetc/passwd Host:HOST
404 GET /TOKEN/tiny-scene.json Host:HOST
405 POST /TOKEN/ Host:HOST
405 HEAD /TOKEN/ Host:HOST
404 POST / Host:HOST
400 GET /TOKEN/
400 GET /TOKEN/ Host:HOST Host:HOST
403 GET /TOKEN/ Host:elsewhere.example:PORT
403 GET /TOKEN/ Host:localhost.elsewhere.example:PORT
403 GET /TOKEN/ Host:elsewhere.example@:PORT
403 GET /TOKEN/ Host:127.0.0.1.elsewhere.example
403 GET /TOKEN/ Host:HOST.elsewhere.example
403 GET /TOKEN/ Host:192.168.0.1:PORT
403 GET /TOKEN/ Host:HOST Origin:null
403 GET /TOKEN/ Host:HOST Origin:http://elsewhere.example
403 GET /TOKEN/ Host:HOST Origin:http://127.0.0.1
403 GET /TOKEN/ Host:elsewhere.example Origin:http://elsewhere.example
403 GET /TOKEN/socket Host:HOST Origin:ftp://HOST
400 GET /TOKEN/ Host:HOST Origin:null Origin:null
404 GET / Host:elsewhere.example
403 GET /TOKEN/ Host:localhost.:PORT
403 GET /TOKEN/ Host:page.localhost:PORT
403 GET /TOKEN/ Host:localhost:99999
403 GET /TOKEN/ Host:0.0.0.0:PORT
403 GET /TOKEN/ Host:
403 GET /TOKEN/ Host::PORT
403 GET /TOKEN/socket Host:HOST Origin:http://localhost:PORT
403 GET /TOKEN/socket Host:HOST
426 GET /TOKEN/socket Host:HOST Origin:http://HOST";

#[test]
fn only_requests_that_know_the_page_are_answered() {
    let shown = Shown::begin();
    let page = shown.page();
    assert!(page.starts_with("HTTP/1.1 200 OK\r\n") && page.contains("<!doctype html>"), "{page}");
    let policy = "content-security-policy: default-src 'none'; connect-src 'self'; ";
    for line in [policy, "frame-ancestors 'none'\r\n", "no-store\r\n", "nosniff\r\n"] {
        assert!(page.contains(line), "{line}");
    }
    let mut socket = shown.socket();
    while socket.next("figures")["halves"][0]["rests"] != true {}
    let image = shown.ask("GET /TOKEN/image.png HTTP/1.1\r\nHost: localhost:PORT\r\n\r\n");
    assert!(image.starts_with("HTTP/1.1 200 ") && image.contains("image/png"), "{image}");
    for refused in REFUSED.lines() {
        let mut words = refused.split(' ');
        let [status, method, path] = [(); 3].map(|()| words.next().expect("a word"));
        let headers: String = words.map(|w| w.replacen(':', ": ", 1) + "\r\n").collect();
        let answer = shown.ask(&format!("{method} {path} HTTP/1.1\r\n{headers}\r\n"));
        assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")), "{refused}: {answer}");
        assert!(!answer.contains("<!doctype"), "{refused}: {answer}");
    }
    let long = format!("GET /TOKEN/ HTTP/1.1\r\nHost: HOST\r\nA: {}\r\n\r\n", "b".repeat(1 << 16));
    assert!(shown.ask(&long).starts_with("HTTP/1.1 431 "));
    for origin in ["", "Origin: null\r\n", "Origin: http://elsewhere.example\r\n"] {
        let answer = shown.ask(&format!("GET /TOKEN/{UPGRADE}{origin}\r\n"));
        assert!(answer.starts_with("HTTP/1.1 403 "), "{origin}: {answer}");
    }
}

#[test]
fn silent_and_endless_connections_keep_nobody_waiting() {
    let shown = Shown::begin();
    let mut socket = shown.socket();
    while socket.next("figures")["halves"][0]["rests"] != true {}
    let image = shown.filled("GET /TOKEN/image.png HTTP/1.1\r\nHost: HOST\r\n\r\n");
    let mut downloads: Vec<TcpStream> = (0..9).map(|_| shown.connect()).collect();
    downloads.iter_mut().for_each(|saved| saved.write_all(image.as_bytes()).expect("a connection"));
    // Until it has begun, the server does not know who asks.
    downloads.iter().for_each(|saved| assert_eq!(saved.peek(&mut [0]).expect("an answer"), 1));
    let silent: Vec<TcpStream> = (0..300).map(|_| shown.connect()).collect();
    let begun = Instant::now();
    assert!(shown.page().starts_with("HTTP/1.1 200 "));
    assert!(begun.elapsed() < Duration::from_secs(2), "{:?}", begun.elapsed());
    assert!(socket.probe([0.5, 0.5]).is_string());
    for saved in &mut downloads {
        let mut status = [0; 13];
        saved.read_exact(&mut status).expect("strangers end no download");
        assert_eq!(text(&status), "HTTP/1.1 200 ");
    }
    drop(silent);

    let mut endless = shown.connect();
    let head = "POST /TOKEN/ HTTP/1.1\r\nHost: HOST\r\nContent-Length: 1000000000\r\n\r\n";
    endless.write_all(shown.filled(head).as_bytes()).expect("a connection");
    let mut status = [0; 13];
    endless.read_exact(&mut status).expect("an answer");
    assert_eq!(text(&status), "HTTP/1.1 405 ");
    let part = [b'a'; 1 << 16];
    let sent = (0..1000).take_while(|_| endless.write_all(&part).is_ok()).count();
    assert!(sent < 500, "{sent} parts of the body were taken");

    let begun = Instant::now();
    assert_eq!(shown.ask("GET /TOKEN/ HTTP/1.1\r\nHo"), "");
    let waited = begun.elapsed().as_secs_f64();
    assert!((1.0..10.0).contains(&waited), "half a request is closed after {waited} s");
    assert!(socket.probe([0.25, 0.5]).is_string());
}

#[test]
fn a_page_that_floods_or_sends_what_is_none_is_closed_and_others_go_on() {
    let shown = Shown::begin();
    let mut socket = shown.socket();
    socket.next("state");
    for (kind, content) in [(TEXT, r#"{"do":"taken"}"#), (TEXT, "{}"), (PING, "")] {
        let (sent, _) = shown.socket().flood(&frame(kind, content.as_bytes()), 1 << 20);
        assert!(sent < 1 << 20, "{content}");
        assert!(socket.probe([0.5, f64::from(kind)]).is_string(), "{content}");
    }
    let unmasked = [0x80 | TEXT, 2, b'{', b'}'];
    for wrong in [&*frame(TEXT, &[b' '; 4097]), &frame(TEXT, b"\xff"), &frame(3, b""), &unmasked] {
        shown.socket().flood(wrong, 1);
    }
    // The longest that is taken, and what is no text.
    let longest = format!("{:4096}", r#"{"do":"taken"}"#);
    socket.send(&longest);
    socket.0.write_all(&frame(2, &[0; 9])).expect("a connection");
    assert!(socket.probe([0.25, 0.5]).is_string());
    assert!(shown.page().starts_with("HTTP/1.1 200 "));
}

/// Those that were there first stay, and another may come once one of them has gone.
#[test]
fn the_page_that_is_one_too_many_is_told_so_and_closed() {
    let shown = Shown::begin();
    let mut pages: Vec<_> = (0..16).map(|_| shown.socket()).collect();
    pages.iter_mut().for_each(|page| drop(page.next("state")));
    for _ in 0..3 {
        let (_, told) = shown.socket().flood(&frame(CLOSE, b""), 1);
        assert!(told.contains("Too many pages show this scene."), "{told}");
    }
    for (page, x) in pages.iter_mut().zip(1..) {
        assert!(page.probe([0.5, 1.0 / f64::from(x)]).is_string(), "page {x}");
    }
    pages.swap_remove(7).flood(&frame(CLOSE, b""), 1);
    shown.socket().next("state");
}

/// Requests that change nothing.
const ODD: &str = r#"{"do":"orbit","by":[NaN,0]}
{"do":"orbit","by":[1e999,0]}
{"do":"orbit","by":[]}
{"do":"walk","by":[1e30,1e308,-1e308]}
{"do":"pan","by":[1e308,1e308]}
{"do":"zoom","at":[1e308,-1e308],"by":1}
{"do":"grab","at":[1e308,1e308]}
{"do":"probe","at":[-1e308,1e308]}
{"do":"set","halves":[]}
{"do":"set","halves":[{}]}
{"do":"show"}"#;

#[test]
fn odd_numbers_change_nothing_and_end_nothing() {
    let shown = Shown::begin();
    let mut socket = shown.socket();
    let first = socket.next("state");
    ODD.lines().for_each(|odd| socket.send(odd));
    socket.send(&"[".repeat(4000));
    socket.send(r#"{"do":"probe","at":[0.5,0.5]}"#);
    loop {
        let told = socket.receive();
        match told["kind"].as_str() {
            Some("state") => assert_eq!(told, first),
            Some("probe") if told["at"] == json!([0.5, 0.5]) => break,
            _ => {}
        }
    }
    // As far as there is anywhere, and nearer than anything is near, in fewer requests than may wait.
    for by in [-1e308, 1e308] {
        for _ in 0..25 {
            socket.send(&json!({"do": "zoom", "at": [0.5, 0.5], "by": by}).to_string());
            socket.send(r#"{"do":"orbit","by":[0,1e308]}"#);
        }
        assert!(socket.probe([0.5, by]).is_string());
    }
    socket.send(r#"{"do":"side","side":"start"}"#);
    while socket.next("state")["camera"] != first["camera"] {}
}

#[test]
#[cfg(unix)]
fn ctrl_c_ends_the_page_without_a_failure() {
    let mut shown = Shown::begin();
    shown.socket().next("state");
    let id = shown.process.id().to_string();
    let sent = std::process::Command::new("kill").args(["-s", "INT", &id]).status();
    assert!(sent.expect("kill runs").success());
    assert!(shown.process.wait().expect("it ends").success());
}

/// At the sky and at the floor: the first view has the same numbers again, and the floor is never passed.
#[test]
fn notches_lead_back_and_not_through_the_floor() {
    let shown = Shown::begin();
    let mut socket = shown.socket();
    let first = socket.next("state")["camera"].take();
    let (sky, floor) = ([0.04, 0.06], [0.54, 0.56]);
    // What is met there after so many movements.
    let mut zoomed = |at: [f64; 2], by: f64| {
        let request = json!({"do": "zoom", "at": at, "by": by}).to_string();
        (0..50).for_each(|_| socket.send(&request));
        // Within the pixel, but at another place each time.
        socket.probe([at[0], at[1] + by / 1000.0]).to_string()
    };
    for by in [1.0, 2.0, -1.0, -2.0] {
        let met = zoomed(sky, by);
        assert!(met.contains("hits nothing"), "{by}: {met}");
    }
    assert_eq!(shown.socket().next("state")["camera"], first);
    for by in [1.0, 2.0, 0.5, 3.0, 0.1] {
        let met = zoomed(floor, by);
        assert!(met.contains("of scene.shapes[0]"), "{by}: {met}");
    }
    assert_ne!(shown.socket().next("state")["camera"], first);
}

/// The file has a triangle at its beginning, and another at its end.
#[test]
fn a_large_file_is_shown_by_its_first_part_until_all_is_read() {
    let folder = folder();
    let path = folder.path().join("large.stl");
    let mut file = std::fs::File::create(&path).expect("a file");
    let count = 3_000_000_u32;
    let triangle = |x: f32| {
        let corners = [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.5]];
        let corners = corners.as_flattened().iter().flat_map(|number| number.to_le_bytes());
        [vec![0; 12], corners.collect(), vec![0; 2]].concat()
    };
    file.write_all(&[&[0; 80], &count.to_le_bytes()[..], &triangle(0.0)].concat()).expect("room");
    file.set_len(84 + 50 * u64::from(count - 1)).expect("a length");
    file.seek(SeekFrom::End(0)).expect("a place");
    file.write_all(&triangle(9.0)).expect("room");
    let shown = Shown::begin_of(&path, |command| command.arg("--no-open"));
    let mut socket = shown.socket();
    let first = socket.next("state")["camera"].take();
    let mut is_told = false;
    loop {
        let message = socket.receive();
        let stage = message["stage"].as_str().unwrap_or_default();
        is_told |= stage.contains("the image shows the first part of the file");
        if message["kind"] == "state" && message["camera"] != first {
            break;
        }
    }
    assert!(is_told);
}

/// What is shown and saved stays what was read.
#[test]
fn a_file_that_changes_or_vanishes_neither_ends_the_page_nor_mixes_in() {
    let folder = folder();
    let file = folder.path().join("scene.json");
    std::fs::copy(repository("scenes/hard/tiny-scene.json"), &file).expect("a copy");
    let shown = Shown::begin_of(&file, |command| command.arg("--no-open"));
    let mut socket = shown.socket();
    let first = socket.next("state")["shown"].take();
    std::fs::write(&file, "{}").expect("a file");
    for (gone, look) in [(false, "depth"), (true, "uv")] {
        if gone {
            std::fs::remove_file(&file).expect("it is there");
        }
        let mut request = first.clone();
        (request["do"], request["look"]) = (json!("show"), json!(look));
        socket.send(&request.to_string());
        while socket.next("state")["shown"]["look"] != look {}
        assert!(socket.probe([0.5, 0.25]).is_string());
    }
}

#[test]
#[cfg(unix)]
fn the_address_among_the_arguments_of_the_browser_leads_to_the_page_once() {
    use std::os::unix::fs::PermissionsExt as _;
    let programs = folder();
    let opener = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
    let script = "#!/bin/sh\necho \"$1\" > \"$0.part\" && mv \"$0.part\" \"$0.given\"\n";
    put(programs.path(), opener, script);
    let program = programs.path().join(opener);
    std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).expect("a program");
    let usual = std::env::var("PATH").expect("folders");
    let shown = Shown::begin_with(|command| {
        command.env("PATH", format!("{}:{usual}", programs.path().display()))
    });
    let given = programs.path().join(format!("{opener}.given"));
    let start = Instant::now();
    while !given.exists() && start.elapsed() < Duration::from_secs(10) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let address = std::fs::read_to_string(&given).expect("the browser is opened");
    let once = address.trim_end().trim_end_matches('/').rsplit('/').next().expect("a part");
    assert!(once.len() == shown.token.len() && once != shown.token, "{address}");
    let ask = || shown.ask(&format!("GET /{once}/ HTTP/1.1\r\nHost: HOST\r\n\r\n"));
    let first = ask();
    let page = format!("location: ../{}/\r\n", shown.token);
    assert!(first.starts_with("HTTP/1.1 303 ") && first.contains(&page), "{first}");
    assert!(first.contains("cache-control: no-store") && first.contains("no-referrer"), "{first}");
    assert!(ask().starts_with("HTTP/1.1 404 "));
}
