//! `render --plot`: what happened, at a glance.
//!
//! From top to bottom: the finger's speed and force; the surface as it passed below with the pad on
//! it; the impulses sent to the body; the busiest instant enlarged; and both outputs as waves and
//! spectra.

use asperity::Wrap;
use asperity_plot::{
    Axis, Figure, Layer, Panel, Picture, Series, SpectrogramOptions, colour, palette, spectrogram,
};
use asperity_surface::raster::Raster;

/// Contacts drawn one by one; more would cover each other.
pub const DRAWN_CONTACTS: usize = 8;
/// Letters that a legend has room for beside the title, and how many a swatch takes; where names
/// need more, numbers stand there.
const MOST_LETTERS: usize = 126;
const LEGEND_LETTERS: usize = 6;
/// Length of the enlarged instant, s.
const ZOOM_S: f64 = 0.03;
/// A curve that moves by less within it is flat, m.
const FLAT_M: f64 = 1e-8;
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

/// Momentum in a sample that is none: a thousandth of what the lightest stroke sends.
const NO_IMPULSE_N_S: f64 = 1e-11;

/// The window with the most collisions, or else the most momentum, on the contact it belongs to.
fn busiest(take: &Take<'_>) -> Option<(usize, f64)> {
    let mut best: Option<(f64, usize, f64)> = None;
    // Only what is drawn was kept in full.
    for (index, contact) in take.contacts.iter().enumerate().filter(|(_, c)| !c.height_m.is_empty()) {
        let collides = !contact.collisions.is_empty();
        let events = if collides { &contact.collisions } else { &contact.impulses };
        let strength = |at: usize| if collides { 1.0 } else { events[at][1].abs() };
        let (mut first, mut sum) = (0, 0.0);
        for last in 0..events.len() {
            sum += strength(last);
            while events[last][0] - events[first][0] > ZOOM_S {
                sum -= strength(first);
                first += 1;
            }
            // The landing itself is an event of its own kind; the stroke is what is to be seen.
            let settled = events[first][0] > contact.start_s + 0.08;
            if settled && best.is_none_or(|(most, _, _)| sum > most) {
                best = Some((sum, index, (events[first][0] + events[last][0]) / 2.0));
            }
        }
    }
    best.map(|(_, index, middle)| (index, middle)).or_else(|| {
        let index = take.contacts.iter().position(|contact| !contact.height_m.is_empty())?;
        let contact = &take.contacts[index];
        Some((index, contact.start_s + contact.height_m.len() as f64 / take.sample_rate_hz / 2.0))
    })
}

fn zoom_panels(take: &Take<'_>) -> Vec<Panel> {
    let Some((index, middle)) = busiest(take) else { return Vec::new() };
    let contact = &take.contacts[index];
    let rate_hz = take.sample_rate_hz;
    let end_s = contact.start_s + contact.height_m.len() as f64 / rate_hz;
    let from_s = (middle - ZOOM_S / 2.0).min(end_s - ZOOM_S).max(contact.start_s);
    let first = ((from_s - contact.start_s) * rate_hz) as usize;
    let last = (first + (ZOOM_S * rate_hz) as usize).min(contact.height_m.len());
    let part = |values: &[f64]| {
        let cut = values.get(first..last).unwrap_or(&[]);
        Series::signal(cut.iter().copied(), rate_hz, contact.start_s + first as f64 / rate_hz)
    };
    let inside = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
        points.iter().filter(|[t, _]| (from_s..from_s + ZOOM_S).contains(t)).copied().collect()
    };
    let collisions = inside(&contact.collisions);
    let label = if collisions.is_empty() { "" } else { "collision" };
    let axis = Axis::new("time", "s").range(from_s, from_s + ZOOM_S);
    let (of, colour) = match take.contacts.len() {
        1 => ("it", palette::PAD),
        _ => (&*contact.label, drawn(take).nth(index).map_or(palette::PAD, |(_, colour)| colour)),
    };
    let title = format!("{:.0} ms of {of}, enlarged", ZOOM_S * 1e3);
    let zoom = Panel::new(title, axis, Axis::new("height", "m"))
        .weight(2.0)
        .with(Layer::ground("surface", part(&contact.height_m)))
        .with(Layer::Line {
            label: "pad".to_owned(),
            colour: colour.to_owned(),
            width_px: 1.8,
            fill: None,
            dashed: false,
            data: part(&contact.pad_m),
        })
        .with(Layer::Dots {
            label: label.to_owned(),
            colour: palette::IMPACT.to_owned(),
            points: collisions,
            radius_px: vec![3.5],
            names: Vec::new(),
        });
    // On flat ground there is nothing to enlarge.
    let swing_m = [&contact.height_m, &contact.pad_m].map(|curve| {
        let cut = curve.get(first..last).unwrap_or(&[]);
        cut.iter().copied().fold(f64::MIN, f64::max) - cut.iter().copied().fold(f64::MAX, f64::min)
    });
    let moves = swing_m.iter().any(|swing_m| *swing_m > FLAT_M);
    let mut panels: Vec<Panel> = moves.then_some(zoom).into_iter().chain([levels_panel(take)]).collect();
    // Several surfaces have rows of their own.
    if let [ground] = &take.grounds[..] {
        panels.push(ground_panel(take, ground));
    }
    panels
}

/// Surfaces from above in a row of the picture.
const GROUNDS_A_ROW: usize = 4;

/// The finger's way over the surface, seen from above; v grows downwards, as in the image.
fn ground_panel(take: &Take<'_>, ground: &Ground) -> Panel {
    let [width_m, height_m] = ground.extent_m;
    let picture = Picture {
        x: [0.0, width_m],
        y: [height_m, 0.0],
        width: ground.heights.width,
        height: ground.heights.height,
        values: ground.heights.values.iter().map(|&height| height as f32).collect(),
        scale: colour::Scale::Earth,
        bar: None,
    };
    let across = Axis::new("u", "m").range(0.0, width_m);
    let down = Axis::new("v", "m").range(height_m, 0.0);
    let title = match take.grounds.len() {
        1 => ground.title.clone(),
        _ => ground.surface.trim_start_matches(" on ").to_owned(),
    };
    let mut panel = Panel::new(title, across, down).with(picture).true_scale();
    for (contact, colour) in drawn(take).filter(|(contact, _)| contact.label.ends_with(&ground.surface)) {
        panel = panel.with(Layer::Line {
            label: String::new(),
            colour: colour.to_owned(),
            width_px: 1.8,
            fill: None,
            dashed: false,
            data: Series::Points(on_one_tile(&contact.path_uv, ground)),
        });
    }
    panel
}

/// A path on the one tile of a surface that is drawn, m; where it goes on at the other edge the
/// line is broken.
fn on_one_tile(path_uv: &[[f64; 2]], ground: &Ground) -> Vec<[f64; 2]> {
    let fold = |x: f64| match ground.wrap {
        Wrap::Repeat => x.rem_euclid(1.0),
        Wrap::Mirror => 1.0 - (x.rem_euclid(2.0) - 1.0).abs(),
        Wrap::Clamp => x,
    };
    let place = |uv: [f64; 2]| [fold(uv[0]) * ground.extent_m[0], fold(uv[1]) * ground.extent_m[1]];
    let tile = |uv: [f64; 2]| uv.map(f64::floor);
    let mut points = Vec::with_capacity(path_uv.len());
    for (n, &uv) in path_uv.iter().enumerate() {
        if ground.wrap == Wrap::Repeat && n > 0 && tile(path_uv[n - 1]) != tile(uv) {
            points.push([f64::NAN; 2]);
        }
        points.push(place(uv));
    }
    points
}

/// Third-octave levels of what is felt and what is heard, each relative to its strongest band.
fn levels_panel(take: &Take<'_>) -> Panel {
    let frequency = Axis::log("frequency", "Hz").range(10.0, 20_000.0);
    let mut panel = Panel::new(
        "spectra",
        frequency,
        Axis::new("third-octave level", "dB re strongest").range(-70.0, 3.0),
    );
    let curves = take
        .haptic
        .first()
        .map(|channel| ("felt", palette::HAPTIC, channel.samples))
        .into_iter()
        .chain([("heard", palette::AUDIO, take.audio)]);
    for (label, colour, samples) in curves {
        let bands = asperity_plot::third_octaves(samples, take.sample_rate_hz);
        let top = bands.iter().map(|band| band[1]).fold(f64::NEG_INFINITY, f64::max);
        if top.is_finite() {
            let points = bands.iter().map(|[hz, db]| [*hz, db - top]).collect();
            panel = panel.with(Layer::line(label, colour, Series::Points(points)));
        }
    }
    panel
}

fn haptic_rows(figure: &mut Figure, take: &Take<'_>, index: usize, channel: &HapticChannel<'_>) {
    let number = if take.haptic.len() > 1 { format!(" {index}") } else { String::new() };
    let values = channel.samples.iter().map(|&sample| f64::from(sample) * channel.full_scale);
    let growing = match channel.felt_force_exponent {
        0.0 => String::new(),
        exponent => format!(", as felt: its own by (F / 1 N)^{exponent:.2}"),
    };
    let wave = Panel::new(
        format!("haptic channel{number}: pad {}{growing}", channel.quantity),
        time(take),
        Axis::new(channel.quantity, channel.unit),
    )
    .with(Layer::line("", palette::HAPTIC, Series::signal(values, take.sample_rate_hz, 0.0)))
    .with(impact_rules(take));
    // 0 dB is 1 µm or 1 m/s².
    let (unit, reference) = if channel.unit == "m" { ("dB re 1 µm", 1e-6) } else { ("dB re 1 m/s²", 1.0) };
    let options = SpectrogramOptions {
        window_s: 0.09,
        from_hz: 5.0,
        to_hz: 1_000.0,
        range_db: 70.0,
        unit: unit.to_owned(),
        offset_db: 20.0 * (channel.full_scale / reference).log10(),
        rows: 150,
        ..SpectrogramOptions::default()
    };
    let spectrum = Panel::new("felt, by frequency", time(take), Axis::log("frequency", "Hz"))
        .with(spectrogram(channel.samples, take.sample_rate_hz, &options));
    figure.row(70.0, [wave]);
    figure.row(140.0, [spectrum]);
}

fn audio_rows(figure: &mut Figure, take: &Take<'_>) {
    let values = take.audio.iter().map(|&sample| f64::from(sample));
    let wave = Panel::new("audio", time(take), Axis::new("sample value", ""))
        .with(Layer::line("", palette::AUDIO, Series::signal(values, take.sample_rate_hz, 0.0)))
        .with(impact_rules(take));
    let options = SpectrogramOptions { unit: "dB re 1".to_owned(), ..SpectrogramOptions::default() };
    let spectrum = Panel::new("heard, by frequency", time(take), Axis::log("frequency", "Hz"))
        .with(spectrogram(take.audio, take.sample_rate_hz, &options));
    figure.row(70.0, [wave]);
    figure.row(190.0, [spectrum]);
}
