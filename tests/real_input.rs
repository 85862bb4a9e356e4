//! Real maps, real pen strokes, published modes: everything renders, and the spectra are those of
//! the surfaces. The importers are those of the example `real_input`. Long renders and pictures of
//! the same input are made by that example; the bars here are what those showed.

use crate::common;
use crate::modal_tables;
use crate::profile;
use crate::trajectories;

use asperity::files::contact_log::{ContactLog, Names};
use asperity::offline::{self, Options};
use asperity::{Config, Extent, Surface, Wrap};
use asperity_evidence::corpus::corpus;
use asperity_evidence::spectrum;
use asperity_surface::height_map::HeightMap;
use asperity_surface::image_io::{self, Channel};
use common::{peak, render, rms, si_config, stroke};
use std::collections::HashMap;
use trajectories::PenSample;

fn text(corpus: &std::path::Path, name: &str) -> String {
    std::fs::read_to_string(corpus.join(name)).unwrap()
}

fn pens(corpus: &std::path::Path) -> [Vec<PenSample>; 2] {
    [
        trajectories::handwriting(&text(corpus, "haptics/stylus_handwriting_signal.svc")).unwrap(),
        trajectories::painting(&text(corpus, "haptics/stylus_painting30sec_first_half.dat")).unwrap(),
    ]
}

fn surface(corpus: &std::path::Path, file: &str, channel: Channel, side_m: f64, relief_m: f64) -> Surface {
    let image = image_io::load_channel(corpus.join("textures").join(file), channel).unwrap();
    let extent = Extent { width_m: side_m, height_m: side_m, relief_m };
    let map = HeightMap::new(&image.debanded(Wrap::Repeat), extent, Wrap::Repeat).unwrap();
    Surface::new(map, side_m, side_m).unwrap()
}

/// A piece of a recording, from `from` seconds on, that starts at time 0.
fn piece(samples: &[PenSample], from: f64, seconds: f64) -> Vec<PenSample> {
    let inside = samples.iter().filter(|s| (from..from + seconds).contains(&s.t));
    inside.map(|s| PenSample { t: s.t - from, ..*s }).collect()
}

const MAPS: [(&str, Channel, f64, f64); 12] = [
    ("MetalWalkway006_1K-PNG_Displacement.png", Channel::Luma, 0.2, 1.5e-3),
    ("CorrugatedSteel003_1K-PNG_Displacement.png", Channel::Luma, 0.2, 2e-3),
    ("Fabric061_1K-PNG_Displacement.png", Channel::Luma, 0.1, 0.3e-3),
    ("Rock003_1K-PNG_Displacement.png", Channel::Luma, 0.3, 10e-3),
    ("Ground048_1K-PNG_Displacement.png", Channel::Luma, 0.3, 5e-3),
    ("Ground048_1K-JPG_Displacement.jpg", Channel::Luma, 0.3, 5e-3),
    ("Bricks102_1K-JPG_Displacement.jpg", Channel::Luma, 0.5, 10e-3),
    ("Metal056B_1K-JPG_Displacement.jpg", Channel::Luma, 0.2, 1e-3),
    ("hterrain_sand_depth.png", Channel::Luma, 0.3, 3e-3),
    ("rock023_alb_ht.png", Channel::A, 0.3, 5e-3),
    ("bevy_cube_depth.png", Channel::Luma, 0.1, 3e-3),
    ("dime_truemap_16bit.png", Channel::Luma, 18.9566e-3, 0.350_987e-3),
];

#[test]
fn every_map_under_a_real_stroke_is_finite_felt_and_heard() {
    let Some(corpus) = corpus("") else { return };
    let [_, painting] = pens(&corpus);
    let strokes = piece(&painting, 1.7, 1.0);
    for (file, channel, side_m, relief_m) in MAPS {
        let log = trajectories::strokes(&strokes, "s", [side_m; 2], false);
        let surface = surface(&corpus, file, channel, side_m, relief_m);
        let take = render(si_config(), surface, &log, &Options { tail_s: 0.2, ..Options::default() });
        let (felt, heard) = (&take.haptic[0], &take.audio[0]);
        assert!(felt.iter().chain(heard).all(|x| x.is_finite()), "{file}");
        assert_eq!((take.stats.refused, take.stats.quarantined), (0, 0), "{file}");
        // Ten times the threshold of touch at its most sensitive, and 100 dB below full scale.
        assert!(rms(felt) > 1e-6 && peak(felt) < 1.2 * relief_m + 2e-3, "{file}: {} m rms", rms(felt));
        assert!(rms(heard) > 1e-5 && peak(heard) < 1.0, "{file}: {} rms", rms(heard));
    }
}

#[test]
fn corrugated_steel_vibrates_at_speed_over_pitch() {
    let Some(corpus) = corpus("") else { return };
    let file = "CorrugatedSteel003_1K-PNG_Displacement.png";
    // Small, so that the ridges pass at rates that are felt.
    let side_m = 0.02;
    // The pitch, from the picture alone: the strongest harmonic of its mean column.
    let raster = image_io::load_channel(corpus.join("textures").join(file), Channel::Luma).unwrap().raster;
    let mean: Vec<f32> = (0..raster.width)
        .map(|x| (0..raster.height).map(|y| raster.at(x, y)).sum::<f64>() as f32 / raster.height as f32)
        .collect();
    let strength = |k: usize| common::tone_amplitude(&mean, k as f64, mean.len() as f64);
    let ridges = (2..200).max_by(|a, b| strength(*a).total_cmp(&strength(*b))).unwrap();
    for speed_m_s in [0.05, 0.2] {
        let log = stroke(side_m, speed_m_s, 0.6, 2.5);
        let take = render(
            si_config(),
            surface(&corpus, file, Channel::Luma, side_m, 2e-4).micro_relief_m(0.0),
            &log,
            &Options::default(),
        );
        let x = &take.haptic[0][(0.4 * take.sample_rate_hz) as usize..(2.4 * take.sample_rate_hz) as usize];
        let expected_hz = speed_m_s * ridges as f64 / side_m;
        let strongest_hz = (2..400)
            .map(|bin| 0.5 * f64::from(bin))
            .max_by(|a, b| {
                let level = |hz: &f64| common::tone_amplitude(x, *hz, take.sample_rate_hz);
                level(a).total_cmp(&level(b))
            })
            .unwrap();
        println!("{ridges} ridges, {speed_m_s} m/s: {strongest_hz} Hz, expected {expected_hz} Hz");
        assert!((strongest_hz - expected_hz).abs() <= 0.5, "{strongest_hz} Hz instead of {expected_hz} Hz");
    }
}

#[test]
fn sixteen_and_eight_bits_of_one_ground_feel_alike() {
    let Some(corpus) = corpus("") else { return };
    for (samples, from) in pens(&corpus).iter().zip([0.2, 1.7]) {
        let log = trajectories::strokes(&piece(samples, from, 1.5), "s", [0.3; 2], false);
        let octaves = |file| {
            let surface = surface(&corpus, file, Channel::Luma, 0.3, 5e-3);
            let take = render(si_config(), surface, &log, &Options::default());
            spectrum::third_octaves_db(&take.haptic[0], take.sample_rate_hz)
        };
        let (fine, coarse) =
            (octaves("Ground048_1K-PNG_Displacement.png"), octaves("Ground048_1K-JPG_Displacement.jpg"));
        // 25 Hz to 800 Hz: all that skin feels.
        let worst = fine[..16].iter().zip(&coarse[..16]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        println!("16 against 8 bits: {worst:.2} dB");
        assert!(worst < 1.0, "{worst} dB");
    }
}

#[test]
fn a_measured_profile_of_wood_is_felt_with_its_own_relief() {
    let Some(corpus) = corpus("") else { return };
    let bytes = std::fs::read(corpus.join("textures/profile_bass_wood.npy")).unwrap();
    let heights_m = profile::read_npy(&bytes).unwrap();
    assert_eq!(heights_m.len(), 100_800);
    let (raster, relief_m) = profile::raster(&heights_m);
    let width_m = profile::STEP_M * raster.width as f64;
    let grey16 = raster.map(|h| (h * 65_535.0).round() / 65_535.0);
    let extent = Extent { width_m, height_m: width_m, relief_m };
    let map = HeightMap::new(&grey16, extent, Wrap::Mirror).unwrap();
    let wood = Surface::new(map, width_m, width_m).unwrap().wraps(false).micro_relief_m(0.0);
    let take = render(si_config(), wood, &stroke(width_m, 0.03, 0.5, 1.2), &Options::default());
    // The recording itself has 5.7 µm rms over all wavelengths; the pad rides on its peaks and the
    // high-pass takes the slow waves.
    let felt = rms(&take.haptic[0]);
    assert!((1e-6..6e-6).contains(&felt), "{felt} m");
}

#[test]
fn pens_lift_jump_and_pause_where_the_recordings_do() {
    let Some(corpus) = corpus("") else { return };
    for (samples, contacts) in pens(&corpus).iter().zip([5, 6]) {
        let log = trajectories::strokes(samples, "s", [0.2; 2], true);
        let begins = log
            .lines
            .iter()
            .filter(|l| matches!(l.event, asperity::files::contact_log::LogEvent::Begin { .. }));
        let ends = log
            .lines
            .iter()
            .filter(|l| matches!(l.event, asperity::files::contact_log::LogEvent::End { .. }));
        assert_eq!((begins.count(), ends.count()), (contacts, contacts));
        assert!(log.lines.windows(2).all(|w| w[0].t <= w[1].t));
        let down = samples.iter().filter(|s| s.pressure > 0.0).count();
        assert_eq!(log.lines.len(), down + contacts, "every sample on paper is an event, and every lift");
    }
}

#[test]
fn nothing_clicks_where_a_pen_lifts() {
    let Some(corpus) = corpus("") else { return };
    let [handwriting, _] = pens(&corpus);
    let (side_m, relief_m) = (0.2, 2e-3);
    let log = trajectories::strokes(&piece(&handwriting, 0.0, 2.2), "s", [side_m; 2], true);
    let end_s = log.lines.last().unwrap().t;
    let surface =
        surface(&corpus, "CorrugatedSteel003_1K-PNG_Displacement.png", Channel::Luma, side_m, relief_m);
    let take = render(si_config(), surface, &log, &Options::default());
    // Second differences, which a step or corner raises and a smooth fade does not.
    let roughest = |x: &[f32], from: f64, to: f64| {
        let part = &x[(from * take.sample_rate_hz) as usize..(to * take.sample_rate_hz) as usize];
        part.windows(3).map(|w| f64::from(w[0] - 2.0 * w[1] + w[2]).abs()).fold(0.0, f64::max)
    };
    for (name, x) in [("felt", &take.haptic[0]), ("heard", &take.audio[0])] {
        let (during, lift) = (roughest(x, 0.1, end_s - 0.1), roughest(x, end_s - 0.001, end_s + 0.05));
        assert!(lift <= during + 1e-3 * peak(x), "{name}: {lift} at the lift, {during} during the stroke");
    }
}

#[test]
fn published_modes_ring_in_tune_and_tossed_cubes_strike_them() {
    let Some(corpus) = corpus("") else { return };
    let mut models = Vec::new();
    for name in ["tdw_ceramic_0_mm", "tdw_wood_medium_0_mm", "tdw_stone_1_mm"] {
        models.push(modal_tables::fitted(name, &text(&corpus, &format!("modal/{name}.json"))).unwrap());
    }
    for name in ["faust_bells_bars", "faust_measured_bodies", "stk_modalbar", "csound_modal_ratios"] {
        models.extend(modal_tables::bodies(&text(&corpus, &format!("modal/{name}.json"))).unwrap());
    }
    assert_eq!(models.len(), 23);
    let tosses = trajectories::tosses(&text(&corpus, "haptics/cube_tosses_148hz.csv"), "b").unwrap();
    assert!((12..40).contains(&tosses.lines.len()), "{} impacts of six tosses", tosses.lines.len());
    let toss = ContactLog { lines: tosses.lines[..1].to_vec() };
    // A cube of plastic is too blunt to make high modes heard; a steel ball is not.
    let ball = r#"{"t":0.1,"event":"impact","body":"b","speed_m_s":1,"mass_kg":0.004,"radius_m":0.005,"striker":"steel"}"#;
    let ball = ContactLog::parse(ball, "log").unwrap();
    for (name, model) in models {
        let loudest = model
            .modes
            .iter()
            .filter(|m| m.frequency_hz < 4_000.0)
            .max_by(|a, b| (a.amplitude / a.decay_per_s).total_cmp(&(b.amplitude / b.decay_per_s)))
            .copied();
        let lowest_hz = model.modes.iter().map(|m| m.frequency_hz).fold(f64::INFINITY, f64::min);
        let ring = |log| {
            let asperity::Engine { mut scene, renderer, .. } = Config::default().build().unwrap();
            let body = scene.add_body(model.clone()).unwrap();
            let names = Names { bodies: HashMap::from([("b".to_owned(), body)]), ..Names::default() };
            offline::render(scene, renderer, log, &names, &Options::default()).unwrap()
        };
        let tossed = ring(&toss);
        assert!(tossed.audio[0].iter().all(|x| x.is_finite()) && rms(&tossed.audio[0]) > 1e-4, "{name}");
        let take = ring(&ball);
        if let Some(mode) = loudest {
            let at = |hz| common::tone_amplitude(&take.audio[0], hz, take.sample_rate_hz);
            let (on, off) = (at(mode.frequency_hz), at(0.5 * lowest_hz));
            assert!(on > 3.0 * off, "{name}: {on} at {} Hz, {off} below it", mode.frequency_hz);
        }
    }
}

#[test]
fn broken_recordings_are_refused_with_their_line() {
    assert!(trajectories::handwriting("2\n1 2 3 1 0 0 0.5\n1 2 x 1 0 0 0.5").unwrap_err().contains("line 3"));
    assert!(trajectories::painting("1 2 3").unwrap_err().contains("line 1"));
    assert!(profile::read_npy(b"no numpy").is_err());
}
