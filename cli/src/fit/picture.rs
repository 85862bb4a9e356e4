//! The picture of a fit: recording, resynthesis and residual on one scale, modes drawn over.

use crate::plot::{Axis, Figure, Layer, Panel, Series, SpectrogramOptions, palette, spectrogram};
use asperity_fit::{Fit, Recording};

/// Most modes whose ring is drawn as a line.
const DRAWN: usize = 80;

/// The picture as SVG.
pub fn svg(recording: &Recording, fit: &Fit) -> String {
    let rate = fit.sample_rate_hz;
    let start_s = recording.starts_at_s;
    let mut figure = Figure::new(format!("{}: {} modes", fit.source, fit.modes.len())).subtitle(format!(
        "resynthesis {:.1} dB above the residual, onset {:.4} s, fitted from {:.1} ms after it",
        fit.resynthesis_snr_db,
        fit.onset_s,
        1e3 * fit.start_offset_s
    ));
    for warning in &fit.warnings {
        figure = figure.subtitle(format!("warning: {warning}"));
    }
    let wave =
        Panel::new("recording", Axis::new("time", "s").without_numbers(), Axis::new("sample value", ""))
            .with(Layer::line(
                "",
                palette::AUDIO,
                Series::signal(recording.samples.iter().copied(), rate, start_s),
            ));
    figure.row(70.0, [wave]);
    let resynthesis = fit.resynthesis();
    let mut options = SpectrogramOptions {
        start_s,
        unit: "dB re 1".to_owned(),
        top_db: None,
        ..SpectrogramOptions::default()
    };
    let parts: [(&str, &[f64], bool); 3] = [
        ("recording, its modes drawn as long as they ring (60 dB)", &recording.samples, true),
        ("resynthesis: the modes alone", &resynthesis, false),
        ("residual: what the modes leave", &fit.residual.samples, false),
    ];
    for (title, samples, with_modes) in parts {
        let picture = spectrogram(samples, rate, &options);
        // All three on the recording's scale.
        options.top_db = options.top_db.or(picture.bar.as_ref().map(|bar| bar.range[1]));
        let mut panel = Panel::new(title, Axis::new("time", "s"), Axis::log("frequency", "Hz")).with(picture);
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
