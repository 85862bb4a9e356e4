//! Hard cases for the whole engine: no parameter a config accepts, and no event a game can send,
//! makes it grow, stick or lose a number.
//!
//! The bound everywhere: what comes out is finite, the pad stays within a few times what the
//! surface and the force can move it by, and once everything has ended the engine is silent.

use crate::common;

use asperity::{
    ActuatorSettings, ChannelId, Config, ContactEvent, ContactId, ContactSample, Impact, Integrator,
    Material, ModalModel, Mode, PathMode, Probe, Renderer, Scene, Surface, SurfaceId,
};
use asperity_dsp::rng::Rng;
use common::{SIDE_M, bar, grating, plate};

const RATES_HZ: [f64; 6] = [8_000.0, 22_050.0, 44_100.0, 48_000.0, 96_000.0, 192_000.0];

/// An engine in SI units, one surface on one body, and what it has sent out so far.
struct Run {
    scene: Scene,
    renderer: Renderer,
    surface: SurfaceId,
    haptic: Vec<f32>,
    audio: Vec<f32>,
}

/// Largest values since the last look.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Peaks {
    haptic: f32,
    audio: f32,
}

impl Run {
    fn new(config: Config, surface: Surface) -> Self {
        let si = ActuatorSettings { full_scale: 1.0, highpass_hz: 0.0, ..ActuatorSettings::default() };
        let config = Config { actuators: vec![si], contact_timeout_s: 3600.0, ..config };
        let asperity::Engine { mut scene, renderer, .. } = config.build().unwrap();
        let body = scene.add_body(bar()).unwrap();
        let surface = scene.add_surface(surface.body(body)).unwrap();
        Self { scene, renderer, surface, haptic: vec![0.0; 441], audio: vec![0.0; 441] }
    }

    fn now_s(&self) -> f64 {
        self.renderer.position() as f64 / self.renderer.sample_rate_hz()
    }

    fn begin(&mut self, sample: ContactSample) {
        let event = ContactEvent::begin(ContactId(1), self.surface, ChannelId(0), sample);
        self.scene.report(self.now_s(), event).unwrap();
    }

    fn moved(&mut self, sample: ContactSample) {
        self.scene.report(self.now_s(), ContactEvent::moved(ContactId(1), sample)).unwrap();
    }

    fn end(&mut self) {
        self.scene.report(self.now_s(), ContactEvent::end(ContactId(1))).unwrap();
    }

    /// Slides on from `u` with a report every 10 ms.
    fn slide(&mut self, u: f64, speed_m_s: f64, seconds: f64) -> Peaks {
        let mut peaks = Peaks { haptic: 0.0, audio: 0.0 };
        for step in 0..(100.0 * seconds) as usize {
            self.moved(pressed(u + speed_m_s * step as f64 / 100.0 / SIDE_M, speed_m_s, 0.8));
            let now = self.render(0.01);
            peaks = Peaks { haptic: peaks.haptic.max(now.haptic), audio: peaks.audio.max(now.audio) };
        }
        peaks
    }

    /// Renders; every sample must be a number.
    fn render(&mut self, seconds: f64) -> Peaks {
        let end = self.renderer.position() + (seconds * self.renderer.sample_rate_hz()) as u64;
        let mut peaks = Peaks { haptic: 0.0, audio: 0.0 };
        while self.renderer.position() < end {
            self.renderer.render(&mut [&mut self.haptic], &mut [&mut self.audio]);
            let peak = |x: &[f32]| {
                x.iter().fold(0.0f32, |peak, x| {
                    assert!(x.is_finite());
                    peak.max(x.abs())
                })
            };
            peaks.haptic = peaks.haptic.max(peak(&self.haptic));
            peaks.audio = peaks.audio.max(peak(&self.audio));
        }
        peaks
    }

    /// Ends the contact; soon nothing is felt, and what was heard decays as the body does.
    fn must_fall_silent(&mut self, what: &str) {
        self.end();
        self.render(0.1);
        assert_eq!(self.render(0.02).haptic, 0.0, "{what}: still felt");
        let before = self.render(0.1).audio;
        let after = self.render(0.1).audio;
        assert!(after <= before, "{what}: grows from {before} to {after} with nobody touching");
    }
}

fn pressed(u: f64, speed_m_s: f64, normal_force_n: f64) -> ContactSample {
    ContactSample {
        uv: [u, 0.4],
        velocity_m_s: Some([speed_m_s, 0.0]),
        normal_force_n,
        closing_m_s: 0.0,
        ..ContactSample::default()
    }
}

/// A second of everything that is hard on a contact: light, unloaded, 0 → 5 N, standing still,
/// jumping.
fn hard_second(run: &mut Run) -> Peaks {
    let steps = [
        (0.00, 0.10, 0.02),
        (0.02, 0.10, 0.0),
        (0.03, 0.10, 5.0),
        (0.05, 0.0, 5.0),
        (0.05, 0.0, 0.0),
        (0.05, 1.0, -0.3),
        (0.20, 1.0, 5.0),
        (0.80, 0.0, 0.5),
        (0.80, 0.3, 0.5),
        (0.10, 0.3, 0.02),
    ];
    let mut peaks = Peaks { haptic: 0.0, audio: 0.0 };
    run.begin(ContactSample { closing_m_s: 0.2, ..pressed(0.0, 0.1, 0.5) });
    for (u, speed_m_s, force_n) in steps {
        run.moved(pressed(u, speed_m_s, force_n));
        let now = run.render(0.03);
        peaks = Peaks { haptic: peaks.haptic.max(now.haptic), audio: peaks.audio.max(now.audio) };
    }
    peaks
}

#[test]
fn every_stiffness_stays_within_what_force_and_relief_can_move() {
    for rate in RATES_HZ {
        for contact_stiffness_n_m in [1e3, 5e4, 1e6, 1e8] {
            for pad_mass_kg in [1e-5, 0.15e-3] {
                for integrator in
                    [Integrator::ExactEvent, Integrator::SemiImplicitEuler, Integrator::EnergyConserving]
                {
                    let probe = Probe { contact_stiffness_n_m, pad_mass_kg, ..Probe::default() };
                    let config = Config { sample_rate_hz: rate, integrator, probe, ..Config::default() };
                    let what =
                        format!("{rate} Hz, {contact_stiffness_n_m} N/m, {pad_mass_kg} kg, {integrator:?}");
                    let mut run = Run::new(config, grating(2e-3, 1e-4));
                    let peaks = hard_second(&mut run);
                    // 5 N on the spring, 0.1 mm of relief, 1 mm of leash, a landing at 0.2 m/s.
                    let bound = 3.0 * (5.0 / contact_stiffness_n_m + 1e-4 + 1e-3) + 2e-3;
                    assert!(f64::from(peaks.haptic) < bound, "{what}: {} m", peaks.haptic);
                    assert!(peaks.haptic > 1e-6, "{what}: nothing is felt");
                    assert!(peaks.audio < 1e4, "{what}: {}", peaks.audio);
                    run.must_fall_silent(&what);
                    assert_eq!(run.scene.stats().quarantined, 0, "{what}");
                }
            }
        }
    }
}

#[test]
fn an_undamped_pad_never_rises_higher_than_its_energy_allows() {
    for integrator in [Integrator::ExactEvent, Integrator::EnergyConserving] {
        for contact_stiffness_n_m in [5e4, 5e6] {
            let force_exponent = 0.0;
            let probe =
                Probe { pad_damping_n_s_m: 0.0, contact_stiffness_n_m, force_exponent, ..Probe::default() };
            let (speed_m_s, force_n) = (0.05, 0.3);
            let mut run = Run::new(Config { integrator, probe, ..Config::default() }, plate(0.0));
            run.begin(ContactSample { closing_m_s: speed_m_s, ..pressed(0.2, 0.0, force_n) });
            let what = format!("{integrator:?}, {contact_stiffness_n_m} N/m");
            let peaks: Vec<f64> = (0..5).map(|_| f64::from(run.render(2.0).haptic)).collect();
            // At its highest the pad is s above the finger: energy ≥ k s²/2 + F (x − s), so x ≤
            // energy/F + F/2k. No slack: the energy may grow by the integrators' own bars alone.
            let energy_j = 0.5 * (probe.pad_mass_kg + probe.finger_mass_kg) * speed_m_s * speed_m_s;
            let gain = if integrator == Integrator::ExactEvent { 1.002 } else { 1.0 + 1e-9 };
            let highest_m = gain * energy_j / force_n + 0.5 * force_n / probe.pad_stiffness_n_m;
            println!("{what}: {peaks:?} against {highest_m}");
            assert!(peaks.iter().all(|m| *m <= highest_m), "{what}: {peaks:?} against {highest_m}");
            assert!(peaks[4] > 0.5 * peaks[0], "{what}: the bouncing dies out: {peaks:?}");
        }
    }
}

#[test]
fn a_sticking_finger_costs_no_sound_and_slides_on_unchanged() {
    let mut run = Run::new(Config::default(), plate(0.8));
    run.begin(pressed(0.1, 0.1, 0.8));
    run.slide(0.1, 0.1, 0.2);
    let moving = run.slide(0.1 + 0.02 / SIDE_M, 0.1, 0.05);
    run.moved(pressed(0.3, 0.0, 0.8));
    run.render(1.0);
    let resting = run.render(0.2);
    assert!(resting.audio < 1e-3 * moving.audio, "{resting:?} against {moving:?}");
    run.slide(0.3, 0.1, 0.1);
    let again = run.slide(0.3 + 0.01 / SIDE_M, 0.1, 0.05);
    assert!(again.audio > 0.1 * moving.audio && again.audio < 10.0 * moving.audio, "{again:?}, {moving:?}");
}

/// A number a broken physics engine may report.
fn wild(rng: &mut Rng) -> f64 {
    match rng.next_u32() % 12 {
        0 => f64::NAN,
        1 => f64::INFINITY,
        2 => f64::NEG_INFINITY,
        3 => 1e300,
        4 => -1e300,
        5 => f64::MIN_POSITIVE / 4.0,
        6 => 0.0,
        7 => -rng.uniform(),
        _ => 10f64.powf(6.0 * rng.uniform() - 4.0),
    }
}

#[test]
fn a_storm_of_bad_numbers_leaves_a_working_engine() {
    let mut rng = Rng::new(11);
    let mut run = Run::new(Config::default(), plate(0.7));
    run.begin(pressed(0.1, 0.1, 0.5));
    run.render(0.3);
    let before = run.render(0.1);
    for _ in 0..20_000 {
        let sample = ContactSample {
            uv: [wild(&mut rng), wild(&mut rng)],
            velocity_m_s: (rng.next_u32().is_multiple_of(2)).then(|| [wild(&mut rng), wild(&mut rng)]),
            normal_force_n: wild(&mut rng),
            closing_m_s: wild(&mut rng),
            ..ContactSample::default()
        };
        let now = run.now_s();
        let event = match rng.next_u32() % 4 {
            0 => ContactEvent::begin(
                ContactId(u64::from(rng.next_u32() % 3)),
                run.surface,
                ChannelId(0),
                sample,
            ),
            _ => ContactEvent::moved(ContactId(u64::from(rng.next_u32() % 3)), sample),
        };
        let _ = run.scene.report(now, event);
        if rng.next_u32().is_multiple_of(8) {
            run.render(0.001);
        }
    }
    assert!(run.scene.stats().refused > 1000);
    for contact in 0..3 {
        let now = run.now_s();
        let _ = run.scene.report(now, ContactEvent::end(ContactId(contact)));
    }
    run.render(3.0);
    assert_eq!((run.scene.stats().contacts, run.render(0.01).haptic), (0, 0.0), "a contact is stuck");
    run.begin(pressed(0.1, 0.1, 0.5));
    run.render(0.3);
    let after = run.render(0.1);
    assert!((after.haptic / before.haptic - 1.0).abs() < 0.2, "{before:?}, {after:?}");
    assert!(after.audio > 0.1 * before.audio && after.audio < 10.0 * before.audio, "{before:?}, {after:?}");
}

/// A config that the builder may refuse but, once accepted, must survive.
fn adversarial(rng: &mut Rng) -> Config {
    let mut between = |low: f64, high: f64| low * (high / low).powf(rng.uniform());
    let probe = Probe {
        pad_mass_kg: between(1e-6, 1e-2),
        pad_stiffness_n_m: between(1.0, 1e5),
        pad_damping_n_s_m: between(1e-3, 1e3),
        finger_mass_kg: between(1e-4, 1.0),
        contact_stiffness_n_m: between(1e2, 1e9),
        ..Probe::default()
    };
    let sample_rate_hz = between(8e3, 384e3);
    let integrators = [
        Integrator::ExactEvent,
        Integrator::SemiImplicitEuler,
        Integrator::SemiImplicitEulerExplicitDamper,
        Integrator::EnergyConserving,
    ];
    let paths = [PathMode::Extrapolate, PathMode::Hold, PathMode::Hermite];
    Config {
        sample_rate_hz,
        probe,
        integrator: integrators[rng.next_u32() as usize % 4],
        path: paths[rng.next_u32() as usize % 3],
        ..Config::default()
    }
}

#[test]
fn adversarial_parameters_and_events_never_make_energy() {
    let mut rng = Rng::new(29);
    let mut accepted = 0;
    for case in 0..400 {
        let config = adversarial(&mut rng);
        if config.clone().build().is_err() {
            continue;
        }
        accepted += 1;
        let what = format!(
            "case {case}: {:?} {:?} at {} Hz",
            config.probe, config.integrator, config.sample_rate_hz
        );
        let stiffness_n_m = config.probe.contact_stiffness_n_m;
        let surface = if case % 2 == 0 { plate(rng.uniform()) } else { grating(1e-3, 2e-4 * rng.uniform()) };
        let mut run = Run::new(config, surface);
        run.begin(ContactSample { closing_m_s: 0.3 * rng.uniform(), ..pressed(0.1, 0.1, 1.0) });
        let mut most: Peaks = Peaks { haptic: 0.0, audio: 0.0 };
        for _ in 0..12 {
            let force_n = [0.0, 0.01, 0.5, 5.0, -1.0][rng.next_u32() as usize % 5];
            run.moved(pressed(rng.uniform(), 2.0 * rng.uniform() - 1.0, force_n));
            let now = run.render(0.004);
            most = Peaks { haptic: most.haptic.max(now.haptic), audio: most.audio.max(now.audio) };
        }
        let bound = 10.0 * (5.0 / stiffness_n_m + 2e-3) + 0.3 * 0.05;
        assert!(f64::from(most.haptic) < bound, "{what}: {} m", most.haptic);
        assert!(most.audio < 1e6, "{what}: {}", most.audio);
        run.must_fall_silent(&what);
    }
    assert!(accepted > 150, "only {accepted} configs were accepted");
}

#[test]
fn a_soak_of_four_minutes_with_ever_new_events_stays_level() {
    let mut rng = Rng::new(2);
    // 8 kHz: as many samples as CI has time for.
    let mut run = Run::new(Config { sample_rate_hz: 8000.0, ..Config::default() }, grating(2e-3, 5e-5));
    run.begin(pressed(0.0, 0.1, 0.5));
    let mut minutes = Vec::new();
    for _ in 0..4 {
        let mut peaks = Peaks { haptic: 0.0, audio: 0.0 };
        let mut u = 0.0;
        for _ in 0..600 {
            let speed_m_s = 0.4 * rng.uniform() - 0.2;
            u += 0.1 * speed_m_s / SIDE_M;
            run.moved(pressed(u, speed_m_s, 3.0 * rng.uniform()));
            let now = run.render(0.1);
            peaks = Peaks { haptic: peaks.haptic.max(now.haptic), audio: peaks.audio.max(now.audio) };
        }
        minutes.push(peaks);
    }
    let (first, last) = (minutes[0], minutes[3]);
    assert!(last.haptic < 2.0 * first.haptic && last.audio < 4.0 * first.audio, "{minutes:?}");
    run.must_fall_silent("soak");
}

#[test]
fn a_body_struck_a_hundred_thousand_times_rings_out_all_the_same() {
    let mode = Mode { frequency_hz: 30.0, decay_per_s: 0.69, amplitude: 1.0, phase_rad: 0.0 };
    let asperity::Engine { mut scene, mut renderer, .. } =
        Config { sample_rate_hz: 48_000.0, ..Config::default() }.build().unwrap();
    let body = scene.add_body(ModalModel::new(vec![mode], 1e-3).unwrap()).unwrap();
    let (mut haptic, mut audio) = (vec![0.0; 480], vec![0.0; 480]);
    let mut peak = 0.0f32;
    for step in 0..1000 {
        for _ in 0..100 {
            let impact = Impact {
                body,
                other: None,
                speed_m_s: 0.01,
                mass_kg: 1e-4,
                radius_m: 1e-3,
                striker: Material::STEEL,
                restitution: 1.0,
                position: 0,
                ..Impact::on(body)
            };
            scene.report(f64::from(step) * 0.01, ContactEvent::Impact(impact)).unwrap();
        }
        renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        peak = audio.iter().fold(peak, |p, x| p.max(x.abs()));
    }
    assert!(peak.is_finite() && peak > 0.0);
    // 10 s of T60, and the rest of the way to the threshold of sleep.
    for _ in 0..6000 {
        renderer.render(&mut [&mut haptic], &mut [&mut audio]);
    }
    assert!(audio.iter().all(|x| *x == 0.0), "{:?}", &audio[..4]);
}
