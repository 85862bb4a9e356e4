//! Answers of the servers on the loopback address: each whole, and the last of its connection.
//!
//! A browser keeps half a dozen connections open, and the server has a thread for each as long as
//! it is open. Of two that come at the same moment it may leave one to a thread that is taken
//! already; where connections stay open that one is never heard, and a page waits for a file for
//! ever. So none stays open.

use std::io::{self, Write};
use tiny_http::{Method, Request, Server, StatusCode};

/// Plain words.
pub const WORDS: &str = "text/plain; charset=utf-8";

/// Answers a request; a client that hangs up meanwhile is not missed.
pub fn answer(request: Request, status: u16, kind: &str, body: &[u8]) {
    let is_body_wanted = *request.method() != Method::Head;
    let mut to = request.into_writer();
    let _ = write(&mut to, status, kind, body.len(), if is_body_wanted { body } else { &[] });
}

/// Tests whether a request comes from this machine's own page: its `Host` and `Origin` are this
/// server's.
pub fn is_ours(server: &Server, request: &Request) -> bool {
    let own = server.server_addr().to_string();
    let port = own.rsplit(':').next().unwrap_or_default();
    let hosts = [own.clone(), format!("localhost:{port}")];
    let header = |name: &'static str| {
        let found = request.headers().iter().find(|header| header.field.equiv(name));
        found.map(|header| header.value.as_str().to_owned())
    };
    let is_host = header("Host").is_some_and(|host| hosts.contains(&host));
    let is_origin = header("Origin").is_none_or(|origin| {
        origin.strip_prefix("http://").is_some_and(|host| hosts.iter().any(|own| own == host))
    });
    is_host && is_origin
}

fn write(to: &mut dyn Write, status: u16, kind: &str, bytes: usize, body: &[u8]) -> io::Result<()> {
    let reason = StatusCode(status).default_reason_phrase();
    write!(
        to,
        "HTTP/1.1 {status} {reason}\r\nContent-Type: {kind}\r\nContent-Length: {bytes}\r\nConnection: close\r\n\r\n"
    )?;
    to.write_all(body)?;
    to.flush()
}
