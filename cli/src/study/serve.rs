//! The page's other end: its files, and answers that are saved as they come.
//!
//! | request | does |
//! |---|---|
//! | `GET /`, `/stimuli/…` | the page |
//! | `GET /answers` | says that answers are saved |
//! | `POST /answers/PARTICIPANT` | replaces that participant's CSV by a longer one that begins alike |

use crate::answer::{WORDS, answer, is_ours};
use crate::error::CliError;
use crate::output::{self, Outputs, ensure_folder};
use std::fs;
use std::io::Read;
use std::path::Path;
use tiny_http::{Method, Request, Server};

/// A participant's answers are never longer, bytes.
const MOST_BYTES: u64 = 4 << 20;
/// Longest name of a participant.
const LONGEST: usize = 32;

/// Serves a page's folder on the loopback address until the program is ended.
///
/// # Errors
/// When the port is taken, or there can be no folder for answers.
pub fn serve(folder: &Path, port: u16) -> Result<(), CliError> {
    ensure_folder(&folder.join("answers"))?;
    let server = Server::http(("127.0.0.1", port)).map_err(|error| {
        CliError::new("--port", format!("{port} cannot be served on ({error})"), "give another one, or 0")
    })?;
    output::say(&format!("serving http://{}/ until ended (Ctrl-C)", server.server_addr()));
    for request in server.incoming_requests() {
        respond(&server, folder, request);
    }
    Ok(())
}

fn respond(server: &Server, folder: &Path, mut request: Request) {
    let path = request.url().split(['?', '#']).next().unwrap_or_default().trim_start_matches('/').to_owned();
    if !is_ours(server, &request) {
        return answer(request, 403, WORDS, b"only the page itself is answered");
    }
    match (request.method(), path.strip_prefix("answers/")) {
        (Method::Post, Some(participant)) => {
            let participant = participant.to_owned();
            let mut text = String::new();
            let read = request.as_reader().take(MOST_BYTES).read_to_string(&mut text);
            match read
                .map_err(|_| "answers are UTF-8".to_owned())
                .and_then(|_| keep(folder, &participant, &text))
            {
                Ok(()) => answer(request, 200, WORDS, b"saved"),
                Err(reason) => answer(request, 409, WORDS, reason.as_bytes()),
            }
        }
        (Method::Get, None) if path == "answers" => answer(request, 200, WORDS, b"asperity study"),
        (Method::Get | Method::Head, None) => match file(folder, &path) {
            Some((kind, content)) => answer(request, 200, kind, &content),
            None => answer(request, 404, WORDS, b"no such file"),
        },
        _ => answer(request, 405, WORDS, b"only GET, and POST of answers"),
    }
}

/// A file of the page: the page itself, or one of its stimuli.
fn file(folder: &Path, path: &str) -> Option<(&'static str, Vec<u8>)> {
    let name = if path.is_empty() { "index.html" } else { path };
    let plain = |name: &str| !name.is_empty() && !name.contains(['/', '\\']) && !name.starts_with('.');
    if name != "index.html" && !name.strip_prefix("stimuli/").is_some_and(plain) {
        return None;
    }
    let kind = match name.rsplit_once('.').map_or("", |(_, ending)| ending) {
        "html" => "text/html; charset=utf-8",
        "wav" => "audio/wav",
        "png" => "image/png",
        "jpg" | "jpeg" => "image/jpeg",
        _ => "application/octet-stream",
    };
    fs::read(folder.join(name)).ok().map(|content| (kind, content))
}

/// Saves a participant's answers; what was saved is never lost to a shorter or another text.
fn keep(folder: &Path, participant: &str, text: &str) -> Result<(), String> {
    let is_plain = participant.chars().all(|c| c.is_ascii_alphanumeric() || c == '-');
    if !is_plain || participant.is_empty() || participant.len() > LONGEST {
        return Err("a participant is 1 to 32 letters, digits and hyphens".to_owned());
    }
    if !text.starts_with(super::analyse::HEADER) {
        return Err("no answers of this page".to_owned());
    }
    let path = folder.join("answers").join(format!("{participant}.csv"));
    let before = fs::read_to_string(&path).unwrap_or_default();
    if !text.starts_with(&before) {
        return Err("other answers of this participant are saved already".to_owned());
    }
    let mut outputs = Outputs::new();
    outputs
        .write(&path, text.as_bytes())
        .and_then(|()| outputs.commit())
        .map_err(|error| error.to_string())?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saved_answers_only_grow_and_nothing_outside_the_page_is_given_out() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("answers")).unwrap();
        fs::write(folder.path().join("secret"), "x").unwrap();
        let header = super::super::analyse::HEADER;
        let text = |rows: &str| format!("{header}\n{rows}");
        keep(folder.path(), "p1", &text("a\n")).unwrap();
        keep(folder.path(), "p1", &text("a\nb\n")).unwrap();
        for (who, what) in [
            ("p1", text("a\n")),
            ("p1", text("c\nb\nd\n")),
            ("../p1", text("a\n")),
            ("", text("")),
            ("p2", "x".into()),
        ] {
            assert!(keep(folder.path(), who, &what).is_err(), "{who}: {what}");
        }
        assert_eq!(fs::read_to_string(folder.path().join("answers/p1.csv")).unwrap(), text("a\nb\n"));
        assert_eq!(fs::read_dir(folder.path().join("answers")).unwrap().count(), 1);
        for name in ["secret", "stimuli/../secret", "answers/p1.csv", "/etc/passwd", "stimuli/.x"] {
            assert_eq!(file(folder.path(), name), None, "{name}");
        }
    }
}
