//! Where the page is served, and under which names it may be asked for.
//!
//! A stranger's site can lead a browser here under a name of its own, which then counts as that site (DNS rebinding). So the
//! `Host` of a request must be a name or an address of this machine, with any port: tunnels have ports of their own. And the
//! `Origin` must be that host. A server that `--allow-origin` names may lead here, too, under its own name and from itself alone.

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, UdpSocket};

use hyper::http::uri::{Authority, PathAndQuery, Uri};

/// Where the page is served.
pub(super) struct Address {
    /// Where the server listens.
    at: SocketAddr,
    /// The host of its address.
    host: String,
    /// The name where it was asked to listen, and the names of this machine in its network.
    name: String,
    machine: Option<String>,
    /// Other servers that lead here.
    origins: Vec<String>,
}

/// An origin of pages: scheme, host and port as browsers write them.
pub(super) fn origin(text: &str) -> Result<String, String> {
    let wrong =
        || "write the address of the other server, such as https://example.org:8443".to_owned();
    let uri: Uri = text.parse().map_err(|_| wrong())?;
    let authority = uri.authority().filter(|authority| is_plain(authority)).ok_or_else(wrong)?;
    let usual = match (uri.scheme_str(), uri.path_and_query().map(PathAndQuery::as_str)) {
        (Some("http"), Some("/")) => 80,
        (Some("https"), Some("/")) => 443,
        _ => return Err(wrong()),
    };
    let port = authority.port_u16().filter(|port| *port != usual);
    let host = with_port(authority.host(), port);
    Ok(format!("{}://{host}", uri.scheme_str().unwrap_or_default()).to_ascii_lowercase())
}

/// Whether this is a host with or without a port, and nothing else that the parser lets pass.
fn is_plain(authority: &Authority) -> bool {
    authority.as_str() == with_port(authority.host(), authority.port_u16())
        && !authority.host().contains('*')
}

fn with_port(host: &str, port: Option<u16>) -> String {
    port.map_or_else(|| host.to_owned(), |port| format!("{host}:{port}"))
}

impl Address {
    /// Listens at a name or an address, and a port; any free one if that is 0.
    ///
    /// # Errors
    /// If the name is unknown, or the port cannot be used.
    pub(super) fn listen(
        name: &str,
        port: u16,
        origins: &[String],
    ) -> io::Result<(TcpListener, Self)> {
        let listener = TcpListener::bind((name, port))?;
        let at = listener.local_addr()?;
        // A name of this machine alone may stand for another address of it, where somebody else listens.
        let is_name = name.parse::<IpAddr>().is_err() && !at.ip().is_loopback();
        let host = if is_name { name.to_owned() } else { written(reached(at.ip())) };
        let (name, origins) = (name.to_owned(), origins.to_vec());
        Ok((listener, Self { at, host, name, machine: machine(), origins }))
    }

    /// The address of the page with this token.
    pub(super) fn url(&self, token: &str) -> String {
        format!("http://{}:{}/{token}/", self.host, self.at.port())
    }

    /// The command that leads from another machine to the page, if nothing else does.
    pub(super) fn tunnel(&self) -> Option<String> {
        let port = self.at.port();
        let machine = self.machine.as_deref().unwrap_or("HOST");
        let leads = self.at.ip().is_loopback();
        leads.then(|| format!("ssh -L {port}:{}:{port} {machine}", self.host))
    }

    /// Whether a request with this `Host` and `Origin`, which reached this machine at its address `here`, is from the page
    /// or from whoever types its address.
    pub(super) fn lets_in(&self, host: &str, origin: Option<&str>, here: IpAddr) -> bool {
        let is_named = || self.origins.iter().any(|named| Some(&**named) == origin);
        let is_host = |origin: &str, host: &str| {
            // With encryption, too, if a server before this one takes it off.
            ["http://", "https://"]
                .into_iter()
                .any(|scheme| origin.strip_prefix(scheme) == Some(host))
        };
        if self.is_own(host, here) {
            return origin.is_none_or(|origin| is_host(origin, host)) || is_named();
        }
        let leads_here =
            self.origins.iter().any(|named| is_host(named, &host.to_ascii_lowercase()));
        leads_here && (origin.is_none() || is_named())
    }

    /// Whether a `Host` is a name or an address of this machine.
    fn is_own(&self, host: &str, here: IpAddr) -> bool {
        let Some(authority) = host.parse::<Authority>().ok().filter(is_plain) else { return false };
        let name = authority.host().trim_matches(['[', ']']).to_ascii_lowercase();
        if let Ok(ip) = name.parse::<IpAddr>() {
            return ip == here || ip.is_loopback() || self.at.ip().is_unspecified();
        }
        // Who answers for names in the network may say that they are here.
        let machine = self.machine.as_deref().filter(|_| !here.is_loopback());
        let is_machine = |machine: &str| [machine, &format!("{machine}.local")].contains(&&*name);
        name == "localhost"
            || name == self.name.to_ascii_lowercase()
            || machine.is_some_and(is_machine)
    }
}

/// The name of this machine in small letters, if it is one that may stand in a command and in an address.
fn machine() -> Option<String> {
    let name = gethostname::gethostname().to_string_lossy().to_ascii_lowercase();
    let is_part = |c: char| c.is_ascii_alphanumeric() || ['-', '.'].contains(&c);
    let is_name =
        name.starts_with(|c: char| c.is_ascii_alphanumeric()) && name.chars().all(is_part);
    is_name.then_some(name)
}

/// An address that leads to a server at `ip`: of a server at all addresses, the one that others see.
fn reached(ip: IpAddr) -> IpAddr {
    let (any, elsewhere): (IpAddr, IpAddr) = match ip {
        // Reserved for documentation; nothing is sent there.
        IpAddr::V4(Ipv4Addr::UNSPECIFIED) => (ip, Ipv4Addr::new(192, 0, 2, 1).into()),
        IpAddr::V6(Ipv6Addr::UNSPECIFIED) => {
            (ip, Ipv6Addr::new(0x2001, 0xdb8, 0, 0, 0, 0, 0, 1).into())
        }
        own => return own,
    };
    let seen = || {
        let socket = UdpSocket::bind((any, 0))?;
        socket.connect((elsewhere, 1))?;
        Ok::<_, io::Error>(socket.local_addr()?.ip())
    };
    seen().unwrap_or(if ip.is_ipv4() {
        Ipv4Addr::LOCALHOST.into()
    } else {
        Ipv6Addr::LOCALHOST.into()
    })
}

/// An address as hosts write it.
fn written(ip: IpAddr) -> String {
    if ip.is_ipv6() { format!("[{ip}]") } else { ip.to_string() }
}
