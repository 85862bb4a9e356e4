//! Scenes, a stroke and a body to go with a photograph's maps, so that they render at once.

use crate::scene_log::rounded;
use asperity::files::contact_log::{ContactLog, ContactSample, LogHand, LogLine};
use asperity::{ModalModel, Mode};
use asperity_pictures::from_photo::{HeightCell, PhotoSurface};

/// The generated stroke: speed, m/s, force, N, length, s, and events a second.
const STROKE: (f64, f64, f64, f64) = (0.1, 0.6, 2.0, 60.0);
/// A free bar struck in the middle, 420 Hz: ratios of a uniform bar, decays and levels assumed.
const MODES: [(f64, f64, f64); 4] =
    [(420.0, 9.0, 0.3), (1157.5, 16.0, 0.22), (2269.7, 27.0, 0.15), (3751.9, 41.0, 0.1)];

/// A scene of the whole picture, `factor` times as high as found, that renders at once.
pub(super) fn of_picture(surface: &PhotoSurface, size_m: [f64; 2], factor: f64, full_scale_m: f64) -> String {
    let wrap = if surface.tileable { "repeat" } else { "mirror" };
    let relief_m = surface.relief_m * factor;
    let source = format!(
        "displacement = \"displacement.png\"\nroughness = \"roughness.png\"\nrelief_m = {relief_m:?}\nwrap = \"{wrap}\"\n"
    );
    scene(&source, size_m, surface.micro_relief_m * factor, full_scale_m)
}

/// A scene of the pattern's cell, repeated without end, that renders at once.
pub(super) fn of_cell(
    surface: &PhotoSurface,
    cell: &HeightCell,
    size_m: [f64; 2],
    full_scale_m: f64,
) -> String {
    let source = format!(
        "lattice = {{ cell = \"cell.png\", t1_m = {:?}, t2_m = {:?} }}\nrelief_m = {:?}\nroughness = {:?}\n",
        cell.t1_m,
        cell.t2_m,
        cell.relief_m,
        surface.roughness.mean(),
    );
    scene(&source, size_m, surface.micro_relief_m, full_scale_m)
}

fn scene(source: &str, [width_m, height_m]: [f64; 2], micro_relief_m: f64, full_scale_m: f64) -> String {
    format!(
        "# A stroke over the surface of a photograph.\n\
         contacts = \"stroke.jsonl\"\n\n\
         [[body]]\nname = \"plate\"\nmodes = \"surface.modes.json\"\n\n\
         [[surface]]\nname = \"photo\"\nbody = \"plate\"\n{source}\
         width_m = {width_m:?}\nheight_m = {height_m:?}\nmicro_relief_m = {micro_relief_m:?}\n\n\
         [[actuator]]\noutput = \"displacement\"\nfull_scale = {full_scale_m:?}\n"
    )
}

/// A stroke across the middle, along u.
pub(super) fn stroke([width_m, height_m]: [f64; 2]) -> ContactLog {
    let (speed, force, seconds, rate) = STROKE;
    let samples = (0..(seconds * rate) as usize).map(|step| {
        let t = step as f64 / rate;
        // A slight diagonal, so that a repeated pattern is not met on one line only.
        let uv = [0.05 + speed * t / width_m, 0.45 + 0.05 * speed * t / height_m].map(|x| rounded(x, 9));
        let sample = ContactSample::new(uv, force).sliding([speed, 0.05 * speed]);
        (rounded(t, 6), ContactSample { closing_m_s: if step == 0 { 0.02 } else { 0.0 }, ..sample })
    });
    ContactLog { lines: LogLine::contact(1, ("photo", LogHand::felt_by(0)), samples, seconds) }
}

pub(super) fn modes() -> ModalModel {
    let mode = |(frequency_hz, decay_per_s, amplitude)| Mode {
        frequency_hz,
        decay_per_s,
        amplitude,
        phase_rad: 0.0,
    };
    let (source, modes) = ("assumed: a free bar".to_owned(), MODES.map(mode).to_vec());
    ModalModel { source, impulse_n_s: 0.01, modes, ..ModalModel::silent() }
}
