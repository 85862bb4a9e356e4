//! The page that says what each file of the demo is.

use super::bowl;
use super::demo_scene::DemoScene;
use crate::fit;
use crate::modes;
use crate::render::Report;
use asperity_plot::quantity;
use std::fmt::Write;
use std::path::Path;

/// Peak below which a channel is silent: −60 dBFS.
const SILENT: f32 = 1e-3;

/// Description of asperity, in one sentence.
const WHAT: &str = "asperity turns touch into signal: from where a finger or a tool is and how hard it presses, it computes what the \
                    finger feels and what the thing sounds like.";

/// Use of the files, in one paragraph.
const HOW: &str = "NAME.audio.wav is what is heard; NAME.haptic.wav is what a vibration actuator at the fingertip \
                   would play (through headphones it is a low rumble); NAME.svg is a picture of both: the surface \
                   passing under the finger, the pad on it, the impulses sent to the body, and the spectra. \
                   NAME.toml and NAME.jsonl are the scene and the contact log it was made from; change them and \
                   run `asperity render NAME.toml -o NAME --plot` again.";

/// Text about the fit, beside its pictures.
const FIT: &str = "tile_strike.wav is a recorded impact, made by the project (synthetic: a tile in a room, with noise), \
                   fitted as `asperity fit tile_strike.wav -o tile.modes.json --max-modes 32 --plot tile.fit.svg` does. \
                   tile.resynthesis.wav is what the modes alone sound like; the tile of the struck scene plays them. \
                   Do the same with a recording of your own.";

/// Text about the mesh, beside its picture.
const SHAPE: &str = "bowl.obj is a mesh made by the project. `asperity modes bowl.obj --material ceramic --max-modes 12 --shapes-glb -o bowl.modes.json \
                     --plot bowl.shapes.svg` makes the body of the bowl scene of it. Do the same with a mesh of your own.";

/// The bodies that the demo makes before it renders.
pub struct Bodies {
    /// The tile, from its recording.
    pub fitted: fit::Report,
    /// The bowl, from its mesh.
    pub solved: modes::Report,
}

/// Result of the mesh.
fn solved(report: &modes::Report) -> String {
    format!(
        "{} modes from {:.0} to {:.0} Hz, {} unknowns, {:.1} s",
        report.modes, report.lowest_hz, report.highest_hz, report.degrees_of_freedom, report.seconds
    )
}

/// Result of the fit.
fn found(fitted: &fit::Report) -> String {
    format!(
        "{} modes in {:.1} s, {:.0} dB above what they leave",
        fitted.modes, fitted.seconds, fitted.resynthesis_snr_db
    )
}

fn level(report: &Report) -> String {
    quantity(20.0 * f64::from(report.audio_peak).max(1e-10).log10(), "dB")
}

/// Text printed at the end.
#[must_use]
pub fn summary(folder: &Path, scenes: &[DemoScene], reports: &[Report], bodies: &Bodies) -> String {
    let mut text = format!(
        "fitted tile_strike.wav: {}\nsolved bowl.obj: {}\n{} scenes in {}\n\n",
        found(&bodies.fitted),
        solved(&bodies.solved),
        scenes.len(),
        folder.display()
    );
    for (scene, report) in scenes.iter().zip(reports) {
        let _ = writeln!(
            text,
            "  {:<12} {:>6}  {:>4.0}× real time  {}",
            scene.name,
            quantity(report.duration_s, "s"),
            report.real_time_factor,
            scene.title
        );
    }
    let page = folder.join("index.html");
    let _ = write!(
        text,
        "\nOpen {} in a browser to listen and look. Without one: play NAME.audio.wav (heard) and \
         NAME.haptic.wav (felt),\nlook at NAME.svg, and read README.txt for what to notice.",
        page.display()
    );
    text
}

/// `README.txt`.
#[must_use]
pub fn text(scenes: &[DemoScene], reports: &[Report], bodies: &Bodies) -> String {
    let mut text = format!("asperity demo\n=============\n\n{}\n{}\n", wrapped(WHAT), wrapped(HOW));
    let _ = write!(text, "\nThe fit\n-------\n{}{}\n", wrapped(FIT), found(&bodies.fitted));
    let _ = write!(text, "\nThe bowl\n--------\n{}{}\n", wrapped(SHAPE), solved(&bodies.solved));
    for (scene, report) in scenes.iter().zip(reports) {
        let _ = write!(
            text,
            "\n{}: {}\n{}\n{}{} long, {} micro-collisions, {} impacts, audio peak {}\n",
            scene.name,
            scene.title,
            "-".repeat(scene.name.len() + 2 + scene.title.chars().count()),
            wrapped(scene.notice),
            quantity(report.duration_s, "s"),
            report.micro_collisions,
            report.impacts,
            level(report)
        );
    }
    text
}

/// Lines of at most 90 letters.
fn wrapped(text: &str) -> String {
    let mut out = String::new();
    let mut length = 0;
    for word in text.split_whitespace() {
        if length > 0 && length + word.chars().count() + 1 > 90 {
            out.push('\n');
            length = 0;
        } else if length > 0 {
            out.push(' ');
            length += 1;
        }
        out.push_str(word);
        length += word.chars().count();
    }
    out.push('\n');
    out
}

/// `index.html`: players and pictures, no script, no network.
#[must_use]
pub fn html(scenes: &[DemoScene], reports: &[Report], bodies: &Bodies) -> String {
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>asperity demo</title>\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<style>\n\
         body {{ font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 1200px; margin: 2rem auto; padding: 0 1rem }}\n\
         section {{ margin: 3rem 0 }} h2 {{ margin: 0 }} img {{ width: 100%; border: 1px solid #e4e6ea }}\n\
         .players {{ display: flex; flex-wrap: wrap; gap: 1rem; margin: .6rem 0 }}\n\
         label {{ display: flex; align-items: center; gap: .5rem; color: #667 }}\n\
         </style></head><body>\n<h1>asperity demo</h1>\n<p>{WHAT}</p>\n<p>"
    );
    for scene in scenes {
        let _ = write!(page, "<a href=\"#{0}\">{1}</a> · ", scene.name, scene.title);
    }
    page.push_str(
        "<a href=\"#fit\">A recording becomes modes</a> · <a href=\"#shape\">A mesh becomes a body</a> · \
         <a href=\"#files\">The files</a></p>\n",
    );
    for (scene, report) in scenes.iter().zip(reports) {
        let name = scene.name;
        let _ = write!(
            page,
            "<section id=\"{name}\"><h2>{}</h2>\n<p>{}</p>\n<div class=\"players\">\
             {}{}</div>\n\
             <p>{} · {} micro-collisions · {} impacts · audio peak {} · <a href=\"{name}.toml\">scene</a> · \
             <a href=\"{name}.jsonl\">contact log</a></p>\n<img src=\"{name}.svg\" alt=\"profile, pad, impulses and \
             spectra of {name}\"></section>\n",
            scene.title,
            scene.notice,
            player("heard", name, "audio", report.audio_peak),
            player("felt", name, "haptic", report.haptic_peak.iter().copied().fold(0.0, f32::max)),
            quantity(report.duration_s, "s"),
            report.micro_collisions,
            report.impacts,
            level(report)
        );
    }
    let _ = write!(
        page,
        "<section id=\"fit\"><h2>A recording becomes modes</h2>\n<p>{FIT}</p>\n<div class=\"players\">\
         <label>recording <audio controls preload=\"none\" src=\"tile_strike.wav\"></audio></label>\
         <label>its modes <audio controls preload=\"none\" src=\"tile.resynthesis.wav\"></audio></label></div>\n\
         <p>{} · <a href=\"tile.modes.json\">modes</a></p>\n<img src=\"tile.fit.svg\" alt=\"spectrograms of the \
         recording, its resynthesis and the residual\"></section>\n",
        found(&bodies.fitted)
    );
    let _ = write!(
        page,
        "<section id=\"shape\"><h2>A mesh becomes a body</h2>\n<p>{SHAPE}</p>\n<p>{} · <a href=\"{}\">modes</a></p>\n\
         <img src=\"{}\" alt=\"the first shapes of the bowl, its frequencies and how long they ring\"></section>\n",
        solved(&bodies.solved),
        bowl::MODES,
        bowl::PICTURE
    );
    let _ = write!(
        page,
        "<section id=\"files\"><h2>The files</h2>\n<p>{}</p></section>\n</body></html>\n",
        HOW.replace(
            "`asperity render NAME.toml -o NAME --plot`",
            "<code>asperity render NAME.toml -o NAME --plot</code>"
        )
    );
    page
}

/// A player of a channel; nothing where it is silent.
fn player(label: &str, name: &str, kind: &str, peak: f32) -> String {
    if peak < SILENT {
        return String::new();
    }
    format!("<label>{label} <audio controls preload=\"none\" src=\"{name}.{kind}.wav\"></audio></label>")
}
