//! A woven cloth: a surface source of one's own, in one file.
//!
//! ```text
//! h(u, v) = a · cos(2πu/p) · cos(2πv/p)      p: pitch of the threads, a: half of their height
//! ```
//! [`Woven`] is all a source is: its properties and its heights along a path. [`ThreadHeight`] is
//! the change that it takes: the game thickens the threads while fingers stroke them. [`make`] is
//! its key in scene files, `own = { kind = "woven", pitch_m = 1e-3, height_m = 2e-5 }`.
//!
//! Run `cargo run --release -p asperity-own-source`: a finger strokes the cloth of a scene file,
//! then one whose threads grow.

use asperity::files::FileError;
use asperity::files::scene_file::{OwnSource, SceneFile};
use asperity::load::Overrides;
use asperity::surface::fade::Fade;
use asperity::surface::height_field::{
    HeightField, PathBlock, Properties, Setup, SurfaceBlock, WavelengthBand,
};
use asperity::{
    ActuatorSettings, ChannelId, Config, ContactEvent, ContactId, ContactSample, DesignError, Engine,
    Renderer, Scene, Surface, SurfaceId,
};
use std::any::Any;
use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

/// A woven cloth.
struct Woven {
    pitch_m: f64,
    /// Half of the threads' height, over absolute samples: every finger feels the same at the same
    /// sample, in blocks of any length.
    amplitude_m: Fade<f64>,
}

/// Change of a [`Woven`] while it is touched: height of its threads, m.
struct ThreadHeight(f64);

/// What a scene says of a cloth.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Cloth {
    pitch_m: f64,
    height_m: f64,
}

impl Cloth {
    fn weave(&self) -> Woven {
        Woven { pitch_m: self.pitch_m, amplitude_m: Fade::new(0.5 * self.height_m) }
    }
}

/// The scene key.
fn make(own: &OwnSource, _size_m: [f64; 2]) -> Result<Box<dyn HeightField>, FileError> {
    Ok(Box::new(own.read::<Cloth>()?.weave()))
}

impl HeightField for Woven {
    fn properties(&self, _tile_m: [f64; 2]) -> Properties {
        Properties::of(WavelengthBand { shortest_m: self.pitch_m, longest_m: self.pitch_m })
    }

    /// Samples are counted anew, at this rate.
    fn prepare(&mut self, setup: &Setup<'_>) -> Result<(), DesignError> {
        self.amplitude_m.prepare(setup.sample_rate_hz);
        Ok(())
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let turn = TAU / self.pitch_m;
        out.clear(path.len());
        for (i, [u_m, v_m]) in path.position_m.iter().enumerate() {
            let amplitude_m = self.amplitude_m.at(path.first_sample + i as u64);
            let ((su, cu), (sv, cv)) = ((turn * u_m).sin_cos(), (turn * v_m).sin_cos());
            out.height_m[i] = amplitude_m * cu * cv;
            out.gradient[i] = [-amplitude_m * turn * su * cv, -amplitude_m * turn * cu * sv];
        }
    }

    /// Heights fade to the new ones from that sample on. A change of another type is not for it.
    fn set(&mut self, change: &dyn Any, sample: u64) -> bool {
        let Some(ThreadHeight(height_m)) = change.downcast_ref() else { return false };
        self.amplitude_m.set(0.5 * height_m, sample);
        true
    }
}

const RATE_HZ: f64 = 44_100.0;

/// Strokes a surface for half a second from `from_s` on; rms of what is felt, m.
fn stroke(
    scene: &mut Scene,
    renderer: &mut Renderer,
    cloth: SurfaceId,
    from_s: f64,
) -> Result<f64, Box<dyn Error>> {
    let mut squares = 0.0;
    for step in 0..30 {
        let t = from_s + f64::from(step) / 60.0;
        let sample = ContactSample {
            uv: [0.2 + t, 0.5],
            velocity_m_s: Some([0.1, 0.0]),
            normal_force_n: 0.5,
            closing_m_s: 0.0,
            ..ContactSample::default()
        };
        let event = match step {
            0 => ContactEvent::begin(ContactId(1), cloth, ChannelId(0), sample),
            _ => ContactEvent::moved(ContactId(1), sample),
        };
        scene.report(t, event)?;
        let (mut haptic, mut audio) = ([0.0f32; 735], [0.0f32; 735]);
        renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        squares += haptic.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>();
    }
    scene.report(from_s + 0.5, ContactEvent::end(ContactId(1)))?;
    Ok((squares / (0.5 * RATE_HZ)).sqrt())
}

fn main() -> Result<(), Box<dyn Error>> {
    // From a scene file.
    let text = "[[surface]]\nname = \"cloth\"\nwidth_m = 0.1\nheight_m = 0.1\nmicro_relief_m = 0.0\n\
                own = { kind = \"woven\", pitch_m = 1e-3, height_m = 2e-5 }\n[[actuator]]\nfull_scale = 1.0\n";
    let file = SceneFile::parse(text, Path::new("cloth.toml"))?;
    let knows_cloth = Overrides { own: &[("woven", make)], ..Overrides::default() };
    let Engine { mut scene, mut renderer, names, .. } = Engine::from_scene(&file, &knows_cloth)?;
    let from_file_m = stroke(&mut scene, &mut renderer, names.surfaces["cloth"], 0.0)?;
    println!("the cloth of the scene file is felt with {:.1} um rms", 1e6 * from_file_m);
    let stranger = Engine::from_scene(&file, &Overrides::default()).err().map(|error| error.to_string());
    println!("a program that does not know it refuses: {}", stranger.unwrap_or_default());

    // From code, and changed while it is there.
    let cloth = Cloth { pitch_m: 1e-3, height_m: 2e-5 }.weave();
    let si = ActuatorSettings { full_scale: 1.0, ..ActuatorSettings::default() };
    let Engine { mut scene, mut renderer, .. } =
        Config { actuators: vec![si], ..Config::default() }.build()?;
    let cloth = scene.add_surface(Surface::new(cloth, 0.1, 0.1)?.micro_relief_m(0.0))?;
    let thin_m = stroke(&mut scene, &mut renderer, cloth, 0.0)?;
    scene.change_surface(cloth, ThreadHeight(4e-5))?;
    stroke(&mut scene, &mut renderer, cloth, 0.5)?;
    let thick_m = stroke(&mut scene, &mut renderer, cloth, 1.0)?;
    println!("thin threads {:.1} um rms, twice as high {:.1} um rms", 1e6 * thin_m, 1e6 * thick_m);
    assert!((thin_m / from_file_m - 1.0).abs() < 1e-6, "the scene file's cloth is another");
    assert!((thick_m / thin_m - 2.0).abs() < 0.1, "the change did not arrive");
    Ok(())
}
