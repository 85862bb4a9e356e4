//! Outputs, felt and heard: waves and spectra.

use super::{HapticChannel, Take, impact_rules, time};
use asperity_plot::{Axis, Figure, Layer, Panel, Series, SpectrogramOptions, palette, spectrogram};

pub(super) fn haptic_rows(figure: &mut Figure, take: &Take<'_>, index: usize, channel: &HapticChannel<'_>) {
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

pub(super) fn audio_rows(figure: &mut Figure, take: &Take<'_>) {
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

/// Third-octave levels of what is felt and what is heard, each relative to its strongest band.
pub(super) fn levels_panel(take: &Take<'_>) -> Panel {
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
