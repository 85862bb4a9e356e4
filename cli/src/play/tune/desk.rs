//! The page's other end: a few addresses on the loopback address, for nobody but the page.
//!
//! | request | does |
//! |---|---|
//! | `GET /`, `/tune.js`, `/style.css` | the page |
//! | `GET /state` | everything that can be turned, and what plays |
//! | `POST /set` | `{ "path", "key", "value": [numbers] }`; an empty list takes the key out |
//! | `POST /touch` | lines of a contact log, `t` by the page's own clock |
//! | `POST /keep`, `/revert` | writes the file; takes it as it is |
//! | `POST /log` | `true` or `false`: whether the contact log plays |
//! | `POST /end` | ends the program |
//!
//! A request that another page sends is refused: its `Host` or `Origin` is not this address.

use super::Tuned;
use crate::answer::{WORDS, answer, is_ours};
use crate::error::CliError;
use serde::Deserialize;
use serde_json::json;
use std::io::Read;
use tiny_http::{Method, Request, Server};

/// Files of the page, by their addresses.
const PAGE: &[(&str, &str, &str)] = &[
    ("/", "text/html; charset=utf-8", include_str!("page/tune.html")),
    ("/tune.js", "text/javascript; charset=utf-8", include_str!("page/tune.js")),
    ("/style.css", "text/css; charset=utf-8", include_str!("page/style.css")),
];
/// A request is never longer, bytes.
const MOST_BYTES: u64 = 1 << 20;
/// Requests answered before the log is looked at again.
const MOST_AT_ONCE: usize = 64;

/// The page's other end.
pub struct Desk {
    server: Server,
}

#[derive(Deserialize)]
struct Turn {
    path: String,
    key: String,
    value: Vec<f64>,
}

impl Desk {
    /// Listens on a port of the loopback address; 0: one that is free.
    ///
    /// # Errors
    /// When it is taken.
    pub fn open(port: u16) -> Result<Self, CliError> {
        let server = Server::http(("127.0.0.1", port)).map_err(|error| {
            CliError::new("--port", format!("{port} cannot be served on ({error})"), "give another one, or 0")
        })?;
        Ok(Self { server })
    }

    /// Address of the page.
    pub fn address(&self) -> String {
        format!("http://{}/", self.server.server_addr())
    }

    /// Answers what has come in; false when the page ends the program.
    pub fn answer(&self, tuned: &mut Tuned<'_>) -> bool {
        for _ in 0..MOST_AT_ONCE {
            match self.server.try_recv() {
                Ok(Some(request)) => {
                    if !self.one(request, tuned) {
                        return false;
                    }
                }
                _ => return true,
            }
        }
        true
    }

    fn one(&self, mut request: Request, tuned: &mut Tuned<'_>) -> bool {
        let path = request.url().split(['?', '#']).next().unwrap_or_default().to_owned();
        if !is_ours(&self.server, &request) {
            answer(request, 403, WORDS, b"only the page itself is answered");
            return true;
        }
        if *request.method() == Method::Get
            && let Some((_, kind, content)) = PAGE.iter().find(|(name, _, _)| *name == path)
        {
            answer(request, 200, kind, content.as_bytes());
            return true;
        }
        let mut body = String::new();
        let whole = request.as_reader().take(MOST_BYTES).read_to_string(&mut body).is_ok();
        let done = match (request.method(), path.as_str()) {
            _ if !whole => Err(CliError::new("request", "is no text", "send UTF-8")),
            (Method::Get, "/state") => Ok(()),
            (Method::Post, "/set") => set(tuned, &body),
            (Method::Post, "/touch") => tuned.touch(&body),
            (Method::Post, "/keep") => tuned.keep(),
            (Method::Post, "/revert") => tuned.revert(),
            (Method::Post, "/log") => plays(tuned, &body),
            (Method::Post, "/end") => Ok(()),
            _ => {
                answer(request, 404, WORDS, b"no such address");
                return true;
            }
        };
        let (text, status) = match (&done, path.as_str()) {
            (Err(error), _) => (json!({ "error": error.to_string() }), 400),
            (Ok(()), "/touch") => (json!({}), 200),
            (Ok(()), _) => (state(tuned), 200),
        };
        answer(request, status, "application/json", text.to_string().as_bytes());
        path != "/end" || done.is_err()
    }
}

fn set(tuned: &mut Tuned<'_>, body: &str) -> Result<(), CliError> {
    let turn: Turn = serde_json::from_str(body).map_err(|error| {
        CliError::new("request", error, "send { \"path\", \"key\", \"value\": [numbers] }")
    })?;
    tuned.set(&turn.path, &turn.key, &turn.value)
}

fn plays(tuned: &mut Tuned<'_>, body: &str) -> Result<(), CliError> {
    let on =
        serde_json::from_str(body).map_err(|error| CliError::new("request", error, "send true or false"))?;
    tuned.log.plays = on && !tuned.log.lines.lines.is_empty();
    Ok(())
}

/// Contents of the page.
fn state(tuned: &Tuned<'_>) -> serde_json::Value {
    let stats = tuned.scene.stats();
    let surfaces = tuned.file.surfaces.iter();
    json!({
        "scene": tuned.name(),
        "settings": tuned.document.settings(),
        "surfaces": surfaces
            .map(|entry| json!({ "name": entry.name, "width_m": entry.width_m, "height_m": entry.height_m }))
            .collect::<Vec<_>>(),
        "bodies": tuned.file.bodies.iter().map(|entry| &entry.name).collect::<Vec<_>>(),
        "actuators": tuned.file.actuators.len(),
        "heard": tuned.heard,
        "plays": tuned.log.plays,
        "has_log": !tuned.log.lines.lines.is_empty(),
        "changed": tuned.is_changed(),
        "said": tuned.said,
        "position_s": tuned.position_s(),
        "events": stats.events,
        "peak": stats.bus_levels,
        "why_silent": tuned.scene.why_silent().iter().map(ToString::to_string).collect::<Vec<_>>(),
    })
}
