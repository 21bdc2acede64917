//! Who may ask: pages of the lab itself, and whoever names it as it is served. Other sites that a browser is on may not.

use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::header::{self, HeaderMap, HeaderName};
use axum::http::{HeaderValue, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

/// The names under which the lab answers. A name that leads here but is none of them is somebody else's, who has pointed it here
/// so that a browser takes the lab for their site.
#[derive(Clone, Debug)]
pub struct Hosts {
    at: SocketAddr,
}

impl Hosts {
    /// Those of a lab that listens there.
    pub fn of(at: SocketAddr) -> Hosts {
        Hosts { at }
    }

    /// Whether a name with its port, as a URL has it, is one of them.
    fn has(&self, host: &str) -> bool {
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if !port.ends_with(']') => (name, port.parse().ok()),
            _ => (host, Some(80)),
        };
        let address: Option<IpAddr> = name.trim_start_matches('[').trim_end_matches(']').parse().ok();
        let is_here = match address {
            Some(address) => address == self.at.ip() || self.at.ip().is_unspecified() || self.is_loopback(address),
            None => name.eq_ignore_ascii_case("localhost"),
        };
        port == Some(self.at.port()) && is_here
    }

    fn is_loopback(&self, address: IpAddr) -> bool {
        address.is_loopback() && self.at.ip().is_loopback()
    }
}

/// Refuses requests that come from other sites.
pub async fn check(State(hosts): State<Arc<Hosts>>, request: Request, next: Next) -> Response {
    match foreign(&hosts, request.headers(), request.uri().path()) {
        Some(why) => (StatusCode::FORBIDDEN, why).into_response(),
        None => next.run(request).await,
    }
}

/// Why a request is refused, if it is.
fn foreign(hosts: &Hosts, headers: &HeaderMap, path: &str) -> Option<&'static str> {
    let text = |name: HeaderName| headers.get(name).map(|value| value.to_str().unwrap_or_default());
    if !text(header::HOST).is_some_and(|host| hosts.has(host)) {
        return Some("refused: the lab has another name; ask for it by the address that it was started with\n");
    }
    let origin = text(header::ORIGIN);
    if origin.is_some_and(|origin| !origin.strip_prefix("http://").is_some_and(|host| hosts.has(host))) {
        return Some("refused: another site may not ask the lab for anything\n");
    }
    // A link on another page may lead to the lab, and to nothing behind it.
    let from = text(HeaderName::from_static("sec-fetch-site"));
    if path != "/" && from.is_some_and(|from| matches!(from, "cross-site" | "same-site")) {
        return Some("refused: another site may lead to the lab's page alone\n");
    }
    None
}

/// What browsers are to hold to: the page takes nothing from elsewhere, and stands in no other site's.
const RULES: [(HeaderName, &str); 6] = [
    (
        header::CONTENT_SECURITY_POLICY,
        "default-src 'self'; img-src 'self' data:; style-src 'self' 'unsafe-inline'; base-uri 'none'; form-action 'none'; \
         frame-ancestors 'self'",
    ),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::CACHE_CONTROL, "no-store"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
];

/// Tells browsers what to hold to.
pub async fn tell_browsers(request: Request, next: Next) -> Response {
    let mut response = next.run(request).await;
    let headers = response.headers_mut();
    for (name, value) in RULES {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hosts(at: &str) -> Hosts {
        Hosts::of(at.parse().unwrap())
    }

    #[test]
    fn a_lab_on_loopback_answers_to_its_own_names_alone() {
        let own = hosts("127.0.0.1:1989");
        assert!(["127.0.0.1:1989", "localhost:1989", "LOCALHOST:1989", "[::1]:1989"].iter().all(|host| own.has(host)));
        let others =
            ["127.0.0.1", "127.0.0.1:80", "localhost", "example.org:1989", "192.168.1.9:1989", "", ":1989", "[::1]"];
        assert!(others.iter().all(|host| !own.has(host)), "{others:?}");
        assert!(hosts("127.0.0.1:80").has("localhost"));
    }

    #[test]
    fn a_lab_on_a_network_answers_to_addresses_and_to_no_names() {
        let own = hosts("0.0.0.0:1989");
        assert!(own.has("192.168.1.9:1989") && own.has("localhost:1989") && !own.has("example.org:1989"));
        let own = hosts("192.168.1.9:1989");
        assert!(own.has("192.168.1.9:1989") && !own.has("192.168.1.8:1989"));
    }
}
