//! Many fingers: the engine tells every source its rate and its contacts, so that nobody feels nothing because a number was not passed on.

mod common;

use asperity::texture::sand::{SandDesign, SandSource};
use asperity::texture::solid_materials::SolidMaterial;
use asperity::texture::solid_noise::SolidNoise;
use asperity::{
    Actuator, AddError, Config, ContactBlock, ContactEvent, ContactId, ContactSample, Engine, Surface, Tap,
};
use std::collections::HashMap;

const SIDE_M: f64 = 0.25;

/// Lowest and highest profile of each contact, m.
#[derive(Default)]
struct Felt(HashMap<u64, [f64; 2]>);

impl Tap for Felt {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        let felt = self.0.entry(block.contact.0).or_insert([f64::INFINITY, f64::NEG_INFINITY]);
        for row in block.contact_samples {
            *felt = [felt[0].min(row.height_m), felt[1].max(row.height_m)];
        }
    }
}

/// So many fingers side by side stroke a surface for 0.4 s; what each of them felt, from highest to lowest, m.
fn strokes(surface: Surface, fingers: u64) -> Vec<f64> {
    let Engine { mut scene, mut renderer, .. } = Config::default().build().unwrap();
    let surface = scene.add_surface(surface.micro_relief_m(0.0)).unwrap();
    let mut felt = Felt::default();
    for step in 0..24 {
        let t = f64::from(step) / 60.0;
        for finger in 0..fingers {
            let sample = ContactSample {
                uv: [0.2 + 0.08 * t / SIDE_M, 0.05 + 0.9 * finger as f64 / fingers as f64],
                velocity_m_s: Some([0.08, 0.0]),
                normal_force_n: 0.6,
                closing_m_s: 0.0,
            };
            let event = match step {
                0 => ContactEvent::begin(ContactId(finger), surface, Actuator(0), sample),
                _ => ContactEvent::moved(ContactId(finger), sample),
            };
            scene.report(t, event).unwrap();
        }
        let (mut haptic, mut audio) = ([0.0; 735], [0.0; 735]);
        renderer.render_tapped(&mut [&mut haptic], &mut [&mut audio], &mut felt);
    }
    assert_eq!(scene.stats().stolen + scene.stats().orphaned, 0);
    (0..fingers).map(|finger| felt.0.get(&finger).map_or(0.0, |[low, high]| high - low)).collect()
}

fn sand(rate_hz: f64) -> Surface {
    let design = SandDesign { cells: 128, ..SandDesign::default() };
    Surface::new(SandSource::synchronous(&design, 1, rate_hz).unwrap(), SIDE_M, SIDE_M).unwrap()
}

#[cfg(feature = "brownian")]
fn brownian_path() -> Surface {
    use asperity::texture::brownian::{BrownianDesign, rendering::BrownianPath};
    let heights_m = BrownianDesign::new(0.5, 1e-4, 3).path().unwrap();
    Surface::new(BrownianPath::new(&heights_m, 1e-4, None, 1).unwrap(), SIDE_M, SIDE_M).unwrap()
}

fn solid() -> Surface {
    let gravel = SolidNoise::new(SolidMaterial::Gravel.parameters(), 1, 44_100.0).unwrap();
    Surface::new(gravel, SIDE_M, SIDE_M).unwrap()
}

#[test]
fn twenty_and_sixty_four_fingers_on_sand_a_brownian_path_and_a_solid_all_feel_it() {
    for fingers in [20, 64] {
        let surfaces = [
            ("sand", sand(44_100.0)),
            ("solid", solid()),
            #[cfg(feature = "brownian")]
            ("Brownian path", brownian_path()),
        ];
        for (name, surface) in surfaces {
            let felt = strokes(surface, fingers);
            let least = felt.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(least > 1e-6, "of {fingers} fingers on {name} one feels {least} m: {felt:?}");
        }
    }
}

#[cfg(feature = "brownian")]
#[test]
fn fingers_on_a_brownian_path_each_go_their_own_way_along_it() {
    // They all begin at its origin and go as fast: alike, where a shared state would send some of them on.
    let felt = strokes(brownian_path(), 20);
    assert!(felt.iter().all(|x| (x - felt[0]).abs() < 1e-12), "{felt:?}");
}

#[test]
fn sand_that_was_made_for_another_rate_is_simulated_at_the_engines() {
    assert_eq!(strokes(sand(8_000.0), 3), strokes(sand(44_100.0), 3));
}

#[test]
fn sand_that_is_simulated_elsewhere_for_fewer_contacts_than_the_engine_has_is_refused() {
    let Engine { mut scene, .. } = Config::default().build().unwrap();
    let design = SandDesign { cells: 64, contacts: 16, ..SandDesign::default() };
    let (source, _worker) = SandSource::threaded(&design, 1, 44_100.0).unwrap();
    let refused = scene.add_surface(Surface::new(source, SIDE_M, SIDE_M).unwrap()).unwrap_err();
    assert!(matches!(&refused, AddError::Design(error) if error.field == "contacts"), "{refused}");
    let (source, _worker) =
        SandSource::threaded(&SandDesign { contacts: 96, ..design }, 1, 44_100.0).unwrap();
    assert!(scene.add_surface(Surface::new(source, SIDE_M, SIDE_M).unwrap()).is_ok());
}
