//! Many fingers: the engine tells every source its rate and its contacts, so that nobody feels
//! nothing because a number was not passed on.

use asperity::surface::combine::Crossfade;
use asperity::surface::height_field::{HeightField, PathBlock, Setup, SurfaceBlock};
use asperity::surface::height_map::HeightMap;
use asperity::surface::raster::Raster;
use asperity::surface::sand::{SandDesign, SandSource};
use asperity::surface::solid_materials::SolidMaterial;
use asperity::surface::solid_noise::SolidNoise;
use asperity::{
    ChannelId, Config, ContactBlock, ContactEvent, ContactId, ContactSample, Engine, Extent, Surface, Tap,
    Wrap,
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

/// So many fingers side by side stroke a surface for 0.4 s; what each of them felt, from highest to
/// lowest, m.
fn strokes(surface: Surface, fingers: u64) -> Vec<f64> {
    strokes_beside(surface, fingers, || ())
}

/// The same beside something that is done 60 times a second.
fn strokes_beside(surface: Surface, fingers: u64, mut frame: impl FnMut()) -> Vec<f64> {
    let max_contacts = fingers.max(64) as usize;
    let Engine { mut scene, mut renderer, .. } =
        Config { max_contacts, ..Config::default() }.build().unwrap();
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
                ..ContactSample::default()
            };
            let event = match step {
                0 => ContactEvent::begin(ContactId(finger), surface, ChannelId(0), sample),
                _ => ContactEvent::moved(ContactId(finger), sample),
            };
            scene.report(t, event).unwrap();
        }
        frame();
        let (mut haptic, mut audio) = ([0.0; 735], [0.0; 735]);
        renderer.render_tapped(&mut [&mut haptic], &mut [&mut audio], &mut felt);
    }
    assert_eq!(scene.stats().stolen + scene.stats().orphaned, 0);
    (0..fingers).map(|finger| felt.0.get(&finger).map_or(0.0, |[low, high]| high - low)).collect()
}

fn sand() -> Surface {
    let design = SandDesign { cells: 128, ..SandDesign::default() };
    Surface::new(SandSource::synchronous(&design, 1).unwrap(), SIDE_M, SIDE_M).unwrap()
}

#[cfg(feature = "brownian")]
fn brownian_path() -> Surface {
    use asperity::surface::brownian::{BrownianDesign, rendering::BrownianPath};
    let heights_m = BrownianDesign::new(0.5, 1e-4, 3).path().unwrap();
    Surface::new(BrownianPath::new(&heights_m, 1e-4, None).unwrap(), SIDE_M, SIDE_M).unwrap()
}

fn solid() -> Surface {
    let gravel = SolidNoise::new(SolidMaterial::Gravel.parameters(), 1).unwrap();
    Surface::new(gravel, SIDE_M, SIDE_M).unwrap()
}

#[test]
fn sixty_four_fingers_on_sand_path_and_solid_feel_it() {
    for fingers in [20, 64] {
        let surfaces = [
            ("sand", sand()),
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
    // They all begin at its origin and go as fast: alike, where a shared state would send some of
    // them on.
    let felt = strokes(brownian_path(), 20);
    assert!(felt.iter().all(|x| (x - felt[0]).abs() < 1e-12), "{felt:?}");
}

#[test]
fn sand_simulated_elsewhere_is_felt_by_more_fingers_than_planned() {
    let design = SandDesign { cells: 128, ..SandDesign::default() };
    let (source, mut worker) = SandSource::threaded(&design, 1).unwrap();
    let surface = Surface::new(source, SIDE_M, SIDE_M).unwrap();
    let felt = strokes_beside(surface, 120, || worker.frame());
    let least = felt.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(least > 1e-6, "one of 120 fingers feels {least} m: {felt:?}");
}

#[test]
fn a_crossfade_comes_at_its_second_whatever_the_rate_of_the_engine() {
    let plate = |height_m: f64| -> Box<dyn HeightField> {
        let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: height_m };
        let raster = Raster { width: 4, height: 4, values: vec![1.0; 16] };
        Box::new(HeightMap::new(&raster, extent, Wrap::Repeat).unwrap())
    };
    for rate_hz in [44_100.0, 48_000.0, 96_000.0] {
        let mut fade = Crossfade::new(plate(0.0), plate(1e-3)).at_s(0.5);
        fade.prepare(&Setup { sample_rate_hz: rate_hz, voices: 1, tip_radii_m: &[] }).unwrap();
        let mut height_at = |time_s: f64| {
            let mut out = SurfaceBlock::default();
            let path = PathBlock {
                position_m: &[[0.1, 0.1]],
                velocity_m_s: &[[0.0; 2]],
                footprint_m: &[1e-6],
                normal_force_n: &[],
                first_sample: (time_s * rate_hz).round() as u64,
                contact: 0,
                slopes: false,
                ..PathBlock::default()
            };
            fade.sample(&path, &mut out);
            out.height_m[0]
        };
        let heights = [0.5, 0.55, 0.6].map(&mut height_at);
        assert!(
            heights[0] == 0.0 && (heights[1] - 5e-4).abs() < 1e-6 && heights[2] > 0.999e-3,
            "{heights:?}"
        );
    }
}
