//! `haptic --plot`: what was and what is left, above each other.

use super::Made;
use asperity_plot::{
    Axis, Figure, Layer, Panel, Series, SpectrogramOptions, palette, spectrogram, third_octaves,
};
use asperity_ports::{Device, felt};

/// The picture as SVG; `title` says what was made of what.
pub fn svg(title: &str, made: &Made, device: &Device) -> String {
    let mut figure = Figure::new(title)
        .subtitle(format!("{:.2} s, {} points, gain {:.3}", made.duration_s, made.points, made.gain));
    let time = || Axis::new("time", "s").range(0.0, made.duration_s.max(1e-3));
    let wave = |name: &str, colour: &str, samples: &[f64]| {
        let data = Series::signal(samples.iter().copied(), felt::RATE_HZ, 0.0);
        Panel::new(name, time(), Axis::new("sample value", "")).with(Layer::line("", colour, data))
    };
    let options = SpectrogramOptions {
        from_hz: 20.0,
        to_hz: 800.0,
        rows: 140,
        range_db: 60.0,
        unit: "dB re 1".to_owned(),
        ..SpectrogramOptions::default()
    };
    let tones = |name: &str, samples: &[f64]| {
        Panel::new(name, time(), Axis::log("frequency", "Hz")).with(spectrogram(
            samples,
            felt::RATE_HZ,
            &options,
        ))
    };
    figure.row(80.0, [wave("what was", palette::GROUND_EDGE, &made.original)]);
    figure.row(80.0, [wave("what is left", palette::HAPTIC, &made.left)]);
    figure.row(120.0, [tones("what was, by frequency", &made.original)]);
    figure.row(120.0, [tones("what is left, by frequency", &made.left)]);
    figure.row(140.0, [levels(made), thirds(made, device)]);
    figure.svg()
}

/// Levels of 20 ms of what is felt, and the points.
fn levels(made: &Made) -> Panel {
    let level = |samples: &[f64]| {
        let felt = felt::felt(samples);
        let frames = felt.chunks(160).map(|f| (f.iter().map(|x| x * x).sum::<f64>() / f.len() as f64).sqrt());
        Series::signal(frames.collect::<Vec<_>>(), felt::RATE_HZ / 160.0, 0.01)
    };
    let mut panel =
        Panel::new("how much is felt", Axis::new("time", "s"), Axis::new("level over threshold", ""))
            .with(Layer::line("was", palette::GROUND_EDGE, level(&made.original)))
            .with(Layer::line("is left", palette::HAPTIC, level(&made.left)));
    if let Some(clip) = &made.clip {
        let strokes: Vec<f64> =
            clip.amplitude.iter().filter(|p| p.emphasis.is_some()).map(|p| p.time_s).collect();
        if !strokes.is_empty() {
            panel = panel.with(Layer::Rules {
                label: "strokes".to_owned(),
                colour: palette::IMPACT.to_owned(),
                x: strokes,
            });
        }
    }
    panel
}

fn thirds(made: &Made, device: &Device) -> Panel {
    let felt_thirds = |samples: &[f64]| {
        let bands = third_octaves(&felt::felt(samples), felt::RATE_HZ);
        Series::Points(bands.into_iter().filter(|p| (16.0..=900.0).contains(&p[0])).collect())
    };
    Panel::new("felt, by third octaves", Axis::log("frequency", "Hz"), Axis::new("level", "dB re threshold"))
        .with(Layer::line("was", palette::GROUND_EDGE, felt_thirds(&made.original)))
        .with(Layer::line("is left", palette::HAPTIC, felt_thirds(&made.left)))
        .with(Layer::Rules {
            label: "device's range".to_owned(),
            colour: palette::PAD.to_owned(),
            x: device.band_hz.to_vec(),
        })
}
