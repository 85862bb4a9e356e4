//! The scenes of the demo: what is in each folder before anything is rendered.

use super::demo_scene::DemoScene;
use super::plates::{PLATES, Plate, RELIEF_M, SIDE_M};
use super::strokes::{Finger, log, strike};
use asperity::files::contact_log::Striker;
use asperity::{ModalModel, Mode};
use asperity_plot::pixels;

/// Seconds before the first event, so that a player that fades in cuts nothing off.
pub const LEAD_S: f64 = 0.15;

/// Every scene of the demo, in the order of the index.
#[must_use]
pub fn scenes() -> Vec<DemoScene> {
    let mut scenes: Vec<DemoScene> = PLATES.iter().map(plate_scene).collect();
    scenes.push(struck());
    scenes.push(super::knuckle::scene());
    scenes.push(scraped());
    scenes.push(super::touchers::scene());
    scenes.extend(super::gallery::scenes());
    scenes.push(super::answering::scene());
    scenes.push(super::bowl::scene());
    scenes
}

/// A plate stroked across and back, slowly and fast.
#[must_use]
pub fn plate_scene(plate: &Plate) -> DemoScene {
    let (side, grey) = plate.displacement();
    let (rough_side, rough) = plate.roughness();
    let name = plate.name;
    let finger = Finger {
        contact: 1,
        surface: "plate",
        extent_m: [SIDE_M; 2],
        start_s: LEAD_S,
        normal_force_n: 0.6,
        // Along a row of bumps: the bow of a hand is 3 mm, as wide as a bump's half.
        from_m: [0.018, 0.065],
        strokes: vec![([0.122, 0.066], 0.08), ([0.018, 0.07], 0.2)],
    };
    let toml = format!(
        "# {title}: a plate of the Hasti study, stroked across at 80 mm/s and back at 200 mm/s.\n\
         contacts = \"{name}.jsonl\"\n\
         tail_s = 0.4\n\n\
         [[body]]\n\
         name = \"plate\"\n\
         modes = \"plate.modes.json\"\n\
         material = \"pla\"\n\n\
         [[surface]]\n\
         name = \"plate\"\n\
         body = \"plate\"\n\
         displacement = \"{name}.displacement.png\"\n\
         roughness = \"{name}.roughness.png\"\n\
         width_m = {SIDE_M}\n\
         height_m = {SIDE_M}\n\
         relief_m = {RELIEF_M}\n\
         wrap = \"clamp\"\n\n\
         [[actuator]]\n\
         output = \"displacement\"\n\
         full_scale = {full_scale}          # metres at sample value 1\n\n\
         [audio]\n\
         gain = {PLATE_GAIN}\n",
        title = plate.title,
        full_scale = plate.full_scale_m,
    );
    DemoScene {
        name,
        title: plate.title,
        notice: plate.notice,
        toml,
        log: log(finger.lines()),
        assets: vec![
            (format!("{name}.displacement.png"), pixels::png16(side, side, &grey)),
            (format!("{name}.roughness.png"), pixels::png8(rough_side, rough_side, &rough)),
        ],
    }
}

/// One gain for all six plates, so that their loudness can be compared.
const PLATE_GAIN: f64 = 5.0;

/// Modes of a free round plastic plate: its first bending modes, ω ∝ λ², heavily damped.
///
/// λ² of a free circular plate with Poisson ratio 0.33: 5.25 (2,0), 9.08 (0,1), 12.2 (3,0), 20.5
/// (1,1), 21.5 (4,0), 33.1 (5,0), 35.3 (2,1), 38.6 (0,2), 53.0 (3,1) (Leissa 1969, rounded). A
/// printed disc of 140 mm × 5 mm puts the first near 430 Hz. Amplitudes and damping are chosen, not
/// measured.
#[must_use]
pub fn plate_modes() -> ModalModel {
    const LAMBDA2: [f64; 9] = [5.25, 9.08, 12.2, 20.5, 21.5, 33.1, 35.3, 38.6, 53.0];
    let hz = LAMBDA2.map(|lambda2| 430.0 * lambda2 / LAMBDA2[0]);
    free("free circular plate, chosen damping", &hz, |hz| 25.0 + 0.03 * hz, 0.35)
}

/// Modes of a free steel bar (Euler–Bernoulli, f ∝ (2n+1)²), as a glockenspiel's.
#[must_use]
pub fn bar_modes() -> ModalModel {
    let hz = [1.0, 2.756, 5.404, 8.933, 13.34, 18.64].map(|ratio| 784.0 * ratio);
    free("free bar, chosen damping", &hz, |hz| 3.0 + 2.5e-7 * hz * hz, 1.0)
}

/// A free body of these frequencies; amplitudes fall by `fall` from mode to mode.
fn free(source: &str, hz: &[f64], decay_per_s: fn(f64) -> f64, fall: f64) -> ModalModel {
    let mode = |(index, &frequency_hz): (usize, &f64)| Mode {
        frequency_hz,
        decay_per_s: decay_per_s(frequency_hz),
        amplitude: 0.3 / (1.0 + fall * index as f64),
        phase_rad: 0.0,
    };
    let modes = hz.iter().enumerate().map(mode).collect();
    ModalModel { source: source.to_owned(), impulse_n_s: 0.01, modes, ..ModalModel::silent() }
}

/// A tile fitted from a recording and a steel bar, struck by hard and soft things.
fn struck() -> DemoScene {
    const BALL: (f64, f64) = (0.008, 0.006);
    let mut lines = Vec::new();
    let mut t = LEAD_S;
    for body in ["tile", "bar"] {
        for striker in ["steel", "wood", "rubber"] {
            for speed_m_s in [0.3, 0.6, 1.2] {
                lines.push(strike(t, (body, None), speed_m_s, Striker::Preset(striker.to_owned()), BALL));
                t += 0.28;
            }
            t += 0.2;
        }
    }
    DemoScene {
        name: "struck",
        title: "A struck tile and a struck bar",
        notice: "Nine strikes on a tile whose modes were fitted from tile_strike.wav, then nine on a steel bar: \
                 three with a steel ball, three with wood, three with rubber, each harder than the last. A \
                 softer striker stays longer and sounds duller (Hertz).",
        toml: "# Impacts of rigid strikers, as a physics engine reports them.\n\
               contacts = \"struck.jsonl\"\n\
               tail_s = 1.2\n\n\
               [[body]]\n\
               name = \"tile\"\n\
               modes = \"tile.modes.json\"      # fitted from tile_strike.wav\n\
               material = \"ceramic\"\n\n\
               [[body]]\n\
               name = \"bar\"\n\
               modes = \"bar.modes.json\"\n\
               material = \"steel\"\n\n\
               [audio]\n\
               gain = 0.5\n"
            .to_owned(),
        log: log(lines),
        assets: Vec::new(),
    }
}

/// A stick run over a ribbed bar, back and forth, faster each time.
fn scraped() -> DemoScene {
    const LENGTH_M: f64 = 0.2;
    const WIDTH_M: f64 = 0.04;
    let finger = Finger {
        contact: 1,
        surface: "ribs",
        extent_m: [LENGTH_M, WIDTH_M],
        start_s: LEAD_S,
        normal_force_n: 0.8,
        from_m: [0.02, 0.02],
        strokes: vec![([0.18, 0.02], 0.1), ([0.02, 0.02], 0.2), ([0.18, 0.02], 0.4), ([0.02, 0.02], 0.7)],
    };
    let columns = 1024;
    let grey: Vec<u16> = (0..columns)
        .map(|column| {
            let x = (f64::from(column) + 0.5) / f64::from(columns) * LENGTH_M;
            // Round ribs with sharp valleys, 4 mm apart.
            let height = (std::f64::consts::PI * x / 0.004).sin().abs();
            (height * 65_535.0) as u16
        })
        .collect();
    let rows = 16;
    let map: Vec<u16> = (0..rows).flat_map(|_| grey.iter().copied()).collect();
    DemoScene {
        name: "scraped",
        title: "A scraped bar",
        notice: "A wooden stick runs over the ribs of a steel bar at 100, 200, 400 and 700 mm/s. The rattle is \
                 the speed over 4 mm; the ringing is the bar's own and does not change.",
        toml: format!(
            "# A light, stiff stick over ribs: the pad leaves the surface and every landing is an impact.\n\
             contacts = \"scraped.jsonl\"\n\
             tail_s = 1.5\n\n\
             [[body]]\n\
             name = \"bar\"\n\
             modes = \"bar.modes.json\"\n\
             material = \"steel\"\n\n\
             [[surface]]\n\
             name = \"ribs\"\n\
             body = \"bar\"\n\
             displacement = \"scraped.displacement.png\"\n\
             roughness = 0.4\n\
             width_m = {LENGTH_M}\n\
             height_m = {WIDTH_M}\n\
             relief_m = 0.0006\n\
             wrap = \"clamp\"\n\n\
             [probe]                    # the tip of a stick, not a fingertip\n\
             pad_mass_kg = 0.002\n\
             pad_stiffness_n_m = 4000.0\n\
             pad_damping_n_s_m = 0.5\n\
             finger_mass_kg = 0.05\n\
             contact_stiffness_n_m = 1e6\n\n\
             [[actuator]]\n\
             full_scale = 0.002\n\n\
             [audio]\n\
             gain = 0.3\n"
        ),
        log: log(finger.lines()),
        assets: vec![("scraped.displacement.png".to_owned(), pixels::png16(columns as usize, rows, &map))],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity::files::scene_file::SceneFile;

    #[test]
    fn every_scene_of_the_demo_is_a_valid_scene_file() {
        for scene in scenes() {
            let path = std::path::PathBuf::from(format!("{}.toml", scene.name));
            let file = SceneFile::parse(&scene.toml, &path).unwrap();
            assert_eq!(file.contacts.unwrap(), std::path::PathBuf::from(format!("{}.jsonl", scene.name)));
            assert!(scene.log.lines.windows(2).all(|pair| pair[1].t >= pair[0].t), "{}", scene.name);
        }
    }
}
