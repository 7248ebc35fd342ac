//! The server of the page: HTTP and WebSocket on one port, for whoever has the address.
//!
//! The path of every resource starts with a random token; without it nothing is found. Who asks must
//! name this machine ([`address`](super::address)), and the `Origin` of a WebSocket must be the page.
//! Nothing in a request names a file. One thread serves all connections: each that has not asked for anything soon is
//! closed, as are the oldest of a kind when there are too many. A page beyond the most gets a reason and is closed.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::net::IpAddr;
use std::pin::pin;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use futures_util::{FutureExt as _, TryFutureExt as _};
use http_body_util::Full;
use hyper::body::{Body as _, Bytes, Incoming};
use hyper::header::{self, HeaderMap};
use hyper::service::service_fn;
use hyper::{Method, Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use sha1_smol::Sha1;
use tokio::task::AbortHandle;
use tokio::time::{interval, timeout};

use super::address::Address;
use super::exchange::Exchange;
use super::page;
use super::take_away::TakeAway;
use super::talk::{refuse, talk};
use wavecrest_base::lock;

/// The most connections of strangers, and of those that knew the address but are no page; and the most pages.
const MOST_CONNECTIONS: usize = 128;
const MOST_PAGES: usize = 16;
/// How long a connection may take to ask, and to take an answer: then as long as it takes at this many bytes a second.
const ASKING: Duration = Duration::from_secs(3);
const ANSWERING: Duration = Duration::from_secs(60);
const SLOWEST: u64 = 16 << 10;
/// How often the progress of a scene's preparation is sent.
const SHOWING: Duration = Duration::from_millis(100);
/// The longest head of a request, in bytes.
const LONGEST_HEAD: usize = 16 << 10;

/// What is served, to whom.
pub(super) struct Site {
    pub(super) exchange: Arc<Exchange>,
    pub(super) take_away: TakeAway,
    /// Whose turn it is to make a file to save.
    pub(super) turn: Arc<tokio::sync::Mutex<()>>,
    /// The first part of every path.
    pub(super) token: String,
    /// That of an address which leads to the page once: others see it among the arguments of the browser.
    pub(super) once: String,
    /// Until when it leads there; nothing once it has.
    pub(super) leads: Mutex<Option<Instant>>,
    /// Where it is served.
    pub(super) address: Address,
}

impl Site {
    /// What is asked for below the token, if the request, which reached this machine at its address `here`, is from the
    /// page or from whoever types its address.
    fn resource<'r>(
        &self,
        request: &'r Request<Incoming>,
        here: IpAddr,
    ) -> Result<&'r str, StatusCode> {
        let text = |name: header::HeaderName| one(request.headers(), &name);
        let host = text(header::HOST).ok_or(StatusCode::BAD_REQUEST)?;
        let origin = text(header::ORIGIN);
        if origin.is_none() && request.headers().contains_key(header::ORIGIN) {
            return Err(StatusCode::BAD_REQUEST);
        }
        let (token, resource) = request
            .uri()
            .path()
            .strip_prefix('/')
            .and_then(|path| path.split_once('/'))
            .ok_or(StatusCode::NOT_FOUND)?;
        let is_once = token == self.once && resource.is_empty();
        if token != self.token && !is_once {
            return Err(StatusCode::NOT_FOUND);
        }
        // The reason is only for those who know the address: to others nothing is here.
        if !self.address.lets_in(host, origin, here) {
            return Err(StatusCode::FORBIDDEN);
        }
        if request.method() != Method::GET {
            return Err(StatusCode::METHOD_NOT_ALLOWED);
        }
        if is_once {
            let leads = lock(&self.leads).take().is_some_and(|until| Instant::now() < until);
            return if leads { Ok(ONCE) } else { Err(StatusCode::NOT_FOUND) };
        }
        // A page of another site could open a WebSocket, but cannot hide where it is from.
        if resource == SOCKET && origin.is_none() {
            return Err(StatusCode::FORBIDDEN);
        }
        Ok(resource)
    }
}

/// The only header of a name, if it is text.
fn one<'h>(headers: &'h HeaderMap, name: &header::HeaderName) -> Option<&'h str> {
    let mut all = headers.get_all(name).iter();
    let first = all.next()?;
    if all.next().is_some() { None } else { first.to_str().ok() }
}

/// The resource that is a WebSocket, and what stands for the address that leads to the page once.
const SOCKET: &str = "socket";
const ONCE: &str = "once";

/// Tasks of which the oldest end when there are too many.
struct Bounded {
    tasks: Mutex<VecDeque<AbortHandle>>,
    most: usize,
}

impl Bounded {
    fn new(most: usize) -> Self {
        Self { tasks: Mutex::default(), most }
    }

    fn spawn(&self, task: impl Future<Output = ()> + Send + 'static) {
        self.push(tokio::spawn(task).abort_handle());
    }

    /// Takes the task that runs now from others.
    fn take_from(&self, others: &Self) {
        let now = tokio::task::id();
        let mut tasks = lock(&others.tasks);
        let found = tasks.iter().position(|task| task.id() == now);
        if let Some(task) = found.and_then(|at| tasks.remove(at)) {
            self.push(task);
        }
    }

    fn push(&self, task: AbortHandle) {
        let mut tasks = lock(&self.tasks);
        tasks.retain(|task| !task.is_finished());
        tasks.push_back(task);
        let surplus = tasks.len().saturating_sub(self.most);
        tasks.drain(..surplus).for_each(|task| task.abort());
    }

    /// Whether one more would end the oldest.
    fn is_full(&self) -> bool {
        let running = |task: &&AbortHandle| !task.is_finished();
        lock(&self.tasks).iter().filter(running).count() >= self.most
    }

    fn end_oldest(&self) {
        let mut tasks = lock(&self.tasks);
        tasks.pop_front().inspect(AbortHandle::abort);
    }
}

/// What is connected: those that have asked for nothing here yet, those that knew the address, and pages. Each is bounded
/// by itself, so that strangers cannot close a download.
struct Connections {
    strangers: Bounded,
    known: Bounded,
    pages: Bounded,
}

/// Serves `site` on connections of `listener`, until the process ends.
///
/// # Errors
/// If the system allows no server.
pub(super) fn serve(listener: std::net::TcpListener, site: &Arc<Site>) -> std::io::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .max_blocking_threads(2)
        .build()?;
    listener.set_nonblocking(true)?;
    runtime.block_on(async {
        let listener = tokio::net::TcpListener::from_std(listener)?;
        let connections = Arc::new(Connections {
            strangers: Bounded::new(MOST_CONNECTIONS),
            known: Bounded::new(MOST_CONNECTIONS),
            pages: Bounded::new(MOST_PAGES),
        });
        let exchange = Arc::clone(&site.exchange);
        tokio::spawn(async move {
            let mut next = interval(SHOWING);
            loop {
                next.tick().await;
                exchange.send_progress();
            }
        });
        loop {
            match listener.accept().await {
                Ok((stream, _)) => {
                    let _ = stream.set_nodelay(true);
                    let served = connection(stream, Arc::clone(site), Arc::clone(&connections));
                    connections.strangers.spawn(served);
                }
                // Too many files are open, perhaps.
                Err(_) => {
                    connections.strangers.end_oldest();
                    tokio::time::sleep(Duration::from_millis(20)).await;
                }
            }
        }
    })
}

/// Answers the one request of a connection.
async fn connection(stream: tokio::net::TcpStream, site: Arc<Site>, all: Arc<Connections>) {
    let Ok(here) = stream.local_addr() else { return };
    let here = here.ip().to_canonical();
    let length = AtomicU64::new(0);
    let service = service_fn(|request| {
        let answered = answer(request, here, Arc::clone(&site), Arc::clone(&all));
        answered.inspect_ok(|answer| {
            length.store(answer.body().size_hint().lower(), Ordering::Relaxed);
        })
    });
    let mut http = hyper::server::conn::http1::Builder::new();
    http.timer(TokioTimer::new())
        .header_read_timeout(ASKING)
        .keep_alive(false)
        .max_buf_size(LONGEST_HEAD);
    let served = http.serve_connection(TokioIo::new(stream), service).with_upgrades();
    let mut served = pin!(served);
    // A client that goes away or hangs is no error of the server's.
    if timeout(ANSWERING, &mut served).await.is_err() {
        let more = Duration::from_secs(length.load(Ordering::Relaxed) / SLOWEST);
        let _ = timeout(more, served).await;
    }
}

async fn answer(
    mut request: Request<Incoming>,
    here: IpAddr,
    site: Arc<Site>,
    all: Arc<Connections>,
) -> Result<Response<Full<Bytes>>, Infallible> {
    let resource = site.resource(&request, here).map(str::to_owned);
    if resource.is_ok() {
        all.known.take_from(&all.strangers);
    }
    Ok(match resource.as_deref() {
        Ok("") => content("text/html; charset=utf-8", page::HTML.as_str()),
        Ok(ONCE) => {
            // Relative, as a server before this one may have put the page below a path.
            let page = format!("../{}/", site.token);
            let mut moved = content("text/plain; charset=utf-8", Bytes::new());
            *moved.status_mut() = StatusCode::SEE_OTHER;
            moved.headers_mut().extend(page.try_into().ok().map(|page| (header::LOCATION, page)));
            moved
        }
        Ok(SOCKET) => {
            let Some(accepted) = accepted(request.headers()) else {
                return Ok(refused(StatusCode::UPGRADE_REQUIRED));
            };
            let upgrade = hyper::upgrade::on(&mut request);
            if all.pages.is_full() {
                all.known.spawn(async move {
                    let refused = upgrade.and_then(|page| refuse(TokioIo::new(page)).map(Ok));
                    let _ = timeout(ASKING, refused).await;
                });
                return Ok(accepted);
            }
            all.pages.spawn(async move {
                if let Ok(upgraded) = upgrade.await {
                    talk(TokioIo::new(upgraded), &site.exchange).await;
                }
            });
            accepted
        }
        Ok(download) => {
            let download = download.to_owned();
            // One at a time: who does not wait for it any more costs nothing.
            let turn = Arc::clone(&site.turn).lock_owned().await;
            let made = tokio::task::spawn_blocking(move || {
                let _turn = turn;
                site.take_away.get(&download, &site.exchange)
            });
            match made.await.ok().flatten() {
                Some((kind, bytes)) => content(kind, bytes),
                None => refused(StatusCode::NOT_FOUND),
            }
        }
        Err(&StatusCode::FORBIDDEN) => stranger(request.headers()),
        Err(status) => refused(*status),
    })
}

/// The answer to who asks under a strange name, or from a page of another server, with what allows that.
fn stranger(headers: &HeaderMap) -> Response<Full<Bytes>> {
    let told = |name| one(headers, &name).unwrap_or("nothing");
    let [host, origin] = [header::HOST, header::ORIGIN].map(told);
    let words = format!(
        "This is the page of wavecrest view, which is asked for as \"{host}\" (Host) from \"{origin}\" (Origin). \
         That is neither a name of this machine nor the page itself. If another server leads here, add its address to \
         the command: --allow-origin https://example.org\n"
    );
    let mut response = content("text/plain; charset=utf-8", words);
    *response.status_mut() = StatusCode::FORBIDDEN;
    response
}

/// The answer to the handshake of a WebSocket (RFC 6455, section 4.2), if it is one.
fn accepted(headers: &HeaderMap) -> Option<Response<Full<Bytes>>> {
    const GUID: &str = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";
    let is_asked = one(headers, &header::UPGRADE)?.eq_ignore_ascii_case("websocket")
        && one(headers, &header::SEC_WEBSOCKET_VERSION)? == "13";
    let key = Sha1::from(format!("{}{GUID}", one(headers, &header::SEC_WEBSOCKET_KEY)?)).digest();
    let response = Response::builder()
        .status(StatusCode::SWITCHING_PROTOCOLS)
        .header(header::CONNECTION, "Upgrade")
        .header(header::UPGRADE, "websocket")
        .header(header::SEC_WEBSOCKET_ACCEPT, STANDARD.encode(key.bytes()));
    response.body(Full::default()).ok().filter(|_| is_asked)
}

/// A resource, with what a browser is to refuse it.
fn content(kind: &'static str, bytes: impl Into<Bytes>) -> Response<Full<Bytes>> {
    let response = Response::builder()
        .header(header::CONTENT_TYPE, kind)
        .header(header::CONTENT_SECURITY_POLICY, page::POLICY)
        .header(header::CACHE_CONTROL, "no-store")
        .header(header::REFERRER_POLICY, "no-referrer")
        .header(header::X_CONTENT_TYPE_OPTIONS, "nosniff")
        .header(header::X_FRAME_OPTIONS, "DENY");
    response.body(Full::new(bytes.into())).unwrap_or_else(|_| refused(StatusCode::NOT_FOUND))
}

/// A status alone.
fn refused(status: StatusCode) -> Response<Full<Bytes>> {
    let mut response = Response::new(Full::default());
    *response.status_mut() = status;
    response
}
