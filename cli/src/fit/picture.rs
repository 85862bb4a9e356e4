//! The picture of a fit: recording, what the engine plays, and what is left, each as a wave and as
//! a spectrogram, all on the recording's scale; above them the first milliseconds, where a strike
//! is right or wrong.

use asperity_fit::{Fit, Recording};
use asperity_plot::{Axis, Figure, Layer, Panel, Series, SpectrogramOptions, decibels, palette, spectrogram};

/// Most modes whose ring is drawn as a line.
const DRAWN: usize = 80;
/// The attack as it is drawn: from so long before the onset to so long after it, s.
const BEFORE_S: f64 = 0.002;
const ATTACK_S: f64 = 0.03;

/// The picture as SVG.
pub fn svg(recording: &Recording, fit: &Fit) -> String {
    let rate = fit.sample_rate_hz;
    let start_s = recording.starts_at_s;
    let mut figure = Figure::new(format!("{}: {} modes", fit.source, fit.modes.len())).subtitle(format!(
        "struck body {:.1} dB above what is left, its peak {} dB of the recording's, onset {:.4} s",
        fit.snr_from_onset_db,
        decibels(fit.struck_peak_db),
        fit.onset_s
    ));
    for warning in &fit.warnings {
        figure = figure.subtitle(format!("warning: {warning}"));
    }
    let struck = fit.resynthesis();
    let parts: [(&str, &str, &[f64], bool); 3] = [
        ("recording", "recording, its modes drawn as long as they ring (60 dB)", &recording.samples, true),
        ("struck body", "the struck body: what the engine plays", &struck, false),
        ("what is left", "what is left", &fit.residual.samples, false),
    ];
    let from = fit.onset_sample.saturating_sub((BEFORE_S * rate) as usize);
    let until = (fit.onset_sample + (ATTACK_S * rate) as usize).min(struck.len());
    let loudest =
        [&recording.samples, &struck].into_iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    let wave = |title: String, samples: &[f64], from: usize, until: usize| {
        let axis = Axis::new("sample value", "").range(-loudest, loudest);
        let wave = Series::signal(samples[from..until].iter().copied(), rate, start_s + from as f64 / rate);
        Panel::new(title, Axis::new("time", "s"), axis).with(Layer::line("", palette::AUDIO, wave))
    };
    let attack = |name: &str| format!("{name}: the first {:.0} ms", 1e3 * ATTACK_S);
    figure.row(80.0, parts.map(|(name, _, samples, _)| wave(attack(name), samples, from, until)));
    figure.row(
        60.0,
        parts.map(|(name, _, samples, _)| wave(format!("{name}: all of it"), samples, 0, struck.len())),
    );
    let mut options = SpectrogramOptions {
        start_s,
        unit: "dB re 1".to_owned(),
        top_db: None,
        ..SpectrogramOptions::default()
    };
    for (_, title, samples, with_modes) in parts {
        let picture = spectrogram(samples, rate, &options);
        // All three on the recording's scale.
        options.top_db = options.top_db.or(picture.bar.as_ref().map(|bar| bar.range[1]));
        // A mode above the picture's top leaves no strip there.
        let frequency = Axis::log("frequency", "Hz").range(picture.y[0], picture.y[1]);
        let mut panel = Panel::new(title, Axis::new("time", "s"), frequency).with(picture);
        if with_modes {
            let end_s = start_s + recording.samples.len() as f64 / rate;
            for mode in fit.modes.iter().take(DRAWN) {
                let until = (fit.onset_s + 6.908 / mode.decay_per_s.max(1e-3)).min(end_s);
                let ends = vec![[fit.onset_s, mode.frequency_hz], [until, mode.frequency_hz]];
                panel = panel.with(Layer::line("", palette::GROUND, Series::Points(ends)));
            }
        }
        figure.row(190.0, [panel]);
    }
    figure.svg()
}
