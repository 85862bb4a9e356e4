//! `render --plot`: what happened, at a glance.
//!
//! From top to bottom: the finger's speed and force; the surface as it passed below with the pad on
//! it; the impulses sent to the body; the busiest instant enlarged ([`zoom`]); surfaces from above
//! ([`ground`]); and both outputs as waves and spectra ([`outputs`]).

mod ground;
mod outputs;
mod zoom;

use asperity::Wrap;
use asperity_plot::{Axis, Figure, Layer, Panel, Series, palette};
use asperity_surface::raster::Raster;
use ground::ground_panel;
use outputs::{audio_rows, haptic_rows};
use zoom::zoom_panels;

/// Contacts drawn one by one; more would cover each other.
pub const DRAWN_CONTACTS: usize = 8;
/// Letters that a legend has room for beside the title, and how many a swatch takes; where names
/// need more, numbers stand there.
const MOST_LETTERS: usize = 126;
const LEGEND_LETTERS: usize = 6;
/// Momentum in a sample that is none: a thousandth of what the lightest stroke sends.
const NO_IMPULSE_N_S: f64 = 1e-11;
/// Surfaces from above in a row of the picture.
const GROUNDS_A_ROW: usize = 4;
/// Between two reports of most games, s.
const REPORT_S: f64 = 1.0 / 60.0;

/// Samples of one contact.
#[derive(Debug, Clone, Default)]
pub struct ContactCurve {
    /// `finger on tiles`.
    pub label: String,
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Duration in samples.
    pub samples: u64,
    /// Profile under the contact, m.
    pub height_m: Vec<f64>,
    /// Pad, m.
    pub pad_m: Vec<f64>,
    /// Tangential speed, m/s.
    pub speed_m_s: Vec<f64>,
    /// Normal force, N.
    pub normal_force_n: Vec<f64>,
    /// Path in texture coordinates, some hundred points a second.
    pub path_uv: Vec<[f64; 2]>,
    /// Times, s, and momenta, N·s, sent to the body.
    pub impulses: Vec<[f64; 2]>,
    /// Times, s, and pad heights, m, of micro-collisions.
    pub collisions: Vec<[f64; 2]>,
}

/// A haptic channel.
#[derive(Debug, Clone)]
pub struct HapticChannel<'a> {
    /// `displacement` or `acceleration`.
    pub quantity: &'a str,
    /// Its unit.
    pub unit: &'a str,
    /// Meaning of sample value 1.
    pub full_scale: f64,
    /// n, where it grows beside the pad's own motion, ∝ Fⁿ.
    pub felt_force_exponent: f64,
    /// The samples.
    pub samples: &'a [f32],
}

/// A surface seen from above.
#[derive(Debug, Clone)]
pub struct Ground {
    /// Headline.
    pub title: String,
    /// Extent along u and v, m.
    pub extent_m: [f64; 2],
    /// Continuation beyond its edges.
    pub wrap: Wrap,
    /// Heights, 0 = lowest, 1 = highest, top row first.
    pub heights: Raster,
    /// Label of the contacts on it ends with this.
    pub surface: String,
}

/// Everything the picture shows.
#[derive(Debug)]
pub struct Take<'a> {
    /// Headline.
    pub title: String,
    /// Lines below it.
    pub summary: Vec<String>,
    /// Rate of both outputs, Hz.
    pub sample_rate_hz: f64,
    /// Audio.
    pub audio: &'a [f32],
    /// Haptics.
    pub haptic: Vec<HapticChannel<'a>>,
    /// Contacts.
    pub contacts: &'a [ContactCurve],
    /// Times of impacts, s.
    pub impacts_s: Vec<f64>,
    /// Surfaces, as far as they can be drawn from above.
    pub grounds: Vec<Ground>,
}

/// Draws the picture.
#[must_use]
pub fn draw(take: &Take<'_>) -> String {
    let mut figure = Figure::new(take.title.clone());
    figure.subtitle.extend(take.summary.iter().cloned());
    if take.contacts.iter().any(|contact| !contact.height_m.is_empty()) {
        // What stands still has no speed to show.
        let slides = highest(take, |contact| &contact.speed_m_s) > 0.0;
        figure.row(
            80.0,
            std::iter::once(force_panel(take)).chain(slides.then(|| speed_panel(take))).collect::<Vec<_>>(),
        );
        figure.row(120.0, [profile_panel(take)]);
        // What bows a body drives it by friction and sends no impulses.
        let strikes = |contact: &ContactCurve| {
            contact.impulses.iter().any(|[_, impulse]| impulse.abs() > NO_IMPULSE_N_S)
        };
        let strikes = take.contacts.iter().any(strikes);
        if strikes {
            figure.row(70.0, [impulse_panel(take)]);
        }
        // Without a collision and without momentum there is nothing to enlarge.
        if strikes || take.contacts.iter().any(|contact| !contact.collisions.is_empty()) {
            figure.row(190.0, zoom_panels(take));
        }
        for row in take.grounds.chunks(GROUNDS_A_ROW).filter(|_| take.grounds.len() > 1) {
            figure.row(130.0, row.iter().map(|ground| ground_panel(take, ground)).collect::<Vec<_>>());
        }
    }
    for (index, channel) in take.haptic.iter().enumerate() {
        if channel.samples.iter().all(|&sample| sample == 0.0) {
            continue;
        }
        haptic_rows(&mut figure, take, index, channel);
    }
    audio_rows(&mut figure, take);
    figure.svg()
}

fn duration_s(take: &Take<'_>) -> f64 {
    take.audio.len() as f64 / take.sample_rate_hz
}

fn time(take: &Take<'_>) -> Axis {
    Axis::new("time", "s").range(0.0, duration_s(take).max(1e-3))
}

fn drawn<'a>(take: &'a Take<'_>) -> impl Iterator<Item = (&'a ContactCurve, &'static str)> {
    take.contacts.iter().take(DRAWN_CONTACTS).zip(palette::SERIES)
}

fn speed_panel(take: &Take<'_>) -> Panel {
    let mut panel = Panel::new(
        "how fast the finger slides",
        time(take),
        Axis::new("speed", "m/s").above_zero(highest(take, |c| &c.speed_m_s)),
    );
    for (contact, colour) in drawn(take) {
        let data = Series::of_reports(&contact.speed_m_s, REPORT_S, take.sample_rate_hz, contact.start_s);
        panel = panel.with(Layer::line("", colour, data));
    }
    panel
}

fn force_panel(take: &Take<'_>) -> Panel {
    let mut panel = Panel::new(
        "how hard it presses",
        time(take),
        Axis::new("force", "N").above_zero(highest(take, |c| &c.normal_force_n)),
    );
    for (contact, colour) in drawn(take) {
        let data =
            Series::signal(contact.normal_force_n.iter().copied(), take.sample_rate_hz, contact.start_s);
        panel = panel.with(Layer::line("", colour, data));
    }
    panel
}

/// The largest value of one curve over the contacts drawn.
fn highest(take: &Take<'_>, values: impl Fn(&ContactCurve) -> &Vec<f64>) -> f64 {
    drawn(take).flat_map(|(contact, _)| values(contact)).copied().fold(0.0, f64::max)
}

/// Text of the legend: the pad where there is one contact, and as much of each name as there is
/// room for where there are more. The colours are those of the force and speed panels above.
fn legend(take: &Take<'_>, contact: &ContactCurve) -> String {
    let letters: usize = drawn(take).map(|(contact, _)| LEGEND_LETTERS + contact.label.chars().count()).sum();
    match take.contacts.len() {
        0 | 1 => "pad".to_owned(),
        _ if letters <= MOST_LETTERS => contact.label.clone(),
        _ => contact.label.split(' ').next().unwrap_or_default().to_owned(),
    }
}

fn profile_panel(take: &Take<'_>) -> Panel {
    let hidden = take.contacts.len().saturating_sub(DRAWN_CONTACTS);
    let title = if hidden > 0 {
        format!("surface and pad (first {DRAWN_CONTACTS} of {} contacts)", take.contacts.len())
    } else {
        "surface and pad".to_owned()
    };
    let mut panel = Panel::new(title, time(take), Axis::new("height", "m"));
    for (index, (contact, colour)) in drawn(take).enumerate() {
        let surface = Series::signal(contact.height_m.iter().copied(), take.sample_rate_hz, contact.start_s);
        let pad = Series::signal(contact.pad_m.iter().copied(), take.sample_rate_hz, contact.start_s);
        let label = if index == 0 { "surface" } else { "" };
        panel = panel.with(Layer::ground(label, surface));
        panel = panel.with(Layer::line(legend(take, contact), colour, pad));
    }
    panel.with(impact_rules(take))
}

fn impact_rules(take: &Take<'_>) -> Layer {
    let label = if take.impacts_s.is_empty() { "" } else { "impact" };
    Layer::Rules { label: label.to_owned(), colour: palette::IMPACT.to_owned(), x: take.impacts_s.clone() }
}

fn impulse_panel(take: &Take<'_>) -> Panel {
    let points: Vec<[f64; 2]> = take
        .contacts
        .iter()
        .flat_map(|contact| contact.impulses.iter().map(|[time, impulse]| [*time, impulse.abs()]))
        .filter(|point| point[1] > 0.0)
        .collect();
    let top = points.iter().map(|point| point[1]).fold(1e-12, f64::max);
    Panel::new(
        "momentum sent to the body",
        time(take),
        Axis::log("impulse", "N·s").range(top * 1e-4, top * 1.5),
    )
    .with(Layer::Stems { label: String::new(), colour: palette::IMPACT.to_owned(), points })
}
