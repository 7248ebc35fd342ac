//! The connection to one page: what changes on the board is sent, and requests are received.
//!
//! A page gets the next image when it has drawn the last, or a little before where the line is long; what a slow line has no
//! room for waits on the board, where newer messages replace it. Nothing of this keeps from hearing the page: it is there
//! as long as it says anything, however slowly it takes what is sent.

use std::collections::VecDeque;
use std::future::poll_fn;
use std::sync::Arc;
use std::time::Duration;

use futures_util::{Sink, SinkExt, StreamExt};
use hyper::body::Bytes;
use tokio::time::{Instant, interval_at, sleep};
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::protocol::frame::coding::CloseCode;
use tokio_tungstenite::tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};

use super::exchange::{Exchange, Kind, Posted};
use super::line::{LATE, Line};
use super::picture::{Parcel, Picture};
use super::request::Request;

/// How often a page is asked whether it is there, and after which silence it is not.
const PULSE: Duration = Duration::from_secs(5);
const SILENCE: Duration = Duration::from_secs(20);
/// The longest message of a page in bytes, and the most in a pulse.
const LONGEST_MESSAGE: usize = 4096;
const MOST_MESSAGES: u32 = 2000;
/// The reason with which a page beyond the most is closed (at most 123 bytes: RFC 6455, section 5.5): it knows by it that
/// the server is there.
const TOO_MANY: &str = "Too many pages show this scene. This one goes on once another is closed.";

/// Talks until the page is gone, hangs or floods.
pub(super) async fn talk<S>(stream: S, exchange: &Exchange)
where
    S: tokio::io::AsyncRead + tokio::io::AsyncWrite + Unpin,
{
    let config = WebSocketConfig::default()
        // Little at a time, so that a flood of empty frames leaves time for other pages.
        .read_buffer_size(LONGEST_MESSAGE)
        .max_message_size(Some(LONGEST_MESSAGE))
        .max_frame_size(Some(LONGEST_MESSAGE));
    let socket = WebSocketStream::from_raw_socket(stream, Role::Server, Some(config)).await;
    let (mut sink, mut requests) = socket.split();
    let mut board = exchange.board.subscribe();
    let mut page = Page::new();
    let mut pulse = interval_at(Instant::now() + PULSE, PULSE);
    let (mut heard, mut since_pulse) = (Instant::now(), 0);
    // Before anything else, so that nothing else is in the way of the answer.
    page.ping();
    loop {
        if !page.sends {
            let messages = board.borrow_and_update().messages.clone();
            page.offer(messages).await;
        }
        tokio::select! {
            // What has been heard counts before a silence.
            biased;
            request = requests.next() => {
                let Some(Ok(message)) = request else { return };
                (heard, since_pulse) = (Instant::now(), since_pulse + 1);
                if since_pulse > MOST_MESSAGES || message.is_close() {
                    return;
                }
                page.receive(&message, exchange);
            }
            passed = pass_on(&mut sink, &mut page.waiting), if page.sends => {
                if passed.is_err() {
                    return;
                }
                page.sends = false;
            }
            () = sleep(LATE), if page.line.is_full() => {}
            changed = board.changed() => if changed.is_err() { return },
            _ = pulse.tick() => {
                since_pulse = 0;
                if heard.elapsed() > SILENCE {
                    return;
                }
                page.ping();
            }
        }
    }
}

/// Tells a page that it is one too many, and waits until it has heard.
pub(super) async fn refuse<S>(stream: S)
where
    S: tokio::io::AsyncRead + tokio::io::AsyncWrite + Unpin,
{
    let mut socket = WebSocketStream::from_raw_socket(stream, Role::Server, None).await;
    let close = CloseFrame { code: CloseCode::Again, reason: TOO_MANY.into() };
    if socket.close(Some(close)).await.is_ok() {
        while let Some(Ok(_)) = socket.next().await {}
    }
}

/// Passes on what waits. If it is dropped, another call goes on with the rest.
async fn pass_on<S: Sink<Message> + Unpin>(
    sink: &mut S,
    waiting: &mut VecDeque<Message>,
) -> Result<(), S::Error> {
    while !waiting.is_empty() {
        poll_fn(|context| sink.poll_ready_unpin(context)).await?;
        waiting.pop_front().map_or(Ok(()), |message| sink.start_send_unpin(message))?;
    }
    poll_fn(|context| sink.poll_flush_unpin(context)).await
}

/// What is known of a page, and what is on its way there.
struct Page {
    /// The numbers of the last messages of each kind that were sent.
    sent: [u64; Kind::COUNT],
    /// Those of which an image has been sent, exact or not.
    begun: [u64; Kind::COUNT],
    line: Line,
    /// The image of which a part has been sent, with its kind.
    parcel: Option<(usize, Parcel)>,
    /// What is to be sent, and whether the system has not taken all of it.
    waiting: VecDeque<Message>,
    sends: bool,
}

impl Page {
    fn new() -> Self {
        let (sent, line, waiting) = ([0; Kind::COUNT], Line::new(), VecDeque::new());
        Self { sent, begun: sent, line, parcel: None, waiting, sends: false }
    }

    fn ping(&mut self) {
        self.line.ping(Instant::now());
        self.put([Message::Ping(Bytes::new())]);
    }

    fn put(&mut self, messages: impl IntoIterator<Item = Message>) {
        self.waiting.extend(messages);
        self.sends = true;
    }

    /// Takes from the board what the page has not been sent and the line has room for.
    async fn offer(&mut self, board: [(u64, Option<Posted>); Kind::COUNT]) {
        if self.line.is_full() {
            return;
        }
        let mut pictures = Vec::new();
        for (kind, (number, posted)) in board.into_iter().enumerate() {
            let is_new = number != self.sent[kind];
            match posted {
                Some(Posted::Words(words)) if is_new => {
                    self.sent[kind] = number;
                    self.put([Message::Text(words)]);
                }
                Some(Posted::Picture(picture)) if is_new => pictures.push((kind, number, picture)),
                None => drop(self.parcel.take_if(|(of, _)| *of == kind)),
                Some(_) => {}
            }
        }
        if !self.line.has_room() {
            return;
        }
        let is_over = |kind: usize, picture: &Arc<Picture>| {
            let gives_way = |newer| !Arc::ptr_eq(picture, newer) && picture.gives_way(newer);
            pictures.iter().any(|(of, _, newer)| *of == kind && gives_way(newer))
        };
        self.parcel.take_if(|(kind, parcel)| parcel.is_sent() || is_over(*kind, &parcel.picture));
        for (kind, number, picture) in pictures {
            if self.parcel.is_none() {
                let first = self.begun[kind] != number;
                let parcel = self.pack(picture, first).await;
                self.begun[kind] = number;
                if !parcel.as_ref().is_some_and(Parcel::is_preview) {
                    self.sent[kind] = number;
                }
                self.parcel = parcel.map(|parcel| (kind, parcel));
            }
        }
        if let Some((_, parcel)) = &mut self.parcel {
            let (bytes, messages) = parcel.part(self.line.budget());
            self.line.send(bytes, Instant::now());
            self.put(messages);
        }
    }

    /// An image as it is sent on this line, for the `first` time or once more.
    async fn pack(&mut self, picture: Arc<Picture>, first: bool) -> Option<Parcel> {
        if !self.line.is_known() {
            return Some(picture.parcel(None));
        }
        let budget = self.line.budget();
        if picture.is_spared(budget) {
            return None;
        }
        let Some(by) = picture.reduction(budget, self.line.density, first) else {
            return Some(picture.parcel(None));
        };
        // Not among the connections, which would wait.
        let parcel = tokio::task::spawn_blocking(move || picture.parcel(Some(by))).await.ok()?;
        self.line.density = parcel.density().unwrap_or(self.line.density);
        Some(parcel)
    }

    /// Puts a request in the inbox, unless it is about the line. What is none is dropped.
    fn receive(&mut self, message: &Message, exchange: &Exchange) {
        if message.is_pong() {
            self.line.pong(Instant::now());
        }
        let request = message.to_text().ok().and_then(|text| serde_json::from_str(text).ok());
        match request {
            Some(Request::Taken { drawing }) => self.line.taken(drawing, Instant::now()),
            Some(request) => exchange.inbox.put(request),
            None => {}
        }
    }
}
