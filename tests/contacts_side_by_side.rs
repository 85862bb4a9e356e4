//! Contacts that are rendered together have the bits of each alone, whatever they are and however
//! the time is cut.

use crate::common;

use asperity::{
    ActuatorSettings, AudioBus, Body, BusId, ChannelId, Config, ContactEvent, ContactId, ContactSample,
    Engine, Excitation, Integrator, Material, ModalModel, Mode, ProbeId, Quantity, SurfaceId, Touching,
    probe_by_name,
};
use asperity_dsp::rng::Rng;
use common::{SIDE_M, grating};

/// What one contact does: when each report is due, s, and what it says.
struct Game {
    reports: Vec<Vec<(f64, Step)>>,
    seconds: f64,
}

#[derive(Clone, Copy)]
enum Step {
    Begin(ContactSample),
    Move(ContactSample),
    End,
}

/// Contacts that come, jump, press lightly or hard, stop and go, at times of their own.
fn game(rng: &mut Rng, contacts: usize, seconds: f64) -> Game {
    let mut reports = Vec::new();
    for _ in 0..contacts {
        let mut own = Vec::new();
        let mut t = 0.2 * rng.uniform();
        let mut uv = [rng.uniform(), rng.uniform()];
        let mut on = false;
        let press_n = 0.02 + 1.5 * rng.uniform() * rng.uniform();
        while t < seconds {
            let speed_m_s = [0.3 * rng.normal(), 0.1 * rng.normal()];
            let rests = rng.uniform() < 0.15;
            let speed_m_s = if rests { [0.0; 2] } else { speed_m_s };
            let sample = ContactSample::new(uv, press_n * (0.5 + rng.uniform()));
            let sample = if rng.uniform() < 0.7 { sample.sliding(speed_m_s) } else { sample };
            own.push((
                t,
                match (on, rng.uniform() < 0.05) {
                    (false, _) => {
                        on = true;
                        let closing_m_s = if rng.uniform() < 0.5 { 0.2 * rng.uniform() } else { 0.0 };
                        Step::Begin(ContactSample { closing_m_s, ..sample })
                    }
                    (true, true) => {
                        on = false;
                        Step::End
                    }
                    (true, false) => Step::Move(sample),
                },
            ));
            let step_s = 0.004 + 0.03 * rng.uniform();
            uv = [uv[0] + speed_m_s[0] * step_s / SIDE_M, uv[1] + speed_m_s[1] * step_s / SIDE_M];
            t += step_s;
        }
        reports.push(own);
    }
    Game { reports, seconds }
}

fn ringing(seed: u64) -> ModalModel {
    let mode = |i: usize| Mode {
        frequency_hz: 300.0 + 170.0 * i as f64 + 13.0 * seed as f64,
        decay_per_s: 20.0,
        amplitude: 0.2,
        phase_rad: 0.0,
    };
    ModalModel::new((0..9).map(mode).collect(), 0.01).unwrap()
}

/// How the contacts of a game are to be rendered.
struct Setting {
    config: Config,
    probes: Vec<Option<&'static str>>,
    /// Surfaces, one for several contacts.
    shared_by: usize,
}

/// Renders those contacts of a game that `plays` says, in blocks of random lengths; the outputs of
/// each contact's channel and bus.
fn render(game: &Game, setting: &Setting, seed: u64, plays: impl Fn(usize) -> bool) -> Vec<[Vec<u32>; 2]> {
    let count = game.reports.len();
    let mut rng = Rng::new(seed);
    let Engine { mut scene, mut renderer, .. } = setting.config.clone().build().unwrap();
    let probes: Vec<Option<ProbeId>> = setting
        .probes
        .iter()
        .map(|name| name.map(|name| scene.add_probe(probe_by_name(name).unwrap()).unwrap()))
        .collect();
    let surfaces: Vec<SurfaceId> = (0..count)
        .map(|i| {
            let body = Body::new(ringing(i as u64)).material(Material::CERAMIC).bus(BusId(i));
            let ground = grating(1e-3 + 0.4e-3 * (i / setting.shared_by) as f64, 3e-5).micro_relief_m(1e-5);
            let body = scene.add_body(body).unwrap();
            scene.add_surface(ground.body(body).excitation(Excitation::BOTH)).unwrap()
        })
        .collect();
    let mut due: Vec<(f64, usize, Step)> = Vec::new();
    for (contact, reports) in game.reports.iter().enumerate().filter(|(contact, _)| plays(*contact)) {
        due.extend(reports.iter().map(|(t, step)| (*t, contact, *step)));
    }
    due.sort_by(|a, b| a.0.total_cmp(&b.0));
    let rate_hz = setting.config.sample_rate_hz;
    let samples = (game.seconds * rate_hz) as usize;
    let (mut haptic, mut audio) = (vec![vec![0.0f32; samples]; count], vec![vec![0.0f32; samples]; count]);
    let (mut at, mut next) = (0, 0);
    while at < samples {
        let end = (at + 1 + (200.0 * rng.uniform()) as usize).min(samples);
        while let Some((t, contact, step)) = due.get(next).filter(|(t, ..)| t * rate_hz < end as f64) {
            let id = ContactId(1 + *contact as u64);
            let mut touching = Touching::on(surfaces[*contact / setting.shared_by * setting.shared_by])
                .felt_by(ChannelId(*contact as u16));
            touching.probe = probes[*contact];
            scene
                .report(
                    *t,
                    match *step {
                        Step::Begin(sample) => ContactEvent::begin_with(id, touching, sample),
                        Step::Move(sample) => ContactEvent::moved(id, sample),
                        Step::End => ContactEvent::end(id),
                    },
                )
                .unwrap();
            next += 1;
        }
        let mut felt: Vec<&mut [f32]> = haptic.iter_mut().map(|channel| &mut channel[at..end]).collect();
        let mut heard: Vec<&mut [f32]> = audio.iter_mut().map(|channel| &mut channel[at..end]).collect();
        renderer.render(&mut felt, &mut heard);
        scene.collect();
        at = end;
    }
    let bits = |samples: Vec<f32>| samples.into_iter().map(f32::to_bits).collect();
    haptic.into_iter().zip(audio).map(|(haptic, audio)| [bits(haptic), bits(audio)]).collect()
}

#[test]
fn a_random_games_contacts_have_the_bits_they_have_alone() {
    let mut rng = Rng::new(31);
    let names = [None, Some("fingertip"), Some("stylus"), Some("rigid")];
    let outputs = [Quantity::Displacement, Quantity::Acceleration, Quantity::Tangential];
    for round in 0..8 {
        let count = 2 + (8.0 * rng.uniform()) as usize;
        let pick = |rng: &mut Rng, n: usize| (n as f64 * rng.uniform()) as usize;
        let actuators = (0..count)
            .map(|_| ActuatorSettings {
                // Most alike, so that they have company.
                output: if rng.uniform() < 0.7 { Quantity::Displacement } else { outputs[pick(&mut rng, 3)] },
                highpass_hz: if rng.uniform() < 0.8 { 10.0 } else { 0.0 },
                ..ActuatorSettings::default()
            })
            .collect();
        let config = Config {
            sample_rate_hz: [44.1e3, 22.05e3, 48e3, 96e3][round % 4],
            integrator: if round < 5 { Integrator::ExactEvent } else { Integrator::ALL[pick(&mut rng, 4)] },
            oversampling: if round == 3 { 2 } else { 1 },
            threads: if round % 3 == 2 { 3 } else { 1 },
            actuators,
            audio: vec![AudioBus::default(); count],
            ..Config::default()
        };
        let probes = (0..count).map(|_| names[pick(&mut rng, names.len())]).collect();
        let setting = Setting { config, probes, shared_by: 1 + pick(&mut rng, 3) };
        let game = game(&mut rng, count, 0.6);
        let together = render(&game, &setting, round as u64, |_| true);
        let again = render(&game, &setting, 100 + round as u64, |_| true);
        assert!(together == again, "round {round}: blocks show");
        for (contact, together) in together.iter().enumerate() {
            let alone = render(&game, &setting, 1000 + contact as u64, |other| other == contact);
            let [felt, heard] = &alone[contact];
            assert!(felt.iter().any(|x| f32::from_bits(*x) != 0.0), "round {round}: {contact} feels nothing");
            assert!(*felt == together[0], "round {round}: {contact} of {count} feels something else alone");
            // A body under several surfaces' contacts is heard by all of them.
            if setting.shared_by == 1 {
                assert!(*heard == together[1], "round {round}: {contact} of {count} sounds otherwise alone");
            }
        }
    }
}
