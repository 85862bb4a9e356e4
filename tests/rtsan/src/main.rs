//! A minute of randomised events, swaps and removals, rendered inside a function that the real-time
//! sanitizer watches: any allocation, lock or blocking system call in it ends the program with a trace.

use asperity::texture::height_map::HeightMap;
use asperity::{
    Actuator, BodyId, Config, ContactEvent, ContactId, ContactSample, Extent, Impact, Material, ModalModel, Mode,
    Renderer, Scene, Surface, SurfaceId,
};
use asperity_dsp::rng::Rng;
use rtsan_standalone::nonblocking;
use std::error::Error;

const SIDE_M: f64 = 0.1;

#[nonblocking]
fn watched(renderer: &mut Renderer, haptic: &mut [f32], audio: &mut [f32]) {
    renderer.render(&mut [haptic], &mut [audio]);
}

#[nonblocking]
fn broken() -> usize {
    std::hint::black_box(vec![0u8; 1000]).len()
}

fn main() -> Result<(), Box<dyn Error>> {
    rtsan_standalone::ensure_initialized();
    if std::env::args().any(|argument| argument == "--broken") {
        println!("{} bytes allocated unnoticed: the sanitizer is off", broken());
        return Ok(());
    }
    let config = Config { max_contacts: 6, contact_timeout_s: 0.05, ..Config::default() };
    let (mut scene, mut renderer) = config.build()?;
    let mut body = scene.add_body(bar()?)?;
    let mut surface = scene.add_surface(plate(body)?)?;
    let mut rng = Rng::new(11);
    let (mut haptic, mut audio) = ([0.0f32; 256], [0.0f32; 256]);
    let mut step = 0u64;
    while renderer.position() < 60 * 44_100 {
        let time_s = renderer.position() as f64 / renderer.sample_rate_hz();
        for _ in 0..4 {
            // Refusals are part of the game.
            let _ = scene.report(time_s, random_event(&mut rng, surface, body));
        }
        step += 1;
        if step.is_multiple_of(50) {
            let _ = scene.replace_surface(surface, plate(body)?);
            let _ = scene.replace_body(body, bar()?, Material::GLASS);
        }
        if step.is_multiple_of(501) {
            scene.remove_surface(surface)?;
            scene.remove_body(body)?;
            body = scene.add_body(bar()?)?;
            surface = scene.add_surface(plate(body)?)?;
        }
        watched(&mut renderer, &mut haptic, &mut audio);
    }
    println!("no blocking call: {:?}", scene.stats());
    Ok(())
}

fn random_event(rng: &mut Rng, surface: SurfaceId, body: BodyId) -> ContactEvent {
    let contact = ContactId(u64::from(rng.next_u32() % 12));
    let sample = ContactSample {
        uv: [rng.uniform(), rng.uniform()],
        velocity_m_s: Some([0.3 * rng.uniform(), 0.0]),
        normal_force_n: 2.0 * rng.uniform(),
        closing_m_s: 0.1 * rng.uniform(),
    };
    match rng.next_u32() % 8 {
        0 | 1 => ContactEvent::begin(contact, surface, Actuator(0), sample),
        2 => ContactEvent::end(contact),
        3 => ContactEvent::Impact(Impact {
            body,
            other: None,
            speed_m_s: 1.0,
            mass_kg: 0.01,
            radius_m: 0.005,
            striker: Material::STEEL,
            restitution: 0.7,
            position: 0,
        }),
        _ => ContactEvent::moved(contact, sample),
    }
}

fn bar() -> Result<ModalModel, Box<dyn Error>> {
    let mode = |frequency_hz| Mode { frequency_hz, decay_per_s: 12.0, amplitude: 0.2, phase_rad: 0.0 };
    Ok(ModalModel::new(vec![mode(412.0), mode(1133.0), mode(2219.0)], 0.01)?)
}

fn plate(body: BodyId) -> Result<Surface, Box<dyn Error>> {
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    Ok(Surface::new(HeightMap::flat(extent, 0.8)?, SIDE_M, SIDE_M)?.on(body))
}
