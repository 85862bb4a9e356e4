//! The picture of a fit: recording, the struck body with its burst and bands of noise, and what the
//! modes leave, each as a wave and as a spectrogram, all on the recording's scale; above them the
//! first milliseconds, where a strike is right or wrong.

use asperity_dsp::DesignError;
use asperity_dsp::diffuse::{
    BANDS, DiffuseBand, DiffuseBank, DiffuseGroup, DiffuseInput, DiffuseState, RISE_A_BURST,
};
use asperity_dsp::simd::Level;
use asperity_fit::body::residual::Burst;
use asperity_fit::{Fit, Recording};
use asperity_plot::{Axis, Figure, Layer, Panel, Series, SpectrogramOptions, decibels, palette, spectrogram};

/// Most modes whose ring is drawn as a line.
const DRAWN: usize = 80;
/// The attack as it is drawn: from so long before the onset to so long after it, s.
const BEFORE_S: f64 = 0.002;
const ATTACK_S: f64 = 0.03;

/// The recorded strike as a body plays it: modes, burst, and bands of noise with a seed of their
/// own.
fn played(fit: &Fit, burst: Option<&Burst>, bands: &[DiffuseBand]) -> Result<Vec<f64>, DesignError> {
    let mut sound = fit.resynthesis();
    let after = &mut sound[fit.onset_sample..];
    if let Some(burst) = burst {
        after.iter_mut().zip(&burst.samples).for_each(|(sum, x)| *sum += x);
    }
    let burst_s = burst.map_or(0.0, |burst| burst.samples.len() as f64 / burst.sample_rate_hz);
    let (rise_s, rate) = ((RISE_A_BURST * burst_s).max(1e-3), fit.sample_rate_hz);
    let groups = bands.chunks(BANDS).zip(0..);
    let groups = groups.map(|(bands, seed)| DiffuseGroup::new(bands, rise_s, seed, rate));
    let groups = groups.collect::<Result<Vec<_>, _>>()?;
    let states = vec![DiffuseState::REST; groups.len()];
    let (mut all, mut noise) = (vec![0.0; after.len()], vec![0.0; after.len()]);
    all.iter_mut().take(1).for_each(|x| *x = 1.0);
    let rising: &[f32] = if burst.is_some() { &all } else { &[] };
    DiffuseBank::new(Level::detect(), groups, states).render(DiffuseInput { all: &all, rising }, &mut noise);
    after.iter_mut().zip(noise).for_each(|(sum, x)| *sum += f64::from(x));
    Ok(sound)
}

/// The picture as SVG.
///
/// # Errors
/// When a band cannot be played at the recording's rate.
pub fn svg(
    recording: &Recording,
    fit: &Fit,
    burst: Option<&Burst>,
    bands: &[DiffuseBand],
) -> Result<String, DesignError> {
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
    let struck = played(fit, burst, bands)?;
    let plays = match (burst, bands) {
        (None, []) => "the struck body: its modes",
        (Some(_), []) => "the struck body: modes and burst",
        (None, _) => "the struck body: modes and bands of noise",
        (Some(_), _) => "the struck body: modes, burst and bands of noise",
    };
    let parts: [(&str, &str, &[f64], bool); 3] = [
        ("recording", "recording, its modes drawn as long as they ring (60 dB)", &recording.samples, true),
        ("struck body", plays, &struck, false),
        ("what the modes leave", "what the modes leave", &fit.residual.samples, false),
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
    Ok(figure.svg())
}
