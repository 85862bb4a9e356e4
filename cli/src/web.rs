//! `asperity web [-o DIR] [--open]`: the page on which anybody strokes a texture and hears it.
//!
//! The page is static: any host serves what `-o` writes. `--open` serves it from the program
//! itself, on the loopback address only, because browsers run no engine from a file. Its files are
//! put into the program when that is built with the feature `web`, from where `bindings/web/build`
//! has staged them.

use crate::error::CliError;
use clap::Args;
use std::path::PathBuf;

/// Write the page on which textures are stroked and heard in a browser, or serve it on this machine
#[derive(Debug, Args)]
pub struct Options {
    /// Folder to write the page to; any static host serves it
    #[arg(short, long = "output", value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Serve the page on the loopback address, until the program is ended, and show it in a browser
    /// (what BROWSER names, or else the system's); without it and without -o it is served only
    #[arg(long)]
    pub open: bool,
    /// Port to serve on; 0 = one that is free
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub port: u16,
}

/// Name and content of each file, staged by `bindings/web/build`.
#[cfg(feature = "web")]
const PAGE: &[(&str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/page.rs"));
#[cfg(not(feature = "web"))]
const PAGE: &[(&str, &[u8])] = &[];

/// Runs the verb.
///
/// # Errors
/// When the program was built without the page, the folder cannot be written, or the port is taken.
pub fn run(options: &Options) -> Result<(), CliError> {
    if PAGE.is_empty() {
        return Err(CliError::new(
            "asperity web",
            "this program was built without the page",
            "run bindings/web/build, then cargo build --release -p asperity-cli --features web",
        ));
    }
    carried::run(options)
}

#[cfg(not(feature = "web"))]
mod carried {
    use super::{CliError, Options};

    /// There is no page, and that was said.
    pub fn run(_: &Options) -> Result<(), CliError> {
        Ok(())
    }
}

#[cfg(feature = "web")]
mod carried {
    use super::{CliError, Options, PAGE};
    use crate::answer::{WORDS, answer};
    use crate::output::{self, Outputs};
    use std::path::Path;
    use std::process::{Command, Stdio};
    use std::{env, fs, thread};
    use tiny_http::{Method, Request, Server};

    pub fn run(options: &Options) -> Result<(), CliError> {
        if let Some(folder) = &options.output {
            write(folder)?;
        }
        if options.open || options.output.is_none() {
            serve(options.port, options.open)?;
        }
        Ok(())
    }

    fn write(folder: &Path) -> Result<(), CliError> {
        fs::create_dir_all(folder).map_err(|error| CliError::write(folder, &error))?;
        let mut outputs = Outputs::new();
        for (name, content) in PAGE {
            outputs.write(&folder.join(name), content)?;
        }
        outputs.commit()?;
        output::say(&format!("wrote {}", folder.join("index.html").display()));
        Ok(())
    }

    fn serve(port: u16, shown: bool) -> Result<(), CliError> {
        let server = Server::http(("127.0.0.1", port)).map_err(|error| {
            CliError::new("--port", format!("{port} cannot be served on ({error})"), "give another one, or 0")
        })?;
        let address = format!("http://{}/", server.server_addr());
        output::say(&format!("serving {address} until ended (Ctrl-C)"));
        if shown && let Err(reason) = show(&address) {
            output::say(&format!("{reason}: open the address in a browser"));
        }
        for request in server.incoming_requests() {
            respond(request);
        }
        Ok(())
    }

    /// Shows an address in a browser, which goes on by itself; or says why not.
    fn show(address: &str) -> Result<(), String> {
        let variable = |name| env::var(name).ok().filter(|value| !value.is_empty());
        let program = match (variable("BROWSER"), env::consts::OS) {
            (Some(program), _) => program,
            (None, "macos") => "open".to_owned(),
            (None, "windows") => "explorer".to_owned(),
            _ if variable("DISPLAY").or_else(|| variable("WAYLAND_DISPLAY")).is_some() => {
                "xdg-open".to_owned()
            }
            _ => return Err("there is no screen here and no BROWSER".to_owned()),
        };
        let silent = || Stdio::null();
        let begun =
            Command::new(&program).arg(address).stdin(silent()).stdout(silent()).stderr(silent()).spawn();
        let mut browser = begun.map_err(|error| format!("{program} cannot be started ({error})"))?;
        // A starter that has done its work is not kept as a dead process.
        thread::spawn(move || browser.wait());
        Ok(())
    }

    fn respond(request: Request) {
        let path = request.url().split(['?', '#']).next().unwrap_or_default().trim_start_matches('/');
        let wanted = if path.is_empty() { "index.html" } else { path };
        let file = PAGE.iter().find(|(name, _)| *name == wanted);
        match (request.method(), file) {
            (Method::Get | Method::Head, Some((name, content))) => answer(request, 200, kind(name), content),
            (Method::Get | Method::Head, None) => answer(request, 404, WORDS, b"no such file"),
            _ => answer(request, 405, WORDS, b"only GET"),
        }
    }

    /// Media type of a file, by its ending; browsers insist on it for scripts and engines.
    fn kind(name: &str) -> &'static str {
        match name.rsplit_once('.').map_or("", |(_, ending)| ending) {
            "html" => "text/html; charset=utf-8",
            "js" => "text/javascript; charset=utf-8",
            "css" => "text/css; charset=utf-8",
            "wasm" => "application/wasm",
            _ => "application/octet-stream",
        }
    }
}
