//! Where the page is served, and under which names it may be asked for.
//!
//! A stranger's site can lead a browser here under a name of its own, which then counts as that site (DNS rebinding). So the
//! `Host` of a request must be a name or an address of this machine, with any port: tunnels have ports of their own. And the
//! `Origin` must be that host, or a server that `--allow-origin` names.

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, UdpSocket};

use hyper::http::uri::{Authority, Uri};

/// Where the page is served.
pub(super) struct Address {
    /// Where the server listens.
    at: SocketAddr,
    /// The host of its address: as it was given, if that is a name.
    host: String,
    /// Names of this machine, in small letters.
    names: Vec<String>,
    /// Other servers that lead here.
    origins: Vec<String>,
}

/// An origin of pages: scheme, host and port as browsers write them.
pub(super) fn origin(text: &str) -> Result<String, String> {
    let wrong =
        || "write the address of the other server, such as https://example.org:8443".to_owned();
    let uri: Uri = text.parse().map_err(|_| wrong())?;
    let (Some(scheme), Some(authority), "/") = (uri.scheme_str(), uri.authority(), uri.path())
    else {
        return Err(wrong());
    };
    let usual = match scheme {
        "http" => 80,
        "https" => 443,
        _ => return Err(wrong()),
    };
    let port = authority.port_u16().filter(|port| *port != usual);
    let port = port.map_or(String::new(), |port| format!(":{port}"));
    Ok(format!("{scheme}://{}{port}", authority.host()).to_ascii_lowercase())
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
        let machine = machine();
        let of_origins = origins.iter().filter_map(|origin| origin.parse::<Uri>().ok());
        let names = of_origins.filter_map(|origin| origin.host().map(str::to_owned));
        let own = ["localhost".to_owned(), format!("{machine}.local"), machine, name.to_owned()];
        let names = own.into_iter().chain(names).map(|name| name.to_ascii_lowercase()).collect();
        let is_name = name.parse::<IpAddr>().is_err();
        let host = if is_name { name.to_owned() } else { written(reached(at.ip())) };
        Ok((listener, Self { at, host, names, origins: origins.to_vec() }))
    }

    /// The address of the page with this token.
    pub(super) fn url(&self, token: &str) -> String {
        format!("http://{}:{}/{token}/", self.host, self.at.port())
    }

    /// The command that leads from another machine to the page, if nothing else does.
    pub(super) fn tunnel(&self) -> Option<String> {
        let port = self.at.port();
        let leads = self.at.ip().is_loopback();
        leads.then(|| format!("ssh -L {port}:{}:{port} {}", self.host, machine()))
    }

    /// Whether a `Host` names this machine, which the request reached at its address `here`.
    pub(super) fn is_own(&self, host: &str, here: IpAddr) -> bool {
        let Ok(authority) = host.parse::<Authority>() else { return false };
        let port = authority.port_u16().map_or(String::new(), |port| format!(":{port}"));
        // The parser lets other words pass.
        if host != format!("{}{port}", authority.host()) {
            return false;
        }
        let name = authority.host().trim_matches(['[', ']']);
        match name.parse::<IpAddr>() {
            Ok(ip) => ip == here || ip.is_loopback() || self.at.ip().is_unspecified(),
            Err(_) => self.names.iter().any(|own| own.eq_ignore_ascii_case(name)),
        }
    }

    /// Whether the page at `host`, a name of this machine, has this `Origin`: with encryption, too, if a server before this
    /// one takes it off.
    pub(super) fn is_origin(&self, origin: &str, host: &str) -> bool {
        let is_host = |scheme| origin.strip_prefix(scheme) == Some(host);
        ["http://", "https://"].into_iter().any(is_host) || self.origins.iter().any(|o| o == origin)
    }
}

/// The name of this machine.
fn machine() -> String {
    gethostname::gethostname().to_string_lossy().into_owned()
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
